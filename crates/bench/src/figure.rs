//! The paper's figures with a truth.

use crate::error::BenchError;
use clap::ValueEnum;
use radsight_camera::CameraFile;
use radsight_diag::SourceMap;
use radsight_loader::{FileKind, LoadError, Loaded, Loader};
use radsight_picture::read_pfm;
use radsight_sensor::Sensor;
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

/// A figure, by the name of its truth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Figure {
    /// Lambertian sheet, point pinhole, sharp cone.
    T8,
    /// Retroreflecting sheet, point pinhole, sharp cone.
    T9,
    /// Retroreflecting sheet, finite pinhole, sharp cone.
    T10,
    /// Retroreflecting sheet, finite pinhole, measured distribution.
    T11,
    /// With the washer, point pinhole, measured distribution.
    T13,
    /// With the washer, finite pinhole, measured distribution.
    T14,
}

impl Figure {
    fn number(self) -> u32 {
        match self {
            Figure::T8 => 8,
            Figure::T9 => 9,
            Figure::T10 => 10,
            Figure::T11 => 11,
            Figure::T13 => 13,
            Figure::T14 => 14,
        }
    }

    fn scene_names(self) -> &'static [&'static str] {
        match self {
            Figure::T8 => &["sheet-lambertian.rad"],
            Figure::T9 | Figure::T10 | Figure::T11 => &["sheet-retro.rad"],
            Figure::T13 | Figure::T14 => &["sheet-retro.rad", "washer.rad"],
        }
    }

    /// The target error of a capture of the figure, relative to the mean exposure: mirrors are
    /// harder.
    pub(crate) fn target_error(self) -> f64 {
        match self {
            Figure::T13 | Figure::T14 => 0.01,
            _ => 0.005,
        }
    }
}

impl fmt::Display for Figure {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.pad(&format!("t{}", self.number()))
    }
}

/// A figure with its files.
#[derive(Debug)]
pub(crate) struct Subject {
    pub(crate) figure: Figure,
    pub(crate) camera: PathBuf,
    pub(crate) scenes: Vec<PathBuf>,
    pub(crate) sensor: Sensor,
    /// E_pixel in J/m², scanline order from the top left.
    pub(crate) truth: Vec<f64>,
    /// The truth's own rms error, relative to its mean; 0 if unknown.
    pub(crate) truth_noise: f64,
}

impl Subject {
    /// Reads the files of a figure in the repository.
    pub(crate) fn read(figure: Figure, repository: &Path) -> Result<Subject, BenchError> {
        let scenes = repository.join("radiance-scenes/gripps");
        let truths = repository.join("tests/gripps/truth");
        let camera = scenes.join(format!("fig{:02}.toml", figure.number()));
        let truth_file = truths.join(format!("{figure}.pfm"));
        let truth = read_pfm(&read(&truth_file)?)
            .map_err(|error| BenchError::Read { path: truth_file, reason: error.to_string() })?;
        Ok(Subject {
            figure,
            sensor: read_sensor(&camera)?,
            camera,
            scenes: figure.scene_names().iter().map(|name| scenes.join(name)).collect(),
            truth: truth.data().iter().map(|value| f64::from(*value)).collect(),
            truth_noise: noise_of(figure, &fs::read_to_string(truths.join("noise.txt")).unwrap_or_default()),
        })
    }
}

/// The bytes of a file.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, BenchError> {
    fs::read(path).map_err(|error| BenchError::Read { path: path.to_owned(), reason: error.to_string() })
}

fn read_sensor(path: &Path) -> Result<Sensor, BenchError> {
    let bytes = read(path)?;
    let mut sources = SourceMap::default();
    let camera = CameraFile::read(&path.to_string_lossy(), &bytes, &mut sources, &Disk).map_err(|errors| {
        let reason = errors.iter().map(|error| error.render(&sources)).collect();
        BenchError::Read { path: path.to_owned(), reason }
    })?;
    camera.sensor.ok_or_else(|| BenchError::NoSensor { path: path.to_owned() })
}

/// Parses lines such as `t8: noise rms/mean 0.00074; …`.
fn noise_of(figure: Figure, text: &str) -> f64 {
    let start = format!("{figure}: noise rms/mean ");
    let number = text.lines().find_map(|line| line.strip_prefix(&start)?.split(';').next());
    number.and_then(|number| number.trim().parse().ok()).unwrap_or(0.0)
}

/// Files by their path.
pub(crate) struct Disk;

impl Loader for Disk {
    fn load(&self, name: &str, kind: FileKind) -> Result<Loaded, LoadError> {
        match fs::read(name) {
            Ok(bytes) => Ok(Loaded { path: name.to_owned(), bytes }),
            Err(_) => Err(LoadError::NotFound { name: name.to_owned(), kind: kind.words(), searched: String::new() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_noise_is_found_by_figure() {
        let text = "Noise of each\nt1: noise rms/mean 0.5; a\nt10: noise rms/mean 0.00073; mean E 8\n";
        assert_eq!(noise_of(Figure::T10, text), 0.00073);
        assert_eq!(noise_of(Figure::T14, text), 0.0);
    }

    #[test]
    fn every_figure_of_the_repository_can_be_read() {
        let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        for figure in Figure::value_variants() {
            let subject = Subject::read(*figure, &repository).unwrap();
            assert_eq!(subject.truth.len(), 192 * 165);
            assert!(subject.truth_noise > 0.0 && subject.scenes.iter().all(|scene| scene.is_file()));
        }
    }
}
