//! `ra_png [-b] [-g GAMMA] [-e ±STOPS] [input [output]]`: PNG pictures of 8 bits, grey (`-b`) or
//! coloured. A converter of radsight's own in the style of Radiance's; the header is stored as
//! text.

use super::{Colors, GAMMA, Pixels, open_picture, put_file, stops};
use crate::commands::picture::files::{failed, write_failed};
use crate::commands::words::Words;
use crate::failure::{Failure, Outcome};
use radsight_picture::{Image, write_png_grey8, write_png_rgb8};
use radsight_picture_ops::gamma::{GammaTable, with_grey};

/// Largest number of pixels: the picture is held in memory.
const MOST_PIXELS: usize = 1 << 28;

/// Runs the program.
pub(crate) fn run(mut words: Words<'_>) -> Outcome {
    let (mut colors, mut gamma, mut brighter) = (Colors::Color, GAMMA, 0);
    while let Some(option) = words.option()? {
        match option {
            "-b" => colors = Colors::Grey,
            "-g" => gamma = words.number(option)?,
            "-e" => brighter = stops(&mut words, option)?,
            _ => return Err(words.unknown(option)),
        }
    }
    let (path, target) = words.input_and_output()?;
    let reader = open_picture(path)?;
    let resolution = reader.resolution();
    let header = reader.header().clone();
    if resolution.width.saturating_mul(resolution.height) > MOST_PIXELS {
        let (width, height) = (resolution.width, resolution.height);
        return Err(Failure::input(format!("{path}: {width} x {height} pixels, expected at most {MOST_PIXELS}")));
    }
    let table = GammaTable::new(gamma);
    let wrong = |error: radsight_picture::PictureError| failed(path, error.into());
    let mut pixels = Pixels::standard(reader, brighter, colors).map_err(wrong)?;
    let mut bytes = Vec::new();
    for _ in 0..resolution.scanlines() {
        for pixel in pixels.next().map_err(wrong)? {
            match colors {
                Colors::Color => bytes.extend_from_slice(&table.to_bytes(*pixel)),
                Colors::Grey => bytes.push(table.to_bytes(with_grey(*pixel))[1]),
            }
        }
    }
    let components = if colors == Colors::Color { 3 } else { 1 };
    let image: Image<u8> = resolution.upright(components, bytes).map_err(wrong)?;
    let png = match colors {
        Colors::Color => write_png_rgb8(&image, Some(&header)),
        Colors::Grey => write_png_grey8(&image, Some(&header)),
    };
    let png = png.map_err(wrong)?;
    put_file(target, |out| out.write_all(&png).map_err(|error| write_failed(&error)))
}
