//! Materials written in Python.

use crate::supervise::Raised;
use glam::DVec3;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use radsight::{BrdfSample, Density, Lobes};
use std::f64::consts::{FRAC_1_PI, PI, TAU};

/// A Python object with `evaluate(outgoing, incident)`, and `pdf` and `sample` where cosine-weighted directions are not good enough.
#[derive(Debug)]
pub(crate) struct PythonMaterial {
    object: Py<PyAny>,
    has_sample: bool,
    raised: Raised,
}

impl PythonMaterial {
    pub(crate) fn new(py: Python<'_>, object: Py<PyAny>, raised: &Raised) -> PyResult<PythonMaterial> {
        let has = |name: &str| object.bind(py).hasattr(name);
        if !has("evaluate")? {
            let kind = object.bind(py).get_type().name()?;
            return Err(PyValueError::new_err(format!("material {kind} has no method evaluate(outgoing, incident)")));
        }
        let has_sample = has("sample")?;
        if has_sample != has("pdf")? {
            return Err(PyValueError::new_err("a material has sample and pdf, or neither"));
        }
        Ok(PythonMaterial { object, has_sample, raised: raised.clone() })
    }

    /// Values for incident directions, the bands of the first, then those of the second.
    fn evaluate(&self, py: Python<'_>, outgoing: DVec3, incident: &[DVec3], values: &mut [f64]) -> PyResult<()> {
        let given = self.object.bind(py).call_method1("evaluate", (vector(py, outgoing), rows(py, incident)?))?;
        let bands = values.len() / incident.len().max(1);
        if let Ok(one_band) = as_array(py, &given)?.extract::<PyReadonlyArray1<'_, f64>>() {
            let one_band = one_band.as_array();
            check_length("evaluate", one_band.len(), incident.len())?;
            values.chunks_mut(bands).zip(&one_band).for_each(|(values, value)| values.fill(*value));
            return Ok(());
        }
        let all: PyReadonlyArray2<'_, f64> = as_array(py, &given)?.extract()?;
        let all = all.as_array();
        check_length("evaluate", all.nrows(), incident.len())?;
        for (values, row) in values.chunks_mut(bands).zip(all.rows()) {
            check_length("the bands of evaluate", row.len(), bands)?;
            values.iter_mut().zip(row).for_each(|(value, given)| *value = *given);
        }
        Ok(())
    }

    fn pdf(&self, py: Python<'_>, outgoing: DVec3, incident: &[DVec3], pdfs: &mut [f64]) -> PyResult<()> {
        if !self.has_sample {
            pdfs.iter_mut().zip(incident).for_each(|(pdf, direction)| *pdf = direction.z.max(0.0) * FRAC_1_PI);
            return Ok(());
        }
        let given = self.object.bind(py).call_method1("pdf", (vector(py, outgoing), rows(py, incident)?))?;
        let given: PyReadonlyArray1<'_, f64> = as_array(py, &given)?.extract()?;
        let given = given.as_array();
        check_length("pdf", given.len(), incident.len())?;
        pdfs.iter_mut().zip(&given).for_each(|(pdf, given)| *pdf = *given);
        Ok(())
    }

    fn drawn(&self, py: Python<'_>, outgoing: DVec3, u: [f64; 3]) -> PyResult<Option<DVec3>> {
        if !self.has_sample {
            let (radius, angle) = (u[0].sqrt(), TAU * u[1]);
            let z = (1.0 - u[0]).max(1e-12).sqrt();
            return Ok(Some(DVec3::new(radius * angle.cos(), radius * angle.sin(), z)));
        }
        let point = PyArray1::from_slice(py, &u);
        let given = self.object.bind(py).call_method1("sample", (vector(py, outgoing), point))?;
        if given.is_none() {
            return Ok(None);
        }
        let given: PyReadonlyArray1<'_, f64> = as_array(py, &given)?.extract()?;
        let given = given.as_array();
        check_length("sample", given.len(), 3)?;
        Ok(DVec3::new(given[0], given[1], given[2]).try_normalize())
    }

    fn sampled(
        &self,
        py: Python<'_>,
        outgoing: DVec3,
        u: [f64; 3],
        weights: &mut [f64],
    ) -> PyResult<Option<BrdfSample>> {
        let Some(incident) = self.drawn(py, outgoing, u)? else { return Ok(None) };
        let mut pdf = [0.0];
        self.pdf(py, outgoing, &[incident], &mut pdf)?;
        self.evaluate(py, outgoing, &[incident], weights)?;
        // Cosine-weighted directions cancel the cosine exactly.
        let factor = if self.has_sample { incident.z.abs() / pdf[0] } else { PI };
        weights.iter_mut().for_each(|weight| *weight *= factor);
        let drawn = pdf[0] > 0.0 && factor.is_finite();
        Ok(drawn.then_some(BrdfSample { incident, density: Density::Continuous(pdf[0]) }))
    }
}

impl radsight::Material for PythonMaterial {
    fn lobes(&self) -> Lobes {
        Lobes { diffuse: true, glossy: self.has_sample, ..Lobes::default() }
    }

    fn eval_pdf(&self, outgoing: DVec3, incident: &[DVec3], values: &mut [f64], pdfs: &mut [f64]) {
        if incident.is_empty() {
            return;
        }
        let told = Python::attach(|py| {
            self.evaluate(py, outgoing, incident, values)?;
            self.pdf(py, outgoing, incident, pdfs)
        });
        if let Err(error) = told {
            values.fill(0.0);
            pdfs.fill(0.0);
            self.raised.set(error);
        }
    }

    fn sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> Option<BrdfSample> {
        let drawn = Python::attach(|py| self.sampled(py, outgoing, u, weights));
        drawn.unwrap_or_else(|error| {
            self.raised.set(error);
            None
        })
    }
}

fn vector(py: Python<'_>, vector: DVec3) -> Bound<'_, PyArray1<f64>> {
    PyArray1::from_slice(py, &vector.to_array())
}

fn rows<'py>(py: Python<'py>, vectors: &[DVec3]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let values = vectors.iter().flat_map(|vector| vector.to_array()).collect();
    PyArray1::from_vec(py, values).reshape([vectors.len(), 3])
}

/// As an array of doubles, whatever it was.
pub(crate) fn as_array<'py>(py: Python<'py>, given: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    py.import("numpy")?.call_method1("asarray", (given, "float64"))
}

pub(crate) fn check_length(what: &str, found: usize, expected: usize) -> PyResult<()> {
    match found == expected {
        true => Ok(()),
        false => Err(PyValueError::new_err(format!("{what} gave {found} values, expected {expected}"))),
    }
}
