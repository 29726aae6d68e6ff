//! The program's side of a check, and both processes of the other side: the supervisor, and the
//! worker that runs the plugin.

use super::CheckOptions;
use super::job::{Request, Response, perform};
use crate::guard::standard_output::StandardOutput;
use serde::{Deserialize, Serialize};
use std::io::{BufRead, Read, Write};
use std::process::{Child, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// Marks the line of an answer among other output.
const MARK: &str = "\u{1}radsight-plugin-check ";
/// Maximum length of an answer or of error output.
const MOST_OUTPUT_BYTES: u64 = 1 << 20;
/// Maximum time for the supervisor to end processes that a plugin started.
const LONGEST_CLEARING: Duration = Duration::from_secs(5);
/// Maximum time to read the remaining output of a pipe after its writers have ended.
const LONGEST_READING: Duration = Duration::from_secs(1);

/// Maximum number of threads of a check, which bounds their address space.
#[cfg(target_os = "linux")]
const THREADS: usize = 8;

/// Answer of the supervisor.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Supervised {
    answer: Option<Response>,
    /// How the plugin's process ended, if it did not end normally.
    ended: Option<String>,
}

/// Entry point of the hidden command: reads one request from standard input, runs it in a worker
/// process, and writes the answer to standard output. When it ends, no process that the plugin
/// started is left.
///
/// # Errors
/// If the request cannot be read, or the answer cannot be written.
pub fn child_main() -> std::io::Result<()> {
    #[cfg(target_os = "linux")]
    if !crate::supervise::is_worker() {
        return supervise();
    }
    #[cfg(target_os = "linux")]
    crate::supervise::begin_work();
    let mut line = String::new();
    std::io::stdin().lock().take(MOST_OUTPUT_BYTES).read_line(&mut line)?;
    let request: Request = serde_json::from_str(&line)?;
    crate::guard::install_in_child()?;
    #[cfg(target_os = "linux")]
    crate::supervise::limit_memory(request.memory, THREADS)?;
    say(&Supervised { answer: Some(perform(&request)), ended: None })
}

fn say(answer: &Supervised) -> std::io::Result<()> {
    let line = format!("\n{MARK}{}\n", serde_json::to_string(answer)?);
    StandardOutput.write_all(line.as_bytes())?;
    StandardOutput.flush()
}

#[cfg(target_os = "linux")]
fn supervise() -> std::io::Result<()> {
    let mut line = String::new();
    std::io::stdin().lock().take(MOST_OUTPUT_BYTES).read_line(&mut line)?;
    crate::supervise::adopt_orphans()?;
    let mut worker = crate::supervise::worker_command()?.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
    // The status of a process that ends before reading is reported below.
    let _ = worker.stdin.take().map(|mut input| input.write_all(line.as_bytes()));
    let output = worker.stdout.take().map(read_in_thread);
    let ended = crate::supervise::watch(worker)?;
    if ended.unwanted {
        return Ok(());
    }
    let answer = find_answer(&text_of(output)).and_then(|found| found.answer);
    let request: Option<Request> = serde_json::from_str(&line).ok();
    let memory = ended.memory(request.and_then(|request| request.memory));
    let memory = memory.map(|memory| format!("; it {memory}")).unwrap_or_default();
    let ended = (ended.code != Some(0)).then(|| format!("{ended}{memory}"));
    say(&Supervised { answer, ended })
}

/// Runs a check in a child process.
pub(super) fn run_in_child(options: &CheckOptions, request: &Request) -> (Response, Duration) {
    let started = Instant::now();
    let response = match start(options, request) {
        Ok(child) => watch(child, started, options.time_limit),
        Err(error) => {
            let program = options.child.program.display();
            Response::failure(format!("cannot start \"{program}\" for the check: {error}"))
        }
    };
    (response, started.elapsed())
}

fn start(options: &CheckOptions, request: &Request) -> std::io::Result<Child> {
    let mut command = options.child.command();
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
    let line = serde_json::to_string(request)? + "\n";
    // The exit status of a child that dies before reading is reported below. The pipe stays open:
    // closing it ends the child.
    let _ = child.stdin.as_mut().map(|input| input.write_all(line.as_bytes()));
    Ok(child)
}

fn watch(mut child: Child, started: Instant, limit: Duration) -> Response {
    let output = child.stdout.take().map(read_in_thread);
    let complaints = child.stderr.take().map(read_in_thread);
    let Some(status) = wait_until(&mut child, started + limit) else {
        end(child);
        return fatal(format!("hang: no answer within {} s", limit.as_secs_f64()));
    };
    let (output, complaints) = (text_of(output), text_of(complaints));
    let Supervised { answer, ended } = find_answer(&output).unwrap_or_default();
    let ended = ended.or_else(|| how_it_ended(status));
    match (ended, answer) {
        (None, Some(answer)) => answer,
        (ended, answer) => {
            let ended = ended.unwrap_or_else(|| "the process ended without an answer".to_owned());
            let when = if answer.is_some() { " after the check, at the end of the process" } else { "" };
            fatal(format!("crash: {ended}{when}{}", final_message(&complaints)))
        }
    }
}

/// Status of the child, if it ends before the deadline.
fn wait_until(child: &mut Child, deadline: Instant) -> Option<ExitStatus> {
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return Some(status),
            Ok(None) if Instant::now() < deadline => std::thread::sleep(Duration::from_millis(5)),
            _ => return None,
        }
    }
}

/// Ends a child and all processes that it started. The supervisor ends them when its standard input
/// closes.
fn end(mut child: Child) {
    drop(child.stdin.take());
    if cfg!(target_os = "linux") && wait_until(&mut child, Instant::now() + LONGEST_CLEARING).is_some() {
        return;
    }
    #[cfg(unix)]
    let _ =
        rustix::process::kill_process_group(rustix::process::Pid::from_child(&child), rustix::process::Signal::KILL);
    let _ = child.kill();
    let _ = child.wait();
}

/// A finding after which no further check of the same model runs, since each would end the same
/// way.
fn fatal(finding: String) -> Response {
    Response { unusable: true, ..Response::failure(finding) }
}

/// Reads a stream to its end in a detached thread: an escaped process may hold the pipe open.
fn read_in_thread(stream: impl Read + Send + 'static) -> Receiver<String> {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        let mut stream = stream;
        let _ = stream.by_ref().take(MOST_OUTPUT_BYTES).read_to_end(&mut bytes);
        // The rest is discarded, so that the child does not block.
        let _ = std::io::copy(&mut stream, &mut std::io::sink());
        let _ = sender.send(String::from_utf8_lossy(&bytes).into_owned());
    });
    receiver
}

fn text_of(reader: Option<Receiver<String>>) -> String {
    reader.and_then(|reader| reader.recv_timeout(LONGEST_READING).ok()).unwrap_or_default()
}

fn find_answer(output: &str) -> Option<Supervised> {
    output.lines().find_map(|line| serde_json::from_str(line.split_once(MARK)?.1).ok())
}

/// The guard's message if there is one, otherwise the last line.
fn final_message(complaints: &str) -> String {
    let lines = || complaints.lines().map(str::trim).filter(|line| !line.is_empty());
    let of_guard = |line: &&str| line.starts_with("radsight: crash in") || line.starts_with("radsight: fault in");
    let line = lines().find(of_guard).or_else(|| lines().next_back());
    line.map(|line| format!("; {}", line.trim_start_matches("radsight: "))).unwrap_or_default()
}

fn how_it_ended(status: ExitStatus) -> Option<String> {
    if status.success() {
        return None;
    }
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return Some(format!("the process was ended by signal {signal}"));
    }
    Some(format!("the process ended with {status}"))
}
