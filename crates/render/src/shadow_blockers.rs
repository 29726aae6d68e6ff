//! The surfaces that blocked the last shadow rays, by target.
//!
//! Neighbouring points are often in the shadow of the same surface. Testing that surface first
//! leaves out the search of the hierarchy where it blocks the ray again. Only opaque surfaces are
//! remembered, so the result is that of the search.

use radsight_accel::{Crossing, MemberId, PrimitiveId, Ray, RayFrame};
use radsight_compile::RenderPlan;

/// Number of targets that are told apart; others share a place.
const PLACES: usize = 32;

/// The last blocker of each target.
#[derive(Debug, Default)]
pub(crate) struct ShadowBlockers {
    of_target: [Option<MemberId>; PLACES],
}

impl ShadowBlockers {
    fn place(target: PrimitiveId) -> usize {
        target.0 as usize % PLACES
    }

    /// Whether the last blocker of a target blocks this ray before `end` as well.
    #[inline]
    pub(crate) fn block_again(
        &self,
        plan: &RenderPlan,
        (ray, from): (&Ray, Option<PrimitiveId>),
        end: f64,
        target: PrimitiveId,
    ) -> bool {
        let Some(member) = self.of_target[ShadowBlockers::place(target)] else { return false };
        let blocks = |crossing: Crossing| crossing.primitive != target && !plan.is_veiled(ray, from, &crossing);
        plan.geometry.any_of_member(&plan.scene, member, (ray, &RayFrame::new(ray)), from, end, blocks)
    }

    /// The last blocker of a target.
    #[inline]
    pub(crate) fn last(&self, target: PrimitiveId) -> Option<MemberId> {
        self.of_target[ShadowBlockers::place(target)]
    }

    /// Remembers what blocked a ray to a target; `None` if nothing did, or it is not opaque.
    #[inline]
    pub(crate) fn note(&mut self, target: PrimitiveId, blocker: Option<MemberId>) {
        self.of_target[ShadowBlockers::place(target)] = blocker;
    }
}

/// The surface of a primitive, if it blocks every shadow ray that crosses it.
#[inline]
pub(crate) fn opaque_member(plan: &RenderPlan, primitive: PrimitiveId) -> Option<MemberId> {
    let member = (primitive.0 < plan.geometry.len() as u64).then(|| primitive.member())?;
    let is_opaque = || !plan.shader(plan.geometry.surface_of(member)).passes_shadow_rays();
    (plan.geometry.is_plain(member) && is_opaque()).then_some(member)
}
