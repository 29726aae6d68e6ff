//! Retroreflectors in the terms of their trade.

use crate::array_argument::{array_argument, wrong_shape};
use crate::errors::RadsightError;
use numpy::ndarray::Ix1;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use radsight::Material;
use radsight_retro::{Geometry, MODELS, Row, Weights};
use std::collections::BTreeMap;

/// Angles of measurements, of equal length, as they are given.
type Angles<'a, 'py> = &'a Bound<'py, PyAny>;

/// List the models.
///
/// Returns
/// -------
/// dict of str to list of str
///     Names of the models, each with the names of its numbers.
#[pyfunction]
pub(crate) fn models() -> BTreeMap<&'static str, Vec<&'static str>> {
    MODELS.iter().map(|model| (model.name, model.parameters.iter().map(|parameter| parameter.name).collect())).collect()
}

/// The coefficient of retroreflection R_A of a model, cd/(lx m²).
///
/// Parameters
/// ----------
/// model : str
///     One of `models`.
/// numbers : sequence of float
///     As a scene writes them.
/// observation_deg, entrance_deg : (n,) array of float
///     From the light to the observer, and from the normal to the light, degrees.
/// rotation_deg : float
///     About the normal.
/// word : str, optional
///     Such as ``paint`` for ``glass_bead``.
///
/// Returns
/// -------
/// (n,) array of float
///     R_A, cd/(lx m²).
///
/// Raises
/// ------
/// RadsightError
///     If there is no such model, or its numbers or the angles are wrong.
#[pyfunction]
#[pyo3(signature = (model, numbers, observation_deg, entrance_deg, *, rotation_deg=0.0, word=None))]
pub(crate) fn coefficient<'py>(
    py: Python<'py>,
    model: &str,
    numbers: Vec<f64>,
    observation_deg: Angles<'_, 'py>,
    entrance_deg: Angles<'_, 'py>,
    rotation_deg: f64,
    word: Option<String>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let words: Vec<String> = word.into_iter().collect();
    let sheet = radsight_retro::model(model, &words, &numbers);
    let sheet = sheet.map_err(|error| RadsightError::new_err(error.to_string()))?;
    let of = |at: Geometry| {
        let (observer, light) = at.directions();
        let (mut value, mut pdf) = ([0.0], [0.0]);
        sheet.eval_pdf(observer, &[light], &mut value, &mut pdf);
        at.coefficient(value[0])
    };
    let angles = geometries(observation_deg, entrance_deg, rotation_deg)?;
    Ok(PyArray1::from_vec(py, angles.into_iter().map(of).collect()))
}

/// Fit a model to measured R_A by least squares of the relative residuals.
///
/// Parameters
/// ----------
/// model : str
///     One of `models`.
/// observation_deg, entrance_deg : (n,) array of float
///     From the light to the observer, and from the normal to the light, degrees.
/// coefficient_cd_per_lx_m2 : (n,) array of float
///     R_A.
/// word : str, optional
///     Such as ``paint`` for ``glass_bead``.
///
/// Returns
/// -------
/// dict of str to float
///     The model's numbers, in its order, and ``rms``: the root mean square of the relative residuals.
#[pyfunction]
#[pyo3(signature = (model, observation_deg, entrance_deg, coefficient_cd_per_lx_m2, *, word=None))]
pub(crate) fn fit<'py>(
    py: Python<'py>,
    model: &str,
    observation_deg: Angles<'_, 'py>,
    entrance_deg: Angles<'_, 'py>,
    coefficient_cd_per_lx_m2: Angles<'_, 'py>,
    word: Option<String>,
) -> PyResult<Bound<'py, pyo3::types::PyDict>> {
    let angles = geometries(observation_deg, entrance_deg, 0.0)?;
    let coefficients = numbers_of("coefficient_cd_per_lx_m2", coefficient_cd_per_lx_m2, Some(angles.len()))?;
    let coefficients = coefficients.as_array();
    let row = |(geometry, coefficient): (Geometry, &f64)| Row { geometry, coefficient: *coefficient };
    let rows: Vec<Row> = angles.into_iter().zip(coefficients).map(row).collect();
    let words: Vec<String> = word.into_iter().collect();
    let found = radsight_retro::fit(model, &words, &rows, Weights::Relative);
    let found = found.map_err(|error| RadsightError::new_err(error.to_string()))?;
    let fitted = pyo3::types::PyDict::new(py);
    for parameter in &found.parameters {
        fitted.set_item(parameter.name, parameter.value)?;
    }
    fitted.set_item("rms", found.rms)?;
    Ok(fitted)
}

fn geometries(observation: Angles<'_, '_>, entrance: Angles<'_, '_>, rotation: f64) -> PyResult<Vec<Geometry>> {
    let observation = numbers_of("observation_deg", observation, None)?;
    let entrance = numbers_of("entrance_deg", entrance, Some(observation.len()?))?;
    let degrees = |(at, from): (&f64, &f64)| Geometry::from_degrees(*at, *from, rotation);
    Ok(observation.as_array().iter().zip(entrance.as_array()).map(degrees).collect())
}

/// An argument of so many numbers, if that is given.
fn numbers_of<'py>(
    name: &str,
    given: &Bound<'py, PyAny>,
    count: Option<usize>,
) -> PyResult<PyReadonlyArray1<'py, f64>> {
    let shape = count.map_or_else(|| "(n,)".to_owned(), |count| format!("({count},), that of observation_deg"));
    let numbers = array_argument::<Ix1>(name, given, &shape)?;
    match count {
        Some(count) if numbers.len()? != count => Err(wrong_shape(name, numbers.as_array().shape(), &shape)),
        _ => Ok(numbers),
    }
}
