//! Rays.

use glam::DVec3;
use radsight_ir::Transform;

/// A half line. The direction is a unit vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Scene units.
    pub origin: DVec3,
    /// Unit.
    pub direction: DVec3,
}

impl Ray {
    /// A ray through `origin` along `direction`, which is normalised here; every program makes its rays in this one way, so
    /// that a ray read from a stream is the same ray bit for bit. `None` when the direction has no length or a number is
    /// not finite.
    #[must_use]
    pub fn new(origin: DVec3, direction: DVec3) -> Option<Ray> {
        let length = direction.length();
        let usable = origin.is_finite() && length.is_finite() && length > 0.0;
        usable.then(|| Ray { origin, direction: direction / length })
    }

    /// The point at `distance` along the ray.
    #[inline]
    #[must_use]
    pub fn at(&self, distance: f64) -> DVec3 {
        self.origin + self.direction * distance
    }

    /// The same ray in the coordinates of something that `to_scene` places; distances along it are those here over its scale.
    #[inline]
    pub(crate) fn seen_from(&self, to_scene: &Transform) -> Ray {
        let to_local = to_scene.rotation.transpose();
        Ray {
            origin: to_local * (self.origin - to_scene.translation) / to_scene.scale,
            direction: to_local * self.direction,
        }
    }
}
