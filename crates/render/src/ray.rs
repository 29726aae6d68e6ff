//! Rays, and where they end.

use glam::DVec3;
use radsight_ir::SurfaceHandle;

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
}

/// Names a primitive of the geometry: a surface, or one triangle of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PrimitiveId(pub(crate) u32);

/// Where a ray meets a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    pub(crate) distance: f64,
    pub(crate) primitive: PrimitiveId,
    pub(crate) surface: SurfaceHandle,
    pub(crate) point: DVec3,
    /// Unit, on the surface's front side, whatever side the ray comes from.
    pub(crate) front: DVec3,
}
