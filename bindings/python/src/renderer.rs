//! Rendering views and tracing rays.

use crate::errors::{RadsightError, exception};
use crate::scene::{Scene, View};
use crate::{png, run};
use glam::DVec3;
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use radsight::Stage;
use radsight::{ErrorBudget, Ray};
use std::path::PathBuf;
use std::time::Instant;

/// A scene that is ready to be rendered.
///
/// Parameters
/// ----------
/// scene : Scene
/// ambient_bounces : int
///     Diffuse interreflections that are followed (``-ab``).
/// ambient_accuracy : float
///     Error at which interpolation of irradiance aims (``-aa``); 0 caches nothing.
/// ambient_divisions, ambient_super_samples : int
///     Rays of a cache point, and further ones (``-ad``, ``-as``).
/// error : float, optional
///     Relative error of pictures, such as 0.02. Without it and ``samples``: a preview, as Radiance's defaults give.
/// samples : int, optional
///     Rays through every pixel.
/// seed : int
///     Chooses the sample sequence.
/// threads : int, optional
///     All cores if not given. Results do not depend on it.
#[pyclass(module = "radsight")]
pub(crate) struct Renderer {
    renderer: radsight::Renderer,
    threads: Option<usize>,
}

#[pymethods]
impl Renderer {
    #[new]
    #[pyo3(signature = (scene, *, ambient_bounces=0, ambient_accuracy=0.2, ambient_divisions=512, ambient_super_samples=128, error=None, samples=None, seed=0, threads=None))]
    #[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn new(
        py: Python<'_>,
        scene: &Scene,
        ambient_bounces: u32,
        ambient_accuracy: f64,
        ambient_divisions: u32,
        ambient_super_samples: u32,
        error: Option<f64>,
        samples: Option<u32>,
        seed: u64,
        threads: Option<usize>,
    ) -> PyResult<Renderer> {
        let budget = match (error, samples) {
            (Some(_), Some(_)) => return Err(RadsightError::new_err("both error and samples are given, expected one")),
            (Some(error), None) => ErrorBudget::error(error),
            (None, Some(samples)) => ErrorBudget::samples(samples),
            (None, None) => ErrorBudget::default(),
        };
        if !(ambient_accuracy >= 0.0 && ambient_accuracy.is_finite()) {
            return Err(RadsightError::new_err(format!("ambient_accuracy is {ambient_accuracy}, expected 0 or more")));
        }
        let renderer = py.detach(|| radsight::Renderer::new(&scene.0)).map_err(exception)?;
        let renderer = renderer
            .ambient_bounces(ambient_bounces)
            .ambient_accuracy(ambient_accuracy)
            .ambient_divisions(ambient_divisions, ambient_super_samples)
            .seed(seed)
            .budget(budget);
        Ok(Renderer { renderer, threads })
    }

    /// Render a view within a size; the picture has the view's own proportions.
    ///
    /// Parameters
    /// ----------
    /// view : View
    /// columns, rows : int
    /// progress : callable, optional
    ///     Called with the share that is done, 0 to 1. An exception in it stops the work.
    ///
    /// Returns
    /// -------
    /// Image
    #[pyo3(signature = (view, columns, rows, progress=None))]
    fn render(
        &mut self,
        py: Python<'_>,
        view: &View,
        columns: usize,
        rows: usize,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Image> {
        let (renderer, threads) = (&mut self.renderer, self.threads);
        let mut raised = None;
        let mut hear = |done: f64| {
            let heard = Python::attach(|py| {
                py.check_signals()?;
                progress.as_ref().map_or(Ok(()), |progress| progress.call1(py, (done,)).map(drop))
            });
            raised = heard.err();
            raised.is_none()
        };
        let begun = Instant::now();
        let image = run(py, threads, || renderer.render_with_progress(&view.0, columns, rows, &mut hear))?;
        match (raised, image.map_err(exception)?) {
            (Some(error), _) => Err(error),
            (None, Some(image)) => Ok(Image { image, seconds: begun.elapsed().as_secs_f64() }),
            (None, None) => Err(RadsightError::new_err("the work was stopped")),
        }
    }

    /// Answer rays.
    ///
    /// Parameters
    /// ----------
    /// rays : (n, 6) array of float
    ///     Origin (scene units) and direction of each.
    ///
    /// Returns
    /// -------
    /// TracedRays
    fn trace(&mut self, py: Python<'_>, rays: PyReadonlyArray2<'_, f64>) -> PyResult<TracedRays> {
        let rays = rays_of(&rays)?;
        let (renderer, threads) = (&mut self.renderer, self.threads);
        run(py, threads, || renderer.trace(&rays))?.map(TracedRays).map_err(exception)
    }

    /// What each ray owes to modifiers of these names, as ``rcontrib`` finds it.
    ///
    /// Returns
    /// -------
    /// (n, m, 3) array of float
    ///     W/(sr·m²) by ray, modifier and band.
    fn contributions<'py>(
        &mut self,
        py: Python<'py>,
        rays: PyReadonlyArray2<'py, f64>,
        modifiers: Vec<String>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let rays = rays_of(&rays)?;
        let names: Vec<&str> = modifiers.iter().map(String::as_str).collect();
        let (renderer, threads) = (&mut self.renderer, self.threads);
        let owed = run(py, threads, || renderer.contributions(&rays, &names))?.map_err(exception)?;
        let values: Vec<f64> = owed.iter().flatten().flat_map(|owed| owed.value).collect();
        PyArray1::from_vec(py, values).reshape([rays.len(), names.len(), 3])
    }
}

fn rays_of(rays: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<Ray>> {
    let rays = rays.as_array();
    if rays.ncols() != 6 {
        return Err(RadsightError::new_err(format!(
            "rays have {} columns, expected 6: origin and direction",
            rays.ncols()
        )));
    }
    let ray = |(index, row): (usize, numpy::ndarray::ArrayView1<'_, f64>)| {
        let vector = |first: usize| DVec3::new(row[first], row[first + 1], row[first + 2]);
        Ray::new(vector(0), vector(3))
            .ok_or_else(|| RadsightError::new_err(format!("ray {index} has no direction, or is not finite")))
    };
    rays.rows().into_iter().enumerate().map(ray).collect()
}

/// What rays found.
#[pyclass(frozen, module = "radsight")]
pub(crate) struct TracedRays(Vec<radsight::Traced>);

impl TracedRays {
    fn vectors<'py>(
        &self,
        py: Python<'py>,
        of: impl Fn(&radsight::Traced) -> [f64; 3],
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        PyArray1::from_vec(py, self.0.iter().flat_map(of).collect()).reshape([self.0.len(), 3])
    }
}

#[pymethods]
impl TracedRays {
    /// Radiance of each ray in red, green and blue, W/(sr·m²): (n, 3).
    #[getter]
    fn radiance_w_per_sr_m2<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.vectors(py, |traced| traced.value)
    }

    /// Distance to the first surface, scene units; infinite for none: (n,).
    #[getter]
    fn distance<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let distance = |traced: &radsight::Traced| traced.first_hit.map_or(f64::INFINITY, |hit| hit.distance);
        PyArray1::from_vec(py, self.0.iter().map(distance).collect())
    }

    /// The first point, scene units; NaN for none: (n, 3).
    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.vectors(py, |traced| {
            let near = traced.first_hit.filter(|hit| hit.distance.is_finite());
            near.map_or([f64::NAN; 3], |hit| hit.point.to_array())
        })
    }

    /// The unit normal there with textures; NaN for none: (n, 3).
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.vectors(py, |traced| {
            let near = traced.first_hit.filter(|hit| hit.distance.is_finite());
            near.map_or([f64::NAN; 3], |hit| hit.perturbed_normal.to_array())
        })
    }

    fn __len__(&self) -> usize {
        self.0.len()
    }
}

/// A picture of radiances.
#[pyclass(frozen, module = "radsight")]
pub(crate) struct Image {
    image: radsight::Image,
    /// Time that rendering took.
    seconds: f64,
}

#[pymethods]
impl Image {
    /// Radiance, W/(sr·m²): (rows, columns, 3), top row first.
    #[getter]
    fn radiance_w_per_sr_m2<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let values = self.image.pixels().iter().flatten().copied().collect();
        PyArray1::from_vec(py, values).reshape([self.image.rows(), self.image.columns(), 3])
    }

    /// Estimated relative noise of the pixels; ``None`` where it was not estimated.
    #[getter]
    fn error(&self) -> Option<f64> {
        self.image.report().error
    }

    /// What is known of the error, and what was skipped.
    #[getter]
    fn report(&self) -> String {
        self.image.report().to_string()
    }

    /// Write a file: ``.hdr .exr .tif .pfm .npy .mtx .png``.
    fn save(&self, path: PathBuf) -> PyResult<()> {
        self.image.save(path).map_err(exception)
    }

    /// Standard error of each pixel as a share of its value: (rows, columns); ``None`` where no error was asked for.
    #[getter]
    fn relative_error<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f32>>>> {
        let shape = [self.image.rows(), self.image.columns()];
        self.image.relative_errors().map(|errors| PyArray1::from_slice(py, errors).reshape(shape)).transpose()
    }

    /// Rays through each pixel: (rows, columns); ``None`` where pixels are interpolated.
    #[getter]
    fn samples<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<u32>>>> {
        let shape = [self.image.rows(), self.image.columns()];
        self.image.samples().map(|samples| PyArray1::from_slice(py, samples).reshape(shape)).transpose()
    }

    /// One HTML page that loads nothing: values, false colour, error, time, what was skipped, settings.
    ///
    /// Parameters
    /// ----------
    /// title : str
    ///
    /// Returns
    /// -------
    /// str
    #[pyo3(signature = (title="radsight"))]
    fn report_html(&self, py: Python<'_>, title: &str) -> String {
        py.detach(|| {
            let name = "rendering".to_owned();
            let stage = Stage { name, elapsed_s: self.seconds, processor_s: None };
            self.image.report_page(title).stage(stage).to_html()
        })
    }

    fn _repr_png_(&self) -> Option<Vec<u8>> {
        png::of_radiance(self.image.columns(), self.image.pixels())
    }

    fn __repr__(&self) -> String {
        format!("<radsight.Image {} × {}>", self.image.columns(), self.image.rows())
    }
}
