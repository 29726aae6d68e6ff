//! `getinfo`: the headers of files.
//!
//! `getinfo [-d|+d] [file …]` prints headers, `+d` with the size and `-d` only the size; `-` prints
//! standard input without its header; `-a line …` adds lines to the header of standard input and
//! copies the rest, `-r line …` replaces lines (`NAME=` alone removes); `-c command …` pipes the
//! data through a command and adds the command to the header.

use super::files::{finish, output, read_header, refuse_own_output, standard_input, write_failed};
use crate::commands::words::Words;
use crate::disk::Commands;
use crate::failure::{Failure, Outcome, reason};
use crate::read_once;
use crate::trust::program;
use radsight_picture::{Header, Resolution};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, StdinLock, Write};
use std::path::Path;

/// Whether sizes are printed.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sizes {
    No,
    Too,
    Only,
}

/// Longest size line, bytes.
const LONGEST_LINE: u64 = 1 << 12;

/// Runs the program.
pub(super) fn run(mut words: Words<'_>) -> Outcome {
    let sizes = match words.next_if(|word| word.starts_with("-d") || word.starts_with("+d")) {
        None => Sizes::No,
        Some(word) if word.starts_with('-') => Sizes::Only,
        Some(_) => Sizes::Too,
    };
    match words.rest() {
        [] => of_standard_input(sizes),
        [word] if word == "-" => without_header(sizes),
        [option, command @ ..] if option == "-c" && !command.is_empty() => {
            with_command(sizes, command, words.commands())
        }
        [option, lines @ ..] if option == "-a" && !lines.is_empty() => change(|header| add(header, lines)),
        [option, lines @ ..] if option == "-r" && !lines.is_empty() => change(|header| replace(header, lines)),
        files => {
            files
                .iter()
                .filter(|file| file.len() > 1 && file.starts_with('-'))
                .try_for_each(|file| words.meant(file).map(drop))?;
            of_files(sizes, files)
        }
    }
}

fn bad_header(words: String) -> Failure {
    Failure::input(format!("getinfo: standard input: {words}"))
}

fn of_standard_input(sizes: Sizes) -> Outcome {
    let mut input = standard_input()?;
    let header = read_header(&mut input).map_err(bad_header)?;
    let mut text = if sizes == Sizes::Only { Vec::new() } else { header.to_bytes() };
    if sizes != Sizes::No {
        put_size(&mut input, &mut text);
    }
    print(&text)
}

fn of_files(sizes: Sizes, files: &[String]) -> Outcome {
    let mut out = output();
    for path in files {
        let mut text = path.clone().into_bytes();
        match read_once::open(Path::new(path)).map(BufReader::new) {
            // The output would be added to the file.
            Err(error) if error.kind() == io::ErrorKind::InvalidInput => {
                return Err(Failure::read(&format!("\"{path}\""), &error));
            }
            Err(_) => text.extend_from_slice(b": cannot open\n"),
            Ok(mut file) => put_file(path, &mut file, sizes, &mut text)?,
        }
        out.write_all(&text).map_err(|error| write_failed(&error))?;
    }
    finish(out)
}

fn put_file(path: &str, file: &mut BufReader<File>, sizes: Sizes, text: &mut Vec<u8>) -> Outcome {
    let header = match read_header(file) {
        Ok(header) => header,
        Err(_) if sizes == Sizes::Only => {
            text.extend_from_slice(b": bad header!\n");
            return Ok(());
        }
        Err(words) => return Err(Failure::input(format!("getinfo: {path}: {words}"))),
    };
    if sizes == Sizes::Only {
        text.extend_from_slice(b": ");
        put_size(file, text);
        return Ok(());
    }
    text.extend_from_slice(b":\n\t");
    for line in header.lines() {
        text.extend_from_slice(line);
        text.extend_from_slice(b"\n\t");
    }
    text.push(b'\n');
    if sizes == Sizes::Too {
        text.push(b'\t');
        put_size(file, text);
    }
    Ok(())
}

/// Adds the size of a picture, or the cube of an octree.
fn put_size(source: &mut impl BufRead, text: &mut Vec<u8>) {
    const OCTREE: u8 = 1;
    let mut line = Vec::new();
    let mut limited = source.take(LONGEST_LINE);
    match limited.fill_buf().ok().and_then(|bytes| bytes.first().copied()) {
        Some(b'+' | b'-') => {
            let _ = limited.read_until(b'\n', &mut line);
            text.extend_from_slice(&line);
        }
        Some(OCTREE) => {
            let _ = limited.read_exact(&mut [0; 2]);
            for part in 0..4 {
                line.clear();
                let _ = limited.read_until(0, &mut line);
                text.extend(line.iter().filter(|byte| **byte != 0));
                text.push(if part < 3 { b' ' } else { b'\n' });
            }
        }
        _ => text.extend_from_slice(b"unknown file type\n"),
    }
}

fn without_header(sizes: Sizes) -> Outcome {
    let mut input = standard_input()?;
    read_header(&mut input).map_err(bad_header)?;
    if sizes == Sizes::Only {
        read_resolution(&mut input)?;
    }
    copy_rest(input, Vec::new())
}

fn read_resolution(source: &mut impl BufRead) -> Result<Resolution, Failure> {
    let mut line = Vec::new();
    source.take(LONGEST_LINE).read_until(b'\n', &mut line).map_err(|error| bad_header(reason(&error)))?;
    Resolution::read(&line, 0).map(|(found, _)| found).map_err(|error| bad_header(error.to_string()))
}

/// Copies standard input with another header.
fn change(change: impl FnOnce(Header) -> Header) -> Outcome {
    let mut input = standard_input()?;
    let header = read_header(&mut input).map_err(bad_header)?;
    let format = header.format().map(|format| format.into_owned());
    let mut changed = change(header);
    if let Some(format) = format {
        changed.push_variable("FORMAT", &format);
    }
    copy_rest(input, changed.to_bytes())
}

fn copy_rest(mut input: StdinLock<'_>, start: Vec<u8>) -> Outcome {
    let mut out = output();
    let copied = out.write_all(&start).and_then(|()| io::copy(&mut input, &mut out));
    copied.map_err(|error| write_failed(&error))?;
    finish(out)
}

fn add(mut header: Header, lines: &[String]) -> Header {
    header.remove("FORMAT");
    for line in lines {
        header.push_line(line.strip_suffix('\n').unwrap_or(line));
    }
    header
}

fn replace(header: Header, lines: &[String]) -> Header {
    let mut changed = Header::default();
    for line in header.lines() {
        let is_format = line.starts_with(b"FORMAT=");
        if !is_format && !lines.iter().any(|new| takes_place(new.as_bytes(), line)) {
            changed.push_line(&String::from_utf8_lossy(line));
        }
    }
    for line in lines.iter().map(|line| line.trim_end()) {
        let start = line.len() - line.trim_start().len();
        let inner = line.as_bytes().get(start + 1..line.len().saturating_sub(1)).unwrap_or_default();
        if inner.iter().any(|byte| *byte == b'=' || byte.is_ascii_whitespace()) {
            changed.push_line(line);
        }
    }
    changed
}

/// Whether a new line replaces an old one: both have the same variable, or the same program.
fn takes_place(new: &[u8], old: &[u8]) -> bool {
    let is_indented = |line: &[u8]| line.first().is_some_and(u8::is_ascii_whitespace);
    if is_indented(new) && !is_indented(old) {
        return false;
    }
    let (new, old) = if is_indented(new) { (new.trim_ascii_start(), old.trim_ascii_start()) } else { (new, old) };
    let is_end = |byte: &u8| byte.is_ascii_whitespace();
    for at in 0.. {
        match (new.get(at), old.get(at)) {
            (Some(b'='), Some(b'=')) => return at > 0,
            (None, Some(b'=')) => return at > 0,
            (Some(a), Some(b)) if a == b && !is_end(a) => {}
            (Some(a), b) => return at > 0 && is_end(a) && b.is_none_or(is_end),
            (None, _) => return false,
        }
    }
    false
}

/// Adds the command to the header and pipes the rest of standard input through it.
fn with_command(sizes: Sizes, command: &[String], commands: Commands) -> Outcome {
    let permit = commands.permit(&command.join(" "))?;
    refuse_own_output()?;
    // Read single bytes, since buffered data would be lost for the command.
    let mut input = BufReader::with_capacity(1, unbuffered_input().map_err(|error| bad_header(reason(&error)))?);
    let mut header = read_header(&mut input).map_err(bad_header)?;
    let format = header.format().map(|format| format.into_owned());
    header.remove("FORMAT");
    header.push_command(command.iter().map(String::as_str));
    if let Some(format) = format {
        header.push_variable("FORMAT", &format);
    }
    let mut text = header.to_bytes();
    if sizes != Sizes::No {
        let resolution = read_resolution(&mut input)?;
        if sizes == Sizes::Too {
            text.extend_from_slice(format!("{resolution}\n").as_bytes());
        }
    }
    print(&text)?;
    let status = program(permit, command[0].as_ref()).args(&command[1..]).status();
    let failed = |words: &str| Failure::fault(format!("getinfo: \"{}\" {words}", command[0]));
    match status {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(failed(&format!("ended with {status}"))),
        Err(error) => Err(failed(&format!("cannot be run: {}", reason(&error)))),
    }
}

#[cfg(unix)]
fn unbuffered_input() -> io::Result<File> {
    use std::os::fd::AsFd;
    Ok(File::from(io::stdin().as_fd().try_clone_to_owned()?))
}

#[cfg(not(unix))]
fn unbuffered_input() -> io::Result<io::Stdin> {
    Ok(io::stdin())
}

fn print(text: &[u8]) -> Outcome {
    let mut out = output();
    out.write_all(text).map_err(|error| write_failed(&error))?;
    finish(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_replaced_by_their_variable_or_program() {
        for (new, old, expected) in [
            ("VIEW=", "VIEW= -vtv", true),
            ("EXPOSURE=2", "EXPOSURE=3", true),
            ("EXPOSURE", "EXPOSURE=3", true),
            ("EXPOSURE=2", "EXPOSURES=3", false),
            ("pfilt -x 2", "pfilt -1", true),
            ("pfilt -x 2", "pfiltered", false),
            ("EXPOSURE=2", "\tEXPOSURE=2", false),
            ("\tEXPOSURE=2", "\tEXPOSURE=7", true),
        ] {
            assert_eq!(takes_place(new.as_bytes(), old.as_bytes()), expected, "{new} {old}");
        }
    }
}
