//! The trait through which all libraries of radsight read files and run commands.
//!
//! Libraries do no input of their own: they ask a [`Loader`], so a test, a fuzz target or another
//! program decides what a name means. [`MemoryLoader`] serves files from memory; the program has a
//! loader that searches the disk as Radiance does.
//!
//! ```
//! use radsight_loader::{FileKind, Loader, MemoryLoader};
//! let loader = MemoryLoader::default().with("sky.cal", "skybright = 1;");
//! assert_eq!(loader.load("sky.cal", FileKind::Function).unwrap().bytes, b"skybright = 1;");
//! assert!(loader.load("nosuch.cal", FileKind::Function).is_err());
//! ```
#![forbid(unsafe_code)]

use std::collections::BTreeMap;
use std::io::{Cursor, Read};

/// The kind of a file. A loader may search different folders for each kind, and names it in errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FileKind {
    /// Scene text (`.rad`).
    Scene,
    /// Function definitions (`.cal`).
    Function,
    /// A table of numbers (`.dat`).
    Data,
    /// A picture (`.hdr`, `.pic`).
    Picture,
    /// A polygonal font (`.fnt`).
    Font,
    /// Text for `colortext` and the other text patterns.
    Text,
    /// A mesh (`.rtm`, `.obj`).
    Mesh,
    /// An octree (`.oct`).
    Octree,
    /// A BSDF description (`.xml`).
    Bsdf,
    /// An input of a program that reads text or numbers, such as `total`. Its name is a path:
    /// Radiance looks for it in no other folder.
    Input,
    /// Any other file that a command names.
    Other,
}

/// A file's bytes and the path under which they were found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Loaded {
    /// The path, for messages; it is not opened again.
    pub path: String,
    /// The whole content.
    pub bytes: Vec<u8>,
}

/// Why a file or the output of a command is not available.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// No searched folder has the file.
    #[error("cannot find {kind} \"{name}\"{searched}")]
    NotFound {
        /// The requested name.
        name: String,
        /// The kind of file, in words.
        kind: &'static str,
        /// The searched folders: empty, or ` in …`.
        searched: String,
    },
    /// The file is there but cannot be read.
    #[error("cannot read \"{path}\": {reason}")]
    Unreadable {
        /// Where it was found.
        path: String,
        /// The reason given by the operating system.
        reason: String,
    },
    /// The file is the one that standard output writes.
    #[error("cannot read \"{path}\": standard output goes to the same file")]
    OwnOutput {
        /// The name of the file.
        path: String,
    },
    /// External commands are not allowed.
    #[error("refused to run \"{command}\": a scene file is input, not a program")]
    CommandRefused {
        /// The command line.
        command: String,
    },
    /// An allowed external command failed.
    #[error("command \"{command}\" failed: {reason}")]
    CommandFailed {
        /// The command line.
        command: String,
        /// Exit status or error message.
        reason: String,
    },
}

impl LoadError {
    /// A file that a loader without folders does not have.
    ///
    /// ```
    /// use radsight_loader::{FileKind, LoadError};
    /// let error = LoadError::not_found("a.cal", FileKind::Function);
    /// assert_eq!(error.to_string(), "cannot find function file \"a.cal\"");
    /// ```
    #[must_use]
    pub fn not_found(name: &str, kind: FileKind) -> LoadError {
        LoadError::NotFound { name: name.to_owned(), kind: kind.words(), searched: String::new() }
    }
}

impl FileKind {
    /// The kind in words, for messages.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            FileKind::Scene => "scene file",
            FileKind::Function => "function file",
            FileKind::Data => "data file",
            FileKind::Picture => "picture",
            FileKind::Font => "font",
            FileKind::Text => "text file",
            FileKind::Mesh => "mesh",
            FileKind::Octree => "octree",
            FileKind::Bsdf => "BSDF file",
            FileKind::Input | FileKind::Other => "file",
        }
    }
}

/// Resolves names to bytes.
pub trait Loader: Sync {
    /// The whole content of the file `name`.
    ///
    /// # Errors
    /// When the file does not exist or cannot be read.
    fn load(&self, name: &str, kind: FileKind) -> Result<Loaded, LoadError>;

    /// A stream of the same content.
    ///
    /// # Errors
    /// When the file does not exist or cannot be opened.
    fn open(&self, name: &str, kind: FileKind) -> Result<Box<dyn Read>, LoadError> {
        Ok(Box::new(Cursor::new(self.load(name, kind)?.bytes)))
    }

    /// The content of a file that an earlier command of the same scene wrote.
    fn written(&self, _name: &str) -> Option<Vec<u8>> {
        None
    }

    /// The sorted names of files that match a shell pattern (`*`, `?`, `[…]`). Empty if the loader
    /// cannot list files or the text is not a pattern.
    fn names_like(&self, _pattern: &str) -> Vec<String> {
        Vec::new()
    }

    /// The seed for programs that shuffle their input. Constant by default, so that a scene is
    /// reproducible; a program that the user runs overrides it.
    fn shuffle_seed(&self) -> u64 {
        0
    }

    /// The standard output of a program that the host provides in process and a library cannot,
    /// such as a renderer; `None` if the host has no such program. `argv[0]` is the program's name.
    fn run_program(&self, _argv: &[String], _standard_input: Option<&[u8]>) -> Option<Result<Vec<u8>, LoadError>> {
        None
    }

    /// The standard output of an external command line, run by a shell. Refused unless the user
    /// allowed it.
    ///
    /// # Errors
    /// When commands are refused, or the command fails.
    fn run_command(&self, command: &str, _standard_input: Option<&[u8]>) -> Result<Vec<u8>, LoadError> {
        Err(LoadError::CommandRefused { command: command.to_owned() })
    }

    /// A stream of the same output. Whether the command failed is known only at its end.
    ///
    /// # Errors
    /// When commands are refused, or the command cannot be run.
    fn open_command(&self, command: &str) -> Result<Box<dyn Read>, LoadError> {
        Ok(Box::new(Cursor::new(self.run_command(command, None)?)))
    }
}

/// A borrowed loader, so that its owner can use it afterwards.
impl<L: Loader + ?Sized> Loader for &L {
    fn load(&self, name: &str, kind: FileKind) -> Result<Loaded, LoadError> {
        (**self).load(name, kind)
    }

    fn open(&self, name: &str, kind: FileKind) -> Result<Box<dyn Read>, LoadError> {
        (**self).open(name, kind)
    }

    fn written(&self, name: &str) -> Option<Vec<u8>> {
        (**self).written(name)
    }

    fn names_like(&self, pattern: &str) -> Vec<String> {
        (**self).names_like(pattern)
    }

    fn shuffle_seed(&self) -> u64 {
        (**self).shuffle_seed()
    }

    fn run_program(&self, argv: &[String], standard_input: Option<&[u8]>) -> Option<Result<Vec<u8>, LoadError>> {
        (**self).run_program(argv, standard_input)
    }

    fn run_command(&self, command: &str, standard_input: Option<&[u8]>) -> Result<Vec<u8>, LoadError> {
        (**self).run_command(command, standard_input)
    }

    fn open_command(&self, command: &str) -> Result<Box<dyn Read>, LoadError> {
        (**self).open_command(command)
    }
}

/// Pattern matching as in `sh`: hidden files match only an explicit dot, and folders only a `/` in
/// the pattern.
pub const AS_IN_SHELL: glob::MatchOptions =
    glob::MatchOptions { case_sensitive: true, require_literal_separator: true, require_literal_leading_dot: true };

/// Serves files from memory.
#[derive(Clone, Debug, Default)]
pub struct MemoryLoader {
    files: BTreeMap<String, Vec<u8>>,
}

impl MemoryLoader {
    /// Adds a file.
    #[must_use]
    pub fn with(mut self, name: &str, content: impl AsRef<[u8]>) -> Self {
        self.files.insert(name.to_owned(), content.as_ref().to_vec());
        self
    }
}

impl Loader for MemoryLoader {
    fn load(&self, name: &str, kind: FileKind) -> Result<Loaded, LoadError> {
        match self.files.get(name) {
            Some(bytes) => Ok(Loaded { path: name.to_owned(), bytes: bytes.clone() }),
            None => Err(LoadError::not_found(name, kind)),
        }
    }

    fn names_like(&self, pattern: &str) -> Vec<String> {
        let Ok(pattern) = glob::Pattern::new(pattern) else { return Vec::new() };
        self.files.keys().filter(|name| pattern.matches_with(name, AS_IN_SHELL)).cloned().collect()
    }
}
