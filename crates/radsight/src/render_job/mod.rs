//! Parts of a picture or a capture as plain data, for other processes and other machines.
//!
//! A [`RenderJob`] contains the view, the number of samples of each pixel, the seed, and the
//! requested rectangle of pixels or range of rays. It is split into jobs for smaller parts; each
//! gives a [`JobResult`]; these are merged to the whole. A pixel depends on scene,
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
use crate::option_check::wrong;
use radsight_diag::{Diagnostic, SourceMap};
use radsight_film::MAX_SAMPLES;
use radsight_render::Quantity;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// The format of jobs.
const FORMAT: u32 = 1;

/// A picture, capture or list of rays to compute, and the part of it. `radsight job` reads it as
/// JSON.
///
/// ```
/// use radsight::{JobTarget, RenderJob};
/// let whole = RenderJob::new(JobTarget::trace("sensors.txt"), 1);
/// let parts = whole.split_rays(64, 100)?;
/// assert_eq!(parts[1].rays, Some(64..100));
/// assert_eq!(RenderJob::from_json("part.json", parts[1].to_json().as_bytes())?, parts[1]);
/// # Ok::<(), radsight::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RenderJob {
    /// The format of the job: 1.
    pub format: u32,
    /// The scene's files and octrees. The program reads them; users of the library may pass a
    /// scene instead.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub scenes: Vec<String>,
    /// The view, camera or rays.
    #[serde(flatten)]
    pub target: JobTarget,
    /// Rays per pixel; a power of two converges fastest. 1 for a job of rays.
    pub samples: u32,
    /// Seed of the sample sequence.
    #[serde(default)]
    pub seed: u64,
    /// Number of diffuse interreflections (`-ab`).
    #[serde(default)]
    pub ambient_bounces: u32,
    /// Relative interpolation error of cached irradiance (`-aa`); 0 traces single paths. Above 0
    /// the parts share a cache that is filled before.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub ambient_accuracy: f64,
    /// Rays of a cache point (`-ad`); the renderer's default if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ambient_divisions: Option<u32>,
    /// Additional rays of a cache point (`-as`); the renderer's default if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ambient_super_samples: Option<u32>,
    /// The file of the irradiance cache. The program reads it; users of the library may pass a
    /// cache instead.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub irradiance_cache: Option<String>,
    /// The requested columns of a picture or capture; all if none are given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub columns: Option<Range<usize>>,
    /// The requested rows; all if none are given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rows: Option<Range<usize>>,
    /// The requested rays of a job of rays; all if none are given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rays: Option<Range<usize>>,
    /// Identifies the input files, so that only values of the same inputs are merged; the program
    /// writes their SHA-256.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub inputs: String,
}

/// The view, camera or rays of a job.
///
/// ```
/// use radsight::{JobTarget, View};
/// let view = View::from_args("-vp 0 0 0 -vd 0 1 0 -vh 40 -vv 40")?;
/// assert!(matches!(JobTarget::picture(&view, 640, 480), JobTarget::Picture { columns: 640, .. }));
/// # Ok::<(), radsight::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
#[non_exhaustive]
pub enum JobTarget {
    /// A picture of a Radiance view; the values are radiances, W/(sr·m²).
    Picture {
        /// Radiance's view options.
        view: String,
        /// Maximum number of columns.
        columns: usize,
        /// Maximum number of rows.
        rows: usize,
    },
    /// A camera file; the values are exposures, J/m².
    Capture {
        /// Its name. Users of the library may pass a camera instead.
        camera: String,
    },
    /// Rays; each has one value.
    Trace {
        /// The file of the rays: six numbers each, origin and direction. Users of the library may
        /// pass rays instead.
        rays: String,
        /// The format of the numbers.
        #[serde(default)]
        format: RayFormat,
        /// The quantity of the values.
        #[serde(default)]
        quantity: RayQuantity,
    },
}

/// The format of the numbers in a file of rays.
///
/// ```
/// use radsight::{JobTarget, RayFormat, RayQuantity, RenderJob};
/// let (format, quantity) = (RayFormat::Float, RayQuantity::Irradiance);
/// let job = RenderJob::new(JobTarget::Trace { rays: "sensors.f32".to_owned(), format, quantity }, 1);
/// assert!(job.to_json().contains("float") && job.to_json().contains("irradiance"));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RayFormat {
    /// As text.
    #[default]
    Ascii,
    /// In single precision, in the machine's byte order.
    Float,
    /// In double precision.
    Double,
}

/// The quantity of a job of rays.
///
/// ```
/// assert_eq!(radsight::RayQuantity::default(), radsight::RayQuantity::Radiance);
/// ```
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
    /// A view of at most this size.
    #[must_use]
    pub fn picture(view: &View, columns: usize, rows: usize) -> JobTarget {
        JobTarget::Picture { view: view.to_args().trim().to_owned(), columns, rows }
    }

    /// The camera file with this name.
    ///
    /// ```
    /// use radsight::JobTarget;
    /// assert!(matches!(JobTarget::capture("camera.toml"), JobTarget::Capture { .. }));
    /// ```
    #[must_use]
    pub fn capture(camera: impl Into<String>) -> JobTarget {
        JobTarget::Capture { camera: camera.into() }
    }

    /// The radiance of the rays in the text file with this name.
    ///
    /// ```
    /// use radsight::{JobTarget, RayQuantity};
    /// let JobTarget::Trace { quantity, .. } = JobTarget::trace("sensors.txt") else { panic!("rays") };
    /// assert_eq!(quantity, RayQuantity::Radiance);
    /// ```
    #[must_use]
    pub fn trace(rays: impl Into<String>) -> JobTarget {
        JobTarget::Trace { rays: rays.into(), format: RayFormat::default(), quantity: RayQuantity::default() }
    }
}

impl RenderJob {
    /// All pixels or rays, with seed 0 and without interreflection.
    ///
    /// ```
    /// use radsight::{JobTarget, RenderJob};
    /// let job = RenderJob::new(JobTarget::capture("camera.toml"), 64);
    /// assert_eq!((job.samples, job.seed), (64, 0));
    /// ```
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

    /// Reads a job; `name` is its name in messages.
    ///
    /// ```
    /// use radsight::RenderJob;
    /// assert!(RenderJob::from_json("job.json", b"{}").unwrap_err().to_string().contains("job.json"));
    /// ```
    ///
    /// # Errors
    /// [`Error::Job`] with the position, and [`Error::Option`] for a number out of range.
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

/// The error of a text that is not a job, with its position.
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
