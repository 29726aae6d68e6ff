//! Errors of commands.

use radsight_loader::LoadError;

use crate::shell_words::SyntaxError;

/// Why a command failed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Neither this crate nor the caller provides the program.
    #[error("unknown program \"{program}\"")]
    UnknownProgram {
        /// The name as written.
        program: String,
    },
    /// An argument is missing, superfluous or invalid.
    #[error("{program}: {mistake}\nusage: {usage}")]
    Argument {
        /// The program.
        program: String,
        /// The argument, its value, and what was expected.
        mistake: String,
        /// The usage line.
        usage: &'static str,
        /// Index of the wrong word in `argv`; `argv.len()` if one is missing.
        argument: usize,
    },
    /// The arguments are valid one by one but describe an impossible object.
    #[error("{program}: {mistake}")]
    Impossible {
        /// The program.
        program: String,
        /// What is impossible, and why.
        mistake: String,
    },
    /// A file or the standard input is malformed.
    #[error("{program}: {source_name}: {mistake}")]
    Input {
        /// The program.
        program: String,
        /// File name, or `standard input`.
        source_name: String,
        /// The mistake and its position.
        mistake: String,
    },
    /// An expression or function file is wrong.
    #[error("{program}: {message}")]
    Expression {
        /// The program.
        program: String,
        /// The rendered diagnostic of the expression.
        message: String,
        /// Index of the expression in `argv`.
        argument: Option<usize>,
    },
    /// The output exceeds [`MAX_OUTPUT_BYTES`](crate::MAX_OUTPUT_BYTES).
    #[error("the output exceeds {limit_bytes} bytes")]
    OutputTooLarge {
        /// The limit.
        limit_bytes: usize,
    },
    /// The command makes more than radsight allows, where Radiance has no limit.
    #[error("{program}: {mistake}")]
    Limit {
        /// The program.
        program: String,
        /// The quantity and the limit.
        mistake: String,
        /// Index of the word in `argv` that asks for so much; `argv.len()` if there is none.
        argument: usize,
    },
    /// The command line cannot be run without a shell.
    #[error(transparent)]
    Syntax(#[from] SyntaxError),
    /// A file could not be loaded, or an external command was refused or failed.
    #[error(transparent)]
    Load(#[from] LoadError),
}

impl Error {
    /// The program named at the start of the message, if any.
    #[must_use]
    pub fn program(&self) -> Option<&str> {
        match self {
            Error::Argument { program, .. }
            | Error::Impossible { program, .. }
            | Error::Input { program, .. }
            | Error::Limit { program, .. }
            | Error::Expression { program, .. } => Some(program),
            Error::UnknownProgram { .. } | Error::OutputTooLarge { .. } | Error::Syntax(_) | Error::Load(_) => None,
        }
    }

    /// Whether radsight refuses what Radiance would try.
    #[must_use]
    pub fn is_limit(&self) -> bool {
        matches!(self, Error::OutputTooLarge { .. } | Error::Limit { .. })
    }

    /// Index in `argv` of the wrong word; `argv.len()` if one is missing.
    #[must_use]
    pub fn argument(&self) -> Option<usize> {
        match self {
            Error::Argument { argument, .. } | Error::Limit { argument, .. } => Some(*argument),
            Error::Expression { argument, .. } => *argument,
            _ => None,
        }
    }
}

impl From<std::fmt::Error> for Error {
    /// This crate formats only into a text that fails when it is full.
    fn from(_: std::fmt::Error) -> Self {
        Error::OutputTooLarge { limit_bytes: crate::MAX_OUTPUT_BYTES }
    }
}
