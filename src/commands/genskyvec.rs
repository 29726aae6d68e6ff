//! `genskyvec`: a sky as a vector of patches, whose directions are rendered.

use super::mksource::seen_from_outside;
use super::scene_program::{Piped, finish};
use crate::args::Reading;
use crate::failure::Outcome;
use crate::input::plan_text;
use radsight_generate::{Error, Surrounding, genskyvec};
use radsight_loader::LoadError;
use radsight_render::{RenderOptions, Renderer};

/// Runs the program; `argv[0]` is its name.
pub(crate) fn run(argv: &[String]) -> Outcome {
    finish("genskyvec", genskyvec(argv, &Piped::default(), &open))
}

fn open(sky: Vec<u8>) -> Result<Box<Surrounding<'static>>, Error> {
    let planned = plan_text("<sky>", sky, &Reading::default(), RenderOptions::default());
    let failed = |reason: &str| LoadError::Unreadable { path: "standard input".to_owned(), reason: reason.to_owned() };
    let renderer = Renderer::new(planned.map_err(|failure| failed(failure.message()))?.plan);
    Ok(Box::new(move |direction| seen_from_outside(&renderer, direction)))
}
