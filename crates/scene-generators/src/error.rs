//! What can go wrong with a command.

use radsight_loader::LoadError;

use crate::shell_words::SyntaxError;

/// Why a command gave nothing.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Neither this crate nor the caller has the program.
    #[error("unknown program \"{program}\"")]
    UnknownProgram {
        /// As written.
        program: String,
    },
    /// An argument is missing, extra, or not what the program takes.
    #[error("{program}: {mistake}\nusage: {usage}")]
    Argument {
        /// The program.
        program: String,
        /// Which argument, what it is, what was expected.
        mistake: String,
        /// The usage line.
        usage: &'static str,
        /// Index into `argv` of the wrong word; `argv.len()` when one is missing.
        argument: usize,
    },
    /// The arguments are well formed but describe something that cannot be made.
    #[error("{program}: {mistake}")]
    Impossible {
        /// The program.
        program: String,
        /// What cannot be made, and why.
        mistake: String,
    },
    /// A file or the standard input does not hold what the program reads.
    #[error("{program}: {source_name}: {mistake}")]
    Input {
        /// The program.
        program: String,
        /// File name, or `standard input`.
        source_name: String,
        /// What is wrong, and where.
        mistake: String,
    },
    /// An expression or function file is wrong.
    #[error("{program}: {message}")]
    Expression {
        /// The program.
        program: String,
        /// The rendered diagnostic of the function language.
        message: String,
        /// Index into `argv` of the expression.
        argument: Option<usize>,
    },
    /// The command asks for more than [`MAX_OUTPUT_BYTES`](crate::MAX_OUTPUT_BYTES).
    #[error("the output would be larger than {limit_bytes} bytes")]
    OutputTooLarge {
        /// The limit.
        limit_bytes: usize,
    },
    /// The command line is not one that can be run without a shell.
    #[error(transparent)]
    Syntax(#[from] SyntaxError),
    /// A file could not be loaded, or an external command was refused or failed.
    #[error(transparent)]
    Load(#[from] LoadError),
}

impl Error {
    /// The program that the message begins with, where it does.
    #[must_use]
    pub fn program(&self) -> Option<&str> {
        match self {
            Error::Argument { program, .. }
            | Error::Impossible { program, .. }
            | Error::Input { program, .. }
            | Error::Expression { program, .. } => Some(program),
            Error::UnknownProgram { .. } | Error::OutputTooLarge { .. } | Error::Syntax(_) | Error::Load(_) => None,
        }
    }

    /// Index into `argv` of the word that the error is about; `argv.len()` when a word is missing.
    #[must_use]
    pub fn argument(&self) -> Option<usize> {
        match self {
            Error::Argument { argument, .. } => Some(*argument),
            Error::Expression { argument, .. } => *argument,
            _ => None,
        }
    }
}

impl From<std::fmt::Error> for Error {
    /// The only writer that this crate formats into is a text that fails when it is full.
    fn from(_: std::fmt::Error) -> Self {
        Error::OutputTooLarge { limit_bytes: crate::MAX_OUTPUT_BYTES }
    }
}
