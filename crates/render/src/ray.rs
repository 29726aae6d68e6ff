//! Rays, and where they end.

use crate::surface_interaction::Placed;
use glam::DVec3;
use radsight_ir::{SurfaceHandle, Transform};

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

/// How far apart neighbouring rays are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RaySpacing {
    /// Distance of their origins, scene units.
    pub width: f64,
    /// Angle between them, radians.
    pub angle: f64,
}

impl RaySpacing {
    /// Rays that have nothing to do with each other.
    pub const UNKNOWN: RaySpacing = RaySpacing { width: 0.0, angle: 0.0 };

    /// Distance of neighbouring rays where they have gone so far, scene units.
    pub(crate) fn at(&self, distance: f64) -> f64 {
        self.width + self.angle * distance
    }
}

/// Names a surface of one scene that has a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct MemberId(pub(crate) u32);

impl MemberId {
    /// The primitive that a surface is which holds no others.
    pub(crate) fn primitive(self) -> PrimitiveId {
        PrimitiveId(u64::from(self.0))
    }
}

/// Names what a ray can hit: a surface of the scene, a triangle of a mesh, a surface of a scene that is placed in it. Each copy has
/// a name of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PrimitiveId(pub(crate) u64);

impl PrimitiveId {
    /// Names nothing.
    pub(crate) const NONE: PrimitiveId = PrimitiveId(u64::MAX);

    /// The member that has this primitive's name, for one that no other holds.
    pub(crate) fn member(self) -> MemberId {
        MemberId(self.0 as u32)
    }
}

/// Names a shader of the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct ShaderId(pub(crate) u32);

/// Where a ray crosses a primitive.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// Along the ray, scene units.
    pub(crate) distance: f64,
    pub(crate) primitive: PrimitiveId,
}

/// Where a ray meets a surface, with all that its shading asks for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Intersection {
    pub(crate) distance: f64,
    pub(crate) primitive: PrimitiveId,
    /// The surface of the whole scene: a mesh or an instance where the ray hits something within one.
    pub(crate) surface: SurfaceHandle,
    pub(crate) shader: ShaderId,
    pub(crate) point: DVec3,
    /// Unit, on the surface's front side, whatever side the ray comes from.
    pub(crate) front: DVec3,
    /// What only meshes and instances have.
    pub(crate) placed: Option<Placed>,
}
