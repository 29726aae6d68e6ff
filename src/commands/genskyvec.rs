//! `genskyvec`: a sky as a vector of patches, whose directions are rendered.

use super::mksource::surrounding;
use super::scene_program::{Piped, finish};
use crate::args::Reading;
use crate::failure::Outcome;
use crate::input::plan_text;
use crate::trust::Trust;
use radsight_render::RenderOptions;
use radsight_scene_generators::{Error, Surrounding, genskyvec};

/// Runs the program; `argv[0]` is its name.
pub(crate) fn run(argv: &[String], trust: &Trust) -> Outcome {
    finish("genskyvec", genskyvec(argv, &Piped::default(), &open), trust)
}

fn open(sky: Vec<u8>) -> Result<Box<Surrounding<'static>>, Error> {
    surrounding("standard input", plan_text("<sky>", sky, &Reading::default(), RenderOptions::default()))
}
