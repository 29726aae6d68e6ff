//! Rendering views and tracing rays.

use crate::camera::PythonCamera;
use crate::capture::Capture;
use crate::errors::{RadsightError, exception, wrong};
use crate::image::Image;
use crate::job::{JobResult, RenderJob};
use crate::scene::{Scene, View};
use crate::supervise::{Raised, Watch, stopped, supervised};
use crate::traced::{Asked, TracedRays, kept, rays_of};
use crate::whole_argument;
use numpy::{PyArray1, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use radsight::{ErrorBudget, TracedQuantity};
use std::time::Instant;

/// A scene that is ready to be rendered.
///
/// Parameters
/// ----------
/// scene : Scene
///     It is compiled once.
/// ambient_bounces : int
///     Number of diffuse interreflections (``-ab``).
/// ambient_accuracy : float
///     Target relative error of interpolated irradiance (``-aa``); 0 disables the cache.
/// ambient_divisions, ambient_super_samples : int
///     Rays of a cache point, and additional rays (``-ad``, ``-as``).
/// error : float, optional
///     Relative error of pictures, such as 0.02. Without it and ``samples``: a preview, as Radiance's defaults give.
/// samples : int, optional
///     Rays through every pixel.
/// seed : int
///     Chooses the sample sequence.
/// quantity : {"radiance", "irradiance", "surface_irradiance"}
///     Quantity that is computed: radiance along the rays, irradiance on a surface at their origin that faces their direction (``-I``), or
///     irradiance of the first surface (``-i``).
/// threads : int, optional
///     All cores if not given. Results do not depend on it.
/// irradiance_cache : bytes, optional
///     From `fill_irradiance_cache`; no records are added.
///
/// Raises
/// ------
/// RadsightError
///     If an option is out of its range, or both ``error`` and ``samples`` are given.
#[pyclass(module = "radsight")]
pub(crate) struct Renderer {
    renderer: radsight::Renderer,
    asked: Asked,
    threads: Option<usize>,
    /// Exceptions of materials in Python.
    raised: Raised,
}

#[pymethods]
impl Renderer {
    #[new]
    #[pyo3(signature = (scene, *, ambient_bounces=0, ambient_accuracy=0.2, ambient_divisions=512, ambient_super_samples=128, error=None, samples=None, seed=0, quantity="radiance", threads=None, irradiance_cache=None))]
    #[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn new(
        py: Python<'_>,
        scene: &Scene,
        #[pyo3(from_py_with = whole_argument::ambient_bounces)] ambient_bounces: u32,
        ambient_accuracy: f64,
        #[pyo3(from_py_with = whole_argument::ambient_divisions)] ambient_divisions: u32,
        #[pyo3(from_py_with = whole_argument::ambient_super_samples)] ambient_super_samples: u32,
        error: Option<f64>,
        #[pyo3(from_py_with = whole_argument::optional::samples)] samples: Option<u32>,
        #[pyo3(from_py_with = whole_argument::seed)] seed: u64,
        quantity: &str,
        #[pyo3(from_py_with = whole_argument::optional::threads)] threads: Option<usize>,
        irradiance_cache: Option<Vec<u8>>,
    ) -> PyResult<Renderer> {
        let budget = match (error, samples) {
            (Some(_), Some(_)) => return Err(RadsightError::new_err("both error and samples are given, expected one")),
            (Some(error), None) => ErrorBudget::error(error),
            (None, Some(samples)) => ErrorBudget::samples(samples),
            (None, None) => ErrorBudget::default(),
        };
        if !(ambient_accuracy >= 0.0 && ambient_accuracy.is_finite()) {
            return Err(wrong("ambient_accuracy", ambient_accuracy, "0 or more"));
        }
        let (quantity, asked) = match quantity {
            "radiance" => (TracedQuantity::Radiance, Asked::Radiance),
            "irradiance" => (TracedQuantity::Irradiance, Asked::Irradiance),
            "surface_irradiance" => (TracedQuantity::SurfaceIrradiance, Asked::Irradiance),
            other => return Err(wrong("quantity", other, "radiance, irradiance or surface_irradiance")),
        };
        let renderer = py.detach(|| radsight::Renderer::new(&scene.scene)).map_err(exception)?;
        let mut renderer = renderer
            .ambient_bounces(ambient_bounces)
            .ambient_accuracy(ambient_accuracy)
            .ambient_divisions(ambient_divisions, ambient_super_samples)
            .seed(seed)
            .budget(budget);
        renderer.options_mut().quantity = quantity;
        if let Some(cache) = irradiance_cache {
            renderer.only_irradiance_cache(cache);
        }
        Ok(Renderer { renderer, asked, threads: scene.threads(threads), raised: scene.raised.clone() })
    }

    /// Render a view within a size; the picture has the view's own proportions.
    ///
    /// Parameters
    /// ----------
    /// view : View
    ///     The view.
    /// columns, rows : int
    ///     The picture's size at most.
    /// progress : callable, optional
    ///     Called with the finished fraction, 0 to 1, about twenty times a second and at the end. An exception in it stops the work.
    ///
    /// Returns
    /// -------
    /// Image
    ///     Radiances, W/(sr·m²).
    #[pyo3(signature = (view, columns, rows, progress=None))]
    fn render(
        &mut self,
        py: Python<'_>,
        view: &View,
        #[pyo3(from_py_with = whole_argument::columns)] columns: usize,
        #[pyo3(from_py_with = whole_argument::rows)] rows: usize,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Image> {
        let renderer = &mut self.renderer;
        let begun = Instant::now();
        let image = supervised(py, self.threads, progress, &self.raised, |watch: &Watch| {
            renderer.render_with_progress(&view.0, columns, rows, watch)
        })?;
        let image = image.map_err(exception)?.ok_or_else(stopped)?;
        Ok(Image { image, seconds: begun.elapsed().as_secs_f64() })
    }

    /// Render the picture of a custom camera, to ``error`` or with ``samples`` rays per pixel (16 without both).
    ///
    /// Parameters
    /// ----------
    /// camera : Camera
    ///     Its ``rays(film, aperture)`` is called with many points at once.
    /// columns, rows : int
    ///     The picture's size.
    /// progress : callable, optional
    ///     Called with the finished fraction, 0 to 1.
    ///
    /// Returns
    /// -------
    /// Image
    ///     Radiances, W/(sr·m²).
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the camera gives rays of a wrong shape or without a direction; with its class, and what it gave.
    #[pyo3(signature = (camera, columns, rows, progress=None))]
    fn render_camera(
        &mut self,
        py: Python<'_>,
        camera: Py<PyAny>,
        #[pyo3(from_py_with = whole_argument::columns)] columns: usize,
        #[pyo3(from_py_with = whole_argument::rows)] rows: usize,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Image> {
        let camera = PythonCamera::new(py, camera, &self.raised)?;
        let renderer = &mut self.renderer;
        let begun = Instant::now();
        let image = supervised(py, self.threads, progress, &self.raised, |watch: &Watch| {
            renderer.render_camera_with_progress(&camera, columns, rows, watch)
        })?;
        let image = image.map_err(exception)?.ok_or_else(stopped)?;
        Ok(Image { image, seconds: begun.elapsed().as_secs_f64() })
    }

    /// Trace rays.
    ///
    /// Parameters
    /// ----------
    /// rays : (n, 6) array of float
    ///     Origin (scene units) and direction of each. An array of doubles is read in place.
    /// first : int
    ///     Index of the first ray if these are a part of a longer list; it determines the rays' random numbers.
    /// progress : callable, optional
    ///     Called with the finished fraction, 0 to 1.
    ///
    /// Returns
    /// -------
    /// TracedRays
    ///     The results, in the order of the rays.
    ///
    /// Raises
    /// ------
    /// RadsightError
    ///     If the rays have a wrong shape, or one has no direction or is not finite.
    #[pyo3(signature = (rays, *, first=0, progress=None))]
    fn trace(
        &mut self,
        py: Python<'_>,
        rays: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = whole_argument::first)] first: u64,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<TracedRays> {
        let rays = rays_of(rays)?;
        let renderer = &mut self.renderer;
        let traced = supervised(py, self.threads, progress, &self.raised, |watch: &Watch| {
            renderer.trace_part(first, &rays, kept, watch)
        })?;
        TracedRays::new(py, traced.map_err(exception)?.ok_or_else(stopped)?, self.asked)
    }

    /// Fill the irradiance cache for a list of rays, or for a whole job.
    ///
    /// Parameters
    /// ----------
    /// rays : (n, 6) array of float, optional
    ///     All rays, in the order of the list whose parts are traced later.
    /// job : RenderJob, optional
    ///     The whole job, with an ``ambient_accuracy``. For a job of rays all of them are given, too.
    /// progress : callable, optional
    ///     Called from time to time; an exception in it stops the work.
    ///
    /// Returns
    /// -------
    /// bytes or None
    ///     For ``Renderer(…, irradiance_cache=…)``, here or in another process. ``None`` if the options use no cache.
    #[pyo3(signature = (rays=None, *, job=None, progress=None))]
    fn fill_irradiance_cache<'py>(
        &mut self,
        py: Python<'py>,
        rays: Option<&Bound<'py, PyAny>>,
        job: Option<&RenderJob>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Option<Bound<'py, PyBytes>>> {
        if rays.is_none() && job.is_none() {
            return Err(RadsightError::new_err("expected rays, or a job"));
        }
        let rays = rays.map(rays_of).transpose()?.unwrap_or_default();
        let renderer = &mut self.renderer;
        let filled = supervised(py, self.threads, progress, &self.raised, |watch: &Watch| match job {
            Some(job) => renderer.irradiance_cache_for(&job.0, &rays, watch),
            None => renderer.irradiance_cache_of(&rays, watch),
        })?;
        Ok(filled.map_err(exception)?.map(|bytes| PyBytes::new(py, &bytes)))
    }

    /// Contributions of modifiers to each ray, as ``rcontrib`` computes them.
    ///
    /// Parameters
    /// ----------
    /// rays : (n, 6) array of float
    ///     Origin (scene units) and direction of each. An array of doubles is read in place.
    /// modifiers : sequence of str
    ///     Names of materials and lights.
    /// first : int
    ///     As in `trace`.
    /// progress : callable, optional
    ///     Called with the finished fraction, 0 to 1.
    ///
    /// Returns
    /// -------
    /// (n, m, 3) array of float
    ///     W/(sr·m²) by ray, modifier and band; W/m² with ``quantity="irradiance"``.
    #[pyo3(signature = (rays, modifiers, *, first=0, progress=None))]
    fn contributions<'py>(
        &mut self,
        py: Python<'py>,
        rays: &Bound<'py, PyAny>,
        modifiers: Vec<String>,
        #[pyo3(from_py_with = whole_argument::first)] first: u64,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let rays = rays_of(rays)?;
        let names: Vec<&str> = modifiers.iter().map(String::as_str).collect();
        let renderer = &mut self.renderer;
        let contributions = supervised(py, self.threads, progress, &self.raised, |watch: &Watch| {
            renderer.contributions_part(first, &rays, &names, watch)
        })?;
        let contributions = contributions.map_err(exception)?.ok_or_else(stopped)?;
        let values: Vec<f64> = contributions.iter().flatten().flat_map(|contribution| contribution.value).collect();
        PyArray1::from_vec(py, values).reshape([rays.len(), names.len(), 3])
    }

    /// Render the part of a job with the options of the job.
    ///
    /// Parameters
    /// ----------
    /// job : RenderJob
    ///     With its part.
    /// camera : Capture, optional
    ///     For the job of a capture; the scene has its light ring (`Capture.with_ring`).
    /// rays : (n, 6) array of float, optional
    ///     For a job of rays: all rays of the whole job.
    ///
    /// Returns
    /// -------
    /// JobResult
    ///     The part, for `MergedJob`.
    #[pyo3(signature = (job, *, camera=None, rays=None))]
    fn run_job<'py>(
        &mut self,
        py: Python<'py>,
        job: &RenderJob,
        camera: Option<&Capture>,
        rays: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<JobResult> {
        let rays = rays.map(rays_of).transpose()?.unwrap_or_default();
        let renderer = &mut self.renderer;
        let result = supervised(py, self.threads, None, &self.raised, |watch: &Watch| match camera {
            Some(camera) => camera.capture.run_job(renderer, &job.0, watch),
            None => renderer.run_job_with_progress(&job.0, &rays, watch),
        })?;
        result.map_err(exception)?.map(JobResult).ok_or_else(stopped)
    }
}
