//! What a ray sees first, as outlines divide a picture.

use crate::panes::BehindPanes;
use crate::plan::RenderPlan;
use glam::DVec3;
use radsight_accel::{Intersection, Ray, ShaderId};
use radsight_ir::{ModifierHandle, ModifierKind, SurfaceHandle};
use radsight_texture::Step;

/// What outlines divide a picture into: a surface, or nothing, behind plain panes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutlinedSurface {
    /// A hash of the panes.
    panes: u64,
    surface: Option<OutlinedKind>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum OutlinedKind {
    /// A surface, with the index of its compiled material.
    Single(SurfaceHandle, ShaderId),
    /// Facets of a material whose normals a texture turns, as in smoothed meshes, and that face the
    /// same of six directions: there is hardly an outline between them.
    Facets(ModifierHandle, Facing),
}

/// A signed axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Facing {
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
    /// What a ray hits first; `None` behind too many panes.
    #[must_use]
    pub fn outlined_surface(&self, ray: &Ray) -> Option<OutlinedSurface> {
        let BehindPanes { panes, hit } = self.behind_panes(ray, |_, _| true)?;
        Some(OutlinedSurface { panes, surface: hit.map(|(hit, _)| self.outlined_kind(&hit)) })
    }

    fn outlined_kind(&self, hit: &Intersection) -> OutlinedKind {
        let single = OutlinedKind::Single(hit.surface, hit.shader);
        let shader = self.shader_at(hit.shader);
        if hit.instance.is_some() || !shader.textures.steps.iter().any(Step::is_texture) {
            return single;
        }
        let mut chain = self.scene.chain(shader.modifier);
        let material = chain.find(|(_, modifier)| matches!(modifier.kind, ModifierKind::Material(_)));
        material.map_or(single, |(handle, _)| OutlinedKind::Facets(handle, Facing::of(hit.front)))
    }
}
