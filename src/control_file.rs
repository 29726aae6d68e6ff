//! Control files of Radiance's persistent programs (`-P`, `-PP`).
//!
//! radsight starts no persistent process: the file stores the command line, and a call with the
//! same file and no scene repeats it. The file contains no process number, so a script that kills
//! the persistent process kills none. A stored command line counts as words of a file and can name
//! no more outputs than other files.

use crate::failure::{Failure, Outcome, reason};
use crate::output::write_file;
use std::fs::{self, File};
use std::io::{ErrorKind, Read};

/// The first line; Radiance stores host and process there.
const MARK: &str = "radsight";

/// Largest control file, bytes.
const LONGEST: u64 = 1 << 20;

/// Whether an option names a control file.
pub(crate) fn is_option(word: &str) -> bool {
    matches!(word, "-P" | "-PP")
}

/// Stores a command line with scenes, whose first word is the program's name; without scenes,
/// returns the stored one.
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
        Failure::usage(format!("{program}: no scene is given, and control file \"{path}\" has no command line yet"))
    })?;
    let mut lines = text.lines().skip(1).map(str::to_owned);
    let made_in = lines.next().unwrap_or_default();
    if made_in != folder() {
        return Err(wrong(format!(
            "its command line was stored in the folder \"{made_in}\", expected a call from that folder"
        )));
    }
    let words = without_control_file(lines.collect());
    match words.first() {
        Some(name) if name == program => Ok(words),
        name => {
            Err(wrong(format!("its command line is for {}, expected {program}", name.map_or("nothing", |name| name))))
        }
    }
}

/// The repeated command line without the control file option.
fn without_control_file(mut words: Vec<String>) -> Vec<String> {
    while let Some(at) = words.iter().position(|word| is_option(word)) {
        words.drain(at..words.len().min(at + 2));
    }
    words
}

/// The text of a control file; `None` if it is missing or empty.
fn read(path: &str) -> Result<Option<String>, Failure> {
    let failed = |error: std::io::Error| Failure::input(format!("control file \"{path}\": {}", reason(&error)));
    let other = || {
        Failure::input(format!(
            "control file \"{path}\": it belongs to another program, expected a control file of radsight or a new one"
        ))
    };
    match fs::metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(failed(error)),
        // Reading a pipe would block.
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

/// The working folder of the call.
fn folder() -> String {
    std::env::current_dir().map(|folder| folder.display().to_string()).unwrap_or_default()
}
