//! `cargo xtask TASK`: what those who work on radsight do again and again.
#![forbid(unsafe_code)]

mod function_lengths;
mod package;
mod sanitize;
mod structure;
mod workspace;

use std::process::ExitCode;

/// A task by its name, with what it does.
type Task = (&'static str, &'static str, fn() -> Result<(), String>);

const TASKS: [Task; 5] = [
    ("ci", "all that must pass before a merge, as .ci/run has it", ci),
    ("lint", "format and lints alone", lint),
    ("structure", "measures crates, edges and functions, and writes them into docs/architecture.md", structure::write),
    ("sanitize", "tests the crates with unsafe code under AddressSanitizer", sanitize::check),
    ("package", "checks that each crate that is to be published can be packaged", package::check),
];

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let task = match words.as_slice() {
        [name] => TASKS.iter().find(|(known, ..)| known == name),
        _ => None,
    };
    let Some((name, _, run)) = task else {
        eprintln!("usage: cargo xtask TASK\n");
        TASKS.iter().for_each(|(name, does, _)| eprintln!("  {name:10} {does}"));
        return ExitCode::from(2);
    };
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask {name}: {error}");
            ExitCode::FAILURE
        }
    }
}

fn ci() -> Result<(), String> {
    workspace::run("bash", &[".ci/run"])
}

fn lint() -> Result<(), String> {
    workspace::run("cargo", &["fmt", "--all", "--check"])?;
    workspace::run("cargo", &["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"])
}
