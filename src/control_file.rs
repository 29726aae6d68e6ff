//! Control files of programs that stay alive in Radiance (`-P`, `-PP`).
//!
//! Here none does: the file keeps the command line, and a call with the same file and no scene does again what it says. No process stands in it, so who
//! ends the one that would wait in Radiance ends none. The line that is kept is a file's: it can
//! name no more than other files.

use crate::failure::{Failure, Outcome, reason};
use crate::output::write_file;
use std::fs::{self, File};
use std::io::{ErrorKind, Read};

/// The first line; Radiance has the computer and the process there.
const MARK: &str = "radsight";

/// A longer file is none of ours.
const LONGEST: u64 = 1 << 20;

/// The options that name a control file.
pub(crate) fn is_option(word: &str) -> bool {
    matches!(word, "-P" | "-PP")
}

/// Keeps a command line that names scenes, of which the first word is the program's name; where it names none, gives the one that was kept.
pub(crate) fn keep_or_recall(path: &str, words: &[String], scenes: &[String]) -> Result<Option<Vec<String>>, Failure> {
    if scenes.is_empty() { recall(path, &words[0]).map(Some) } else { keep(path, words).map(|()| None) }
}

fn keep(path: &str, words: &[String]) -> Outcome {
    read(path)?;
    if let Some(word) = words.iter().find(|word| word.contains('\n')) {
        return Err(Failure::usage(format!("control file \"{path}\": \"{word}\" has more than one line")));
    }
    let text = format!("{MARK}\n{}\n{}\n", folder(), words.join("\n"));
    write_file(path, text.as_bytes())
}

fn recall(path: &str, program: &str) -> Result<Vec<String>, Failure> {
    let wrong = |what: String| Failure::input(format!("control file \"{path}\": {what}"));
    let text = read(path)?.ok_or_else(|| {
        Failure::usage(format!("{program}: no scene is named, and control file \"{path}\" holds no command line yet"))
    })?;
    let mut lines = text.lines().skip(1).map(str::to_owned);
    let made_in = lines.next().unwrap_or_default();
    if made_in != folder() {
        return Err(wrong(format!("its command line is for the folder \"{made_in}\", expected to be called there")));
    }
    let words = without_control_file(lines.collect());
    match words.first() {
        Some(name) if name == program => Ok(words),
        name => {
            Err(wrong(format!("its command line is for {}, expected {program}", name.map_or("nothing", |name| name))))
        }
    }
}

/// What is done again, without the option that kept it.
fn without_control_file(mut words: Vec<String>) -> Vec<String> {
    while let Some(at) = words.iter().position(|word| is_option(word)) {
        words.drain(at..words.len().min(at + 2));
    }
    words
}

/// The text of a control file of ours; `None` where there is none, or nothing in it.
fn read(path: &str) -> Result<Option<String>, Failure> {
    let failed = |error: std::io::Error| Failure::input(format!("control file \"{path}\": {}", reason(&error)));
    let other = || {
        Failure::input(format!("control file \"{path}\": another program's, expected one of radsight's or a new one"))
    };
    match fs::metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(failed(error)),
        // A pipe would be waited for.
        Ok(found) if !found.is_file() => return Err(other()),
        Ok(_) => {}
    }
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(failed)?;
    file.take(LONGEST + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > LONGEST {
        return Err(other());
    }
    if bytes.is_empty() {
        return Ok(None);
    }
    let text = String::from_utf8(bytes).map_err(|_| other())?;
    if text.lines().next() == Some(MARK) { Ok(Some(text)) } else { Err(other()) }
}

/// Where the program was called.
fn folder() -> String {
    std::env::current_dir().map(|folder| folder.display().to_string()).unwrap_or_default()
}
