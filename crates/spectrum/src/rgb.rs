//! Conversion of spectra to Radiance's red, green and blue, by CIE 1931 colours.

use crate::observer::cumulative;
use glam::DVec3;
use radsight_units::color::XYZ_TO_RGB;

/// Scotopic weights of Radiance's red, green and blue, each constant over its part of the spectrum
/// (780, 588, 480, 380 nm), with 412 lm/W for white: CIE 1951 V'(λ).
pub const SCOTOPIC_OF_RGB: [f64; 3] = [4.652_171, 292.074_6, 115.273_2];

/// Melanopic weights of red, green and blue, with 179 lm/W for white: CIE S 026.
pub const MELANOPIC_OF_RGB: [f64; 3] = [0.327_763_8, 107.451_9, 71.220_34];

/// X, Y and Z of values in equal bands between two wavelengths, nm; equal-energy light of 1 gives
/// 1, 1, 1.
#[must_use]
pub fn xyz_of_bands(values: &[f64], range_nm: [f64; 2]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (value, weights) in values.iter().zip(band_weights(values.len(), range_nm)) {
        for (sum, weight) in sum.iter_mut().zip(weights) {
            *sum += value * weight;
        }
    }
    sum
}

/// X, Y and Z of each band alone; band limits are rounded to whole nanometres, as in Radiance.
pub fn xyz_of_whole_bands(bands: usize, [first_nm, last_nm]: [f64; 2]) -> impl Iterator<Item = [f64; 3]> {
    let edge = move |band: usize| (first_nm + (last_nm - first_nm) * band as f64 / bands as f64).trunc();
    (0..bands).map(move |band| xyz_of_bands(&[1.0], [edge(band), edge(band + 1)]))
}

/// Weight of each band in X, Y and Z.
pub(crate) fn band_weights(bands: usize, [first_nm, last_nm]: [f64; 2]) -> impl Iterator<Item = [f64; 3]> {
    let step = (last_nm - first_nm) / bands as f64;
    let edge = move |band: usize| cumulative(first_nm + step * band as f64);
    (0..bands).map(move |band| {
        let (from, to) = (edge(band), edge(band + 1));
        std::array::from_fn(|i| (to[i] - from[i]).abs())
    })
}

/// Radiance's red, green and blue of a colour. A colour with a negative component is mixed with the
/// grey of its luminance until that component is zero.
#[must_use]
pub fn xyz_to_rgb(xyz: [f64; 3]) -> [f64; 3] {
    let grey = xyz[1];
    if grey < 0.0 {
        return [0.0; 3];
    }
    let rgb = (XYZ_TO_RGB * DVec3::from(xyz)).to_array();
    let lowest = rgb.into_iter().fold(0.0, f64::min);
    if lowest == 0.0 {
        return rgb;
    }
    let kept = grey / (grey - lowest);
    rgb.map(|value| (kept * value + (1.0 - kept) * grey).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_white() {
        let rgb = xyz_to_rgb([0.7; 3]);
        assert!(rgb.iter().all(|value| (value - 0.7).abs() < 1e-12), "{rgb:?}");
    }

    #[test]
    fn laser_light_has_no_negative_component() {
        let mut values = [0.0; 40];
        values[12] = 1.0;
        let rgb = xyz_to_rgb(xyz_of_bands(&values, [380.0, 780.0]));
        assert!(rgb.iter().all(|value| *value >= 0.0) && rgb[1] > 0.0, "{rgb:?}");
    }
}
