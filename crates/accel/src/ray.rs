//! Rays.

use glam::DVec3;
use radsight_ir::Transform;
use std::ops::RangeInclusive;

/// Lengths whose squares do not over- or underflow.
const SAFE_LENGTHS: RangeInclusive<f64> = 1e-140..=1e150;

/// A half line. The direction is a unit vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Scene units.
    pub origin: DVec3,
    /// Unit.
    pub direction: DVec3,
}

/// The axes of u and v, and the longest one, of a vector with these absolute components: the frame of a
/// sheared ray. Branch-free, since the longest axis is unpredictable.
#[inline(always)]
pub(crate) fn sheared_axes<T: PartialOrd>([x, y, z]: [T; 3]) -> [usize; 3] {
    let without_x = if y > z { 1 } else { 2 };
    let longest = if (x > y) & (x > z) { 0 } else { without_x };
    [[1, 2, 0], [2, 0, 1], [0, 1, 2]][longest]
}

impl Ray {
    /// A ray from `origin` along `direction`, which is normalised here. Every program makes its
    /// rays in this way, so a ray read from a stream has the same bits. `None` if the direction has
    /// no length or a number is not finite.
    #[must_use]
    pub fn new(origin: DVec3, direction: DVec3) -> Option<Ray> {
        let length = direction.length();
        if !SAFE_LENGTHS.contains(&length) {
            return Ray::of_extreme_direction(origin, direction);
        }
        origin.is_finite().then(|| Ray { origin, direction: direction / length })
    }

    /// The same for a direction whose squares over- or underflow, including zero and infinity.
    #[cold]
    fn of_extreme_direction(origin: DVec3, direction: DVec3) -> Option<Ray> {
        let largest = direction.abs().max_element();
        let usable = origin.is_finite() && direction.is_finite() && largest > 0.0;
        usable.then(|| Ray { origin, direction: (direction / largest).normalize() })
    }

    /// The point at `distance` along the ray.
    #[inline]
    #[must_use]
    pub fn at(&self, distance: f64) -> DVec3 {
        self.origin + self.direction * distance
    }

    /// The same ray in the coordinates of an instance with the transform `to_scene`; distances
    /// along it are divided by its scale.
    #[inline]
    pub(crate) fn seen_from(&self, to_scene: &Transform) -> Ray {
        let to_local = to_scene.rotation.transpose();
        Ray {
            origin: to_local * (self.origin - to_scene.translation) / to_scene.scale,
            direction: to_local * self.direction,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_of_any_length_give_unit_rays() {
        for length in [5e-324, 1e-310, 1e-160, 1e-139, 1.0, 1e149, 1e160, 1e308] {
            let ray = Ray::new(DVec3::ZERO, DVec3::new(0.0, length, -length)).unwrap();
            assert!((ray.direction - DVec3::new(0.0, 0.5f64.sqrt(), -(0.5f64.sqrt()))).length() < 1e-15, "{length}");
        }
        for none in [DVec3::ZERO, DVec3::INFINITY, DVec3::NAN, DVec3::new(1.0, f64::INFINITY, 0.0)] {
            assert_eq!(Ray::new(DVec3::ZERO, none), None);
        }
    }
}
