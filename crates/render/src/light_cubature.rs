//! Direct light by cubature: the points of a rule replace samples on small uniform lights.
//!
//! At the first surface of a camera ray, where light sampling alone finds the lights. A light that
//! may be partly hidden, and one that no rule integrates accurately, is sampled as always.

use crate::cubature_error::CubatureError;
use crate::direct::{DirectSampler, ReachingLight};
use crate::trace::PathIntegrator;
use radsight_bsdf::{Bsdf, PdfRequest};
use radsight_compile::{RenderPlan, VisibilityClass, given};
use radsight_light::Light;
use radsight_texture::{bands, product};

impl DirectSampler<'_> {
    /// The allowed error of rules at this point; `None` where lights are sampled.
    #[inline]
    pub(crate) fn light_cubature<const BANDS: usize>(
        &self,
        tracer: &PathIntegrator<'_, BANDS>,
        point: &Bsdf<'_, BANDS>,
    ) -> Option<CubatureError> {
        let allowed = tracer.light_cubature?;
        let is_alone = self.highlight_draws == 0 && !self.shares_diffuse && !self.drawn;
        let is_plain = tracer.tree.is_none() && tracer.contributions.is_none() && !tracer.plan.shadow_rays_interact;
        (is_alone && is_plain && point.is_smooth_lobe()).then_some(allowed)
    }

    /// The contribution of a light by cubature; `None` where it must be sampled.
    #[inline]
    pub(crate) fn integrate<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        point: &Bsdf<'_, BANDS>,
        lit: &ReachingLight<'_>,
        allowed: CubatureError,
    ) -> Option<[f64; BANDS]> {
        let light = lit.light;
        let radiance = uniform_radiance(tracer, light)?;
        let cubature = light.cubature(self.point, &self.reception.peak, allowed.0)?;
        let is_free = *lit.between == VisibilityClass::Nothing || self.sees_all_of(tracer.plan, light, lit.between);
        if !is_free {
            return None;
        }
        let scratch = &mut tracer.workspace.scratch;
        let mut scattered = [0.0; BANDS];
        cubature.for_each_node(|node| {
            let value = point.eval(node.direction, node.solid_angle.recip(), PdfRequest::Unused, scratch);
            let share = node.solid_angle * light.focal_factor(node.distance);
            for ((sum, diffuse), highlight) in scattered.iter_mut().zip(value.diffuse).zip(value.highlight) {
                *sum += share * (diffuse + highlight);
            }
        });
        Some(product(scattered, radiance))
    }
}

/// Whether all lights are disks of uniform radiance within their cones.
pub(crate) fn integrates_all_lights(plan: &RenderPlan) -> bool {
    let is_uniform = |light: &Light| light.is_plain_disk() && plan.shader(light.surface).textures.steps.is_empty();
    plan.light_tree.is_none() && plan.lights.iter().all(is_uniform)
}

/// The radiance of a light without pattern, in all directions of its cone.
#[inline]
fn uniform_radiance<const BANDS: usize>(tracer: &PathIntegrator<'_, BANDS>, light: &Light) -> Option<[f64; BANDS]> {
    let shader = tracer.plan.shader(light.surface);
    let emitter = shader.kind.emitter()?;
    shader.textures.steps.is_empty().then(|| given(bands(emitter.radiance)))
}
