//! `pflip` and `protate`: reorder pixels.

use crate::ToolError;
use radsight_picture::{Header, Orientation, PictureReader, PictureWriter, Resolution};
use std::io::{Read, Write};

/// The reordering.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// Mirrored.
    Flip {
        /// Each scanline is reversed.
        horizontally: bool,
        /// The order of the scanlines is reversed.
        vertically: bool,
    },
    /// By a quarter turn clockwise.
    Clockwise,
    /// By a quarter turn counterclockwise.
    Counterclockwise,
}

/// The orientation in the output's resolution line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrderRecord {
    /// The new order, so that the displayed picture is unchanged.
    Kept,
    /// The order of the input, so that the displayed picture is turned.
    Corrected,
}

/// Turns a picture. All but a horizontal flip hold the whole picture in memory.
///
/// # Errors
/// When the picture cannot be read, or the output cannot be written.
pub fn turn<R: Read, W: Write>(
    mut reader: PictureReader<R>,
    turn: Turn,
    record: OrderRecord,
    header: &Header,
    target: W,
) -> Result<(), ToolError> {
    let resolution = turned(reader.resolution(), turn, record);
    let (length, size) = (reader.resolution().scanline_length(), reader.components() + 1);
    let mut writer = PictureWriter::new(target, header, reader.components(), resolution)?;
    if let Turn::Flip { horizontally, vertically: false } = turn {
        while reader.scanlines_left() > 0 {
            let mut scanline = reader.read_stored()?.to_vec();
            if horizontally {
                reverse(&mut scanline, size);
            }
            writer.write_stored(&scanline)?;
        }
        return Ok(writer.finish()?);
    }
    let mut scanlines = Vec::new();
    while reader.scanlines_left() > 0 {
        scanlines.push(reader.read_stored()?.to_vec());
    }
    match turn {
        Turn::Flip { horizontally, .. } => {
            for scanline in scanlines.iter_mut().rev() {
                if horizontally {
                    reverse(scanline, size);
                }
                writer.write_stored(scanline)?;
            }
        }
        Turn::Clockwise => {
            for column in 0..length {
                let pixels = scanlines.iter().rev().flat_map(|scanline| &scanline[column * size..][..size]);
                writer.write_stored(&pixels.copied().collect::<Vec<u8>>())?;
            }
        }
        Turn::Counterclockwise => {
            for column in (0..length).rev() {
                let pixels = scanlines.iter().flat_map(|scanline| &scanline[column * size..][..size]);
                writer.write_stored(&pixels.copied().collect::<Vec<u8>>())?;
            }
        }
    }
    Ok(writer.finish()?)
}

/// Reverses the pixels of a scanline.
fn reverse(scanline: &mut [u8], size: usize) {
    scanline.reverse();
    scanline.chunks_exact_mut(size).for_each(<[u8]>::reverse);
}

fn turned(from: Resolution, turn: Turn, record: OrderRecord) -> Resolution {
    let orientation = match record {
        OrderRecord::Corrected => from.orientation,
        OrderRecord::Kept => new_orientation(from.orientation, turn),
    };
    let (mut length, mut count) = (from.scanline_length(), from.scanlines());
    if !matches!(turn, Turn::Flip { .. }) {
        std::mem::swap(&mut length, &mut count);
    }
    let (width, height) = if orientation.scanlines_are_rows { (length, count) } else { (count, length) };
    Resolution { width, height, orientation }
}

fn new_orientation(from: Orientation, turn: Turn) -> Orientation {
    let Orientation { scanlines_are_rows, x_falls, y_falls } = from;
    match turn {
        Turn::Flip { horizontally, vertically } => {
            let (x, y) = if scanlines_are_rows { (horizontally, vertically) } else { (vertically, horizontally) };
            Orientation { scanlines_are_rows, x_falls: x_falls ^ x, y_falls: y_falls ^ y }
        }
        // The first scanline is the former first column, reversed.
        Turn::Clockwise => {
            let (x, y) = if scanlines_are_rows { (false, true) } else { (true, false) };
            Orientation { scanlines_are_rows: !scanlines_are_rows, x_falls: x_falls ^ x, y_falls: y_falls ^ y }
        }
        Turn::Counterclockwise => {
            let (x, y) = if scanlines_are_rows { (true, false) } else { (false, true) };
            Orientation { scanlines_are_rows: !scanlines_are_rows, x_falls: x_falls ^ x, y_falls: y_falls ^ y }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_quarter_turns_are_none() {
        for bits in 0..8u8 {
            let from =
                Orientation { scanlines_are_rows: bits & 4 != 0, x_falls: bits & 1 != 0, y_falls: bits & 2 != 0 };
            let once = new_orientation(from, Turn::Clockwise);
            let four = (0..3).fold(once, |orientation, _| new_orientation(orientation, Turn::Clockwise));
            assert_eq!(four, from);
            assert_eq!(new_orientation(once, Turn::Counterclockwise), from);
        }
    }
}
