//! The errors that end the program.

use crate::output::{append, write_standard_output};
use radsight_diag::{Diagnostic, Severity, SourceMap};
use radsight_picture::Header;
use std::fs::File;
use std::io::{self, Write};
use std::process::ExitCode;
use std::sync::OnceLock;

/// The result of a command.
pub(crate) type Outcome = Result<(), Failure>;

/// Why the program stopped, with its exit code.
#[derive(Debug)]
pub(crate) struct Failure {
    kind: FailureKind,
    message: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FailureKind {
    /// No error: help was requested, or the reader of our output went away.
    Success,
    /// No error: an option requested a text on standard output instead of the work.
    Answer,
    /// Exit code 1.
    Input,
    /// Exit code 2.
    Usage,
    /// Exit code 3.
    Fault,
}

/// Largest number of printed messages of one kind; the others are counted.
const MOST_MESSAGES: usize = 20;

impl Failure {
    /// A failure caused by the input.
    pub(crate) fn input(message: impl Into<String>) -> Failure {
        Failure { kind: FailureKind::Input, message: with_prefix(&message.into()) }
    }

    /// A failure caused by the command line.
    pub(crate) fn usage(message: impl Into<String>) -> Failure {
        Failure { kind: FailureKind::Usage, message: with_prefix(&message.into()) }
    }

    /// A failure caused by a limit or a fault.
    pub(crate) fn fault(message: impl Into<String>) -> Failure {
        Failure { kind: FailureKind::Fault, message: with_prefix(&message.into()) }
    }

    /// A text requested by an option such as `-version`, instead of the work.
    pub(crate) fn answer(text: impl Into<String>) -> Failure {
        Failure { kind: FailureKind::Answer, message: text.into() }
    }

    /// The result of the argument parser; help and version are not failures.
    pub(crate) fn from_clap(error: clap::Error) -> Failure {
        if error.use_stderr() {
            return Failure { kind: FailureKind::Usage, message: error.to_string() };
        }
        if let Err(error) = error.print().and_then(|()| io::stdout().flush()) {
            return Failure::write("standard output", &error);
        }
        Failure { kind: FailureKind::Success, message: String::new() }
    }

    /// A failure with all diagnostics about the input.
    pub(crate) fn diagnostics(diagnostics: &[Diagnostic], sources: &SourceMap) -> Failure {
        Failure { kind: FailureKind::Input, message: render(diagnostics, sources) }
    }

    /// A failed write. A reader that went away is no failure.
    pub(crate) fn write(what: &str, error: &io::Error) -> Failure {
        if error.kind() == io::ErrorKind::BrokenPipe {
            return Failure { kind: FailureKind::Success, message: String::new() };
        }
        Failure::fault(format!("cannot write {what}: {}", reason(error)))
    }

    /// A failed read. An input that is also an output is a mistake of the command line.
    pub(crate) fn read(what: &str, error: &io::Error) -> Failure {
        let message = format!("cannot read {what}: {}", reason(error));
        match error.kind() {
            io::ErrorKind::InvalidInput => Failure::usage(message),
            _ => Failure::input(message),
        }
    }

    /// The message.
    pub(crate) fn message(&self) -> &str {
        self.message.trim_end()
    }

    /// Prints the message and returns the exit code.
    pub(crate) fn report(self) -> ExitCode {
        if self.kind == FailureKind::Answer {
            return match write_standard_output(self.message.as_bytes()) {
                Ok(()) => ExitCode::SUCCESS,
                Err(failure) => failure.report(),
            };
        }
        if !self.message.is_empty() {
            say(&self.message);
        }
        ExitCode::from(match self.kind {
            FailureKind::Success | FailureKind::Answer => 0,
            FailureKind::Input => 1,
            FailureKind::Usage => 2,
            FailureKind::Fault => 3,
        })
    }
}

/// Converts an error of the library.
impl From<radsight::Error> for Failure {
    fn from(error: radsight::Error) -> Failure {
        match error {
            radsight::Error::Scene(report)
            | radsight::Error::Camera(report)
            | radsight::Error::Material(report)
            | radsight::Error::Series(report) => Failure { kind: FailureKind::Input, message: report.to_string() },
            error => Failure::input(error.to_string()),
        }
    }
}

fn with_prefix(message: &str) -> String {
    format!("radsight: {}\n", message.trim_end())
}

/// The system's description of an error, without its number.
pub(crate) fn reason(error: &io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_lowercase()
}

/// Prints text to standard error; a missing reader is no failure.
///
/// Messages quote files and arguments, so control characters are escaped.
pub(crate) fn say(text: &str) {
    let speaks_to_terminal = |c: char| c.is_control() && c != '\n' && c != '\t';
    let text = text.replace(speaks_to_terminal, "\u{fffd}");
    match ELSEWHERE.get() {
        Some(mut file) => drop(file.write_all(text.as_bytes())),
        None => drop(io::stderr().write_all(text.as_bytes())),
    }
}

/// The file for messages, if they do not go to standard error.
static ELSEWHERE: OnceLock<File> = OnceLock::new();

/// Separator before the messages of each run in a file, as in Radiance.
pub(crate) const MESSAGES_MARK: &str = "**************";

/// Redirects all further messages to the end of a file (Radiance's `-e`), after the command line.
pub(crate) fn say_in(path: &str, words: &[String]) -> Outcome {
    if ELSEWHERE.set(append(path)?).is_ok() {
        let mut command = Header::default();
        command.push_command(words.iter().map(String::as_str));
        let command = String::from_utf8_lossy(&command.to_bytes()).into_owned();
        say(&format!("{MESSAGES_MARK}\n*** PID {:5}: {command}", std::process::id()));
    }
    Ok(())
}

/// Diagnostics as text; the most serious ones are kept if there are too many.
pub(crate) fn render(diagnostics: &[Diagnostic], sources: &SourceMap) -> String {
    let mut text = String::new();
    for severity in [Severity::Error, Severity::Warning, Severity::Note] {
        let of_kind: Vec<&Diagnostic> = diagnostics.iter().filter(|found| found.severity == severity).collect();
        for diagnostic in of_kind.iter().take(MOST_MESSAGES) {
            text.push_str(&diagnostic.render(sources));
        }
        if of_kind.len() > MOST_MESSAGES {
            let more = of_kind.len() - MOST_MESSAGES;
            let word = match severity {
                Severity::Error => "errors",
                Severity::Warning => "warnings",
                Severity::Note => "notes",
            };
            text.push_str(&format!("and {more} more {word}\n"));
        }
    }
    text
}
