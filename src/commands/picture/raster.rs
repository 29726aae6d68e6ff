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
    Encoding, Header, PictureError, PictureReader, PictureWriter, Resolution, RgbPrimaries, decode_rgbe, encode_rgbe,
};
use radsight_picture_ops::brightness::of_rgb;
use radsight_picture_ops::gamma::shifted;
use radsight_picture_ops::gamut::{Gamut, within_gamut};
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
    conversion: Conversion,
    stops: i32,
    row: Vec<[u8; 4]>,
}

/// The conversion of a pixel's three values.
enum Conversion {
    None,
    /// Three times the second value, the luminance of XYZE.
    Luminance,
    /// To other primaries. Negative components become 0.
    Primaries([[f32; 3]; 3]),
    /// To red, green and blue that a display can show.
    IntoGamut([[f32; 3]; 3]),
}

impl<R: Read> Pixels<R> {
    /// Pixels in the primaries of the picture. Those of XYZE are mapped into the gamut of
    /// `primaries`.
    fn new(reader: PictureReader<R>, stops: i32, primaries: &RgbPrimaries) -> Result<Pixels<R>, PictureError> {
        let conversion = match reader.encoding() {
            Encoding::Xyze => Conversion::IntoGamut(rows_of(primaries.xyz_to_rgb().ok_or(impossible(0, primaries))?)),
            _ => Conversion::None,
        };
        Ok(Pixels::converted(reader, stops, conversion))
    }

    /// Pixels whose brightness is used alone, or that are converted for a display.
    fn for_grey(reader: PictureReader<R>, stops: i32) -> Pixels<R> {
        let conversion = match reader.encoding() {
            Encoding::Xyze => Conversion::Luminance,
            _ => Conversion::None,
        };
        Pixels::converted(reader, stops, conversion)
    }

    fn converted(reader: PictureReader<R>, stops: i32, conversion: Conversion) -> Pixels<R> {
        let row = vec![[0; 4]; reader.resolution().scanline_length()];
        Pixels { reader, conversion, stops, row }
    }

    /// Pixels for colours or grey, in Radiance's primaries.
    fn standard(reader: PictureReader<R>, stops: i32, colors: Colors) -> Result<Pixels<R>, PictureError> {
        match colors {
            Colors::Color => Pixels::new(reader, stops, &RgbPrimaries::STANDARD),
            Colors::Grey => Ok(Pixels::for_grey(reader, stops)),
        }
    }

    /// Converts pixels to a display's primaries and white.
    fn for_display(mut self, primaries: &RgbPrimaries) -> Result<Pixels<R>, PictureError> {
        let own = self.reader.header().primaries()?.unwrap_or(RgbPrimaries::STANDARD);
        let matrix = match self.reader.encoding() {
            Encoding::Xyze => primaries.xyz_to_rgb(),
            _ if own == *primaries => return Ok(self),
            _ => own.rgb_to_rgb(primaries),
        };
        let matrix =
            matrix.ok_or_else(|| match (own.rgb_to_xyz(), self.reader.header().assignments("PRIMARIES").last()) {
                (None, Some(assignment)) => impossible(assignment.line, &own),
                _ => impossible(0, primaries),
            });
        self.conversion = Conversion::Primaries(rows_of(matrix?));
        Ok(self)
    }

    fn size(&self) -> (usize, usize) {
        (self.reader.resolution().scanline_length(), self.reader.resolution().scanlines())
    }

    /// The next scanline as four-byte pixels.
    fn next(&mut self) -> Result<&[[u8; 4]], PictureError> {
        self.reader.read_pixels(&mut self.row)?;
        for pixel in &mut self.row {
            *pixel = self.conversion.of_pixel(shifted(*pixel, self.stops));
        }
        Ok(&self.row)
    }
}

impl Conversion {
    fn of_pixel(&self, pixel: [u8; 4]) -> [u8; 4] {
        match self {
            Conversion::None => pixel,
            Conversion::Luminance => [pixel[1], pixel[1], pixel[1], pixel[3]],
            Conversion::Primaries(matrix) => encode_rgbe(transformed(matrix, decode_rgbe(pixel))),
            Conversion::IntoGamut(matrix) => {
                let rgb = transformed(matrix, decode_rgbe(pixel));
                encode_rgbe(within_gamut(rgb, of_rgb(rgb), Gamut::Cube))
            }
        }
    }
}

/// The error of primaries that make no colour space; `line` is that of the header that has them, or 0.
fn impossible(line: usize, primaries: &RgbPrimaries) -> PictureError {
    PictureError::HeaderValue {
        line,
        name: "PRIMARIES",
        value: primaries.to_header_value(),
        expected: "three colours that are not collinear, and a white inside their triangle",
    }
}

/// The product of a matrix and a vector.
pub(super) fn transformed(rows: &[[f32; 3]; 3], [a, b, c]: [f32; 3]) -> [f32; 3] {
    rows.map(|row| row[0] * a + row[1] * b + row[2] * c)
}

/// The rows of a matrix in single precision.
pub(super) fn rows_of(matrix: DMat3) -> [[f32; 3]; 3] {
    std::array::from_fn(|i| matrix.row(i).to_array().map(|value| value as f32))
}

/// The header of a picture converted from another format, which kept these lines.
fn converted_header(words: &Words<'_>, kept: &Header) -> Header {
    let mut header = Header::new("RADIANCE");
    header.push_body(&kept.history());
    header.push_command(words.taken());
    header.push_variable("FORMAT", Encoding::Rgbe.name());
    header
}

/// Writes a picture of pixels from `row`, in the order of the resolution.
fn write_picture(
    target: &str,
    header: &Header,
    resolution: Resolution,
    mut row: impl FnMut(usize, &mut Vec<u8>) -> Outcome,
) -> Outcome {
    let wrong = |error: PictureError| failed(target, error.into());
    put_file(target, |out: &mut dyn Write| {
        let mut writer = PictureWriter::new(out, header, 3, resolution).map_err(wrong)?;
        let mut stored = Vec::new();
        for number in 0..resolution.scanlines() {
            stored.clear();
            row(number, &mut stored)?;
            writer.write_stored(&stored).map_err(wrong)?;
        }
        writer.finish().map_err(wrong)
    })
}
