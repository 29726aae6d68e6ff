//! Exceptions.

use pyo3::PyErr;
use pyo3::create_exception;
use pyo3::exceptions::PyValueError;

create_exception!(_radsight, RadsightError, PyValueError, "Something that radsight was given is wrong.");
create_exception!(
    _radsight,
    SceneError,
    RadsightError,
    "A scene or camera file is wrong: file, line, caret and hint of each mistake."
);

/// The exception for an error of the library.
pub(crate) fn exception(error: radsight::Error) -> PyErr {
    let text = error.to_string();
    match error {
        radsight::Error::Scene(_) | radsight::Error::Camera(_) | radsight::Error::Material(_) => {
            SceneError::new_err(text)
        }
        _ => RadsightError::new_err(text),
    }
}
