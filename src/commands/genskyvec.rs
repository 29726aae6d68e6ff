//! `genskyvec`: a sky as a vector of patches, sampled by rendering.

use super::mksource::environment;
use super::scene_program::{Piped, finish};
use crate::args::Reading;
use crate::failure::Outcome;
use crate::input::plan_text;
use crate::trust::Trust;
use radsight_render::RenderOptions;
use radsight_scene_generators::{EnvironmentRadiance, Error, genskyvec};

/// Runs the program; `argv[0]` is its name.
pub(crate) fn run(argv: &[String], trust: &Trust) -> Outcome {
    finish("genskyvec", genskyvec(argv, &Piped::default(), &open), trust)
}

fn open(sky: Vec<u8>) -> Result<Box<EnvironmentRadiance<'static>>, Error> {
    environment("standard input", plan_text("<sky>", sky, &Reading::default(), RenderOptions::default()))
}
