//! Where records go: standard output, files whose names hold the modifier's name or the bin's number, commands.

use super::bins::Bins;
use super::options::Options;
use crate::clock::greenwich_time;
use crate::failure::{Failure, Outcome, reason};
use crate::input::program_history;
use crate::output::beside;
use crate::output_format::OutputFormat;
use radsight_picture::{Resolution, encode_rgbe};
use radsight_pinhole::stream::NumberFormat;
use std::collections::HashMap;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};

/// Bytes that all files together hold back.
const MOST_HELD: usize = 1 << 24;
/// All that is written to.
pub(super) struct Streams<'o> {
    options: &'o Options,
    streams: Vec<Stream>,
    /// The stream of each bin.
    of_bin: Vec<usize>,
    held: usize,
}

struct Stream {
    target: Target,
    held: Vec<u8>,
}

enum Target {
    StandardOutput,
    /// Written aside, so that the file appears when it is whole. Opened only to add to it: there may be more than can be open at once.
    File {
        name: String,
        aside: PathBuf,
    },
    /// `None` when it has ended.
    Command {
        name: String,
        child: Option<Child>,
    },
}

/// A stream in the making.
struct Planned {
    name: Option<String>,
    /// The modifier and the bin that its name holds.
    modifier: Option<String>,
    bin: Option<usize>,
    /// Values in a record.
    values: usize,
}

impl<'o> Streams<'o> {
    /// Opens all of them and writes their headers.
    pub(super) fn open(options: &'o Options, bins: &Bins) -> Result<Streams<'o>, Failure> {
        let (planned, of_bin) = plan(options, bins)?;
        let mut streams = Vec::new();
        for planned in &planned {
            let target = match &planned.name {
                None => Target::StandardOutput,
                Some(name) => Target::open(name, options.overwrites)?,
            };
            streams.push(Stream { target, held: head(options, planned) });
        }
        let mut streams = Streams { options, streams, of_bin, held: 0 };
        streams.flush()?;
        Ok(streams)
    }

    /// Writes a record: a value for each bin of each modifier.
    pub(super) fn put(&mut self, values: &[[f64; 3]]) -> Outcome {
        for (value, stream) in values.iter().zip(&self.of_bin) {
            encode(*value, self.options.output_format, &mut self.streams[*stream].held);
        }
        if self.options.output_format == OutputFormat::Numbers(NumberFormat::Ascii) {
            self.streams.iter_mut().for_each(|stream| stream.held.push(b'\n'));
        }
        self.held += size_of_val(values);
        if self.held > MOST_HELD {
            self.flush()?;
        }
        Ok(())
    }

    /// Sends on what is held back.
    pub(super) fn flush(&mut self) -> Outcome {
        self.held = 0;
        self.streams.iter_mut().try_for_each(Stream::flush)
    }

    /// Ends all of them.
    pub(super) fn finish(&mut self) -> Outcome {
        self.flush()?;
        self.streams.iter_mut().try_for_each(Stream::finish)
    }
}

impl Drop for Streams<'_> {
    fn drop(&mut self) {
        for stream in &mut self.streams {
            if let Target::File { aside, .. } = &stream.target {
                let _ = fs::remove_file(aside);
            }
        }
    }
}

impl Stream {
    fn flush(&mut self) -> Outcome {
        let held = std::mem::take(&mut self.held);
        if held.is_empty() {
            return Ok(());
        }
        let (written, what) = match &mut self.target {
            Target::StandardOutput => {
                let mut out = io::stdout().lock();
                (out.write_all(&held).and_then(|()| out.flush()), "standard output".to_owned())
            }
            Target::File { name, aside } => {
                let file = File::options().append(true).open(aside);
                (file.and_then(|mut file| file.write_all(&held)), format!("\"{name}\""))
            }
            Target::Command { name, child } => {
                let input = child.as_mut().and_then(|child| child.stdin.as_mut());
                let written = input.map_or(Ok(()), |input| input.write_all(&held).and_then(|()| input.flush()));
                (written, format!("to \"{name}\""))
            }
        };
        written.map_err(|error| Failure::write(&what, &error))
    }

    fn finish(&mut self) -> Outcome {
        match &mut self.target {
            Target::StandardOutput => Ok(()),
            Target::File { name, aside } => {
                fs::rename(aside, &*name).map_err(|error| Failure::write(&format!("\"{name}\""), &error))
            }
            Target::Command { name, child } => {
                let Some(mut child) = child.take() else { return Ok(()) };
                drop(child.stdin.take());
                match child.wait() {
                    Ok(status) if status.success() => Ok(()),
                    Ok(status) => Err(Failure::fault(format!("rcontrib: command \"{name}\" failed: {status}"))),
                    Err(error) => Err(Failure::fault(format!("rcontrib: command \"{name}\": {}", reason(&error)))),
                }
            }
        }
    }
}

impl Target {
    fn open(name: &str, overwrites: bool) -> Result<Target, Failure> {
        if let Some(command) = name.strip_prefix('!') {
            let child = Command::new("sh").args(["-c", command]).stdin(Stdio::piped()).spawn();
            let child = child
                .map_err(|error| Failure::fault(format!("rcontrib: cannot run \"{command}\": {}", reason(&error))))?;
            return Ok(Target::Command { name: command.to_owned(), child: Some(child) });
        }
        let path = PathBuf::from(name);
        if path.exists() && !overwrites {
            return Err(Failure::fault(format!("cannot write \"{name}\": it exists, expected -fo+ to write over it")));
        }
        let aside = beside(&path);
        File::create(&aside).map_err(|error| Failure::write(&format!("\"{name}\""), &error))?;
        Ok(Target::File { name: name.to_owned(), aside })
    }
}

/// The streams, and which of them each bin goes to.
fn plan(options: &Options, all_bins: &Bins) -> Result<(Vec<Planned>, Vec<usize>), Failure> {
    let mut planned: Vec<Planned> = Vec::new();
    let mut by_name: HashMap<Option<String>, usize> = HashMap::new();
    let mut of_bin = Vec::new();
    for (index, tracked) in options.tracked.iter().enumerate() {
        let bins = all_bins.of_modifier(index);
        // Pictures have one value a pixel: where modifiers share numbered files, each has numbers of its own.
        let mut first = 0;
        if let (OutputFormat::Pixels, Some(pattern)) = (options.output_format, &tracked.output) {
            while pattern_holds_bin(pattern) && by_name.contains_key(&Some(named(pattern, &tracked.name, first)?.0)) {
                first += 1;
            }
        }
        for bin in 0..bins {
            let (name, modifier, number) = match &tracked.output {
                None => (None, None, None),
                Some(pattern) => {
                    let (name, has_modifier, has_bin) = named(pattern, &tracked.name, first + bin)?;
                    (Some(name), has_modifier.then(|| tracked.name.clone()), has_bin.then_some(first + bin))
                }
            };
            let stream = *by_name.entry(name.clone()).or_insert_with(|| {
                planned.push(Planned { name, modifier, bin: number, values: 0 });
                planned.len() - 1
            });
            if planned[stream].values == 0 && planned[stream].modifier.is_none() {
                planned[stream].modifier = Some(tracked.name.clone()).filter(|_| bins == 1 || number.is_some());
            } else if planned[stream].values > 0 && !matches!(&tracked.output, Some(pattern) if pattern.contains("%s"))
            {
                planned[stream].modifier = None;
            }
            planned[stream].values += 1;
            of_bin.push(stream);
        }
    }
    Ok((planned, of_bin))
}

fn pattern_holds_bin(pattern: &str) -> bool {
    named(pattern, "", 0).is_ok_and(|(_, _, holds_bin)| holds_bin)
}

/// A file's name, and whether it holds the modifier's name and the bin's number: `%s`, `%d` (also `%03d`, `%o`, `%x`), `%%`.
fn named(pattern: &str, modifier: &str, bin: usize) -> Result<(String, bool, bool), Failure> {
    let wrong =
        || Failure::usage(format!("rcontrib: output \"{pattern}\" holds an unknown %, expected %s once and %d once"));
    let (mut name, mut has_modifier, mut has_bin) = (String::new(), false, false);
    let mut rest = pattern;
    while let Some(at) = rest.find('%') {
        name.push_str(&rest[..at]);
        rest = &rest[at + 1..];
        let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let width: usize = if digits == 0 { 0 } else { rest[..digits].parse().map_err(|_| wrong())? };
        const WIDEST: usize = 255;
        if width > WIDEST {
            return Err(wrong());
        }
        let zeros = rest.starts_with('0');
        let letter = rest[digits..].chars().next().ok_or_else(wrong)?;
        let number = match letter {
            '%' => "%".to_owned(),
            's' if !has_modifier => modifier.to_owned(),
            'd' | 'i' if !has_bin => bin.to_string(),
            'o' if !has_bin => format!("{bin:o}"),
            'x' if !has_bin => format!("{bin:x}"),
            'X' if !has_bin => format!("{bin:X}"),
            _ => return Err(wrong()),
        };
        has_modifier |= letter == 's';
        has_bin |= !matches!(letter, 's' | '%');
        let padding = if zeros && letter != 's' { '0' } else { ' ' };
        (number.chars().count()..width).for_each(|_| name.push(padding));
        name.push_str(&number);
        rest = &rest[digits + letter.len_utf8()..];
    }
    name.push_str(rest);
    Ok((name, has_modifier, has_bin))
}

/// What stands before the records.
fn head(options: &Options, planned: &Planned) -> Vec<u8> {
    let mut bytes = if options.header { header(options, planned) } else { Vec::new() };
    let [columns, rows] = options.size;
    if planned.values == 1 && columns > 0 && rows > 0 {
        bytes.extend_from_slice(format!("{}\n", Resolution::standard(columns as usize, rows as usize)).as_bytes());
    }
    bytes
}

fn header(options: &Options, planned: &Planned) -> Vec<u8> {
    let mut header = program_history(&options.scenes, &options.command);
    header.push_variable("GMT", &format!(" {}", greenwich_time()));
    header.push_variable("NCOMP", "3");
    if planned.name.is_some() {
        if let Some(modifier) = &planned.modifier {
            header.push_variable("MODIFIER", modifier);
        }
        if let Some(bin) = planned.bin {
            header.push_variable("BIN", &bin.to_string());
        }
    }
    let [columns, rows] = options.size;
    if rows > 0 {
        header.push_variable("NROWS", &(rows * columns.max(1)).to_string());
    }
    if columns == 0 || planned.values > 1 {
        header.push_variable("NCOLS", &planned.values.to_string());
    }
    options.output_format.end_header(&mut header, "32-bit_rle_rgbe");
    header.to_bytes()
}

fn encode(value: [f64; 3], format: OutputFormat, out: &mut Vec<u8>) {
    match format {
        OutputFormat::Numbers(_) => format.put_numbers(&value, out),
        OutputFormat::Pixels => out.extend_from_slice(&encode_rgbe(value.map(|band| band as f32))),
    }
}
