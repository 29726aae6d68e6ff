//! Formats of pictures other than Radiance's, told by their first bytes.

use std::fmt;

/// A format of pictures other than Radiance's. It can be told even where it cannot be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ForeignFormat {
    /// OpenEXR.
    Exr,
    /// TIFF.
    Tiff,
    /// PNG.
    Png,
    /// JPEG.
    Jpeg,
    /// A NumPy array.
    Npy,
    /// A portable float map.
    Pfm,
}

impl ForeignFormat {
    /// Number of first bytes that tell a format.
    pub const LONGEST_SIGNATURE: usize = 6;

    /// The format of a file's first bytes.
    ///
    /// ```
    /// use radsight_picture::ForeignFormat;
    /// assert_eq!(ForeignFormat::from_content(b"\x89PNG\r\n"), Some(ForeignFormat::Png));
    /// assert_eq!(ForeignFormat::from_content(b"#?RADIANCE\n"), None);
    /// ```
    #[must_use]
    pub fn from_content(bytes: &[u8]) -> Option<ForeignFormat> {
        Some(match bytes {
            [0x76, 0x2f, 0x31, 0x01, ..] => ForeignFormat::Exr,
            [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..] => ForeignFormat::Tiff,
            [0x89, b'P', b'N', b'G', ..] => ForeignFormat::Png,
            [0xff, 0xd8, 0xff, ..] => ForeignFormat::Jpeg,
            [0x93, b'N', b'U', b'M', b'P', b'Y', ..] => ForeignFormat::Npy,
            [b'P', b'F' | b'f', b'\n' | b' ' | b'\r' | b'\t', ..] => ForeignFormat::Pfm,
            _ => return None,
        })
    }
}

/// The name with an article.
impl fmt::Display for ForeignFormat {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            ForeignFormat::Exr => "an OpenEXR picture",
            ForeignFormat::Tiff => "a TIFF picture",
            ForeignFormat::Png => "a PNG picture",
            ForeignFormat::Jpeg => "a JPEG picture",
            ForeignFormat::Npy => "a NumPy array",
            ForeignFormat::Pfm => "a portable float map",
        })
    }
}
