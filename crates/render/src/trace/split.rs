//! Path splitting: the number of rays into which a ray splits at a surface.
//!
//! A ray whose value is used by itself (`Uncached::Split`) is not the mean of many independent
//! paths: it splits at scattering surfaces. The path before is traced once, and the branches are
//! stratified over the hemisphere.
//!
//! Their number follows Radiance's options (`samp_hemi` in `ambcomp.c`). With the weight w of the
//! ray, the scattered fraction ρ, and the minimum weight l (`-lw`), the diffuse component gets
//!
//! n = round(√(a·min(w, 0.8 ρ w / (a l))))², a = `-ad`,
//!
//! so that no branch starts below the minimum weight. With an irradiance cache (`-aa` above 0) the
//! second bound does not apply, and n is at least 64 at the first diffuse surface. Super-samples
//! (`-as`) add s·w rays if that is at least 4√n. Each branch has the weight ρ w / n: it splits
//! further only if a is much larger than n, and below the minimum weight Russian roulette applies.
//!
//! Radiance samples a highlight by one ray (`-ss`), which itself splits into a·ρ rays at the next
//! surface. Here it is √(a ρ) rays, which split into as many each: about as much work, without the
//! noise of a single direction. Irradiance from the cache costs nothing more, so then there is one
//! ray.

use super::PathIntegrator;
use super::path_state::PathState;
use radsight_bsdf::Bsdf;
use radsight_compile::{LightDivision, Quantity, RenderOptions};
use radsight_light::LightSampleCount;
use radsight_sampling::{DimensionSet, RaySampler};
use std::f64::consts::FRAC_1_PI;

/// Factor of the minimum weight at which a branch starts.
const MARGIN: f64 = 0.8;

/// Square root of the minimum number of rays for cached irradiance.
const MIN_SIDE: f64 = 8.0;

/// The number of rays into which a ray splits at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Branches {
    pub(super) diffuse: u32,
    pub(super) highlight: u32,
}

/// Fraction of many branches towards portals: these find what is bright there, the others the rest.
const OUTWARD_SHARE: f64 = 0.125;

impl Branches {
    /// Sets of sample points for branches: one for the highlight, and two for the others.
    pub(super) const SETS: u32 = 3;

    /// Number of highlight rays in the balance heuristic with light sampling.
    ///
    /// Branches count as one. With many rays the heuristic would give weight to highlight rays for
    /// a small light that they hardly ever hit, which adds noise to light sampling.
    pub(super) fn shared_highlight(self) -> u32 {
        self.highlight.min(1)
    }

    /// Number of diffuse branches towards portals, if any are visible.
    pub(super) fn outward(self) -> u32 {
        (OUTWARD_SHARE * f64::from(self.diffuse)).ceil() as u32
    }
}

/// Samples per square of Radiance's light subdivision. Radiance halves a light until its pieces are
/// no larger than a square, along each side separately, so they have about half its area. Random
/// points have as much noise in penumbrae with about two per square.
const SAMPLES_PER_SQUARE: f64 = 2.0;

/// Samples of a light per solid angle of the narrow lobe that reflects it.
const SAMPLES_PER_LOBE: f64 = 4.0;

/// Number of branches per additional sample of each light, and the maximum.
const BRANCHES_PER_SAMPLE: f64 = 32.0;
const MAX_SAMPLES_FOR_BRANCHES: f64 = 16.0;

/// A sensor takes several samples of few lights, since it may be in their penumbra. If its
/// irradiance is gathered for few points, it takes one for this many of the requested rays, as many
/// as for branches at most.
const FEW_LIGHTS: usize = 4;
const SAMPLES_OF_FEW_LIGHTS: f64 = 2.0;
const GATHERED_RAYS_PER_SAMPLE: f64 = 64.0;

/// The state of a ray that splits, restored after its branches.
pub(super) struct SuspendedPath {
    sampler: RaySampler,
    set: DimensionSet,
    waiting: usize,
    media: usize,
    cuts: usize,
    open: usize,
}

/// Number of rays of a diffuse component of a ray with weight `weight`, of which it scatters
/// `reflectance`. `least_side` squared is the minimum.
fn hemisphere_rays(options: &RenderOptions, weight: f64, reflectance: f64, least_side: f64) -> u32 {
    let gathering = &options.gathering;
    let divisions = f64::from(gathering.divisions);
    let rays = if gathering.accuracy > 0.0 {
        divisions * weight
    } else {
        (divisions * weight).min(most_above_least_weight(options, weight * reflectance))
    };
    let side = rays.sqrt().round().max(least_side);
    let super_samples = (f64::from(gathering.super_samples) * (rays / divisions.max(1.0))).round();
    let is_worth_it = side > MIN_SIDE && super_samples >= 4.0 * side;
    (side * side + if is_worth_it { super_samples } else { 0.0 }) as u32
}

/// Maximum number of rays that share a weight without falling below the minimum weight; infinite
/// without one.
fn most_above_least_weight(options: &RenderOptions, weight: f64) -> f64 {
    MARGIN * weight / options.least_weight.max(f64::MIN_POSITIVE)
}

fn mean<const BANDS: usize>(bands: &[f64; BANDS]) -> f64 {
    bands.iter().sum::<f64>() / BANDS as f64
}

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// The weight of this ray relative to the first, at most 1.
    fn weight(&self, path: &PathState<BANDS>) -> f64 {
        let unit = if self.plan.options.quantity == Quantity::Radiance { 1.0 } else { FRAC_1_PI };
        (unit * path.pdf_ratio() * mean(&path.throughput).abs()).min(1.0)
    }

    /// The number of rays into which a ray splits; `requested` is the number without splitting.
    pub(super) fn branches(&self, path: &PathState<BANDS>, point: &Bsdf<'_, BANDS>, requested: Branches) -> Branches {
        let options = &self.plan.options;
        let weight = self.weight(path);
        let shares = options.gathering.accuracy > 0.0;
        let diffuse = if requested.diffuse > 0 && !point.is_retroreflector() {
            let is_first = path.ambient_bounces == options.ambient_bounces;
            let least_side = if shares && is_first { MIN_SIDE } else { 1.0 };
            hemisphere_rays(options, weight, mean(&point.ambient_reflectance()), least_side)
        } else {
            requested.diffuse
        };
        let highlight = if requested.highlight > 0 && path.ambient_bounces > 0 && !shares {
            let carried = weight * point.highlight_strength().min(1.0);
            let rays = (f64::from(options.gathering.divisions) * carried).sqrt();
            (rays.min(most_above_least_weight(options, carried)) as u32).max(requested.highlight)
        } else {
            requested.highlight
        };
        Branches { diffuse, highlight }
    }

    /// Number of samples of a light at a point: some in each of the squares whose side is the
    /// requested fraction of the distance (`-ds`), fewer for a ray of less weight. Each branch
    /// samples all lights again, so some more here cost little.
    ///
    /// Rays whose mean is wanted get one sample, as scattered rays do that split no further.
    pub(super) fn light_samples(
        &self,
        path: &PathState<BANDS>,
        point: &Bsdf<'_, BANDS>,
        branches: Branches,
    ) -> LightSampleCount {
        let options = &self.plan.options;
        let is_sensor = options.quantity != Quantity::Radiance && path.mis.is_none();
        if let (LightDivision::BySize(density) | LightDivision::Shared(density), None) =
            (options.light_division, &path.mis)
        {
            let side = options.source_sampling;
            let squares = if side > 0.0 { self.weight(path) / (side * side) } else { 0.0 };
            let per_lobe = if point.has_highlight() { 0.0 } else { SAMPLES_PER_LOBE };
            return LightSampleCount {
                per_sr: density * squares,
                least: 1.0,
                per_lobe,
                most_per_sr: SAMPLES_PER_SQUARE * squares,
            };
        }
        if !self.splits || path.is_scattered() && branches.diffuse <= 1 {
            return LightSampleCount::ONE;
        }
        let side = options.source_sampling;
        let per_sr = if side > 0.0 { SAMPLES_PER_SQUARE * self.weight(path) / (side * side) } else { 0.0 };
        let for_branches = (f64::from(branches.diffuse) / BRANCHES_PER_SAMPLE).min(MAX_SAMPLES_FOR_BRANCHES).floor();
        let for_few =
            if is_sensor && self.plan.lights.len() <= FEW_LIGHTS { self.samples_of_few_lights() } else { 1.0 };
        LightSampleCount { per_sr, least: for_branches.max(for_few), ..LightSampleCount::ONE }
    }

    /// Number of samples of each of few lights for a sensor.
    fn samples_of_few_lights(&self) -> f64 {
        let gathering = &self.plan.options.gathering;
        let is_gathered = gathering.bounded && gathering.accuracy > 0.0 && self.plan.options.ambient_bounces > 0;
        let for_gathered = if is_gathered { gathering.rays() as f64 / GATHERED_RAYS_PER_SAMPLE } else { 0.0 };
        for_gathered.floor().clamp(SAMPLES_OF_FEW_LIGHTS, MAX_SAMPLES_FOR_BRANCHES)
    }

    /// Begins the branches of the current ray, which take their sample points instead of its `set`.
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

    /// The first sample point of a branch.
    pub(super) fn begin_branch(&mut self, suspended: &SuspendedPath, branch: u32, branches: u32) -> [f64; 4] {
        self.sampler = suspended.sampler.branch(suspended.set, branch, branches);
        self.next_set = 1;
        self.sampler.take(DimensionSet::render(0))
    }

    /// Traces a branch to its end.
    pub(super) fn end_branch(&mut self, suspended: &SuspendedPath) {
        self.follow_until(suspended.waiting);
        if let Some(contributions) = &mut self.contributions {
            contributions.close_until(suspended.open, self.radiance);
        }
        self.media.truncate(suspended.media);
        self.cuts.truncate(suspended.cuts);
    }

    /// Continues with the ray that was split.
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
        assert_eq!(hemisphere_rays(&options(1024, 0, 0.1, 1e-2), 1.0, 0.1, MIN_SIDE), 1024);
        assert_eq!(hemisphere_rays(&options(1024, 0, 0.1, 1e-2), 1e-3, 0.1, MIN_SIDE), 64);
    }
}
