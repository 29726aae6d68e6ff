//! Direct light of many lights as the difference from what neighbouring rays received.
//!
//! Most lights shine on neighbouring points alike. So what the records around a point
//! suggest is a control variate: the light of the point is their interpolated light, plus the
//! differences of some lights from theirs, each divided by the probability with which it is sampled. Lights whose records
//! differ are sampled always or often, the others in proportion to their strength. Any
//! interpolation and any probability above zero give an unbiased sum (control variates and importance sampling: Owen and
//! Zhou, JASA 2000); the better the
//! interpolation, the less noise.
//!
//! Radiance instead stops to test shadows where the rest is weak (`-dt`), and assumes how much of
//! it is visible (`-dc`).

use crate::direct::{DirectSampler, DrawnSet, ReachingLight};
use crate::direct_record::{DirectRecorder, ExpectedLight, RecordedLight, RecordedPoint};
use crate::trace::PathIntegrator;
use radsight_bsdf::{Bsdf, Highlight, PdfRequest};
use radsight_compile::VisibilityClass;
use radsight_light::{Light, LobePeak};
use radsight_sampling::DimensionSet;
use radsight_texture::product;
use std::f64::consts::FRAC_1_PI;

/// Share of a point's unshadowed light up to which a light on which the records agree is sampled
/// seldom.
const AGREED_SHARE: f64 = 0.15;

/// Difference between the records of a light, relative to the unshadowed light of all, above which
/// the light is sampled always.
const MOST_SPREAD: f64 = 0.02;

/// Minimum probability of sampling a light.
const LEAST_CHANCE: f64 = 1.0 / 16.0;

/// Lights are sampled always where a highlight exceeds this fraction of the diffuse component.
const NOTABLE_HIGHLIGHT: f64 = 0.1;

/// A direction is inside of a highlight up to this difference from its axis.
#[derive(Clone, Copy)]
struct HighlightCone {
    peak: LobePeak,
    /// Distance between unit vectors.
    radius: f64,
}

impl HighlightCone {
    fn new(peak: &LobePeak, diffuse: f64) -> HighlightCone {
        let least = NOTABLE_HIGHLIGHT * FRAC_1_PI * diffuse;
        let radius = if peak.width == 0.0 || peak.height <= least {
            0.0
        } else if least > 0.0 {
            ((peak.height / least).ln() / peak.width).sqrt()
        } else {
            f64::INFINITY
        };
        HighlightCone { peak: *peak, radius }
    }
}

impl DirectSampler<'_> {
    /// Radiance reflected and transmitted by the point from all lights, recorded by light.
    pub(crate) fn sample_and_record<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        point: &Bsdf<'_, BANDS>,
        first_set: u32,
        recorder: &mut DirectRecorder,
    ) -> [f64; BANDS] {
        let plan = tracer.plan;
        let diffuse = point.diffuse.iter().copied().fold(0.0, f64::max);
        let here = RecordedPoint { position: self.point, normal: self.normal, diffuse };
        let is_known = recorder.expect(&here, plan.lights.len()) && is_predictable(point);
        let cone = HighlightCone::new(&self.reception.peak, diffuse);
        let total: f64 = recorder.expected.iter().map(|expected| f64::from(expected.mean.unshadowed)).sum();
        let set = DimensionSet::render(tracer.next_set);
        tracer.next_set += 1;
        let mut cumulative = tracer.sampler.take(set)[0];
        let mut drawn = DrawnSet::none();
        let mut sum = [0.0; BANDS];
        recorder.begin_point(here, plan.lights.len());
        for (index, light) in plan.lights.iter().enumerate() {
            let (chance, mean) = if is_known && total > 0.0 {
                let expected = &recorder.expected[index];
                (self.chance(light, expected, total, &cone), expected.mean)
            } else {
                (1.0, RecordedLight::default())
            };
            let given: [f64; BANDS] = std::array::from_fn(|band| f64::from(mean.given[band]));
            sum = std::array::from_fn(|band| sum[band] + given[band]);
            if chance < 1.0 {
                cumulative += chance;
                if cumulative < 1.0 {
                    recorder.add(mean);
                    continue;
                }
                cumulative -= 1.0;
            }
            let (sampled, unshadowed) = self.light_of(tracer, point, (index, light), (first_set, &mut drawn));
            sum = std::array::from_fn(|band| sum[band] + (sampled[band] - given[band]) / chance);
            let bands = std::array::from_fn(|band| sampled[band.min(BANDS - 1)] as f32);
            recorder.add(RecordedLight { given: bands, unshadowed: unshadowed as f32 });
        }
        sum
    }

    /// Probability of sampling a light.
    fn chance(&self, light: &Light, expected: &ExpectedLight, total: f64, cone: &HighlightCone) -> f64 {
        let strength = f64::from(expected.strongest) / (AGREED_SHARE * total);
        let spread = f64::from(expected.spread()) / (MOST_SPREAD * total);
        let chance = strength.max(spread).max(LEAST_CHANCE);
        if chance >= 1.0 || self.is_uncertain(light, expected, cone) { 1.0 } else { chance }
    }

    /// Whether records tell little of a light: it was nowhere seen, but may be, or the highlight of
    /// the point may be on it.
    fn is_uncertain(&self, light: &Light, expected: &ExpectedLight, cone: &HighlightCone) -> bool {
        if expected.strongest == 0.0 {
            return !self.is_below(light);
        }
        if cone.radius == 0.0 {
            return false;
        }
        let offset = light.center - self.point;
        let distance = offset.length();
        let outside = light.radius < distance && {
            let apart = (offset / distance).distance(cone.peak.axis);
            apart > cone.radius + light.radius / distance
        };
        !outside
    }

    /// Whether a light is far below the tangent plane.
    fn is_below(&self, light: &Light) -> bool {
        let offset = light.center - self.point;
        light.radius.is_finite() && self.normal.dot(offset) < -BELOW * offset.length() - light.radius
    }

    /// Radiance that the point scatters from one light, and what it would be without shadows, summed
    /// over the bands.
    fn light_of<'p, const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'p, BANDS>,
        point: &Bsdf<'_, BANDS>,
        (index, light): (usize, &'p Light),
        drawn: (u32, &mut DrawnSet),
    ) -> ([f64; BANDS], f64) {
        let (mut sum, mut unshadowed) = ([0.0; BANDS], 0.0);
        let between = self.between(tracer.plan, index);
        if *between == VisibilityClass::Dark || light.misses(self.point) || self.faces_away(light) {
            return (sum, unshadowed);
        }
        let pdfs =
            if self.highlight_draws > 0 || self.shares_diffuse { PdfRequest::Wanted } else { PdfRequest::Unused };
        self.for_each_point(tracer, &ReachingLight { index, light, between }, drawn, |tracer, numbered, between, u| {
            let Some(sample) = self.light_sample(tracer, light, u) else { return };
            let value = point.eval(sample.direction, sample.pdf, pdfs, &mut tracer.workspace.scratch);
            let expected = f64::from(numbered.samples);
            let Some([weight, radiance]) = self.unshadowed(tracer, light, &sample, expected, &value) else { return };
            unshadowed += product(weight, radiance).iter().sum::<f64>();
            let given = product(weight, self.arriving(tracer, light, &sample, between, radiance));
            sum = std::array::from_fn(|band| sum[band] + given[band]);
        });
        (sum, unshadowed)
    }
}

/// A light is far below a point if the sine of its angle below the tangent plane exceeds this.
const BELOW: f64 = 0.2;

/// Whether light scattered by a point is as at points around it, except in a known highlight.
fn is_predictable<const BANDS: usize>(point: &Bsdf<'_, BANDS>) -> bool {
    let is_known = match point.highlight {
        Highlight::Function(_) | Highlight::Measured(_) | Highlight::Model(_) => false,
        Highlight::None | Highlight::Ward(_) | Highlight::WardAnisotropic(_) => true,
        Highlight::Ashikhmin(_) | Highlight::Retro(_) => false,
    };
    is_known && point.transmission.is_none_or(|transmission| transmission.lobe.is_none())
}
