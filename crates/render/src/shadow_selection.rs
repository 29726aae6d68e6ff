//! Selects the shadow rays of a point by what its light samples would contribute.
//!
//! In a picture with few rays per pixel every light is sampled at every point, and most of the time
//! goes to shadow rays, many of them to lights that hardly matter there. Radiance tests lights in
//! the order of their contributions, and neglects the rest (`-dt`). Here a sample that contributes
//! less than a share τ of the unshadowed sum S keeps its shadow ray with the probability p =
//! c/(τ S), and its weight becomes 1/p: nothing is lost in the mean. Weak samples are selected
//! systematically along their cumulative contribution, so there are at most 1/τ of them, and
//! neighbouring lights are not missed together. The relative variance that this adds is at most τ.

use crate::direct::DirectSampler;
use crate::trace::PathIntegrator;
use crate::unshadowed_sample::UnshadowedSample;
use radsight_bsdf::{Bsdf, PdfRequest};
use radsight_compile::LightDivision;
use radsight_sampling::DimensionSet;
use radsight_texture::product;

/// Share of a point's unshadowed light below which a sample is weak.
const WEAK_SHARE: f64 = 0.02;

impl DirectSampler<'_> {
    /// Whether shadow rays may be selected: neighbouring pixels average the noise, and nobody asks
    /// for each ray.
    pub(crate) fn selects_shadow_rays<const BANDS: usize>(&self, tracer: &PathIntegrator<'_, BANDS>) -> bool {
        let is_divided = tracer.plan.options.light_division != LightDivision::Whole;
        is_divided && !self.drawn && tracer.tree.is_none() && tracer.contributions.is_none()
    }

    /// Radiance reflected and transmitted by the point from all lights, with fewer shadow rays to
    /// weak ones.
    pub(crate) fn sample_strong<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        point: &Bsdf<'_, BANDS>,
        first_set: u32,
    ) -> [f64; BANDS] {
        let mut samples = std::mem::take(&mut tracer.unshadowed);
        samples.clear();
        let pdfs =
            if self.highlight_draws > 0 || self.shares_diffuse { PdfRequest::Wanted } else { PdfRequest::Unused };
        self.for_each_light(tracer, first_set, |tracer, numbered, between, u| {
            let light = numbered.light;
            let Some(sample) = self.light_sample(tracer, light, u) else { return };
            let value = point.eval(sample.direction, sample.pdf, pdfs, &mut tracer.workspace.scratch);
            let expected = f64::from(numbered.samples);
            if let Some([weight, radiance]) = self.unshadowed(tracer, light, &sample, expected, &value) {
                let strength = product(weight, radiance).iter().sum();
                samples.push(UnshadowedSample { light, between, sample, weight, radiance, strength });
            }
        });
        let sum = self.trace_strong(tracer, &samples);
        tracer.unshadowed = samples;
        sum
    }

    fn trace_strong<'p, const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'p, BANDS>,
        samples: &[UnshadowedSample<'p, BANDS>],
    ) -> [f64; BANDS] {
        let step = WEAK_SHARE * samples.iter().map(|sample| sample.strength).sum::<f64>();
        let set = DimensionSet::render(tracer.next_set);
        tracer.next_set += 1;
        // Computed when needed.
        let mut until_next = None;
        let mut sum = [0.0; BANDS];
        for sample in samples {
            let mut scale = 1.0;
            if sample.strength < step && !sample.is_kept() {
                let left = until_next.get_or_insert_with(|| step * tracer.sampler.take(set)[0]);
                *left -= sample.strength;
                if *left >= 0.0 {
                    continue;
                }
                *left += step;
                scale = step / sample.strength;
            }
            let arriving = self.arriving(tracer, sample.light, &sample.sample, sample.between, sample.radiance);
            for (sum, given) in sum.iter_mut().zip(product(sample.weight, arriving)) {
                *sum += scale * given;
            }
        }
        sum
    }
}
