//! `ra_xyze [-r] [-o] [-e E] [-c|-u] [-p rx ry gx gy bx by wx wy] [input [output]]`: converts
//! between RGBE, spectra and XYZE (`-r` to RGBE); `-o` undoes exposures, `-c` and `-u` select
//! run-length encoding or none.

use super::files::{Source, failed, open_picture, put_file};
use super::packing::Packing;
use super::raster::{rows_of, transformed};
use super::three_values::ThreeValues;
use crate::commands::words::Words;
use crate::failure::{Failure, Outcome};
use radsight_picture::{
    Encoding, Header, PictureReader, PictureWriter, RgbPrimaries, WHITE_EFFICACY, encode_rgbe, xyz_to_rgb,
};
use std::io::{Cursor, Write};

struct Options {
    to_rgb: bool,
    undoes_exposure: bool,
    exposure: f64,
    packing: Option<Packing>,
    primaries: RgbPrimaries,
}

/// Runs `ra_xyze`.
pub(super) fn run(mut words: Words<'_>) -> Outcome {
    let mut options = Options::default();
    while let Some(option) = words.option()? {
        match option {
            "-c" => options.packing = Some(Packing::RunLengths),
            "-u" => options.packing = Some(Packing::Flat),
            "-r" => options.to_rgb = true,
            "-o" => options.undoes_exposure = true,
            "-e" => {
                let word = words.value(option, "an exposure")?;
                let number = words.number_in(word, option)?;
                options.exposure = if word.starts_with(['+', '-']) { 2f64.powf(number) } else { number };
            }
            "-p" => options.primaries = words.primaries(option)?,
            _ => return Err(words.unknown(option)),
        }
    }
    let (path, target) = words.input_and_output()?;
    let reader = open_picture(path)?;
    put_file(target, |out| convert(&options, &words.all(), reader, path, out))
}

impl Default for Options {
    fn default() -> Options {
        let primaries = RgbPrimaries::STANDARD;
        Options { to_rgb: false, undoes_exposure: false, exposure: 1.0, packing: None, primaries }
    }
}

/// A picture in Radiance's RGBE: an RGBE picture as it is, any other as `ra_xyze -r` converts it.
pub(super) fn as_rgbe(reader: PictureReader<Source>, path: &str) -> Result<PictureReader<Source>, Failure> {
    if reader.encoding() == Encoding::Rgbe {
        return Ok(reader);
    }
    let mut converted = Vec::new();
    let options = Options { to_rgb: true, ..Options::default() };
    convert(&options, &["ra_xyze", "-r"], reader, path, &mut converted)?;
    PictureReader::new(Box::new(Cursor::new(converted)) as Source).map_err(|error| failed(path, error.into()))
}

fn convert(
    options: &Options,
    command: &[&str],
    reader: PictureReader<Source>,
    path: &str,
    out: &mut dyn Write,
) -> Outcome {
    let mut pixels = ThreeValues::new(reader);
    let reader = pixels.reader();
    let wrong = |error: radsight_picture::PictureError| failed(path, error.into());
    let from_xyz = reader.encoding() == Encoding::Xyze;
    let primaries = reader.header().primaries().map_err(wrong)?.unwrap_or(RgbPrimaries::STANDARD);
    let to_xyz = if !pixels.are_xyz() { Some(primaries.rgb_to_xyz().ok_or_else(|| impossible(path))?) } else { None };
    let to_rgb = match options.to_rgb {
        true => Some(options.primaries.xyz_to_rgb().ok_or_else(|| impossible(path))?),
        false => None,
    };
    let (mut factor, mut recorded) = (options.exposure, options.exposure);
    if options.undoes_exposure {
        factor /= reader.header().exposure().map_err(wrong)?;
    }
    // XYZE has luminance, RGBE radiance.
    let change = match (from_xyz, options.to_rgb) {
        (true, true) => 1.0 / WHITE_EFFICACY,
        (false, false) => WHITE_EFFICACY,
        _ => 1.0,
    };
    if options.undoes_exposure {
        factor *= change;
    } else {
        recorded /= change;
    }
    let header = header(options, command, reader.header(), recorded);
    let matrix = to_xyz.map(rows_of);
    let packing = options.packing.unwrap_or(if options.to_rgb { Packing::RunLengths } else { Packing::Flat });
    let resolution = reader.resolution();
    let mut writer = PictureWriter::new(out, &header, 3, resolution).map_err(wrong)?;
    let mut values = vec![[0.0f32; 3]; resolution.scanline_length()];
    for _ in 0..resolution.scanlines() {
        pixels.read(&mut values).map_err(wrong)?;
        let stored: Vec<u8> = values
            .iter()
            .flat_map(|value| {
                let xyz = matrix.map_or(*value, |rows| transformed(&rows, *value));
                let value = to_rgb.map_or(xyz, |matrix| xyz_to_rgb(&matrix, xyz));
                encode_rgbe(value.map(|part| (f64::from(part) * factor) as f32))
            })
            .collect();
        packing.write(&mut writer, &stored).map_err(wrong)?;
    }
    writer.finish().map_err(wrong)
}

fn impossible(path: &str) -> Failure {
    Failure::input(format!("{path}: the primaries are collinear or the white is impossible"))
}

fn header(options: &Options, command: &[&str], input: &Header, recorded: f64) -> Header {
    let mut header = input.clone();
    for name in ["FORMAT", "PRIMARIES", "NCOMP", "WAVELENGTH_SPLITS"] {
        header.remove(name);
    }
    if options.undoes_exposure {
        header.remove("EXPOSURE");
    }
    header.push_command(command.iter().copied());
    if !(0.99..=1.01).contains(&recorded) {
        header.push_exposure(recorded);
    }
    if options.to_rgb {
        header.push_variable("PRIMARIES", &options.primaries.to_header_value());
        header.push_variable("FORMAT", Encoding::Rgbe.name());
    } else {
        header.push_variable("FORMAT", Encoding::Xyze.name());
    }
    header
}
