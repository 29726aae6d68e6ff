//! Means over the neighbourhoods of points.
//!
//! Where a few samples decide how many more there are, the mean of all is too low: samples that are
//! high by chance are found noisy and outnumbered, those that are low by chance are not (Kirk and
//! Arvo, Unbiased Sampling Techniques for Image Synthesis, SIGGRAPH 1991). The noise of many points
//! hardly depends on the samples of one.

use glam::DVec3;

/// Points before and after a point, along the curve, that count for its mean.
const NEIGHBOURS: usize = 16;

/// Bits of a coordinate on the curve.
const BITS: u32 = 16;

/// The mean of the values of each point and its neighbours: those next to it along a Morton curve
/// through the points whose unit normals have the same main direction.
pub(crate) fn local_means(points: &[(DVec3, DVec3)], values: &[f64]) -> Vec<f64> {
    let low = points.iter().fold(DVec3::INFINITY, |low, (point, _)| low.min(*point));
    let high = points.iter().fold(DVec3::NEG_INFINITY, |high, (point, _)| high.max(*point));
    let size = (high - low).max_element().max(f64::MIN_POSITIVE);
    let steps = f64::from((1_u32 << BITS) - 1);
    let key = |index: &usize| {
        let (point, normal) = points[*index];
        let along = ((point - low) / size * steps).as_u64vec3();
        (main_direction(normal), spread(along.x) | spread(along.y) << 1 | spread(along.z) << 2)
    };
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by_cached_key(key);
    let mut means = vec![0.0; values.len()];
    for (at, index) in order.iter().enumerate() {
        let near = &order[at.saturating_sub(NEIGHBOURS)..order.len().min(at + NEIGHBOURS + 1)];
        means[*index] = near.iter().map(|index| values[*index]).sum::<f64>() / near.len() as f64;
    }
    means
}

/// The face of a cube that a unit normal points to.
fn main_direction(normal: DVec3) -> usize {
    let axis = normal.abs().max_position();
    2 * axis + usize::from(normal[axis] < 0.0)
}

/// Moves bit i to bit 3i.
fn spread(number: u64) -> u64 {
    (0..BITS).fold(0, |spread, bit| spread | (number >> bit & 1) << (3 * bit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_those_of_points_nearby_on_the_same_side() {
        // A floor and a ceiling of 40 × 40 points: the values differ between both, and halves.
        let mut points = Vec::new();
        let mut values = Vec::new();
        for (height, normal, value) in [(0.0, DVec3::Z, 1.0), (0.1, DVec3::NEG_Z, 5.0)] {
            for index in 0..1600 {
                let (x, y) = (f64::from(index % 40), f64::from(index / 40));
                points.push((DVec3::new(x, y, height), normal));
                values.push(value + if x < 20.0 { 0.0 } else { 1.0 });
            }
        }
        let means = local_means(&points, &values);
        // Only at the end of the curve through the floor does the ceiling count.
        assert!(means[..1600].iter().filter(|mean| **mean > 2.0).count() <= NEIGHBOURS);
        let inside = (0..points.len()).filter(|index| (points[*index].0.x - 19.5).abs() > 8.0);
        let differing = inside.clone().filter(|index| (means[*index] - values[*index]).abs() > 1e-9).count();
        assert!(differing * 10 < inside.count(), "{differing} points");
    }

    #[test]
    fn one_high_value_hardly_counts() {
        let points: Vec<_> = (0..100).map(|index| (DVec3::X * f64::from(index), DVec3::Y)).collect();
        let mut values = vec![1.0; 100];
        values[50] = 34.0;
        let means = local_means(&points, &values);
        assert!((means[50] - 2.0).abs() < 1e-9 && (means[10] - 1.0).abs() < 1e-9);
    }

    #[test]
    fn few_points_and_none_have_means() {
        assert_eq!(local_means(&[], &[]), [0.0; 0]);
        assert_eq!(local_means(&[(DVec3::ONE, DVec3::Z); 3], &[1.0, 2.0, 6.0]), [3.0; 3]);
    }
}
