//! Errors.

use std::io;
use std::path::PathBuf;

/// Why the benchmark failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum BenchError {
    /// A file of the repository, or one that a program should have written.
    #[error("cannot read \"{}\": {reason}", path.display())]
    Read { path: PathBuf, reason: String },
    #[error("cannot write \"{}\": {reason}", path.display())]
    Write { path: PathBuf, reason: io::Error },
    /// A program cannot be started.
    #[error("cannot run \"{program}\": {reason}{hint}")]
    Start { program: String, reason: io::Error, hint: &'static str },
    /// A program failed.
    #[error("\"{command}\" failed ({status}): {message}")]
    Failed { command: String, status: std::process::ExitStatus, message: String },
    /// A process was stopped at its limit.
    #[error("ended after {seconds} s of processor time")]
    TookTooLong { seconds: f64 },
    /// A capture cannot be compared with its truth.
    #[error("{what} has {found} values, expected {expected} as in the truth")]
    Size { what: String, found: usize, expected: usize },
    #[error("the requested error is {value}, expected a relative error above 0, such as 0.005")]
    AskedError { value: f64 },
    #[error("unknown scene \"{name}\"; --list prints all names")]
    UnknownScene { name: String },
    #[error("camera file \"{}\" has no [sensor], which is needed for grey values", path.display())]
    NoSensor { path: PathBuf },
    #[error("Embree stopped: {reason}")]
    Embree { reason: String },
    #[error("cannot create a temporary folder: {reason}")]
    Temporary { reason: io::Error },
}

impl BenchError {
    /// 1 wrong input, 2 wrong command line, 3 a fault.
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            BenchError::Read { .. } | BenchError::Size { .. } | BenchError::NoSensor { .. } => 1,
            BenchError::AskedError { .. } | BenchError::UnknownScene { .. } => 2,
            _ => 3,
        }
    }
}
