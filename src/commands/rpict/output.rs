//! Where a picture goes, row by row, so that what is done of it survives an interruption.

use crate::failure::{Failure, Outcome, reason, say};
use crate::output::write_file;
use radsight_brdf_host::guard::standard_output::StandardOutput;
use radsight_picture::{Header, Resolution, Unfinished};
use std::fs::File;
use std::io::{self, ErrorKind, Seek, SeekFrom, Write};

/// What an interrupted run left.
#[derive(Debug)]
pub(super) struct Recovered {
    pub(super) header: Header,
    pub(super) columns: usize,
    pub(super) rows: usize,
    /// How many rows are done.
    pub(super) done: usize,
    /// Those rows, as they are stored.
    pixels: Vec<u8>,
}

impl Recovered {
    /// Reads an unfinished picture; `None`, with a message, if there is no such file.
    pub(super) fn read(path: &str) -> Result<Option<Recovered>, Failure> {
        let bytes = match std::fs::read(path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == ErrorKind::NotFound => {
                say(&format!("rpict: warning - no recover file \"{path}\": starting anew\n"));
                return Ok(None);
            }
            Err(error) => {
                return Err(Failure::input(format!("cannot read recover file \"{path}\": {}", reason(&error))));
            }
        };
        let unfinished = Unfinished::read(&bytes)
            .map_err(|error| Failure::input(format!("bad recover file \"{path}\": {error}")))?;
        let Resolution { width, height, .. } = unfinished.resolution;
        if unfinished.resolution != Resolution::standard(width, height) {
            return Err(Failure::input(format!("bad recover file \"{path}\": its rows do not run from the top left")));
        }
        Ok(Some(Recovered {
            columns: width,
            rows: height,
            done: unfinished.scanlines,
            pixels: unfinished.pixels.to_vec(),
            header: unfinished.header,
        }))
    }
}

/// A picture that is being written.
pub(super) struct PictureWriter {
    target: Target,
    name: String,
    depths: Option<(File, String)>,
}

enum Target {
    StandardOutput,
    File(File),
}

/// How a picture begins.
pub(super) struct Start<'a> {
    pub(super) header: &'a Header,
    pub(super) resolution: Resolution,
    pub(super) recovered: Option<&'a Recovered>,
}

impl PictureWriter {
    /// Writes header, resolution and recovered rows. A file that exists is only replaced if it is the one that is recovered.
    pub(super) fn begin(output: Option<&str>, replaces: bool, start: &Start<'_>) -> Result<PictureWriter, Failure> {
        let mut bytes = start.header.to_bytes();
        bytes.extend_from_slice(format!("{}\n", start.resolution).as_bytes());
        if let Some(recovered) = start.recovered {
            bytes.extend_from_slice(&recovered.pixels);
        }
        let Some(path) = output else {
            let mut writer =
                PictureWriter { target: Target::StandardOutput, name: "standard output".into(), depths: None };
            writer.write(&bytes)?;
            return Ok(writer);
        };
        let name = format!("\"{path}\"");
        let failed = |error: io::Error| match error.kind() {
            ErrorKind::AlreadyExists => Failure::input(format!(
                "cannot open output file {name}: it exists (-ro continues an unfinished picture)"
            )),
            _ => Failure::write(&name, &error),
        };
        let file = if replaces {
            // The old file stays whole until all that it held is in the new one.
            write_file(path, &bytes)?;
            File::options().append(true).open(path).map_err(failed)?
        } else {
            let mut file = File::options().write(true).create_new(true).open(path).map_err(failed)?;
            file.write_all(&bytes).map_err(|error| Failure::write(&name, &error))?;
            file
        };
        Ok(PictureWriter { target: Target::File(file), name, depths: None })
    }

    /// Opens the file for the distances, of which those of the rows that are done are kept.
    pub(super) fn with_depths(mut self, path: Option<&str>, pixels_done: usize) -> Result<PictureWriter, Failure> {
        let Some(path) = path else { return Ok(self) };
        let failed = |error: io::Error| Failure::write(&format!("\"{path}\""), &error);
        let mut file = File::options().write(true).create(true).truncate(false).open(path).map_err(failed)?;
        let start = (pixels_done * size_of::<f32>()) as u64;
        file.set_len(start).and_then(|()| file.seek(SeekFrom::Start(start))).map_err(failed)?;
        self.depths = Some((file, format!("\"{path}\"")));
        Ok(self)
    }

    /// Whether distances are wanted.
    pub(super) fn wants_depths(&self) -> bool {
        self.depths.is_some()
    }

    /// Appends rows of the picture; they are out of this program's hands afterwards.
    pub(super) fn write(&mut self, bytes: &[u8]) -> Outcome {
        let written = match &mut self.target {
            Target::StandardOutput => {
                let mut out = StandardOutput;
                out.write_all(bytes).and_then(|()| out.flush())
            }
            Target::File(file) => file.write_all(bytes),
        };
        written.map_err(|error| Failure::write(&self.name, &error))
    }

    /// Appends distances, in the machine's single precision.
    pub(super) fn write_depths(&mut self, depths: &[f32]) -> Outcome {
        let Some((file, name)) = &mut self.depths else { return Ok(()) };
        let bytes: Vec<u8> = depths.iter().flat_map(|depth| depth.to_ne_bytes()).collect();
        file.write_all(&bytes).map_err(|error| Failure::write(name, &error))
    }
}
