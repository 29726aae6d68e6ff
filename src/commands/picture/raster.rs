//! Radiance's converters to and from 8- and 16-bit pictures: `ra_ppm`, `ra_bmp`, `ra_tiff`; and
//! radsight's own `ra_png`.

mod bmp;
mod png;
mod ppm;
mod tiff;

use super::files::{failed, open_picture, put_file};
use crate::commands::words::Words;
use crate::failure::{Failure, Outcome};
use glam::DMat3;
use radsight_picture::{
    Encoding, Header, PictureError, PictureReader, PictureWriter, Resolution, RgbPrimaries, encode_rgbe,
};
use radsight_picture_ops::gamma::shifted;
use std::io::{Read, Write};

pub(super) use bmp::run as ra_bmp;
pub(super) use png::run as ra_png;
pub(super) use ppm::run as ra_ppm;
pub(super) use tiff::run as ra_tiff;

/// The default gamma.
const GAMMA: f64 = 2.2;

/// Whether components are kept.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Colors {
    Color,
    Grey,
}

/// The direction of the conversion.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Direction {
    FromRadiance,
    ToRadiance,
}

/// Exposure in integer stops, which must have a sign.
pub(super) fn stops(words: &mut Words<'_>, option: &str) -> Result<i32, Failure> {
    let word = words.value(option, "a number of stops with its sign")?;
    if !word.starts_with(['+', '-']) {
        let program = words.program();
        return Err(Failure::usage(format!(
            "{program}: option \"{option}\" is followed by \"{word}\", expected a number of stops with its sign"
        )));
    }
    Ok(words.number_in(word, option)?.clamp(-200.0, 200.0) as i32)
}

/// A picture's pixels in red, green and blue.
struct Pixels<R> {
    reader: PictureReader<R>,
    /// From CIE to RGB.
    transform: Option<[[f32; 3]; 3]>,
    stops: i32,
    row: Vec<[u8; 4]>,
}

impl<R: Read> Pixels<R> {
    fn new(reader: PictureReader<R>, stops: i32) -> Pixels<R> {
        let transform = match reader.encoding() {
            Encoding::Xyze => RgbPrimaries::STANDARD.xyz_to_rgb().map(rows_of),
            _ => None,
        };
        let row = vec![[0; 4]; reader.resolution().scanline_length()];
        Pixels { reader, transform, stops, row }
    }

    /// Converts pixels to a display's primaries and white.
    fn for_display(mut self, primaries: &RgbPrimaries) -> Result<Pixels<R>, PictureError> {
        let matrix = match (self.reader.encoding(), self.reader.header().primaries()?) {
            (Encoding::Xyze, _) => primaries.xyz_to_rgb(),
            (_, own) => own.unwrap_or(RgbPrimaries::STANDARD).rgb_to_rgb(primaries),
        };
        let impossible = PictureError::HeaderValue {
            line: 0,
            name: "PRIMARIES",
            value: primaries.to_header_value(),
            expected: "three colours that are not collinear, and a white inside their triangle",
        };
        self.transform = Some(rows_of(matrix.ok_or(impossible)?));
        Ok(self)
    }

    fn size(&self) -> (usize, usize) {
        (self.reader.resolution().scanline_length(), self.reader.resolution().scanlines())
    }

    /// The next scanline as four-byte pixels.
    fn next(&mut self) -> Result<&[[u8; 4]], radsight_picture::PictureError> {
        self.reader.read_pixels(&mut self.row)?;
        for pixel in &mut self.row {
            if let Some(matrix) = &self.transform {
                let value = radsight_picture::decode_rgbe(*pixel);
                let component = |row: &[f32; 3]| row[0] * value[0] + row[1] * value[1] + row[2] * value[2];
                *pixel = encode_rgbe(std::array::from_fn(|i| component(&matrix[i])));
            }
            *pixel = shifted(*pixel, self.stops);
        }
        Ok(&self.row)
    }
}

/// The rows of a matrix in single precision.
pub(super) fn rows_of(matrix: DMat3) -> [[f32; 3]; 3] {
    std::array::from_fn(|i| matrix.row(i).to_array().map(|value| value as f32))
}

/// The properties of a picture converted from another format.
struct Made<'d> {
    /// Columns and rows.
    size: (usize, usize),
    encoding: Encoding,
    /// The date of the picture, if known.
    date: Option<&'d str>,
}

/// Writes a picture of pixels from `row`, starting at the top.
fn write_picture(
    words: &Words<'_>,
    target: &str,
    made: &Made<'_>,
    mut row: impl FnMut(usize, &mut Vec<u8>) -> Outcome,
) -> Outcome {
    let Made { size: (columns, rows), encoding, date } = *made;
    let mut header = Header::new("RADIANCE");
    header.push_command(words.taken());
    header.push_variable("FORMAT", encoding.name());
    if let Some(date) = date {
        header.push_variable("CAPDATE", &format!(" {date}"));
    }
    let wrong = |error: radsight_picture::PictureError| failed(target, error.into());
    put_file(target, |out: &mut dyn Write| {
        let mut writer = PictureWriter::new(out, &header, 3, Resolution::standard(columns, rows)).map_err(wrong)?;
        let mut stored = Vec::new();
        for number in 0..rows {
            stored.clear();
            row(number, &mut stored)?;
            writer.write_stored(&stored).map_err(wrong)?;
        }
        writer.finish().map_err(wrong)
    })
}
