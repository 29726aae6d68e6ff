//! What takes part in the race.

use super::scene::Scene;
use crate::error::BenchError;
use crate::taken::{Taken, taken};
use radsight_picture::{Image, read_image};
use std::path::Path;
use std::process::Command;

/// A way of rendering whose settings differ in effort only, the cheapest first.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    pub(crate) name: String,
    /// Whether its error falls with the square root of the time for ever.
    pub(crate) unbiased: bool,
    pub(crate) settings: Vec<Setting>,
}

/// One way of calling a program.
#[derive(Clone, Debug)]
pub(crate) struct Setting {
    /// What tells it from its neighbours.
    pub(crate) label: String,
    pub(crate) options: Vec<String>,
    /// Rays a pixel, where the options do not say it.
    pub(crate) rays: u32,
}

impl Setting {
    /// The label, with what the series has in common before it.
    pub(crate) fn of(label: impl Into<String>, options: &str, rays: u32) -> Setting {
        Setting { label: label.into(), options: super::scene::words(options), rays }
    }
}

/// Whose programs are compared with each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Team {
    Radsight,
    Radiance,
    Mitsuba,
}

/// A program that renders pictures.
pub(crate) trait Program {
    fn team(&self) -> Team;

    /// As tables call it.
    fn name(&self) -> String;

    /// The settings that are worth trying on a scene; none where it cannot render it.
    fn series(&self, scene: &Scene) -> Vec<Series>;

    /// Gets ready what is not measured, in `folder`.
    fn prepare(&mut self, scene: &Scene, folder: &Path) -> Result<(), BenchError>;

    /// The program as it reads a scene that is ready for it, and answers no ray; `None` where that is not in what rendering takes.
    fn reading(&self, scene: &Scene) -> Option<Command>;

    /// Renders, and tells what that took, reading included.
    fn render(&self, scene: &Scene, setting: &Setting, folder: &Path) -> Result<(Taken, Image<f32>), BenchError>;
}

/// What reading a scene takes, the least of some runs; nothing where that is not measured with the rest.
pub(crate) fn reading(program: &dyn Program, scene: &Scene) -> Result<Taken, BenchError> {
    let mut least = Taken { processor: 0.0, wall: 0.0, peak: 0.0 };
    let Some(mut command) = program.reading(scene) else { return Ok(least) };
    scene.place(&mut command);
    for run in 0..READINGS {
        let taken = taken(&mut command, &scene.folder, None, None)?;
        if run == 0 || taken.processor < least.processor {
            least = taken;
        }
    }
    Ok(least)
}

const READINGS: u32 = 3;

/// Reads any picture.
pub(crate) fn read_picture(path: &Path) -> Result<Image<f32>, BenchError> {
    let read = read_image(&crate::figure::read(path)?)
        .map_err(|error| BenchError::Read { path: path.to_owned(), reason: error.to_string() })?;
    Ok(read.image)
}
