//! `ra_bmp [-r] [-b] [-g GAMMA] [-e ±STOPS|auto|human|linear] [-p rx ry gx gy bx by wx wy] [input
//! [output]]`: Windows bitmaps, with 24 bits or grey (`-b`), for a display with these primaries
//! (`-p`), optionally tone mapped (`-e` with a word); `-r` converts bitmaps of every depth, packed
//! or not, to Radiance.

use super::{Colors, Direction, GAMMA, Pixels, converted_header, open_picture, put_file, stops, write_picture};
use crate::commands::picture::files::{Source, failed, open};
use crate::commands::words::Words;
use crate::failure::{Failure, Outcome, reason};
use image::ImageDecoder;
use image::codecs::bmp::BmpDecoder;
use radsight_picture::{Encoding, Header, PictureError, PictureReader, Resolution, RgbPrimaries};
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
    let primaries = primaries.unwrap_or(RgbPrimaries::STANDARD);
    let output = Output { colors, primaries, gamma };
    match (direction, tones) {
        (Direction::FromRadiance, None) => from_radiance(&words, &output, exposure),
        (Direction::FromRadiance, Some(tones)) => tone_mapped(&words, &output, tones),
        (Direction::ToRadiance, None) => to_radiance(&words, exposure, gamma),
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

/// The colours of a bitmap.
struct Output {
    colors: Colors,
    /// The primaries of the display, for colours.
    primaries: RgbPrimaries,
    gamma: f64,
}

impl Output {
    /// The lines between a bitmap's headers and its pixels: those of the picture's header, and the
    /// display's gamma and primaries.
    fn notes(&self, header: &Header) -> Vec<u8> {
        let mut notes = header.history();
        for name in ["EXPOSURE", "PRIMARIES", "GAMMA"] {
            notes.remove(name);
        }
        notes.push_variable("GAMMA", &format!("{:.2}", self.gamma));
        if self.colors == Colors::Color {
            notes.push_variable("PRIMARIES", &self.primaries.to_header_value());
        }
        let mut bytes: Vec<u8> = notes.body().flat_map(|line| [line, b"\n"].concat()).collect();
        bytes.push(0);
        bytes
    }

    /// Greys use the standard primaries.
    fn pixels(&self, reader: PictureReader<Source>, exposure: i32) -> Result<Pixels<Source>, PictureError> {
        match (self.colors, reader.encoding()) {
            (Colors::Grey, Encoding::Xyze) => Ok(Pixels::for_grey(reader, exposure)),
            (Colors::Grey, _) => Pixels::for_grey(reader, exposure).for_display(&RgbPrimaries::STANDARD),
            (Colors::Color, _) => Pixels::for_grey(reader, exposure).for_display(&self.primaries),
        }
    }
}

fn from_radiance(words: &Words<'_>, output: &Output, exposure: i32) -> Outcome {
    let (path, target) = words.input_and_output()?;
    let wrong = |error: PictureError| failed(path, error.into());
    let reader = open_picture(path)?;
    let bitmap = Bitmap::new(path, output, &reader)?;
    let mut pixels = output.pixels(reader, exposure).map_err(wrong)?;
    let table = GammaTable::new(output.gamma);
    bitmap.write(target, |bytes| {
        for pixel in pixels.next().map_err(wrong)? {
            match output.colors {
                Colors::Grey => bytes.push(table.to_bytes(with_grey(*pixel))[1]),
                Colors::Color => bytes.extend(table.to_bytes(*pixel).iter().rev()),
            }
        }
        Ok(())
    })
}

/// Writes a tone-mapped picture.
fn tone_mapped(words: &Words<'_>, output: &Output, tones: Tones) -> Outcome {
    let (path, target) = words.input_and_output()?;
    let display = match output.colors {
        Colors::Grey => Display::Grey,
        Colors::Color => Display::Color(output.primaries),
    };
    let reader = open_picture(path)?;
    let bitmap = Bitmap::new(path, output, &reader)?;
    let pixels = tone_map(reader, tones, &display).map_err(|error| failed(path, error))?;
    let byte = |light: f32| (256.0 * f64::from(light).powf(1.0 / output.gamma)) as u8;
    let mut rows = pixels.chunks_exact(bitmap.size[0]);
    bitmap.write(target, |bytes| {
        for pixel in rows.next().unwrap_or_default() {
            match output.colors {
                Colors::Grey => bytes.push(byte(pixel[1])),
                Colors::Color => bytes.extend(pixel.iter().rev().map(|light| byte(*light))),
            }
        }
        Ok(())
    })
}

/// The headers of a bitmap, and the sizes of its pixels.
struct Bitmap {
    headers: Vec<u8>,
    /// Columns and rows.
    size: [usize; 2],
    /// Number of bytes of a row.
    stride: usize,
}

impl Bitmap {
    /// The bitmap of a picture, with rows from the top.
    fn new(path: &str, output: &Output, reader: &PictureReader<Source>) -> Result<Bitmap, Failure> {
        let (columns, rows) = (reader.resolution().scanline_length(), reader.resolution().scanlines());
        let (components, palette) = if output.colors == Colors::Grey { (1, PALETTE) } else { (3, 0) };
        let stride = (columns * components).next_multiple_of(4);
        let notes = output.notes(reader.header());
        let start = HEADERS + palette + notes.len();
        let size = stride * rows;
        let (Ok(width), Ok(height), Ok(total)) =
            (i32::try_from(columns), i32::try_from(rows), u32::try_from(start + size))
        else {
            return Err(Failure::input(format!("{path}: {columns} x {rows} pixels exceed the size of a bitmap")));
        };
        let mut headers = Vec::with_capacity(start);
        headers.extend_from_slice(b"BM");
        // Rows from the top have a negative height.
        for number in [total, 0, start as u32, 40, width as u32, -height as u32] {
            headers.extend_from_slice(&number.to_le_bytes());
        }
        headers.extend_from_slice(&1u16.to_le_bytes());
        headers.extend_from_slice(&(8 * components as u16).to_le_bytes());
        let entries = palette as u32 / 4;
        for number in [0, size as u32, DOTS_PER_METRE, DOTS_PER_METRE, entries, 0] {
            headers.extend_from_slice(&number.to_le_bytes());
        }
        headers.extend((0..palette / 4).flat_map(|grey| [grey as u8, grey as u8, grey as u8, 0]));
        headers.extend(notes);
        Ok(Bitmap { headers, size: [columns, rows], stride })
    }

    /// Writes the bitmap; `put_row` adds the bytes of each row, blue first.
    fn write(&self, target: &str, mut put_row: impl FnMut(&mut Vec<u8>) -> Outcome) -> Outcome {
        put_file(target, |out| {
            let failed_write = |error: std::io::Error| Failure::write(target, &error);
            out.write_all(&self.headers).map_err(failed_write)?;
            let mut row = Vec::with_capacity(self.stride);
            for _ in 0..self.size[1] {
                row.clear();
                put_row(&mut row)?;
                row.resize(self.stride, 0);
                out.write_all(&row).map_err(failed_write)?;
            }
            Ok(())
        })
    }
}

/// The lines that Radiance's converters store between a bitmap's headers and its pixels; none if
/// the bytes there are anything else.
fn notes(bytes: &[u8]) -> Option<Header> {
    let number = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?) as usize);
    let bits = u16::from_le_bytes(bytes.get(28..30)?.try_into().ok()?);
    let colors = match number(46)? {
        0 if bits <= 8 => 1usize << bits,
        colors => colors,
    };
    let start = number(14)?.checked_add(14)?.checked_add(colors.checked_mul(4)?)?;
    let text = bytes.get(start..number(10)?)?.strip_suffix(b"\n\0")?;
    let is_header =
        !text.is_empty() && !text.contains(&0) && text.split(|byte| *byte == b'\n').all(|line| !line.is_empty());
    is_header.then(|| Header::read_text(text))
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

/// The gamma in the bitmap is used instead of the option, as in Radiance.
fn to_radiance(words: &Words<'_>, exposure: i32, gamma: f64) -> Outcome {
    let (path, target) = words.input_and_output()?;
    let mut bytes = Vec::new();
    let read = open(path)?.read_to_end(&mut bytes);
    read.map_err(|error| Failure::input(format!("{path}: {}", reason(&error))))?;
    let (columns, rows, colors) = read_bitmap(path, &bytes)?;
    let mut notes = notes(&bytes).unwrap_or_default();
    let own = notes.variable("GAMMA").and_then(|gamma| gamma.trim().parse::<f64>().ok());
    let table = GammaTable::new(own.filter(|gamma| gamma.is_finite() && *gamma > 0.0).unwrap_or(gamma));
    notes.remove("GAMMA");
    let header = converted_header(words, &notes);
    write_picture(target, &header, Resolution::standard(columns, rows), |row, stored| {
        let colors = &colors[3 * columns * row..3 * columns * (row + 1)];
        stored.extend(colors.as_chunks().0.iter().flat_map(|color| shifted(table.pixel(*color), exposure)));
        Ok(())
    })
}
