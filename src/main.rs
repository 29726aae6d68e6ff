//! The `radsight` program: arguments, standard streams, exit codes. All the work is in the crates.
#![forbid(unsafe_code)]

mod args;
mod commands;
mod disk;
mod failure;
mod input;
mod output;
mod plugins;
mod progress;
mod render_args;

use clap::Parser;
use failure::{Failure, Outcome};
use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<OsString> = std::env::args_os().collect();
    match run(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

fn run(arguments: Vec<OsString>) -> Outcome {
    let own_name = arguments.first().and_then(|name| Path::new(name).file_stem()).and_then(|name| name.to_str());
    // Called through a link with a Radiance program's name, it is that program.
    if let Some(program) = own_name.and_then(commands::radiance_program) {
        return program(&words(&arguments[1..])?);
    }
    if let Some(program) = arguments.get(1).and_then(|name| name.to_str()).and_then(commands::radiance_program) {
        return program(&words(&arguments[2..])?);
    }
    let (render, rest) = render_args::take(&words(&arguments)?)?;
    match args::Program::try_parse_from(rest) {
        Ok(program) => commands::run(program, render),
        Err(error) => Err(Failure::from_clap(error)),
    }
}

fn words(arguments: &[OsString]) -> Result<Vec<String>, Failure> {
    arguments
        .iter()
        .map(|word| {
            word.to_str()
                .map(str::to_owned)
                .ok_or_else(|| Failure::usage(format!("an argument is not UTF-8 text: \"{}\"", word.to_string_lossy())))
        })
        .collect()
}
