//! `-r`: continues the output of an interrupted run.

use super::bins::Bins;
use super::options::Options;
use super::record::Earlier;
use super::streams::{Layout, Planned, Streams, pixel_format};
use crate::failure::{Failure, reason, say};
use crate::output::file_path;
use crate::output_format::OutputFormat;
use radsight_output::{ClosedFile, leftovers};
use radsight_picture::{Header, Resolution, decode_spectrum, leading_number};
use radsight_pinhole::stream::NumberFormat;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::PathBuf;

/// The state of the earlier output.
pub(super) enum Reopened<'o> {
    /// No output: the run starts anew.
    Nothing,
    /// All requested records.
    Everything,
    /// Some records.
    Some(Streams<'o>, Earlier),
}

/// A file of an earlier run.
struct Written {
    target: PathBuf,
    /// The target, or the leftover of an interrupted run beside it.
    path: PathBuf,
    /// Offset of the records.
    start: u64,
    records: u64,
}

/// Longest header, bytes.
const LONGEST_HEADER: u64 = 1 << 16;

/// Finds the complete records that all files have, and opens the files after them.
pub(super) fn reopen<'o>(options: &'o Options, bins: &Bins) -> Result<Reopened<'o>, Failure> {
    let layout = Layout::new(options, bins)?;
    for planned in &layout.planned {
        file_name(planned)?;
    }
    if options.accumulate == 0 {
        let sums = reload(options, &layout)?;
        return Ok(Reopened::Some(Streams::open(options, bins)?, Earlier::Sums(sums)));
    }
    if options.output_format == OutputFormat::Numbers(NumberFormat::Ascii) {
        return Err(Failure::usage("rcontrib: text cannot be recovered (-r), expected -ff, -fd or -fc"));
    }
    let mut found = Vec::new();
    for planned in &layout.planned {
        found.extend(find(options, planned)?);
    }
    let records = found.iter().map(|written| written.records).min().unwrap_or(0);
    if records == 0 || found.len() < layout.planned.len() {
        warn(options, "no previous data to recover");
        return Ok(Reopened::Nothing);
    }
    let rays = records.saturating_mul(options.accumulate);
    if options.expected_rays().is_some_and(|expected| rays >= expected) {
        warn(options, "output appears to be complete");
        return Ok(Reopened::Everything);
    }
    let mut files = Vec::new();
    for (planned, written) in layout.planned.iter().zip(&found) {
        let length = written.start + records * record_size(options, planned);
        let name = file_name(planned)?;
        let file = shorten(written, length).map_err(|error| Failure::write(&format!("\"{name}\""), &error))?;
        files.push(file);
    }
    Ok(Reopened::Some(Streams::go_on(options, layout, files), Earlier::Rays(rays)))
}

fn warn(options: &Options, what: &str) {
    if !options.reading.no_warnings {
        say(&format!("rcontrib: warning - {what}\n"));
    }
}

fn file_name(planned: &Planned) -> Result<&str, Failure> {
    match planned.name.as_deref() {
        None => Err(Failure::usage("rcontrib: standard output cannot be recovered (-r), expected files (-o)")),
        Some(name) if name.starts_with('!') => {
            Err(Failure::usage(format!("rcontrib: the output of \"{name}\" cannot be recovered (-r), expected files")))
        }
        Some(name) => Ok(name),
    }
}

/// Size of a record, bytes.
fn record_size(options: &Options, planned: &Planned) -> u64 {
    let components = options.components();
    let value = match options.output_format {
        OutputFormat::Numbers(NumberFormat::Double) => size_of::<f64>() * components,
        OutputFormat::Numbers(_) => size_of::<f32>() * components,
        OutputFormat::Pixels => components + 1,
    };
    (value * planned.values) as u64
}

/// The longer of the file and the leftover of an interrupted run.
fn find(options: &Options, planned: &Planned) -> Result<Option<Written>, Failure> {
    let name = file_name(planned)?;
    let mut longest: Option<Written> = None;
    let Some(target) = file_path(name)? else {
        return Err(Failure::usage(format!("rcontrib: \"{name}\" cannot be recovered (-r), expected a file")));
    };
    for path in std::iter::once(target.clone()).chain(leftovers(&target)) {
        let failed = |error: io::Error| Failure::input(format!("cannot read \"{name}\": {}", reason(&error)));
        let (file, size) = match File::open(&path).and_then(|file| file.metadata().map(|found| (file, found.len()))) {
            Err(error) if error.kind() == ErrorKind::NotFound => continue,
            opened => opened.map_err(failed)?,
        };
        let mut head = Vec::new();
        file.take(LONGEST_HEADER).read_to_end(&mut head).map_err(failed)?;
        if head.is_empty() {
            continue;
        }
        let start = check_head(options, planned, &head)? as u64;
        let records = (size - start) / record_size(options, planned);
        if longest.as_ref().is_none_or(|longest| records > longest.records) {
            longest = Some(Written { target: target.clone(), path, start, records });
        }
    }
    if longest.is_none() {
        warn(options, &format!("missing recover file \"{name}\""));
    }
    Ok(longest)
}

/// Checks that a file has the requested format; returns the offset of its records.
fn check_head(options: &Options, planned: &Planned, bytes: &[u8]) -> Result<usize, Failure> {
    let wrong =
        |what: String| Failure::input(format!("cannot recover \"{}\": {what}", planned.name.as_deref().unwrap_or("-")));
    let mut start = 0;
    if options.header {
        let (header, length) = Header::read(bytes).map_err(|error| wrong(error.to_string()))?;
        let expected = options.output_format.name(pixel_format(options));
        let format = header.format().unwrap_or_default();
        if format != expected {
            return Err(wrong(format!("its format is \"{format}\", expected \"{expected}\"")));
        }
        start = length;
    }
    if planned.is_picture(options) {
        let (found, end) = Resolution::read(bytes, start).map_err(|error| wrong(error.to_string()))?;
        let [columns, rows] = options.size.map(|size| size as usize);
        if found != Resolution::standard(columns, rows) {
            return Err(wrong(format!("its size is \"{found}\", expected \"-Y {rows} +X {columns}\"")));
        }
        start = end;
    }
    Ok(start)
}

/// A hidden file with the start of the earlier output.
fn shorten(written: &Written, length: u64) -> io::Result<ClosedFile> {
    if written.path != written.target {
        return ClosedFile::adopt(&written.target, &written.path, length);
    }
    let file = ClosedFile::create(&written.target)?;
    let mut start = File::open(&written.path)?.take(length);
    let mut piece = Vec::new();
    while start.by_ref().take(COPIED_AT_A_TIME).read_to_end(&mut piece)? > 0 {
        file.append(&piece)?;
        piece.clear();
    }
    Ok(file)
}

/// Number of bytes copied at a time.
const COPIED_AT_A_TIME: u64 = 1 << 24;

/// The single record of an earlier run; zeros for missing files.
fn reload(options: &Options, layout: &Layout) -> Result<Vec<f64>, Failure> {
    let components = options.components();
    let mut numbers = Vec::new();
    for planned in &layout.planned {
        let name = file_name(planned)?;
        let expected = planned.values * components;
        let values = match beginning(name, record_size(options, planned).saturating_mul(LONGEST_NUMBER)) {
            Err(error) if error.kind() == ErrorKind::NotFound => {
                warn(options, &format!("missing reload file \"{name}\""));
                vec![0.0; expected]
            }
            Err(error) => return Err(Failure::input(format!("cannot read \"{name}\": {}", reason(&error)))),
            Ok(bytes) if bytes.is_empty() => vec![0.0; expected],
            Ok(bytes) => {
                let start = check_head(options, planned, &bytes)?;
                values(&bytes[start..], options, expected)
            }
        };
        if values.len() != expected {
            let found = values.len();
            return Err(Failure::input(format!(
                "cannot recover \"{name}\": it has {found} numbers, expected {expected}"
            )));
        }
        numbers.push(values.into_iter());
    }
    let of_bins = layout.of_bin.iter().map(|stream| (*stream, components));
    Ok(of_bins.flat_map(|(stream, count)| numbers[stream].by_ref().take(count).collect::<Vec<f64>>()).collect())
}

/// Largest ratio of a number's length in text and in binary.
const LONGEST_NUMBER: u64 = 16;

/// The bytes of a file up to the largest possible end of its header and numbers: a reload file may
/// be an unrelated long file.
fn beginning(name: &str, bytes: u64) -> io::Result<Vec<u8>> {
    if !fs::metadata(name)?.is_file() {
        return Err(io::Error::new(ErrorKind::InvalidInput, "it is not a file"));
    }
    let mut read = Vec::new();
    File::open(name)?.take(LONGEST_HEADER.saturating_add(bytes)).read_to_end(&mut read)?;
    Ok(read)
}

/// The first numbers of a record, at most as many as expected.
fn values(bytes: &[u8], options: &Options, expected: usize) -> Vec<f64> {
    match options.output_format {
        OutputFormat::Numbers(NumberFormat::Ascii) => bytes
            .split(u8::is_ascii_whitespace)
            .filter(|word| !word.is_empty())
            .map(|word| leading_number(word).0)
            .take(expected)
            .collect(),
        OutputFormat::Numbers(NumberFormat::Float) => {
            bytes.as_chunks().0.iter().map(|value| f64::from(f32::from_ne_bytes(*value))).take(expected).collect()
        }
        OutputFormat::Numbers(NumberFormat::Double) => {
            bytes.as_chunks().0.iter().map(|value| f64::from_ne_bytes(*value)).take(expected).collect()
        }
        OutputFormat::Pixels => {
            let components = options.components();
            let mut pixel = vec![0.0; components];
            let mut numbers = Vec::new();
            for stored in bytes.chunks_exact(components + 1).take(expected / components) {
                decode_spectrum(stored, &mut pixel);
                numbers.extend(pixel.iter().map(|value| f64::from(*value)));
            }
            numbers
        }
    }
}
