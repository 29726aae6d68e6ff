//! Captures.

use crate::errors::exception;
use crate::{png, run};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use radsight::Stage;
use std::path::PathBuf;
use std::time::Instant;

/// A camera file (camera, light ring, sensor), and how exactly it is to expose.
///
/// Parameters
/// ----------
/// path : path-like
///     The camera file (TOML).
/// error : float
///     Relative error of the exposure: rms over the pixels, as a share of the mean.
/// samples : int, optional
///     Rays through every pixel instead.
/// seed : int
///     Chooses the sample sequence and the sensor's noise.
/// ambient_bounces : int
///     Diffuse interreflections that are followed.
/// threads : int, optional
///     All cores if not given.
#[pyclass(frozen, module = "radsight")]
pub(crate) struct Capture {
    capture: radsight::Capture,
    threads: Option<usize>,
}

#[pymethods]
impl Capture {
    #[new]
    #[pyo3(signature = (path, *, error=0.005, samples=None, seed=0, ambient_bounces=0, threads=None))]
    fn new(
        path: PathBuf,
        error: f64,
        samples: Option<u32>,
        seed: u64,
        ambient_bounces: u32,
        threads: Option<usize>,
    ) -> PyResult<Capture> {
        let mut capture = radsight::Capture::load(path).map_err(exception)?.error(error).seed(seed);
        if let Some(samples) = samples {
            capture = capture.samples(samples);
        }
        capture.options_mut().ambient_bounces = ambient_bounces;
        Ok(Capture { capture, threads })
    }

    /// Expose the camera to scenes, with its light ring.
    ///
    /// Parameters
    /// ----------
    /// *scenes : path-like
    ///
    /// Returns
    /// -------
    /// CapturedImage
    #[pyo3(signature = (*scenes))]
    fn expose(&self, py: Python<'_>, scenes: &Bound<'_, PyTuple>) -> PyResult<CapturedImage> {
        let paths: Vec<PathBuf> = scenes.extract()?;
        let begun = Instant::now();
        let exposed = run(py, self.threads, || {
            let scene = radsight::Scene::builder().files(paths)?;
            let image = self.capture.expose(&self.capture.with_ring(scene).build()?)?;
            let greys = match image.greys(&self.capture) {
                Err(radsight::Error::NoSensor) => None,
                greys => Some(greys?),
            };
            let seconds = begun.elapsed().as_secs_f64();
            Ok(CapturedImage { image, greys, capture: self.capture.clone(), seconds })
        })?;
        exposed.map_err(exception)
    }
}

/// An exposed picture.
#[pyclass(frozen, module = "radsight")]
pub(crate) struct CapturedImage {
    image: radsight::CapturedImage,
    greys: Option<Vec<u16>>,
    /// What exposed it.
    capture: radsight::Capture,
    /// Time that reading the scene and exposing took.
    seconds: f64,
}

#[pymethods]
impl CapturedImage {
    /// Exposure of each pixel, J/m²: (rows, columns).
    #[getter]
    fn exposure_j_per_m2<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        PyArray1::from_slice(py, &self.image.exposure_j_per_m2).reshape([self.image.rows, self.image.columns])
    }

    /// The sensor's grey values: (rows, columns).
    #[getter]
    fn grey<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u16>>> {
        let greys = self.greys.as_ref().ok_or_else(|| exception(radsight::Error::NoSensor))?;
        PyArray1::from_slice(py, greys).reshape([self.image.rows, self.image.columns])
    }

    /// Estimated rms error over the pixels as a share of the mean exposure.
    #[getter]
    fn estimated_error(&self) -> Option<f64> {
        self.image.estimated_error
    }

    /// Rays that were traced from the camera.
    #[getter]
    fn rays(&self) -> u64 {
        self.image.rays
    }

    /// Standard error of each pixel, J/m²: (rows, columns); ``None`` where it was not estimated.
    #[getter]
    fn standard_error_j_per_m2<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let shape = [self.image.rows, self.image.columns];
        let pixels = self.image.pixels.as_ref();
        pixels.map(|pixels| PyArray1::from_slice(py, &pixels.standard_errors).reshape(shape)).transpose()
    }

    /// One HTML page that loads nothing: exposure, false colour, error, grey values, time, what was skipped, settings.
    ///
    /// Parameters
    /// ----------
    /// title : str
    ///
    /// Returns
    /// -------
    /// str
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
        let pixels: Vec<[f32; 3]> = self.image.exposure_j_per_m2.iter().map(|value| [*value as f32; 3]).collect();
        png::of_radiance(self.image.columns, &pixels)
    }

    fn __repr__(&self) -> String {
        format!("<radsight.CapturedImage {} × {}>", self.image.columns, self.image.rows)
    }
}
