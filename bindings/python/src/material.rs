//! Materials written in Python.

use crate::array_argument::{as_doubles, shape_text};
use crate::batcher::Batcher;
use crate::supervise::Raised;
use glam::DVec3;
use numpy::ndarray::ArrayView1;
use numpy::{
    PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use radsight::{BrdfSample, Density, Lobes, Material};
use radsight_brdf::Lambert;
use std::f64::consts::PI;
use std::ops::Range;

/// Negative numbers down to this are rounding errors of zero, 1/sr.
const ROUNDING: f64 = -1e-9;

/// A Python object with `evaluate(outgoing, incident)`, and `pdf` and `sample` where cosine-weighted directions are not good enough.
#[derive(Debug)]
pub(crate) struct PythonMaterial {
    name: String,
    object: Py<PyAny>,
    has_sample: bool,
    raised: Raised,
    hits: Batcher<HitQuery, HitAnswer>,
}

/// A query of a hit.
#[derive(Debug)]
struct HitQuery {
    outgoing: DVec3,
    ask: Ask,
    bands: usize,
}

#[derive(Debug)]
enum Ask {
    /// Values and densities of these incident directions.
    Eval(Vec<DVec3>),
    /// An incident direction for a point of the unit cube.
    Sample([f64; 3]),
}

/// The results of a hit's query.
#[derive(Debug)]
struct HitAnswer {
    /// The asked directions, or the sampled one; without it the light is absorbed.
    incident: Vec<DVec3>,
    /// The bands of the first direction, then those of the second.
    values: Vec<f64>,
    pdfs: Vec<f64>,
}

/// Pairs of directions of many hits.
#[derive(Default)]
struct Pairs {
    outgoing: Vec<DVec3>,
    incident: Vec<DVec3>,
}

impl PythonMaterial {
    pub(crate) fn new(py: Python<'_>, name: &str, object: Py<PyAny>, raised: &Raised) -> PyResult<PythonMaterial> {
        let has = |method: &str| object.bind(py).hasattr(method);
        if !has("evaluate")? {
            let kind = object.bind(py).get_type().name()?;
            return Err(PyValueError::new_err(format!(
                "material \"{name}\": {kind} has no method evaluate(outgoing, incident)"
            )));
        }
        let has_sample = has("sample")?;
        if has_sample != has("pdf")? {
            return Err(PyValueError::new_err(format!(
                "material \"{name}\" has sample or pdf, expected both or neither"
            )));
        }
        let (name, raised, hits) = (name.to_owned(), raised.clone(), Batcher::default());
        Ok(PythonMaterial { name, object, has_sample, raised, hits })
    }

    /// The answer to a hit, from a batch of many.
    fn ask(&self, query: HitQuery) -> Option<HitAnswer> {
        self.hits.ask(query, |py, queries| {
            self.answer_all(py, &queries).unwrap_or_else(|error| {
                self.raised.set(error);
                Vec::new()
            })
        })
    }

    fn answer_all(&self, py: Python<'_>, queries: &[HitQuery]) -> PyResult<Vec<HitAnswer>> {
        let mut sampled = self.sample_all(py, queries)?.into_iter();
        let incident_of = |query: &HitQuery| match &query.ask {
            Ask::Eval(incident) => incident.clone(),
            Ask::Sample(_) => sampled.next().flatten().into_iter().collect(),
        };
        let incidents: Vec<Vec<DVec3>> = queries.iter().map(incident_of).collect();
        let mut pairs = Pairs::default();
        for (query, incident) in queries.iter().zip(&incidents) {
            pairs.outgoing.extend(incident.iter().map(|_| query.outgoing));
            pairs.incident.extend(incident);
        }
        let values = self.evaluate(py, &pairs)?;
        let pdfs = self.pdfs(py, &pairs)?;
        let mut first = 0;
        let mut answers = Vec::with_capacity(queries.len());
        for (query, incident) in queries.iter().zip(incidents) {
            let places = first..first + incident.len();
            first = places.end;
            let values = values.of(places.clone(), query.bands);
            answers.push(HitAnswer { incident, values, pdfs: pdfs[places].to_vec() });
        }
        Ok(answers)
    }

    /// A sampled incident direction for each sampling query; `None` for absorption.
    fn sample_all(&self, py: Python<'_>, queries: &[HitQuery]) -> PyResult<Vec<Option<DVec3>>> {
        let points = queries.iter().filter_map(|query| match query.ask {
            Ask::Sample(u) => Some((query.outgoing, u)),
            Ask::Eval(_) => None,
        });
        if !self.has_sample {
            let lambert = Lambert { reflectance: [1.0] };
            let sample = |(outgoing, u)| lambert.sample(outgoing, u, &mut [0.0]).map(|sample| sample.incident);
            return Ok(points.map(sample).collect());
        }
        let (outgoing, u): (Vec<DVec3>, Vec<[f64; 3]>) = points.unzip();
        if u.is_empty() {
            return Ok(Vec::new());
        }
        let u = PyArray1::from_vec(py, u.concat()).reshape([outgoing.len(), 3])?;
        let given = self.object.bind(py).call_method1("sample", (rows(py, &outgoing)?, u))?;
        let given = self.array("sample", &given, &[&[outgoing.len(), 3]])?;
        let given: PyReadonlyArray2<'_, f64> = given.extract()?;
        let direction = |row: ArrayView1<'_, f64>| DVec3::new(row[0], row[1], row[2]).try_normalize();
        Ok(given.as_array().rows().into_iter().map(direction).collect())
    }

    fn evaluate(&self, py: Python<'_>, pairs: &Pairs) -> PyResult<Values> {
        let count = pairs.incident.len();
        if count == 0 {
            return Ok(Values { bands: 1, all: Vec::new() });
        }
        let given = self.call(py, "evaluate", pairs)?;
        let given = self.array("evaluate", &given, &[&[count], &[count, 3]])?;
        let (bands, all) = if let Ok(one_band) = given.extract::<PyReadonlyArray1<'_, f64>>() {
            (1, one_band.as_array().to_vec())
        } else {
            let bands: PyReadonlyArray2<'_, f64> = given.extract()?;
            (3, bands.as_array().iter().copied().collect())
        };
        self.check("evaluate", &all, bands, pairs)?;
        // Rounding below zero is no light.
        Ok(Values { bands, all: all.into_iter().map(|value: f64| value.max(0.0)).collect() })
    }

    fn pdfs(&self, py: Python<'_>, pairs: &Pairs) -> PyResult<Vec<f64>> {
        let count = pairs.incident.len();
        if !self.has_sample || count == 0 {
            let mut pdfs = vec![0.0; count];
            let lambert = Lambert { reflectance: [1.0] };
            for ((outgoing, incident), pdf) in pairs.outgoing.iter().zip(&pairs.incident).zip(&mut pdfs) {
                lambert.eval_pdf(*outgoing, &[*incident], &mut [0.0], std::slice::from_mut(pdf));
            }
            return Ok(pdfs);
        }
        let given = self.call(py, "pdf", pairs)?;
        let given = self.array("pdf", &given, &[&[count]])?;
        let pdfs = given.extract::<PyReadonlyArray1<'_, f64>>()?.as_array().to_vec();
        self.check("pdf", &pdfs, 1, pairs)?;
        Ok(pdfs)
    }

    fn call<'py>(&self, py: Python<'py>, method: &str, pairs: &Pairs) -> PyResult<Bound<'py, PyAny>> {
        self.object.bind(py).call_method1(method, (rows(py, &pairs.outgoing)?, rows(py, &pairs.incident)?))
    }

    /// The result of a method as an array of doubles with one of these shapes.
    fn array<'py>(
        &self,
        method: &str,
        given: &Bound<'py, PyAny>,
        shapes: &[&[usize]],
    ) -> PyResult<Bound<'py, PyUntypedArray>> {
        let array = as_doubles(given);
        let array = array.map_err(|found| self.wrong(&format!("{method} gave {found}, expected an array")))?;
        if shapes.contains(&array.shape()) {
            return Ok(array);
        }
        let expected: Vec<String> = shapes.iter().map(|shape| shape_text(shape)).collect();
        let found = shape_text(array.shape());
        Err(self.wrong(&format!("{method} gave an array of shape {found}, expected {}", expected.join(" or "))))
    }

    /// Says for which directions a value is not a number, or negative by more than rounding.
    fn check(&self, method: &str, values: &[f64], bands: usize, pairs: &Pairs) -> PyResult<()> {
        let is_wrong = |value: &f64| !(ROUNDING..=f64::MAX).contains(value);
        let Some(place) = values.iter().position(is_wrong) else { return Ok(()) };
        let text = |direction: DVec3| format!("({:.6}, {:.6}, {:.6})", direction.x, direction.y, direction.z);
        let (outgoing, incident) = (pairs.outgoing[place / bands], pairs.incident[place / bands]);
        Err(self.wrong(&format!(
            "{method} gave {} for outgoing {} and incident {}, expected a finite number of 0 or more",
            values[place],
            text(outgoing),
            text(incident)
        )))
    }

    fn wrong(&self, message: &str) -> PyErr {
        PyValueError::new_err(format!("material \"{}\": {message}", self.name))
    }
}

/// Values of a BRDF, 1/sr, in one band or three.
struct Values {
    bands: usize,
    all: Vec<f64>,
}

impl Values {
    /// The values of some directions in as many bands as are traced: one or three.
    fn of(&self, places: Range<usize>, bands: usize) -> Vec<f64> {
        let given = &self.all[places.start * self.bands..places.end * self.bands];
        if self.bands == 1 {
            return given.iter().flat_map(|value| std::iter::repeat_n(*value, bands)).collect();
        }
        // A grey scene has one band, and all are equal.
        given.chunks(self.bands).flat_map(|row| &row[..bands]).copied().collect()
    }
}

impl Material for PythonMaterial {
    fn lobes(&self) -> Lobes {
        Lobes { diffuse: true, glossy: self.has_sample, ..Lobes::default() }
    }

    fn eval_pdf(&self, outgoing: DVec3, incident: &[DVec3], values: &mut [f64], pdfs: &mut [f64]) {
        values.fill(0.0);
        pdfs.fill(0.0);
        if incident.is_empty() {
            return;
        }
        let bands = values.len() / incident.len();
        if let Some(answer) = self.ask(HitQuery { outgoing, ask: Ask::Eval(incident.to_vec()), bands }) {
            values.copy_from_slice(&answer.values);
            pdfs.copy_from_slice(&answer.pdfs);
        }
    }

    fn sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> Option<BrdfSample> {
        let answer = self.ask(HitQuery { outgoing, ask: Ask::Sample(u), bands: weights.len() })?;
        let (&incident, &pdf) = (answer.incident.first()?, answer.pdfs.first()?);
        // Cosine-weighted directions cancel the cosine exactly.
        let factor = if self.has_sample { incident.z.abs() / pdf } else { PI };
        weights.iter_mut().zip(&answer.values).for_each(|(weight, value)| *weight = value * factor);
        (pdf > 0.0 && factor.is_finite()).then_some(BrdfSample { incident, density: Density::Continuous(pdf) })
    }
}

fn rows<'py>(py: Python<'py>, vectors: &[DVec3]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let values = vectors.iter().flat_map(|vector| vector.to_array()).collect();
    PyArray1::from_vec(py, values).reshape([vectors.len(), 3])
}
