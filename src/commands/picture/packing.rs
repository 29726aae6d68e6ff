//! How the scanlines of a picture are written.

use radsight_picture::{PictureError, PictureWriter};
use std::io::Write;

/// Whether repeated bytes are counted.
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
