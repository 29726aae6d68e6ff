//! The first pass: measures the mean brightness and finds hot pixels.

use super::stars::{HotPixel, Slopes};
use super::{FilterOptions, HotPixels};
use crate::ToolError;
use crate::brightness::Brightness;
use radsight_picture::{Encoding, PictureReader, mean_of_spectrum};
use std::io::Read;

/// The mean brightness of the output of two passes.
const TARGET: f64 = 0.5;

/// The results of the first pass.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Mean brightness of the included pixels.
    average: f64,
    /// The threshold of hot pixels, as stored.
    pub(super) hot_level: f64,
    /// The hot pixels; empty if no stars are requested.
    pub(super) hot: Vec<HotPixel>,
    /// Number of complete scanlines.
    pub(super) rows: usize,
    /// Declared number of scanlines.
    expected: usize,
}

impl Measured {
    /// Defaults for a single pass.
    pub(super) fn nothing<R: Read>(reader: &PictureReader<R>) -> Measured {
        let rows = reader.resolution().scanlines();
        Measured { average: TARGET, hot_level: f64::INFINITY, hot: Vec::new(), rows, expected: rows }
    }

    /// The total factor of each component.
    pub(super) fn exposure(&self, options: &FilterOptions) -> [f32; 3] {
        options.exposure.map(|part| (f64::from(part) * (TARGET / self.average)) as f32)
    }

    /// The available part of an incomplete picture, per cent.
    #[must_use]
    pub fn partial(&self) -> Option<usize> {
        (self.rows < self.expected).then(|| 100 * self.rows / self.expected)
    }
}

/// The first of two passes. An incomplete picture is measured as far as it goes.
///
/// # Errors
/// When the picture cannot be read at all, or has no brightness.
pub fn measure<R: Read>(mut reader: PictureReader<R>, options: &FilterOptions) -> Result<Measured, ToolError> {
    let (encoding, components) = (reader.encoding(), reader.components());
    let brightness = Brightness::new(encoding, components);
    let hot_level = options.hot_level * reader.header().exposure()?;
    let expected = reader.resolution().scanlines();
    let mut measured = Measured { average: 0.0, hot_level, hot: Vec::new(), rows: 0, expected };
    let mut slopes = Slopes::new(options.star_lines);
    let mut scanline = vec![0.0; reader.resolution().scanline_length() * components];
    let mut count = 0u64;
    while measured.rows < expected && reader.read_values(&mut scanline).is_ok() {
        for (column, pixel) in scanline.chunks_exact(components).enumerate() {
            let value = brightness.of(pixel);
            if value <= 0.0 {
                continue;
            }
            if options.hot_pixels == HotPixels::Averaged || value < hot_level {
                measured.average += value;
                count += 1;
            }
            if options.star_lines > 0 && value >= hot_level {
                let color = three(pixel, encoding);
                measured.hot.push(HotPixel { color, column, row: measured.rows, slope: slopes.next() });
            }
        }
        measured.rows += 1;
    }
    if measured.rows == 0 {
        return Err(ToolError::TooFewScanlines { rows: 0, expected });
    }
    if count == 0 {
        return Err(ToolError::NoAverage { hot: hot_level });
    }
    measured.average /= count as f64;
    Ok(measured)
}

fn three(pixel: &[f32], encoding: Encoding) -> [f32; 3] {
    match encoding {
        Encoding::Spectral { splits } if pixel.len() > 3 => mean_of_spectrum(pixel, splits),
        _ => [pixel[0], pixel[1], pixel[2]],
    }
}
