//! Tests whether a veil replaces the surface that a ray crosses.

use crate::plan::RenderPlan;
use radsight_accel::{Crossing, MemberId, PrimitiveId, Ray, RayFrame};

/// With more veils than this, a search near the crossing is faster than testing each of them.
const MANY: usize = 32;

impl RenderPlan {
    /// Whether a ray hits a veil on the crossed surface instead of that surface.
    #[inline]
    pub fn is_veiled(&self, ray: &Ray, from: Option<PrimitiveId>, crossing: &Crossing) -> bool {
        !self.veils.is_empty() && self.is_under_veil(ray, from, crossing)
    }

    #[cold]
    fn is_under_veil(&self, ray: &Ray, from: Option<PrimitiveId>, crossing: &Crossing) -> bool {
        let (geometry, scene, frame) = (&self.geometry, &self.scene, RayFrame::new(ray));
        let (distance, tolerance) = (crossing.distance, geometry.tolerance());
        let is_there = |veil: &MemberId| {
            let hit = geometry.intersect(scene, *veil, ray, &frame, from, distance + tolerance);
            hit.is_some_and(|hit| hit.distance >= distance - tolerance)
        };
        (self.veils.len() > MANY || self.veils.iter().any(is_there))
            && geometry.chosen_near(scene, ray, from, distance) != Some(crossing.primitive)
    }
}
