//! `ra_xyze [-r] [-o] [-e E] [-c|-u] [-p rx ry gx gy bx by wx wy] [input [output]]`: converts
//! between RGBE, spectra and XYZE (`-r` to RGBE); `-o` undoes exposures, `-c` and `-u` select
//! run-length encoding or none.

use super::files::{failed, open_picture, put_file};
use super::packing::Packing;
use super::raster::rows_of;
use crate::commands::words::Words;
use crate::failure::{Failure, Outcome};
use radsight_picture::{Encoding, Header, PictureWriter, RgbPrimaries, WHITE_EFFICACY, encode_rgbe, xyz_to_rgb};
use radsight_spectrum::xyz_of_whole_bands;

struct Options {
    to_rgb: bool,
    undoes_exposure: bool,
    exposure: f64,
    packing: Option<Packing>,
    primaries: RgbPrimaries,
}

/// Runs `ra_xyze`.
pub(super) fn run(mut words: Words<'_>) -> Outcome {
    let mut options = Options {
        to_rgb: false,
        undoes_exposure: false,
        exposure: 1.0,
        packing: None,
        primaries: RgbPrimaries::STANDARD,
    };
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
    convert(&options, &words)
}

fn convert(options: &Options, words: &Words<'_>) -> Outcome {
    let (path, target) = words.input_and_output()?;
    let mut reader = open_picture(path)?;
    let wrong = |error: radsight_picture::PictureError| failed(path, error.into());
    let from_xyz = reader.encoding() == Encoding::Xyze;
    let primaries = reader.header().primaries().map_err(wrong)?.unwrap_or(RgbPrimaries::STANDARD);
    let of_bands = match reader.encoding() {
        Encoding::Spectral { splits } if reader.components() > 3 => {
            let range = [splits[0], splits[3]].map(f64::from);
            Some(xyz_of_whole_bands(reader.components(), range).collect::<Vec<_>>())
        }
        _ => None,
    };
    let is_rgb = !from_xyz && of_bands.is_none();
    let to_xyz = if is_rgb { Some(primaries.rgb_to_xyz().ok_or_else(|| impossible(path))?) } else { None };
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
    let header = header(options, words, reader.header(), recorded);
    let matrix = to_xyz.map(rows_of);
    let packing = options.packing.unwrap_or(if options.to_rgb { Packing::RunLengths } else { Packing::Flat });
    let resolution = reader.resolution();
    put_file(target, |out| {
        let mut writer = PictureWriter::new(out, &header, 3, resolution).map_err(wrong)?;
        let mut values = vec![[0.0f32; 3]; resolution.scanline_length()];
        for _ in 0..resolution.scanlines() {
            match &of_bands {
                None => reader.read_three(&mut values).map_err(wrong)?,
                Some(of_bands) => {
                    let mut spectra = vec![0.0f32; values.len() * of_bands.len()];
                    reader.read_values(&mut spectra).map_err(wrong)?;
                    for (value, spectrum) in values.iter_mut().zip(spectra.chunks_exact(of_bands.len())) {
                        *value = xyz_of_spectrum(spectrum, of_bands);
                    }
                }
            }
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
    })
}

fn xyz_of_spectrum(spectrum: &[f32], of_bands: &[[f64; 3]]) -> [f32; 3] {
    let part = |i: usize| spectrum.iter().zip(of_bands).map(|(value, xyz)| f64::from(*value) * xyz[i]).sum::<f64>();
    [0, 1, 2].map(|i| part(i) as f32)
}

fn impossible(path: &str) -> Failure {
    Failure::input(format!("{path}: the primaries are collinear or the white is impossible"))
}

fn transformed(rows: &[[f32; 3]; 3], [a, b, c]: [f32; 3]) -> [f32; 3] {
    rows.map(|row| row[0] * a + row[1] * b + row[2] * c)
}

fn header(options: &Options, words: &Words<'_>, input: &Header, recorded: f64) -> Header {
    let mut header = input.clone();
    for name in ["FORMAT", "PRIMARIES", "NCOMP", "WAVELENGTH_SPLITS"] {
        header.remove(name);
    }
    if options.undoes_exposure {
        header.remove("EXPOSURE");
    }
    header.push_command(words.all());
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
