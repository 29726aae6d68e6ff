//! `ra_rgbe [-r] [-e ±STOPS] [-f] [-n FRAME] [input [output]]`: writes pictures without run-length
//! encoding, or with it (`-r`). All frames of an animation in one file are written, each to its own
//! file if the output name has `%d`, or only frame `-n`. Files that exist, also those of earlier
//! frames, are overwritten only with `-f`.

use super::files::{Source, failed, open_picture, put_file};
use super::packing::Packing;
use super::raster::stops;
use crate::commands::words::Words;
use crate::failure::{Failure, Outcome};
use crate::file_pattern;
use crate::trust::Existing;
use radsight_picture::{Encoding, Header, PictureError, PictureReader, PictureWriter};
use radsight_picture_ops::gamma::shifted;
use std::path::Path;

/// Runs the program.
pub(super) fn run(mut words: Words<'_>) -> Outcome {
    let mut options = Options { packing: Packing::Flat, exposure: 0, frame: 0, existing: Existing::Kept };
    while let Some(option) = words.option()? {
        match option {
            "-r" => options.packing = Packing::RunLengths,
            "-e" => options.exposure = stops(&mut words, option)?,
            "-n" => options.frame = words.integer(option)?,
            "-f" => options.existing = Existing::Replaced,
            _ => return Err(words.unknown(option)),
        }
    }
    let (path, target) = words.input_and_output()?;
    let wrong = |error: PictureError| failed(path, error.into());
    let mut next = Some(open_picture(path)?);
    let mut first: Option<Header> = None;
    while let Some(mut reader) = next {
        let header = options.header(&words, [first.as_ref(), Some(reader.header())], reader.encoding());
        first.get_or_insert_with(|| reader.header().clone());
        let frame = frame_of(reader.header());
        if options.frame == 0 || options.frame == frame {
            let target = match target.contains('%') {
                true => file_pattern::expanded("ra_rgbe", target, "", usize::try_from(frame).unwrap_or(0))?.0,
                false => target.to_owned(),
            };
            options.transfer(&mut reader, &header, path, &target)?;
        } else if options.frame < frame {
            return Ok(());
        } else {
            for _ in 0..reader.resolution().scanlines() {
                reader.read_stored().map_err(wrong)?;
            }
        }
        next = reader.next_picture().map_err(wrong)?;
    }
    Ok(())
}

struct Options {
    packing: Packing,
    /// The output files that may be replaced.
    existing: Existing<'static>,
    exposure: i32,
    /// The only requested frame; 0 for all.
    frame: i64,
}

impl Options {
    /// `inputs` are the headers of the first frame and of this one: as in Radiance, the first
    /// header applies to all.
    fn header(&self, words: &Words<'_>, inputs: [Option<&Header>; 2], encoding: Encoding) -> Header {
        let mut header = Header::new("RADIANCE");
        for input in inputs.into_iter().flatten() {
            let mut history = input.history();
            history.remove(FRAME);
            header.push_body(&history);
        }
        let mut command = words.program().to_owned();
        if self.exposure != 0 {
            command.push_str(&format!(" -e {:+}", self.exposure));
        }
        if self.packing == Packing::RunLengths {
            command.push_str(" -r");
        }
        header.push_line(&command);
        if self.exposure != 0 {
            header.push_exposure(2f64.powi(self.exposure));
        }
        let frame = inputs[1].map_or(0, frame_of);
        if frame != 0 {
            header.push_variable(FRAME, &frame.to_string());
        }
        let encoding = if encoding == Encoding::Xyze { Encoding::Xyze } else { Encoding::Rgbe };
        header.push_variable("FORMAT", encoding.name());
        header
    }

    fn transfer(&self, reader: &mut PictureReader<Source>, header: &Header, path: &str, target: &str) -> Outcome {
        if self.existing == Existing::Kept && target != "-" && Path::new(target).exists() {
            return Err(Failure::input(format!(
                "ra_rgbe: \"{target}\" exists, expected -f to overwrite it, or %d in the name for frames"
            )));
        }
        let resolution = reader.resolution();
        let wrong = |error: PictureError| -> Failure { failed(path, error.into()) };
        put_file(target, |out| {
            let mut writer = PictureWriter::new(out, header, 3, resolution).map_err(wrong)?;
            let mut pixels = vec![[0; 4]; resolution.scanline_length()];
            for _ in 0..resolution.scanlines() {
                reader.read_pixels(&mut pixels).map_err(wrong)?;
                pixels.iter_mut().for_each(|pixel| *pixel = shifted(*pixel, self.exposure));
                self.packing.write(&mut writer, pixels.as_flattened()).map_err(wrong)?;
            }
            writer.finish().map_err(wrong)
        })
    }
}

/// The header variable with the frame number.
const FRAME: &str = "FRAME";

/// The frame number; 0 if there is none.
fn frame_of(header: &Header) -> i64 {
    header.assignments(FRAME).last().and_then(|found| found.value.trim().parse().ok()).unwrap_or(0)
}
