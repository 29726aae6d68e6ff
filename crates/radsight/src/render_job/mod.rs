//! Parts of a picture or a capture as plain data, for other processes and other machines.
//!
//! A [`RenderJob`] says what is seen, how many samples each pixel has, the seed, and which
//! rectangle of the pixels, or range of the rays, is asked for. It is split into jobs for smaller
//! parts; each gives a [`JobResult`]; these are merged to the whole. A pixel depends on scene,
//! options, samples, seed and irradiance cache alone, so the merged picture is the one that a
//! single process renders, to the last bit, however it was split.
//!
//! ```
//! use radsight::{JobTarget, MergedJob, RenderJob, Renderer, Scene, View};
//! # fn main() -> Result<(), radsight::Error> {
//! let scene = Scene::from_text("void glow white 0 0 4 1 1 1 0 white sphere ball 0 0 4 0 9 0 2")?;
//! let view = View::from_args("-vp 0 0 0 -vd 0 1 0 -vh 40 -vv 40")?;
//! let mut renderer = Renderer::new(&scene)?;
//! let whole = RenderJob::new(JobTarget::picture(&view, 32, 32), 4);
//! let mut parts = Vec::new();
//! for job in whole.split(3, [32, 32])? {
//!     parts.push(renderer.run_job(&job)?); // on another machine
//! }
//! let merged = MergedJob::of(&parts)?;
//! assert!(merged.missing().is_empty());
//! assert_eq!(merged.values, renderer.samples(4).render(&view, 32, 32)?.pixels().concat());
//! # Ok(())
//! # }
//! ```

mod merged;
mod result;
mod run;
mod tile;

pub use merged::MergedJob;
pub use result::JobResult;
pub use tile::Tile;

use crate::View;
use crate::error::{Error, Report};
use radsight_diag::{Diagnostic, SourceMap};
use radsight_film::MAX_SAMPLES;
use radsight_render::Quantity;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// The format of jobs.
const FORMAT: u32 = 1;

/// What is rendered, how exactly, and which part of it. As JSON it is what `radsight job` reads.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RenderJob {
    /// The format of the job: 1.
    pub format: u32,
    /// The scene's files and octrees, for who reads the scene; a library user may give the scene
    /// itself.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub scenes: Vec<String>,
    /// What sees the scene.
    #[serde(flatten)]
    pub target: JobTarget,
    /// Rays through every pixel; a power of two converges fastest. 1 for a job of rays.
    pub samples: u32,
    /// Chooses the sample sequence.
    #[serde(default)]
    pub seed: u64,
    /// Diffuse interreflections that are followed (`-ab`).
    #[serde(default)]
    pub ambient_bounces: u32,
    /// Error at which interpolation of irradiance aims (`-aa`); 0 follows light path by path. With
    /// more the parts share a cache that is made before.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub ambient_accuracy: f64,
    /// Rays of a cache point (`-ad`); as the renderer's default if it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ambient_divisions: Option<u32>,
    /// Further rays of it (`-as`); as the renderer's default if it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ambient_super_samples: Option<u32>,
    /// The file of the irradiance cache, for who reads it; a library user may give the cache
    /// itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub irradiance_cache: Option<String>,
    /// Which columns of a picture or capture are asked for; all of them if it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub columns: Option<Range<usize>>,
    /// Which rows of it are asked for; all of them if it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rows: Option<Range<usize>>,
    /// Which rays of a job of rays are asked for; all of them if it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rays: Option<Range<usize>>,
    /// Says which inputs the values are made from, so that no others are merged with them; the
    /// program writes a SHA-256 here.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub inputs: String,
}

/// What sees the scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
#[non_exhaustive]
pub enum JobTarget {
    /// A view of Radiance's, within a size; the values are radiances, W/(sr·m²).
    Picture {
        /// Radiance's options of it.
        view: String,
        /// Most pixels in a row.
        columns: usize,
        /// Most rows.
        rows: usize,
    },
    /// A camera file; the values are exposures, J/m².
    Capture {
        /// Its name, for who reads it; a library user may give the camera itself.
        camera: String,
    },
    /// Rays; the values are what each brings.
    Trace {
        /// The file of the rays, for who reads it: six numbers a ray, origin and direction. A
        /// library user may give the rays themselves.
        rays: String,
        /// How the numbers are written.
        #[serde(default)]
        format: RayFormat,
        /// What is answered.
        #[serde(default)]
        quantity: RayQuantity,
    },
}

/// How a file of rays has its numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RayFormat {
    /// As text.
    #[default]
    Ascii,
    /// In single precision, in the machine's order of bytes.
    Float,
    /// In double precision.
    Double,
}

/// What a job of rays answers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RayQuantity {
    /// Radiance along the ray, W/(sr·m²).
    #[default]
    Radiance,
    /// Irradiance at the ray's origin on a surface that faces the ray's direction, W/m².
    Irradiance,
    /// Irradiance of the first surface that is neither a light nor lets light through, W/m².
    SurfaceIrradiance,
}

impl From<RayQuantity> for Quantity {
    fn from(quantity: RayQuantity) -> Quantity {
        match quantity {
            RayQuantity::Radiance => Quantity::Radiance,
            RayQuantity::Irradiance => Quantity::Irradiance,
            RayQuantity::SurfaceIrradiance => Quantity::SurfaceIrradiance,
        }
    }
}

impl JobTarget {
    /// A view, within a size.
    #[must_use]
    pub fn picture(view: &View, columns: usize, rows: usize) -> JobTarget {
        JobTarget::Picture { view: view.to_args().trim().to_owned(), columns, rows }
    }

    /// A camera file of this name.
    #[must_use]
    pub fn capture(camera: impl Into<String>) -> JobTarget {
        JobTarget::Capture { camera: camera.into() }
    }

    /// The radiance of rays of a text file of this name.
    #[must_use]
    pub fn trace(rays: impl Into<String>) -> JobTarget {
        JobTarget::Trace { rays: rays.into(), format: RayFormat::default(), quantity: RayQuantity::default() }
    }
}

impl RenderJob {
    /// All pixels or rays, with seed 0 and without interreflections.
    #[must_use]
    pub fn new(target: JobTarget, samples: u32) -> RenderJob {
        RenderJob {
            format: FORMAT,
            scenes: Vec::new(),
            target,
            samples,
            seed: 0,
            ambient_bounces: 0,
            ambient_accuracy: 0.0,
            ambient_divisions: None,
            ambient_super_samples: None,
            irradiance_cache: None,
            columns: None,
            rows: None,
            rays: None,
            inputs: String::new(),
        }
    }

    /// Reads a job, of this name in messages.
    ///
    /// # Errors
    /// [`Error::Job`] with the place, and [`Error::Option`] for a number that is out of its range.
    pub fn from_json(name: &str, text: &[u8]) -> Result<RenderJob, Error> {
        let job: RenderJob = serde_json::from_slice(text).map_err(|error| bad_json(name, text, &error))?;
        if job.format != FORMAT {
            return Err(wrong("format", job.format, "1"));
        }
        job.check()?;
        Ok(job)
    }

    /// The job as JSON, indented, with a line feed at the end.
    #[must_use]
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("a job is text and numbers");
        text.push('\n');
        text
    }

    fn check(&self) -> Result<(), Error> {
        let is_trace = matches!(self.target, JobTarget::Trace { .. });
        match self.samples {
            1 => {}
            samples if is_trace => return Err(wrong("samples", samples, "1: each ray is answered once")),
            2..=MAX_SAMPLES => {}
            samples => return Err(wrong("samples", samples, "1 to 65536")),
        }
        let accuracy = self.ambient_accuracy;
        if !(accuracy >= 0.0 && accuracy.is_finite()) {
            return Err(wrong("ambient_accuracy", accuracy, "0 or more"));
        }
        if accuracy > 0.0 && matches!(self.target, JobTarget::Capture { .. }) {
            return Err(wrong("ambient_accuracy", accuracy, "0 for a capture, whose light is followed path by path"));
        }
        Ok(())
    }
}

/// Whether a number is the default that is not written.
fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

fn wrong(option: &'static str, value: impl ToString, expected: &'static str) -> Error {
    Error::Option { option, value: value.to_string(), expected }
}

/// What is wrong with a text that is no job, with its place.
fn bad_json(name: &str, text: &[u8], error: &serde_json::Error) -> Error {
    let said = error.to_string();
    let reason = said.split(" at line ").next().unwrap_or(&said);
    let before: usize =
        text.split_inclusive(|byte| *byte == b'\n').take(error.line().max(1) - 1).map(<[u8]>::len).sum();
    let place = (before + error.column().max(1) - 1).min(text.len());
    let mut sources = SourceMap::default();
    let source = sources.add(name, text, None);
    let at = sources.span(source, place, (place + 1).min(text.len()));
    Error::Job(Report::new(vec![Diagnostic::error(format!("bad job: {reason}")).at(at)], sources))
}
