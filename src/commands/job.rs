//! `radsight job`: parts of a picture, a capture or a list of rays for other processes and
//! machines, and what makes one of them.

mod cache;
mod inputs;
mod merge;
mod run;
mod split;

use crate::failure::{Failure, Outcome};
use crate::plugin_guard::PluginGuard;
use crate::trust::Trust;
use clap::{Args, Subcommand};

/// What `radsight job` does.
#[derive(Debug, Subcommand)]
pub(crate) enum Job {
    /// Writes jobs for parts of a job: rows, tiles or ranges of rays
    Split(Split),
    /// Fills the irradiance cache that all parts of a job have in common
    Cache(Cache),
    /// Renders a job: values and standard errors of its part, as a float matrix
    Run(Run),
    /// Puts the parts of a picture together, in any order
    Merge(Merge),
}

#[derive(Args, Debug)]
pub(crate) struct Split {
    /// The whole job
    #[arg(value_name = "JOB.json")]
    job: String,
    /// Number of parts, each with about the same number of rows or rays
    #[arg(long, value_name = "N", required_unless_present_any = ["tiles", "rays"], conflicts_with_all = ["tiles", "rays"])]
    parts: Option<usize>,
    /// Rectangles of at most WxH pixels, such as 64x64
    #[arg(long, value_name = "WxH", conflicts_with = "rays")]
    tiles: Option<String>,
    /// Ranges of at most N rays
    #[arg(long, value_name = "N")]
    rays: Option<usize>,
    /// Names of the parts' files; %d, or %03d, is their number from 0
    #[arg(short, long, value_name = "PART%d.json")]
    output: String,
}

#[derive(Args, Debug)]
pub(crate) struct Cache {
    /// The job
    #[arg(value_name = "JOB.json")]
    job: String,
    /// The cache, which the job names as its "irradiance_cache"
    #[arg(short, long, value_name = "FILE")]
    output: String,
    /// Threads [default: one for each processor]
    #[arg(long)]
    threads: Option<usize>,
    #[command(flatten)]
    plugin_guard: PluginGuard,
}

#[derive(Args, Debug)]
pub(crate) struct Run {
    /// The job
    #[arg(value_name = "JOB.json")]
    job: String,
    /// The values
    #[arg(short, long, value_name = "PART.mtx")]
    output: String,
    /// Only this part of the job's rows or rays, the first is 0: so that all tasks of an array run
    /// one job
    #[arg(long, value_name = "K/N")]
    part: Option<String>,
    /// Threads [default: one for each processor]
    #[arg(long)]
    threads: Option<usize>,
    #[command(flatten)]
    plugin_guard: PluginGuard,
}

#[derive(Args, Debug)]
pub(crate) struct Merge {
    /// What `radsight job run` has written
    #[arg(value_name = "PART.mtx", required = true)]
    parts: Vec<String>,
    /// The picture, or the exposure in J/m²; the format follows from the name
    #[arg(short, long, value_name = "FILE")]
    output: String,
    /// Also writes the estimated standard error of each value, in its unit
    #[arg(long, value_name = "FILE")]
    error_map: Option<String>,
    /// Write what is there, though parts are missing: their pixels are black
    #[arg(long)]
    partial: bool,
}

/// Runs the command.
pub(crate) fn run(command: &Job, trust: &Trust) -> Outcome {
    match command {
        Job::Split(arguments) => split::run(arguments, trust),
        Job::Cache(arguments) => cache::run(arguments, trust),
        Job::Run(arguments) => run::run(arguments, trust),
        Job::Merge(arguments) => merge::run(arguments, trust),
    }
}

fn failure(error: radsight::Error) -> Failure {
    Failure::input(error.to_string())
}
