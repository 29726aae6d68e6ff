//! How the program ends when it cannot do what was asked.

use crate::output::{append, write_standard_output};
use radsight_diag::{Diagnostic, Severity, SourceMap};
use radsight_picture::Header;
use std::fs::File;
use std::io::{self, Write};
use std::process::ExitCode;
use std::sync::OnceLock;

/// What a command gives.
pub(crate) type Outcome = Result<(), Failure>;

/// Why the work stopped, with the exit code that says so.
#[derive(Debug)]
pub(crate) struct Failure {
    kind: FailureKind,
    message: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FailureKind {
    /// Nothing is wrong: help was asked for, or the reader of our output went away.
    Success,
    /// Nothing is wrong either: an option asked for a text on standard output instead of the work.
    Answer,
    /// Exit code 1.
    Input,
    /// Exit code 2.
    Usage,
    /// Exit code 3.
    Fault,
}

/// Messages that are printed of one kind; the rest are counted.
const MOST_MESSAGES: usize = 20;

impl Failure {
    /// The input is wrong.
    pub(crate) fn input(message: impl Into<String>) -> Failure {
        Failure { kind: FailureKind::Input, message: with_prefix(&message.into()) }
    }

    /// The command line is wrong.
    pub(crate) fn usage(message: impl Into<String>) -> Failure {
        Failure { kind: FailureKind::Usage, message: with_prefix(&message.into()) }
    }

    /// A limit or a fault stopped the work.
    pub(crate) fn fault(message: impl Into<String>) -> Failure {
        Failure { kind: FailureKind::Fault, message: with_prefix(&message.into()) }
    }

    /// An option asked for a text instead of the work, as `-version` does.
    pub(crate) fn answer(text: impl Into<String>) -> Failure {
        Failure { kind: FailureKind::Answer, message: text.into() }
    }

    /// What the argument parser says; help and version are no failure.
    pub(crate) fn from_clap(error: clap::Error) -> Failure {
        if error.use_stderr() {
            return Failure { kind: FailureKind::Usage, message: error.to_string() };
        }
        if let Err(error) = error.print().and_then(|()| io::stdout().flush()) {
            return Failure::write("standard output", &error);
        }
        Failure { kind: FailureKind::Success, message: String::new() }
    }

    /// Diagnostics about input, all of them.
    pub(crate) fn diagnostics(diagnostics: &[Diagnostic], sources: &SourceMap) -> Failure {
        Failure { kind: FailureKind::Input, message: render(diagnostics, sources) }
    }

    /// A write that failed. A reader that went away is success.
    pub(crate) fn write(what: &str, error: &io::Error) -> Failure {
        if error.kind() == io::ErrorKind::BrokenPipe {
            return Failure { kind: FailureKind::Success, message: String::new() };
        }
        Failure::fault(format!("cannot write {what}: {}", reason(error)))
    }

    /// A read that failed. An input that is an output, too, is a mistake of the command line.
    pub(crate) fn read(what: &str, error: &io::Error) -> Failure {
        let message = format!("cannot read {what}: {}", reason(error));
        match error.kind() {
            io::ErrorKind::InvalidInput => Failure::usage(message),
            _ => Failure::input(message),
        }
    }

    /// What is to be said.
    pub(crate) fn message(&self) -> &str {
        self.message.trim_end()
    }

    /// Prints the message and gives the exit code.
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

/// What the library says of an input.
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

/// The system's words for an error, without its number.
pub(crate) fn reason(error: &io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_lowercase()
}

/// Says something on standard error. Nobody may be listening, which is no failure.
///
/// Messages quote what files and arguments say; nothing in those may speak to the terminal.
pub(crate) fn say(text: &str) {
    let speaks_to_terminal = |c: char| c.is_control() && c != '\n' && c != '\t';
    let text = text.replace(speaks_to_terminal, "\u{fffd}");
    match ELSEWHERE.get() {
        Some(mut file) => drop(file.write_all(text.as_bytes())),
        None => drop(io::stderr().write_all(text.as_bytes())),
    }
}

/// The file that messages go to instead of standard error.
static ELSEWHERE: OnceLock<File> = OnceLock::new();

/// What stands before the messages of each run in a file, as Radiance writes it.
pub(crate) const MESSAGES_MARK: &str = "**************";

/// Sends all messages from now on to the end of a file (Radiance's `-e`), after the command line.
pub(crate) fn say_in(path: &str, words: &[String]) -> Outcome {
    if ELSEWHERE.set(append(path)?).is_ok() {
        let mut command = Header::default();
        command.push_command(words.iter().map(String::as_str));
        let command = String::from_utf8_lossy(&command.to_bytes()).into_owned();
        say(&format!("{MESSAGES_MARK}\n*** PID {:5}: {command}", std::process::id()));
    }
    Ok(())
}

/// Diagnostics as text, the most serious ones kept when there are too many.
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
