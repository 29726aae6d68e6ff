//! Captures of a scene with a real camera.

use crate::error::{Error, Report};
use crate::error_budget::ErrorBudget;
use crate::file_loader::FileLoader;
use crate::renderer::check_materials;
use crate::report_page;
use crate::scene::{LIGHT_RING, Scene};
use radsight_camera::CameraFile;
use radsight_capture::{Checkpoint, ErrorTarget, Exposer, Exposure, PixelStatistics, Progress, Silent};
use radsight_diag::{Diagnostic, SourceMap};
use radsight_loader::{FileKind, Loader};
use radsight_pinhole::Rays;
use radsight_render::{RenderOptions, RenderPlan};
use radsight_report::RunRecord;
use std::path::Path;

/// Default relative error of the exposure.
const USUAL_ERROR: f64 = 0.005;

/// A camera file (camera, light ring, sensor), and the sampling budget of its exposure.
///
/// ```no_run
/// use radsight::{Capture, Scene};
/// let capture = Capture::load("fig14.toml")?.error(0.01);
/// let scene = capture.with_ring(Scene::builder().files(["sheet-retro.rad", "washer.rad"])?).build()?;
/// let image = capture.expose(&scene)?;
/// println!("{:.3e} J/m² in the mean, {:?} %", image.mean_exposure(), image.estimated_error);
/// let greys = image.greys(&capture)?;
/// # Ok::<(), radsight::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Capture {
    file: CameraFile,
    options: RenderOptions,
    budget: ErrorBudget,
}

/// An exposed image.
///
/// ```no_run
/// use radsight::{Capture, Scene};
/// let capture = Capture::load("fig14.toml")?;
/// let scene = capture.with_ring(Scene::builder().files(["sheet-retro.rad"])?).build()?;
/// let image = capture.expose(&scene)?;
/// println!("{} x {} pixels of {:.3e} J/m² in the mean", image.columns, image.rows, image.mean_exposure());
/// let greys: Vec<u16> = image.greys(&capture)?;
/// # Ok::<(), radsight::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct CapturedImage {
    /// Number of columns.
    pub columns: usize,
    /// Number of rows.
    pub rows: usize,
    /// Exposure of each pixel, J/m², top row first.
    pub exposure_j_per_m2: Vec<f64>,
    /// Estimated rms error of the pixels, relative to the mean exposure, if it was estimated.
    pub estimated_error: Option<f64>,
    /// Whether the limit of rays per pixel stopped the work before the requested error was reached.
    pub is_stopped: bool,
    /// Number of camera rays.
    pub rays: u64,
    /// Standard error and number of rays of each pixel, if the error was estimated.
    pub pixels: Option<PixelStatistics>,
    seed: u64,
    pub(crate) record: RunRecord,
}

impl Capture {
    /// Loads a camera file; files that it names are found beside it.
    ///
    /// # Errors
    /// [`Error::Load`], and [`Error::Camera`] with every mistake in it.
    pub fn load(path: impl AsRef<Path>) -> Result<Capture, Error> {
        let name = path.as_ref().display().to_string();
        let loader = FileLoader::default();
        let bytes = loader.load(&name, FileKind::Other)?.bytes;
        Capture::from_text(&name, &bytes, &loader)
    }

    /// Loads a camera file and replaces some of its keys, as [`with_keys`](Capture::with_keys)
    /// does.
    ///
    /// # Errors
    /// As [`Capture::load`] and [`Capture::with_keys`].
    pub fn load_with_keys<K: AsRef<str>>(path: impl AsRef<Path>, keys: &[(K, K)]) -> Result<Capture, Error> {
        let name = path.as_ref().display().to_string();
        let loader = FileLoader::default();
        let bytes = loader.load(&name, FileKind::Other)?.bytes;
        Capture::with_keys(&name, &bytes, keys, &loader)
    }

    /// Parses a camera file with some of its keys, written as `table.key`, replaced or added.
    ///
    /// # Errors
    /// [`Error::Key`] for an unknown key, and [`Error::Camera`] with every mistake in the changed
    /// text.
    pub fn with_keys<K: AsRef<str>>(
        name: &str,
        text: &[u8],
        keys: &[(K, K)],
        loader: &dyn Loader,
    ) -> Result<Capture, Error> {
        let Ok(mut text) = String::from_utf8(text.to_vec()) else { return Capture::from_text(name, text, loader) };
        for (key, value) in keys {
            text = radsight_camera::with_key(&text, key.as_ref(), value.as_ref())
                .map_err(|error| Error::Key { key: key.as_ref().to_owned(), expected: error.to_string() })?;
        }
        Capture::from_text(name, text.as_bytes(), loader)
    }

    /// Parses a camera file. `name` denotes it in messages.
    ///
    /// # Errors
    /// [`Error::Camera`] with every mistake in it.
    pub fn from_text(name: &str, text: &[u8], loader: &dyn Loader) -> Result<Capture, Error> {
        let mut sources = SourceMap::default();
        match CameraFile::read(name, text, &mut sources, loader) {
            Ok(file) if !file.flickering.is_empty() => {
                let message = "[flicker] is not supported by the library, only by the program \"radsight capture\"";
                Err(Error::Camera(Report::new(vec![Diagnostic::error(message)], sources)))
            }
            Ok(file) => {
                Ok(Capture { file, options: RenderOptions::default(), budget: ErrorBudget::error(USUAL_ERROR) })
            }
            Err(errors) => Err(Error::Camera(Report::new(errors, sources))),
        }
    }

    /// The requested error of the exposure: rms over the pixels, relative to the mean. Default
    /// 0.005.
    #[must_use]
    pub fn error(self, error: f64) -> Capture {
        self.budget(ErrorBudget::error(error))
    }

    /// The number of rays per pixel, instead of an error.
    #[must_use]
    pub fn samples(self, samples: u32) -> Capture {
        self.budget(ErrorBudget::samples(samples))
    }

    /// The sampling budget, as of a [`Renderer`](crate::Renderer): an error relative to the mean
    /// exposure, or a number of rays per pixel.
    #[must_use]
    pub fn budget(mut self, budget: ErrorBudget) -> Capture {
        self.budget = budget;
        self
    }

    /// The seed of the sample sequence and of the sensor's noise. Default 0.
    #[must_use]
    pub fn seed(mut self, seed: u64) -> Capture {
        self.options.seed = seed;
        self
    }

    /// All render options, mutable.
    pub fn options_mut(&mut self) -> &mut RenderOptions {
        &mut self.options
    }

    /// Adds the camera file's light ring to a scene.
    #[must_use]
    pub fn with_ring<'l>(&self, scene: crate::SceneBuilder<'l>) -> crate::SceneBuilder<'l> {
        match &self.file.rig {
            Some(rig) => scene.text(LIGHT_RING, rig.scene_text()),
            None => scene,
        }
    }

    /// Exposes the camera to a scene.
    ///
    /// # Errors
    /// [`Error::Option`], [`Error::Bands`], [`Error::Scene`] and [`Error::Material`].
    pub fn expose(&self, scene: &Scene) -> Result<CapturedImage, Error> {
        self.expose_with_progress(scene, &Silent)
    }

    /// The same with progress reports. `progress` receives the finished share and can stop the
    /// work; unfinished pixels are then 0.
    ///
    /// # Errors
    /// As [`Capture::expose`].
    pub fn expose_with_progress(&self, scene: &Scene, progress: &dyn Progress) -> Result<CapturedImage, Error> {
        self.check()?;
        let plan = RenderPlan::new(scene.scene.clone(), self.options.clone(), &scene.materials)
            .map_err(|errors| Error::Scene(Report::new(errors, scene.sources.clone())))?;
        let weights = self.file.band_weights_for(plan.bands()).map_err(|error| Error::Bands(error.to_string()))?;
        let renderer = radsight_render::Renderer::new(plan);
        let rays = Rays::new(&self.file.camera, self.fixed_samples().unwrap_or(1), self.options.seed);
        let exposer = Exposer { renderer: &renderer, rays: &rays, weights: &weights, by_row: &[] };
        let exposure = self.sampled(&exposer, None, progress);
        check_materials(renderer.plan(), &scene.sources)?;
        Ok(self.image(exposure, report_page::record(&renderer, &self.options)))
    }

    /// Checks the options.
    pub(crate) fn check(&self) -> Result<(), Error> {
        let wrong = |option, value: String, expected| Err(Error::Option { option, value, expected });
        match (self.budget.asked_error(), self.fixed_samples()) {
            (None, None) => return wrong("budget", "a preview".to_owned(), "an error or a number of samples"),
            (_, Some(0)) => return wrong("samples", "0".to_owned(), "at least 1"),
            (Some(error), _) if !(error > 0.0 && error.is_finite()) => {
                return wrong("error", error.to_string(), "a relative error above 0, such as 0.005");
            }
            _ => {}
        }
        Ok(())
    }

    /// The parsed camera file.
    #[must_use]
    pub fn camera_file(&self) -> &CameraFile {
        &self.file
    }

    pub(crate) fn options(&self) -> &RenderOptions {
        &self.options
    }

    /// Exposes with the budget. Only exposures to an error continue from `start`.
    pub(crate) fn sampled(
        &self,
        exposer: &Exposer<'_>,
        start: Option<Checkpoint>,
        progress: &dyn Progress,
    ) -> Exposure {
        match self.budget.target() {
            Some(target) => exposer.to_error(target, start, progress),
            None => exposer.with_samples(None, progress),
        }
    }

    pub(crate) fn error_target(&self) -> Option<ErrorTarget> {
        self.budget.target()
    }

    pub(crate) fn fixed_samples(&self) -> Option<u32> {
        self.budget.asked_samples()
    }

    pub(crate) fn image(&self, exposure: Exposure, mut record: RunRecord) -> CapturedImage {
        let asked = self.budget.asked_error();
        record.error = report_page::reached(exposure.estimated_error, None, asked);
        record.rays = Some(exposure.rays);
        CapturedImage {
            columns: self.file.camera.columns() as usize,
            rows: self.file.camera.rows() as usize,
            exposure_j_per_m2: exposure.values,
            estimated_error: exposure.estimated_error,
            is_stopped: exposure.stopped.is_some(),
            rays: exposure.rays,
            pixels: exposure.pixels,
            seed: self.options.seed,
            record,
        }
    }
}

impl CapturedImage {
    /// Mean exposure, J/m².
    #[must_use]
    pub fn mean_exposure(&self) -> f64 {
        self.exposure_j_per_m2.iter().sum::<f64>() / self.exposure_j_per_m2.len().max(1) as f64
    }

    /// The grey values of the camera's sensor, top row first.
    ///
    /// # Errors
    /// [`Error::NoSensor`].
    pub fn greys(&self, camera: &Capture) -> Result<Vec<u16>, Error> {
        let sensor = camera.file.sensor.as_ref().ok_or(Error::NoSensor)?;
        // Exposures are rounded to single precision, as in files.
        let stored: Vec<f64> = self.exposure_j_per_m2.iter().map(|value| f64::from(*value as f32)).collect();
        Ok(sensor.greys(&stored, self.seed))
    }
}
