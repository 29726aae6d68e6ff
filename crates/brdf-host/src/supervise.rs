//! The process between the program and one that runs a plugin. It runs no code of the plugin, and
//! when it ends nothing is left of those that did: they are its children, or become so when their
//! own parent ends.

use crate::child_command::{own_file, set_apart};
use rustix::event::{PollFd, PollFlags, poll};
use rustix::process::{Pid, Resource, Rlimit, Signal, WaitOptions};
use serde::{Deserialize, Serialize};
use std::process::{Child, Command, ExitStatus};
use std::time::{Duration, Instant};

/// Set in the environment of a process that is to do the work; without it the process supervises
/// another one.
const WORKER_VARIABLE: &str = "RADSIGHT_PLUGIN_WORKER";

/// How long killing may take. A plugin that starts processes faster than they can be killed is left
/// to the system.
const LONGEST_CLEARING: Duration = Duration::from_secs(2);

/// How a worker ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Ended {
    pub(crate) code: Option<i32>,
    pub(crate) signal: Option<i32>,
    /// Whether it was killed because nobody wanted it any more.
    pub(crate) unwanted: bool,
    /// The most memory that it or a child of it occupied, bytes.
    pub(crate) largest_memory: u64,
}

impl Ended {
    /// Words for a process that came near to its limit of memory.
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

/// Whether this process is to do the work, rather than to supervise it.
pub(crate) fn is_worker() -> bool {
    std::env::var_os(WORKER_VARIABLE).is_some()
}

/// To be called first in a worker: it ends with its supervisor.
pub(crate) fn begin_work() {
    let _ = rustix::process::set_parent_process_death_signal(Some(Signal::KILL));
    let nothing = Rlimit { current: Some(0), maximum: Some(0) };
    let _ = rustix::process::setrlimit(Resource::Core, nothing);
}

/// This very command as a worker.
pub(crate) fn worker_command() -> std::io::Result<Command> {
    let mut command = Command::new(own_file()?);
    command.args(std::env::args_os().skip(1)).env(WORKER_VARIABLE, "1");
    set_apart(&mut command);
    Ok(command)
}

/// Makes this process the one to which orphans of a worker come. To be called before the worker is
/// started.
pub(crate) fn adopt_orphans() -> std::io::Result<()> {
    Ok(rustix::process::set_child_subreaper(Some(rustix::process::getpid()))?)
}

/// Waits until the worker ends, or until the other end of standard input is closed; then ends the
/// worker and all that it started.
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

/// Kills all children, and theirs as they come, until there are none.
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
                // There is no child any more.
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
    // The name before it may hold anything, brackets too.
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

/// Lets the plugin have so many bytes beyond what the process has.
pub(crate) fn limit_memory(limit: Option<u64>, threads: usize) -> std::io::Result<()> {
    /// Address space that allocators set aside for a thread without using it, and for files that
    /// are mapped.
    const AIR_BYTES: u64 = 1 << 30;
    const THREAD_AIR_BYTES: u64 = 128 << 20;
    let Some(limit) = limit else { return Ok(()) };
    let statistics = std::fs::read_to_string("/proc/self/statm")?;
    let pages: Vec<u64> = statistics.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let bytes = |field: usize| pages.get(field).copied().unwrap_or(0) * rustix::param::page_size() as u64;
    let set = |resource, wanted: u64| {
        // Nobody but the superuser may ask for more than there is.
        let most = rustix::process::getrlimit(resource).maximum.map_or(wanted, |most| most.min(wanted));
        rustix::process::setrlimit(resource, Rlimit { current: Some(most), maximum: Some(most) })
    };
    set(Resource::Data, bytes(5).saturating_add(limit))?;
    let air = AIR_BYTES + THREAD_AIR_BYTES * threads as u64;
    Ok(set(Resource::As, bytes(0).saturating_add(limit).saturating_add(air))?)
}
