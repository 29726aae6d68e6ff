//! Parts of pictures and captures for other processes.

use crate::array_view::array_view;
use crate::errors::{RadsightError, exception, wrong};
use numpy::{PyArray2, PyArray3};
use pyo3::exceptions::PyAttributeError;
use pyo3::prelude::*;
use radsight::{JobTarget, RayFormat, RayQuantity};
use std::ops::Range;

use crate::scene::View;
use crate::whole_argument;

/// A picture, capture or list of rays, its sampling, and the part to compute: plain data that can be pickled, and JSON for ``radsight job``.
///
/// Parameters
/// ----------
/// samples : int
///     Rays through every pixel; a power of two converges fastest. 1 for a job of rays.
/// view : View, optional
///     For a picture within ``columns`` and ``rows``.
/// columns, rows : int
///     The picture is within this size, in the view's own proportions.
/// camera : str, optional
///     For a capture instead: the name of the camera file.
/// rays : str, optional
///     For rays instead: the name of the text file with six numbers a ray.
/// quantity : str
///     Quantity that a job of rays computes: ``radiance``, ``irradiance`` or ``surface_irradiance``.
/// scenes : sequence of str
///     The scene's files, for ``radsight job run``.
/// seed : int
///     Chooses the sample sequence.
/// ambient_bounces : int
///     Number of diffuse interreflections.
/// ambient_accuracy : float
///     0 follows them path by path. With more all parts share an irradiance cache (`Renderer.fill_irradiance_cache`).
/// ambient_divisions, ambient_super_samples : int, optional
///     Rays of a cache point, and additional rays.
/// irradiance_cache : str, optional
///     The cache's file, for ``radsight job run``.
#[pyclass(frozen, module = "radsight")]
pub(crate) struct RenderJob(pub(crate) radsight::RenderJob);

#[pymethods]
impl RenderJob {
    #[new]
    #[pyo3(signature = (*, samples, view=None, columns=0, rows=0, camera=None, rays=None, quantity="radiance", scenes=vec![], seed=0, ambient_bounces=0, ambient_accuracy=0.0, ambient_divisions=None, ambient_super_samples=None, irradiance_cache=None))]
    #[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn new(
        #[pyo3(from_py_with = whole_argument::samples)] samples: u32,
        view: Option<&View>,
        #[pyo3(from_py_with = whole_argument::columns)] columns: usize,
        #[pyo3(from_py_with = whole_argument::rows)] rows: usize,
        camera: Option<String>,
        rays: Option<String>,
        quantity: &str,
        scenes: Vec<String>,
        #[pyo3(from_py_with = whole_argument::seed)] seed: u64,
        #[pyo3(from_py_with = whole_argument::ambient_bounces)] ambient_bounces: u32,
        ambient_accuracy: f64,
        #[pyo3(from_py_with = whole_argument::optional::ambient_divisions)] ambient_divisions: Option<u32>,
        #[pyo3(from_py_with = whole_argument::optional::ambient_super_samples)] ambient_super_samples: Option<u32>,
        irradiance_cache: Option<String>,
    ) -> PyResult<RenderJob> {
        let quantity = match quantity {
            "radiance" => RayQuantity::Radiance,
            "irradiance" => RayQuantity::Irradiance,
            "surface_irradiance" => RayQuantity::SurfaceIrradiance,
            other => return Err(wrong("quantity", other, "radiance, irradiance or surface_irradiance")),
        };
        let target = match (view, camera, rays) {
            (Some(view), None, None) => JobTarget::picture(&view.0, columns, rows),
            (None, Some(camera), None) => JobTarget::capture(camera),
            (None, None, Some(rays)) => JobTarget::Trace { rays, format: RayFormat::default(), quantity },
            _ => return Err(RadsightError::new_err("expected either a view, a camera or rays")),
        };
        let job = radsight::RenderJob {
            scenes,
            seed,
            ambient_bounces,
            ambient_accuracy,
            ambient_divisions,
            ambient_super_samples,
            irradiance_cache,
            ..radsight::RenderJob::new(target, samples)
        };
        RenderJob::from_json(&job.to_json(), "<job>")
    }

    /// Read what `to_json` wrote.
    ///
    /// Parameters
    /// ----------
    /// text : str
    ///     JSON.
    /// name : str
    ///     For messages.
    ///
    /// Returns
    /// -------
    /// RenderJob
    ///     The job.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     With line and caret.
    #[staticmethod]
    #[pyo3(signature = (text, name="<job>"))]
    fn from_json(text: &str, name: &str) -> PyResult<RenderJob> {
        radsight::RenderJob::from_json(name, text.as_bytes()).map(RenderJob).map_err(exception)
    }

    /// Write the job as ``radsight job`` reads it.
    ///
    /// Returns
    /// -------
    /// str
    ///     JSON.
    fn to_json(&self) -> String {
        self.0.to_json()
    }

    /// Rays through every pixel.
    #[getter]
    fn samples(&self) -> u32 {
        self.0.samples
    }

    /// The first row and the one after the last; ``None`` for all.
    #[getter]
    fn rows(&self) -> Option<Span> {
        self.0.rows.as_ref().map(span)
    }

    /// The first column and the one after the last; ``None`` for all.
    #[getter]
    fn columns(&self) -> Option<Span> {
        self.0.columns.as_ref().map(span)
    }

    /// The first ray and the one after the last; ``None`` for all.
    #[getter]
    fn rays(&self) -> Option<Span> {
        self.0.rays.as_ref().map(span)
    }

    /// Columns and rows of the whole picture; of a capture the camera knows them.
    #[getter]
    fn picture_size(&self) -> PyResult<(usize, usize)> {
        self.0.picture_size().map(|[columns, rows]| (columns, rows)).map_err(exception)
    }

    /// Jobs for at most `parts` parts, with about equal numbers of rows or rays.
    ///
    /// Parameters
    /// ----------
    /// parts : int
    ///     Maximum number of parts.
    /// size : (int, int), optional
    ///     Columns and rows of the whole picture, where the job does not know them: `Capture.size`, or (n, 1) for n rays.
    ///
    /// Returns
    /// -------
    /// list of RenderJob
    ///     Disjoint parts that together cover all pixels.
    #[pyo3(signature = (parts, size=None))]
    fn split(
        &self,
        #[pyo3(from_py_with = whole_argument::parts)] parts: usize,
        #[pyo3(from_py_with = whole_argument::size)] size: Option<[usize; 2]>,
    ) -> PyResult<Vec<RenderJob>> {
        jobs(self.0.split(parts, self.size(size)?))
    }

    /// Jobs for rectangles of at most `columns` by `rows` pixels.
    ///
    /// Parameters
    /// ----------
    /// columns, rows : int
    ///     Of a rectangle.
    /// size : (int, int), optional
    ///     As for `split`.
    ///
    /// Returns
    /// -------
    /// list of RenderJob
    ///     Disjoint parts that together cover all pixels.
    #[pyo3(signature = (columns, rows, size=None))]
    fn split_tiles(
        &self,
        #[pyo3(from_py_with = whole_argument::columns)] columns: usize,
        #[pyo3(from_py_with = whole_argument::rows)] rows: usize,
        #[pyo3(from_py_with = whole_argument::size)] size: Option<[usize; 2]>,
    ) -> PyResult<Vec<RenderJob>> {
        jobs(self.0.split_tiles([columns, rows], self.size(size)?))
    }

    /// Jobs for at most `rays` rays each.
    ///
    /// Parameters
    /// ----------
    /// rays : int
    ///     Of a job.
    /// all : int
    ///     Of all jobs.
    ///
    /// Returns
    /// -------
    /// list of RenderJob
    ///     In the order of the rays.
    fn split_rays(
        &self,
        #[pyo3(from_py_with = whole_argument::rays)] rays: usize,
        #[pyo3(from_py_with = whole_argument::all)] all: usize,
    ) -> PyResult<Vec<RenderJob>> {
        jobs(self.0.split_rays(rays, all))
    }

    /// The same job with another number of samples.
    ///
    /// Parameters
    /// ----------
    /// samples : int
    ///     Rays through every pixel.
    ///
    /// Returns
    /// -------
    /// RenderJob
    ///     Another job.
    fn with_samples(&self, #[pyo3(from_py_with = whole_argument::samples)] samples: u32) -> PyResult<RenderJob> {
        RenderJob::from_json(&radsight::RenderJob { samples, ..self.0.clone() }.to_json(), "<job>")
    }

    fn __eq__(&self, other: &RenderJob) -> bool {
        self.0 == other.0
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((py.import("radsight._pickle")?.getattr("job")?, (self.to_json(),)))
    }

    fn __repr__(&self) -> String {
        let part = |what: &str, range: Option<Span>| range.map(|(first, end)| format!("{what} {first} to {}", end - 1));
        let parts = [part("columns", self.columns()), part("rows", self.rows()), part("rays", self.rays())];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        match parts.is_empty() {
            true => "<radsight.RenderJob of all>".to_owned(),
            false => format!("<radsight.RenderJob of {}>", parts.join(", ")),
        }
    }
}

impl RenderJob {
    fn size(&self, given: Option<[usize; 2]>) -> PyResult<[usize; 2]> {
        given.map_or_else(|| self.0.picture_size().map_err(exception), Ok)
    }
}

fn jobs(split: Result<Vec<radsight::RenderJob>, radsight::Error>) -> PyResult<Vec<RenderJob>> {
    split.map(|jobs| jobs.into_iter().map(RenderJob).collect()).map_err(exception)
}

/// The first, and the one after the last.
type Span = (usize, usize);

fn span(range: &Range<usize>) -> Span {
    (range.start, range.end)
}

/// The pixels of a rectangle, or the values of a range of rays, with their standard errors. It can be pickled, and has the format of ``radsight job`` files.
#[pyclass(frozen, module = "radsight")]
pub(crate) struct JobResult(pub(crate) radsight::JobResult);

#[pymethods]
impl JobResult {
    /// Read what ``radsight job run`` or `to_bytes` wrote.
    ///
    /// Parameters
    /// ----------
    /// data : bytes
    ///     Content of the file.
    /// name : str
    ///     For messages.
    ///
    /// Returns
    /// -------
    /// JobResult
    ///     The part.
    ///
    /// Raises
    /// ------
    /// RadsightError
    ///     If it is no part of a picture.
    #[staticmethod]
    #[pyo3(signature = (data, name="<part>"))]
    fn from_bytes(data: &[u8], name: &str) -> PyResult<JobResult> {
        radsight::JobResult::from_bytes(name, data).map(JobResult).map_err(exception)
    }

    /// Write what ``radsight job merge`` reads.
    ///
    /// Returns
    /// -------
    /// bytes
    ///     A float matrix in Radiance's format.
    fn to_bytes(&self) -> PyResult<Vec<u8>> {
        self.0.to_bytes().map_err(exception)
    }

    /// The job, with its part.
    #[getter]
    fn job(&self) -> RenderJob {
        RenderJob(self.0.job.clone())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyAny>,))> {
        let bytes = pyo3::types::PyBytes::new(py, &self.to_bytes()?).into_any();
        Ok((py.import("radsight._pickle")?.getattr("result")?, (bytes,)))
    }

    fn __repr__(&self) -> String {
        self.job().__repr__().replace("RenderJob", "JobResult")
    }
}

/// A picture from the parts that are there; the others are black.
///
/// Parameters
/// ----------
/// parts : sequence of JobResult
///     In any order.
#[pyclass(frozen, module = "radsight")]
pub(crate) struct MergedJob(radsight::MergedJob);

#[pymethods]
impl MergedJob {
    #[new]
    fn new(parts: Vec<Bound<'_, JobResult>>) -> PyResult<MergedJob> {
        let parts: Vec<radsight::JobResult> = parts.iter().map(|part| part.get().0.clone()).collect();
        radsight::MergedJob::of(&parts).map(MergedJob).map_err(exception)
    }

    /// Radiance, irradiance or exposure, as the job has it: (rows, columns, 3), of an exposure (rows, columns, 1). A read-only view.
    #[getter]
    fn values<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        array_view(slf, slf.get().shape(), |merged| &merged.0.values)
    }

    /// Radiance, W/(sr·m²): (rows, columns, 3), a read-only view. Rays are one row.
    ///
    /// Raises
    /// ------
    /// AttributeError
    ///     If the job has another quantity.
    #[getter]
    fn radiance_w_per_sr_m2<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        slf.get().check("radiance_w_per_sr_m2")?;
        MergedJob::values(slf)
    }

    /// Irradiance, W/m²: (1, rays, 3), a read-only view.
    ///
    /// Raises
    /// ------
    /// AttributeError
    ///     If the job has another quantity.
    #[getter]
    fn irradiance_w_per_m2<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        slf.get().check("irradiance_w_per_m2")?;
        MergedJob::values(slf)
    }

    /// Exposure, J/m²: (rows, columns), a read-only view.
    ///
    /// Raises
    /// ------
    /// AttributeError
    ///     If the job has another quantity.
    #[getter]
    fn exposure_j_per_m2<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        slf.get().check("exposure_j_per_m2")?;
        let [rows, columns, _] = slf.get().shape();
        array_view(slf, [rows, columns], |merged| &merged.0.values)
    }

    /// Estimated standard errors of the values, a read-only view; NaN where a part is missing, and with one sample.
    #[getter]
    fn standard_errors<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        array_view(slf, slf.get().shape(), |merged| &merged.0.standard_errors)
    }

    /// Estimated relative error of the pixels that are there; ``None`` with one sample.
    #[getter]
    fn relative_error(&self) -> Option<f64> {
        self.0.relative_error()
    }

    /// Rectangles of which there is no part: (first column, the one after the last), (first row, the one after the last).
    #[getter]
    fn missing(&self) -> Vec<(Span, Span)> {
        self.0.missing().iter().map(|tile| (span(&tile.columns), span(&tile.rows))).collect()
    }

    /// The whole job, without a part.
    #[getter]
    fn job(&self) -> RenderJob {
        RenderJob(self.0.job.clone())
    }

    fn _repr_png_(&self) -> Option<Vec<u8>> {
        match self.0.components {
            1 => {
                let values: Vec<f64> = self.0.values.iter().map(|value| f64::from(*value)).collect();
                crate::png::false_color(self.0.size[0], &values, "J/m2")
            }
            _ => crate::png::of_radiance(self.0.size[0], self.0.values.as_chunks::<3>().0),
        }
    }
}

impl MergedJob {
    /// The attribute that has the values by their unit; `None` for a kind of job that is newer than this module.
    fn attribute(&self) -> Option<&'static str> {
        match &self.0.job.target {
            JobTarget::Capture { .. } => Some("exposure_j_per_m2"),
            JobTarget::Picture { .. } => Some("radiance_w_per_sr_m2"),
            JobTarget::Trace { quantity: RayQuantity::Radiance, .. } => Some("radiance_w_per_sr_m2"),
            JobTarget::Trace { .. } => Some("irradiance_w_per_m2"),
            _ => None,
        }
    }

    fn check(&self, wanted: &str) -> PyResult<()> {
        match self.attribute() {
            Some(attribute) if attribute == wanted => Ok(()),
            attribute => {
                let values = attribute.unwrap_or("values");
                Err(PyAttributeError::new_err(format!("the values of this job are {values}, not {wanted}")))
            }
        }
    }

    /// Rows, columns, components.
    fn shape(&self) -> [usize; 3] {
        [self.0.size[1], self.0.size[0], self.0.components]
    }
}
