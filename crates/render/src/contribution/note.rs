//! Records the contributions to the current ray.

use super::{Contribution, DeferredContribution, Open};
use crate::trace::PathIntegrator;
use crate::trace::path_state::PathState;
use radsight_accel::Intersection;
use radsight_compile::{Shader, TrackedValue};
use radsight_texture::{BandValues, SurfaceInteraction};

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// Records that a ray hits a surface that does not emit.
    pub(crate) fn note_tracked_hit(&mut self, path: &PathState<BANDS>, hit: &Intersection, shader: &Shader) {
        let (Some(modifier), None) = (shader.tracked, shader.kind.emitter()) else { return };
        let interaction = SurfaceInteraction::at(&path.ray, hit, path.travelled + hit.distance);
        let (before, waiting) = (self.radiance, self.waiting());
        let Some(contributions) = &mut self.contributions else { return };
        match self.plan.options.tracked_value {
            TrackedValue::Share => contributions.add(shader, &interaction, path.throughput),
            TrackedValue::Radiance => contributions.open.push(Open { modifier, interaction, before, waiting }),
        }
    }

    /// Records that a ray hits an emitter where it does not emit. Coefficients count the hit all the
    /// same, as in Radiance.
    pub(crate) fn note_dark_emitter(
        &mut self,
        path: &PathState<BANDS>,
        shader: &Shader,
        interaction: &SurfaceInteraction,
    ) {
        if let Some(contributions) = &mut self.contributions
            && self.plan.options.tracked_value == TrackedValue::Share
        {
            contributions.add(shader, interaction, path.throughput);
        }
    }

    /// Passes the contributions to the last ray to `visit`.
    pub(crate) fn take_contributions(&mut self, visit: impl FnMut(Contribution)) {
        let Some(contributions) = &mut self.contributions else { return };
        // No ray is pending any more, including those before the first.
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
        let contribution = |deferred: DeferredContribution<BANDS>| Contribution {
            modifier: deferred.modifier as usize,
            value: values(deferred.value),
            interaction: deferred.interaction,
        };
        contributions.settled.drain(..).map(contribution).for_each(visit);
    }
}
