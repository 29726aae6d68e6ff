//! Both ends of the pipe between the program and its children.

use super::CheckOptions;
use super::job::{Request, Response, perform};
use std::io::{BufRead, Read, Write};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Begins the line of the answer: a plugin may print to standard output as well.
const MARK: &str = "\u{1}radsight-plugin-check ";
/// No answer and no complaint is longer.
const MOST_OUTPUT_BYTES: u64 = 1 << 20;

/// What the hidden command does: reads one request from `input`, performs it, writes the answer to `output`.
///
/// # Errors
/// When the request cannot be read or the answer not be written.
pub fn child_main(input: &mut dyn BufRead, output: &mut dyn Write) -> std::io::Result<()> {
    crate::install_crash_messages();
    let mut line = String::new();
    input.take(MOST_OUTPUT_BYTES).read_line(&mut line)?;
    let request: Request = serde_json::from_str(&line)?;
    let response = perform(&request);
    writeln!(output, "\n{MARK}{}", serde_json::to_string(&response)?)?;
    output.flush()
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
    let mut child = Command::new(&options.child.program)
        .args(&options.child.arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()?;
    let line = serde_json::to_string(request)? + "\n";
    // A child that dies before it reads is seen by its exit status.
    let _ = child.stdin.take().map(|mut input| input.write_all(line.as_bytes()));
    Ok(child)
}

fn watch(mut child: Child, started: Instant, limit: Duration) -> Response {
    let output = child.stdout.take().map(read_in_thread);
    let complaints = child.stderr.take().map(read_in_thread);
    let status = loop {
        match child.try_wait() {
            Ok(Some(status)) => break Some(status),
            Ok(None) if started.elapsed() < limit => std::thread::sleep(Duration::from_millis(5)),
            _ => {
                let _ = child.kill();
                let _ = child.wait();
                break None;
            }
        }
    };
    let text = |reader: Option<std::thread::JoinHandle<String>>| reader.and_then(|r| r.join().ok()).unwrap_or_default();
    let (output, complaints) = (text(output), text(complaints));
    let answer = output.lines().find_map(|line| serde_json::from_str::<Response>(line.split_once(MARK)?.1).ok());
    match (status, answer) {
        (None, _) => fatal(format!("hang: no answer within {} s", limit.as_secs_f64())),
        (Some(status), Some(answer)) if status.success() => answer,
        (Some(status), answer) => {
            let when = if answer.is_some() { " after the check, at the end of the process" } else { "" };
            let said = last_words(&complaints);
            fatal(format!("crash: {}{when}{said}", ended(status)))
        }
    }
}

/// A finding after which the same model is not checked further: each check would end so.
fn fatal(finding: String) -> Response {
    Response { unusable: true, ..Response::failure(finding) }
}

fn read_in_thread(stream: impl Read + Send + 'static) -> std::thread::JoinHandle<String> {
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        let mut stream = stream;
        let _ = stream.by_ref().take(MOST_OUTPUT_BYTES).read_to_end(&mut bytes);
        // The rest is thrown away, so that the child does not wait for us.
        let _ = std::io::copy(&mut stream, &mut std::io::sink());
        String::from_utf8_lossy(&bytes).into_owned()
    })
}

/// The line of the crash message if there is one, else the last line.
fn last_words(complaints: &str) -> String {
    let lines = || complaints.lines().map(str::trim).filter(|line| !line.is_empty());
    let line = lines().find(|line| line.starts_with("radsight: crash in")).or_else(|| lines().next_back());
    line.map(|line| format!("; {}", line.trim_start_matches("radsight: "))).unwrap_or_default()
}

fn ended(status: ExitStatus) -> String {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return format!("the process was ended by signal {signal}");
    }
    format!("the process ended with {status}")
}
