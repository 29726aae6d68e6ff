//! Captures.

use crate::array_view::array_view;
use crate::errors::{RadsightError, exception};
use crate::png;
use crate::scene::{Files, Materials, Scene, Text, files_first, texts_of};
use crate::sensor::Sensor;
use crate::supervise::{Watch, supervised};
use crate::whole_argument;
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};
use radsight::{FileKind, FileLoader, Loader, MemoryLoader, RecordingLoader, Stage};
use radsight_camera::with_key;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Instant;

/// A camera file (camera, light ring, sensor), and the sampling of its exposure.
///
/// Parameters
/// ----------
/// path : path-like
///     The camera file (TOML).
/// error : float, optional
///     Requested error of the exposure: rms over the pixels, relative to the mean. Without it and ``samples``: 0.005.
/// samples : int, optional
///     Rays through every pixel instead.
/// seed : int
///     Chooses the sample sequence and the sensor's noise.
/// ambient_bounces : int
///     Number of diffuse interreflections.
/// threads : int, optional
///     All cores if not given.
#[pyclass(frozen, module = "radsight")]
pub(crate) struct Capture {
    pub(crate) capture: radsight::Capture,
    pub(crate) threads: Option<usize>,
    /// The camera file, and the files that it names.
    text: Text,
    files: Files,
    options: CaptureOptions,
}

/// The error where neither it nor a number of samples is given.
const DEFAULT_ERROR: f64 = 0.005;

/// The options of a capture, as they were given.
#[derive(Clone, Copy)]
struct CaptureOptions {
    /// Relative error of the exposure, if one was given.
    error: Option<f64>,
    /// Rays through every pixel, instead of an error.
    samples: Option<u32>,
    seed: u64,
    ambient_bounces: u32,
}

impl CaptureOptions {
    fn apply_to(&self, capture: radsight::Capture) -> radsight::Capture {
        let mut capture = capture.error(self.error.unwrap_or(DEFAULT_ERROR)).seed(self.seed);
        if let Some(samples) = self.samples {
            capture = capture.samples(samples);
        }
        capture.options_mut().ambient_bounces = self.ambient_bounces;
        capture
    }

    /// As keyword arguments of `Capture.from_text`.
    fn keywords<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let keywords = PyDict::new(py);
        keywords.set_item("error", self.error)?;
        keywords.set_item("samples", self.samples)?;
        keywords.set_item("seed", self.seed)?;
        keywords.set_item("ambient_bounces", self.ambient_bounces)?;
        Ok(keywords)
    }
}

impl Capture {
    fn read(
        text: Text,
        loader: RecordingLoader<impl Loader>,
        options: CaptureOptions,
        threads: Option<usize>,
    ) -> PyResult<Capture> {
        if options.error.is_some() && options.samples.is_some() {
            return Err(RadsightError::new_err("both error and samples are given, expected one"));
        }
        let capture = radsight::Capture::from_text(&text.0, &text.1, &loader).map_err(exception)?;
        let capture = options.apply_to(capture);
        Ok(Capture { capture, threads, text, files: loader.named_files().into_iter().collect(), options })
    }

    /// A scene of this camera's: a `Scene`, or files, with the light ring.
    fn lit(&self, py: Python<'_>, scenes: &Bound<'_, PyTuple>) -> PyResult<Scene> {
        let scene = match scenes.extract::<(Bound<'_, Scene>,)>() {
            Ok((scene,)) => scene,
            Err(_) => {
                let (texts, loader) = texts_of(&scenes.extract::<Vec<PathBuf>>()?)?;
                return self.read_lit(py, texts, loader);
            }
        };
        self.with_ring(py, &scene)
    }

    /// The light ring as scene text.
    fn ring(&self) -> Option<Text> {
        let rig = self.capture.camera_file().rig.as_ref()?;
        Some(("<light ring>".to_owned(), rig.scene_text().into_bytes()))
    }

    fn read_lit(&self, py: Python<'_>, mut texts: Vec<Text>, loader: FileLoader) -> PyResult<Scene> {
        texts.extend(self.ring());
        Scene::read(py, texts, (Files::new(), loader), Materials::new())
    }
}

#[pymethods]
impl Capture {
    #[new]
    #[pyo3(signature = (path, *, error=None, samples=None, seed=0, ambient_bounces=0, threads=None))]
    fn new(
        path: PathBuf,
        error: Option<f64>,
        #[pyo3(from_py_with = whole_argument::optional::samples)] samples: Option<u32>,
        #[pyo3(from_py_with = whole_argument::seed)] seed: u64,
        #[pyo3(from_py_with = whole_argument::ambient_bounces)] ambient_bounces: u32,
        #[pyo3(from_py_with = whole_argument::optional::threads)] threads: Option<usize>,
    ) -> PyResult<Capture> {
        let loader = FileLoader::default();
        let loaded = loader.load(&path.display().to_string(), FileKind::Other);
        let loaded = loaded.map_err(|error| exception(error.into()))?;
        let options = CaptureOptions { error, samples, seed, ambient_bounces };
        Capture::read((loaded.path, loaded.bytes), RecordingLoader::new(loader), options, threads)
    }

    /// Read the text of a camera file.
    ///
    /// Parameters
    /// ----------
    /// text : str
    ///     In TOML.
    /// name : str
    ///     For messages; files that the text names are looked for beside it.
    /// files : dict of str to bytes, optional
    ///     Files that it names, instead of those of the disk.
    /// error : float, optional
    ///     Requested error of the exposure: rms over the pixels, relative to the mean. Without it and ``samples``: 0.005.
    /// samples : int, optional
    ///     Rays through every pixel instead.
    /// seed : int
    ///     Chooses the sample sequence and the sensor's noise.
    /// ambient_bounces : int
    ///     Number of diffuse interreflections.
    /// threads : int, optional
    ///     All cores if not given.
    ///
    /// Returns
    /// -------
    /// Capture
    ///     A camera as from a file.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     With every mistake in the text: line, caret and hint.
    #[staticmethod]
    #[pyo3(signature = (text, *, name="<text>", files=None, error=None, samples=None, seed=0, ambient_bounces=0, threads=None))]
    #[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn from_text(
        text: &str,
        name: &str,
        files: Option<Files>,
        error: Option<f64>,
        #[pyo3(from_py_with = whole_argument::optional::samples)] samples: Option<u32>,
        #[pyo3(from_py_with = whole_argument::seed)] seed: u64,
        #[pyo3(from_py_with = whole_argument::ambient_bounces)] ambient_bounces: u32,
        #[pyo3(from_py_with = whole_argument::optional::threads)] threads: Option<usize>,
    ) -> PyResult<Capture> {
        let text = (name.to_owned(), text.as_bytes().to_vec());
        let options = CaptureOptions { error, samples, seed, ambient_bounces };
        match files {
            None => Capture::read(text, RecordingLoader::new(FileLoader::default()), options, threads),
            Some(files) => {
                let memory =
                    files.iter().fold(MemoryLoader::default(), |memory, (name, bytes)| memory.with(name, bytes));
                Capture::read(text, RecordingLoader::new(memory), options, threads)
            }
        }
    }

    /// Expose the camera to scenes, with its light ring.
    ///
    /// Parameters
    /// ----------
    /// *scenes : Scene, or path-like
    ///     One scene, or files.
    /// progress : callable, optional
    ///     Called with the finished fraction, 0 to 1, about twenty times a second and at the end. An exception in it stops the work.
    ///
    /// Returns
    /// -------
    /// CapturedImage
    ///     Exposures, their errors and grey values.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     With every mistake in the files.
    #[pyo3(signature = (*scenes, progress=None))]
    fn expose(
        &self,
        py: Python<'_>,
        scenes: &Bound<'_, PyTuple>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<CapturedImage> {
        let begun = Instant::now();
        let scene = self.lit(py, scenes)?;
        let exposed = supervised(py, scene.threads(self.threads), progress, &scene.raised, |watch: &Watch| {
            let image = self.capture.expose_with_progress(&scene.scene, watch)?;
            Ok(CapturedImage::new(image, self.capture.clone(), begun.elapsed().as_secs_f64()))
        })?;
        exposed.map_err(exception)
    }

    /// A scene with the camera's light ring.
    ///
    /// Parameters
    /// ----------
    /// scene : Scene
    ///     Stays as it is.
    ///
    /// Returns
    /// -------
    /// Scene
    ///     For `Renderer.run_job` with this camera.
    fn with_ring(&self, py: Python<'_>, scene: &Bound<'_, Scene>) -> PyResult<Scene> {
        let scene = scene.get();
        let mut texts = scene.texts.clone();
        texts.extend(self.ring());
        let materials = scene.materials.iter().map(|(name, object)| (name.clone(), object.clone_ref(py))).collect();
        Scene::read(py, texts, (scene.files.clone(), FileLoader::default()), materials)
    }

    /// The same camera with some keys of its file replaced or added.
    ///
    /// Parameters
    /// ----------
    /// keys : dict of str to str
    ///     Such as ``{"rig.ring_diameter_mm": "30"}``, the values as a camera file has them.
    ///
    /// Returns
    /// -------
    /// Capture
    ///     Another camera.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     If a key or value is wrong.
    pub(crate) fn with_keys(&self, keys: BTreeMap<String, String>) -> PyResult<Capture> {
        let mut text = String::from_utf8_lossy(&self.text.1).into_owned();
        for (key, value) in &keys {
            let refused = |error| RadsightError::new_err(format!("key \"{key}\": {error}"));
            text = with_key(&text, key, value).map_err(refused)?;
        }
        let loader = RecordingLoader::new(files_first(&self.files, FileLoader::default()));
        Capture::read((self.text.0.clone(), text.into_bytes()), loader, self.options, self.threads)
    }

    /// The same camera with another number of threads.
    ///
    /// Parameters
    /// ----------
    /// threads : int or None
    ///     All cores if ``None``.
    ///
    /// Returns
    /// -------
    /// Capture
    ///     It gives the same bits.
    fn with_threads(
        &self,
        #[pyo3(from_py_with = whole_argument::optional::threads)] threads: Option<usize>,
    ) -> Capture {
        let Capture { capture, text, files, options, .. } = self;
        Capture { capture: capture.clone(), threads, text: text.clone(), files: files.clone(), options: *options }
    }

    /// The sensor.
    ///
    /// Raises
    /// ------
    /// RadsightError
    ///     If the camera file has none.
    #[getter]
    fn sensor(&self) -> PyResult<Sensor> {
        Sensor::of(&self.capture)
    }

    /// Pixels in a row, and rows.
    #[getter]
    fn size(&self) -> (u32, u32) {
        let camera = &self.capture.camera_file().camera;
        (camera.columns(), camera.rows())
    }

    /// One line that describes the camera.
    #[getter]
    fn summary(&self) -> String {
        self.capture.camera_file().summary()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let files = PyDict::new(py);
        for (name, bytes) in &self.files {
            files.set_item(name, PyBytes::new(py, bytes))?;
        }
        let again = py.import("radsight._pickle")?.getattr("capture")?;
        let text = PyBytes::new(py, &self.text.1);
        let options = self.options.keywords(py)?;
        options.set_item("threads", self.threads)?;
        Ok((again, (&self.text.0, text, files, options).into_pyobject(py)?))
    }

    fn __repr__(&self) -> String {
        let (columns, rows) = self.size();
        format!("<radsight.Capture {columns} × {rows}>")
    }
}

impl CapturedImage {
    pub(crate) fn new(image: radsight::CapturedImage, capture: radsight::Capture, seconds: f64) -> CapturedImage {
        // Without a sensor there are no grey values.
        let greys = image.greys(&capture).ok();
        CapturedImage { image, greys, capture, seconds }
    }

    /// Rows and columns.
    fn shape(&self) -> [usize; 2] {
        [self.image.rows, self.image.columns]
    }
}

/// An exposed picture.
#[pyclass(frozen, module = "radsight")]
pub(crate) struct CapturedImage {
    image: radsight::CapturedImage,
    greys: Option<Vec<u16>>,
    /// The camera that exposed it.
    capture: radsight::Capture,
    /// Time that reading the scene and exposing took.
    seconds: f64,
}

#[pymethods]
impl CapturedImage {
    /// Exposure of each pixel, J/m²: (rows, columns), a read-only view.
    #[getter]
    fn exposure_j_per_m2<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        array_view(slf, slf.get().shape(), |captured| &captured.image.exposure_j_per_m2)
    }

    /// The sensor's grey values: (rows, columns), a read-only view.
    ///
    /// Raises
    /// ------
    /// RadsightError
    ///     If the camera file has no sensor.
    #[getter]
    fn grey<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<u16>>> {
        if slf.get().greys.is_none() {
            return Err(exception(radsight::Error::NoSensor));
        }
        array_view(slf, slf.get().shape(), |captured| captured.greys.as_deref().unwrap_or_default())
    }

    /// Whether the camera file has a sensor, and thus grey values.
    #[getter]
    fn has_sensor(&self) -> bool {
        self.greys.is_some()
    }

    /// Estimated rms error of the pixels, relative to the mean exposure.
    #[getter]
    fn estimated_error(&self) -> Option<f64> {
        self.image.estimated_error
    }

    /// Number of camera rays.
    #[getter]
    fn rays(&self) -> u64 {
        self.image.rays
    }

    /// Standard error of each pixel, J/m²: (rows, columns), a read-only view; ``None`` where it was not estimated.
    #[getter]
    fn standard_error_j_per_m2<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        if slf.get().image.pixels.is_none() {
            return Ok(None);
        }
        let errors = array_view(slf, slf.get().shape(), |captured| {
            captured.image.pixels.as_ref().map_or(&[], |pixels| &pixels.standard_errors)
        });
        errors.map(Some)
    }

    /// One HTML page that loads nothing: exposure, false colour, error, grey values, time, what was skipped, settings.
    ///
    /// Parameters
    /// ----------
    /// title : str
    ///     Heading of the page.
    ///
    /// Returns
    /// -------
    /// str
    ///     The page.
    #[pyo3(signature = (title="radsight"))]
    fn report_html(&self, py: Python<'_>, title: &str) -> PyResult<String> {
        py.detach(|| {
            let name = "scene read and exposed".to_owned();
            let stage = Stage { name, elapsed_s: self.seconds, processor_s: None };
            Ok(self.image.report_page(&self.capture, title)?.stage(stage).to_html())
        })
        .map_err(exception)
    }

    fn _repr_png_(&self) -> Option<Vec<u8>> {
        png::false_color(self.image.columns, &self.image.exposure_j_per_m2, "J/m2")
    }

    fn __repr__(&self) -> String {
        format!("<radsight.CapturedImage {} × {}>", self.image.columns, self.image.rows)
    }
}
