//! A density over the unit square, and over a parallelogram that a diffuse surface sees.

use crate::lobe_weighting::ReceiverCosine;
use glam::DVec3;

/// The least density at a corner, relative to the largest one: the cosine is only nearly bilinear.
const LEAST_DENSITY: f64 = 0.01;

/// A density over the unit square that is bilinear between its corners.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bilinear {
    /// At (0, 0), (1, 0), (0, 1) and (1, 1); their mean is 1.
    corners: [f64; 4],
}

impl Bilinear {
    /// In proportion to these values, which are not negative; uniform if none is above 0 and finite.
    #[inline]
    pub(crate) fn new(values: [f64; 4]) -> Bilinear {
        let largest = values.into_iter().fold(0.0, f64::max);
        if !(largest > 0.0 && largest.is_finite()) {
            return Bilinear { corners: [1.0; 4] };
        }
        let values = values.map(|value| value.max(LEAST_DENSITY * largest));
        let mean = 0.25 * values.iter().sum::<f64>();
        Bilinear { corners: values.map(|value| value / mean) }
    }

    #[inline]
    pub(crate) fn sample(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let [a, b, c, d] = self.corners;
        let y = linear([a + b, c + d], v);
        [linear([a + (c - a) * y, b + (d - b) * y], u), y]
    }

    #[inline]
    pub(crate) fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let [a, b, c, d] = self.corners;
        let (low, high) = (a + (b - a) * x, c + (d - c) * x);
        low + (high - low) * y
    }
}

/// Maps a number of the unit interval to a density that is linear between its ends.
fn linear([low, high]: [f64; 2], u: f64) -> f64 {
    let squared = low * low + u * (high * high - low * low);
    let sum = low + squared.max(0.0).sqrt();
    if sum > 0.0 { (u * (low + high) / sum).min(1.0) } else { u }
}

/// The density by area of points on a parallelogram, in proportion to the light that a surface of
/// this cosine receives from its corners: the cosines at both ends over the squared distance.
/// `corner` is relative to the receiver.
#[inline]
pub(crate) fn by_received_light(corner: DVec3, [x, y]: [DVec3; 2], cosine: &ReceiverCosine) -> Bilinear {
    let corners = [corner, corner + x, corner + y, corner + x + y];
    // The height above the plane, the other cosine times the distance, is the same for all.
    Bilinear::new(corners.map(|corner| cosine.of(corner) / corner.length_squared().powi(2)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_receiver_at_a_corner_has_a_finite_density() {
        let cosine = ReceiverCosine::Front(DVec3::Z);
        for corner in [DVec3::ZERO, DVec3::Z * 1e-200, DVec3::splat(1e-100), DVec3::splat(1e200)] {
            let density = by_received_light(corner, [DVec3::X, DVec3::Y], &cosine);
            for u in [[0.0, 0.0], [0.5, 0.1], [1.0, 1.0]] {
                let at = density.sample(u);
                assert!(at.iter().all(|share| (0.0..=1.0).contains(share)), "{at:?} at {corner}");
                assert!(density.at(at) > 0.0 && density.at(at).is_finite(), "{density:?} at {corner}");
            }
        }
    }
}
