//! Time, error and memory of radsight beside real Radiance, in one run on one machine.
//!
//! `radsight-bench capture [FIGURE…]` captures the paper's figures at several numbers of samples and asked errors, sends the same
//! camera rays through real `rtrace`, compares all exposures with the project's truth, and says how much longer Radiance
//! takes to the same error. It runs the programs as a user would, each in a process of its own, one after the other.
//!
//! `radsight-bench race` renders many scenes with radsight, real Radiance and Mitsuba 3, and says how long each takes to an error.
//!
//! `radsight-bench commands` runs other people's `rpict` commands as they stand with both programs: time, and distance from the truth.
//!
//! `radsight-bench rooms` asks for errors in random rooms, and says which are reached and whether what is reported is true.
//!
//! `radsight-bench sensors` reads few points in rooms and outdoors again and again: mean, deviation and time beside real `rtrace`.
//!
//! `radsight-bench rays` sends rays without any order against a million triangles, beside Embree and real `rtrace`.
//!
//! `radsight-bench scaling` says how time and memory grow with triangles, lights, pixels and threads.
//!
//! `radsight-bench load` writes large scenes as text and compares the way from text to a hierarchy with `oconv`'s.
//!
//! `radsight-bench plugin` captures with a model in the program and the same model in a plugin, and says what the plugin costs.
//!
//! Real Radiance is found through `RADSIGHT_RADIANCE` (a folder with `bin` and `lib`), else on PATH. Processor time is that of the child
//! processes, so other work on the machine counts only through shared caches.
#![forbid(unsafe_code)]

mod accuracy;
mod args;
mod capture;
mod commands;
mod cost;
mod curve;
mod embree;
mod equal_error;
mod error;
mod figure;
mod generated;
mod load;
mod machine;
mod plugin;
mod race;
mod radiance;
mod radsight;
mod rays;
mod rooms;
mod run;
mod scaling;
mod sensors;
mod table;
mod taken;

use clap::Parser;
use std::process::ExitCode;

/// That of the program: where memory comes from decides how soon rays find what they look for.
#[global_allocator]
static ALLOCATOR: radsight_memory::ReportingAllocator = radsight_memory::ReportingAllocator;

fn main() -> ExitCode {
    let done = match args::Program::parse().command {
        args::Command::Capture(arguments) => capture::run(&arguments),
        args::Command::Plugin(arguments) => plugin::run(&arguments),
        args::Command::Load(arguments) => load::run(&arguments),
        args::Command::Rooms(arguments) => rooms::run(&arguments),
        args::Command::Sensors(arguments) => sensors::run(&arguments),
        args::Command::Rays(arguments) => rays::run(&arguments),
        args::Command::Scaling(arguments) => scaling::run(&arguments),
        args::Command::Race(arguments) => race::run(&arguments),
        args::Command::Commands(arguments) => commands::run(&arguments),
        args::Command::Cost { limit, input, output, words } => {
            taken::cost(&words, limit, input.as_deref(), output.as_deref())
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("radsight-bench: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}
