//! Pictures.

use crate::errors::exception;
use crate::png;
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use radsight::Stage;
use std::path::PathBuf;

/// A picture of radiances.
#[pyclass(frozen, module = "radsight")]
pub(crate) struct Image {
    pub(crate) image: radsight::Image,
    /// Time that rendering took.
    pub(crate) seconds: f64,
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

    /// False colour of the luminance, 179 lm/W, with its scale: the bytes of a PNG.
    fn false_color_png(&self) -> Option<Vec<u8>> {
        let [red, green, blue] = [47.4, 119.9, 11.6];
        let luminance = |pixel: &[f32; 3]| red * pixel[0] + green * pixel[1] + blue * pixel[2];
        let values: Vec<f64> = self.image.pixels().iter().map(|pixel| f64::from(luminance(pixel))).collect();
        png::false_color(self.image.columns(), &values, "cd/m2")
    }

    fn _repr_png_(&self) -> Option<Vec<u8>> {
        png::of_radiance(self.image.columns(), self.image.pixels())
    }

    fn __repr__(&self) -> String {
        format!("<radsight.Image {} × {}>", self.image.columns(), self.image.rows())
    }
}
