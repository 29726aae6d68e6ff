//! Learns the path guide before a picture: random paths find bright patches, then the contribution
//! of each patch to each region.

use crate::cache_point_search::{of_camera_rays, scattered};
use crate::cache_query::{CachePoint, PointSearch};
use crate::caching::gathering_limits;
use crate::path_guide::PathGuide;
use crate::path_guide::patches::{BrightPoint, MAX_PATCHES, patches};
use crate::path_guide::regions::{RegionStatistics, Regions};
use crate::ray_spacing::RaySpacing;
use crate::trace::PathIntegrator;
use glam::DVec3;
use radsight_accel::Ray;
use radsight_compile::{MOST_PORTALS, Portals, RenderPlan};
use radsight_irradiance_cache::{Cache, Record};
use radsight_sampling::{DimensionSet, RaySampler, cosine_hemisphere};
use radsight_texture::luminance;
use rayon::prelude::*;
use std::f64::consts::{FRAC_1_PI, PI};
use std::ops::Range;

/// Number of points at which the guide is learned: points that camera rays see, and points that
/// rays from these see.
const MAX_POINTS: usize = 1024;

/// Rays per point in each round, and in a first round that decides whether a guide is needed.
const RAYS_PER_POINT: usize = 6;
const FIRST_LOOKS: usize = 2;

/// Rounds, each guided by the previous ones, by the number of further bounces of their paths:
/// patches are best detected by direct light.
const ROUNDS: [u32; 4] = [0, 1, u32::MAX, u32::MAX];

/// Rounds in which patches are searched. The others only train regions: rays drawn before a patch
/// was known say nothing about it.
const ROUNDS_FOR_PATCHES: usize = 2;

/// Steps of expectation maximisation after each round.
const STEPS: usize = 3;

/// Paths are guided only if the mean square of the rays' results is this many times the square of
/// the mean.
const MIN_UNEVENNESS: f64 = 2.5;

/// A guide must reduce the mean square below this fraction to be worth its cost. A few unguided
/// rays underestimate the mean square, since they miss bright patches.
const MAX_GUIDED_SHARE: f64 = 1.0;

/// Maximum number of portals, to leave room for patches.
const MAX_GUIDED_PORTALS: usize = MOST_PORTALS - ROUNDS_FOR_PATCHES * MAX_PATCHES;

/// Results above this multiple of the mean are bright.
const BRIGHT: f64 = 3.0;

/// Samples are limited to this multiple of the mean for learning.
const MAX_SAMPLE_VALUE: f64 = 100.0;

/// Seed of the guide's rays.
const GUIDE_SEED: u64 = 0x6775_6964_696e;
const SECOND_SEED: u64 = 0x7365_636f_6e64;

/// A traced guide ray.
#[derive(Clone, Copy, Debug)]
struct GuideRay {
    point: usize,
    direction: DVec3,
    /// Pdf of the direction, 1/sr.
    pdf: f64,
    /// Luminance, and its contribution to the irradiance: times cosine over pdf.
    radiance: f64,
    irradiance: f64,
    /// Apparent distance and position of the hit, through panes and plane mirrors; `None` at
    /// infinity.
    found: Option<(f64, DVec3)>,
}

impl PathGuide {
    /// Learns where rays like these find light via diffuse surfaces; `None` if they need no guide.
    pub(crate) fn learn<const BANDS: usize>(
        plan: &RenderPlan,
        rays: &[Option<Ray>],
        spread: RaySpacing,
    ) -> Option<PathGuide> {
        let points = guided_points::<BANDS>(plan, rays, spread);
        if points.is_empty() {
            return None;
        }
        let positions: Vec<(DVec3, DVec3)> = points.iter().map(|point| (point.point, point.normal)).collect();
        let portals = Portals(plan.portals.0.iter().take(MAX_GUIDED_PORTALS).cloned().collect());
        let regions = Regions::new(&positions, portals.len());
        let mut guide = PathGuide { portals, regions };
        let first = guide.trace_rays(plan, &points, (0..FIRST_LOOKS, u32::MAX));
        if unevenness(&guide.relative(&points, &first, &first)) < MIN_UNEVENNESS {
            return None;
        }
        let (mut known, mut guided) = (Vec::new(), Vec::new());
        for (round, bounces) in ROUNDS.into_iter().enumerate() {
            let begin = FIRST_LOOKS + round * RAYS_PER_POINT;
            let traced = guide.trace_rays(plan, &points, (begin..begin + RAYS_PER_POINT, bounces));
            if round < ROUNDS_FOR_PATCHES {
                let relative = guide.relative(&points, &traced, &traced);
                guide.find_patches(&traced, &relative);
            } else {
                known.extend_from_slice(&traced);
                let relative = guide.relative(&points, &known, &known);
                for _ in 0..STEPS {
                    guide.train(&points, &known, &relative);
                }
            }
            guided = traced;
        }
        let [without, with] = [&first, &guided].map(|traced| unevenness(&guide.relative(&points, traced, &guided)));
        (with < MAX_GUIDED_SHARE * without).then_some(guide)
    }

    /// Traces some rays from each point.
    fn trace_rays<const BANDS: usize>(
        &self,
        plan: &RenderPlan,
        points: &[CachePoint<BANDS>],
        (rounds, bounces): (Range<usize>, u32),
    ) -> Vec<GuideRay> {
        let points: Vec<CachePoint<BANDS>> =
            points.iter().map(|point| CachePoint { bounces: point.bounces.min(bounces), ..point.clone() }).collect();
        points
            .par_iter()
            .enumerate()
            .with_min_len(8)
            .map_init(
                || PathIntegrator::new(plan, [None; 2]).guided_by(Some(self)),
                |tracer, (index, point)| {
                    let ray = |round: usize| self.ray(tracer, (index, point), (round * points.len() + index) as u64);
                    rounds.clone().filter_map(ray).collect::<Vec<_>>()
                },
            )
            .flatten_iter()
            .collect()
    }

    fn ray<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        (index, point): (usize, &CachePoint<BANDS>),
        number: u64,
    ) -> Option<GuideRay> {
        let sampler = RaySampler::new(tracer.plan.options.seed ^ GUIDE_SEED, number);
        let [choice, u, v, _] = sampler.take(DimensionSet::CAMERA);
        let portals = self.seen_from(point.point, point.normal);
        let chance = portals.as_ref().map_or(0.0, |portals| portals.chance);
        let direction = match &portals {
            Some(portals) if choice < chance => portals.sample([choice / chance, u, v])?,
            _ => by_cosine(point.normal, [u, v]),
        };
        let cosine = direction.dot(point.normal);
        if cosine <= 0.0 {
            return None;
        }
        let by_cosine = (1.0 - chance) * cosine * FRAC_1_PI;
        let pdf = by_cosine + chance * portals.as_ref().map_or(0.0, |portals| portals.pdf(direction));
        let radiance = luminance(&tracer.gather_radiance(point, direction, sampler).radiance);
        let distance = tracer.shown_distance();
        let found = distance.is_finite().then(|| (distance, point.point + direction * distance));
        Some(GuideRay { point: index, direction, pdf, radiance, irradiance: radiance * cosine / pdf, found })
    }

    /// The result of each ray relative to the mean over `all` rays of its region.
    fn relative<const BANDS: usize>(
        &self,
        points: &[CachePoint<BANDS>],
        traced: &[GuideRay],
        all: &[GuideRay],
    ) -> Vec<f64> {
        let region = |ray: &GuideRay| self.regions.find(points[ray.point].point, points[ray.point].normal);
        let mut sums = vec![(0.0, 0.0); self.regions.len()];
        for ray in all {
            let (sum, count) = &mut sums[region(ray)];
            *sum += ray.irradiance;
            *count += 1.0;
        }
        let relative = |ray: &GuideRay| {
            let (sum, count) = sums[region(ray)];
            if sum > 0.0 { ray.irradiance * count / sum } else { 0.0 }
        };
        traced.iter().map(relative).collect()
    }

    /// Finds bright patches, besides portals and known ones.
    fn find_patches(&mut self, traced: &[GuideRay], relative: &[f64]) {
        let point = |(ray, relative): (&GuideRay, &f64)| {
            let (distance, position) = ray.found?;
            // The result of a ray sampled by the cosine.
            let radiance = relative * PI * ray.radiance / ray.irradiance.max(f64::MIN_POSITIVE);
            let area = distance * distance / (traced.len() as f64 * ray.pdf);
            area.is_finite().then_some(BrightPoint { position, radiance, area, second_moment: relative * relative })
        };
        let points: Vec<BrightPoint> = traced.iter().zip(relative).filter_map(point).collect();
        let mut portals = std::mem::take(&mut self.portals.0);
        let room = MOST_PORTALS - portals.len();
        portals.extend(patches(&points, BRIGHT).into_iter().take(room));
        self.regions.forget(portals.len());
        self.portals = Portals(portals);
    }

    /// Trains the mixture of each region with the results of its rays.
    fn train<const BANDS: usize>(&mut self, points: &[CachePoint<BANDS>], traced: &[GuideRay], relative: &[f64]) {
        let unknown = RegionStatistics::new(self.portals.len());
        let mut statistics = vec![unknown; self.regions.len()];
        for (ray, relative) in traced.iter().zip(relative) {
            let CachePoint { point, normal, .. } = points[ray.point];
            let Some(portals) = self.seen_from(point, normal) else { continue };
            let by_cosine = (1.0 - portals.chance) * ray.direction.dot(normal) * FRAC_1_PI;
            let statistics = &mut statistics[self.regions.find(point, normal)];
            statistics.add(relative.min(MAX_SAMPLE_VALUE), by_cosine, portals.chance, portals.parts(ray.direction));
        }
        self.regions.learn(&statistics);
    }
}

/// The mean square of numbers with mean 1.
fn unevenness(relative: &[f64]) -> f64 {
    relative.iter().map(|relative| relative * relative).sum::<f64>() / relative.len().max(1) as f64
}

/// A cosine-distributed unit direction around a unit normal, and its pdf.
fn by_cosine(normal: DVec3, [u, v]: [f64; 2]) -> DVec3 {
    let [x, y, z] = Record::<1>::frame(normal);
    let [a, b, c] = cosine_hemisphere(u, v);
    (x * a + y * b + z * c).normalize()
}

/// Points where these rays hit diffuse surfaces, and where rays from there do.
fn guided_points<const BANDS: usize>(
    plan: &RenderPlan,
    rays: &[Option<Ray>],
    spread: RaySpacing,
) -> Vec<CachePoint<BANDS>> {
    let nothing = Cache::<BANDS>::new(gathering_limits(plan));
    let order = scattered(rays.len());
    let some = &order[..order.len().min(MAX_POINTS)];
    let mut points: Vec<CachePoint<BANDS>> = of_camera_rays(plan, (rays, spread), some).into_iter().flatten().collect();
    points.retain(|point| point.point.is_finite());
    let seen: Vec<CachePoint<BANDS>> = points
        .par_iter()
        .enumerate()
        .with_min_len(64)
        .filter(|(_, point)| point.bounces > 0)
        .map_init(
            || PathIntegrator::new(plan, [None, Some(&nothing)]),
            |tracer, (index, point)| {
                tracer.point_search = Some(PointSearch::new(spread));
                let sampler = RaySampler::new(plan.options.seed ^ SECOND_SEED, index as u64);
                let [u, v, ..] = sampler.take(DimensionSet::CAMERA);
                let _ = tracer.gather_radiance(point, by_cosine(point.normal, [u, v]), sampler);
                tracer.point_search.take().map_or(Vec::new(), |search| search.found)
            },
        )
        .flatten_iter()
        .collect();
    points.extend(seen);
    points
}
