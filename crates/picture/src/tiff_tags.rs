//! The tags of a TIFF file that describe the picture, and the order of its pixels.

use crate::tiff_pixels::TiffTags;
use crate::{Header, Orientation, Resolution, RgbPrimaries};

/// Codes of tags, the same in each kind of TIFF.
pub(crate) const DESCRIPTION: u16 = 270;
const ORIENTATION: u16 = 274;
const X_RESOLUTION: u16 = 282;
const Y_RESOLUTION: u16 = 283;
const RESOLUTION_UNIT: u16 = 296;
const DATE: u16 = 306;
const ARTIST: u16 = 315;
const WHITE_POINT: u16 = 318;
const PRIMARIES: u16 = 319;
/// Factor from a pixel's values to cd/m², of the software Pixar and SGI used.
const NITS: u16 = 37_439;

/// The resolution that Radiance writes, dots per inch, and the code of the unit.
const DOTS: f64 = 72.0;
const INCHES: u16 = 2;

/// Number of characters of a date.
const LONGEST_DATE: usize = 19;

/// The orientations of the codes 1 to 8: whether scanlines are rows, x falls and y falls.
const ORIENTATIONS: [[bool; 3]; 8] = [
    [true, false, true],
    [true, true, true],
    [true, true, false],
    [true, false, false],
    [false, false, true],
    [false, true, true],
    [false, true, false],
    [false, false, false],
];

/// The value of a tag.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum TagValue {
    /// Characters without the zero byte at their end.
    Text(String),
    /// A number of 16 bits.
    Short(u16),
    /// Fractions.
    Rationals(Vec<[u32; 2]>),
    /// Single precision.
    Floats(Vec<f32>),
    /// Double precision.
    Double(f64),
}

/// What a tag holds when it is read.
pub(crate) enum FoundTag {
    /// Characters.
    Text(String),
    /// Numbers of any type.
    Numbers(Vec<f64>),
}

impl TiffTags {
    /// The values of all tags, by their codes.
    pub(crate) fn values(&self, resolution: &Resolution) -> Vec<(u16, TagValue)> {
        let orientation = resolution.orientation;
        let code = ORIENTATIONS.iter().position(|found| oriented(*found) == orientation).unwrap_or(0) as u16 + 1;
        let rows = orientation.scanlines_are_rows;
        let aspect = self.pixel_aspect.unwrap_or(1.0);
        let across = if rows { DOTS / aspect } else { DOTS * aspect };
        let mut values = vec![
            (ORIENTATION, TagValue::Short(code)),
            (X_RESOLUTION, TagValue::Rationals(vec![rational(DOTS)])),
            (Y_RESOLUTION, TagValue::Rationals(vec![rational(across)])),
            (RESOLUTION_UNIT, TagValue::Short(INCHES)),
        ];
        if let Some(RgbPrimaries { red, green, blue, white }) = self.primaries {
            values.push((PRIMARIES, chromaticities(&[red, green, blue].concat())));
            values.push((WHITE_POINT, chromaticities(&white)));
        }
        values.extend(self.nits.map(|nits| (NITS, TagValue::Double(nits))));
        // Shorter text is no date.
        let date = self.date.as_deref().filter(|date| date.is_ascii()).and_then(|date| date.get(..LONGEST_DATE));
        values.extend(date.map(|date| (DATE, TagValue::Text(date.to_owned()))));
        values.extend(self.owner.as_deref().map(|owner| (ARTIST, TagValue::Text(ascii(owner)))));
        values
    }

    /// The tags of a file, from a function that finds a tag by its code.
    pub(crate) fn find(resolution: &Resolution, mut tag: impl FnMut(u16) -> Option<FoundTag>) -> TiffTags {
        let mut numbers = |code| match tag(code) {
            Some(FoundTag::Numbers(numbers)) => numbers,
            _ => Vec::new(),
        };
        let positive = |number: f64| (number.is_finite() && number > 0.0).then_some(number);
        let mut one = |code| numbers(code).first().copied().and_then(positive);
        let nits = one(NITS);
        let ratio = one(X_RESOLUTION).zip(one(Y_RESOLUTION)).map(|(along, across)| along / across);
        let pixel_aspect = ratio.and_then(positive);
        let white = numbers(WHITE_POINT);
        let primaries = primaries_of(&numbers(PRIMARIES), &white);
        let mut text = |code| match tag(code) {
            Some(FoundTag::Text(text)) => Some(text.trim().to_owned()).filter(|text| !text.is_empty()),
            _ => None,
        };
        TiffTags {
            nits,
            pixel_aspect: match resolution.orientation.scanlines_are_rows {
                true => pixel_aspect,
                false => pixel_aspect.map(f64::recip),
            },
            primaries,
            date: text(DATE).map(|date| date.chars().take(LONGEST_DATE).collect()),
            owner: text(ARTIST),
        }
    }
}

/// The Radiance header in the description of a file.
pub(crate) fn header(mut tag: impl FnMut(u16) -> Option<FoundTag>) -> Option<Header> {
    match tag(DESCRIPTION) {
        Some(FoundTag::Text(text)) if text.starts_with("#?") => Some(Header::read_text(text.as_bytes())),
        _ => None,
    }
}

/// The resolution of a file with this many pixels a row and rows. An unknown orientation is the
/// standard one, as in Radiance.
pub(crate) fn resolution(length: usize, rows: usize, mut tag: impl FnMut(u16) -> Option<FoundTag>) -> Resolution {
    let code = match tag(ORIENTATION) {
        Some(FoundTag::Numbers(numbers)) => numbers.first().copied().unwrap_or(1.0),
        _ => 1.0,
    };
    let orientation = oriented(*ORIENTATIONS.get((code as usize).wrapping_sub(1)).unwrap_or(&ORIENTATIONS[0]));
    let (width, height) = if orientation.scanlines_are_rows { (length, rows) } else { (rows, length) };
    Resolution { width, height, orientation }
}

fn oriented([scanlines_are_rows, x_falls, y_falls]: [bool; 3]) -> Orientation {
    Orientation { scanlines_are_rows, x_falls, y_falls }
}

/// The white is that of equal energy if the file names none.
fn primaries_of(colors: &[f64], white: &[f64]) -> Option<RgbPrimaries> {
    let [rx, ry, gx, gy, bx, by] = *colors else { return None };
    let [wx, wy] = *white else { return primaries_of(colors, &[1.0 / 3.0; 2]) };
    Some(RgbPrimaries::from_array([rx, ry, gx, gy, bx, by, wx, wy]))
}

/// Fractions have no sign. Some primaries of wide gamuts are imaginary and have negative numbers.
fn chromaticities(numbers: &[f64]) -> TagValue {
    match numbers.iter().all(|number| *number >= 0.0) {
        true => TagValue::Rationals(numbers.iter().copied().map(rational).collect()),
        false => TagValue::Floats(numbers.iter().map(|number| *number as f32).collect()),
    }
}

/// A fraction for a number that is not negative.
fn rational(number: f64) -> [u32; 2] {
    const MOST_DIGITS: i32 = 9;
    // As many decimal places as fit.
    let digits = (0..=MOST_DIGITS).rev().find(|digits| number * 10f64.powi(*digits) <= f64::from(u32::MAX));
    let scale = 10f64.powi(digits.unwrap_or(0));
    let (above, below) = ((number * scale).round() as u32, scale as u32);
    let (mut divisor, mut rest) = (below, above);
    while rest != 0 {
        (divisor, rest) = (rest, divisor % rest);
    }
    [above / divisor, below / divisor]
}

/// Text of a tag is ASCII and ends at a zero byte.
pub(crate) fn ascii(text: &str) -> String {
    text.chars().map(|c| if c.is_ascii() && c != '\0' { c } else { '?' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_keep_nine_digits() {
        assert_eq!(rational(0.3127), [3127, 10_000]);
        assert_eq!(rational(1.0 / 3.0), [333_333_333, 1_000_000_000]);
        assert_eq!(rational(72.0), [72, 1]);
        assert_eq!(rational(0.0), [0, 1]);
        assert_eq!(rational(1e20), [u32::MAX, 1]);
    }
}
