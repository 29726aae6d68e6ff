//! The outputs of records: standard output, files named by modifier and bin, commands.

use super::bins::Bins;
use super::options::{Options, OutputPattern, Tracked};
use crate::clock::push_date;
use crate::failure::{Failure, Outcome, reason};
use crate::file_pattern::{holds_number, named};
use crate::input::program_history;
use crate::output::{self, Output, reserve_output};
use crate::output_format::OutputFormat;
use crate::trust::{CommandPermit, Existing, Origin, OutputName, PROJECT, shell};
use radsight_brdf_host::guard::standard_output;
use radsight_output::ClosedFile;
use radsight_picture::Resolution;
use radsight_pinhole::stream::NumberFormat;
use std::collections::HashMap;
use std::io::Write;
use std::process::{Child, Stdio};

/// Largest memory of all output buffers, bytes.
const MOST_HELD: usize = 1 << 24;

/// All outputs.
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
    /// A pipe or a device.
    Stream(Output),
    /// A file that appears when it is complete; `None` afterwards.
    File {
        name: String,
        file: Option<ClosedFile>,
    },
    /// `None` when it has ended.
    Command {
        name: String,
        child: Option<Child>,
    },
}

/// A stream to be opened.
pub(super) struct Planned {
    /// A file's name, or a command after `!`; `None` for standard output.
    pub(super) name: Option<String>,
    target: Allowed,
    /// The modifier and the bin in its name.
    modifier: Option<String>,
    bin: Option<usize>,
    /// Values per record.
    pub(super) values: usize,
}

/// A permitted destination.
#[derive(Clone, Debug)]
enum Allowed {
    StandardOutput,
    File(OutputName),
    Command(String, CommandPermit),
}

/// The streams, and the stream of each bin.
pub(super) struct Layout {
    pub(super) planned: Vec<Planned>,
    pub(super) of_bin: Vec<usize>,
}

impl<'o> Streams<'o> {
    /// Opens all streams and writes their headers.
    pub(super) fn open(options: &'o Options, bins: &Bins) -> Result<Streams<'o>, Failure> {
        let Layout { planned, of_bin } = Layout::new(options, bins)?;
        let mut streams = Vec::new();
        for planned in &planned {
            let replaces = options.overwrites || options.recovers;
            let existing = if replaces { Existing::Replaced } else { Existing::Kept };
            let target = Target::open(&planned.target, existing)?;
            streams.push(Stream { target, held: head(options, planned) });
        }
        let mut streams = Streams { options, streams, of_bin, held: 0 };
        streams.flush()?;
        Ok(streams)
    }

    /// Continues existing files, one per planned stream.
    pub(super) fn go_on(options: &'o Options, layout: Layout, files: Vec<ClosedFile>) -> Streams<'o> {
        let names = layout.planned.into_iter().filter_map(|planned| planned.name);
        let target = |(name, file)| Target::File { name, file: Some(file) };
        let streams = names.zip(files).map(|found| Stream { target: target(found), held: Vec::new() }).collect();
        Streams { options, streams, of_bin: layout.of_bin, held: 0 }
    }

    /// Writes a record: a value for each bin of each modifier.
    pub(super) fn put(&mut self, values: &[f64]) -> Outcome {
        for (value, stream) in values.chunks_exact(self.options.components()).zip(&self.of_bin) {
            self.options.output_format.put(value, &mut self.streams[*stream].held);
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

    /// Flushes all buffers.
    pub(super) fn flush(&mut self) -> Outcome {
        self.held = 0;
        self.streams.iter_mut().try_for_each(Stream::flush)
    }

    /// Ends all streams.
    pub(super) fn finish(&mut self) -> Outcome {
        self.flush()?;
        self.streams.iter_mut().try_for_each(Stream::finish)
    }
}

impl Drop for Streams<'_> {
    fn drop(&mut self) {
        // Existing output is kept if the input was wrong.
        if !self.options.recovers {
            return;
        }
        for stream in &mut self.streams {
            if let Target::File { file, .. } = &mut stream.target {
                file.take().map(ClosedFile::keep);
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
                let mut out = output::standard_output();
                (out.write_all(&held).and_then(|()| out.flush()), "standard output".to_owned())
            }
            Target::Stream(output) => return output.put(&held),
            Target::File { name, file } => {
                (file.as_ref().map_or(Ok(()), |file| file.append(&held)), format!("\"{name}\""))
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
            Target::StandardOutput | Target::Stream(_) => Ok(()),
            Target::File { name, file } => {
                let committed = file.take().map_or(Ok(()), ClosedFile::commit);
                committed.map_err(|error| Failure::write(&format!("\"{name}\""), &error))
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
    fn open(allowed: &Allowed, existing: Existing<'_>) -> Result<Target, Failure> {
        match allowed {
            Allowed::StandardOutput => Ok(Target::StandardOutput),
            Allowed::File(name) => Target::open_file(name, existing),
            Allowed::Command(command, permit) => {
                let child = shell(*permit, command).stdin(Stdio::piped()).stdout(standard_output::for_child()).spawn();
                let child = child.map_err(|error| {
                    Failure::fault(format!("rcontrib: cannot run \"{command}\": {}", reason(&error)))
                })?;
                Ok(Target::Command { name: command.clone(), child: Some(child) })
            }
        }
    }

    fn open_file(name: &OutputName, existing: Existing<'_>) -> Result<Target, Failure> {
        let name: &str = name;
        let Some(path) = reserve_output(name)? else { return Output::create(name).map(Target::Stream) };
        if path.exists() && existing == Existing::Kept {
            return Err(Failure::fault(format!("cannot write \"{name}\": it exists, expected -fo+ to overwrite it")));
        }
        let file = ClosedFile::create(&path).map_err(|error| Failure::write(&format!("\"{name}\""), &error))?;
        Ok(Target::File { name: name.to_owned(), file: Some(file) })
    }
}

impl Layout {
    /// The layout of the bins of all modifiers.
    pub(super) fn new(options: &Options, all_bins: &Bins) -> Result<Layout, Failure> {
        let mut planned: Vec<Planned> = Vec::new();
        let mut by_name: HashMap<Option<String>, usize> = HashMap::new();
        let mut of_bin = Vec::new();
        for (index, tracked) in options.tracked.iter().enumerate() {
            let bins = all_bins.of_modifier(index);
            // Pictures have one value per pixel: modifiers that share numbered files use disjoint
            // numbers.
            let mut first = 0;
            if let (OutputFormat::Pixels, Some(OutputPattern { text: pattern, .. })) =
                (options.output_format, &tracked.output)
            {
                while holds_number(pattern)
                    && by_name.contains_key(&Some(named("rcontrib", pattern, &tracked.name, first)?.0))
                {
                    first += 1;
                }
            }
            for bin in 0..bins {
                let (name, modifier, number) = match &tracked.output {
                    None => (None, None, None),
                    Some(OutputPattern { text: pattern, .. }) => {
                        let (name, has_modifier, has_bin) = named("rcontrib", pattern, &tracked.name, first + bin)?;
                        (Some(name), has_modifier.then(|| tracked.name.clone()), has_bin.then_some(first + bin))
                    }
                };
                let stream = match by_name.get(&name) {
                    Some(stream) => *stream,
                    None => {
                        let target = allowed(options, tracked, name.as_deref(), modifier.as_deref())?;
                        by_name.insert(name.clone(), planned.len());
                        planned.push(Planned { name, target, modifier, bin: number, values: 0 });
                        planned.len() - 1
                    }
                };
                if planned[stream].values == 0 && planned[stream].modifier.is_none() {
                    planned[stream].modifier = Some(tracked.name.clone()).filter(|_| bins == 1 || number.is_some());
                } else if planned[stream].values > 0
                    && !matches!(&tracked.output, Some(pattern) if pattern.text.contains("%s"))
                {
                    planned[stream].modifier = None;
                }
                planned[stream].values += 1;
                of_bin.push(stream);
            }
        }
        Ok(Layout { planned, of_bin })
    }
}

/// The destination of a modifier's values, if the origins of the output's and the modifier's name
/// permit it.
///
/// `modifier` is the name that occurs in the file name.
fn allowed(
    options: &Options,
    tracked: &Tracked,
    name: Option<&str>,
    modifier: Option<&str>,
) -> Result<Allowed, Failure> {
    let (Some(pattern), Some(name)) = (&tracked.output, name) else { return Ok(Allowed::StandardOutput) };
    let trust = &options.reading.trust;
    let part = modifier.filter(|_| tracked.origin == Origin::File);
    if pattern.text.starts_with('!') {
        if let Some(part) = part {
            trust.check_command_part(part)?;
        }
        let commands = if pattern.origin == Origin::File { trust.commands() } else { trust.own_commands() };
        return Ok(Allowed::Command(name[1..].to_owned(), commands.permit(&name[1..])?));
    }
    if pattern.origin == Origin::CommandLine {
        return Ok(Allowed::File(trust.output_with_part(name, part)?));
    }
    let existing = match (options.existing_of_files, trust.project()) {
        (Existing::Kept, Some(receiver)) => Existing::MadeBy(receiver),
        (existing, _) => existing,
    };
    Ok(Allowed::File(trust.output_of_file(name, existing)?))
}

impl Planned {
    /// Whether it has one value per pixel, and thus a resolution line.
    pub(super) fn is_picture(&self, options: &Options) -> bool {
        self.values == 1 && options.size.iter().all(|size| *size > 0)
    }
}

/// The header before the records.
fn head(options: &Options, planned: &Planned) -> Vec<u8> {
    let mut bytes = if options.header { header(options, planned) } else { Vec::new() };
    let [columns, rows] = options.size;
    if planned.is_picture(options) {
        bytes.extend_from_slice(format!("{}\n", Resolution::standard(columns as usize, rows as usize)).as_bytes());
    }
    bytes
}

fn header(options: &Options, planned: &Planned) -> Vec<u8> {
    let mut header = program_history(&options.scenes, &options.command);
    if let Some(receiver) = options.reading.trust.project() {
        header.push_variable(PROJECT, &format!(" {receiver}"));
    }
    push_date(&mut header);
    header.push_variable("NCOMP", &options.components().to_string());
    if options.components() > 3 {
        let splits = options.render.sampling.splits_nm().map(|split| split.to_string());
        header.push_variable("WAVELENGTH_SPLITS", &format!(" {}", splits.join(" ")));
    }
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
    options.output_format.end_header(&mut header, pixel_format(options));
    header.to_bytes()
}

/// The name of the pixel format.
pub(super) fn pixel_format(options: &Options) -> &'static str {
    if options.components() > 3 { "Radiance_spectra" } else { "32-bit_rle_rgbe" }
}
