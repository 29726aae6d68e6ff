//! Values printed on the picture in rows and columns (`-odim`), or on a part of it (`-orct`).

use super::{Options, layer, legend_sign, reader_of};
use crate::commands::picture::files::{Source, failed};
use crate::commands::picture::psign::picture_of;
use crate::failure::Failure;
use radsight_picture::{Encoding, Header, Picture, PictureReader, scientific};
use radsight_picture_ops::brightness::of_rgb;
use radsight_picture_ops::compose::{Layer, compose};
use radsight_picture_ops::filter::{FilterOptions, Kernel, Size, filter_one_pass};

/// The layout of the printed values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Overlay {
    /// Columns and rows of values.
    pub(super) counts: [usize; 2],
    /// Left, lower, right and upper border of the covered part, pixels; the whole picture by
    /// default.
    pub(super) part: Option<[i64; 4]>,
}

/// Height of letters, relative to the cell of a value, vertically and horizontally.
const HEIGHT_DOWN: f64 = 0.67;
const HEIGHT_ACROSS: f64 = 0.167;

/// Smallest readable letters, pixels.
const LEAST_HEIGHT: usize = 10;

/// Decimals of a value's mantissa.
const DIGITS: usize = 3;

impl Overlay {
    /// The layers over the colours, whose lower left corner is at `left`: a shadow and the values.
    /// Also returns the height of their letters.
    pub(super) fn layers(
        &self,
        options: &Options,
        reader: PictureReader<Source>,
        left: i64,
    ) -> Result<([Layer<Source>; 2], usize), Failure> {
        let [x, y, width, height] = self.place(&reader)?;
        let across = width as f64 / self.counts[0] as f64;
        let down = height as f64 / self.counts[1] as f64;
        let letter = ((down * HEIGHT_DOWN + 0.5) as usize).min((across * HEIGHT_ACROSS) as usize);
        if letter < LEAST_HEIGHT {
            return Err(Failure::usage(format!(
                "falsecolor: option \"-odim\": {} x {} values do not fit with letters of {LEAST_HEIGHT} pixels in {width} x {height}",
                self.counts[0], self.counts[1]
            )));
        }
        let means = means(options, reader, [x, y, width, height], letter)?;
        let sign = legend_sign(letter);
        let mut labels = Vec::new();
        for row in 0..self.counts[1] {
            let row = (down * (row as f64 + 0.5)) as i64;
            for column in 0..self.counts[0] {
                let column = (across * (column as f64 + 0.5)) as i64;
                let value = means[row as usize * width as usize + column as usize];
                let mut label = layer(picture_of(&shown(value), &sign)?, [0, 0])?;
                let size = label.size();
                label.corner = [column - size[0] / 2, height - 1 - row - size[1] / 2];
                labels.push(label);
            }
        }
        let wrong = |error| failed("overlay", error);
        let mut header = Header::new("RADIANCE");
        header.push_variable("FORMAT", Encoding::Rgbe.name());
        let mut text = Vec::new();
        compose(&mut labels, [width as usize, height as usize], [0; 4], &header, &mut text).map_err(wrong)?;
        let shadow = super::inverted(&text)?;
        let mut shadow = layer(shadow, [left + x, y])?;
        shadow.below = Some(0.1);
        let mut text = layer(text, [left + x - 2, y + 1])?;
        text.above = Some(0.5);
        Ok(([shadow, text], letter))
    }

    /// The covered part: corner and size.
    fn place(&self, reader: &PictureReader<Source>) -> Result<[i64; 4], Failure> {
        let resolution = reader.resolution();
        let size = [resolution.scanline_length() as i64, resolution.scanlines() as i64];
        let [left, lower, right, upper] = self.part.unwrap_or([0, 0, size[0], size[1]]);
        if left < 0 || lower < 0 || right <= left || upper <= lower || right > size[0] || upper > size[1] {
            return Err(Failure::usage(format!(
                "falsecolor: option \"-orct\" with {left} {lower} {right} {upper}: expected left, lower, right and upper border within {} x {} pixels",
                size[0], size[1]
            )));
        }
        Ok([left, lower, right - left, upper - lower])
    }
}

/// The brightness of each pixel of a part, averaged over the height of a letter.
fn means(
    options: &Options,
    reader: PictureReader<Source>,
    [x, y, width, height]: [i64; 4],
    letter: usize,
) -> Result<Vec<f64>, Failure> {
    let path = &options.picture;
    let wrong = |error| failed(path, error);
    let scale = reader.header().radiance_scale().map_err(|error| wrong(error.into()))?;
    let mut header = Header::new("RADIANCE");
    header.push_variable("FORMAT", Encoding::Rgbe.name());
    let mut part = Vec::new();
    let mut layers = [Layer { reader, corner: [-x, -y], above: None, below: None }];
    compose(&mut layers, [width as usize, height as usize], [0; 4], &header, &mut part).map_err(wrong)?;
    let share = Size::Scale(1.0 / letter as f64);
    let smaller = FilterOptions { columns: share, rows: share, ..FilterOptions::default() };
    let larger = FilterOptions {
        columns: Size::Pixels(width as usize),
        rows: Size::Pixels(height as usize),
        kernel: Kernel::Gaussian { radius: 0.5 },
        ..FilterOptions::default()
    };
    for filter in [smaller, larger] {
        let reader = reader_of(Box::new(std::io::Cursor::new(part)), path)?;
        part = Vec::new();
        filter_one_pass(reader, &filter, &["pfilt"], &mut part).map_err(wrong)?;
    }
    let picture = Picture::read(&part).map_err(|error| wrong(error.into()))?;
    if picture.width() as i64 != width || picture.height() as i64 != height {
        return Err(Failure::input(format!("{path}: the pixels are not square")));
    }
    let values = picture.three_values();
    let bright = |pixel: &[f32; 3]| of_rgb(std::array::from_fn(|i| pixel[i] * scale[i]));
    Ok(values.data().as_chunks::<3>().0.iter().map(|pixel| bright(pixel) * options.scale.multiplier).collect())
}

/// A value with four digits, without an exponent from a thousandth to ten millions.
fn shown(value: f64) -> String {
    let text = scientific(value, DIGITS);
    let Some((mantissa, exponent)) = text.split_once('e') else { return text };
    let Ok(exponent) = exponent.parse::<i32>() else { return text.clone() };
    let digits = mantissa.replace('.', "");
    match exponent {
        -3..0 => format!("0.{}{digits}", "0".repeat(exponent.unsigned_abs() as usize - 1)),
        0..3 => radsight_picture::general(text.parse().unwrap_or(value), 6),
        3..=6 => format!("{digits}{}", "0".repeat(exponent as usize - DIGITS)),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::shown;

    #[test]
    fn values_have_four_digits() {
        for (value, text) in [
            (0.00012345, "1.234e-04"),
            (0.0012345, "0.001234"),
            (0.12345, "0.1235"),
            (1.5, "1.5"),
            (123.45, "123.5"),
            (1234.5, "1234"),
            (12345.0, "12340"),
            (1.2345e6, "1234000"),
            (1.2345e7, "1.234e+07"),
            (0.0, "0"),
        ] {
            assert_eq!(shown(value), text, "{value}");
        }
    }
}
