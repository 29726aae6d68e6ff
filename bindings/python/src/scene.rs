//! Scenes and views.

use crate::errors::exception;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::path::PathBuf;

/// A scene: surfaces, materials, patterns and lights, read and checked.
#[pyclass(frozen, module = "radsight")]
pub(crate) struct Scene(pub(crate) radsight::Scene);

#[pymethods]
impl Scene {
    /// Read scene files and octrees.
    ///
    /// Parameters
    /// ----------
    /// *paths : path-like
    ///     The files. Files that they name are looked for in the working folder, and then beside them.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     With every mistake in them: file, line, caret and hint.
    #[staticmethod]
    #[pyo3(signature = (*paths))]
    fn load(py: Python<'_>, paths: &Bound<'_, PyTuple>) -> PyResult<Scene> {
        let paths: Vec<PathBuf> = paths.extract()?;
        py.detach(|| radsight::Scene::load(paths)).map(Scene).map_err(exception)
    }

    /// Read scene text.
    #[staticmethod]
    fn from_text(py: Python<'_>, text: &str) -> PyResult<Scene> {
        py.detach(|| radsight::Scene::from_text(text)).map(Scene).map_err(exception)
    }

    /// How many surfaces there are; those of meshes and placed octrees count once.
    #[getter]
    fn surface_count(&self) -> usize {
        self.0.surface_count()
    }

    /// What is suspect, with lines and carets; empty if nothing is.
    #[getter]
    fn warnings(&self) -> String {
        self.0.warnings().to_string()
    }

    fn __repr__(&self) -> String {
        format!("<radsight.Scene of {} surfaces>", self.0.surface_count())
    }
}

/// A view by Radiance's options, such as ``-vp 0 0 1.7 -vd 0 1 0 -vh 60``.
#[pyclass(frozen, module = "radsight")]
pub(crate) struct View(pub(crate) radsight::View);

#[pymethods]
impl View {
    #[new]
    fn new(arguments: &str) -> PyResult<View> {
        radsight::View::from_args(arguments).map(View).map_err(exception)
    }

    fn __repr__(&self) -> String {
        format!("<radsight.View {}>", self.0.to_args().trim())
    }
}
