//! First hits of rays, without shading.

use crate::plan::RenderPlan;
use glam::DVec3;
use radsight_accel::{Intersection, PrimitiveId, Ray, ShaderId};
use radsight_ir::{ModifierHandle, ModifierKind, Scene, SurfaceHandle};
use radsight_texture::Step;

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

/// What outlines divide a picture into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutlinedSurface {
    /// A surface, with the index of its compiled material.
    Single(SurfaceHandle, ShaderId),
    /// Facets of a material whose normals a texture turns, as in smoothed meshes, and that face the
    /// same of six directions: there is hardly an outline between them.
    Facets(ModifierHandle, Facing),
}

/// A signed axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Facing {
    axis: usize,
    is_negative: bool,
}

impl Facing {
    /// The one nearest to a direction.
    fn of(direction: DVec3) -> Facing {
        let axis = direction.abs().max_position();
        Facing { axis, is_negative: direction[axis] < 0.0 }
    }
}

impl RenderPlan {
    /// What a ray hits first.
    #[must_use]
    pub fn outlined_surface(&self, ray: &Ray) -> Option<OutlinedSurface> {
        let hit = self.first_hit(ray, None)?;
        let single = OutlinedSurface::Single(hit.surface, hit.shader);
        let shader = self.shader_at(hit.shader);
        if hit.instance.is_some() || !shader.textures.steps.iter().any(Step::is_texture) {
            return Some(single);
        }
        let mut chain = self.scene.chain(shader.modifier);
        let material = chain.find(|(_, modifier)| matches!(modifier.kind, ModifierKind::Material(_)));
        Some(material.map_or(single, |(handle, _)| OutlinedSurface::Facets(handle, Facing::of(hit.front))))
    }
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

/// Name of the first material of a modifier chain; `void` for none.
pub(crate) fn material_name(scene: &Scene, modifier: Option<ModifierHandle>) -> &str {
    let material = scene.chain(modifier).find(|(_, modifier)| matches!(modifier.kind, ModifierKind::Material(_)));
    scene.original_name(material.map(|(handle, _)| handle))
}
