//! All plugins of a run.

use crate::isolate::Isolation;
use crate::library::User;
use crate::self_check::SelfCheck;
use crate::{Error, FaultReport, Label, Library, PluginBrdf, SearchPath};
use radsight_brdf_abi::Band;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// A request of a scene or an option.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// Name of the library.
    pub library: &'a str,
    /// Name of the model in the library.
    pub model: &'a str,
    /// Words after library and model.
    pub words: &'a [String],
    /// Real arguments.
    pub numbers: &'a [f64],
    /// Bands of the rendering, at least one. Wavelengths in metres.
    pub bands: &'a [Band],
    /// Material and position, for messages.
    pub label: &'a Label,
    /// Folder of the scene, in which files named by parameters are searched first.
    pub folder: Option<&'a Path>,
}

/// An instance, with the findings of the quick self-check.
#[derive(Clone, Debug)]
pub struct Instantiated {
    /// The model with its parameters.
    pub brdf: Arc<PluginBrdf>,
    /// Findings of the self-check, with angles and values, and warnings of the plugin.
    pub warnings: Vec<String>,
}

/// Loads each library once, and keeps all instances in order to report their faults.
#[derive(Debug)]
pub struct Registry {
    search: SearchPath,
    self_check: SelfCheck,
    isolation: Option<Isolation>,
    libraries: Mutex<HashMap<PathBuf, Result<Arc<Library>, Error>>>,
    instances: Mutex<Vec<Arc<PluginBrdf>>>,
}

impl Registry {
    /// An empty registry. It also installs the crash message.
    #[must_use]
    pub fn new(search: SearchPath, self_check: SelfCheck) -> Self {
        crate::guard::install_crash_messages();
        Registry { search, self_check, isolation: None, libraries: Mutex::default(), instances: Mutex::default() }
    }

    /// Runs libraries in processes of their own from now on.
    #[must_use]
    pub fn isolated(self, isolation: Isolation) -> Self {
        Registry { isolation: Some(isolation), ..self }
    }

    /// Folders in which libraries are searched.
    #[must_use]
    pub fn search_path(&self) -> &SearchPath {
        &self.search
    }

    /// The library of this name.
    ///
    /// # Errors
    /// If it is not found or is not a plugin.
    pub fn library(&self, name: &str) -> Result<Arc<Library>, Error> {
        self.library_file(&self.search.find(name)?)
    }

    /// The library in this file, for a command line.
    ///
    /// # Errors
    /// If it is not a plugin.
    pub fn library_file(&self, path: &Path) -> Result<Arc<Library>, Error> {
        self.library_file_for(path, None)
    }

    fn library_file_for(&self, path: &Path, user: Option<User<'_>>) -> Result<Arc<Library>, Error> {
        let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let mut libraries = self.libraries.lock().unwrap_or_else(PoisonError::into_inner);
        let load = |path: &PathBuf| Library::load_for(path, user, self.isolation.as_ref());
        libraries.entry(path).or_insert_with_key(|path| load(path).map(Arc::new)).clone()
    }

    /// Makes an instance, after checking its parameters.
    ///
    /// # Errors
    /// See [`Error`]; [`Error::token`] is the token of the scene that caused it.
    pub fn instantiate(&self, request: &Request<'_>) -> Result<Instantiated, Error> {
        let user = User { model: request.model, label: request.label };
        let library = self.library_file_for(&self.search.find(request.library)?, Some(user))?;
        self.instantiate_from(library, request)
    }

    /// As [`Registry::instantiate`], from a loaded library; `request.library` is ignored.
    ///
    /// # Errors
    /// As there.
    pub fn instantiate_from(&self, library: Arc<Library>, request: &Request<'_>) -> Result<Instantiated, Error> {
        let (index, model) = library.model(request.model)?;
        let arguments = model.arguments(request.words, request.numbers, request.bands, request.folder)?;
        let brdf = PluginBrdf::create(Arc::clone(&library), index, &arguments, request.bands, request.label.clone())?;
        let findings = brdf.quick_check(self.self_check);
        if self.self_check == SelfCheck::Strict && !findings.is_empty() {
            return Err(Error::SelfCheck { library: library.name().to_owned(), findings });
        }
        let mut warnings = findings;
        warnings.extend(library.take_messages().into_iter().map(|message| message.text));
        let brdf = Arc::new(brdf);
        self.instances.lock().unwrap_or_else(PoisonError::into_inner).push(Arc::clone(&brdf));
        Ok(Instantiated { brdf, warnings })
    }

    /// Faults of all instances that have any. Call it when the work is done.
    #[must_use]
    pub fn fault_reports(&self) -> Vec<FaultReport> {
        let instances = self.instances.lock().unwrap_or_else(PoisonError::into_inner);
        instances.iter().filter_map(|instance| instance.fault_report()).collect()
    }

    /// Messages that plugins logged since the last call, as lines with the plugin's name.
    #[must_use]
    pub fn take_messages(&self) -> Vec<String> {
        let libraries = self.libraries.lock().unwrap_or_else(PoisonError::into_inner);
        let mut lines: Vec<String> = libraries
            .values()
            .flatten()
            .flat_map(|library| {
                library.take_messages().into_iter().map(|m| format!("plugin \"{}\": {}", library.name(), m.text))
            })
            .collect();
        lines.sort();
        lines
    }
}
