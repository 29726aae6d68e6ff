//! Conversion of the colours of BSDF files to Radiance's red, green and blue.

use glam::{DMat3, DVec3};

/// Matrix from CIE XYZ to red, green and blue with chromaticities (0.640, 0.330), (0.290, 0.600),
/// (0.150, 0.060), for the white of equal energy with Y = 1 (Radiance's standard primaries); rows
/// are red, green, blue.
const XYZ_TO_RGB: [[f64; 3]; 3] = [
    [2.565_312_84, -1.166_849_62, -0.398_463_23],
    [-1.022_108_17, 1.978_286_62, 0.043_821_56],
    [0.074_724_38, -0.251_939_57, 1.177_215_19],
];

/// Matrix from XYZ to the "Sharp" primaries, in which Radiance determines the minimum of a BSDF.
const XYZ_TO_SHARP: [[f64; 3]; 3] = [[1.2694, -0.0988, -0.1706], [-0.8364, 1.8006, 0.0357], [0.0297, -0.0315, 1.0018]];

fn matrix(rows: &[[f64; 3]; 3]) -> DMat3 {
    DMat3::from_cols_array_2d(rows).transpose()
}

/// Radiance's red, green and blue of a CIE XYZ value, without clipping.
pub(crate) fn rgb_of_xyz(xyz: [f64; 3]) -> [f64; 3] {
    (matrix(&XYZ_TO_RGB) * DVec3::from_array(xyz)).to_array()
}

/// A CIE XYZ value in the Sharp primaries.
pub(crate) fn sharp_of_xyz(xyz: [f64; 3]) -> [f64; 3] {
    (matrix(&XYZ_TO_SHARP) * DVec3::from_array(xyz)).to_array()
}

/// The XYZ of a value in the Sharp primaries.
pub(crate) fn xyz_of_sharp(sharp: [f64; 3]) -> [f64; 3] {
    (matrix(&XYZ_TO_SHARP).inverse() * DVec3::from_array(sharp)).to_array()
}

/// XYZ of a luminance Y and CIE 1976 chromaticities u′, v′.
///
/// Source: CIE 15, x = 9u′/(6u′ − 16v′ + 12), y = 4v′/(6u′ − 16v′ + 12). Invalid chromaticities
/// give grey.
pub(crate) fn xyz_of_yuv(y: f64, u: f64, v: f64) -> [f64; 3] {
    if v <= 1e-6 || y <= 0.0 {
        return [y; 3];
    }
    let [x_over_y, z_over_y] = [9.0 * u / (4.0 * v), (12.0 - 3.0 * u - 20.0 * v) / (4.0 * v)];
    [x_over_y * y, y, z_over_y * y]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_is_grey_in_all_primaries() {
        // u′ and v′ of equal-energy white.
        let xyz = xyz_of_yuv(0.7, 4.0 / 19.0, 9.0 / 19.0);
        for value in xyz.into_iter().chain(rgb_of_xyz(xyz)) {
            assert!((value - 0.7).abs() < 1e-6, "{value}");
        }
        let back = xyz_of_sharp(sharp_of_xyz([0.3, 0.5, 0.2]));
        assert!((back[0] - 0.3).abs() < 1e-12 && (back[2] - 0.2).abs() < 1e-12);
    }

    #[test]
    fn luminance_is_kept() {
        let [red, green, blue] = rgb_of_xyz(xyz_of_yuv(0.4, 0.3, 0.5));
        assert!((0.265_105_82 * red + 0.670_105_82 * green + 0.064_788_36 * blue - 0.4).abs() < 1e-6);
    }
}
