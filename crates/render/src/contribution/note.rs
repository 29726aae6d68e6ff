//! Noting what the ray in hand owes.

use super::{Contribution, DeferredContribution, Open};
use crate::trace::PathIntegrator;
use crate::trace::path_state::PathState;
use radsight_accel::Intersection;
use radsight_compile::{Shader, TrackedValue};
use radsight_texture::{BandValues, SurfaceInteraction};

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// Notes that a ray has met a surface that emits nothing.
    pub(crate) fn note_met(&mut self, path: &PathState<BANDS>, hit: &Intersection, shader: &Shader) {
        let (Some(modifier), None) = (shader.tracked, shader.kind.emitter()) else { return };
        let interaction = SurfaceInteraction::at(&path.ray, hit, path.travelled + hit.distance);
        let (before, waiting) = (self.radiance, self.waiting());
        let Some(contributions) = &mut self.contributions else { return };
        match self.plan.options.tracked_value {
            TrackedValue::Share => contributions.add(shader, &interaction, path.throughput),
            TrackedValue::Radiance => contributions.open.push(Open { modifier, interaction, before, waiting }),
        }
    }

    /// Tells what the last ray owes.
    pub(crate) fn take_contributions(&mut self, visit: impl FnMut(Contribution)) {
        let Some(contributions) = &mut self.contributions else { return };
        // Nothing waits any more, not even what began before the first ray.
        contributions.open.iter_mut().for_each(|open| open.waiting += 1);
        contributions.close(self.radiance, 0);
        for deferred in &mut contributions.settled {
            self.plan.unbounded.bound(&mut deferred.value, self.first_hit.as_ref());
        }
        let layout = &self.plan.layout;
        let values = |value: [f64; BANDS]| {
            if BANDS > 3 {
                BandValues::new(layout.collect(&value))
            } else {
                BandValues::new((0..3).map(|band| value[band.min(BANDS - 1)]))
            }
        };
        let told = |deferred: DeferredContribution<BANDS>| Contribution {
            modifier: deferred.modifier as usize,
            value: values(deferred.value),
            interaction: deferred.interaction,
        };
        contributions.settled.drain(..).map(told).for_each(visit);
    }
}
