//! Where rays end, without what they bring.

use glam::DVec3;
use radsight_accel::{Intersection, PrimitiveId};
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
    /// The number of the compiled material.
    pub material: u32,
    /// Local coordinates on a mesh; zero elsewhere.
    pub local: [f64; 2],
    /// What was hit; [`PrimitiveId::NONE`] for a distant source.
    pub primitive: PrimitiveId,
}

/// Stands for the material of all distant sources where surfaces are told apart.
pub const DISTANT: u32 = u32::MAX;

impl FirstHit {
    /// At a surface; `distance` as it is told, which may count pieces before.
    pub fn at(hit: &Intersection, distance: f64) -> FirstHit {
        FirstHit {
            distance,
            point: hit.point,
            normal: hit.front,
            perturbed_normal: hit.front,
            surface: hit.surface,
            material: hit.shader.0,
            local: hit.placed.map_or([0.0; 2], |placed| placed.uv),
            primitive: hit.primitive,
        }
    }

    /// At a distant source.
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

/// The name of the first material of a chain of modifiers; `void` for none.
pub(crate) fn material_name(scene: &Scene, modifier: Option<ModifierHandle>) -> &str {
    let material = scene.chain(modifier).find(|(_, modifier)| matches!(modifier.kind, ModifierKind::Material(_)));
    scene.original_name(material.map(|(handle, _)| handle))
}
