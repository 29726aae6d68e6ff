//! Pictures whose rendering was interrupted.

use crate::picture::Encoding;
use crate::resolution::Resolution;
use crate::{Header, PictureError, scanline};

/// The complete scanlines, as stored, of an unfinished picture with three components.
///
/// ```
/// use radsight_picture::{Header, Image, Picture, Unfinished};
/// let image = Image::filled(9, 4, 3, 0.5f32).unwrap();
/// let bytes = Picture::from_rgb(Header::new("RADIANCE"), &image).unwrap().to_bytes();
/// let unfinished = Unfinished::read(&bytes[..bytes.len() - 1]).unwrap();
/// assert_eq!(unfinished.scanlines, 3);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Unfinished<'b> {
    /// All lines of the header.
    pub header: Header,
    /// The size of the complete picture.
    pub resolution: Resolution,
    /// The encoding of its values.
    pub encoding: Encoding,
    /// Number of complete scanlines.
    pub scanlines: usize,
    /// The bytes of those scanlines.
    pub pixels: &'b [u8],
}

/// Largest ratio of decoded to encoded bytes of a scanline.
const LARGEST_RATIO: usize = 64;

impl<'b> Unfinished<'b> {
    /// Reads an unfinished picture, which must have at least a header and a resolution.
    ///
    /// # Errors
    /// When the header or the resolution is wrong, or the picture is spectral.
    pub fn read(bytes: &'b [u8]) -> Result<Unfinished<'b>, PictureError> {
        let (header, start) = Header::read(bytes)?;
        let encoding = Encoding::from_header(&header)?;
        if !matches!(encoding, Encoding::Rgbe | Encoding::Xyze) {
            let expected = "a picture of three components".into();
            return Err(PictureError::Unexpected { offset: 0, expected, found: encoding.name().into() });
        }
        let (resolution, start) = Resolution::read(bytes, start)?;
        let length = resolution.scanline_length();
        let (mut at, mut scanlines) = (start, 0);
        if length / LARGEST_RATIO <= bytes.len() - start {
            let (mut row, mut planes) = (vec![0; length * scanline::PIXEL], Vec::new());
            while scanlines < resolution.scanlines() {
                let Ok(next) = scanline::read(bytes, at, &mut row, &mut planes) else { break };
                (at, scanlines) = (next, scanlines + 1);
            }
        }
        Ok(Unfinished { header, resolution, encoding, scanlines, pixels: &bytes[start..at] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Image, Picture};

    fn picture() -> Vec<u8> {
        let data = (0..10 * 3 * 3).map(|i| i as f32).collect();
        Picture::from_rgb(Header::new("RADIANCE"), &Image::new(10, 3, 3, data).unwrap()).unwrap().to_bytes()
    }

    #[test]
    fn any_part_of_a_picture_gives_its_whole_scanlines() {
        let whole = picture();
        let all = Unfinished::read(&whole).unwrap();
        assert_eq!(all.scanlines, 3);
        let start = whole.len() - all.pixels.len();
        let mut seen = [0; 4];
        for end in start..=whole.len() {
            let part = Unfinished::read(&whole[..end]).unwrap();
            assert_eq!(part.pixels, &all.pixels[..part.pixels.len()]);
            seen[part.scanlines] += 1;
        }
        assert!(seen[..3].iter().all(|count| *count > 10) && seen[3] == 1, "{seen:?}");
    }

    #[test]
    fn a_size_that_cannot_be_takes_no_memory() {
        let bytes = b"#?RADIANCE\n\n-Y 2000000000 +X 2000000000\n\x02\x02";
        assert_eq!(Unfinished::read(bytes).unwrap().scanlines, 0);
    }
}
