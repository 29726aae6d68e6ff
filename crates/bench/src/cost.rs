//! The cost of a program.

use crate::error::BenchError;
use std::fs::File;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Time of a process with its children.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Cost {
    /// Wall time, s.
    pub(crate) wall: f64,
    /// Processor time of all threads, user and system, s. NaN if the system does not report it.
    pub(crate) processor: f64,
}

/// Runs a program with its standard input and output in files, and measures it.
///
/// `hint` ends the message if the program cannot be started.
pub(crate) fn measure(
    command: &mut Command,
    input: Option<&Path>,
    output: Option<&Path>,
    hint: &'static str,
) -> Result<Cost, BenchError> {
    command.stdin(match input {
        Some(path) => Stdio::from(
            File::open(path).map_err(|error| BenchError::Read { path: path.into(), reason: error.to_string() })?,
        ),
        None => Stdio::null(),
    });
    command.stdout(match output {
        Some(path) => {
            Stdio::from(File::create(path).map_err(|reason| BenchError::Write { path: path.into(), reason })?)
        }
        None => Stdio::null(),
    });
    // Output in a pipe is small: messages only.
    command.stderr(Stdio::piped());
    let processor_before = processor_time_of_children();
    let start = Instant::now();
    let ended = command.spawn().and_then(std::process::Child::wait_with_output).map_err(|reason| {
        BenchError::Start { program: command.get_program().to_string_lossy().into_owned(), reason, hint }
    })?;
    let wall = start.elapsed().as_secs_f64();
    let processor = (processor_time_of_children() - processor_before).max(0.0);
    if !ended.status.success() {
        let message = String::from_utf8_lossy(&ended.stderr).trim().to_owned();
        return Err(BenchError::Failed { command: words(command), status: ended.status, message });
    }
    Ok(Cost { wall, processor })
}

/// A command line as text, without quotes.
fn words(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    words.map(|word| word.to_string_lossy()).collect::<Vec<_>>().join(" ")
}

/// Processor time of all ended child processes, including their own, s.
#[cfg(unix)]
pub(crate) fn processor_time_of_children() -> f64 {
    processor_time_of(nix::sys::resource::UsageWho::RUSAGE_CHILDREN)
}

/// Processor time of this process, s. NaN if the system does not report it.
#[cfg(unix)]
pub(crate) fn processor_time() -> f64 {
    processor_time_of(nix::sys::resource::UsageWho::RUSAGE_SELF)
}

#[cfg(unix)]
fn processor_time_of(who: nix::sys::resource::UsageWho) -> f64 {
    use nix::sys::time::TimeVal;
    let seconds =
        |time: TimeVal| Duration::new(time.tv_sec().unsigned_abs(), 0).as_secs_f64() + time.tv_usec() as f64 * 1e-6;
    nix::sys::resource::getrusage(who)
        .map_or(f64::NAN, |usage| seconds(usage.user_time()) + seconds(usage.system_time()))
}

#[cfg(not(unix))]
pub(crate) fn processor_time_of_children() -> f64 {
    f64::NAN
}

#[cfg(not(unix))]
pub(crate) fn processor_time() -> f64 {
    f64::NAN
}
