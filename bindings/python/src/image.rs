//! Pictures.

use crate::array_view::array_view;
use crate::errors::exception;
use crate::png;
use numpy::{PyArray2, PyArray3};
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

impl Image {
    /// Rows and columns.
    fn shape(&self) -> [usize; 2] {
        [self.image.rows(), self.image.columns()]
    }
}

#[pymethods]
impl Image {
    /// Radiance, W/(sr·m²): (rows, columns, 3), top row first, a read-only view.
    #[getter]
    fn radiance_w_per_sr_m2<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let [rows, columns] = slf.get().shape();
        array_view(slf, [rows, columns, 3], |image| image.image.pixels().as_flattened())
    }

    /// Estimated relative noise of the pixels; ``None`` where it was not estimated.
    #[getter]
    fn error(&self) -> Option<f64> {
        self.image.report().error
    }

    /// The estimated error, and the skipped work.
    #[getter]
    fn report(&self) -> String {
        self.image.report().to_string()
    }

    /// Write a file: ``.hdr .exr .tif .pfm .npy .mtx .png``.
    ///
    /// Parameters
    /// ----------
    /// path : path-like
    ///     Its ending says the format.
    ///
    /// Raises
    /// ------
    /// RadsightError
    ///     If it cannot be written, or the ending is none of these.
    fn save(&self, path: PathBuf) -> PyResult<()> {
        self.image.save(path).map_err(exception)
    }

    /// Relative standard error of each pixel: (rows, columns), a read-only view; ``None`` where no error was requested.
    #[getter]
    fn relative_error<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, PyArray2<f32>>>> {
        if slf.get().image.relative_errors().is_none() {
            return Ok(None);
        }
        array_view(slf, slf.get().shape(), |image| image.image.relative_errors().unwrap_or_default()).map(Some)
    }

    /// Rays through each pixel: (rows, columns), a read-only view; ``None`` where pixels are interpolated.
    #[getter]
    fn samples<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, PyArray2<u32>>>> {
        if slf.get().image.samples().is_none() {
            return Ok(None);
        }
        array_view(slf, slf.get().shape(), |image| image.image.samples().unwrap_or_default()).map(Some)
    }

    /// One HTML page that loads nothing: values, false colour, error, time, what was skipped, settings.
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
    fn report_html(&self, py: Python<'_>, title: &str) -> String {
        py.detach(|| {
            let name = "rendering".to_owned();
            let stage = Stage { name, elapsed_s: self.seconds, processor_s: None };
            self.image.report_page(title).stage(stage).to_html()
        })
    }

    /// Show the luminance in false colour, at 179 lm/W, with its scale in cd/m².
    ///
    /// Returns
    /// -------
    /// bytes
    ///     A PNG.
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
