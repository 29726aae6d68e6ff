//! BRDF plugins for the renderer: their search path, and their errors at the scene's tokens.

use crate::failure::say;
use crate::plugin_guard::PluginGuard;
use crate::trust::Trust;
use radsight_brdf::Brdf;
use radsight_brdf_host::check::CHECK_BANDS;
use radsight_brdf_host::{Band, Label, Registry, Request, SearchPath, SelfCheck, Token};
use radsight_diag::{Diagnostic, SourceMap};
use radsight_render::{ModelRequest, ModelSource};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The environment variable with further folders, in the system's list syntax.
const PATH_VARIABLE: &str = "RADSIGHT_PLUGIN_PATH";

/// The whole visible spectrum as one band.
const GREY_BAND: Band = Band { centre_m: 555e-9, low_m: 380e-9, high_m: 780e-9 };

/// Options of plugins.
#[derive(Clone, Debug, Default)]
pub(crate) struct PluginOptions {
    /// The permissions, including the folders to search.
    pub(crate) trust: Trust,
    /// `--strict`: findings of the self-check are errors.
    pub(crate) strict: bool,
    /// Limits and isolation.
    pub(crate) guard: PluginGuard,
}

/// The folders whose libraries are loaded, in search order: those of the command line, of the
/// environment, and of the program.
///
/// The program's own folder is excluded if it contains scenes: it may just be the place where both
/// were unpacked.
pub(crate) fn search_path(folders: &[PathBuf], scenes: &SearchPath) -> SearchPath {
    let mut path = SearchPath::default();
    folders.iter().for_each(|folder| path.push(folder));
    if let Some(list) = std::env::var_os(PATH_VARIABLE) {
        path.push_list(&list);
    }
    let real = |folder: &Path| std::fs::canonicalize(folder).ok();
    let is_of_scenes = |own: &Path| scenes.folders().iter().any(|folder| real(folder).is_some_and(|f| f == own));
    let own = std::env::current_exe().ok().and_then(|program| real(program.parent()?));
    if let Some(own) = own.as_deref().filter(|own| !is_of_scenes(own)) {
        path.push(own.join("plugins"));
        // A program that was just built has the workspace's plugins beside it.
        path.push(own);
    }
    path
}

/// The folders of the scenes, whose libraries are loaded only if the command line permits it.
fn folders_of(scenes: &[String]) -> SearchPath {
    let mut path = SearchPath::default();
    scenes.iter().filter(|scene| *scene != "-").for_each(|scene| path.push(folder_of(scene)));
    path
}

fn folder_of(file: &str) -> PathBuf {
    let folder = Path::new(file).parent().unwrap_or(Path::new(""));
    if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder.to_owned() }
}

/// Creates the models of a scene.
pub(crate) struct Models<'s> {
    registry: Registry,
    guard: PluginGuard,
    trust: Trust,
    /// Folders whose libraries are loaded, and those of the scenes.
    folders: [SearchPath; 2],
    sources: &'s SourceMap,
    folder: PathBuf,
    /// Messages already printed: a model may be created twice, for three bands and for one.
    reported: RefCell<BTreeSet<String>>,
    /// The models by their definitions: several plans of a scene share them, and their faults are
    /// reported together.
    made: RefCell<BTreeMap<String, Arc<dyn Brdf>>>,
}

impl<'s> Models<'s> {
    pub(crate) fn new(options: &PluginOptions, scenes: &[String], sources: &'s SourceMap) -> Self {
        let check = if options.strict { SelfCheck::Strict } else { SelfCheck::Warn };
        let folder = scenes.iter().find(|scene| *scene != "-").map_or(PathBuf::from("."), |scene| folder_of(scene));
        let of_scenes = folders_of(scenes);
        let folders = [search_path(options.trust.plugin_folders(), &of_scenes), of_scenes];
        // Folders of scenes come last, so that they hide nothing. `check_library` decides whether
        // their libraries are loaded.
        let mut all = folders[0].clone();
        folders[1].folders().iter().for_each(|folder| all.push(folder));
        let (trust, guard) = (options.trust.clone(), options.guard.clone());
        let searched = if trust.may_load_beside_scenes() { all } else { folders[0].clone() };
        let registry = guard.with_isolation(Registry::new(searched, check));
        Models {
            registry,
            guard,
            trust,
            folders,
            sources,
            folder,
            reported: RefCell::default(),
            made: RefCell::default(),
        }
    }

    /// A library beside the scene is only an input, unless the command line permits loading it.
    fn check_library(&self, library: &str) -> Result<(), Diagnostic> {
        let [installed, of_scenes] = &self.folders;
        let is_allowed = self.trust.allows_plugins_of_scenes() || self.trust.names_library(library);
        if is_allowed || installed.find(library).is_ok() {
            return Ok(());
        }
        match of_scenes.find(library) {
            Ok(file) => Err(Diagnostic::error(format!(
                "library \"{}\" is beside the scene and is not loaded: a scene is input, not a program",
                file.display()
            ))
            .hint("--allow-plugins loads libraries beside the scene, --plugin-path DIR those of a folder")),
            Err(_) => Ok(()),
        }
    }

    /// The registry, which counts invalid results of plugins.
    pub(crate) fn registry(&self) -> &Registry {
        &self.registry
    }

    /// Takes the registry.
    pub(crate) fn into_registry(self) -> Registry {
        self.registry
    }

    fn warn(&self, diagnostic: &Diagnostic) {
        let text = diagnostic.render(self.sources);
        if self.reported.borrow_mut().insert(text.clone()) {
            say(&text);
        }
    }
}

impl ModelSource for Models<'_> {
    fn model(&self, request: &ModelRequest<'_>) -> Result<Arc<dyn Brdf>, Diagnostic> {
        let place = match request.span {
            Some(span) => {
                let at = self.sources.position(span);
                format!("{}:{}:{}", self.sources.name(span.source), at.line, at.column)
            }
            None => String::new(),
        };
        let key = format!("{request:?}");
        if let Some(brdf) = self.made.borrow().get(&key) {
            return Ok(Arc::clone(brdf));
        }
        let label = Label { material: request.material.to_owned(), place };
        let bands: &[Band] = if request.bands == 1 { &[GREY_BAND] } else { &CHECK_BANDS };
        self.check_library(request.library).map_err(|diagnostic| {
            let place = token_span(request, Token::Library);
            place.map_or_else(|| diagnostic.clone(), |span| diagnostic.clone().at(span))
        })?;
        self.guard.guard_program().map_err(Diagnostic::error)?;
        let made = self.registry.instantiate(&Request {
            library: request.library,
            model: request.model,
            words: request.words,
            numbers: request.numbers,
            bands,
            label: &label,
            folder: Some(&self.folder),
        });
        let at = |diagnostic: Diagnostic, token: Token| match token_span(request, token) {
            Some(span) => diagnostic.at(span),
            None => diagnostic,
        };
        match made {
            Ok(made) => {
                for warning in &made.warnings {
                    self.warn(&at(Diagnostic::warning(warning.clone()), Token::Model));
                }
                self.made.borrow_mut().insert(key, made.brdf.clone());
                Ok(made.brdf)
            }
            Err(error) => Err(at(Diagnostic::error(error.to_string()), error.token()).maybe_hint(error.hint())),
        }
    }
}

/// The span of a token; that of the material if the token has none.
fn token_span(request: &ModelRequest<'_>, token: Token) -> Option<radsight_diag::Span> {
    let first_number = 2 + request.words.len();
    let index = match token {
        Token::Library => 0,
        Token::Model | Token::Words | Token::Numbers => 1,
        Token::Word(word) => 2 + word,
        Token::Number(number) => first_number + number,
    };
    request.tokens.get(index).copied().or(request.span)
}

/// Reports invalid results of plugins.
pub(crate) fn report_faults(registry: Option<&Registry>) {
    let Some(registry) = registry else { return };
    for line in registry.take_messages() {
        say(&format!("radsight: {line}\n"));
    }
    for report in registry.fault_reports() {
        say(&format!("radsight: warning: {report}\n"));
    }
}
