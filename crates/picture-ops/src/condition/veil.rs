//! The veiling glare that bright regions cause in the eye.

use super::between;
use super::foveal::Fovea;
use crate::ToolError;
use radsight_picture::Resolution;
use rayon::prelude::*;

/// The share of veiling luminance in foveal luminance (Moon and Spencer, "The Visual Effect of
/// Non-Uniform Surrounds", 1945).
const SHARE: f64 = 0.08;
/// Largest number of foveal samples: each receives light from all others.
const MOST: usize = 1 << 17;
/// Directions with a smaller cosine count as behind the eye.
const TINY: f64 = 1e-6;

/// The veiling luminance at each foveal sample, multiplied by its share.
#[derive(Debug)]
pub(super) struct Veil {
    colors: Vec<[f32; 3]>,
    columns: usize,
    rows: usize,
}

impl Veil {
    /// Computes the veil and adds it to the foveal samples.
    pub(super) fn new(fovea: &mut Fovea) -> Result<Veil, ToolError> {
        if fovea.colors.len() > MOST {
            return Err(ToolError::ViewTooWide { degrees: fovea.colors.len(), most: MOST });
        }
        let directions = fovea.directions();
        let colors: Vec<[f32; 3]> = (0..directions.len())
            .into_par_iter()
            .with_min_len(64)
            .map(|sample| veil_at(sample, &directions, &fovea.colors))
            .collect();
        for (color, veil) in fovea.colors.iter_mut().zip(&colors) {
            for (value, veil) in color.iter_mut().zip(veil) {
                *value = (f64::from(*value) * (1.0 - SHARE)) as f32 + veil;
            }
        }
        Ok(Veil { colors, columns: fovea.columns(), rows: fovea.rows() })
    }

    /// Adds the veil to a scanline of the picture, interpolated between foveal samples.
    pub(super) fn add(&self, scanline: usize, resolution: &Resolution, pixels: &mut [[f32; 3]]) {
        let (row, down) = between(scanline, resolution.scanlines(), self.rows);
        let length = pixels.len();
        for (position, pixel) in pixels.iter_mut().enumerate() {
            let (column, right) = between(position, length, self.columns);
            let at = |row: usize, column: usize, i: usize| f64::from(self.colors[row * self.columns + column][i]);
            for (i, value) in pixel.iter_mut().enumerate() {
                let mixed = |column: usize| (1.0 - down) * at(row, column, i) + down * at(row + 1, column, i);
                let veil = (1.0 - right) * mixed(column) + right * mixed(column + 1);
                *value = ((1.0 - SHARE) * f64::from(*value) + veil) as f32;
            }
        }
    }
}

/// The mean of all other samples, weighted by the cosine divided by the squared angle, which is
/// approximately 2 (1 − cos).
fn veil_at(sample: usize, directions: &[[f32; 3]], colors: &[[f32; 3]]) -> [f32; 3] {
    let [x, y, z] = directions[sample];
    let (mut sum, mut total) = ([0.0f32; 3], 0.0);
    for (other, (direction, color)) in directions.iter().zip(colors).enumerate() {
        if other == sample {
            continue;
        }
        let cosine = f64::from(x * direction[0] + y * direction[1] + z * direction[2]);
        if cosine <= TINY {
            continue;
        }
        let weight = cosine * (0.5 / (1.0 - cosine));
        for (sum, value) in sum.iter_mut().zip(color) {
            *sum += (f64::from(*value) * weight) as f32;
        }
        total += weight;
    }
    if total > TINY { sum.map(|value| (f64::from(value) * (SHARE / total)) as f32) } else { sum }
}
