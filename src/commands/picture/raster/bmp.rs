//! `ra_bmp [-r] [-b] [-g GAMMA] [-e ±STOPS|auto|human|linear] [-p rx ry gx gy bx by wx wy] [input
//! [output]]`: Windows bitmaps, with 24 bits or grey (`-b`), for a display with these primaries
//! (`-p`), optionally tone mapped (`-e` with a word); `-r` converts bitmaps of every depth, packed
//! or not, to Radiance.

use super::{Colors, Direction, GAMMA, Made, Pixels, open_picture, put_file, stops, write_picture};
use crate::commands::picture::files::{failed, open};
use crate::commands::words::Words;
use crate::failure::{Failure, Outcome, reason};
use image::ImageDecoder;
use image::codecs::bmp::BmpDecoder;
use radsight_picture::{Encoding, RgbPrimaries};
use radsight_picture_ops::gamma::{GammaTable, shifted, with_grey};
use radsight_picture_ops::tone_map::{Display, Tones, tone_map};
use std::io::{Cursor, Read};

/// Size of the two headers, bytes.
const HEADERS: usize = 54;
/// Size of a palette of 256 colours, bytes.
const PALETTE: usize = 1024;
/// A run of 255 pixels takes two bytes of a packed bitmap; each pixel takes three bytes here.
const MOST_PIXELS_A_BYTE: u64 = 3 * 255 / 2 + 1;
/// 72 dots per inch, in dots per metre.
const DOTS_PER_METRE: u32 = 2835;

/// Runs the program.
pub(crate) fn run(mut words: Words<'_>) -> Outcome {
    let (mut direction, mut colors, mut gamma, mut exposure) = (Direction::FromRadiance, Colors::Color, GAMMA, 0);
    let (mut primaries, mut tones) = (None, None);
    while let Some(option) = words.option()? {
        match option {
            "-b" => colors = Colors::Grey,
            "-g" => gamma = words.number(option)?,
            "-e" if words.rest().first().is_some_and(|word| word.starts_with(['+', '-'])) => {
                exposure = stops(&mut words, option)?;
            }
            "-e" => tones = Some(tones_of(&mut words, option)?),
            "-r" => direction = Direction::ToRadiance,
            "-p" => primaries = Some(words.primaries(option)?),
            _ => return Err(words.unknown(option)),
        }
    }
    let table = GammaTable::new(gamma);
    match (direction, tones) {
        (Direction::FromRadiance, None) => from_radiance(&words, colors, (exposure, primaries), &table),
        (Direction::FromRadiance, Some(tones)) => tone_mapped(&words, colors, (tones, primaries), gamma),
        (Direction::ToRadiance, None) => to_radiance(&words, exposure, &table),
        (Direction::ToRadiance, Some(_)) => {
            Err(Failure::usage("ra_bmp: bitmaps (-r) cannot be tone mapped, expected -e with a number of stops"))
        }
    }
}

/// The tone mapping for a word or its abbreviation.
fn tones_of(words: &mut Words<'_>, option: &str) -> Result<Tones, Failure> {
    const EXPECTED: &str = "a number of stops with its sign, auto, human or linear";
    let word = words.value(option, EXPECTED)?;
    let known = [("auto", Tones::Automatic), ("human", Tones::Human), ("linear", Tones::Linear)];
    let found = known.into_iter().find(|(name, _)| !word.is_empty() && name.starts_with(word));
    found.map(|(_, tones)| tones).ok_or_else(|| {
        Failure::usage(format!("ra_bmp: option \"{option}\" is followed by \"{word}\", expected {EXPECTED}"))
    })
}

fn from_radiance(
    words: &Words<'_>,
    colors: Colors,
    (exposure, primaries): (i32, Option<RgbPrimaries>),
    table: &GammaTable,
) -> Outcome {
    let (path, target) = words.input_and_output()?;
    let mut pixels = Pixels::new(open_picture(path)?, exposure);
    // Greys use the standard primaries.
    if let Some(primaries) = primaries.filter(|_| colors == Colors::Color) {
        pixels = pixels.for_display(&primaries).map_err(|error| failed(path, error.into()))?;
    }
    write_bitmap([path, target], pixels.size(), colors, |bytes| {
        for pixel in pixels.next().map_err(|error| failed(path, error.into()))? {
            match colors {
                Colors::Grey => bytes.push(table.to_bytes(with_grey(*pixel))[1]),
                Colors::Color => bytes.extend(table.to_bytes(*pixel).iter().rev()),
            }
        }
        Ok(())
    })
}

/// Writes a tone-mapped picture.
fn tone_mapped(
    words: &Words<'_>,
    colors: Colors,
    (tones, primaries): (Tones, Option<RgbPrimaries>),
    gamma: f64,
) -> Outcome {
    let (path, target) = words.input_and_output()?;
    let display = match colors {
        Colors::Grey => Display::Grey,
        Colors::Color => Display::Color(primaries.unwrap_or(RgbPrimaries::STANDARD)),
    };
    let reader = open_picture(path)?;
    let size = (reader.resolution().scanline_length(), reader.resolution().scanlines());
    let pixels = tone_map(reader, tones, &display).map_err(|error| failed(path, error))?;
    let byte = |light: f32| (256.0 * f64::from(light).powf(1.0 / gamma)) as u8;
    let mut rows = pixels.chunks_exact(size.0);
    write_bitmap([path, target], size, colors, |bytes| {
        for pixel in rows.next().unwrap_or_default() {
            match colors {
                Colors::Grey => bytes.push(byte(pixel[1])),
                Colors::Color => bytes.extend(pixel.iter().rev().map(|light| byte(*light))),
            }
        }
        Ok(())
    })
}

/// Writes a bitmap with rows from the top; `put_row` adds the bytes of each, blue first.
fn write_bitmap(
    [path, target]: [&str; 2],
    (columns, rows): (usize, usize),
    colors: Colors,
    mut put_row: impl FnMut(&mut Vec<u8>) -> Outcome,
) -> Outcome {
    let components = if colors == Colors::Grey { 1 } else { 3 };
    let stride = (columns * components).next_multiple_of(4);
    let palette = if colors == Colors::Grey { PALETTE } else { 0 };
    let size = stride * rows;
    let (Ok(width), Ok(height), Ok(total)) =
        (i32::try_from(columns), i32::try_from(rows), u32::try_from(HEADERS + palette + size))
    else {
        return Err(Failure::input(format!("{path}: {columns} x {rows} pixels exceed the size of a bitmap")));
    };
    let mut bytes = Vec::with_capacity(HEADERS + palette);
    bytes.extend_from_slice(b"BM");
    // Rows from the top have a negative height.
    for number in [total, 0, (HEADERS + palette) as u32, 40, width as u32, -height as u32] {
        bytes.extend_from_slice(&number.to_le_bytes());
    }
    bytes.extend_from_slice(&1u16.to_le_bytes());
    bytes.extend_from_slice(&(8 * components as u16).to_le_bytes());
    let entries = palette as u32 / 4;
    for number in [0, size as u32, DOTS_PER_METRE, DOTS_PER_METRE, entries, 0] {
        bytes.extend_from_slice(&number.to_le_bytes());
    }
    bytes.extend((0..palette / 4).flat_map(|grey| [grey as u8, grey as u8, grey as u8, 0]));
    put_file(target, |out| {
        let failed_write = |error: std::io::Error| Failure::write(target, &error);
        out.write_all(&bytes).map_err(failed_write)?;
        let mut row = Vec::with_capacity(stride);
        for _ in 0..rows {
            row.clear();
            put_row(&mut row)?;
            row.resize(stride, 0);
            out.write_all(&row).map_err(failed_write)?;
        }
        Ok(())
    })
}

/// Reads a bitmap: columns, rows, and red, green and blue of each pixel from the top left.
fn read_bitmap(path: &str, bytes: &[u8]) -> Result<(usize, usize, Vec<u8>), Failure> {
    let wrong = |error: image::ImageError| Failure::input(format!("{path}: cannot read the bitmap: {error}"));
    let decoder = BmpDecoder::new(Cursor::new(bytes)).map_err(wrong)?;
    let ((columns, rows), size) = (decoder.dimensions(), decoder.total_bytes());
    // Packed rows of one colour are short, but no pixel takes less than this share of a byte.
    if size / MOST_PIXELS_A_BYTE > bytes.len() as u64 {
        return Err(Failure::input(format!("{path}: ends before {columns} x {rows} pixels")));
    }
    let channels = usize::from(decoder.color_type().channel_count());
    let mut pixels = vec![0; usize::try_from(size).unwrap_or(usize::MAX)];
    decoder.read_image(&mut pixels).map_err(wrong)?;
    // Radiance has no transparency.
    let colors = match channels {
        1 => pixels.iter().flat_map(|grey| [*grey; 3]).collect(),
        3 => pixels,
        _ => pixels.chunks_exact(channels).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect(),
    };
    Ok((columns as usize, rows as usize, colors))
}

fn to_radiance(words: &Words<'_>, exposure: i32, table: &GammaTable) -> Outcome {
    let (path, target) = words.input_and_output()?;
    let mut bytes = Vec::new();
    let read = open(path)?.read_to_end(&mut bytes);
    read.map_err(|error| Failure::input(format!("{path}: {}", reason(&error))))?;
    let (columns, rows, colors) = read_bitmap(path, &bytes)?;
    let made = Made { size: (columns, rows), encoding: Encoding::Rgbe, date: None };
    write_picture(words, target, &made, |row, stored| {
        let colors = &colors[3 * columns * row..3 * columns * (row + 1)];
        stored.extend(colors.as_chunks().0.iter().flat_map(|color| shifted(table.pixel(*color), exposure)));
        Ok(())
    })
}
