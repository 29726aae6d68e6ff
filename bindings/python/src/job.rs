//! Parts of pictures and captures for other processes.

use crate::errors::exception;
use numpy::{PyArray1, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use radsight::JobTarget;

use crate::scene::View;

/// What is rendered, how exactly, and which rows of it: plain data, which can be pickled and is JSON for ``radsight job``.
///
/// Parameters
/// ----------
/// samples : int
///     Rays through every pixel; a power of two converges fastest.
/// view : View, optional
///     For a picture within ``columns`` and ``rows``.
/// columns, rows : int
/// camera : str, optional
///     For a capture instead: the name of the camera file.
/// scenes : sequence of str
///     The scene's files, for ``radsight job run``.
/// seed : int
/// ambient_bounces : int
///     Diffuse interreflections that are followed, path by path.
#[pyclass(frozen, module = "radsight")]
pub(crate) struct RenderJob(pub(crate) radsight::RenderJob);

#[pymethods]
impl RenderJob {
    #[new]
    #[pyo3(signature = (*, samples, view=None, columns=0, rows=0, camera=None, scenes=vec![], seed=0, ambient_bounces=0))]
    #[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn new(
        samples: u32,
        view: Option<&View>,
        columns: usize,
        rows: usize,
        camera: Option<String>,
        scenes: Vec<String>,
        seed: u64,
        ambient_bounces: u32,
    ) -> PyResult<RenderJob> {
        let target = match (view, camera) {
            (Some(view), None) => JobTarget::picture(&view.0, columns, rows),
            (None, Some(camera)) => JobTarget::capture(camera),
            _ => return Err(crate::errors::RadsightError::new_err("expected either a view or a camera")),
        };
        let job = radsight::RenderJob { scenes, seed, ambient_bounces, ..radsight::RenderJob::new(target, samples) };
        RenderJob::from_json(&job.to_json(), "<job>")
    }

    /// Read what `to_json` wrote.
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

    /// The job as JSON, as ``radsight job`` reads it.
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
    fn rows(&self) -> Option<(usize, usize)> {
        self.0.rows.clone().map(|rows| (rows.start, rows.end))
    }

    /// Columns and rows of the whole picture; of a capture the camera knows them.
    #[getter]
    fn picture_size(&self) -> PyResult<(usize, usize)> {
        self.0.picture_size().map(|[columns, rows]| (columns, rows)).map_err(exception)
    }

    /// Jobs for at most so many parts, of a picture of ``rows`` rows.
    #[pyo3(signature = (parts, rows=None))]
    fn split(&self, parts: usize, rows: Option<usize>) -> PyResult<Vec<RenderJob>> {
        let rows = match rows {
            Some(rows) => rows,
            None => self.picture_size()?.1,
        };
        self.0.split(parts, rows).map(|jobs| jobs.into_iter().map(RenderJob).collect()).map_err(exception)
    }

    /// The same with other numbers of samples.
    fn with_samples(&self, samples: u32) -> PyResult<RenderJob> {
        RenderJob::from_json(&radsight::RenderJob { samples, ..self.0.clone() }.to_json(), "<job>")
    }

    fn __eq__(&self, other: &RenderJob) -> bool {
        self.0 == other.0
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((py.import("radsight._pickle")?.getattr("job")?, (self.to_json(),)))
    }

    fn __repr__(&self) -> String {
        match self.rows() {
            Some((first, end)) => format!("<radsight.RenderJob of rows {first} to {}>", end - 1),
            None => "<radsight.RenderJob of all rows>".to_owned(),
        }
    }
}

/// The pixels of some rows, with their standard errors. It can be pickled, and is a file of ``radsight job``.
#[pyclass(frozen, module = "radsight")]
pub(crate) struct JobResult(pub(crate) radsight::JobResult);

#[pymethods]
impl JobResult {
    /// Read the bytes of a file that ``radsight job run`` or `to_bytes` wrote.
    #[staticmethod]
    #[pyo3(signature = (data, name="<part>"))]
    fn from_bytes(data: &[u8], name: &str) -> PyResult<JobResult> {
        radsight::JobResult::from_bytes(name, data).map(JobResult).map_err(exception)
    }

    /// The bytes of a file that ``radsight job merge`` reads.
    fn to_bytes(&self) -> PyResult<Vec<u8>> {
        self.0.to_bytes().map_err(exception)
    }

    /// The job, with its rows.
    #[getter]
    fn job(&self) -> RenderJob {
        RenderJob(self.0.job.clone())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyAny>,))> {
        let bytes = pyo3::types::PyBytes::new(py, &self.to_bytes()?).into_any();
        Ok((py.import("radsight._pickle")?.getattr("result")?, (bytes,)))
    }

    fn __repr__(&self) -> String {
        format!("<radsight.JobResult of rows {} to {}>", self.0.rows().start, self.0.rows().end - 1)
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

    /// Radiance, W/(sr·m²), (rows, columns, 3); or exposure, J/m², (rows, columns, 1).
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        self.array(py, &self.0.values)
    }

    /// Estimated standard errors of the values; NaN where a part is missing, and with one sample.
    #[getter]
    fn standard_errors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        self.array(py, &self.0.standard_errors)
    }

    /// Estimated relative error of the rows that are there; ``None`` with one sample.
    #[getter]
    fn relative_error(&self) -> Option<f64> {
        self.0.relative_error()
    }

    /// Ranges of rows of which there is no part: the first row, and the one after the last.
    #[getter]
    fn missing_rows(&self) -> Vec<(usize, usize)> {
        self.0.missing_rows().into_iter().map(|rows| (rows.start, rows.end)).collect()
    }

    /// What was asked for, without rows.
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
    fn array<'py>(&self, py: Python<'py>, values: &[f32]) -> PyResult<Bound<'py, PyArray3<f32>>> {
        PyArray1::from_slice(py, values).reshape([self.0.size[1], self.0.size[0], self.0.components])
    }
}
