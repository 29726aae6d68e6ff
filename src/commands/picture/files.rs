//! Pictures from files and pipes.

use crate::clock::push_date;
use crate::disk::Commands;
use crate::failure::{Failure, Outcome, reason};
use crate::output::{StandardOutput, standard_output, write_file};
use crate::read_once;
use crate::trust::shell;
use radsight_picture::{FloatMatrix, ForeignFormat, Header, MatrixFormat, PictureError, PictureReader, read_image};
use radsight_picture_ops::ToolError;
use radsight_scene_generators::source_name;
use std::fs::File;
use std::io::{self, BufRead, BufWriter, ErrorKind, Read, Seek, StdinLock, Write};
use std::path::Path;
use std::process::{Child, ChildStdout, Stdio};

/// The source of a picture.
pub(super) type Source = Box<dyn Read>;

/// Size of the output buffer, bytes.
const BUFFER: usize = 1 << 17;

/// Opens a file; `-` is standard input.
pub(super) fn open(path: &str) -> Result<Source, Failure> {
    if path == "-" {
        return Ok(Box::new(standard_input()?));
    }
    Ok(Box::new(open_file(path)?))
}

/// Standard input, unless the output would be added to it while it is read.
pub(super) fn standard_input() -> Result<StdinLock<'static>, Failure> {
    refuse_own_output()?;
    Ok(io::stdin().lock())
}

/// An error if standard input is the file of standard output.
pub(super) fn refuse_own_output() -> Outcome {
    match radsight_output::inputs::is_standard_input_standard_output() {
        true => Err(Failure::usage("cannot read standard input: standard output goes to the same file")),
        false => Ok(()),
    }
}

/// Opens a file that can be read twice.
pub(super) fn open_file(path: &str) -> Result<File, Failure> {
    read_once::open(Path::new(path)).map_err(|error| Failure::read(&format!("\"{path}\""), &error))
}

/// Opens a picture; `-` is standard input.
pub(super) fn open_picture(path: &str) -> Result<PictureReader<Source>, Failure> {
    PictureReader::new(open(path)?).map_err(|error| failed(path, error.into()))
}

/// Opens a source that can be read twice: a file, or a temporary copy of standard input.
pub(super) fn open_twice(path: &str) -> Result<File, Failure> {
    let mut source: Source = match path {
        "-" => Box::new(standard_input()?),
        _ => {
            let mut file = open_file(path)?;
            if file.stream_position().is_ok() {
                return Ok(file);
            }
            Box::new(file)
        }
    };
    let copied = tempfile::tempfile().and_then(|mut copy| {
        io::copy(&mut source, &mut copy)?;
        copy.rewind()?;
        Ok(copy)
    });
    copied.map_err(|error| Failure::fault(format!("cannot copy the input to a temporary file: {}", reason(&error))))
}

/// Longest header, bytes.
const LONGEST_HEADER: u64 = 1 << 24;

/// Reads a header and no further byte.
pub(super) fn read_header(source: &mut impl BufRead) -> Result<Header, String> {
    let mut bytes = Vec::new();
    loop {
        let start = bytes.len();
        let left = LONGEST_HEADER.saturating_sub(start as u64);
        source.take(left).read_until(b'\n', &mut bytes).map_err(|error| reason(&error))?;
        if matches!(&bytes[start..], b"\n" | b"\r\n" | b"") {
            return Header::read(&bytes).map(|(header, _)| header).map_err(|error| error.to_string());
        }
    }
}

/// Standard output, buffered.
pub(super) fn output() -> BufWriter<StandardOutput> {
    BufWriter::with_capacity(BUFFER, standard_output())
}

/// The error of a picture with this name.
pub(super) fn failed(path: &str, error: ToolError) -> Failure {
    match error {
        ToolError::Picture(PictureError::Stream { kind, reason }) => stream_failed(kind, &reason),
        ToolError::Picture(error @ PictureError::OtherFormat { found }) => {
            Failure::input(format!("{}: {error}{}", source_name(path), converter_hint(found, path)))
        }
        error => Failure::input(format!("{}: {error}", source_name(path))),
    }
}

/// A hint at the program that makes a Radiance picture of a file.
fn converter_hint(found: ForeignFormat, path: &str) -> String {
    let command = match found {
        format if is_read_by_pcomb(format) => "pcomb",
        ForeignFormat::Tiff => "ra_tiff -r",
        ForeignFormat::Png => "ra_png -r",
        _ => return String::new(),
    };
    format!("\nhint: `{command} {path}` makes one of it")
}

/// Whether the format has values in single precision that become a float matrix.
fn is_read_by_pcomb(format: ForeignFormat) -> bool {
    matches!(format, ForeignFormat::Exr | ForeignFormat::Pfm | ForeignFormat::Npy)
}

fn stream_failed(kind: ErrorKind, words: &str) -> Failure {
    Failure::write("standard output", &io::Error::new(kind, words))
}

/// The error of standard output.
pub(super) fn write_failed(error: &io::Error) -> Failure {
    Failure::write("standard output", error)
}

/// Flushes the output.
pub(super) fn finish(mut out: impl Write) -> Result<(), Failure> {
    out.flush().map_err(|error| write_failed(&error))
}

/// Writes a file that appears whole or not at all, or standard output (`-`).
pub(super) fn put_file(path: &str, write: impl FnOnce(&mut dyn Write) -> Outcome) -> Outcome {
    if path == "-" {
        let mut out = output();
        write(&mut out)?;
        return finish(out);
    }
    let mut bytes = Vec::new();
    write(&mut bytes)?;
    write_file(path, &bytes)
}

/// Whether the headers of the inputs are copied to the output's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum History {
    Copied,
    LeftOut,
}

impl History {
    pub(super) fn other(self) -> History {
        match self {
            History::Copied => History::LeftOut,
            History::LeftOut => History::Copied,
        }
    }

    /// Adds the header of an input without its identifier.
    pub(super) fn push(self, header: &mut Header, name: &str, nested: &Header) {
        if self == History::LeftOut {
            return;
        }
        header.push_line(&format!("{}:", shown(name)));
        for line in nested.body() {
            header.push_line(&format!("\t{}", String::from_utf8_lossy(line)));
        }
    }
}

/// The name of an input in a header.
fn shown(path: &str) -> &str {
    match path {
        "-" => "<stdin>",
        command if command.starts_with('!') => "<Command>",
        path => path,
    }
}

/// The header of a new picture.
pub(super) fn dated_header() -> Header {
    let mut header = Header::new("RADIANCE");
    push_date(&mut header);
    header
}

/// Opens a file, standard input (`-`), or the output of a command (`!…`).
pub(super) fn open_any(path: &str, commands: Commands) -> Result<Source, Failure> {
    match path.strip_prefix('!') {
        Some(command) => Ok(Box::new(CommandOutput::start(command, commands)?)),
        None => open(path),
    }
}

/// As [`open_any`]. An OpenEXR picture, a portable float map or a NumPy array becomes a Radiance
/// float matrix, without loss.
pub(super) fn open_any_image(path: &str, commands: Commands) -> Result<Source, Failure> {
    let mut source = open_any(path, commands)?;
    let unreadable = |error: &io::Error| Failure::read(&format!("\"{path}\""), error);
    let mut bytes = Vec::new();
    source
        .by_ref()
        .take(ForeignFormat::LONGEST_SIGNATURE as u64)
        .read_to_end(&mut bytes)
        .map_err(|error| unreadable(&error))?;
    if !ForeignFormat::from_content(&bytes).is_some_and(is_read_by_pcomb) {
        return Ok(Box::new(io::Cursor::new(bytes).chain(source)));
    }
    source.read_to_end(&mut bytes).map_err(|error| unreadable(&error))?;
    let read = read_image(&bytes).map_err(|error| failed(path, error.into()))?;
    let header = read.header.unwrap_or_else(|| Header::new("RADIANCE"));
    Ok(Box::new(io::Cursor::new(FloatMatrix::write_f32(&header, &read.image, MatrixFormat::Float))))
}

/// The output of a command.
struct CommandOutput {
    child: Child,
    output: ChildStdout,
}

impl CommandOutput {
    fn start(command: &str, commands: Commands) -> Result<CommandOutput, Failure> {
        let wrong = |words: &str| Failure::input(format!("cannot run \"{command}\": {words}"));
        let started = shell(commands.permit(command)?, command).stdin(Stdio::null()).stdout(Stdio::piped()).spawn();
        let mut child = started.map_err(|error| wrong(&reason(&error)))?;
        let output = child.stdout.take().ok_or_else(|| wrong("it has no output"))?;
        Ok(CommandOutput { child, output })
    }
}

impl Read for CommandOutput {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.output.read(buffer)
    }
}

impl Drop for CommandOutput {
    fn drop(&mut self) {
        // Drain the rest of the output and wait, so that the command does not become a zombie.
        let _ = io::copy(&mut self.output, &mut io::sink());
        let _ = self.child.wait();
    }
}
