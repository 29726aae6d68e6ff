//! `mksource`: distant sources for the bright parts of an octree's environment. It renders, so
//! scene files that call it use the program's loader.

use super::scene_program::finish;
use crate::args::Reading;
use crate::failure::{Failure, Outcome};
use crate::input::{Planned, plan};
use crate::trust::Trust;
use glam::DVec3;
use radsight_loader::LoadError;
use radsight_render::{Ray, RenderOptions, Renderer};
use radsight_scene_generators::{EnvironmentRadiance, Error, Output, mksource};
use std::sync::atomic::{AtomicU32, Ordering};

/// Largest recursion depth: sources may be made from scenes that call `mksource` themselves.
const MAX_DEPTH: u32 = 8;

/// The current depth.
static DEPTH: AtomicU32 = AtomicU32::new(0);

/// Runs the program; `argv[0]` is its name.
pub(crate) fn run(argv: &[String], trust: &Trust) -> Outcome {
    finish("mksource", make(argv, trust), trust)
}

/// The output of the program. If its words are not trusted, a scene called it.
pub(crate) fn make(argv: &[String], trust: &Trust) -> Result<Output, Error> {
    mksource(argv, &|octree| {
        let name = octree.unwrap_or("-").to_owned();
        if DEPTH.fetch_add(1, Ordering::Relaxed) >= MAX_DEPTH {
            return Err(unreadable(&name, "its sources depend on themselves"));
        }
        let reading = Reading::trusted(trust);
        let planned = plan(std::slice::from_ref(&name), None, &reading, RenderOptions::default());
        DEPTH.fetch_sub(1, Ordering::Relaxed);
        environment(&name, planned)
    })
}

/// The environment of a planned scene; `name` denotes it in messages.
pub(super) fn environment(
    name: &str,
    planned: Result<Planned, Failure>,
) -> Result<Box<EnvironmentRadiance<'static>>, Error> {
    let plan = planned.map_err(|failure| unreadable(name, failure.message()))?.plan;
    if let Some(error) = plan.unusable_sky() {
        return Err(unreadable(name, &error.message));
    }
    let renderer = Renderer::new(plan);
    Ok(Box::new(move |direction| seen_from_outside(&renderer, direction)))
}

fn unreadable(name: &str, reason: &str) -> Error {
    Error::Load(LoadError::Unreadable { path: name.to_owned(), reason: reason.to_owned() })
}

/// The radiance from a direction at a point beyond all local surfaces.
fn seen_from_outside(renderer: &Renderer, direction: [f64; 3]) -> [f64; 3] {
    let direction = DVec3::from_array(direction);
    let (center, radius) = renderer.plan().bounding_sphere();
    let origin = if radius.is_finite() { center + direction * (1.01 * radius) } else { DVec3::ZERO };
    renderer.worker().trace(0, &Ray { origin, direction }).value
}
