//! Results of rays, and arrays of rays.

use crate::array_argument::{array_argument, wrong_shape};
use crate::errors::RadsightError;
use glam::DVec3;
use numpy::ndarray::{ArrayView1, Ix2};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyAttributeError;
use pyo3::prelude::*;
use pyo3::types::PySlice;
use radsight::Ray;

/// Numbers that are kept of a ray: radiance, distance, point, normal.
const NUMBERS: usize = 10;

/// Results of rays. The arrays are views of one array.
#[pyclass(frozen, module = "radsight")]
pub(crate) struct TracedRays {
    /// A row for each ray.
    numbers: Py<PyArray2<f64>>,
    asked: Asked,
}

/// The unit of the traced quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Asked {
    /// W/(sr·m²).
    Radiance,
    /// W/m².
    Irradiance,
}

/// The stored numbers of a result.
pub(crate) fn kept(traced: radsight::Traced) -> [f64; NUMBERS] {
    let distance = traced.first_hit.map_or(f64::INFINITY, |hit| hit.distance);
    let near = traced.first_hit.filter(|hit| hit.distance.is_finite());
    let [point, normal] = near.map_or([DVec3::NAN; 2], |hit| [hit.point, hit.perturbed_normal]);
    let [red, green, blue] = traced.value;
    [red, green, blue, distance, point.x, point.y, point.z, normal.x, normal.y, normal.z]
}

impl TracedRays {
    /// The vector's memory becomes the array's.
    pub(crate) fn new(py: Python<'_>, rays: Vec<[f64; NUMBERS]>, asked: Asked) -> PyResult<TracedRays> {
        let count = rays.len();
        let array = PyArray1::from_vec(py, rays.into_flattened()).reshape([count, NUMBERS])?;
        Ok(TracedRays { numbers: array.unbind(), asked })
    }

    fn values<'py>(&self, py: Python<'py>, wanted: Asked) -> PyResult<Bound<'py, PyAny>> {
        match (self.asked, wanted) {
            (Asked::Irradiance, Asked::Radiance) => Err(PyAttributeError::new_err(
                "irradiance was traced: it has irradiance_w_per_m2, not radiance_w_per_sr_m2",
            )),
            (Asked::Radiance, Asked::Irradiance) => Err(PyAttributeError::new_err(
                "radiance was traced: it has radiance_w_per_sr_m2, not irradiance_w_per_m2",
            )),
            _ => self.columns(py, 0, 3),
        }
    }

    fn columns<'py>(&self, py: Python<'py>, first: usize, end: usize) -> PyResult<Bound<'py, PyAny>> {
        let columns = PySlice::new(py, first as isize, end as isize, 1);
        self.numbers.bind(py).as_any().get_item((PySlice::full(py), columns))
    }
}

#[pymethods]
impl TracedRays {
    /// Radiance of each ray in red, green and blue, W/(sr·m²): (n, 3).
    ///
    /// Raises
    /// ------
    /// AttributeError
    ///     If irradiance was traced.
    #[getter]
    fn radiance_w_per_sr_m2<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.values(py, Asked::Radiance)
    }

    /// Irradiance in red, green and blue, W/m²: (n, 3).
    ///
    /// Raises
    /// ------
    /// AttributeError
    ///     If radiance was traced.
    #[getter]
    fn irradiance_w_per_m2<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.values(py, Asked::Irradiance)
    }

    /// Distance to the first surface, scene units; infinite for none: (n,).
    #[getter]
    fn distance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.numbers.bind(py).as_any().get_item((PySlice::full(py), 3))
    }

    /// The first point, scene units; NaN for none: (n, 3).
    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.columns(py, 4, 7)
    }

    /// The unit normal there with textures; NaN for none: (n, 3).
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.columns(py, 7, 10)
    }

    fn __len__(&self, py: Python<'_>) -> usize {
        self.numbers.bind(py).dims()[0]
    }
}

/// The rays of an argument: checked, and of unit direction.
pub(crate) fn rays_of(given: &Bound<'_, PyAny>) -> PyResult<Vec<Ray>> {
    const SHAPE: &str = "(n, 6): origin and direction of each";
    let rays = array_argument::<Ix2>("rays", given, SHAPE)?;
    let rays = rays.as_array();
    if rays.ncols() != 6 {
        return Err(wrong_shape("rays", rays.shape(), SHAPE));
    }
    let ray = |(index, row): (usize, ArrayView1<'_, f64>)| {
        let vector = |first: usize| DVec3::new(row[first], row[first + 1], row[first + 2]);
        Ray::new(vector(0), vector(3))
            .ok_or_else(|| RadsightError::new_err(format!("ray {index} has no direction, or is not finite")))
    };
    rays.rows().into_iter().enumerate().map(ray).collect()
}
