//! Random chains of mirrors and dielectrics towards lamps.
//!
//! A dielectric reflects with the probability of its Fresnel reflectance. Each solution costs one
//! search in the mean, whatever its light, so chains that carry little are continued by Russian
//! roulette.

use crate::specular_chain::SpecularEvent;
use crate::trace::PathIntegrator;
use glam::DVec3;
use radsight_accel::{PrimitiveId, Ray, is_flat};
use radsight_compile::{Kind, Shader};
use radsight_ir::Shape;

/// Probability of ending a chain early at each of its surfaces.
const STOP_PROBABILITY: f64 = 0.15;

/// Probability of transmission at a pane. Dielectrics have their transmittance instead, but no
/// event is rarer than `MIN_PROBABILITY`.
const TRANSMIT_PROBABILITY: f64 = 0.7;
const MIN_PROBABILITY: f64 = 0.1;

/// Maximum length of a chain.
const MAX_EVENTS: usize = 8;

/// Random numbers for decisions along a chain (SplitMix64).
pub(crate) struct ChainChoices(u64);

impl ChainChoices {
    pub(crate) fn new(u: f64) -> ChainChoices {
        ChainChoices(u.to_bits())
    }

    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ mixed >> 31) >> 11) as f64 / (1u64 << 53) as f64
    }
}

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// A chain of specular events from an initial direction; `None` if light sampling finds its
    /// paths.
    pub(crate) fn random_chain(
        &mut self,
        (origin, mut from): (DVec3, Option<PrimitiveId>),
        direction: DVec3,
        mut choices: ChainChoices,
    ) -> Option<Vec<SpecularEvent>> {
        let mut ray = Ray { origin, direction };
        let mut events = Vec::new();
        let mut is_caustic = false;
        while events.len() < MAX_EVENTS
            && let Some(hit) = self.next_visible(ray, from)
        {
            let shader = self.plan.shader_at(hit.shader);
            let transmittance = self.transmittance(&ray, &hit, shader).unwrap_or(TRANSMIT_PROBABILITY);
            let first = if choices.next() < transmittance.clamp(MIN_PROBABILITY, 1.0 - MIN_PROBABILITY) {
                SpecularEvent::Transmitted
            } else {
                SpecularEvent::Reflected
            };
            let step = self.specular_direction(&ray, &hit, shader, first).map(|direction| (first, direction));
            let other = first.other();
            let step =
                step.or_else(|| self.specular_direction(&ray, &hit, shader, other).map(|direction| (other, direction)));
            let Some((event, direction)) = step else { break };
            let shape = self.plan.scene.surfaces[hit.surface].shape;
            is_caustic |= !is_seen_by_light_sampling(shader, event, shape);
            events.push(event);
            ray = Ray { origin: hit.point, direction };
            from = Some(hit.primitive);
            if choices.next() < STOP_PROBABILITY {
                break;
            }
        }
        is_caustic.then_some(events)
    }

    /// Part of the light that the dielectrics of a chain let through or reflect; 0 if the ray does
    /// not take the chain.
    pub(crate) fn chain_throughput(
        &mut self,
        mut ray: Ray,
        mut from: Option<PrimitiveId>,
        events: &[SpecularEvent],
    ) -> f64 {
        let mut throughput = 1.0;
        for &event in events {
            let Some(hit) = self.next_visible(ray, from) else { return 0.0 };
            let shader = self.plan.shader_at(hit.shader);
            throughput *= match (self.transmittance(&ray, &hit, shader), event) {
                (Some(transmittance), SpecularEvent::Transmitted) => transmittance,
                (Some(transmittance), SpecularEvent::Reflected) => 1.0 - transmittance,
                (None, _) => 1.0,
            };
            let Some(direction) = self.specular_direction(&ray, &hit, shader, event) else { return 0.0 };
            ray = Ray { origin: hit.point, direction };
            from = Some(hit.primitive);
        }
        throughput
    }
}

/// Whether light sampling follows lights through this event: panes and flat mirrors.
fn is_seen_by_light_sampling(shader: &Shader, event: SpecularEvent, shape: Shape) -> bool {
    match shader.kind {
        Kind::Glass { .. } => event == SpecularEvent::Transmitted,
        Kind::Mirror { .. } => is_flat(shape),
        _ => false,
    }
}
