//! The programs of the race.

use super::scene::Scene;
use crate::error::BenchError;
use crate::taken::{Taken, taken};
use radsight_picture::{Image, read_image};
use std::path::Path;
use std::process::Command;

/// A rendering method with settings of increasing cost.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    pub(crate) name: String,
    /// Whether its error decreases with the square root of the time without limit.
    pub(crate) unbiased: bool,
    pub(crate) settings: Vec<Setting>,
}

/// One way of calling a program.
#[derive(Clone, Debug)]
pub(crate) struct Setting {
    /// Distinguishes it from other settings.
    pub(crate) label: String,
    pub(crate) options: Vec<String>,
    /// Rays per pixel, if not in the options.
    pub(crate) rays: u32,
}

impl Setting {
    /// The label, after the common name of the series.
    pub(crate) fn of(label: impl Into<String>, options: &str, rays: u32) -> Setting {
        Setting { label: label.into(), options: super::scene::words(options), rays }
    }
}

/// The family of programs for comparisons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Team {
    Radsight,
    Radiance,
    Mitsuba,
}

/// A program that renders pictures.
pub(crate) trait Program {
    fn team(&self) -> Team;

    /// Name in tables.
    fn name(&self) -> String;

    /// The settings to try on a scene; empty if it cannot be rendered.
    fn series(&self, scene: &Scene) -> Vec<Series>;

    /// Prepares the scene in `folder`, which is not measured.
    fn prepare(&mut self, scene: &Scene, folder: &Path) -> Result<(), BenchError>;

    /// The cost of reading a prepared scene without tracing a ray; `None` if it is not part of the
    /// rendering time.
    fn reading(&self, scene: &Scene) -> Option<Command>;

    /// Renders, and returns the cost including reading.
    fn render(&self, scene: &Scene, setting: &Setting, folder: &Path) -> Result<(Taken, Image<f32>), BenchError>;
}

/// The smallest cost of reading a scene; zero if it is not part of the measurement.
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

/// Reads a picture of any format.
pub(crate) fn read_picture(path: &Path) -> Result<Image<f32>, BenchError> {
    let read = read_image(&crate::figure::read(path)?)
        .map_err(|error| BenchError::Read { path: path.to_owned(), reason: error.to_string() })?;
    Ok(read.image)
}
