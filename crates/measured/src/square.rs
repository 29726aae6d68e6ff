//! Area-preserving, continuous map between the unit disk and the unit square.
//!
//! Source: Shirley and Chiu, "A low distortion map between disk and square", Journal of Graphics
//! Tools 2(3), 1997.

use std::f64::consts::FRAC_PI_4;

/// Largest coordinate: the far edges of the square belong to its last cells.
const LARGEST: f64 = 1.0 - 1e-12;

/// Maps a point of the unit disk to the unit square [0,1)².
pub(crate) fn square_of_disk([x, y]: [f64; 2]) -> [f64; 2] {
    let radius = x.hypot(y);
    let (a, b) = if x.abs() >= y.abs() {
        if radius == 0.0 {
            (0.0, 0.0)
        } else {
            let a = radius.copysign(x);
            (a, a * (y / x).atan() / FRAC_PI_4)
        }
    } else {
        let b = radius.copysign(y);
        (b * (x / y).atan() / FRAC_PI_4, b)
    };
    [a, b].map(|side| (0.5 * side + 0.5).clamp(0.0, LARGEST))
}

/// Maps a point of the unit square to the unit disk.
pub(crate) fn disk_of_square(point: [f64; 2]) -> [f64; 2] {
    let [a, b] = point.map(|side| 2.0 * side - 1.0);
    if a == 0.0 && b == 0.0 {
        return [0.0; 2];
    }
    if a.abs() > b.abs() {
        let (sine, cosine) = (FRAC_PI_4 * b / a).sin_cos();
        [a * cosine, a * sine]
    } else {
        let (sine, cosine) = (FRAC_PI_4 * a / b).sin_cos();
        [b * sine, b * cosine]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_two_maps_are_inverse() {
        for i in 0..40 {
            for j in 0..40 {
                let square = [(f64::from(i) + 0.3) / 40.0, (f64::from(j) + 0.6) / 40.0];
                let disk = disk_of_square(square);
                assert!(disk[0].hypot(disk[1]) <= 1.0);
                let back = square_of_disk(disk);
                assert!((back[0] - square[0]).abs() < 1e-12 && (back[1] - square[1]).abs() < 1e-12, "{square:?}");
            }
        }
    }

    #[test]
    fn the_quadrants_are_those_of_the_paper() {
        let diagonal = 0.5_f64.sqrt();
        assert!((disk_of_square([1.0, 1.0])[0] - diagonal).abs() < 1e-15);
        assert_eq!(disk_of_square([0.0, 0.5]), [-1.0, 0.0]);
        assert!((disk_of_square([0.5, 0.0])[1] + 1.0).abs() < 1e-15);
        assert_eq!(square_of_disk([0.0, 0.0]), [0.5, 0.5]);
    }
}
