//! The content of a TIFF file.

use crate::Header;

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

/// The content of a TIFF file.
#[derive(Clone, Debug, PartialEq)]
pub struct Tiff {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Values per pixel, 1 to 4.
    pub components: usize,
    /// The values, row 0 at the top.
    pub pixels: TiffPixels,
    /// The Radiance header, if the file has one.
    pub header: Option<Header>,
    /// Date and time of the picture: `2026:11:21 11:14:09`. When writing, the date of the header
    /// (`CAPDATE`) is used instead.
    pub date: Option<String>,
}
