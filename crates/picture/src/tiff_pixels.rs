//! The content of a TIFF file.

use crate::{Header, PictureError, Resolution, RgbPrimaries};

/// The pixels as stored.
#[derive(Clone, Debug, PartialEq)]
pub enum TiffPixels {
    /// 8 bits.
    Bytes(Vec<u8>),
    /// 16 bits.
    Words(Vec<u16>),
    /// Single precision; all other number types are converted to this.
    Floats(Vec<f32>),
}

impl TiffPixels {
    /// Number of values.
    pub(crate) fn len(&self) -> usize {
        match self {
            TiffPixels::Bytes(values) => values.len(),
            TiffPixels::Words(values) => values.len(),
            TiffPixels::Floats(values) => values.len(),
        }
    }
}

/// The meaning of three values of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TiffColors {
    /// Red, green and blue of the primaries in the tags. Fewer components are grey.
    Rgb,
    /// CIE tristimulus values, stored as LogLuv.
    Xyz,
}

/// The tags of a TIFF file that correspond to lines of a Radiance header.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TiffTags {
    /// Luminance of a pixel of value 1, cd/m² (`STONITS`); positive.
    pub nits: Option<f64>,
    /// Height of a pixel of the displayed picture relative to its width, as in `PIXASPECT`;
    /// positive.
    pub pixel_aspect: Option<f64>,
    /// The primaries of RGB values.
    pub primaries: Option<RgbPrimaries>,
    /// Date and time of the picture: `2026:11:21 11:14:09`.
    pub date: Option<String>,
    /// The owner of the picture (`Artist`).
    pub owner: Option<String>,
}

impl TiffTags {
    /// The tags that describe the picture of a header, without the scale of its values.
    ///
    /// # Errors
    /// When PIXASPECT or PRIMARIES in the header is invalid.
    pub fn from_header(header: &Header) -> Result<TiffTags, PictureError> {
        let text = |name| header.variable(name).map(|value| value.trim().to_owned()).filter(|value| !value.is_empty());
        Ok(TiffTags {
            nits: None,
            pixel_aspect: Some(header.pixel_aspect()?),
            primaries: header.primaries()?,
            date: text("CAPDATE"),
            owner: text("OWNER"),
        })
    }
}

/// The content of a TIFF file.
#[derive(Clone, Debug, PartialEq)]
pub struct Tiff {
    /// The size, and the order of the pixels in the file.
    pub resolution: Resolution,
    /// Values per pixel, 1, 3 or 4.
    pub components: usize,
    /// The values in file order.
    pub pixels: TiffPixels,
    /// The meaning of the values.
    pub colors: TiffColors,
    /// The tags.
    pub tags: TiffTags,
    /// The Radiance header, if the file has one.
    pub header: Option<Header>,
}

impl Tiff {
    /// The error of a picture with pixels that the format cannot hold.
    pub(crate) fn bad_shape(&self, expected: &'static str) -> PictureError {
        let (Resolution { width, height, .. }, components) = (self.resolution, self.components);
        PictureError::Shape { width, height, components, values: self.pixels.len(), expected }
    }
}
