//! The cost of a program, including memory: a copy of this program runs it and reports the cost of
//! its only child.

use crate::capture::print;
use crate::cost::{measure, processor_time_of_children};
use crate::error::BenchError;
use std::path::Path;
use std::process::{Command, Stdio};

/// The cost of a program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Taken {
    /// Processor time, s.
    pub(crate) processor: f64,
    /// Wall time, s.
    pub(crate) wall: f64,
    /// Peak resident memory, MiB. NaN if the system does not report it.
    pub(crate) peak: f64,
}

impl Taken {
    /// The cost without a part; never negative.
    pub(crate) fn less(self, part: Taken) -> Taken {
        let less = |time: f64, part: f64| (time - part).max(MIN_TIME);
        Taken { processor: less(self.processor, part.processor), wall: less(self.wall, part.wall), peak: self.peak }
    }
}

/// Resolution of the clock, s.
const MIN_TIME: f64 = 1e-3;

/// Runs a program in `folder` through `radsight-bench cost` and reads its result; `input` and
/// `output` are its streams, or null.
pub(crate) fn taken(
    program: &mut Command,
    folder: &Path,
    input: Option<&Path>,
    output: Option<&Path>,
) -> Result<Taken, BenchError> {
    taken_within(None, program, folder, (input, output))
}

/// The same, but a process that exceeds a limit of processor time is stopped.
pub(crate) fn taken_within(
    limit: Option<u64>,
    program: &mut Command,
    folder: &Path,
    (input, output): (Option<&Path>, Option<&Path>),
) -> Result<Taken, BenchError> {
    let own = std::env::current_exe().map_err(|reason| start_error("radsight-bench", reason))?;
    let mut wrapper = Command::new(own);
    wrapper.arg("cost");
    for (option, path) in [("--input", input), ("--output", output)] {
        if let Some(path) = path {
            wrapper.arg(option).arg(path);
        }
    }
    if let Some(seconds) = limit {
        wrapper.arg("--limit").arg(seconds.to_string());
    }
    wrapper.arg("--").arg(program.get_program()).args(program.get_args()).current_dir(folder);
    for (name, value) in program.get_envs() {
        if let Some(value) = value {
            wrapper.env(name, value);
        }
    }
    let output =
        wrapper.stderr(Stdio::inherit()).output().map_err(|reason| start_error("radsight-bench cost", reason))?;
    let text = String::from_utf8_lossy(&output.stdout);
    let numbers: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    match numbers[..] {
        [processor, wall, peak] if output.status.success() => Ok(Taken { processor, wall, peak }),
        [seconds] => Err(BenchError::TookTooLong { seconds }),
        _ => Err(BenchError::Failed {
            command: program.get_program().to_string_lossy().into_owned(),
            status: output.status,
            message: text.into_owned(),
        }),
    }
}

fn start_error(program: &str, reason: std::io::Error) -> BenchError {
    BenchError::Start { program: program.to_owned(), reason, hint: "" }
}

/// `radsight-bench cost`: runs a program and prints its processor time and wall time in s and its
/// peak memory in MiB; for a stopped program, only the limit.
pub(crate) fn cost(
    words: &[String],
    limit: Option<u64>,
    input: Option<&Path>,
    output: Option<&Path>,
) -> Result<(), BenchError> {
    let Some((program, arguments)) = words.split_first() else { return Ok(()) };
    if let Some(seconds) = limit {
        limit_processor_time(seconds);
    }
    match measure(Command::new(program).args(arguments), input, output, "") {
        Ok(cost) => print(&format!("{} {} {}\n", cost.processor, cost.wall, peak_of_children())),
        Err(reason) => match limit.filter(|seconds| was_ended_at(*seconds, &reason)) {
            Some(seconds) => print(&format!("{seconds}\n")),
            None => return Err(reason),
        },
    }
    Ok(())
}

/// Whether a program failed at a limit of processor time: by its signal, or by the time used, since
/// a program that fails because one of its own processes was stopped gets no signal.
fn was_ended_at(seconds: u64, reason: &BenchError) -> bool {
    was_ended_for_its_time(reason) || processor_time_of_children() > seconds as f64 - TICKS
}

/// Tolerance of the limit, s: the system's two clocks differ by their ticks.
const TICKS: f64 = 0.1;

/// Lets the system stop every child process after a number of seconds.
#[cfg(unix)]
fn limit_processor_time(seconds: u64) {
    use nix::sys::resource::{Resource, setrlimit};
    // Without a limit a run only takes longer.
    let _ = setrlimit(Resource::RLIMIT_CPU, seconds, seconds + 1);
}

#[cfg(not(unix))]
fn limit_processor_time(_: u64) {}

/// Whether the system stopped the program for its processor time.
#[cfg(unix)]
fn was_ended_for_its_time(reason: &BenchError) -> bool {
    use std::os::unix::process::ExitStatusExt;
    let BenchError::Failed { status, .. } = reason else { return false };
    status.signal() == Some(nix::sys::signal::Signal::SIGXCPU as i32)
}

#[cfg(not(unix))]
fn was_ended_for_its_time(_: &BenchError) -> bool {
    false
}

/// Peak resident memory of any child, MiB.
#[cfg(unix)]
fn peak_of_children() -> f64 {
    use nix::sys::resource::{UsageWho, getrusage};
    // Linux counts in KiB.
    getrusage(UsageWho::RUSAGE_CHILDREN).map_or(f64::NAN, |usage| usage.max_rss() as f64 / 1024.0)
}

#[cfg(not(unix))]
fn peak_of_children() -> f64 {
    f64::NAN
}

#[cfg(all(test, unix))]
mod tests {
    use super::{measure, was_ended_for_its_time};
    use std::process::Command;

    #[test]
    fn a_program_that_exceeded_its_time_is_distinguished_from_failures() {
        let failure =
            |script: &str| measure(Command::new("sh").args(["-c", script]), None, None, "").expect_err("it fails");
        assert!(was_ended_for_its_time(&failure("kill -XCPU $$")));
        assert!(!was_ended_for_its_time(&failure("kill -TERM $$")));
        assert!(!was_ended_for_its_time(&failure("exit 24")));
    }
}
