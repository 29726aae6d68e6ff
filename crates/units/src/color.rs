//! Radiance's primaries (`color.h`), and the matrices from and to CIE 1931 tristimulus values.

use glam::{DMat3, DVec3};

/// Chromaticity (x, y) of red.
pub const RED: [f64; 2] = [0.640, 0.330];
/// Chromaticity (x, y) of green.
pub const GREEN: [f64; 2] = [0.290, 0.600];
/// Chromaticity (x, y) of blue.
pub const BLUE: [f64; 2] = [0.150, 0.060];
/// Chromaticity (x, y) of white: equal energy at all wavelengths.
pub const WHITE: [f64; 2] = [1.0 / 3.0, 1.0 / 3.0];

/// Weights of red, green and blue in luminance, as `color.h` rounds them.
pub const LUMINANCE_WEIGHTS: [f64; 3] = [0.265, 0.670, 0.065];

/// Matrix from red, green and blue to X, Y and Z; white (1, 1, 1) has X = Y = Z = 1.
#[must_use]
pub fn rgb_to_xyz() -> DMat3 {
    let tristimulus = |[x, y]: [f64; 2]| DVec3::new(x, y, 1.0 - x - y);
    let unscaled = DMat3::from_cols(tristimulus(RED), tristimulus(GREEN), tristimulus(BLUE));
    let amounts = unscaled.inverse() * (tristimulus(WHITE) / WHITE[1]);
    unscaled * DMat3::from_diagonal(amounts)
}

/// Matrix from X, Y and Z to red, green and blue, by columns: the inverse of [`rgb_to_xyz`].
#[rustfmt::skip]
pub const XYZ_TO_RGB: DMat3 = DMat3::from_cols_array(&[
    2.5653128430296377, -1.0221081721279113, 0.07472437729685592,
    -1.1668496158068056, 1.9782866166600865, -0.25193956717027355,
    -0.398463227222832, 0.04382155546782472, 1.1772151898734178,
]);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_has_equal_tristimulus_values() {
        assert!((rgb_to_xyz() * DVec3::ONE).abs_diff_eq(DVec3::ONE, 1e-15));
    }

    #[test]
    fn the_two_matrices_are_inverse() {
        assert!((rgb_to_xyz() * XYZ_TO_RGB).abs_diff_eq(DMat3::IDENTITY, 1e-14));
    }

    #[test]
    fn the_rounded_weights_are_those_of_y() {
        // `color.h` rounds for a white of .333.
        let exact = rgb_to_xyz().row(1).to_array();
        for (weight, exact) in LUMINANCE_WEIGHTS.iter().zip(exact) {
            assert!((weight - exact).abs() < 5e-4, "{exact}");
        }
    }
}
