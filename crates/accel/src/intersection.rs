//! Crossings and intersections.

use crate::ids::{PrimitiveId, ShaderId};
use crate::limits::Limits;
use glam::DVec3;
use radsight_ir::{SurfaceHandle, Transform};
use std::ops::Range;

/// A ray's crossing of a primitive.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    /// Along the ray, scene units.
    pub distance: f64,
    /// The primitive.
    pub primitive: PrimitiveId,
}

impl Crossing {
    /// The crossing of a flat primitive at the distance that a test finds within the limits. A ray never
    /// hits the flat surface from which it starts.
    #[inline(always)]
    pub(crate) fn of_flat(
        primitive: PrimitiveId,
        from: Option<PrimitiveId>,
        limits: &Limits,
        test: impl FnOnce(Range<f64>) -> Option<f64>,
    ) -> Option<Crossing> {
        if from == Some(primitive) {
            return None;
        }
        test(limits.range()).map(|distance| Crossing { distance, primitive })
    }
}

/// A ray's intersection with a surface, with all geometric data for shading.
#[derive(Clone, Copy, Debug)]
pub struct Intersection {
    /// Along the ray, scene units.
    pub distance: f64,
    /// The primitive.
    pub primitive: PrimitiveId,
    /// The surface of the outermost scene: a mesh or an instance if the hit is inside one.
    pub surface: SurfaceHandle,
    /// The shader.
    pub shader: ShaderId,
    /// The point, in scene coordinates.
    pub point: DVec3,
    /// Unit normal on the surface's front side, for any side of incidence.
    pub front: DVec3,
    /// Only for meshes and instances.
    pub instance: Option<InstanceData>,
}

/// Additional data for meshes and instances.
#[derive(Clone, Copy, Debug)]
pub struct InstanceData {
    /// From the scene's coordinates to those of the surface's modifiers; `None` if they are equal.
    pub to_object: Option<Transform>,
    /// Local coordinates of a mesh, the variables `Lu` and `Lv`; otherwise zero.
    pub uv: [f64; 2],
    /// Interpolated minus geometric unit normal, scene coordinates, on the front side; textures add
    /// to it.
    pub perturbation: DVec3,
}
