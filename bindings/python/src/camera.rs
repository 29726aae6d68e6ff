//! Cameras written in Python.

use crate::array_argument::{as_doubles, shape_text};
use crate::supervise::Raised;
use glam::DVec3;
use numpy::ndarray::ArrayView1;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use radsight::CameraRay;

/// A Python object with `rays(film, aperture)`.
pub(crate) struct PythonCamera {
    /// Of its class.
    name: String,
    object: Py<PyAny>,
    raised: Raised,
}

impl PythonCamera {
    pub(crate) fn new(py: Python<'_>, object: Py<PyAny>, raised: &Raised) -> PyResult<PythonCamera> {
        let name = object.bind(py).get_type().name()?.to_string();
        if !object.bind(py).hasattr("rays")? {
            return Err(PyValueError::new_err(format!("camera {name} has no method rays(film, aperture)")));
        }
        Ok(PythonCamera { name, object, raised: raised.clone() })
    }

    fn asked(&self, py: Python<'_>, film: &[[f64; 2]], aperture: &[[f64; 2]]) -> PyResult<Vec<Option<CameraRay>>> {
        let points = |points: &[[f64; 2]]| PyArray1::from_slice(py, points.as_flattened()).reshape([points.len(), 2]);
        let given = self.object.bind(py).call_method1("rays", (points(film)?, points(aperture)?))?;
        let array = as_doubles(&given).map_err(|found| self.wrong(&format!("gave {found}, expected an array")))?;
        let count = film.len();
        if ![[count, 6], [count, 7]].iter().any(|shape| array.shape() == shape) {
            let found = shape_text(array.shape());
            return Err(self.wrong(&format!(
                "gave an array of shape {found}, expected ({count}, 6), origin and direction, or ({count}, 7) with weights"
            )));
        }
        let given = array.cast_into::<PyArray2<f64>>()?.try_readonly()?;
        let rows = given.as_array();
        rows.rows().into_iter().zip(film).map(|(row, point)| self.ray_of(row, *point)).collect()
    }

    /// The ray of a row; `None` where the origin or the direction is NaN.
    fn ray_of(&self, row: ArrayView1<'_, f64>, [x, y]: [f64; 2]) -> PyResult<Option<CameraRay>> {
        let vector = |first: usize| DVec3::new(row[first], row[first + 1], row[first + 2]);
        let ray = CameraRay { origin: vector(0), direction: vector(3), weight: row.get(6).copied().unwrap_or(1.0) };
        if ray.origin.is_nan() || ray.direction.is_nan() {
            return Ok(None);
        }
        let is_ray = ray.origin.is_finite() && ray.direction.try_normalize().is_some();
        if is_ray && ray.weight.is_finite() {
            return Ok(Some(ray));
        }
        let numbers: Vec<String> = row.iter().map(f64::to_string).collect();
        Err(self.wrong(&format!(
            "gave ({}) for the film point ({x}, {y}), expected finite numbers and a direction, or NaN for no ray",
            numbers.join(", ")
        )))
    }

    fn wrong(&self, message: &str) -> PyErr {
        PyValueError::new_err(format!("camera {}: rays {message}", self.name))
    }
}

impl radsight::Camera for PythonCamera {
    fn ray(&self, film: [f64; 2], aperture: [f64; 2]) -> Option<CameraRay> {
        self.rays(&[film], &[aperture]).pop().flatten()
    }

    fn rays(&self, film: &[[f64; 2]], aperture: &[[f64; 2]]) -> Vec<Option<CameraRay>> {
        Python::attach(|py| self.asked(py, film, aperture)).unwrap_or_else(|error| {
            self.raised.set(error);
            vec![None; film.len()]
        })
    }
}
