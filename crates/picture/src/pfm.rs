//! Portable float maps (`.pfm`), the format of lossless exposures.
//!
//! `PF` (three components) or `Pf` (one), width and height, and a scale. The sign of the scale
//! gives the byte order (negative: little-endian), and its magnitude multiplies the values.
//! Single-precision values follow, bottom row first.

use crate::error::shown;
use crate::{Image, PictureError};
use radsight_units::number::{integer_or_zero, is_space, leading_number};

/// Reads a float map; its first row in memory is the top.
///
/// # Errors
/// When the bytes are not a float map, or end too early.
///
/// ```
/// let image = radsight_picture::Image::new(1, 2, 1, vec![1.5f32, -2.0]).unwrap();
/// let bytes = radsight_picture::write_pfm(&image).unwrap();
/// assert_eq!(bytes, b"Pf\n1 2\n-1.0\n\0\0\0\xc0\0\0\xc0\x3f");
/// assert_eq!(radsight_picture::read_pfm(&bytes).unwrap(), image);
/// ```
pub fn read_pfm(bytes: &[u8]) -> Result<Image<f32>, PictureError> {
    let mut words = Words { bytes, at: 0 };
    let components = match words.next("\"PF\" or \"Pf\"")? {
        (_, b"PF") => 3,
        (_, b"Pf") => 1,
        (offset, other) => {
            let expected = "\"PF\" or \"Pf\"".into();
            return Err(PictureError::Unexpected { offset, expected, found: shown(other) });
        }
    };
    let (width, height) = (words.size("the width in pixels")?, words.size("the height in pixels")?);
    let (offset, word) = words.next("the scale")?;
    let (scale, used) = leading_number(word);
    if used != word.len() || !scale.is_finite() || scale == 0.0 {
        let expected = "a scale that is not zero".into();
        return Err(PictureError::Unexpected { offset, expected, found: shown(word) });
    }
    // Exactly one byte of white space separates the scale from the values.
    let start = words.at + 1;
    let values = binary_values(bytes, start, (width, height, components), 4)?;
    let scale_magnitude = scale.abs() as f32;
    let decode: fn([u8; 4]) -> f32 = if scale < 0.0 { f32::from_le_bytes } else { f32::from_be_bytes };
    let data = values.as_chunks::<4>().0.iter().map(|value| decode(*value));
    let data =
        if scale_magnitude == 1.0 { data.collect() } else { data.map(|value| value * scale_magnitude).collect() };
    let mut image = Image::new(width, height, components, data)?;
    image.flip_vertically();
    Ok(image)
}

/// Writes a little-endian float map.
///
/// # Errors
/// [`PictureError::Shape`] unless there are one or three components.
pub fn write_pfm(image: &Image<f32>) -> Result<Vec<u8>, PictureError> {
    let kind = match image.components() {
        1 => "Pf",
        3 => "PF",
        components => {
            let (width, height, values) = (image.width(), image.height(), image.data().len());
            return Err(PictureError::Shape {
                width,
                height,
                components,
                values,
                expected: "1 or 3 components for pfm",
            });
        }
    };
    let mut out = format!("{kind}\n{} {}\n-1.0\n", image.width(), image.height()).into_bytes();
    out.reserve(image.data().len() * 4);
    for row in image.rows().rev() {
        out.extend(row.iter().flat_map(|value| value.to_le_bytes()));
    }
    Ok(out)
}

/// The bytes of `width * height * components` values from `start`, if there are that many.
pub(crate) fn binary_values(
    bytes: &[u8],
    start: usize,
    (width, height, components): (usize, usize, usize),
    value_size: usize,
) -> Result<&[u8], PictureError> {
    let rest = bytes.get(start..).unwrap_or(&[]);
    let count = width.checked_mul(height).and_then(|pixels| pixels.checked_mul(components));
    match count.and_then(|count| rest.get(..count.checked_mul(value_size)?)) {
        Some(values) => Ok(values),
        None => Err(PictureError::TooLarge {
            offset: start.min(bytes.len()),
            width: width as u64,
            height: height as u64,
            components: components as u64,
            available: rest.len(),
        }),
    }
}

struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Words<'a> {
    fn next(&mut self, expected: &'static str) -> Result<(usize, &'a [u8]), PictureError> {
        const LONGEST: usize = 64;
        let rest = &self.bytes[self.at..];
        let space = rest.iter().take(LONGEST).take_while(|byte| is_space(**byte)).count();
        let word = rest[space..].iter().take(LONGEST).take_while(|byte| !is_space(**byte)).count();
        let start = self.at + space;
        self.at = start + word;
        if word == 0 {
            return Err(PictureError::Truncated { offset: start, expected: expected.into() });
        }
        Ok((start, &self.bytes[start..self.at]))
    }

    fn size(&mut self, expected: &'static str) -> Result<usize, PictureError> {
        let (offset, word) = self.next(expected)?;
        let size = i32::try_from(integer_or_zero(word)).ok().and_then(|size| usize::try_from(size).ok());
        match size.filter(|size| *size > 0 && word.iter().all(u8::is_ascii_digit)) {
            Some(size) => Ok(size),
            None => Err(PictureError::Unexpected { offset, expected: expected.into(), found: shown(word) }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn big_endian_and_scale_are_honoured() {
        let image = read_pfm(b"PF 1 1\n2\n\x3f\x80\0\0\x40\0\0\0\0\0\0\0").unwrap();
        assert_eq!(image.data(), [2.0, 4.0, 0.0]);
    }

    #[test]
    fn a_declared_size_beyond_the_bytes_fails_at_once() {
        let error = read_pfm(b"Pf\n1000000000 1000000000\n-1\nabcd").unwrap_err();
        assert_eq!(
            error.to_string(),
            "byte 28: 1000000000 x 1000000000 pixels of 1 components are declared, which 4 bytes cannot hold"
        );
        for bad in [&b""[..], b"P5 1 1 255 a", b"Pf\n-1 1\n-1\n", b"Pf\n1 1\n0\nabcd", b"Pf 1 1 x\nabcd", b"Pf 1 1 -1"]
        {
            assert!(read_pfm(bad).is_err());
        }
    }
}
