//! What rays found, and rays in arrays.

use crate::errors::RadsightError;
use glam::DVec3;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use radsight::Ray;

/// What rays found.
#[pyclass(frozen, module = "radsight")]
pub(crate) struct TracedRays(pub(crate) Vec<radsight::Traced>);

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

pub(crate) fn rays_of(rays: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<Ray>> {
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
