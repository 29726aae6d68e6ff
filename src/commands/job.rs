//! `radsight job`: parts of a picture or capture that other processes and machines render, and what makes one picture of them.

mod merge;
mod run;

use crate::failure::{Failure, Outcome};
use crate::file_pattern;
use crate::input::{read_camera, read_file};
use crate::output::{check_writable, write_file};
use crate::plugin_guard::PluginGuard;
use crate::trust::{Existing, Trust};
use clap::{Args, Subcommand};
use radsight::{JobTarget, RenderJob};
use radsight_camera::CameraFile;

/// What `radsight job` does.
#[derive(Debug, Subcommand)]
pub(crate) enum Job {
    /// Writes jobs for parts of a job's rows
    Split(Split),
    /// Renders a job: values and standard errors of its rows, as a float matrix
    Run(Run),
    /// Puts the parts of a picture together, in any order
    Merge(Merge),
}

#[derive(Args, Debug)]
pub(crate) struct Split {
    /// The whole job
    #[arg(value_name = "JOB.json")]
    job: String,
    /// How many parts
    #[arg(long, value_name = "N")]
    parts: usize,
    /// Names of the parts' files; %d, or %03d, is their number from 0
    #[arg(short, long, value_name = "PART%d.json")]
    output: String,
}

#[derive(Args, Debug)]
pub(crate) struct Run {
    /// The job
    #[arg(value_name = "JOB.json")]
    job: String,
    /// The values
    #[arg(short, long, value_name = "PART.mtx")]
    output: String,
    /// Only this part of the job's rows, the first is 0: so that all tasks of an array run one job
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
    /// Write what is there, though parts are missing: their rows are black
    #[arg(long)]
    partial: bool,
}

/// Runs the command.
pub(crate) fn run(command: &Job, trust: &Trust) -> Outcome {
    match command {
        Job::Split(arguments) => split(arguments, trust),
        Job::Run(arguments) => run::run(arguments, trust),
        Job::Merge(arguments) => merge::run(arguments, trust),
    }
}

fn split(arguments: &Split, trust: &Trust) -> Outcome {
    if !file_pattern::holds_number(&arguments.output) {
        let pattern = &arguments.output;
        return Err(Failure::usage(format!("output \"{pattern}\" has no %d, expected one for the part's number")));
    }
    let job = read_job(&arguments.job)?;
    let [_, rows] = picture_size(&job, camera(&job)?.as_ref())?;
    let parts = job.split(arguments.parts, rows).map_err(failure)?;
    for (number, part) in parts.iter().enumerate() {
        let (name, ..) = file_pattern::named("job", &arguments.output, "", number)?;
        let name = trust.output(&name, Existing::Kept)?;
        check_writable(&name)?;
        write_file(&name, part.to_json().as_bytes())?;
    }
    Ok(())
}

/// Reads a job. What it names are files: a job is data, and runs nothing.
fn read_job(path: &str) -> Result<RenderJob, Failure> {
    let job = RenderJob::from_json(path, &read_file(path, "job")?).map_err(failure)?;
    let camera = match &job.target {
        JobTarget::Capture { camera } => Some(camera),
        _ => None,
    };
    match job.scenes.iter().chain(camera).find(|name| name.starts_with('!') || *name == "-") {
        Some(name) => Err(Failure::input(format!("\"{path}\": \"{name}\" is no file, expected names of files"))),
        None => Ok(job),
    }
}

/// The camera of a capture.
fn camera(job: &RenderJob) -> Result<Option<CameraFile>, Failure> {
    match &job.target {
        JobTarget::Capture { camera } => read_camera(camera).map(Some),
        _ => Ok(None),
    }
}

fn picture_size(job: &RenderJob, camera: Option<&CameraFile>) -> Result<[usize; 2], Failure> {
    match camera {
        Some(file) => Ok([file.camera.columns() as usize, file.camera.rows() as usize]),
        None => job.picture_size().map_err(failure),
    }
}

fn failure(error: radsight::Error) -> Failure {
    Failure::input(error.to_string())
}
