//! `ra_tiff [-b] [-w|-f|-L] [-z] [-g GAMMA] [-e ±STOPS] input output`: TIFF with 8 bits, 16 (`-w`),
//! floats (`-f`) or LogLuv (`-L`), grey (`-b`), compressed (`-z`); `-r` converts to Radiance, to
//! XYZE with `-x`.

use super::{Colors, Direction, GAMMA, Made, Pixels, open_picture, put_file, rows_of, stops, write_picture};
use crate::commands::picture::files::{failed, open};
use crate::commands::words::Words;
use crate::failure::{Failure, Outcome, reason};
use radsight_picture::{
    Encoding, RgbPrimaries, Tiff, TiffCompression, TiffPixels, decode_rgbe, encode_rgbe, read_tiff_pixels,
    write_log_luv, write_tiff_pixels,
};
use radsight_picture_ops::brightness::of_rgb;
use radsight_picture_ops::gamma::{GammaTable, shifted, with_grey};
use std::io::Read;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Depth {
    Bytes,
    Words,
    Floats,
    LogLuv,
}

struct Options {
    direction: Direction,
    colors: Colors,
    depth: Depth,
    compression: TiffCompression,
    gamma: f64,
    stops: i32,
    /// The encoding of a picture made from TIFF.
    encoding: Encoding,
}

/// Runs the program.
pub(crate) fn run(mut words: Words<'_>) -> Outcome {
    let mut options = Options {
        direction: Direction::FromRadiance,
        colors: Colors::Color,
        depth: Depth::Bytes,
        compression: TiffCompression::None,
        gamma: GAMMA,
        stops: 0,
        encoding: Encoding::Rgbe,
    };
    while let Some(option) = words.option()? {
        match option {
            "-b" => options.colors = Colors::Grey,
            "-w" => options.depth = Depth::Words,
            "-f" => options.depth = Depth::Floats,
            "-z" => options.compression = TiffCompression::Lzw,
            "-g" => options.gamma = words.number(option)?,
            "-e" => options.stops = stops(&mut words, option)?,
            "-r" => options.direction = Direction::ToRadiance,
            "-L" => options.depth = Depth::LogLuv,
            "-x" => {
                options.encoding = match options.encoding {
                    Encoding::Xyze => Encoding::Rgbe,
                    _ => Encoding::Xyze,
                }
            }
            "-l" => {
                return Err(Failure::usage(
                    "ra_tiff: option \"-l\" (24-bit LogLuv) is not supported, expected -L or -f for the full range",
                ));
            }
            _ => return Err(words.unknown(option)),
        }
    }
    match options.direction {
        Direction::FromRadiance => from_radiance(&options, &words),
        Direction::ToRadiance => to_radiance(&options, &words),
    }
}

fn from_radiance(options: &Options, words: &Words<'_>) -> Outcome {
    let (path, target) = words.input_and_output()?;
    let reader = open_picture(path)?;
    let mut header = reader.header().history();
    header.push_command(words.all());
    let mut pixels = Pixels::new(reader, options.stops);
    let (width, height) = pixels.size();
    if options.depth == Depth::LogLuv && options.colors == Colors::Grey {
        return Err(Failure::usage(
            "ra_tiff: -b with -L (grey LogLuv) is not supported, expected one of them".to_owned(),
        ));
    }
    let components = if options.colors == Colors::Grey { 1 } else { 3 };
    let table = GammaTable::new(options.gamma);
    let mut found = match options.depth {
        Depth::Bytes => TiffPixels::Bytes(Vec::new()),
        Depth::Words => TiffPixels::Words(Vec::new()),
        Depth::Floats | Depth::LogLuv => TiffPixels::Floats(Vec::new()),
    };
    for _ in 0..height {
        for pixel in pixels.next().map_err(|error| failed(path, error.into()))? {
            options.put(*pixel, &table, &mut found);
        }
    }
    let bytes = match (&found, options.depth) {
        (TiffPixels::Floats(values), Depth::LogLuv) => write_log_luv((width, height), values, Some(&header)),
        _ => {
            let picture = Tiff { width, height, components, pixels: found, header: Some(header), date: None };
            write_tiff_pixels(&picture, options.compression)
        }
    };
    let bytes = bytes.map_err(|error| failed(path, error.into()))?;
    put_file(target, |out| out.write_all(&bytes).map_err(|error| Failure::write(target, &error)))
}

impl Options {
    fn put(&self, pixel: [u8; 4], table: &GammaTable, pixels: &mut TiffPixels) {
        let is_grey = self.colors == Colors::Grey;
        let value = || match decode_rgbe(pixel) {
            value if is_grey => vec![of_rgb(value) as f32],
            value => value.to_vec(),
        };
        match pixels {
            TiffPixels::Bytes(bytes) if is_grey => bytes.push(table.to_bytes(with_grey(pixel))[1]),
            TiffPixels::Bytes(bytes) => bytes.extend_from_slice(&table.to_bytes(pixel)),
            TiffPixels::Words(words) => words.extend(value().iter().map(|value| self.word(*value))),
            TiffPixels::Floats(floats) => floats.extend_from_slice(&value()),
        }
    }

    fn word(&self, value: f32) -> u16 {
        match value {
            value if value <= 0.0 => 0,
            value if value >= 1.0 => u16::MAX,
            value => (65536.0 * f64::from(value).powf(1.0 / self.gamma)) as u16,
        }
    }

    /// The pixel of a TIFF whose numbers begin at `start`.
    fn pixel(&self, picture: &Tiff, start: usize, table: &GammaTable) -> [u8; 4] {
        let at = |component: usize| start + if picture.components < 3 { 0 } else { component };
        let scale = 2f64.powi(self.stops);
        match &picture.pixels {
            TiffPixels::Bytes(bytes) => shifted(table.pixel(std::array::from_fn(|i| bytes[at(i)])), self.stops),
            TiffPixels::Words(words) => encode_rgbe(std::array::from_fn(|i| {
                let linear = ((f64::from(words[at(i)]) + 0.5) / 65536.0).powf(self.gamma) as f32;
                (f64::from(linear) * scale) as f32
            })),
            TiffPixels::Floats(floats) => {
                encode_rgbe(std::array::from_fn(|i| (f64::from(floats[at(i)]) * scale) as f32))
            }
        }
    }
}

fn to_radiance(options: &Options, words: &Words<'_>) -> Outcome {
    let (path, target) = words.input_and_output()?;
    let mut bytes = Vec::new();
    let read = open(path)?.read_to_end(&mut bytes);
    read.map_err(|error| Failure::input(format!("{path}: {}", reason(&error))))?;
    let picture = read_tiff_pixels(&bytes).map_err(|error| failed(path, error.into()))?;
    let table = GammaTable::new(options.gamma);
    let to_xyz = RgbPrimaries::STANDARD.xyz_to_rgb().filter(|_| options.encoding == Encoding::Xyze);
    let to_xyz = to_xyz.map(|matrix| rows_of(matrix.inverse()));
    let made =
        Made { size: (picture.width, picture.height), encoding: options.encoding, date: picture.date.as_deref() };
    write_picture(words, target, &made, |row, stored| {
        for column in 0..picture.width {
            let start = (row * picture.width + column) * picture.components;
            let mut pixel = options.pixel(&picture, start, &table);
            if let Some(matrix) = &to_xyz {
                let [red, green, blue] = decode_rgbe(pixel);
                pixel = encode_rgbe(matrix.map(|row| row[0] * red + row[1] * green + row[2] * blue));
            }
            stored.extend_from_slice(&pixel);
        }
        Ok(())
    })
}
