//! Direct light of many lights as the difference from what neighbouring rays received.
//!
//! Most lights shine on neighbouring points alike. So what the records around a point suggest is a
//! control variate: the light of the point is their interpolated light, plus the differences of some
//! lights from theirs, each divided by the probability with which it is sampled. Lights whose records
//! differ are sampled always or often, the others in proportion to their strength. Any interpolation
//! and any probability above zero give an unbiased sum (control variates and importance sampling:
//! Owen and Zhou, JASA 2000); the better the interpolation, the less noise.
//!
//! Radiance instead stops to test shadows where the rest is weak (`-dt`), and assumes how much of
//! it is visible (`-dc`).

use crate::direct::{DirectSampler, DrawnSet, ReachingLight};
use crate::direct_record::{DirectRecorder, ExpectedLight, RecordedLight, RecordedPoint, SeldomSampled};
use crate::trace::PathIntegrator;
use radsight_bsdf::{Bsdf, Highlight};
use radsight_light::{Light, LobePeak};
use radsight_sampling::DimensionSet;
use std::f64::consts::FRAC_1_PI;

/// Share of a point's light up to which a light on which the records agree is sampled seldom, with
/// the default threshold of direct light (`-dt`), like the two thresholds below.
const AGREED_SHARE: f64 = 0.1;

/// Difference between the records of a light, relative to the light of all, above which the light is
/// sampled always.
const MOST_SPREAD: f64 = 0.02;

/// Minimum probability of sampling a light.
const LEAST_CHANCE: f64 = 1.0 / 16.0;

/// Probability of sampling a light that is dark at all records, as outside of its beam.
const DARK_CHANCE: f64 = 1.0 / 4.0;

/// A difference from the records is large above this fraction of what a light must give to be
/// sampled always.
const SURPRISE: f64 = 0.2;

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

/// Below what a light is sampled seldom at a point, and how seldom at most.
#[derive(Clone, Copy)]
struct Thresholds {
    /// Strength of a light, and difference between its records, W/(sr·m²) summed over the bands.
    agreed: f64,
    spread: f64,
    least_chance: f64,
    /// The same for lights that are dark at all records.
    dark_chance: f64,
}

impl Thresholds {
    /// For a point that probably receives so much light, with so many times the default threshold.
    fn new(level: f64, relative: f64) -> Option<Thresholds> {
        (relative > 0.0).then(|| Thresholds {
            agreed: AGREED_SHARE * relative * level,
            spread: MOST_SPREAD * relative * level,
            least_chance: LEAST_CHANCE / relative,
            dark_chance: (DARK_CHANCE / relative).max(LEAST_CHANCE),
        })
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
        let diffuse = std::array::from_fn(|band| point.diffuse.get(band).map_or(0.0, |diffuse| *diffuse as f32));
        let here = RecordedPoint { position: self.point, normal: self.normal, diffuse };
        let is_known = recorder.expect(&here, plan.lights.len()) && is_predictable(point);
        let relative = plan.options.direct_threshold.relative();
        // Records are expected of all lights; other rays need no more than what was asked for.
        if !is_known && !recorder.records() && relative > 1.0 {
            recorder.pass_point();
            return self.sample_strong(tracer, point, first_set);
        }
        let thresholds = if is_known { Thresholds::new(recorder.level(), relative) } else { None };
        let cone = HighlightCone::new(&self.reception.peak, point.diffuse.iter().copied().fold(0.0, f64::max));
        let set = DimensionSet::render(tracer.next_set);
        tracer.next_set += 1;
        let mut selection = Selection::new(tracer.sampler.take(set)[0]);
        let mut seldom = std::mem::take(&mut recorder.seldom);
        seldom.clear();
        let mut drawn = DrawnSet::none();
        let mut sum = [0.0; BANDS];
        for (index, light) in plan.lights.iter().enumerate() {
            let expected = &mut recorder.expected[index];
            let chance = thresholds.map_or(1.0, |thresholds| self.chance(light, expected, &thresholds, &cone));
            if chance < 1.0 {
                add(&mut sum, expected.mean.given.map(f64::from));
                seldom.push(selection.next(index, chance));
            } else {
                expected.mean = self.light_of(tracer, point, (index, light), (first_set, &mut drawn));
                add(&mut sum, expected.mean.given.map(f64::from));
            }
        }
        let mut sample = |seldom: &mut SeldomSampled| {
            let sampled =
                self.light_of(tracer, point, (seldom.index, &plan.lights[seldom.index]), (first_set, &mut drawn));
            let expected = std::mem::replace(&mut recorder.expected[seldom.index].mean, sampled);
            let [sampled, expected] = [sampled, expected].map(|light| light.given.map(f64::from));
            seldom.difference = std::array::from_fn(|band| sampled[band] - expected[band]);
        };
        let surprise = thresholds.map_or(0.0, |thresholds| SURPRISE * thresholds.agreed);
        seldom.iter_mut().filter(|seldom| seldom.is_selected).for_each(&mut sample);
        if seldom.iter().any(|seldom| seldom.exceeds(surprise)) {
            seldom.iter_mut().filter(|seldom| !seldom.is_selected).for_each(sample);
        }
        add(&mut sum, differences(&seldom, surprise));
        recorder.seldom = seldom;
        recorder.finish_point(here);
        sum
    }

    /// Probability of sampling a light.
    fn chance(&self, light: &Light, expected: &ExpectedLight, thresholds: &Thresholds, cone: &HighlightCone) -> f64 {
        if self.may_be_highlight(light, cone) {
            return 1.0;
        }
        if expected.strongest == 0.0 {
            return if self.is_below(light) { thresholds.least_chance } else { thresholds.dark_chance }.min(1.0);
        }
        let strength = f64::from(expected.strongest) / thresholds.agreed;
        let spread = f64::from(expected.spread()) / thresholds.spread;
        strength.max(spread).max(thresholds.least_chance).min(1.0)
    }

    /// Whether the highlight of the point may be on a light, so that records tell little of it.
    fn may_be_highlight(&self, light: &Light, cone: &HighlightCone) -> bool {
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

    /// Samples one light.
    fn light_of<'p, const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'p, BANDS>,
        point: &Bsdf<'_, BANDS>,
        (index, light): (usize, &'p Light),
        drawn: (u32, &mut DrawnSet),
    ) -> RecordedLight {
        let (mut sum, mut unshadowed) = ([0.0; BANDS], 0.0);
        let between = self.between(tracer.plan, index);
        if !self.may_receive(light, between) {
            return RecordedLight::default();
        }
        self.for_each_point(tracer, &ReachingLight { index, light, between }, drawn, |tracer, numbered, between, u| {
            let Some(sample) = self.unshadowed_sample(tracer, point, numbered, between, u) else { return };
            unshadowed += sample.strength;
            let given = self.shadowed(tracer, &sample);
            sum = std::array::from_fn(|band| sum[band] + given[band]);
        });
        let given = std::array::from_fn(|band| if band < BANDS { sum[band] as f32 } else { 0.0 });
        RecordedLight { given, unshadowed: unshadowed as f32 }
    }
}

/// Adds the bands that are traced.
fn add<const BANDS: usize>(sum: &mut [f64; BANDS], given: [f64; 3]) {
    sum.iter_mut().zip(given).for_each(|(sum, given)| *sum += given);
}

/// Systematic selection of lights: of lights whose probabilities add up to n, n are selected, or one
/// more or less.
struct Selection {
    /// Sum of the probabilities so far, and a random number, both without whole parts.
    cumulative: f64,
    offset: f64,
}

impl Selection {
    /// `u` is uniform from 0 to 1.
    fn new(u: f64) -> Selection {
        Selection { cumulative: 0.0, offset: u }
    }

    fn next(&mut self, index: usize, chance: f64) -> SeldomSampled {
        // Of sums below 2. `f64::fract` is a call of a function on processors without SSE 4.1.
        let without_whole = |sum: f64| if sum >= 1.0 { sum - 1.0 } else { sum };
        let start = self.cumulative;
        self.cumulative = without_whole(start + chance);
        let before = without_whole(start + self.offset);
        SeldomSampled { index, chance, start, is_selected: before + chance >= 1.0, difference: [0.0; 3] }
    }
}

/// The sum of the differences of lights from what was expected, estimated from the selected ones.
///
/// Lights with a large difference often occur together, as where all are hidden. Their sum counts
/// if one of them is selected, divided by the probability of that; others count one by one.
fn differences(lights: &[SeldomSampled], surprise: f64) -> [f64; 3] {
    let is_surprised = lights.iter().any(|light| light.is_selected && light.exceeds(surprise));
    let together = if is_surprised { chance_of_any(lights, surprise) } else { 1.0 };
    let mut sum = [0.0; 3];
    for light in lights {
        let chance = match (light.exceeds(surprise), light.is_selected) {
            (true, _) => together,
            (false, true) => light.chance,
            (false, false) => continue,
        };
        sum = std::array::from_fn(|band| sum[band] + light.difference[band] / chance);
    }
    sum
}

/// Probability that any light with a large difference is selected: the length of the union of the
/// offsets that select them.
fn chance_of_any(lights: &[SeldomSampled], surprise: f64) -> f64 {
    let mut offsets: Vec<[f64; 2]> = Vec::new();
    for light in lights.iter().filter(|light| light.exceeds(surprise)) {
        let end = 1.0 - light.start;
        let start = end - light.chance;
        offsets.push([start.max(0.0), end]);
        if start < 0.0 {
            offsets.push([1.0 + start, 1.0]);
        }
    }
    offsets.sort_unstable_by(|one, other| one[0].total_cmp(&other[0]));
    let (mut covered, mut reached) = (0.0, 0.0_f64);
    for [start, end] in offsets {
        covered += (end - start.max(reached)).max(0.0);
        reached = reached.max(end);
    }
    covered
}

/// A light is far below a point if the sine of its angle below the tangent plane exceeds this.
const BELOW: f64 = 0.2;

/// Whether light scattered by a point is as at points around it, except in a known highlight.
fn is_predictable<const BANDS: usize>(point: &Bsdf<'_, BANDS>) -> bool {
    let is_known = matches!(point.highlight, Highlight::None | Highlight::Ward(_) | Highlight::WardAnisotropic(_));
    is_known && point.transmission.is_none_or(|transmission| transmission.lobe.is_none())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What lights give beyond what was expected: nothing, alike, or far more than others.
    const DIFFERENCES: [&[f64]; 4] = [
        &[0.0, 0.0, 0.3, 0.0, -0.2],
        &[-1.0, -1.0, -1.0, -1.0, -1.0, -1.0],
        &[0.1, 5.0, -0.1, 0.2, 0.0, -3.0, 0.05, 4.0],
        &[0.01, -0.02, 0.03, 0.01],
    ];
    const SURPRISE: f64 = 0.5;
    const OFFSETS: usize = 20_000;

    /// What the lights give if they are sampled like those of a point.
    fn estimate(all: &[f64], u: f64) -> f64 {
        let mut selection = Selection::new(u);
        let chance = |index: usize| [0.0625, 0.4, 0.17, 0.9][index % 4];
        let mut lights: Vec<SeldomSampled> = (0..all.len()).map(|index| selection.next(index, chance(index))).collect();
        let sample = |light: &mut SeldomSampled| light.difference = [all[light.index]; 3];
        lights.iter_mut().filter(|light| light.is_selected).for_each(sample);
        if lights.iter().any(|light| light.exceeds(SURPRISE)) {
            lights.iter_mut().for_each(sample);
        }
        differences(&lights, SURPRISE)[1]
    }

    #[test]
    fn the_mean_of_differences_over_all_offsets_is_their_sum() {
        for all in DIFFERENCES {
            let offsets = (0..OFFSETS).map(|offset| (offset as f64 + 0.5) / OFFSETS as f64);
            let mean = offsets.map(|u| estimate(all, u)).sum::<f64>() / OFFSETS as f64;
            let sum: f64 = all.iter().sum();
            assert!((mean - sum).abs() < 2e-3 * all.iter().map(|one| one.abs()).sum::<f64>(), "{mean}, not {sum}");
        }
    }

    #[test]
    fn a_shadow_of_many_lights_is_certain() {
        let values: Vec<f64> = (0..100).map(|offset| estimate(DIFFERENCES[1], f64::from(offset) / 100.0)).collect();
        assert!(values.iter().all(|value| (value + 6.0).abs() < 1e-9), "{values:?}");
    }

    #[test]
    fn highlights_reach_as_far_as_they_are_notable() {
        let peak = LobePeak { axis: glam::DVec3::Z, width: 50.0, height: 2.0, floor: 0.0, ..LobePeak::NONE };
        let cone = HighlightCone::new(&peak, 0.5);
        let at_edge = peak.height * (-peak.width * cone.radius * cone.radius).exp();
        assert!((at_edge / (NOTABLE_HIGHLIGHT * 0.5 * FRAC_1_PI) - 1.0).abs() < 1e-9);
        assert_eq!(HighlightCone::new(&LobePeak::NONE, 0.5).radius, 0.0);
        assert!(HighlightCone::new(&peak, 0.0).radius.is_infinite());
    }
}
