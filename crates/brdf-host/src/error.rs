//! What can go wrong with a plugin, and which token of the scene is to blame.

use crate::Token;
use std::path::PathBuf;

/// A plugin, or the use that a scene makes of it, is wrong.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A scene may name a library, not a path.
    #[error("\"{name}\" is not the name of a plugin library: expected letters, digits, \"_\" and \"-\" only")]
    BadLibraryName {
        /// As written.
        name: String,
    },
    /// No such library in any place that is searched.
    #[error("cannot find plugin library \"{name}\"{searched}")]
    LibraryNotFound {
        /// As written.
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
        /// What the system said.
        reason: String,
    },
    /// The file is something else.
    #[error("\"{}\" is not a shared library: {found}", path.display())]
    NotALibrary {
        /// The file.
        path: PathBuf,
        /// What it is instead.
        found: String,
    },
    /// The library is for another kind of machine.
    #[error("\"{}\" was built for {found}, this program needs {expected}", path.display())]
    WrongArchitecture {
        /// The file.
        path: PathBuf,
        /// What it is for.
        found: String,
        /// What this program runs on.
        expected: String,
    },
    /// The system's loader refused it.
    #[error("cannot load plugin library \"{}\": {reason}", path.display())]
    CannotLoad {
        /// The file.
        path: PathBuf,
        /// What the loader said.
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
        /// What they should be.
        expected: u64,
    },
    /// The major versions differ.
    #[error("\"{}\" was built for version {found}.{minor} of the plugin interface, this program has {expected}.{host_minor}", path.display())]
    WrongMajor {
        /// The file.
        path: PathBuf,
        /// Of the plugin.
        found: u32,
        /// Of the plugin.
        minor: u32,
        /// Of this program.
        expected: u32,
        /// Of this program.
        host_minor: u32,
    },
    /// The plugin breaks a rule of the header.
    #[error("plugin \"{library}\" breaks the plugin interface: {what}")]
    BrokenRule {
        /// Its name.
        library: String,
        /// Which rule, how.
        what: String,
    },
    /// The library has no such model.
    #[error("plugin \"{library}\" has no model \"{model}\"; it has {known}")]
    UnknownModel {
        /// Its name.
        library: String,
        /// As written.
        model: String,
        /// The models that it has, separated by commas.
        known: String,
        /// A model with a similar name.
        similar: Option<String>,
    },
    /// A parameter does not fit the model's table.
    #[error("{message}")]
    Parameter {
        /// Which one.
        token: Token,
        /// What is wrong with it.
        message: String,
        /// What to do about it.
        hint: Option<String>,
    },
    /// The plugin refused the parameters, which fit its table.
    #[error("plugin \"{library}\" cannot make \"{model}\": {message}")]
    Refused {
        /// Its name.
        library: String,
        /// The model.
        model: String,
        /// Which parameter.
        token: Token,
        /// What it said, or the name of the status.
        message: String,
    },
    /// The process that a plugin was to run in cannot be started.
    #[error("cannot start a process for plugin \"{library}\": {reason}")]
    CannotIsolate {
        /// Its name.
        library: String,
        /// What went wrong.
        reason: String,
    },
    /// The self-check at load found something, and warnings are fatal.
    #[error("plugin \"{library}\" fails its self-check: {}", findings.join("; "))]
    SelfCheck {
        /// Its name.
        library: String,
        /// What was found.
        findings: Vec<String>,
    },
}

impl Error {
    /// Which token of the scene is to blame, for the caret.
    #[must_use]
    pub fn token(&self) -> Token {
        match self {
            Error::Parameter { token, .. } | Error::Refused { token, .. } => *token,
            Error::UnknownModel { .. } | Error::SelfCheck { .. } => Token::Model,
            _ => Token::Library,
        }
    }

    /// What to do about it.
    #[must_use]
    pub fn hint(&self) -> Option<String> {
        match self {
            Error::LibraryNotFound { similar, .. } | Error::UnknownModel { similar, .. } => {
                similar.as_ref().map(|name| format!("did you mean \"{name}\"?"))
            }
            Error::Parameter { hint, .. } => hint.clone(),
            Error::WrongMajor { .. } => Some("compile the plugin again with this program's header or SDK".to_owned()),
            Error::SelfCheck { .. } => Some("`radsight plugin check` tells more".to_owned()),
            _ => None,
        }
    }
}
