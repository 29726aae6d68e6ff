//! Conversion from CIE 1931 colours to Radiance's red, green and blue.
//!
//! Radiance's primaries are those of a nominal monitor with equal-energy white (`color.h`). A
//! colour outside the gamut is desaturated towards the grey of its luminance until no component is
//! negative.

use glam::DVec3;
use radsight_units::color::{XYZ_TO_RGB, rgb_to_xyz};

/// The red, green and blue of a colour with chromaticity (x, y) and luminance (or reflectance)
/// `level`.
pub(crate) fn rgb_of_chromaticity([x, y]: [f64; 2], level: f64) -> [f64; 3] {
    if level <= 0.0 || y <= 0.0 {
        return [0.0; 3];
    }
    let scaled_x = x / y * level;
    rgb([scaled_x, level, level * (1.0 / y - 1.0) - scaled_x])
}

/// The luminance of a colour whose white is (1, 1, 1).
pub(crate) fn brightness(rgb: [f64; 3]) -> f64 {
    rgb_to_xyz().row(1).dot(DVec3::from(rgb))
}

/// Converts XYZ inside the gamut.
fn rgb(xyz: [f64; 3]) -> [f64; 3] {
    // Single precision, as in Radiance's colours.
    let mut rgb = (XYZ_TO_RGB * DVec3::from(xyz)).as_vec3().as_dvec3().to_array();
    let grey = xyz[1];
    let kept = rgb.iter().filter(|value| **value < 0.0).map(|value| grey / (grey - value)).fold(1.0, f64::min);
    if kept < 1.0 {
        rgb = rgb.map(|value| kept * value + (1.0 - kept) * grey);
    }
    rgb
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brightness_has_the_weights_of_radiance() {
        // The weights in color.h are rounded from a white of .333.
        for (rgb, expected) in [([1.0, 0.0, 0.0], 0.2651), ([0.0, 1.0, 0.0], 0.6701), ([0.0, 0.0, 1.0], 0.0648)] {
            assert!((brightness(rgb) - expected).abs() < 5e-5, "{}", brightness(rgb));
        }
        assert!((brightness([1.0; 3]) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn colours_outside_of_the_triangle_keep_their_luminance() {
        let violet = rgb_of_chromaticity([0.17, 0.02], 0.5);
        assert!(violet.iter().all(|value| *value >= 0.0));
        assert!((brightness(violet) - 0.5).abs() < 1e-6);
        assert!(rgb_of_chromaticity(radsight_units::color::WHITE, 0.7).iter().all(|value| (value - 0.7).abs() < 1e-6));
    }
}
