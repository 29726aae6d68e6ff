//! The program's end of a check, and the two processes of the other end: one that supervises, and
//! one that runs the plugin.

use super::CheckOptions;
use super::job::{Request, Response, perform};
use crate::guard::standard_output::StandardOutput;
use serde::{Deserialize, Serialize};
use std::io::{BufRead, Read, Write};
use std::process::{Child, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// Begins the line of an answer, among what else may be printed.
const MARK: &str = "\u{1}radsight-plugin-check ";
/// No answer and no complaint is longer.
const MOST_OUTPUT_BYTES: u64 = 1 << 20;
/// How long the supervisor may take to end what a plugin left behind.
const LONGEST_CLEARING: Duration = Duration::from_secs(5);
/// How long what was written may take to come through a pipe whose writers have ended.
const LONGEST_READING: Duration = Duration::from_secs(1);

/// The most threads of a check, for what they take of address space.
#[cfg(target_os = "linux")]
const THREADS: usize = 8;

/// What the supervisor says.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Supervised {
    answer: Option<Response>,
    /// How the plugin's process ended, unless that was well.
    ended: Option<String>,
}

/// What the hidden command does: reads one request from standard input, performs it in a process of
/// its own, and writes the answer to standard output. When it ends, nothing is left of what the
/// plugin started.
///
/// # Errors
/// When the request cannot be read or the answer not be written.
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
    // A process that ends before it reads is seen by its status.
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

/// Performs a check in a child of its own.
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
    // A child that dies before it reads is seen by its exit status. The pipe stays open: when it
    // closes, the child is to end.
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
            fatal(format!("crash: {ended}{when}{}", last_words(&complaints)))
        }
    }
}

/// The status of the child if it ends before a time.
fn wait_until(child: &mut Child, deadline: Instant) -> Option<ExitStatus> {
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return Some(status),
            Ok(None) if Instant::now() < deadline => std::thread::sleep(Duration::from_millis(5)),
            _ => return None,
        }
    }
}

/// Ends a child and all that it started: the supervisor does so when its standard input closes.
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

/// A finding after which the same model is not checked further: each check would end so.
fn fatal(finding: String) -> Response {
    Response { unusable: true, ..Response::failure(finding) }
}

/// Reads a stream to its end in a thread, which nobody has to wait for: a process that got away may
/// hold the pipe open.
fn read_in_thread(stream: impl Read + Send + 'static) -> Receiver<String> {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        let mut stream = stream;
        let _ = stream.by_ref().take(MOST_OUTPUT_BYTES).read_to_end(&mut bytes);
        // The rest is thrown away, so that the child does not wait for us.
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

/// The line of the guard's message if there is one, else the last line.
fn last_words(complaints: &str) -> String {
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
