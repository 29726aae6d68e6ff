//! `mksource`: distant sources for the bright parts of what surrounds an octree. It renders, so scene files that call it ask
//! the program's loader for it.

use crate::args::Reading;
use crate::failure::{Failure, Outcome};
use crate::input::plan;
use crate::output::write_standard_output;
use glam::DVec3;
use radsight_generate::{Error, Output, Surrounding, mksource};
use radsight_loader::LoadError;
use radsight_render::{Ray, RenderOptions, Renderer};
use std::sync::atomic::{AtomicU32, Ordering};

/// Scenes whose sources are made from scenes whose sources are made from scenes… go no deeper than this.
const MAX_DEPTH: u32 = 8;

/// How deep we are.
static DEPTH: AtomicU32 = AtomicU32::new(0);

/// Runs the program; `argv[0]` is its name.
pub(crate) fn run(argv: &[String]) -> Outcome {
    let output = make(argv).map_err(|error| Failure::input(format!("mksource: {error}")))?;
    write_standard_output(&output.standard_output)
}

/// What the program prints.
pub(crate) fn make(argv: &[String]) -> Result<Output, Error> {
    mksource(argv, &|octree| {
        let name = octree.unwrap_or("-").to_owned();
        let failed =
            |reason: &str| Error::Load(LoadError::Unreadable { path: name.clone(), reason: reason.to_owned() });
        if DEPTH.fetch_add(1, Ordering::Relaxed) >= MAX_DEPTH {
            return Err(failed("its sources are made of its own sources"));
        }
        let planned = plan(std::slice::from_ref(&name), None, &Reading::default(), RenderOptions::default());
        DEPTH.fetch_sub(1, Ordering::Relaxed);
        let renderer = Renderer::new(planned.map_err(|failure| failed(failure.message()))?.plan);
        Ok(Box::new(move |direction| seen_from_outside(&renderer, direction)) as Box<Surrounding<'_>>)
    })
}

/// The radiance that comes from a direction to a point so far out that no surface with a place is in the way.
pub(super) fn seen_from_outside(renderer: &Renderer, direction: [f64; 3]) -> [f64; 3] {
    let direction = DVec3::from_array(direction);
    let (center, radius) = renderer.plan().bounding_sphere();
    let origin = if radius.is_finite() { center + direction * (1.01 * radius) } else { DVec3::ZERO };
    renderer.worker().trace(0, &Ray { origin, direction }).value
}
