//! Parts of a picture or a capture as plain data, for other processes and other machines.
//!
//! A [`RenderJob`] says what is seen, how many samples each pixel has, the seed, and which rows are asked for. It is split into
//! jobs for fewer rows; each gives a [`JobResult`]; these are merged to the whole. A pixel depends on scene, options, samples
//! and seed alone, so the merged picture is the one that a single process renders, to the last bit, however it was split.
//!
//! ```
//! use radsight::{JobTarget, MergedJob, RenderJob, Renderer, Scene, View};
//! # fn main() -> Result<(), radsight::Error> {
//! let scene = Scene::from_text("void glow white 0 0 4 1 1 1 0 white sphere ball 0 0 4 0 9 0 2")?;
//! let view = View::from_args("-vp 0 0 0 -vd 0 1 0 -vh 40 -vv 40")?;
//! let mut renderer = Renderer::new(&scene)?;
//! let whole = RenderJob::new(JobTarget::picture(&view, 32, 32), 4);
//! let mut parts = Vec::new();
//! for job in whole.split(3, 32)? {
//!     parts.push(renderer.run_job(&job)?); // on another machine
//! }
//! let merged = MergedJob::of(&parts)?;
//! assert!(merged.missing_rows().is_empty());
//! assert_eq!(merged.values, renderer.samples(4).render(&view, 32, 32)?.pixels().concat());
//! # Ok(())
//! # }
//! ```

mod merged;
mod result;

pub use merged::MergedJob;
pub use result::JobResult;

use crate::error::{Error, Report};
use crate::{Capture, Image, Renderer, View};
use radsight_camera::CameraFile;
use radsight_capture::{Exposer, Progress};
use radsight_diag::{Diagnostic, SourceMap};
use radsight_film::{MAX_SAMPLES, ViewCamera, sampled_rows};
use radsight_pinhole::Rays;
use radsight_render::RenderOptions;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// The format of jobs.
const FORMAT: u32 = 1;

/// Rows of a picture that are rendered between two reports of progress.
const ROWS_AT_A_TIME: usize = 16;

/// What is rendered, how exactly, and which part of it. As JSON it is what `radsight job` reads.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RenderJob {
    /// The format of the job: 1.
    pub format: u32,
    /// The scene's files and octrees, for who reads the scene; a library user may give the scene itself.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub scenes: Vec<String>,
    /// What sees the scene.
    #[serde(flatten)]
    pub target: JobTarget,
    /// Rays through every pixel; a power of two converges fastest.
    pub samples: u32,
    /// Chooses the sample sequence.
    #[serde(default)]
    pub seed: u64,
    /// Diffuse interreflections that are followed (`-ab`).
    #[serde(default)]
    pub ambient_bounces: u32,
    /// Which rows are asked for; all of them if it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rows: Option<Range<usize>>,
    /// Says which inputs the values are made from, so that no others are merged with them; the program writes a SHA-256 here.
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
}

impl RenderJob {
    /// All rows, with seed 0 and without interreflections.
    #[must_use]
    pub fn new(target: JobTarget, samples: u32) -> RenderJob {
        RenderJob {
            format: FORMAT,
            scenes: Vec::new(),
            target,
            samples,
            seed: 0,
            ambient_bounces: 0,
            rows: None,
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

    /// The size of the whole picture, pixels in a row and rows. Of a capture the camera knows it.
    ///
    /// # Errors
    /// [`Error::View`] and [`Error::Size`]; [`Error::Option`] for a capture.
    pub fn picture_size(&self) -> Result<[usize; 2], Error> {
        let (_, columns, rows) = self.view()?;
        Ok([columns, rows])
    }

    /// Jobs for at most so many parts of about equally many rows, of a picture of `rows` rows in all.
    ///
    /// # Errors
    /// [`Error::Option`] for no parts, and for rows that the picture does not have.
    pub fn split(&self, parts: usize, rows: usize) -> Result<Vec<RenderJob>, Error> {
        if parts == 0 {
            return Err(wrong("parts", parts, "at least 1"));
        }
        let all = self.rows_of(rows)?;
        let parts = parts.min(all.len());
        let bound = |part: usize| all.start + all.len() * part / parts;
        let job = |part: usize| RenderJob { rows: Some(bound(part)..bound(part + 1)), ..self.clone() };
        Ok((0..parts).map(job).collect())
    }

    /// The rows that are asked for, of a picture of so many.
    ///
    /// # Errors
    /// [`Error::Option`] where they are none of the picture's.
    pub fn rows_of(&self, rows: usize) -> Result<Range<usize>, Error> {
        let asked = self.rows.clone().unwrap_or(0..rows);
        if asked.start >= asked.end || asked.end > rows {
            return Err(Error::Option {
                option: "rows",
                value: format!("{} to {}", asked.start, asked.end),
                expected: "some rows of the picture, the first from 0 and the last not counted",
            });
        }
        Ok(asked)
    }

    /// The options with which the scene is to be compiled.
    ///
    /// # Errors
    /// [`Error::Option`] for a number that is out of its range.
    pub fn render_options(&self) -> Result<RenderOptions, Error> {
        self.check()?;
        let mut options = match self.target {
            JobTarget::Picture { .. } => Renderer::picture_options(),
            JobTarget::Capture { .. } => RenderOptions::default(),
        };
        (options.seed, options.ambient_bounces) = (self.seed, self.ambient_bounces);
        if self.ambient_bounces > 0 {
            // Each process would fill a cache of its own, with other values: paths are followed one by one.
            options.gathering.accuracy = 0.0;
        }
        Ok(options)
    }

    /// Renders the rows of a picture. `renderer` is made with [`RenderJob::render_options`]; `progress` is as for captures.
    ///
    /// # Errors
    /// [`Error::View`], [`Error::Size`] and [`Error::Option`]. `None` if the work was stopped.
    pub fn render(
        &self,
        renderer: &radsight_render::Renderer,
        progress: &dyn Progress,
    ) -> Result<Option<JobResult>, Error> {
        let (view, columns, all) = self.view()?;
        let rows = self.rows_of(all)?;
        let mut camera = ViewCamera::new(view.0, columns, all);
        camera.jitter = 1.0;
        let mut result = JobResult::new(self, [columns, all], rows.clone(), 3);
        for first in rows.clone().step_by(ROWS_AT_A_TIME) {
            if progress.stops() {
                return Ok(None);
            }
            let last = (first + ROWS_AT_A_TIME).min(rows.end);
            for pixel in sampled_rows(renderer, &camera, first..last, self.samples) {
                result.push(&pixel.mean, &pixel.half_difference);
            }
            progress.report((last - rows.start) as u64, rows.len() as u64);
        }
        Ok(Some(result))
    }

    /// Exposes the rows of a camera. `renderer` is made with [`RenderJob::render_options`] and the camera's light ring.
    ///
    /// # Errors
    /// [`Error::Bands`], and [`Error::Option`] for a camera whose rows cannot be exposed apart. `None` if the work was stopped.
    pub fn expose(
        &self,
        renderer: &radsight_render::Renderer,
        camera: &CameraFile,
        progress: &dyn Progress,
    ) -> Result<Option<JobResult>, Error> {
        let [columns, all] = [camera.camera.columns() as usize, camera.camera.rows() as usize];
        let rows = self.rows_of(all)?;
        let rays = Rays::new(&camera.camera, self.samples, self.seed);
        if rays.cells() != camera.camera.pixel_count() || !camera.flickering.is_empty() {
            return Err(wrong(
                "camera",
                "one with diffraction or flicker",
                "one whose pixels are exposed each by itself",
            ));
        }
        let weights = camera.band_weights_for(renderer.plan().bands());
        let weights = weights.map_err(|error| Error::Bands(error.to_string()))?;
        let exposer = Exposer { renderer, rays: &rays, weights: &weights, by_row: &[] };
        let cells = (rows.start * columns) as u64..(rows.end * columns) as u64;
        let exposed = exposer.cells(cells, progress);
        Ok(exposed.map(|exposed| {
            let mut result = JobResult::new(self, [columns, all], rows, 1);
            exposed.iter().for_each(|[exposure, half]| result.push(&[*exposure], &[*half]));
            result
        }))
    }

    fn view(&self) -> Result<(View, usize, usize), Error> {
        let JobTarget::Picture { view, columns, rows } = &self.target else {
            return Err(wrong("target", "a capture", "a picture"));
        };
        let view = View::from_args(view)?;
        let (columns, rows) = view.0.fit(*columns, *rows, 1.0);
        Image::check_size(columns, rows)?;
        Ok((view, columns, rows))
    }

    fn check(&self) -> Result<(), Error> {
        match self.samples {
            1..=MAX_SAMPLES => Ok(()),
            samples => Err(wrong("samples", samples, "1 to 65536")),
        }
    }
}

impl Renderer {
    /// Renders the rows of a picture that a job asks for, with the job's options.
    ///
    /// # Errors
    /// As [`RenderJob::render`], and [`Error::Material`] where a ray met a material that cannot be used.
    pub fn run_job(&mut self, job: &RenderJob) -> Result<JobResult, Error> {
        let result = self.run_job_with_progress(job, &radsight_capture::Silent)?;
        Ok(result.expect("nobody stopped it"))
    }

    /// The same; `progress` hears how far it is, and can stop it: it gives `None` then.
    ///
    /// # Errors
    /// As [`Renderer::run_job`].
    pub fn run_job_with_progress(
        &mut self,
        job: &RenderJob,
        progress: &dyn Progress,
    ) -> Result<Option<JobResult>, Error> {
        let renderer = self.ready_for(job.render_options()?)?;
        let result = job.render(renderer, progress)?;
        self.check_met()?;
        Ok(result)
    }
}

impl Capture {
    /// Exposes the rows that a job asks for, with the job's options and samples. `renderer` is for a scene with the camera's light ring.
    ///
    /// # Errors
    /// As [`RenderJob::expose`] and [`Capture::expose`]. `None` if the work was stopped.
    pub fn run_job(
        &self,
        renderer: &mut Renderer,
        job: &RenderJob,
        progress: &dyn Progress,
    ) -> Result<Option<JobResult>, Error> {
        let result = job.expose(renderer.ready_for(job.render_options()?)?, self.camera_file(), progress)?;
        renderer.check_met()?;
        Ok(result)
    }
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
