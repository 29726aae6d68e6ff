//! What can go wrong.

use std::io;
use std::path::PathBuf;

/// Why the benchmark stopped.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum BenchError {
    /// A file of the repository, or one that a program should have written.
    #[error("cannot read \"{}\": {reason}", path.display())]
    Read { path: PathBuf, reason: String },
    #[error("cannot write \"{}\": {reason}", path.display())]
    Write { path: PathBuf, reason: io::Error },
    /// A program that cannot be started.
    #[error("cannot run \"{program}\": {reason}{hint}")]
    Start { program: String, reason: io::Error, hint: &'static str },
    /// A program that ended with an error.
    #[error("\"{command}\" failed ({status}): {message}")]
    Failed { command: String, status: std::process::ExitStatus, message: String },
    /// A process that was ended at its limit.
    #[error("ended after {seconds} s of processor time")]
    TookTooLong { seconds: f64 },
    /// A capture that cannot be compared with its truth.
    #[error("{what} has {found} values, expected {expected} as the truth has")]
    Size { what: String, found: usize, expected: usize },
    #[error("asked error {value} is not a share above 0, such as 0.005")]
    AskedError { value: f64 },
    #[error("no scene is called \"{name}\"; --list names them")]
    UnknownScene { name: String },
    #[error("camera file \"{}\" has no [sensor], expected one for grey values", path.display())]
    NoSensor { path: PathBuf },
    #[error("Embree stopped: {reason}")]
    Embree { reason: String },
    #[error("no temporary folder: {reason}")]
    Temporary { reason: io::Error },
}

impl BenchError {
    /// 1 the input was wrong, 2 the command line was wrong, 3 a fault stopped the work.
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            BenchError::Read { .. } | BenchError::Size { .. } | BenchError::NoSensor { .. } => 1,
            BenchError::AskedError { .. } | BenchError::UnknownScene { .. } => 2,
            _ => 3,
        }
    }
}
