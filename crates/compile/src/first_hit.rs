//! First hits of rays, without shading.

use glam::DVec3;
use radsight_accel::{Intersection, PrimitiveId};
use radsight_ir::{ModifierHandle, ModifierKind, Scene, SurfaceHandle};

/// The first surface or distant source that a ray hits.
#[derive(Clone, Copy, Debug)]
pub struct FirstHit {
    /// Distance from the origin, scene units.
    pub distance: f64,
    /// The hit point, scene coordinates.
    pub point: DVec3,
    /// Unit geometric normal of the surface's own orientation, which may face away from the ray.
    pub normal: DVec3,
    /// Unit shading normal, textures included.
    pub perturbed_normal: DVec3,
    /// Surface of the top-level scene: the mesh or instance if the hit is within one.
    pub surface: SurfaceHandle,
    /// Index of the compiled material.
    pub material: u32,
    /// Local coordinates on a mesh; zero elsewhere.
    pub local: [f64; 2],
    /// The primitive that was hit; [`PrimitiveId::NONE`] for a distant source.
    pub primitive: PrimitiveId,
}

/// Material index of all distant sources.
pub const DISTANT: u32 = u32::MAX;

impl FirstHit {
    /// A hit on a surface. `distance` is the reported distance, which may include earlier segments.
    pub fn at(hit: &Intersection, distance: f64) -> FirstHit {
        FirstHit {
            distance,
            point: hit.point,
            normal: hit.front,
            perturbed_normal: hit.front,
            surface: hit.surface,
            material: hit.shader.0,
            local: hit.instance.map_or([0.0; 2], |instance| instance.uv),
            primitive: hit.primitive,
        }
    }

    /// A hit on a distant source.
    pub fn distant(surface: SurfaceHandle, direction: DVec3) -> FirstHit {
        FirstHit {
            distance: f64::INFINITY,
            point: direction,
            normal: -direction,
            perturbed_normal: -direction,
            surface,
            material: DISTANT,
            local: [0.0; 2],
            primitive: PrimitiveId::NONE,
        }
    }
}

/// Name of the first material of a modifier chain, or of the mixture that stands for one; `void` for
/// none.
pub(crate) fn material_name(scene: &Scene, modifier: Option<ModifierHandle>) -> &str {
    let material = scene.chain(modifier).find(|(_, modifier)| match modifier.kind {
        ModifierKind::Material(_) => true,
        ModifierKind::Mixture(_) => modifier.modifier.is_none(),
        _ => false,
    });
    scene.original_name(material.map(|(handle, _)| handle))
}
