//! Captures of a scene with a real camera.

use crate::camera::{Camera, CameraFault, CameraRay, checked};
use crate::error::{Error, Report};
use crate::error_budget::ErrorBudget;
use crate::file_loader::FileLoader;
use crate::option_check::{check_budget, check_options, wrong};
use crate::renderer::check_materials;
use crate::report_page;
use crate::scene::{LIGHT_RING, Scene};
use radsight_camera::CameraFile;
use radsight_capture::{Checkpoint, ErrorTarget, Exposer, Exposure, PixelStatistics, Progress, Silent};
use radsight_diag::{Diagnostic, SourceMap};
use radsight_film::SamplingBudget;
use radsight_loader::{FileKind, Loader};
use radsight_pinhole::{FilmRay, FilmRays, Rays};
use radsight_render::{RenderOptions, RenderPlan};
use radsight_report::RunRecord;
use std::fmt;
use std::path::Path;
use std::sync::Arc;

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
    own_camera: Option<OwnCamera>,
}

/// A custom camera in the place of the file's.
#[derive(Clone)]
struct OwnCamera(Arc<dyn Camera + Send + Sync>);

impl fmt::Debug for OwnCamera {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("OwnCamera")
    }
}

/// The checked rays of a custom camera for one exposure.
#[derive(Debug)]
struct OwnRays {
    camera: OwnCamera,
    fault: CameraFault,
}

impl FilmRays for OwnRays {
    fn ray(&self, film: [f64; 2], aperture: [f64; 2]) -> Option<FilmRay> {
        let given = self.camera.0.ray(film, aperture)?;
        match checked(given, film) {
            // A ray of usual length keeps its bits.
            Ok((ray, weight)) => {
                let is_usual = given.direction.try_normalize().is_some();
                let direction = if is_usual { given.direction } else { ray.direction };
                Some(FilmRay { origin: given.origin, direction, weight })
            }
            Err(mistake) => {
                self.fault.set(Error::OwnCamera(mistake));
                None
            }
        }
    }
}

/// Stops an exposure after a mistake of its custom camera.
struct UntilFault<'p> {
    progress: &'p dyn Progress,
    own: Option<&'p OwnRays>,
}

impl Progress for UntilFault<'_> {
    fn report(&self, done: u64, total: u64) {
        self.progress.report(done, total);
    }

    fn wants_checkpoint(&self) -> bool {
        self.progress.wants_checkpoint()
    }

    fn save(&self, checkpoint: Checkpoint) {
        self.progress.save(checkpoint);
    }

    fn stops(&self) -> bool {
        self.progress.stops() || self.own.is_some_and(|own| own.fault.is_set())
    }
}

/// The camera of a [`Capture`], for pictures: its pinhole or lens, distortion and sensor position.
/// The weight of a ray is cos⁴θ.
///
/// ```
/// use radsight::{Camera, Capture, MemoryLoader};
/// let file = b"[camera]
/// position_m = [0.0, 0.0, 0.5]
/// direction = [0.0, 0.0, -1.0]
/// up = [0.0, 1.0, 0.0]
/// pixels = [40, 30]
/// pixel_pitch_um = [10.0, 10.0]
/// focal_distance_mm = 4.0
/// pinhole_diameter_mm = 0.1
/// exposure_ms = 10.0";
/// let capture = Capture::from_text("camera.toml", file, &MemoryLoader::default())?;
/// let ray = capture.camera().ray([0.5, 0.5], [0.5, 0.5]).unwrap();
/// assert!(ray.direction.z == -1.0 && ray.weight == 1.0);
/// # Ok::<(), radsight::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct CaptureCamera {
    rays: Rays,
    own: Option<OwnCamera>,
}

impl Camera for CaptureCamera {
    fn ray(&self, [x, y]: [f64; 2], [u, v]: [f64; 2]) -> Option<CameraRay> {
        if let Some(own) = &self.own {
            return own.0.ray([x, y], [u, v]);
        }
        let camera = self.rays.camera();
        let [columns, rows] = [camera.columns(), camera.rows()].map(f64::from);
        let [column, row] = [(x * columns).min(columns - 1.0).floor(), (y * rows).min(rows - 1.0).floor()];
        let pixel = row as u64 * u64::from(camera.columns()) + column as u64;
        let ray = self.rays.ray(pixel, [x * columns - column, y * rows - row, u, v]);
        (ray.cos4 > 0.0).then_some(CameraRay { origin: ray.origin, direction: ray.direction, weight: ray.cos4 })
    }

    fn check(&self) -> Result<(), Error> {
        self.own.as_ref().map_or(Ok(()), |own| own.0.check())
    }
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
    /// Whether the work ended before the requested error was reached: at the limit of rays per pixel, or
    /// because more rays would not lower what is left.
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
    /// ```no_run
    /// let capture = radsight::Capture::load("fig14.toml")?;
    /// # Ok::<(), radsight::Error>(())
    /// ```
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
    /// ```no_run
    /// let slow = radsight::Capture::load_with_keys("fig14.toml", &[("camera.exposure_ms", "20.0")])?;
    /// # Ok::<(), radsight::Error>(())
    /// ```
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
    /// ```
    /// use radsight::{Capture, MemoryLoader, example};
    /// let keys = [("camera.pixels", "[8, 8]")];
    /// let capture = Capture::with_keys("camera.toml", example::CAMERA, &keys, &MemoryLoader::default())?;
    /// assert_eq!(capture.camera_file().camera.columns(), 8);
    /// # Ok::<(), radsight::Error>(())
    /// ```
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
    /// ```
    /// use radsight::{Capture, MemoryLoader};
    /// let error = Capture::from_text("camera.toml", b"[camera]\npixels = 3", &MemoryLoader::default()).unwrap_err();
    /// assert!(error.to_string().contains("camera.toml:2"));
    /// ```
    ///
    /// # Errors
    /// [`Error::Camera`] with every mistake in it.
    pub fn from_text(name: &str, text: &[u8], loader: &dyn Loader) -> Result<Capture, Error> {
        let mut sources = SourceMap::default();
        match CameraFile::read(name, text, &mut sources, loader) {
            Ok(file) if !file.flickering.is_empty() => {
                let message = "[flicker] is supported by single pictures of the program \"radsight capture\" alone: not with --variants, --derivative or --fisher, and not by the library";
                Err(Error::Camera(Report::new(vec![Diagnostic::error(message)], sources)))
            }
            Ok(file) => Ok(Capture {
                file,
                options: RenderOptions::default(),
                budget: ErrorBudget::error(USUAL_ERROR),
                own_camera: None,
            }),
            Err(errors) => Err(Error::Camera(Report::new(errors, sources))),
        }
    }

    /// The requested error of the exposure: rms over the pixels, relative to the mean. Default
    /// 0.005.
    ///
    /// ```
    /// # use radsight::example::{capture, scene};
    /// let image = capture().error(0.1).expose(&scene())?;
    /// assert!(image.estimated_error.unwrap() <= 0.1);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn error(self, error: f64) -> Capture {
        self.budget(ErrorBudget::error(error))
    }

    /// The number of rays per pixel, instead of an error.
    ///
    /// ```
    /// # use radsight::example::{capture, scene};
    /// let image = capture().samples(4).expose(&scene())?;
    /// assert_eq!(image.rays, 4 * 16 * 16);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn samples(self, samples: u32) -> Capture {
        self.budget(ErrorBudget::samples(samples))
    }

    /// The sampling budget, as of a [`Renderer`](crate::Renderer): an error relative to the mean
    /// exposure, or a number of rays per pixel.
    ///
    /// ```
    /// # use radsight::example::{capture, scene};
    /// use radsight::ErrorBudget;
    /// let image = capture().budget(ErrorBudget::error(0.001).at_most(8)).expose(&scene())?;
    /// assert!(image.is_stopped && image.rays <= 8 * 16 * 16);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn budget(mut self, budget: ErrorBudget) -> Capture {
        self.budget = budget;
        self
    }

    /// The seed of the sample sequence and of the sensor's noise. Default 0.
    ///
    /// ```
    /// # use radsight::example::{capture, scene};
    /// let [a, b] = [1, 2].map(|seed| capture().samples(2).seed(seed).expose(&scene()).unwrap());
    /// assert_ne!(a.exposure_j_per_m2, b.exposure_j_per_m2);
    /// ```
    #[must_use]
    pub fn seed(mut self, seed: u64) -> Capture {
        self.options.seed = seed;
        self
    }

    /// All render options, mutable.
    ///
    /// ```
    /// # use radsight::example::{capture, scene};
    /// let mut capture = capture().samples(4);
    /// let direct = capture.expose(&scene())?;
    /// capture.options_mut().ambient_bounces = 1;
    /// assert!(capture.expose(&scene())?.mean_exposure() > direct.mean_exposure());
    /// # Ok::<(), radsight::Error>(())
    /// ```
    pub fn options_mut(&mut self) -> &mut RenderOptions {
        &mut self.options
    }

    /// Exposes with a custom camera: a [`View`](crate::View) of any type, with or without a thin
    /// lens, or custom rays. Pixels, exposure time, sensor and light ring remain those of the
    /// file, and so does the exposure for a mean of weight times radiance of 1 W/(sr·m²), the
    /// exposure time times `A/f²` of the file's pinhole or lens. The weight of a ray thus takes the
    /// place of cos⁴θ.
    ///
    /// ```
    /// use radsight::{Capture, MemoryLoader, Scene, View};
    /// use std::sync::Arc;
    /// let file = b"[camera]
    /// position_m = [0.0, 0.0, 0.0]
    /// direction = [0.0, 1.0, 0.0]
    /// up = [0.0, 0.0, 1.0]
    /// pixels = [16, 16]
    /// pixel_pitch_um = [10.0, 10.0]
    /// focal_distance_mm = 4.0
    /// pinhole_diameter_mm = 0.1
    /// exposure_ms = 10.0";
    /// let capture = Capture::from_text("camera.toml", file, &MemoryLoader::default())?;
    /// let fisheye = View::from_args("-vta -vp 0 0 0 -vd 0 1 0 -vh 120 -vv 120")?;
    /// let capture = capture.with_camera(Arc::new(fisheye)).samples(4);
    /// let scene = Scene::from_text("void glow white 0 0 4 2 2 2 0  white bubble room 0 0 4 0 0 0 9")?;
    /// let image = capture.expose(&scene)?;
    /// // 10 ms times 2 W/(sr m2) times the solid angle of the pinhole, without cos4.
    /// let expected = 0.01 * 2.0 * std::f64::consts::PI * (0.05_f64 / 4.0).powi(2);
    /// assert!((image.mean_exposure() / expected - 1.0).abs() < 1e-9);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn with_camera(mut self, camera: Arc<dyn Camera + Send + Sync>) -> Capture {
        self.own_camera = Some(OwnCamera(camera));
        self
    }

    /// The camera of the file, or the custom one, for
    /// [`Renderer::render_camera`](crate::Renderer::render_camera).
    ///
    /// ```
    /// # use radsight::example::{capture, scene};
    /// let image = radsight::Renderer::new(&scene())?.samples(4).render_camera(&capture().camera(), 16, 16)?;
    /// assert!(image.pixel(8, 8)[0] > 0.9); // radiance times cos4
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn camera(&self) -> CaptureCamera {
        CaptureCamera { rays: self.rays(None), own: self.own_camera.clone() }
    }

    /// Adds the camera file's light ring to a scene.
    ///
    /// ```no_run
    /// use radsight::{Capture, Scene};
    /// let capture = Capture::load("fig14.toml")?;
    /// let scene = capture.with_ring(Scene::builder().files(["sheet-retro.rad"])?).build()?;
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn with_ring<'l>(&self, scene: crate::SceneBuilder<'l>) -> crate::SceneBuilder<'l> {
        match &self.file.rig {
            Some(rig) => scene.text(LIGHT_RING, rig.scene_text()),
            None => scene,
        }
    }

    /// Exposes the camera to a scene.
    ///
    /// ```
    /// # use radsight::example::{capture, scene};
    /// let image = capture().expose(&scene())?;
    /// assert_eq!((image.columns, image.rows, image.exposure_j_per_m2.len()), (16, 16, 256));
    /// # Ok::<(), radsight::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Option`], [`Error::Bands`], [`Error::Scene`] and [`Error::Material`].
    pub fn expose(&self, scene: &Scene) -> Result<CapturedImage, Error> {
        self.expose_with_progress(scene, &Silent)
    }

    /// The same with progress reports. `progress` receives the finished share and can stop the
    /// work; unfinished pixels are then 0.
    ///
    /// ```
    /// # use radsight::example::{capture, scene};
    /// struct Now;
    /// impl radsight::Progress for Now {
    ///     fn report(&self, _done: u64, _total: u64) {}
    ///     fn stops(&self) -> bool {
    ///         true
    ///     }
    /// }
    /// let image = capture().expose_with_progress(&scene(), &Now)?;
    /// assert!(image.is_stopped);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Capture::expose`].
    pub fn expose_with_progress(&self, scene: &Scene, progress: &dyn Progress) -> Result<CapturedImage, Error> {
        self.check()?;
        let plan = RenderPlan::new(scene.scene.clone(), self.options.clone(), &scene.materials)
            .map_err(|errors| Error::Scene(Report::new(errors, scene.sources.clone())))?;
        let weights = self.file.band_weights_for(plan.bands()).map_err(|error| Error::Bands(error.to_string()))?;
        let renderer = radsight_render::Renderer::new(plan);
        let own = self.own_camera.clone().map(|camera| Arc::new(OwnRays { camera, fault: CameraFault::default() }));
        let rays = self.rays(own.clone());
        let exposer = Exposer { renderer: &renderer, rays: &rays, weights: &weights, by_row: &[] };
        let exposure = self.sampled(&exposer, None, &UntilFault { progress, own: own.as_deref() });
        own.map_or(Ok(()), |own| own.fault.take())?;
        check_materials(renderer.plan(), &scene.sources)?;
        Ok(self.image(exposure, report_page::record(&renderer, &self.options)))
    }

    /// The rays of the custom camera, or of the file's.
    fn rays(&self, own: Option<Arc<OwnRays>>) -> Rays {
        let (camera, samples) = (&self.file.camera, self.fixed_samples().unwrap_or(1));
        match own {
            Some(own) => Rays::with_own(camera, own, samples, self.options.seed),
            None => Rays::new(camera, samples, self.options.seed),
        }
    }

    /// Refuses a custom camera where the parameters of the file's are needed.
    pub(crate) fn check_camera(&self) -> Result<(), Error> {
        let (option, value) = ("camera", "a custom camera".to_owned());
        let expected = "the camera of the file, for a series or derivatives";
        if self.own_camera.is_some() { Err(Error::Option { option, value, expected }) } else { Ok(()) }
    }

    /// Checks options and camera.
    pub(crate) fn check(&self) -> Result<(), Error> {
        match self.budget.asked() {
            SamplingBudget::Interpolated(_) => {
                return Err(wrong("budget", "a preview", "an error or a number of samples"));
            }
            SamplingBudget::Samples(0) => return Err(wrong("samples", 0, "at least 1")),
            SamplingBudget::Samples(_) => {}
            SamplingBudget::Error(_) => check_budget(&self.budget)?,
        }
        check_options(&self.options)?;
        self.own_camera.as_ref().map_or(Ok(()), |own| own.0.check())
    }

    /// The parsed camera file.
    ///
    /// ```
    /// let file = radsight::example::capture();
    /// assert_eq!(file.camera_file().camera.exposure_s(), 0.01);
    /// ```
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
    ///
    /// ```
    /// # use radsight::example::{capture, scene};
    /// let [once, twice] = [1, 2].map(|_| capture().samples(4).expose(&scene()).unwrap().mean_exposure());
    /// assert!(once > 0.0 && once == twice); // J/m²
    /// ```
    #[must_use]
    pub fn mean_exposure(&self) -> f64 {
        self.exposure_j_per_m2.iter().sum::<f64>() / self.exposure_j_per_m2.len().max(1) as f64
    }

    /// The grey values of the camera's sensor, top row first.
    ///
    /// ```
    /// # use radsight::example::{capture, scene};
    /// let capture = capture();
    /// let greys = capture.expose(&scene())?.greys(&capture)?;
    /// assert!(greys.len() == 256 && greys[8 * 16 + 8] > greys[0]);
    /// # Ok::<(), radsight::Error>(())
    /// ```
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
