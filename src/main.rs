//! The `radsight` program: arguments, standard streams, exit codes. The crates do all the work.
#![forbid(unsafe_code)]

mod ambient_file;
mod args;
mod budget;
mod clock;
mod commands;
mod control_file;
mod disk;
mod expand;
mod expected_rays;
mod failure;
mod file_pattern;
mod input;
mod listed_options;
mod option_table;
mod output;
mod output_color;
mod output_format;
mod plugin_guard;
mod plugins;
mod progress;
mod ray_input;
mod read_once;
mod render_args;
mod run_record;
mod sampling_args;
mod sensor_picture;
mod switch;
mod trust;
mod view_args;

use clap::Parser;
use failure::{Failure, Outcome};
use radsight_output::interrupt;
use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;
use trust::Trust;

/// Reports exhausted memory.
#[global_allocator]
static ALLOCATOR: radsight_memory::ReportingAllocator = radsight_memory::ReportingAllocator;

fn main() -> ExitCode {
    interrupt::refuse_large_files();
    let arguments: Vec<OsString> = std::env::args_os().collect();
    match run(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

fn run(arguments: Vec<OsString>) -> Outcome {
    let (trust, words) = Trust::of_process(budget::take(words(&arguments)?)?)?;
    let own_name = words.first().and_then(|name| Path::new(name).file_stem()).and_then(|name| name.to_str());
    // A link with the name of a Radiance program runs that program, as does the name as the first
    // argument.
    let linked: Vec<String> = own_name.map(str::to_owned).into_iter().chain(words.iter().skip(1).cloned()).collect();
    if let Some(outcome) = commands::run_radiance_program(&linked, &trust) {
        return outcome;
    }
    if let Some(outcome) = commands::run_radiance_program(words.get(1..).unwrap_or_default(), &trust) {
        return outcome;
    }
    let (render, rest) = render_args::take(&words)?;
    match args::Program::try_parse_from(rest) {
        Ok(program) => commands::run(program, render, &trust),
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
