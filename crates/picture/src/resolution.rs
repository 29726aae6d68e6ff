//! The resolution line, and the eight orientations in which a file may store its pixels.

use crate::error::shown;
use crate::{Image, PictureError};
use radsight_units::number;
use std::borrow::Cow;

/// The order of the pixels in a file. Left, right, top and bottom are those of the displayed
/// picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Orientation {
    /// Whether each scanline is a row (standard) or a column.
    pub scanlines_are_rows: bool,
    /// Whether x decreases (the first pixel is at the right).
    pub x_falls: bool,
    /// Whether y decreases (the first pixel is at the top, standard).
    pub y_falls: bool,
}

impl Orientation {
    /// The standard orientation, `-Y … +X …`: rows from the top, each from the left.
    pub const STANDARD: Orientation = Orientation { scanlines_are_rows: true, x_falls: false, y_falls: true };
}

/// The size of a picture and the order of its pixels in the file: a line such as `-Y 480 +X 640`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Resolution {
    /// Pixels from left to right, at least 1.
    pub width: usize,
    /// Pixels from bottom to top, at least 1.
    pub height: usize,
    /// The order in the file.
    pub orientation: Orientation,
}

/// Longest resolution line including padding, bytes.
const LONGEST_LINE: usize = 256;

impl Resolution {
    /// A resolution in standard orientation.
    #[must_use]
    pub fn standard(width: usize, height: usize) -> Self {
        Resolution { width, height, orientation: Orientation::STANDARD }
    }

    /// Reads the line at `offset`; also returns the offset after it.
    ///
    /// # Errors
    /// [`PictureError::Unexpected`] if it is not a resolution line.
    pub fn read(bytes: &[u8], offset: usize) -> Result<(Resolution, usize), PictureError> {
        let rest = bytes.get(offset..).unwrap_or(&[]);
        let line = &rest[..rest.len().min(LONGEST_LINE)];
        let end = line.iter().position(|byte| *byte == b'\n');
        match end.and_then(|end| Some((Resolution::parse(&line[..end])?, offset + end + 1))) {
            Some(found) => Ok(found),
            None => {
                let expected = "a resolution such as -Y 480 +X 640".into();
                Err(PictureError::Unexpected { offset, expected, found: shown(&line[..end.unwrap_or(line.len())]) })
            }
        }
    }

    /// Parses a line; the first axis is the one that changes from scanline to scanline.
    fn parse(line: &[u8]) -> Option<Resolution> {
        let axis = |name: u8| {
            let at = line.iter().rposition(|byte| *byte == name)?;
            let falls = at > 0 && line[at - 1] == b'-';
            let count = i32::try_from(number::integer_or_zero(&line[at + 1..])).ok()?;
            (count > 0).then_some((at, falls, usize::try_from(count).ok()?))
        };
        let ((x_at, x_falls, width), (y_at, y_falls, height)) = (axis(b'X')?, axis(b'Y')?);
        Some(Resolution {
            width,
            height,
            orientation: Orientation { scanlines_are_rows: x_at > y_at, x_falls, y_falls },
        })
    }

    /// Pixels per scanline.
    #[must_use]
    pub fn scanline_length(&self) -> usize {
        if self.orientation.scanlines_are_rows { self.width } else { self.height }
    }

    /// Number of scanlines.
    #[must_use]
    pub fn scanlines(&self) -> usize {
        if self.orientation.scanlines_are_rows { self.height } else { self.width }
    }

    /// The position in the view of a pixel's centre: x from 0 at the left to 1 at the right, y from
    /// 0 at the bottom to 1 at the top. The pixel is given in file order.
    #[must_use]
    pub fn location(&self, position: usize, scanline: usize) -> [f64; 2] {
        let (column, row) = self.column_and_row(position, scanline);
        let from_bottom = self.height - 1 - row;
        [(column as f64 + 0.5) / self.width as f64, (from_bottom as f64 + 0.5) / self.height as f64]
    }

    /// The column from the left and the row from the top of a pixel given in file order.
    fn column_and_row(&self, position: usize, scanline: usize) -> (usize, usize) {
        let Orientation { scanlines_are_rows, x_falls, y_falls } = self.orientation;
        let (x, y) = if scanlines_are_rows { (position, scanline) } else { (scanline, position) };
        let column = if x_falls { self.width - 1 - x } else { x };
        let row = if y_falls { y } else { self.height - 1 - y };
        (column, row)
    }

    /// Converts pixels in file order to an image.
    ///
    /// # Errors
    /// [`PictureError::Shape`] if the number of values is wrong.
    pub fn upright<T: Copy>(&self, components: usize, stored: Vec<T>) -> Result<Image<T>, PictureError> {
        let stored = Image::new(self.scanline_length(), self.scanlines(), components, stored)?;
        if self.orientation == Orientation::STANDARD {
            return Ok(stored);
        }
        let mut upright = Image::filled(self.width, self.height, components, stored.data()[0])?;
        for (scanline, pixels) in stored.rows().enumerate() {
            for (position, pixel) in pixels.chunks_exact(components).enumerate() {
                let (column, row) = self.column_and_row(position, scanline);
                upright.pixel_mut(column, row).copy_from_slice(pixel);
            }
        }
        Ok(upright)
    }

    /// The pixels of an image of this size in file order.
    ///
    /// # Panics
    /// If the image has another size.
    #[must_use]
    pub fn stored<'a, T: Copy>(&self, image: &'a Image<T>) -> Cow<'a, [T]> {
        assert_eq!((self.width, self.height), (image.width(), image.height()), "the resolution is that of the image");
        if self.orientation == Orientation::STANDARD {
            return Cow::Borrowed(image.data());
        }
        let mut stored = Vec::with_capacity(image.data().len());
        for scanline in 0..self.scanlines() {
            for position in 0..self.scanline_length() {
                let (column, row) = self.column_and_row(position, scanline);
                stored.extend_from_slice(image.pixel(column, row));
            }
        }
        Cow::Owned(stored)
    }
}

/// The line as Radiance writes it, without its line end.
impl std::fmt::Display for Resolution {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Orientation { scanlines_are_rows, x_falls, y_falls } = self.orientation;
        let sign = |falls| if falls { '-' } else { '+' };
        if scanlines_are_rows {
            write!(f, "{}Y {:8} {}X {:8}", sign(y_falls), self.height, sign(x_falls), self.width)
        } else {
            write!(f, "{}X {:8} {}Y {:8}", sign(x_falls), self.width, sign(y_falls), self.height)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn orientations() -> impl Iterator<Item = Orientation> {
        (0..8).map(|bits| Orientation {
            scanlines_are_rows: bits & 4 != 0,
            x_falls: bits & 1 != 0,
            y_falls: bits & 2 != 0,
        })
    }

    #[test]
    fn all_eight_orientations_survive_a_round_trip() {
        let image = Image::new(3, 2, 2, (0..12).collect()).unwrap();
        for orientation in orientations() {
            let resolution = Resolution { width: 3, height: 2, orientation };
            let line = format!("{resolution}\n");
            assert_eq!(Resolution::read(line.as_bytes(), 0).unwrap(), (resolution, line.len()));
            assert_eq!(resolution.upright(2, resolution.stored(&image).into_owned()).unwrap(), image);
        }
    }

    #[test]
    fn a_column_from_the_bottom_right_is_turned() {
        // Two columns, the right one first, each from the bottom.
        let (resolution, _) = Resolution::read(b"-X 2 +Y 3\n", 0).unwrap();
        let image = resolution.upright(1, vec![1, 2, 3, 4, 5, 6]).unwrap();
        assert_eq!(image.data(), [6, 3, 5, 2, 4, 1]);
        assert_eq!(resolution.location(0, 0), [0.75, 0.5 / 3.0]);
    }

    #[test]
    fn padded_and_bad_lines() {
        let padded = Resolution::read(b"xx-Y      512 +X      300     \nz", 2).unwrap();
        assert_eq!(padded, (Resolution::standard(300, 512), 31));
        for bad in ["", "\n", "-Y 5\n", "-Y 0 +X 5\n", "-Y 5 +X -5\n", "-Y 5 +X 5", "-Y 99999999999 +X 5\n"] {
            assert!(Resolution::read(bad.as_bytes(), 0).is_err(), "{bad:?}");
        }
    }
}
