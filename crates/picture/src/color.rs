//! RGB colour spaces: primaries, and conversion to and from CIE tristimulus values.

use glam::{DMat3, DVec3};
use radsight_units::color;

/// Chromaticities (x, y) of red, green, blue and white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RgbPrimaries {
    /// Red.
    pub red: [f64; 2],
    /// Green.
    pub green: [f64; 2],
    /// Blue.
    pub blue: [f64; 2],
    /// White.
    pub white: [f64; 2],
}

/// Chromaticities closer than this are equal.
const SAME: f64 = 1e-4;

/// The "Sharp" matrix from XYZ to cone-like responses, and its inverse as Radiance rounds it;
/// columns.
const SHARP: DMat3 =
    DMat3::from_cols_array(&[1.2694, -0.8364, 0.0297, -0.0988, 1.8006, -0.0315, -0.1706, 0.0357, 1.0018]);
const SHARP_INVERSE: DMat3 =
    DMat3::from_cols_array(&[0.8156, 0.3791, -0.0123, 0.0472, 0.5769, 0.0167, 0.1372, 0.0440, 0.9955]);

impl RgbPrimaries {
    /// Radiance's primaries with equal-energy white; the default of an RGBE picture without
    /// `PRIMARIES=`.
    pub const STANDARD: RgbPrimaries =
        RgbPrimaries { red: color::RED, green: color::GREEN, blue: color::BLUE, white: color::WHITE };

    /// The primaries whose components are X, Y and Z.
    pub const XYZ: RgbPrimaries =
        RgbPrimaries { red: [1.0, 0.0], green: [0.0, 1.0], blue: [0.0, 0.0], white: [1.0 / 3.0, 1.0 / 3.0] };

    /// From the values of a `PRIMARIES=` line: x and y of red, green, blue, white.
    #[must_use]
    pub fn from_array([rx, ry, gx, gy, bx, by, wx, wy]: [f64; 8]) -> Self {
        RgbPrimaries { red: [rx, ry], green: [gx, gy], blue: [bx, by], white: [wx, wy] }
    }

    /// The value of a `PRIMARIES=` line, as Radiance prints it.
    #[must_use]
    pub fn to_header_value(&self) -> String {
        let numbers = [self.red, self.green, self.blue, self.white].concat();
        numbers.iter().map(|number| format!(" {number:.4}")).collect()
    }

    /// The matrix from RGB to XYZ, adapted to equal-energy white, so that RGB (1, 1, 1) has Y = 1.
    /// `None` if the primaries are collinear or the white is impossible.
    #[must_use]
    pub fn rgb_to_xyz(&self) -> Option<DMat3> {
        Some(adaptation(self.white, RgbPrimaries::XYZ.white)? * self.unadapted()?)
    }

    /// The matrix from XYZ to RGB, the inverse of [`RgbPrimaries::rgb_to_xyz`].
    #[must_use]
    pub fn xyz_to_rgb(&self) -> Option<DMat3> {
        Some(invertible(self.unadapted()?)?.inverse() * adaptation(RgbPrimaries::XYZ.white, self.white)?)
    }

    /// The matrix from RGB of these primaries to RGB of others, adapted to the other white.
    #[must_use]
    pub fn rgb_to_rgb(&self, other: &RgbPrimaries) -> Option<DMat3> {
        let to_other = invertible(other.unadapted()?)?.inverse();
        Some(to_other * adaptation(self.white, other.white)? * self.unadapted()?)
    }

    /// The weight of each component in the luminance; the sum is 1.
    #[must_use]
    pub fn luminance_weights(&self) -> Option<[f64; 3]> {
        Some(self.unadapted()?.row(1).to_array())
    }

    /// A matrix whose columns are the XYZ of the primaries, scaled so that they add up to white
    /// with Y = 1.
    fn unadapted(&self) -> Option<DMat3> {
        let column = |[x, y]: [f64; 2]| DVec3::new(x, y, 1.0 - x - y);
        let columns = invertible(DMat3::from_cols(column(self.red), column(self.green), column(self.blue)))?;
        let amounts = columns.inverse() * white_point(self.white)?;
        Some(columns * DMat3::from_diagonal(amounts))
    }
}

fn invertible(matrix: DMat3) -> Option<DMat3> {
    let determinant = matrix.determinant();
    (determinant.is_finite() && determinant.abs() > 1e-6).then_some(matrix)
}

fn white_point([x, y]: [f64; 2]) -> Option<DVec3> {
    (x.is_finite() && y > SAME).then(|| DVec3::new(x / y, 1.0, (1.0 - x - y) / y))
}

/// Von Kries adaptation of XYZ values from one white to another, in the Sharp space.
fn adaptation(from: [f64; 2], to: [f64; 2]) -> Option<DMat3> {
    if (0..2).all(|i| (from[i] - to[i]).abs() <= SAME) {
        return Some(DMat3::IDENTITY);
    }
    let (from, to) = (SHARP * white_point(from)?, SHARP * white_point(to)?);
    if from.abs().min_element() <= SAME {
        return None;
    }
    Some(SHARP_INVERSE * DMat3::from_diagonal(to / from) * SHARP)
}

/// Converts XYZ to RGB by a matrix from [`RgbPrimaries::xyz_to_rgb`]. A colour outside the gamut is
/// desaturated towards the grey of its luminance until no component is negative. Negative luminance
/// gives black, as in Radiance.
#[must_use]
pub fn xyz_to_rgb(matrix: &DMat3, xyz: [f32; 3]) -> [f32; 3] {
    let xyz = DVec3::from(xyz.map(f64::from));
    let (rgb, grey) = (*matrix * xyz, xyz.y);
    if grey < 0.0 {
        return [0.0; 3];
    }
    let lowest = rgb.min_element();
    if lowest >= 0.0 {
        return rgb.to_array().map(|component| component as f32);
    }
    // The lowest component becomes 0: grey + part · (lowest − grey) = 0.
    let part = grey / (grey - lowest);
    (DVec3::splat(grey) + part * (rgb - grey)).max(DVec3::ZERO).to_array().map(|component| component as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weights_are_those_of_the_closed_formula() {
        let weights = RgbPrimaries::STANDARD.luminance_weights().unwrap();
        for (weight, known) in weights.iter().zip([0.265_105_820_1, 0.670_105_820_1, 0.064_788_359_8]) {
            assert!((weight - known).abs() < 1e-9, "{weights:?}");
        }
    }

    #[test]
    fn there_and_back_is_the_same() {
        let d65 = RgbPrimaries::from_array([0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329]);
        for primaries in [RgbPrimaries::STANDARD, RgbPrimaries::XYZ, d65] {
            let both = primaries.xyz_to_rgb().unwrap() * primaries.rgb_to_xyz().unwrap();
            // Radiance's rounded inverse of the Sharp matrix causes this error.
            assert!(both.abs_diff_eq(DMat3::IDENTITY, 5e-4), "{both}");
        }
    }

    #[test]
    fn impossible_primaries_give_nothing() {
        let line = RgbPrimaries::from_array([0.1, 0.1, 0.2, 0.2, 0.3, 0.3, 0.3333, 0.3333]);
        assert_eq!(line.rgb_to_xyz(), None);
        assert_eq!(RgbPrimaries { white: [0.3, 0.0], ..RgbPrimaries::STANDARD }.xyz_to_rgb(), None);
    }

    #[test]
    fn a_colour_outside_is_moved_to_grey() {
        let matrix = RgbPrimaries::STANDARD.xyz_to_rgb().unwrap();
        let rgb = xyz_to_rgb(&matrix, [0.1, 0.5, 0.05]);
        assert!(rgb.iter().all(|value| *value >= 0.0) && rgb[0] < 1e-15, "{rgb:?}");
        assert_eq!(xyz_to_rgb(&matrix, [0.1, -0.5, 0.05]), [0.0; 3]);
    }
}
