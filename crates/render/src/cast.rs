//! Where rays end, without what they bring.

use crate::plan::RenderPlan;
use glam::DVec3;
use radsight_accel::{Intersection, PrimitiveId, Ray};
use radsight_ir::{ModifierHandle, ModifierKind, Scene, SurfaceHandle};

/// Where the first ray ended.
#[derive(Clone, Copy, Debug)]
pub struct FirstHit {
    /// Distance, scene units.
    pub distance: f64,
    /// The point.
    pub point: DVec3,
    /// Unit geometric normal, the way the surface faces, which may be away from the ray.
    pub normal: DVec3,
    /// Unit normal with textures.
    pub perturbed_normal: DVec3,
    /// The surface of the whole scene: a mesh or an instance where the ray ends within one.
    pub surface: SurfaceHandle,
    /// Local coordinates on a mesh; zero elsewhere.
    pub local: [f64; 2],
    pub(crate) primitive: PrimitiveId,
}

impl FirstHit {
    pub(crate) fn at(hit: &Intersection, distance: f64) -> FirstHit {
        FirstHit {
            distance,
            point: hit.point,
            normal: hit.front,
            perturbed_normal: hit.front,
            surface: hit.surface,
            local: hit.placed.map_or([0.0; 2], |placed| placed.uv),
            primitive: hit.primitive,
        }
    }

    pub(crate) fn distant(surface: SurfaceHandle, direction: DVec3) -> FirstHit {
        FirstHit {
            distance: f64::INFINITY,
            point: direction,
            normal: -direction,
            perturbed_normal: -direction,
            surface,
            local: [0.0; 2],
            primitive: PrimitiveId::NONE,
        }
    }
}

impl RenderPlan {
    /// Where a ray ends: at the first surface, or at a distant source. Nothing is shaded, so the perturbed normal is the geometric one.
    #[must_use]
    pub fn cast(&self, ray: &Ray) -> Option<FirstHit> {
        match self.first_hit(ray, None) {
            Some(hit) => Some(FirstHit::at(&hit, hit.distance)),
            None => self.sky_at(ray.direction, false).map(|(surface, _)| FirstHit::distant(surface, ray.direction)),
        }
    }
}

/// The name of the first material of a chain of modifiers; `void` for none.
pub(crate) fn material_name(scene: &Scene, modifier: Option<ModifierHandle>) -> &str {
    let material = scene.chain(modifier).find(|(_, modifier)| matches!(modifier.kind, ModifierKind::Material(_)));
    scene.original_name(material.map(|(handle, _)| handle))
}
