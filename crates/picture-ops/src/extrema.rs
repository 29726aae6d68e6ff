//! `pextrem`: the darkest and the brightest pixel.

use crate::ToolError;
use crate::brightness::{Brightness, WEIGHTS};
use radsight_picture::{Encoding, PictureReader, decode_rgbe, mantissa_step, mean_of_spectrum};
use std::io::Read;

/// A pixel and its position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremum {
    /// Index in its scanline, from 0.
    pub position: usize,
    /// Index of its scanline, counted from the last one.
    pub scanline: usize,
    /// Raw values; for a spectrum the mean in its red, green and blue ranges.
    pub color: [f32; 3],
}

/// The initial minimum is the brightest possible pixel below this.
const BRIGHTEST: [u8; 4] = [201, 201, 201, 228];

/// Finds the darkest and the brightest pixel. Among equal ones, the last pixel of the first
/// scanline is returned.
///
/// # Errors
/// When the picture cannot be read.
pub fn extrema<R: Read>(mut reader: PictureReader<R>) -> Result<[Extremum; 2], ToolError> {
    let (encoding, components) = (reader.encoding(), reader.components());
    let bands = Brightness::new(encoding, components).bands();
    let weights = WEIGHTS.map(|weight| (weight * 256.0 + 0.5) as u32);
    // Compare exponents, then the integer brightness of the mantissas.
    let key = |pixel: &[u8]| {
        let sum: u32 = bands.iter().zip(weights).map(|(band, weight)| u32::from(pixel[*band]) * weight).sum();
        (pixel[components], sum >> 8)
    };
    let start = |color| Extremum { position: 0, scanline: 0, color };
    let mut found = [start(decode_rgbe(BRIGHTEST)), start([0.0; 3])];
    let mut keys = [(BRIGHTEST[3], (weights.iter().sum::<u32>() * u32::from(BRIGHTEST[0])) >> 8), (0, 0)];
    for scanline in (0..reader.resolution().scanlines()).rev() {
        let stored = reader.read_stored()?;
        for (position, pixel) in stored.chunks_exact(components + 1).enumerate().rev() {
            let key = key(pixel);
            if key < keys[0] {
                (keys[0], found[0]) = (key, Extremum { position, scanline, color: color(pixel, encoding) });
            }
            if key > keys[1] {
                (keys[1], found[1]) = (key, Extremum { position, scanline, color: color(pixel, encoding) });
            }
        }
    }
    Ok(found)
}

fn color(pixel: &[u8], encoding: Encoding) -> [f32; 3] {
    match (encoding, pixel) {
        (Encoding::Spectral { splits }, [mantissas @ .., exponent]) if mantissas.len() > 3 => {
            let step = mantissa_step(*exponent);
            let values: Vec<f32> = mantissas.iter().map(|mantissa| (f32::from(*mantissa) + 0.5) * step).collect();
            mean_of_spectrum(&values, splits)
        }
        (_, [red, green, blue, exponent]) => decode_rgbe([*red, *green, *blue, *exponent]),
        _ => [0.0; 3],
    }
}
