//! Scenes and views.

use crate::batcher;
use crate::errors::exception;
use crate::material::PythonMaterial;
use crate::supervise::Raised;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};
use radsight::{FileKind, FileLoader, LoadError, Loaded, Loader, MemoryLoader, RecordingLoader};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A name for messages and a text.
pub(crate) type Text = (String, Vec<u8>);

/// Python objects in the place of materials of these names.
pub(crate) type Materials = BTreeMap<String, Py<PyAny>>;

/// Contents of files, by their names.
pub(crate) type Files = BTreeMap<String, Vec<u8>>;

/// A scene: surfaces, materials, patterns and lights, read and checked. It can be pickled, with all files that it names.
///
/// Parameters
/// ----------
/// texts : sequence of (str, bytes)
///     Scene texts and octrees, each with a name for messages.
/// files : dict of str to bytes, optional
///     Files that they name; others are looked for in the working folder.
/// materials : dict of str to Material, optional
///     Objects in the place of materials of these names; see `Material`.
///
/// Raises
/// ------
/// SceneError
///     With every mistake in them: file, line, caret and hint.
///
/// Examples
/// --------
/// >>> import radsight
/// >>> radsight.Scene([("ball.rad", b"void glow white 0 0 4 1 1 1 0 white sphere ball 0 0 4 0 9 0 2")])
/// <radsight.Scene of 1 surfaces>
#[pyclass(frozen, module = "radsight")]
pub(crate) struct Scene {
    pub(crate) scene: radsight::Scene,
    /// Exceptions of its materials in Python.
    pub(crate) raised: Raised,
    pub(crate) texts: Vec<Text>,
    pub(crate) files: Files,
    pub(crate) materials: Materials,
}

/// Looks in memory first.
#[derive(Clone)]
struct FilesFirst(MemoryLoader, FileLoader);

impl Loader for FilesFirst {
    fn load(&self, name: &str, kind: FileKind) -> Result<Loaded, LoadError> {
        self.0.load(name, kind).or_else(|_| self.1.load(name, kind))
    }

    fn run_command(&self, command: &str, standard_input: Option<&[u8]>) -> Result<Vec<u8>, LoadError> {
        self.1.run_command(command, standard_input)
    }
}

impl Scene {
    /// Reads texts.
    pub(crate) fn read(
        py: Python<'_>,
        texts: Vec<Text>,
        (files, folders): (Files, FileLoader),
        materials: Materials,
    ) -> PyResult<Scene> {
        let raised = Raised::default();
        let models = models_of(py, &materials, &raised)?;
        let recorder = RecordingLoader::new(files_first(&files, folders));
        let scene = py.detach(|| scene_builder(&texts, recorder.clone(), models).build());
        let files = recorder.named_files().into_iter().collect();
        Ok(Scene { scene: scene.map_err(exception)?, raised, texts, files, materials })
    }

    /// The loader of the files that the scene names.
    pub(crate) fn loader(&self) -> impl Loader + Send + use<> {
        files_first(&self.files, FileLoader::default())
    }

    /// Threads of work on it, where so many are asked for: more where its materials are Python's, since these are asked in batches.
    pub(crate) fn threads(&self, asked: Option<usize>) -> Option<usize> {
        match self.materials.is_empty() {
            true => asked,
            false => Some(asked.unwrap_or_default().max(batcher::THREADS)),
        }
    }

    /// Its materials in Python.
    pub(crate) fn models(&self, py: Python<'_>) -> PyResult<Models> {
        models_of(py, &self.materials, &self.raised)
    }
}

/// Models in the place of materials of these names.
pub(crate) type Models = Vec<(String, PythonMaterial)>;

fn models_of(py: Python<'_>, materials: &Materials, raised: &Raised) -> PyResult<Models> {
    let model = |(name, object): (&String, &Py<PyAny>)| {
        Ok((name.clone(), PythonMaterial::new(py, name, object.clone_ref(py), raised)?))
    };
    materials.iter().map(model).collect()
}

/// Looks for files in memory, and then on the disk.
pub(crate) fn files_first(files: &Files, folders: FileLoader) -> impl Loader + Clone + Send + use<> {
    let memory = files.iter().fold(MemoryLoader::default(), |memory, (name, bytes)| memory.with(name, bytes));
    FilesFirst(memory, folders)
}

/// A builder that reads texts with models.
pub(crate) fn scene_builder<'l>(
    texts: &[Text],
    loader: impl Loader + 'l,
    models: Models,
) -> radsight::SceneBuilder<'l> {
    let mut builder = radsight::Scene::builder().loader(loader);
    for (name, text) in texts {
        builder = builder.text(name, text.clone());
    }
    for (name, model) in models {
        builder = builder.material(&name, Arc::new(model));
    }
    builder
}

/// The texts of files, and the loader that finds what they name: in the working folder, and then beside them.
pub(crate) fn texts_of(paths: &[PathBuf]) -> PyResult<(Vec<Text>, FileLoader)> {
    let beside = paths.iter().filter_map(|path| path.parent().filter(|folder| *folder != Path::new("")));
    let folders: Vec<PathBuf> = std::iter::once(Path::new(".")).chain(beside).map(Path::to_owned).collect();
    let loader = FileLoader::new(folders);
    let text = |path: &PathBuf| {
        let loaded = loader.load(&path.display().to_string(), FileKind::Scene);
        loaded.map(|loaded| (loaded.path, loaded.bytes)).map_err(|error| exception(error.into()))
    };
    Ok((paths.iter().map(text).collect::<PyResult<_>>()?, loader))
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (texts, *, files=None, materials=None))]
    fn new(py: Python<'_>, texts: Vec<Text>, files: Option<Files>, materials: Option<Materials>) -> PyResult<Scene> {
        let files = (files.unwrap_or_default(), FileLoader::default());
        Scene::read(py, texts, files, materials.unwrap_or_default())
    }

    /// Read scene files and octrees.
    ///
    /// Parameters
    /// ----------
    /// *paths : path-like
    ///     The files. Files that they name are looked for in the working folder, and then beside them.
    /// materials : dict of str to Material, optional
    ///     Objects in the place of materials of these names.
    ///
    /// Returns
    /// -------
    /// Scene
    ///     Read and checked.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     With every mistake in them: file, line, caret and hint.
    #[staticmethod]
    #[pyo3(signature = (*paths, materials=None))]
    fn load(py: Python<'_>, paths: &Bound<'_, PyTuple>, materials: Option<Materials>) -> PyResult<Scene> {
        let paths: Vec<PathBuf> = paths.extract()?;
        let (texts, loader) = texts_of(&paths)?;
        Scene::read(py, texts, (Files::new(), loader), materials.unwrap_or_default())
    }

    /// Read scene text.
    ///
    /// Parameters
    /// ----------
    /// text : str
    ///     In Radiance's scene language.
    /// materials : dict of str to Material, optional
    ///     Objects in the place of materials of these names.
    ///
    /// Returns
    /// -------
    /// Scene
    ///     Read and checked.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     With every mistake in it: line, caret and hint.
    #[staticmethod]
    #[pyo3(signature = (text, *, materials=None))]
    fn from_text(py: Python<'_>, text: &str, materials: Option<Materials>) -> PyResult<Scene> {
        let texts = vec![("<text>".to_owned(), text.as_bytes().to_vec())];
        let files = (Files::new(), FileLoader::default());
        Scene::read(py, texts, files, materials.unwrap_or_default())
    }

    /// Number of surfaces; those of meshes and instances count once.
    #[getter]
    fn surface_count(&self) -> usize {
        self.scene.surface_count()
    }

    /// Warnings, with lines and carets; empty without any.
    #[getter]
    fn warnings(&self) -> String {
        self.scene.warnings().to_string()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let texts: Vec<(&str, Bound<'py, PyBytes>)> =
            self.texts.iter().map(|(name, text)| (name.as_str(), PyBytes::new(py, text))).collect();
        let (files, materials) = (PyDict::new(py), PyDict::new(py));
        for (name, bytes) in &self.files {
            files.set_item(name, PyBytes::new(py, bytes))?;
        }
        for (name, object) in &self.materials {
            materials.set_item(name, object)?;
        }
        let again = py.import("radsight._pickle")?.getattr("scene")?;
        Ok((again, (texts, files, materials).into_pyobject(py)?))
    }

    fn __repr__(&self) -> String {
        format!("<radsight.Scene of {} surfaces>", self.scene.surface_count())
    }
}

/// A view by Radiance's options.
///
/// Parameters
/// ----------
/// arguments : str
///     Such as ``-vp 0 0 1.7 -vd 0 1 0 -vh 60``.
#[pyclass(frozen, module = "radsight")]
pub(crate) struct View(pub(crate) radsight::View);

#[pymethods]
impl View {
    #[new]
    fn new(arguments: &str) -> PyResult<View> {
        radsight::View::from_args(arguments).map(View).map_err(exception)
    }

    /// Radiance's options that describe it.
    #[getter]
    fn arguments(&self) -> String {
        self.0.to_args().trim().to_owned()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> (Bound<'py, PyAny>, (String,)) {
        (py.get_type::<View>().into_any(), (self.arguments(),))
    }

    fn __repr__(&self) -> String {
        format!("<radsight.View {}>", self.0.to_args().trim())
    }
}
