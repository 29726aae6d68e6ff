//! The supervisor between the program and a process that runs a plugin. It runs no plugin code.
//! When it ends, no process of the plugin is left: they are its children, or become its children
//! when their own parent ends.

use crate::child_command::{own_file, set_apart};
use rustix::event::{PollFd, PollFlags, poll};
use rustix::process::{Pid, Resource, Rlimit, Signal, WaitOptions};
use serde::{Deserialize, Serialize};
use std::process::{Child, Command, ExitStatus};
use std::time::{Duration, Instant};

/// Environment variable of a worker process; without it the process supervises a worker.
const WORKER_VARIABLE: &str = "RADSIGHT_PLUGIN_WORKER";

/// Maximum time for killing processes. A plugin that starts processes faster is left to the system.
const LONGEST_CLEARING: Duration = Duration::from_secs(2);

/// How a worker ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Ended {
    pub(crate) code: Option<i32>,
    pub(crate) signal: Option<i32>,
    /// Whether it was killed because it was no longer needed.
    pub(crate) unwanted: bool,
    /// Maximum memory of the worker or one of its children, bytes.
    pub(crate) largest_memory: u64,
}

impl Ended {
    /// Description of a process that came close to its memory limit.
    pub(crate) fn memory(&self, limit: Option<u64>) -> Option<String> {
        let limit = limit.filter(|limit| self.largest_memory >= limit / 2)?;
        let megabytes = |bytes: u64| bytes >> 20;
        let (most, limit) = (megabytes(self.largest_memory), megabytes(limit));
        Some(format!("had {most} MB of memory, the limit is {limit} MB"))
    }
}

impl std::fmt::Display for Ended {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.signal, self.code) {
            (Some(signal), _) => write!(out, "the process was ended by signal {signal}"),
            (None, Some(code)) => write!(out, "the process ended with exit code {code}"),
            (None, None) => write!(out, "the process ended"),
        }
    }
}

/// Whether this process is a worker, rather than a supervisor.
pub(crate) fn is_worker() -> bool {
    std::env::var_os(WORKER_VARIABLE).is_some()
}

/// Call it first in a worker: makes it end with its supervisor.
pub(crate) fn begin_work() {
    let _ = rustix::process::set_parent_process_death_signal(Some(Signal::KILL));
    let nothing = Rlimit { current: Some(0), maximum: Some(0) };
    let _ = rustix::process::setrlimit(Resource::Core, nothing);
}

/// This command, as a worker.
pub(crate) fn worker_command() -> std::io::Result<Command> {
    let mut command = Command::new(own_file()?);
    command.args(std::env::args_os().skip(1)).env(WORKER_VARIABLE, "1");
    set_apart(&mut command);
    Ok(command)
}

/// Makes this process the parent of a worker's orphans. Call it before starting the worker.
pub(crate) fn adopt_orphans() -> std::io::Result<()> {
    Ok(rustix::process::set_child_subreaper(Some(rustix::process::getpid()))?)
}

/// Waits until the worker ends, or until the other end of standard input is closed; then ends the
/// worker and all processes that it started.
pub(crate) fn watch(mut worker: Child) -> std::io::Result<Ended> {
    let group = Pid::from_child(&worker);
    let handle = rustix::process::pidfd_open(group, rustix::process::PidfdFlags::empty())?;
    let stdin = std::io::stdin();
    let mut watched = [PollFd::new(&stdin, PollFlags::empty()), PollFd::new(&handle, PollFlags::IN)];
    loop {
        match poll(&mut watched, None) {
            Err(rustix::io::Errno::INTR) => {}
            Err(error) => return Err(error.into()),
            Ok(_) => break,
        }
    }
    let unwanted = watched[1].revents().is_empty();
    let _ = rustix::process::kill_process_group(group, Signal::KILL);
    let _ = worker.kill();
    let status = worker.wait()?;
    clear();
    Ok(Ended { unwanted, largest_memory: largest_memory_of_children(), ..Ended::from(status) })
}

impl From<ExitStatus> for Ended {
    fn from(status: ExitStatus) -> Ended {
        let signal = std::os::unix::process::ExitStatusExt::signal(&status);
        Ended { code: status.code(), signal, ..Ended::default() }
    }
}

/// Kills all children, including those adopted meanwhile, until there are none.
fn clear() {
    let started = Instant::now();
    while started.elapsed() < LONGEST_CLEARING {
        children().into_iter().for_each(|child| {
            let _ = rustix::process::kill_process(child, Signal::KILL);
        });
        loop {
            match rustix::process::wait(WaitOptions::NOHANG) {
                Ok(Some(_)) => {}
                Ok(None) => break,
                // There are no more children.
                Err(_) => return,
            }
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// The processes whose parent is this one.
fn children() -> Vec<Pid> {
    let own = rustix::process::getpid().as_raw_pid();
    let Ok(entries) = std::fs::read_dir("/proc") else { return Vec::new() };
    let numbers = entries.filter_map(|entry| entry.ok()?.file_name().to_str()?.parse::<i32>().ok());
    numbers.filter(|number| parent_of(*number) == Some(own)).filter_map(Pid::from_raw).collect()
}

fn parent_of(process: i32) -> Option<i32> {
    let text = std::fs::read(format!("/proc/{process}/stat")).ok()?;
    // The name before it may contain anything, even brackets.
    let end_of_name = text.iter().rposition(|&byte| byte == b')')?;
    let rest = String::from_utf8_lossy(&text[end_of_name + 1..]).into_owned();
    rest.split_whitespace().nth(1)?.parse().ok()
}

fn largest_memory_of_children() -> u64 {
    // SAFETY: all-zero is a valid structure, which the system fills in.
    let usage = unsafe {
        let mut usage: libc::rusage = std::mem::zeroed();
        libc::getrusage(libc::RUSAGE_CHILDREN, &raw mut usage);
        usage
    };
    u64::try_from(usage.ru_maxrss).unwrap_or(0) << 10
}

/// Limits the plugin to this many bytes beyond the memory of the process.
pub(crate) fn limit_memory(limit: Option<u64>, threads: usize) -> std::io::Result<()> {
    /// Address space that allocators reserve for a thread without using it, and for mapped files.
    const AIR_BYTES: u64 = 1 << 30;
    const THREAD_AIR_BYTES: u64 = 128 << 20;
    let Some(limit) = limit else { return Ok(()) };
    let statistics = std::fs::read_to_string("/proc/self/statm")?;
    let pages: Vec<u64> = statistics.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let bytes = |field: usize| pages.get(field).copied().unwrap_or(0) * rustix::param::page_size() as u64;
    let set = |resource, wanted: u64| {
        // Only the superuser may exceed the maximum.
        let most = rustix::process::getrlimit(resource).maximum.map_or(wanted, |most| most.min(wanted));
        rustix::process::setrlimit(resource, Rlimit { current: Some(most), maximum: Some(most) })
    };
    set(Resource::Data, bytes(5).saturating_add(limit))?;
    let air = AIR_BYTES + THREAD_AIR_BYTES * threads as u64;
    Ok(set(Resource::As, bytes(0).saturating_add(limit).saturating_add(air))?)
}
