//! Plain panes: `glass` without patterns and textures, which a ray passes straight on.
//!
//! What a camera sees through a protective window is as sharp, as smooth and as far away as without
//! it.

use crate::plan::RenderPlan;
use crate::shader::{Kind, Shader};
use radsight_accel::{Intersection, MemberId, PrimitiveId, Ray};
use radsight_texture::reflect;

/// Maximum number of panes that a ray passes.
const MOST: u32 = 16;

/// Factor of the hash of the panes that a ray passes (Fibonacci hashing).
const HASH_FACTOR: u64 = 0x9e37_79b9_7f4a_7c15;

/// What a ray hits behind plain panes.
pub(crate) struct BehindPanes {
    /// A hash of the panes, 0 without any.
    pub(crate) panes: u64,
    /// The first other surface, and its distance from the origin of the ray.
    pub(crate) hit: Option<(Intersection, f64)>,
}

impl Shader {
    /// Whether it is that of a plain pane.
    pub(crate) fn is_plain_pane(&self) -> bool {
        matches!(self.kind, Kind::Glass { .. }) && self.textures.steps.is_empty()
    }
}

impl RenderPlan {
    /// Distance along a ray to the first surface that is not a plain pane, scene units; `None` if there
    /// is none at a finite distance.
    #[must_use]
    pub fn distance_behind_panes(&self, ray: &Ray) -> Option<f64> {
        if !self.has_panes {
            return self.distance(ray);
        }
        self.behind_panes(ray, |_, _| true)?.hit.map(|(_, distance)| distance)
    }

    /// Follows a ray through plain panes. `passes` is called with the ray and its intersection with each
    /// of them. `None` where it returns false, or behind too many panes.
    pub(crate) fn behind_panes(
        &self,
        ray: &Ray,
        mut passes: impl FnMut(&Ray, &Intersection) -> bool,
    ) -> Option<BehindPanes> {
        self.behind_panes_from(*ray, None, &mut passes)
    }

    fn behind_panes_from(
        &self,
        mut ray: Ray,
        mut from: Option<PrimitiveId>,
        passes: &mut dyn FnMut(&Ray, &Intersection) -> bool,
    ) -> Option<BehindPanes> {
        let (mut panes, mut passed) = (0_u64, 0.0);
        for _ in 0..MOST {
            let Some(hit) = self.first_hit(&ray, from) else { return Some(BehindPanes { panes, hit: None }) };
            passed += hit.distance;
            if !self.shader_at(hit.shader).is_plain_pane() {
                return Some(BehindPanes { panes, hit: Some((hit, passed)) });
            }
            if !passes(&ray, &hit) {
                return None;
            }
            panes = (panes.rotate_left(5) ^ (hit.primitive.0 + 1)).wrapping_mul(HASH_FACTOR);
            (ray.origin, from) = (hit.point, Some(hit.primitive));
        }
        None
    }

    /// Whether a pane that reflects a ray at an intersection shows nothing in it, or through other panes.
    pub(crate) fn reflects_nothing(&self, ray: &Ray, hit: &Intersection) -> bool {
        let reflected = Ray { origin: hit.point, direction: reflect(ray.direction, hit.front) };
        let behind = self.behind_panes_from(reflected, Some(hit.primitive), &mut |_, _| true);
        behind.is_some_and(|behind| behind.hit.is_none())
    }

    /// Whether a member is a plain pane.
    pub(crate) fn is_pane(&self, member: MemberId) -> bool {
        self.geometry.is_plain(member) && self.shader(self.geometry.surface_of(member)).is_plain_pane()
    }

    /// Whether a primitive is a plain pane that belongs to no mesh and no instance.
    pub(crate) fn is_pane_primitive(&self, primitive: PrimitiveId) -> bool {
        self.has_panes && primitive.0 < self.geometry.len() as u64 && self.is_pane(primitive.member())
    }
}
