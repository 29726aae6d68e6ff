//! `ra_bmp [-r] [-b] [-g GAMMA] [-e ±STOPS|auto|human|linear] [-p rx ry gx gy bx by wx wy] [input [output]]`: Windows bitmaps, with 24 bits or grey (`-b`), for a
//! display with these primaries (`-p`), within whose range a picture can be brought (`-e` with a word); `-r` the other way (8, 24 and 32 bits, not packed).

use super::{Colors, Direction, GAMMA, Made, Pixels, open_picture, put_file, stops, write_picture};
use crate::commands::picture::files::{failed, open};
use crate::commands::words::Words;
use crate::failure::{Failure, Outcome, reason};
use radsight_picture::{Encoding, RgbPrimaries};
use radsight_picture_ops::gamma::{GammaTable, shifted, with_grey};
use radsight_picture_ops::tone_map::{Display, Tones, tone_map};
use std::io::Read;

/// Bytes of the two headers.
const HEADERS: usize = 54;
/// Bytes of a palette of 256 colours.
const PALETTE: usize = 1024;
/// 72 dots an inch, in dots a metre.
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
            Err(Failure::usage("ra_bmp: bitmaps (-r) have no range to be mapped, expected -e with a number of stops"))
        }
    }
}

/// The tone mapping that a word means, or as much of it as is written.
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
    // Greys are those of the usual primaries.
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

/// Writes a picture within the range of the display.
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

/// Writes a bitmap whose rows come from the top; of each `put_row` adds the bytes, blue first.
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
        return Err(Failure::input(format!("{path}: {columns} x {rows} pixels are too many for a bitmap")));
    };
    let mut bytes = Vec::with_capacity(HEADERS + palette);
    bytes.extend_from_slice(b"BM");
    // Rows from the top have a height below zero.
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

/// What the headers of a bitmap say.
struct Bitmap {
    start: usize,
    columns: usize,
    rows: usize,
    is_upright: bool,
    bits: usize,
    palette: Vec<[u8; 4]>,
}

impl Bitmap {
    fn read(bytes: &[u8]) -> Option<Bitmap> {
        let number = |at: usize| Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk::<4>()?));
        if !bytes.starts_with(b"BM") {
            return None;
        }
        let (start, header) = (number(10)? as usize, number(14)? as usize);
        let (columns, height) = (number(18)? as i32, number(22)? as i32);
        let bits = usize::from(u16::from_le_bytes(*bytes.get(28..)?.first_chunk::<2>()?));
        let packing = number(30)?;
        if columns <= 0
            || height == 0
            || !matches!(bits, 8 | 24 | 32)
            || !(packing == 0 || (packing == 3 && bits == 32))
        {
            return None;
        }
        let mut palette = Vec::new();
        if bits == 8 {
            let entries = match number(46)? as usize {
                0 => 256,
                entries => entries.min(256),
            };
            let from = 14usize.checked_add(header)?;
            palette.extend_from_slice(bytes.get(from..from.checked_add(4 * entries)?)?.as_chunks::<4>().0);
        }
        let rows = height.unsigned_abs() as usize;
        let bitmap = Bitmap { start, columns: columns as usize, rows, is_upright: height < 0, bits, palette };
        let end = bitmap.stride()?.checked_mul(rows)?.checked_add(start)?;
        (end <= bytes.len()).then_some(bitmap)
    }

    fn stride(&self) -> Option<usize> {
        Some(self.columns.checked_mul(self.bits)?.div_ceil(32) * 4)
    }

    /// The colours of a row, from the top.
    fn row<'a>(&'a self, bytes: &'a [u8], row: usize) -> impl Iterator<Item = [u8; 3]> + 'a {
        let row = if self.is_upright { row } else { self.rows - 1 - row };
        let stride = self.columns * self.bits / 8;
        let start = self.start + row * self.stride().unwrap_or(0);
        bytes[start..start + stride].chunks_exact(self.bits / 8).map(|pixel| match *pixel {
            [index] => {
                self.palette.get(usize::from(index)).map_or([0; 3], |[blue, green, red, _]| [*red, *green, *blue])
            }
            [blue, green, red, ..] => [red, green, blue],
            _ => [0; 3],
        })
    }
}

fn to_radiance(words: &Words<'_>, exposure: i32, table: &GammaTable) -> Outcome {
    let (path, target) = words.input_and_output()?;
    let mut bytes = Vec::new();
    let read = open(path)?.read_to_end(&mut bytes);
    read.map_err(|error| Failure::input(format!("{path}: {}", reason(&error))))?;
    let bitmap = Bitmap::read(&bytes)
        .ok_or_else(|| Failure::input(format!("{path}: not a bitmap of 8, 24 or 32 bits without packing")))?;
    let made = Made { size: (bitmap.columns, bitmap.rows), encoding: Encoding::Rgbe, date: None };
    write_picture(words, target, &made, |row, stored| {
        stored.extend(bitmap.row(&bytes, row).flat_map(|color| shifted(table.pixel(color), exposure)));
        Ok(())
    })
}
