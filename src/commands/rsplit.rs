//! `rsplit [-ih] [-iH] [-on N] [-f|-a] [-x XR -y YR] { [-oh] [-oH] [-oFORM[N]] [-tC] OUTPUT … }`:
//! distributes the fields of standard input to several outputs in turn.
//!
//! An output is a file, `-`, a command after `!`, or `.` to discard fields. It takes `N` fields:
//! text (`-oa`) that ends with C (`-t`; a line), or numbers of 4 (`-of`, `-oi`), 8 (`-od`), 2
//! (`-ow`) or 1 byte (`-ob`). Options apply to the outputs after them; `-oh` and `-oH` add the
//! header and the resolution, which the input may have (`-ih`, `-iH`).

mod options;

use super::words::Words;
use crate::disk::Commands;
use crate::failure::{Failure, Outcome, reason, say};
use crate::output::{Output, append, reserve_output};
use crate::trust::{Trust, shell};
use options::{Form, Options, Part};
use radsight_picture::{Header, Resolution};
use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Stdio};

/// Header variables that describe the storage of the data.
const STORED: [&str; 5] = ["FORMAT=", "NROWS=", "NCOLS=", "NCOMP=", "BigEndian="];

/// Runs the program; `words[0]` is its name.
pub(crate) fn run(words: &[String], trust: &Trust) -> Outcome {
    let options = Options::read(Words::new(words, trust))?;
    let mut input = BufReader::with_capacity(1 << 16, io::stdin().lock());
    let header = if options.input_header { Some(read_header(&mut input)?) } else { None };
    let resolution = match options.input_resolution {
        true => Some(read_resolution(&mut input)?),
        false => options.resolution,
    };
    let mut outputs = Outputs::open(&options)?;
    outputs.begin(&options, words, header.as_ref(), resolution.as_ref())?;
    let pixels = resolution.map(|found| found.scanline_length() as u64 * found.scanlines() as u64);
    let most = options.records.or(pixels);
    if let (Some(asked), Some(pixels)) = (options.records, pixels)
        && asked != pixels
    {
        say(&format!("rsplit: warning - -on requests {asked} records, but the resolution {pixels}\n"));
    }
    let mut written = 0;
    while most.is_none_or(|most| written < most) && outputs.put_record(&options, &mut input)? {
        written += 1;
    }
    outputs.close()?;
    if let Some(most) = most.filter(|most| written < *most) {
        say(&format!("rsplit: warning - the input ends after {written} of {most} records\n"));
    }
    Ok(())
}

/// The lines of a header without those that describe the storage.
fn read_header(input: &mut impl BufRead) -> Result<Header, Failure> {
    let mut header = Header::default();
    loop {
        let line = read_line(input)?.ok_or_else(|| {
            Failure::input("rsplit: the header of standard input (-ih) has no end, expected an empty line")
        })?;
        let line = String::from_utf8_lossy(&line);
        let line = line.trim_end_matches(['\n', '\r']);
        if line.is_empty() {
            return Ok(header);
        }
        if !STORED.iter().any(|stored| line.starts_with(stored)) {
            header.push_line(line);
        }
    }
}

fn read_resolution(input: &mut impl BufRead) -> Result<Resolution, Failure> {
    let line = read_line(input)?.unwrap_or_default();
    let read =
        Resolution::read(&line, 0).map_err(|error| Failure::input(format!("rsplit: standard input: {error}")))?;
    Ok(read.0)
}

/// `None` at the end.
fn read_line(input: &mut impl BufRead) -> Result<Option<Vec<u8>>, Failure> {
    let mut line = Vec::new();
    input.read_until(b'\n', &mut line).map_err(|error| unreadable(&error))?;
    Ok(Some(line).filter(|line| !line.is_empty()))
}

fn unreadable(error: &io::Error) -> Failure {
    Failure::input(format!("rsplit: cannot read standard input: {}", reason(error)))
}

/// The outputs of the parts.
struct Outputs {
    /// One per requested part; standard output occurs once.
    sinks: Vec<Sink>,
    /// The output of each part, if it has one.
    of_part: Vec<Option<usize>>,
    field: Vec<u8>,
}

struct Sink {
    /// For messages.
    name: String,
    writer: BufWriter<Target>,
    child: Option<Child>,
}

/// The destination of a part.
enum Target {
    Command(ChildStdin),
    /// A file to append to.
    Appended(File),
    /// An output that replaces a file of its name.
    Over(Output),
    /// An output that must not exist.
    New(Output),
}

impl Outputs {
    fn open(options: &Options) -> Result<Outputs, Failure> {
        let mut outputs = Outputs { sinks: Vec::new(), of_part: Vec::new(), field: Vec::new() };
        for part in &options.parts {
            let known = outputs.sinks.iter().position(|sink| part.name == "-" && sink.name == "-");
            let sink = match (known, part.name.as_str()) {
                (_, ".") => None,
                (Some(known), _) => Some(known),
                (None, name) => {
                    outputs.sinks.push(Sink::open(name, part, options.commands)?);
                    Some(outputs.sinks.len() - 1)
                }
            };
            outputs.of_part.push(sink);
        }
        Ok(outputs)
    }

    /// Writes the headers.
    fn begin(
        &mut self,
        options: &Options,
        words: &[String],
        header: Option<&Header>,
        resolution: Option<&Resolution>,
    ) -> Outcome {
        for place in 0..self.sinks.len() {
            let parts = || options.parts.iter().zip(&self.of_part).filter(|(_, sink)| **sink == Some(place));
            let components: usize = parts().map(|(part, _)| part.count).sum();
            // The first part determines whether standard output gets a header, the last one its
            // format.
            let (Some((first, _)), Some((last, _))) = (parts().next(), parts().next_back()) else { continue };
            let sink = &mut self.sinks[place];
            if first.header {
                let mut own = header.cloned().unwrap_or_else(|| Header::new("RADIANCE"));
                own.push_command(words.iter().map(String::as_str));
                own.push_variable("NCOMP", &components.to_string());
                if last.form.size().is_some_and(|size| size > 1) {
                    own.push_variable("BigEndian", "0");
                }
                own.push_variable("FORMAT", last.form.name());
                sink.put(&own.to_bytes())?;
            }
            if let Some(resolution) = resolution.filter(|_| first.resolution) {
                sink.put(format!("{resolution}\n").as_bytes())?;
            }
        }
        Ok(())
    }

    /// Writes one record of each part; `false` at the end of the input.
    fn put_record(&mut self, options: &Options, input: &mut impl BufRead) -> Result<bool, Failure> {
        for (part, sink) in options.parts.iter().zip(&self.of_part) {
            self.field.clear();
            let whole = match part.form {
                Form::Text => take_text(part, input, &mut self.field),
                Form::Binary { size, .. } => take_bytes(size * part.count, input, &mut self.field),
            };
            if !whole.map_err(|error| unreadable(&error))? {
                return Ok(false);
            }
            if let Some(place) = sink {
                self.sinks[*place].put(&self.field)?;
            }
            if options.skips_line_ends() {
                skip_line_end(input).map_err(|error| unreadable(&error))?;
            }
        }
        Ok(true)
    }

    fn close(self) -> Outcome {
        for sink in self.sinks {
            let Sink { name, writer, child } = sink;
            let flushed = writer.into_inner().map_err(io::IntoInnerError::into_error);
            let Some(mut child) = child else {
                match flushed.map_err(|error| Failure::write(&shown(&name), &error))? {
                    Target::Over(output) => output.commit()?,
                    Target::New(output) => output.commit_new()?,
                    Target::Appended(_) | Target::Command(_) => {}
                }
                continue;
            };
            // End the command's input.
            drop(flushed);
            // A command may end before its input; its status tells whether that is a failure.
            let status = child.wait().map_err(|error| Failure::fault(format!("rsplit: {name}: {}", reason(&error))))?;
            if !status.success() {
                return Err(Failure::input(format!("rsplit: command \"{}\" failed: {status}", &name[1..])));
            }
        }
        Ok(())
    }
}

/// Opens an output that no other part has.
fn reserved(name: &str) -> Result<Output, Failure> {
    reserve_output(name)?;
    Output::create(name)
}

impl Sink {
    fn open(name: &str, part: &Part, commands: Commands) -> Result<Sink, Failure> {
        let failed = |error: io::Error| Failure::write(&shown(name), &error);
        let mut child = None;
        let target = match name.strip_prefix('!') {
            Some(command) => {
                let started = shell(commands.permit(command)?, command).stdin(Stdio::piped()).spawn();
                let started = child.insert(started.map_err(failed)?);
                Target::Command(started.stdin.take().expect("it is piped"))
            }
            None if part.appends => Target::Appended(append(name)?),
            None if part.overwrites || name == "-" => Target::Over(reserved(name)?),
            None if Path::new(name).symlink_metadata().is_ok() => {
                return Err(Failure::usage(format!(
                    "rsplit: \"{name}\" exists, expected -f before it to overwrite it, or -a to add to it"
                )));
            }
            None => Target::New(reserved(name)?),
        };
        Ok(Sink { name: name.to_owned(), writer: BufWriter::with_capacity(1 << 16, target), child })
    }

    fn put(&mut self, bytes: &[u8]) -> Outcome {
        self.writer.write_all(bytes).map_err(|error| match self.child {
            Some(_) => {
                Failure::input(format!("rsplit: command \"{}\" ended before the end of its input", &self.name[1..]))
            }
            None => Failure::write(&shown(&self.name), &error),
        })
    }
}

impl Write for Target {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Target::Command(input) => input.write(bytes),
            Target::Appended(file) => file.write(bytes),
            Target::Over(output) | Target::New(output) => output.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Target::Command(input) => input.flush(),
            Target::Appended(file) => file.flush(),
            Target::Over(output) | Target::New(output) => output.flush(),
        }
    }
}

fn shown(name: &str) -> String {
    if name == "-" { "standard output".to_owned() } else { format!("\"{name}\"") }
}

/// The fields of a part with their separators, and the line end after them; `false` if the input
/// ends before.
fn take_text(part: &Part, input: &mut impl BufRead, text: &mut Vec<u8>) -> io::Result<bool> {
    for _ in 0..part.count {
        if !take_field(part.separator, input, text)? {
            return Ok(false);
        }
    }
    if part.separator != b'\n' {
        text.push(b'\n');
    }
    Ok(true)
}

/// Text up to and including its separator. A line end also counts as white space; leading white
/// space is skipped if the separator is a blank.
fn take_field(separator: u8, input: &mut impl BufRead, text: &mut Vec<u8>) -> io::Result<bool> {
    let is_blank = |byte: u8| byte.is_ascii_whitespace() || byte == 0x0b;
    let begin = text.len();
    loop {
        let available = input.fill_buf()?;
        if available.is_empty() {
            // The last field may have no separator.
            let found = text.len() > begin;
            if found {
                text.push(separator);
            }
            return Ok(found);
        }
        let mut used = 0;
        for &byte in available {
            used += 1;
            if separator == b' ' && text.len() == begin && is_blank(byte) {
                continue;
            }
            let byte = if byte == b'\n' && is_blank(separator) { separator } else { byte };
            text.push(byte);
            if byte == separator || separator == b' ' && is_blank(byte) {
                input.consume(used);
                return Ok(true);
            }
        }
        input.consume(used);
    }
}

fn take_bytes(count: usize, input: &mut impl BufRead, bytes: &mut Vec<u8>) -> io::Result<bool> {
    bytes.resize(count, 0);
    match input.read_exact(bytes) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(false),
        Err(error) => Err(error),
    }
}

fn skip_line_end(input: &mut impl BufRead) -> io::Result<()> {
    if input.fill_buf()?.first() == Some(&b'\n') {
        input.consume(1);
    }
    Ok(())
}
