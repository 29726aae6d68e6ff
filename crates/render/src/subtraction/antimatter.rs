//! The effect of antimatter on the current ray.

use super::{AntimatterEvent, Subtraction, SubtractionId};
use crate::trace::PathIntegrator;
use glam::DVec3;
use radsight_accel::Intersection;
use radsight_compile::Kind;

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// Whether a surface exists for a ray with this subtraction. Where antimatter shows its own
    /// surface, the hit gets the material there.
    pub(crate) fn resolve(&mut self, cut: SubtractionId, direction: DVec3, hit: &mut Intersection) -> AntimatterEvent {
        let plan = self.plan;
        let behind = direction.dot(hit.front) > 0.0;
        let before = &self.cuts[cut.0 as usize];
        let is_gone = before.gone.binary_search(&hit.shader).is_ok();
        let mut beyond = before.clone();
        if plan.cut_shaders.binary_search(&hit.shader).is_ok() {
            beyond.pass(hit.shader, if behind { -1 } else { 1 });
        }
        let antimatter = match &plan.shader_at(hit.shader).kind {
            Kind::Antimatter(antimatter) if !is_gone => antimatter,
            _ if is_gone => return AntimatterEvent::Nothing(self.add_subtraction(beyond)),
            _ => return AntimatterEvent::Surface(self.add_subtraction(beyond)),
        };
        if behind {
            beyond.gone.retain(|shader| antimatter.cuts.binary_search(shader).is_err());
        } else {
            antimatter.cuts.iter().for_each(|shader| beyond.add(*shader));
        }
        match antimatter.shade {
            Some(shade) if before.is_within_any(&antimatter.cuts) => {
                hit.shader = shade;
                hit.front = -hit.front;
                if let Some(instance) = &mut hit.instance {
                    instance.perturbation = -instance.perturbation;
                }
                AntimatterEvent::Surface(self.add_subtraction(beyond))
            }
            _ => AntimatterEvent::Nothing(self.add_subtraction(beyond)),
        }
    }

    pub(crate) fn cut(&self, id: SubtractionId) -> &Subtraction {
        &self.cuts[id.0 as usize]
    }

    pub(crate) fn add_subtraction(&mut self, cut: Subtraction) -> SubtractionId {
        let known = self.cuts.iter().position(|known| *known == cut);
        let index = known.unwrap_or_else(|| {
            self.cuts.push(cut);
            self.cuts.len() - 1
        });
        SubtractionId(index as u32)
    }
}
