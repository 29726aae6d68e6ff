//! Rays at surfaces on which others lie that let light through.

use crate::plan::RenderPlan;
use radsight_accel::{Crossing, MemberId, PrimitiveId, Ray, RayFrame};

/// With more veils than this a search for what is near is quicker than each of them.
const MANY: usize = 32;

impl RenderPlan {
    /// Whether a veil that lies on what a ray crosses is there for it instead.
    #[inline]
    pub fn is_veiled(&self, ray: &Ray, from: Option<PrimitiveId>, crossing: &Crossing) -> bool {
        !self.veils.is_empty() && self.is_under_veil(ray, from, crossing)
    }

    #[cold]
    fn is_under_veil(&self, ray: &Ray, from: Option<PrimitiveId>, crossing: &Crossing) -> bool {
        let (geometry, scene, frame) = (&self.geometry, &self.scene, RayFrame::new(ray));
        let (distance, tolerance) = (crossing.distance, geometry.tolerance());
        let is_there = |veil: &MemberId| {
            let met = geometry.intersect(scene, *veil, ray, &frame, from, distance + tolerance);
            met.is_some_and(|met| met.distance >= distance - tolerance)
        };
        (self.veils.len() > MANY || self.veils.iter().any(is_there))
            && geometry.chosen_near(scene, ray, from, distance) != Some(crossing.primitive)
    }
}
