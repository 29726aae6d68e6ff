//! The first pass: how bright the picture is, and where it shines.

use super::{FilterOptions, HotPixels, stars};
use crate::ToolError;
use crate::brightness::Brightness;
use radsight_picture::{Encoding, PictureReader, mean_of_spectrum};
use std::io::Read;

/// The mean brightness that two passes give.
const TARGET: f64 = 0.5;

/// What the first pass found.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Mean brightness of the pixels that count.
    average: f64,
    /// The brightness, as stored, from which a pixel shines.
    pub(super) hot_level: f64,
    /// The pixels that shine; empty where no stars are wanted.
    pub(super) hot: Vec<HotPixel>,
    /// Complete scanlines.
    pub(super) rows: usize,
    /// Scanlines that there should be.
    expected: usize,
}

/// A pixel that shines.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct HotPixel {
    pub(super) color: [f32; 3],
    pub(super) column: usize,
    pub(super) row: usize,
    /// The direction of its star's line, rows a column.
    pub(super) slope: f64,
}

impl Measured {
    /// What a single pass goes by.
    pub(super) fn nothing<R: Read>(reader: &PictureReader<R>) -> Measured {
        let rows = reader.resolution().scanlines();
        Measured { average: TARGET, hot_level: f64::INFINITY, hot: Vec::new(), rows, expected: rows }
    }

    /// What each component is multiplied by in all.
    pub(super) fn exposure(&self, options: &FilterOptions) -> [f32; 3] {
        options.exposure.map(|part| (f64::from(part) * (TARGET / self.average)) as f32)
    }

    /// How much of the picture there is, in per cent, if some is missing.
    #[must_use]
    pub fn partial(&self) -> Option<usize> {
        (self.rows < self.expected).then(|| 100 * self.rows / self.expected)
    }
}

/// The first of two passes. A picture that ends too early is measured as far as it goes.
///
/// # Errors
/// When the picture cannot be read at all, or has no brightness.
pub fn measure<R: Read>(mut reader: PictureReader<R>, options: &FilterOptions) -> Result<Measured, ToolError> {
    let (encoding, components) = (reader.encoding(), reader.components());
    let brightness = Brightness::new(encoding, components);
    let hot_level = options.hot_level * reader.header().exposure()?;
    let expected = reader.resolution().scanlines();
    let mut measured = Measured { average: 0.0, hot_level, hot: Vec::new(), rows: 0, expected };
    let mut slopes = stars::Slopes::new(options.star_lines);
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
        return Err(ToolError::EmptyFrame { rows: 0, expected });
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
