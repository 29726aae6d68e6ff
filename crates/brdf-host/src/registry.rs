//! All plugins of a run.

use crate::isolate::Isolation;
use crate::library::User;
use crate::self_check::SelfCheck;
use crate::{Error, FaultReport, Label, Library, PluginBrdf, SearchPath};
use radsight_brdf_abi::Band;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// What a scene or an option asks for.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// Bare name of the library.
    pub library: &'a str,
    /// Model in the library.
    pub model: &'a str,
    /// Words after library and model.
    pub words: &'a [String],
    /// Numbers.
    pub numbers: &'a [f64],
    /// The bands of the rendering; at least one. Wavelengths in metres.
    pub bands: &'a [Band],
    /// For messages.
    pub label: &'a Label,
    /// The scene's folder, in which files that parameters name are looked for first.
    pub folder: Option<&'a Path>,
}

/// An instance and what the quick self-check thinks of it.
#[derive(Clone, Debug)]
pub struct Instantiated {
    /// The model with its parameters.
    pub brdf: Arc<PluginBrdf>,
    /// Findings of the self-check, each with angle and value, and warnings of the plugin itself.
    pub warnings: Vec<String>,
}

/// Loads each library once and keeps all instances, to tell their faults in the end.
#[derive(Debug)]
pub struct Registry {
    search: SearchPath,
    self_check: SelfCheck,
    isolation: Option<Isolation>,
    libraries: Mutex<HashMap<PathBuf, Result<Arc<Library>, Error>>>,
    instances: Mutex<Vec<Arc<PluginBrdf>>>,
}

impl Registry {
    /// An empty registry. Also installs the message that precedes a crash.
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

    /// Where libraries are looked for.
    #[must_use]
    pub fn search_path(&self) -> &SearchPath {
        &self.search
    }

    /// The library with this bare name.
    ///
    /// # Errors
    /// When it is not found or is no plugin.
    pub fn library(&self, name: &str) -> Result<Arc<Library>, Error> {
        self.library_file(&self.search.find(name)?)
    }

    /// The library in this file, as a command line names it.
    ///
    /// # Errors
    /// When it is no plugin.
    pub fn library_file(&self, path: &Path) -> Result<Arc<Library>, Error> {
        self.library_file_for(path, None)
    }

    fn library_file_for(&self, path: &Path, user: Option<User<'_>>) -> Result<Arc<Library>, Error> {
        let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let mut libraries = self.libraries.lock().unwrap_or_else(PoisonError::into_inner);
        let load = |path: &PathBuf| Library::load_for(path, user, self.isolation.as_ref());
        libraries.entry(path).or_insert_with_key(|path| load(path).map(Arc::new)).clone()
    }

    /// Makes an instance; its parameters are checked before the plugin sees them.
    ///
    /// # Errors
    /// See [`Error`]; [`Error::token`] says which token of the scene is to blame.
    pub fn instantiate(&self, request: &Request<'_>) -> Result<Instantiated, Error> {
        let user = User { model: request.model, label: request.label };
        let library = self.library_file_for(&self.search.find(request.library)?, Some(user))?;
        self.instantiate_from(library, request)
    }

    /// As [`Registry::instantiate`], from a library that is at hand; `request.library` is not looked at.
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

    /// The faults of all instances that have any, and what plugins logged meanwhile, to be told when the work is done.
    #[must_use]
    pub fn fault_reports(&self) -> Vec<FaultReport> {
        let instances = self.instances.lock().unwrap_or_else(PoisonError::into_inner);
        instances.iter().filter_map(|instance| instance.fault_report()).collect()
    }

    /// What the plugins logged since this was last asked, as lines that name them.
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
