//! Selects the shadow rays of a point by what its light samples would contribute.
//!
//! In a picture with few rays per pixel every light is sampled at every point, and most of the time
//! goes to shadow rays, many of them to lights that hardly matter there. Radiance tests lights in
//! the order of their contributions, and does not test the rest (`-dt`) once it is weak against what
//! arrived. Here a sample is strong if it contributes at least a share τ of the point's light S.
//! Strong samples keep their shadow rays. S is what arrives from the tested samples, and what the
//! others would contribute without shadows: where a strong light is hidden, S falls, and further
//! samples are strong.
//!
//! A weak sample keeps its shadow ray with the probability p = c/(τ S), and its weight becomes 1/p:
//! nothing is lost in the mean, since S is known before the first weak sample. They are selected
//! systematically along their cumulative contribution, so there are at most 1/τ of them, and
//! neighbouring lights are not missed together. The relative variance that this adds is at most τ
//! where the weak samples are not hidden.

use crate::direct::{DirectSampler, NumberedLight};
use crate::trace::PathIntegrator;
use crate::unshadowed_sample::UnshadowedSample;
use radsight_bsdf::Bsdf;
use radsight_compile::{LightDivision, VisibilityClass};
use radsight_light::LightSample;
use radsight_sampling::{DimensionSet, choose};
use radsight_texture::product;

/// Share of a point's unshadowed light below which a sample is weak, with the default threshold of
/// direct light (`-dt`).
const WEAK_SHARE: f64 = 0.02;

/// Number of points of which one is selected for each sample of a light with an emission profile. In
/// the fish-eye view of Radiance's render test `tfunc` without interreflection, 8 have half of the rms
/// error of one, and 16 take 1.5 times as long for little more.
const CANDIDATES: usize = 8;

/// Added to the radiance of an emission profile relative to its mean, for light where the table has
/// none.
const LEAST_RADIANCE: f64 = 0.02;

/// The step of a lattice in the unit interval: the golden ratio, less 1.
const GOLDEN_RATIO: f64 = 0.618_033_988_749_894_9;

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
        self.for_each_light(tracer, first_set, |tracer, numbered, between, u| {
            samples.extend(self.unshadowed_sample(tracer, point, numbered, between, u));
        });
        let sum = self.trace_strong(tracer, &samples);
        tracer.unshadowed = samples;
        sum
    }

    /// A sample of a light at a point of the unit square, without its shadow ray; `None` if it
    /// contributes nothing.
    #[inline]
    pub(crate) fn unshadowed_sample<'p, const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'p, BANDS>,
        point: &Bsdf<'_, BANDS>,
        numbered: &NumberedLight<'p>,
        between: &'p VisibilityClass,
        u: [f64; 2],
    ) -> Option<UnshadowedSample<'p, BANDS>> {
        let light = numbered.sampler.light();
        let (sample, weight) = if numbered.sampler.follows_profile() {
            self.selected_candidate(tracer, point, numbered, u)?
        } else {
            let sample = self.light_sample(tracer, &numbered.sampler, u)?;
            (sample, self.sample_weight(tracer, point, numbered, &sample)?)
        };
        let radiance = self.radiance(tracer, light, &sample);
        let strength = product(weight, radiance).iter().sum();
        (strength != 0.0).then_some(UnshadowedSample { light, between, sample, weight, radiance, strength })
    }

    /// The weight of a light sample's radiance; `None` if it is zero.
    #[inline]
    fn sample_weight<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        point: &Bsdf<'_, BANDS>,
        numbered: &NumberedLight<'_>,
        sample: &LightSample,
    ) -> Option<[f64; BANDS]> {
        let scratch = &mut tracer.workspace.scratch;
        let value = point.eval(sample.direction, sample.pdf, self.pdf_request(), scratch);
        self.weight(numbered.sampler.light(), sample, f64::from(numbered.samples), &value)
    }

    /// One of several samples of a light with an emission profile, selected in proportion to what it
    /// would contribute with the radiance of the profile, and its weight (Talbot, Cline and Egbert,
    /// "Importance Resampling for Global Illumination", EGSR 2005, Eq. 4). Only its radiance and its
    /// shadow are computed, which cost more than all candidates.
    fn selected_candidate<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        point: &Bsdf<'_, BANDS>,
        numbered: &NumberedLight<'_>,
        [u, v]: [f64; 2],
    ) -> Option<(LightSample, [f64; BANDS])> {
        let light = numbered.sampler.light();
        let (mut candidates, mut strengths, mut found) = ([None; CANDIDATES], [0.0; CANDIDATES], 0);
        for index in 0..CANDIDATES {
            let step = index as f64;
            let shifted = [u + step / CANDIDATES as f64, v + step * GOLDEN_RATIO].map(f64::fract);
            let Some((sample, relative_radiance)) = numbered.sampler.sample_by_profile(shifted) else { continue };
            if light.fraction_in_radius(self.point, sample.direction, sample.distance) <= 0.0 {
                continue;
            }
            let Some(weight) = self.sample_weight(tracer, point, numbered, &sample) else { continue };
            candidates[found] = Some((sample, weight));
            strengths[found] = weight.iter().sum::<f64>() * (relative_radiance + LEAST_RADIANCE);
            found += 1;
        }
        let choice = tracer.sampler.take(DimensionSet::render(tracer.next_set))[0];
        tracer.next_set += 1;
        let total: f64 = strengths[..found].iter().sum();
        let (selected, _) = choose(strengths[..found].iter().copied(), choice * total)?;
        let (sample, weight) = candidates[selected]?;
        let scale = total / (CANDIDATES as f64 * strengths[selected]);
        Some((sample, weight.map(|band| band * scale)))
    }

    /// What a sample contributes, after its shadow ray.
    #[inline]
    pub(crate) fn shadowed<'p, const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'p, BANDS>,
        sample: &UnshadowedSample<'p, BANDS>,
    ) -> [f64; BANDS] {
        let arriving = self.arriving(tracer, sample.light, &sample.sample, sample.between, sample.radiance);
        product(sample.weight, arriving)
    }

    fn trace_strong<'p, const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'p, BANDS>,
        samples: &[UnshadowedSample<'p, BANDS>],
    ) -> [f64; BANDS] {
        let weak_share = WEAK_SHARE * tracer.plan.options.direct_threshold.relative();
        let set = DimensionSet::render(tracer.next_set);
        tracer.next_set += 1;
        // What the tested samples gave, and the strengths of those that are not tested.
        let mut light: f64 = samples.iter().map(|sample| sample.strength).sum();
        let mut sum = [0.0; BANDS];
        // Samples that are at least so strong have been tested, once there was a pass.
        let mut limit = f64::INFINITY;
        let mut is_first = true;
        loop {
            // Where the light is not a number, each sample is strong.
            let step = (weak_share * light).max(0.0);
            if !is_first && step >= limit {
                break;
            }
            let mut tested = 0;
            for sample in samples {
                let is_weak = sample.strength < step && !sample.is_kept();
                let is_left = is_first || sample.strength < limit && !sample.is_kept();
                if is_weak || !is_left {
                    continue;
                }
                let given = self.shadowed(tracer, sample);
                light -= sample.strength - given.iter().sum::<f64>();
                add(&mut sum, 1.0, given);
                tested += 1;
            }
            limit = limit.min(step);
            is_first = false;
            if tested == 0 {
                break;
            }
            if !light.is_finite() {
                // Infinite strengths cannot be subtracted from a sum.
                let untested = samples.iter().filter(|sample| sample.strength < limit && !sample.is_kept());
                light = sum.iter().sum::<f64>() + untested.map(|sample| sample.strength).sum::<f64>();
            }
        }
        // The weak ones. The random number is taken when it is needed.
        let step = limit;
        let mut until_next = None;
        for sample in samples.iter().filter(|sample| sample.strength < limit && !sample.is_kept()) {
            let left = until_next.get_or_insert_with(|| step * tracer.sampler.take(set)[0]);
            *left -= sample.strength;
            if *left < 0.0 {
                *left += step;
                add(&mut sum, step / sample.strength, self.shadowed(tracer, sample));
            }
        }
        sum
    }
}

/// Adds bands that count with a weight.
fn add<const BANDS: usize>(sum: &mut [f64; BANDS], weight: f64, given: [f64; BANDS]) {
    sum.iter_mut().zip(given).for_each(|(sum, given)| *sum += weight * given);
}
