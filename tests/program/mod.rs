//! Runs the built program as a user does: words, standard streams, exit code.

// Each test file is a program of its own and uses a part of this.
#![allow(dead_code)]

use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::Duration;

/// Far more than any run of a test takes.
const LONGEST_RUN: Duration = Duration::from_secs(600);

/// A room with a lamp, two walls and a ball.
pub(crate) const ROOM: &str = "
void light lamp 0 0 3 20 20 20
void plastic wall 0 0 5 .6 .5 .4 .03 .1
lamp ring bulb 0 0 8 0 4 2.9 0 0 -1 0 .4
wall polygon floor 0 0 12 -3 0 0 3 0 0 3 8 0 -3 8 0
wall polygon back 0 0 12 -3 8 0 3 8 0 3 8 3 -3 8 3
wall sphere ball 0 0 4 .5 5 .6 .6
";

/// The result of a run.
#[derive(Debug)]
pub(crate) struct Run {
    /// Exit code; −1 for a signal.
    pub(crate) code: i32,
    pub(crate) output: Vec<u8>,
    pub(crate) messages: String,
}

impl Run {
    /// The output of a successful run.
    #[track_caller]
    pub(crate) fn done(self) -> Vec<u8> {
        assert_eq!(self.code, 0, "the program failed: {}", self.messages);
        self.output
    }

    /// The output of a successful run as text.
    #[track_caller]
    pub(crate) fn text(self) -> String {
        String::from_utf8(self.done()).expect("the output is text")
    }
}

/// The repository's root.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The path of a file of the paper's experiment.
pub(crate) fn gripps(name: &str) -> String {
    root().join("radiance-scenes/gripps").join(name).display().to_string()
}

/// `radsight` with these words.
pub(crate) fn command(words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_radsight"));
    command.args(words).env_remove("RAYPATH").stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Runs `radsight` with these words and nothing on standard input.
pub(crate) fn radsight(words: &[&str]) -> Run {
    finish(command(words).spawn().expect("the program starts"))
}

/// Runs `radsight` with these words and this on standard input.
pub(crate) fn radsight_with(words: &[&str], input: &[u8]) -> Run {
    run_with(&mut command(words), input)
}

/// Runs any program with this on standard input.
pub(crate) fn run_with(command: &mut Command, input: &[u8]) -> Run {
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the program starts");
    let mut pipe = child.stdin.take().expect("standard input is a pipe");
    let input = input.to_vec();
    // A program that stops at a mistake closes the pipe, so a failed write is not our error.
    let writer = thread::spawn(move || drop(pipe.write_all(&input)));
    let run = finish(child);
    writer.join().expect("the writer ends");
    run
}

/// Runs programs in a pipeline and returns the output of the last one.
#[track_caller]
pub(crate) fn pipeline(commands: Vec<Command>) -> Vec<u8> {
    let mut children: Vec<Child> = Vec::new();
    for mut command in commands {
        if let Some(before) = children.last_mut() {
            command.stdin(before.stdout.take().expect("standard output is a pipe"));
        }
        children.push(command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts"));
    }
    let last = finish(children.pop().expect("a pipeline has programs"));
    for child in children {
        finish(child).done();
    }
    last.done()
}

/// Runs any program with nothing on standard input.
pub(crate) fn finish_command(command: &mut Command) -> Run {
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    finish(command.spawn().expect("the program starts"))
}

/// Waits for the end of a program. One that does not end is killed, so that the test fails instead of lasting forever.
fn finish(mut child: Child) -> Run {
    drop(child.stdin.take());
    let output = read_all(child.stdout.take());
    let messages = read_all(child.stderr.take());
    let [output, messages] = [output, messages].map(|bytes| match bytes.recv_timeout(LONGEST_RUN) {
        Ok(bytes) => bytes,
        Err(_) => {
            child.kill().expect("a program that does not end is killed");
            panic!("the program does not end within {LONGEST_RUN:?}")
        }
    });
    let status = child.wait().expect("the program ends");
    let messages = String::from_utf8_lossy(&messages).into_owned();
    Run { code: status.code().unwrap_or(-1), output, messages }
}

/// Reads a stream to its end in a thread of its own.
fn read_all(stream: Option<impl Read + Send + 'static>) -> Receiver<Vec<u8>> {
    let (sender, receiver) = mpsc::channel();
    thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(mut stream) = stream {
            stream.read_to_end(&mut bytes).expect("a stream is read");
        }
        // Nobody receives it where the program was killed.
        let _ = sender.send(bytes);
    });
    receiver
}

/// A temporary folder with text files.
pub(crate) struct Folder(tempfile::TempDir);

impl AsRef<Path> for Folder {
    fn as_ref(&self) -> &Path {
        self.0.path()
    }
}

impl Folder {
    pub(crate) fn new() -> Folder {
        Folder(tempfile::tempdir().expect("a temporary folder"))
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The name of a file in the folder, as a word of a command line.
    pub(crate) fn word(&self, name: &str) -> String {
        self.path(name).display().to_string()
    }

    /// Writes a file and gives its name.
    pub(crate) fn file(&self, name: &str, text: impl AsRef<[u8]>) -> String {
        File::create(self.path(name)).and_then(|mut file| file.write_all(text.as_ref())).expect("a file is written");
        self.word(name)
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        let mut bytes = Vec::new();
        File::open(self.path(name)).and_then(|mut file| file.read_to_end(&mut bytes)).expect("a file is read");
        bytes
    }

    /// Names of everything in the folder, sorted.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = self.0.path().read_dir().expect("the folder is read");
        let mut names: Vec<String> =
            entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}
