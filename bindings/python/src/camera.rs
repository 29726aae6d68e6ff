//! Cameras written in Python.

use crate::material::as_array;
use crate::supervise::Raised;
use glam::DVec3;
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use radsight::CameraRay;

/// A Python object with `rays(film, aperture)`.
pub(crate) struct PythonCamera {
    object: Py<PyAny>,
    raised: Raised,
}

impl PythonCamera {
    pub(crate) fn new(py: Python<'_>, object: Py<PyAny>, raised: &Raised) -> PyResult<PythonCamera> {
        if !object.bind(py).hasattr("rays")? {
            let kind = object.bind(py).get_type().name()?;
            return Err(PyValueError::new_err(format!("camera {kind} has no method rays(film, aperture)")));
        }
        Ok(PythonCamera { object, raised: raised.clone() })
    }

    fn asked(&self, py: Python<'_>, film: &[[f64; 2]], aperture: &[[f64; 2]]) -> PyResult<Vec<Option<CameraRay>>> {
        let points = |points: &[[f64; 2]]| PyArray1::from_slice(py, points.as_flattened()).reshape([points.len(), 2]);
        let given = self.object.bind(py).call_method1("rays", (points(film)?, points(aperture)?))?;
        let given: PyReadonlyArray2<'_, f64> = as_array(py, &given)?.extract()?;
        let given = given.as_array();
        if given.nrows() != film.len() {
            return Err(PyValueError::new_err(format!("rays gave {} rays, expected {}", given.nrows(), film.len())));
        }
        if ![6, 7].contains(&given.ncols()) {
            return Err(PyValueError::new_err(format!(
                "rays gave {} columns, expected 6 (origin, direction) or 7 (and weight)",
                given.ncols()
            )));
        }
        let ray = |row: numpy::ndarray::ArrayView1<'_, f64>| {
            let vector = |first: usize| DVec3::new(row[first], row[first + 1], row[first + 2]);
            let ray = CameraRay { origin: vector(0), direction: vector(3), weight: row.get(6).copied().unwrap_or(1.0) };
            (ray.origin.is_finite() && ray.direction.is_finite()).then_some(ray)
        };
        Ok(given.rows().into_iter().map(ray).collect())
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
