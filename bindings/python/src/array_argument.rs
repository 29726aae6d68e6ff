//! Arrays that Python code gives: read in place where they are arrays of doubles, and converted once otherwise.

use crate::errors::RadsightError;
use numpy::ndarray::Dimension;
use numpy::{PyArray, PyArrayMethods, PyReadonlyArray, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

/// An argument as an array of doubles with as many axes as `D` has. `shape` is the expected one, for messages.
pub(crate) fn array_argument<'py, D: Dimension>(
    name: &str,
    given: &Bound<'py, PyAny>,
    shape: &str,
) -> PyResult<PyReadonlyArray<'py, f64, D>> {
    let array = as_doubles(given).map_err(|found| {
        PyTypeError::new_err(format!("{name} is {found}, expected an array of numbers of shape {shape}"))
    })?;
    match array.cast::<PyArray<f64, D>>() {
        Ok(array) => Ok(array.try_readonly()?),
        Err(_) => Err(wrong_shape(name, array.shape(), shape)),
    }
}

pub(crate) fn wrong_shape(name: &str, found: &[usize], expected: &str) -> PyErr {
    RadsightError::new_err(format!("{name} has shape {}, expected {expected}", shape_text(found)))
}

/// The argument itself if it is an aligned array of doubles, else an array converted from it. The error is the type that was given.
pub(crate) fn as_doubles<'py>(given: &Bound<'py, PyAny>) -> Result<Bound<'py, PyUntypedArray>, String> {
    let kind_of =
        |thing: &Bound<'py, PyAny>| thing.get_type().name().map_or_else(|_| "?".to_owned(), |name| name.to_string());
    let converted = || -> PyResult<Result<Bound<'py, PyAny>, String>> {
        let numpy = given.py().import("numpy")?;
        let array = numpy.call_method1("asarray", (given,))?;
        let dtype = array.getattr("dtype")?;
        if !["b", "i", "u", "f"].contains(&dtype.getattr("kind")?.extract::<String>()?.as_str()) {
            let is_array = given.is_instance_of::<PyUntypedArray>();
            return Ok(Err(if is_array { format!("an array of {dtype}") } else { kind_of(given) }));
        }
        Ok(Ok(numpy.call_method1("require", (array, "float64", "A"))?))
    };
    // NumPy refuses lists of unequal length and the like.
    let array = converted().unwrap_or_else(|error| Err(format!("{} ({error})", kind_of(given))))?;
    array.cast_into::<PyUntypedArray>().map_err(|error| error.to_string())
}

/// As Python writes a tuple.
pub(crate) fn shape_text(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        _ => format!("({})", shape.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    }
}
