//! Pictures from files and pipes.

use crate::failure::{Failure, reason};
use radsight_picture::{Header, PictureError, PictureReader};
use radsight_picture_tools::ToolError;
use std::fs::File;
use std::io::{self, BufRead, BufWriter, ErrorKind, Read, Seek, StdoutLock, Write};

/// What a picture is read from.
pub(super) type Source = Box<dyn Read>;

/// How much is written at a time.
const BUFFER: usize = 1 << 17;

/// Opens a file; `-` is standard input.
pub(super) fn open(path: &str) -> Result<Source, Failure> {
    if path == "-" {
        return Ok(Box::new(io::stdin().lock()));
    }
    Ok(Box::new(open_file(path)?))
}

/// Opens a file that can be read again.
pub(super) fn open_file(path: &str) -> Result<File, Failure> {
    let failed = |error: &io::Error| Failure::input(format!("cannot read \"{path}\": {}", reason(error)));
    let file = File::open(path).map_err(|error| failed(&error))?;
    match file.metadata() {
        Ok(found) if found.is_dir() => Err(Failure::input(format!("cannot read \"{path}\": it is a folder"))),
        _ => Ok(file),
    }
}

/// Opens a picture; `-` is standard input.
pub(super) fn open_picture(path: &str) -> Result<PictureReader<Source>, Failure> {
    PictureReader::new(open(path)?).map_err(|error| failed(path, error.into()))
}

/// Something that can be read again from its start: a file, or what standard input gave, in a file without a name.
pub(super) fn open_twice(path: &str) -> Result<File, Failure> {
    let mut source: Source = Box::new(io::stdin().lock());
    if path != "-" {
        let mut file = open_file(path)?;
        if file.stream_position().is_ok() {
            return Ok(file);
        }
        source = Box::new(file);
    }
    let copied = tempfile::tempfile().and_then(|mut copy| {
        io::copy(&mut source, &mut copy)?;
        copy.rewind()?;
        Ok(copy)
    });
    copied.map_err(|error| Failure::fault(format!("cannot copy the input to a temporary file: {}", reason(&error))))
}

/// The longest header that is read, in bytes.
const LONGEST_HEADER: u64 = 1 << 24;

/// Reads a header and no byte more.
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
pub(super) fn output() -> BufWriter<StdoutLock<'static>> {
    BufWriter::with_capacity(BUFFER, io::stdout().lock())
}

/// What goes wrong with a picture of this name.
pub(super) fn failed(path: &str, error: ToolError) -> Failure {
    let name = if path == "-" { "standard input" } else { path };
    match error {
        ToolError::Picture(PictureError::Stream { kind, reason }) => stream_failed(kind, &reason),
        error => Failure::input(format!("{name}: {error}")),
    }
}

fn stream_failed(kind: ErrorKind, words: &str) -> Failure {
    Failure::write("standard output", &io::Error::new(kind, words))
}

/// What goes wrong with standard output.
pub(super) fn write_failed(error: &io::Error) -> Failure {
    Failure::write("standard output", error)
}

/// Writes all that was held back.
pub(super) fn finish(mut out: impl Write) -> Result<(), Failure> {
    out.flush().map_err(|error| write_failed(&error))
}
