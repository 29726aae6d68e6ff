//! Where rays end, without what they bring.

use crate::plan::RenderPlan;
use crate::ray::{Hit, PrimitiveId, Ray};
use crate::trace::FirstHit;
use glam::DVec3;
use radsight_ir::{ModifierHandle, ModifierKind, Scene, SurfaceHandle};

impl FirstHit {
    pub(crate) fn at(hit: &Hit, distance: f64) -> FirstHit {
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
    scene.modifier_name(material.map(|(handle, _)| handle))
}
