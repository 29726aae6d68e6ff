//! The encoding of a picture's scanlines.

use radsight_picture::{PictureError, PictureWriter};
use std::io::Write;

/// Whether scanlines are run-length encoded.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Packing {
    Flat,
    RunLengths,
}

impl Packing {
    /// Writes a scanline of stored pixels.
    pub(super) fn write(self, writer: &mut PictureWriter<impl Write>, stored: &[u8]) -> Result<(), PictureError> {
        match self {
            Packing::Flat => writer.write_flat(stored),
            Packing::RunLengths => writer.write_stored(stored),
        }
    }
}
