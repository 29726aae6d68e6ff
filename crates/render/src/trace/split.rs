//! Path splitting: into how many rays a ray splits at a surface.
//!
//! A ray whose value counts by itself (`Uncached::Split`) is not the mean of many paths from its
//! beginning: it splits where light is scattered. What lies before is followed once, and the
//! branches are spread evenly over the hemisphere.
//!
//! How many there are follows the meaning of Radiance's options (`samp_hemi` in `ambcomp.c`). With
//! the weight w of the ray, the share of it that the surface scatters ρ, and the least weight l
//! (`-lw`), the diffuse component gets
//!
//! n = round(√(a·min(w, 0.8 ρ w / (a l))))², a = `-ad`,
//!
//! so that no branch begins below the least weight; where irradiance is shared (`-aa` above 0) the
//! second bound does not hold, and n is 64 at least at the first diffuse surface. Super-samples
//! (`-as`) add s·w rays where that is 4√n or more. Each branch weighs ρ w / n: it splits no further
//! unless a is much larger than n, and below the least weight it goes on by Russian roulette.
//!
//! Radiance looks into a highlight along one ray (`-ss`), which itself splits into a·ρ rays at the
//! next surface. Here it is √(a ρ) rays, which split into as many each: about as much work, without
//! the noise of a single direction. What the irradiance cache gives it costs nothing more, so that
//! one ray is left there.

use super::PathIntegrator;
use super::path_state::PathState;
use radsight_bsdf::Bsdf;
use radsight_compile::{LightDivision, Quantity, RenderOptions};
use radsight_light::LightSampleCount;
use radsight_sampling::{DimensionSet, RaySampler};
use std::f64::consts::FRAC_1_PI;

/// A branch of a ray begins with so many times the least weight, or more.
const MARGIN: f64 = 0.8;

/// The square root of the least number of rays from which irradiance is shared.
const LEAST_SIDE: f64 = 8.0;

/// Into how many rays a ray splits at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Branches {
    pub(super) diffuse: u32,
    pub(super) highlight: u32,
}

/// The share of many branches that is sent towards openings: these find what is bright there, the
/// others the rest.
const OUTWARD_SHARE: f64 = 0.125;

impl Branches {
    /// Sets of points that a ray takes for branches: one for those into the highlight, and two for
    /// the others.
    pub(super) const SETS: u32 = 3;

    /// How many of the rays into the highlight count where they share the work with places on
    /// lights.
    ///
    /// Branches count as one. By the balance heuristic many rays would take a share of a small
    /// light that they hardly ever find, which is noise in what light sampling knows well.
    pub(super) fn shared_highlight(self, is_split: bool) -> u32 {
        if is_split { self.highlight.min(1) } else { self.highlight }
    }

    /// How many diffuse branches are sent towards openings, where any are seen.
    pub(super) fn outward(self) -> u32 {
        (OUTWARD_SHARE * f64::from(self.diffuse)).ceil() as u32
    }
}

/// Radiance halves a light until its pieces are no larger than a square, along each side alone, so
/// that they are about half as large. Places drawn at random have as much noise at the edges of
/// shadows with about two in a square.
const PLACES_IN_A_SQUARE: f64 = 2.0;

/// For so many branches another place is sampled on each light, up to so many.
const BRANCHES_FOR_A_PLACE: f64 = 32.0;
const MOST_PLACES_FOR_BRANCHES: f64 = 16.0;

/// A sensor samples few lights in more places than one, since it may stand where a light is half
/// hidden.
const FEW_LIGHTS: usize = 4;
const PLACES_ON_FEW_LIGHTS: f64 = 2.0;

/// A ray that splits, to be taken up again after its branches.
pub(super) struct SuspendedPath {
    sampler: RaySampler,
    set: DimensionSet,
    waiting: usize,
    media: usize,
    cuts: usize,
    open: usize,
}

/// How many rays a diffuse component gets of a ray of weight `weight`, of which it scatters the
/// share `reflectance`. `least_side` squared is the least number.
fn hemisphere_rays(options: &RenderOptions, weight: f64, reflectance: f64, least_side: f64) -> u32 {
    let gathering = &options.gathering;
    let divisions = f64::from(gathering.divisions);
    let wanted = if gathering.accuracy > 0.0 {
        divisions * weight
    } else {
        (divisions * weight).min(most_above_least_weight(options, weight * reflectance))
    };
    let side = wanted.sqrt().round().max(least_side);
    let super_samples = (f64::from(gathering.super_samples) * (wanted / divisions.max(1.0))).round();
    let is_worth_it = side > LEAST_SIDE && super_samples >= 4.0 * side;
    (side * side + if is_worth_it { super_samples } else { 0.0 }) as u32
}

/// How many rays can share a weight without any that begins below the least weight; infinite where
/// there is none.
fn most_above_least_weight(options: &RenderOptions, weight: f64) -> f64 {
    MARGIN * weight / options.least_weight.max(f64::MIN_POSITIVE)
}

fn mean<const BANDS: usize>(bands: &[f64; BANDS]) -> f64 {
    bands.iter().sum::<f64>() / BANDS as f64
}

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// The share of the first ray that this one carries, 1 at most.
    fn weight(&self, path: &PathState<BANDS>) -> f64 {
        let unit = if self.plan.options.quantity == Quantity::Radiance { 1.0 } else { FRAC_1_PI };
        (unit * path.pdf_ratio() * mean(&path.throughput)).min(1.0)
    }

    /// Into how many rays a ray splits; `asked` are those that rays get that do not split.
    pub(super) fn branches(&self, path: &PathState<BANDS>, point: &Bsdf<'_, BANDS>, asked: Branches) -> Branches {
        let options = &self.plan.options;
        let weight = self.weight(path);
        let shares = options.gathering.accuracy > 0.0;
        let diffuse = if asked.diffuse > 0 && !point.is_retroreflector() {
            let is_first = path.ambient_bounces == options.ambient_bounces;
            let least_side = if shares && is_first { LEAST_SIDE } else { 1.0 };
            hemisphere_rays(options, weight, mean(&point.ambient_reflectance()), least_side)
        } else {
            asked.diffuse
        };
        let highlight = if asked.highlight > 0 && path.ambient_bounces > 0 && !shares {
            let carried = weight * point.highlight_strength().min(1.0);
            let wanted = (f64::from(options.gathering.divisions) * carried).sqrt();
            (wanted.min(most_above_least_weight(options, carried)) as u32).max(asked.highlight)
        } else {
            asked.highlight
        };
        Branches { diffuse, highlight }
    }

    /// How many places on a light are sampled at a point: some in each of the squares whose side is
    /// the asked share of the distance (`-ds`), fewer for a ray of less weight. Each branch samples
    /// all lights again, so that some more here cost little beside them.
    ///
    /// Rays of radiance that do not split get one: who sends many averages them, and they draw what
    /// the rays of a picture would.
    pub(super) fn places(&self, path: &PathState<BANDS>, branches: Branches) -> LightSampleCount {
        let options = &self.plan.options;
        let is_sensor = options.quantity != Quantity::Radiance && path.mis.is_none();
        if options.light_division == LightDivision::BySize && path.mis.is_none() {
            let side = options.source_sampling;
            let per_sr = if side > 0.0 { 0.25 * self.weight(path) / (side * side) } else { 0.0 };
            return LightSampleCount { per_sr, least: 1.0 };
        }
        if !self.splits || !(is_sensor || branches.diffuse > 1) {
            return LightSampleCount::ONE;
        }
        let side = options.source_sampling;
        let per_sr = if side > 0.0 { PLACES_IN_A_SQUARE * self.weight(path) / (side * side) } else { 0.0 };
        let for_branches = (f64::from(branches.diffuse) / BRANCHES_FOR_A_PLACE).min(MOST_PLACES_FOR_BRANCHES).floor();
        let for_few = if is_sensor && self.plan.lights.len() <= FEW_LIGHTS { PLACES_ON_FEW_LIGHTS } else { 1.0 };
        LightSampleCount { per_sr, least: for_branches.max(for_few) }
    }

    /// Begins with the branches of the ray in hand, which take their points where it would take
    /// `set`.
    pub(super) fn split(&mut self, set: u32) -> SuspendedPath {
        SuspendedPath {
            sampler: self.sampler,
            set: DimensionSet::render(set),
            waiting: self.waiting.len(),
            media: self.media.len(),
            cuts: self.cuts.len(),
            open: self.contributions.as_ref().map_or(0, |contributions| contributions.open()),
        }
    }

    /// The first point of a branch.
    pub(super) fn begin_branch(&mut self, suspended: &SuspendedPath, branch: u32, branches: u32) -> [f64; 4] {
        self.sampler = suspended.sampler.branch(suspended.set, branch, branches);
        self.next_set = 1;
        self.sampler.take(DimensionSet::render(0))
    }

    /// Follows a branch to its end.
    pub(super) fn end_branch(&mut self, suspended: &SuspendedPath) {
        self.follow_until(suspended.waiting);
        if let Some(contributions) = &mut self.contributions {
            contributions.close_until(suspended.open, self.radiance);
        }
        self.media.truncate(suspended.media);
        self.cuts.truncate(suspended.cuts);
    }

    /// Goes on with the ray that has split.
    pub(super) fn end_split(&mut self, suspended: &SuspendedPath, next_set: u32) {
        self.sampler = suspended.sampler;
        self.next_set = next_set;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use radsight_compile::{Gathering, Uncached};

    fn options(divisions: u32, super_samples: u32, accuracy: f64, least_weight: f64) -> RenderOptions {
        let gathering =
            Gathering { divisions, super_samples, accuracy, uncached: Uncached::Split, ..Gathering::default() };
        RenderOptions { gathering, least_weight, ..RenderOptions::default() }
    }

    #[test]
    fn a_first_ray_splits_into_as_many_as_were_asked_for() {
        assert_eq!(hemisphere_rays(&options(1024, 0, 0.0, 1e-5), 1.0, 0.5, 1.0), 1024);
        assert_eq!(hemisphere_rays(&options(700, 0, 0.0, 3e-6), 1.0, 0.5, 1.0), 26 * 26);
    }

    #[test]
    fn no_branch_begins_below_the_least_weight() {
        for (least_weight, reflectance) in [(2e-3, 0.5), (1e-4, 0.2), (1e-2, 0.9)] {
            let rays = hemisphere_rays(&options(30_000, 0, 0.0, least_weight), 1.0, reflectance, 1.0);
            assert!(rays < 30_000 && reflectance / f64::from(rays) >= least_weight, "{rays} rays");
        }
    }

    #[test]
    fn a_branch_does_not_split_again() {
        let options = options(1024, 512, 0.0, 1e-6);
        assert_eq!(hemisphere_rays(&options, 0.7 / 1024.0, 0.7, 1.0), 1);
        assert_eq!(hemisphere_rays(&options, 0.25, 0.7, 1.0), 256 + 128);
    }

    #[test]
    fn super_samples_are_added_where_they_are_many() {
        assert_eq!(hemisphere_rays(&options(1024, 512, 0.0, 1e-6), 1.0, 0.7, 1.0), 1024 + 512);
        assert_eq!(hemisphere_rays(&options(1024, 100, 0.0, 1e-6), 1.0, 0.7, 1.0), 1024);
    }

    #[test]
    fn shared_irradiance_has_its_rays_whatever_the_weight() {
        assert_eq!(hemisphere_rays(&options(1024, 0, 0.1, 1e-2), 1.0, 0.1, LEAST_SIDE), 1024);
        assert_eq!(hemisphere_rays(&options(1024, 0, 0.1, 1e-2), 1e-3, 0.1, LEAST_SIDE), 64);
    }
}
