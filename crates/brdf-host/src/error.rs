//! Errors of plugins, with the token of the scene that caused them.

use crate::Token;
use std::path::PathBuf;

/// An error of a plugin, or of its use in a scene.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A scene must name a library, not a path.
    #[error("\"{name}\" is not the name of a plugin library: expected letters, digits, \"_\" and \"-\" only")]
    BadLibraryName {
        /// Name as written.
        name: String,
    },
    /// No library of this name in the searched folders.
    #[error("cannot find plugin library \"{name}\"{searched}")]
    LibraryNotFound {
        /// Name as written.
        name: String,
        /// Empty, or ` in …`.
        searched: String,
        /// A library with a similar name.
        similar: Option<String>,
    },
    /// The file cannot be read.
    #[error("cannot read plugin library \"{}\": {reason}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Error of the system.
        reason: String,
    },
    /// The file is not a shared library.
    #[error("\"{}\" is not a shared library: {found}", path.display())]
    NotALibrary {
        /// The file.
        path: PathBuf,
        /// What was found instead.
        found: String,
    },
    /// The library is for another architecture.
    #[error("\"{}\" was built for {found}, this program needs {expected}", path.display())]
    WrongArchitecture {
        /// The file.
        path: PathBuf,
        /// Architecture of the library.
        found: String,
        /// Architecture of this program.
        expected: String,
    },
    /// The system's loader rejected the file.
    #[error("cannot load plugin library \"{}\": {reason}", path.display())]
    CannotLoad {
        /// The file.
        path: PathBuf,
        /// Error of the loader.
        reason: String,
    },
    /// The exported constant is missing.
    #[error("\"{}\" is not a BRDF plugin: it exports no \"radsight_brdf_entry\"", path.display())]
    MissingEntry {
        /// The file.
        path: PathBuf,
    },
    /// The exported constant does not begin with the magic number.
    #[error("\"{}\" is not a BRDF plugin: its \"radsight_brdf_entry\" begins with {found:#018x}, expected {expected:#018x}", path.display())]
    WrongMagic {
        /// The file.
        path: PathBuf,
        /// The first eight bytes.
        found: u64,
        /// The expected magic number.
        expected: u64,
    },
    /// The major versions differ.
    #[error("\"{}\" was built for version {found}.{minor} of the plugin interface, this program has {expected}.{host_minor}", path.display())]
    WrongMajor {
        /// The file.
        path: PathBuf,
        /// Major version of the plugin.
        found: u32,
        /// Minor version of the plugin.
        minor: u32,
        /// Major version of this program.
        expected: u32,
        /// Minor version of this program.
        host_minor: u32,
    },
    /// The plugin violates the interface.
    #[error("plugin \"{library}\" breaks the plugin interface: {what}")]
    BrokenRule {
        /// Name of the library.
        library: String,
        /// The violated rule.
        what: String,
    },
    /// The library has no such model.
    #[error("plugin \"{library}\" has no model \"{model}\"; it has {known}")]
    UnknownModel {
        /// Name of the library.
        library: String,
        /// Name as written.
        model: String,
        /// Its models, separated by commas.
        known: String,
        /// A model with a similar name.
        similar: Option<String>,
    },
    /// A parameter does not fit the model's table.
    #[error("{message}")]
    Parameter {
        /// Token of the parameter.
        token: Token,
        /// What is wrong.
        message: String,
        /// Hint for the user.
        hint: Option<String>,
    },
    /// The plugin rejected parameters that fit its table.
    #[error("plugin \"{library}\" cannot create \"{model}\": {message}")]
    Refused {
        /// Name of the library.
        library: String,
        /// The model.
        model: String,
        /// Token of the parameter.
        token: Token,
        /// Message of the plugin, or name of the status.
        message: String,
    },
    /// The process of an isolated plugin cannot be started.
    #[error("cannot start a process for plugin \"{library}\": {reason}")]
    CannotIsolate {
        /// Name of the library.
        library: String,
        /// Reason of the failure.
        reason: String,
    },
    /// The self-check failed, and warnings are errors.
    #[error("plugin \"{library}\" fails its self-check: {}", findings.join("; "))]
    SelfCheck {
        /// Name of the library.
        library: String,
        /// Its findings.
        findings: Vec<String>,
    },
}

impl Error {
    /// Token of the scene that caused the error, for the caret.
    #[must_use]
    pub fn token(&self) -> Token {
        match self {
            Error::Parameter { token, .. } | Error::Refused { token, .. } => *token,
            Error::UnknownModel { .. } | Error::SelfCheck { .. } => Token::Model,
            _ => Token::Library,
        }
    }

    /// Hint for the user.
    #[must_use]
    pub fn hint(&self) -> Option<String> {
        match self {
            Error::LibraryNotFound { similar, .. } | Error::UnknownModel { similar, .. } => {
                similar.as_ref().map(|name| format!("did you mean \"{name}\"?"))
            }
            Error::Parameter { hint, .. } => hint.clone(),
            Error::WrongMajor { .. } => Some("recompile the plugin with this program's header or SDK".to_owned()),
            Error::SelfCheck { .. } => Some("run `radsight plugin check` for details".to_owned()),
            _ => None,
        }
    }
}
