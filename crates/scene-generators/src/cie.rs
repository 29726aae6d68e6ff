//! From CIE 1931 colours to Radiance's red, green and blue.
//!
//! Radiance's primaries are those of a nominal monitor with a white of equal energy (`color.h`); a colour outside of their
//! triangle is mixed with the grey of its luminance until no component is negative.

/// Chromaticities of red, green and blue.
const PRIMARIES: [[f64; 2]; 3] = [[0.640, 0.330], [0.290, 0.600], [0.150, 0.060]];
/// Chromaticity of white.
const WHITE: [f64; 2] = [1.0 / 3.0, 1.0 / 3.0];

/// The red, green and blue of a colour with chromaticity (x, y) and luminance (or reflectance) `level`.
pub(crate) fn rgb_of_chromaticity([x, y]: [f64; 2], level: f64) -> [f64; 3] {
    if level <= 0.0 || y <= 0.0 {
        return [0.0; 3];
    }
    let scaled_x = x / y * level;
    rgb([scaled_x, level, level * (1.0 / y - 1.0) - scaled_x])
}

/// The luminance of a colour whose white is (1, 1, 1).
pub(crate) fn brightness(rgb: [f64; 3]) -> f64 {
    let weights = matrix_from_rgb()[1];
    (0..3).map(|band| weights[band] * rgb[band]).sum()
}

/// From XYZ, inside of the primaries' triangle.
fn rgb(xyz: [f64; 3]) -> [f64; 3] {
    let to_rgb = invert(matrix_from_rgb());
    // Single precision, as Radiance's colours.
    let mut rgb: [f64; 3] = to_rgb.map(|row| f64::from((0..3).map(|i| row[i] * xyz[i]).sum::<f64>() as f32));
    let grey = xyz[1];
    let kept = rgb.iter().filter(|value| **value < 0.0).map(|value| grey / (grey - value)).fold(1.0, f64::min);
    if kept < 1.0 {
        rgb = rgb.map(|value| kept * value + (1.0 - kept) * grey);
    }
    rgb
}

/// Rows X, Y, Z; columns red, green, blue; each primary scaled so that together they make the white.
fn matrix_from_rgb() -> [[f64; 3]; 3] {
    let unscaled: [[f64; 3]; 3] = std::array::from_fn(|row| PRIMARIES.map(|[x, y]| [x, y, 1.0 - x - y][row]));
    let [x, y] = WHITE;
    let white = [x / y, 1.0, (1.0 - x - y) / y];
    let scales = invert(unscaled).map(|row| (0..3).map(|i| row[i] * white[i]).sum::<f64>());
    unscaled.map(|row| std::array::from_fn(|band| row[band] * scales[band]))
}

/// The inverse by cofactors; the matrices here are regular.
fn invert(m: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let cofactor = |row: usize, column: usize| {
        let (r1, r2) = ((row + 1) % 3, (row + 2) % 3);
        let (c1, c2) = ((column + 1) % 3, (column + 2) % 3);
        m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1]
    };
    let determinant: f64 = (0..3).map(|column| m[0][column] * cofactor(0, column)).sum();
    std::array::from_fn(|row| std::array::from_fn(|column| cofactor(column, row) / determinant))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brightness_has_the_weights_of_radiance() {
        // The weights that color.h names are rounded from a white of .333.
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
        assert!(rgb_of_chromaticity(WHITE, 0.7).iter().all(|value| (value - 0.7).abs() < 1e-6));
    }
}
