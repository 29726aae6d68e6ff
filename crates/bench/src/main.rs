//! Time, error and memory of radsight compared with real Radiance, in one run on one machine.
//!
//! `radsight-bench capture [FIGURE…]` captures the paper's figures with several numbers of samples
//! and requested errors, traces the same camera rays with real `rtrace`, compares all exposures
//! with the truth, and reports the ratio of Radiance's time at equal error. The programs run one
//! after another, each in its own process.
//!
//! `radsight-bench race` renders many scenes with radsight, real Radiance and Mitsuba 3, and
//! reports the time of each to an error.
//!
//! `radsight-bench commands` runs published `rpict` commands unchanged with both programs: time,
//! and error relative to the truth.
//!
//! `radsight-bench rooms` requests errors in random rooms, and reports which are reached and
//! whether the reported errors are true.
//!
//! `radsight-bench sensors` computes a few sensor points in rooms and outdoors many times: mean,
//! deviation and time, with real `rtrace`.
//!
//! `radsight-bench rays` traces incoherent rays through a million triangles, with Embree and real
//! `rtrace`.
//!
//! `radsight-bench scaling` reports how time and memory grow with triangles, lights, pixels and
//! threads.
//!
//! `radsight-bench load` writes large scenes as text and measures the time from text to a
//! hierarchy, with `oconv`.
//!
//! `radsight-bench plugin` captures with a built-in model and the same model in a plugin, and
//! reports the cost of the plugin.
//!
//! Real Radiance is found through `RADSIGHT_RADIANCE` (a folder with `bin` and `lib`), otherwise on
//! PATH. Processor time is that of the child processes, so other work on the machine matters only
//! through shared caches.
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

/// The allocator of the program: the placement of memory affects the speed of rays.
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
