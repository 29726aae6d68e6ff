//! Area-preserving maps from the unit square.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Maps a point of the unit square to the unit disk, uniform by area.
///
/// Concentric map of Shirley and Chiu, "A Low Distortion Map Between Disk and Square", JGT 2(3),
/// 1997. It preserves stratification with low distortion.
#[inline]
#[must_use]
pub fn unit_disk(u: f64, v: f64) -> (f64, f64) {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if a == 0.0 && b == 0.0 {
        return (0.0, 0.0);
    }
    let (radius, angle) =
        if a.abs() > b.abs() { (a, FRAC_PI_4 * (b / a)) } else { (b, FRAC_PI_2 - FRAC_PI_4 * (a / b)) };
    let (sin, cos) = angle.sin_cos();
    (radius * cos, radius * sin)
}

/// Maps a point of the unit square to a unit direction about +z, with density cos θ / π.
#[inline]
#[must_use]
pub fn cosine_hemisphere(u: f64, v: f64) -> [f64; 3] {
    let (x, y) = unit_disk(u, v);
    [x, y, (1.0 - x * x - y * y).max(0.0).sqrt()]
}

/// Chooses an index by probabilities that sum to 1; returns it with the position of `u` within its
/// interval, 0…1. `None` if there are none.
///
/// ```
/// use radsight_sampling::choose;
/// assert_eq!(choose([0.5, 0.25, 0.25], 0.625), Some((1, 0.5)));
/// ```
#[must_use]
pub fn choose(chances: impl IntoIterator<Item = f64>, u: f64) -> Option<(usize, f64)> {
    let (mut rest, mut last) = (u, None);
    for (index, chance) in chances.into_iter().enumerate() {
        last = Some((index, (rest / chance).clamp(0.0, 1.0)));
        if rest < chance {
            return last;
        }
        rest -= chance;
    }
    // By rounding the probabilities may sum to less than 1.
    last
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_disk_map_is_uniform_by_area() {
        let n = 400;
        let mut within_half = 0;
        for i in 0..n * n {
            let (x, y) = unit_disk((f64::from(i % n) + 0.5) / f64::from(n), (f64::from(i / n) + 0.5) / f64::from(n));
            assert!(x.hypot(y) <= 1.0 + 1e-12);
            within_half += i32::from(x.hypot(y) < 0.5);
        }
        let share = f64::from(within_half) / f64::from(n * n);
        assert!((share - 0.25).abs() < 2e-3, "a quarter of the area lies within half the radius, found {share}");
    }
}
