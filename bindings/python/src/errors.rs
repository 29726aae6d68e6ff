//! Exceptions.

use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

create_exception!(radsight, RadsightError, PyValueError, "An argument or an input file is wrong.");
create_exception!(
    radsight,
    SceneError,
    RadsightError,
    "A scene, camera file, table of a series or job is wrong.\n\nThe text has file, line, caret and hint of each mistake. `mistakes` is a list of (file, line, column, message);\nfile, line and column are None for a mistake at no place."
);

type Mistake = (Option<String>, Option<u32>, Option<u32>, String);

/// The exception for an error of the library.
pub(crate) fn exception(error: radsight::Error) -> PyErr {
    let text = error.to_string();
    match error {
        radsight::Error::Scene(report)
        | radsight::Error::Camera(report)
        | radsight::Error::Material(report)
        | radsight::Error::Series(report)
        | radsight::Error::Job(report) => of_report(text, &report),
        _ => RadsightError::new_err(text),
    }
}

fn of_report(text: String, report: &radsight::Report) -> PyErr {
    let mistake = |diagnostic: &radsight::Diagnostic| -> Mistake {
        match report.position(diagnostic) {
            Some((file, line, column)) => {
                (Some(file.to_owned()), Some(line), Some(column), diagnostic.message.to_string())
            }
            None => (None, None, None, diagnostic.message.to_string()),
        }
    };
    let mistakes: Vec<Mistake> = report.diagnostics.iter().map(mistake).collect();
    let error = SceneError::new_err(text);
    match Python::attach(|py| error.value(py).setattr("mistakes", mistakes)) {
        Ok(()) => error,
        Err(other) => other,
    }
}

/// An option that is out of its range.
pub(crate) fn wrong(option: &str, value: impl std::fmt::Display, expected: &str) -> PyErr {
    RadsightError::new_err(format!("{option} is {value}, expected {expected}"))
}
