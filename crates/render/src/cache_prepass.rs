//! The irradiance-cache pre-pass: gathers irradiance where the rays of the picture need it.

use crate::cache_budget::{
    MOST_RAYS, MOST_RAYS_BEYOND, least_own_rays, most_rays, pays_for_second_cache, sample_rays, second_cache_noise,
};
use crate::cache_occluders::OpaqueSurfaces;
use crate::cache_point_search::{PrepassPoints, SecondaryGathers, of_camera_rays};
use crate::cache_query::{CachePoint, Caches, HemisphereGather};
use crate::caching::gathering_limits;
use crate::checksum::ray_set;
use crate::guiding::GuidingRecords;
use crate::hemisphere_sampling::HemisphereSamples;
use crate::local_mean::local_means;
use crate::ray_spacing::RaySpacing;
use crate::trace::PathIntegrator;
use radsight_accel::Ray;
use radsight_compile::RenderPlan;
use radsight_irradiance_cache::{Cache, Fit, Hemisphere, Limits, Record, Stored, StoredBytes};
use rayon::prelude::*;

/// Rays of the first batch; later batches are larger, as fewer rays find a gap.
const FIRST_BATCH: usize = 64;
const MAX_BATCH: usize = 4096;

/// Cache points that gather in parallel: few, since they ignore each other's records.
const GROUP: usize = 16;

/// A gather uses at most this many rays for each pre-pass ray, and in small pictures at most this
/// many in all. Beyond that single rays are more efficient, and points without records use them.
const MAX_RAYS: usize = 64;
const MAX_RAYS_OF_FEW: usize = 1 << 23;

/// Fraction of the requested rays in one gather, since the rays of neighbours count as well.
const FIRST_SHARE: usize = 16;

/// Fraction in the gathers of the first cache points, which find the bright directions.
const FIRST_POINTS_SHARE: usize = 2;

/// Minimum number of rays of a gather, for the distances to other surfaces.
const MIN_RAYS: usize = 32;

/// Limits of the number of rays in a fit, relative to the requested number. It is larger where the
/// noise is too high or less noise is allowed than usual, and smaller where more noise is allowed
/// than reached.
const MAX_FURTHER: f64 = 4.0;
const MIN_FIT_RAYS: f64 = 0.25;
const SPARING_NOISE: f64 = 0.01;
const USUAL_NOISE: f64 = 0.03;
const MAX_NOISE_REDUCTION: f64 = 16.0;

/// Irradiance below this fraction of the typical value needs no more absolute accuracy.
const DARK_FRACTION: f64 = 0.03;

/// Maximum number of pre-pass rays for counting what records serve.
const MAX_COUNTED: usize = 1 << 16;

/// Number of passes over the rays: where the irradiance is not linear, records get a smaller reach
/// than in the previous pass.
const PREPASSES: usize = 3;

/// Number of passes with caustics, whose edges need more steps, each with less noise.
const PREPASSES_FOR_CAUSTICS: usize = 6;

/// Rounds of additional gathers where there are too few neighbours.
const FURTHER_ROUNDS: usize = 3;

/// Factor of the error of the second cache.
const COARSER: f64 = 2.0;

/// Fraction of the rays that may be used for the second cache, as its reciprocal.
const SECOND_CACHE_SHARE: usize = 4;

/// From this number of rays on, records resolve what the rays do; with fewer they resolve finer
/// details, down to this fraction.
const MANY_RAYS: f64 = 32_768.0;
const FINEST: f64 = 0.47;

/// At this `-aa` a picture is a preview, whose records resolve what its rays do.
const PREVIEW_ACCURACY: f64 = 0.3;

/// First gather number of sensors' sample rays.
const FIRST_SECONDARY_GATHER: u64 = 1 << 40;

/// Whether gathering should be cancelled; once true, it stays true.
pub(crate) type Stops<'s> = dyn Fn() -> bool + Sync + 's;

/// Gathers for these rays, and returns the number of new cache points. The result is a function of
/// the plan and all rays so far; threads only share the work of a group. `None` if it was
/// cancelled: partial results are discarded, since they would change the irradiance.
pub(crate) fn gather<const BANDS: usize>(
    (plan, stops): (&RenderPlan, &Stops<'_>),
    gathered: &mut Option<GatheredIrradiance<BANDS>>,
    rays: &[Option<Ray>],
    spread: RaySpacing,
) -> Option<usize> {
    let found = gather_for((plan, stops), gathered.get_or_insert_with(|| GatheredIrradiance::new(plan)), rays, spread);
    if stops() {
        *gathered = None;
        return None;
    }
    Some(found)
}

fn gather_for<const BANDS: usize>(
    (plan, stops): (&RenderPlan, &Stops<'_>),
    gathered: &mut GatheredIrradiance<BANDS>,
    rays: &[Option<Ray>],
    spread: RaySpacing,
) -> usize {
    let GatheredIrradiance { seen, beyond, bright, served } = gathered;
    let requested = ray_set(rays, spread);
    if served.contains(&requested) {
        return 0;
    }
    served.push(requested);
    if plan.options.ambient_bounces > 1 && pays_for_second_cache(plan, rays.len()) {
        let gathers = SecondaryGathers::new(plan, &seen.cache, (rays, spread), sample_rays(plan, rays.len()));
        let most = most_rays(plan, rays.len(), MOST_RAYS_BEYOND);
        beyond.budget = beyond.rays + most.min(seen.allowance(rays) / SECOND_CACHE_SHARE);
        beyond.noise = second_cache_noise(plan, rays.len());
        beyond.gather(
            (plan, stops),
            ([None; 2], bright),
            PrepassPoints::new(plan, gathers.len(), |order| gathers.points(plan, order)),
        );
    }
    let before = seen.cache.len();
    seen.budget = seen.rays + most_rays(plan, rays.len(), MOST_RAYS).min(seen.allowance(rays));
    let caches = [None, Some(&beyond.cache)];
    let fine = spread.scaled(fineness(rays.len(), plan.options.gathering.accuracy));
    let points = PrepassPoints::new(plan, rays.len(), |order| of_camera_rays(plan, (rays, fine), order));
    seen.gather((plan, stops), (caches, bright), points);
    seen.cache.len() - before
}

/// How much finer than usual the details are that records resolve, for this number of rays and this
/// `-aa`: in small pictures they cost little, and records as far apart as their pixels lose contact
/// shadows. Real Radiance's records are closer with a smaller `-aa`, too.
fn fineness(rays: usize, accuracy: f64) -> f64 {
    let finest = (accuracy / PREVIEW_ACCURACY).clamp(FINEST, 1.0);
    (rays as f64 / MANY_RAYS).sqrt().clamp(finest, 1.0)
}

/// Cached irradiance: for camera rays, and for final gather rays.
#[derive(Debug)]
pub(crate) struct GatheredIrradiance<const BANDS: usize> {
    seen: Level<BANDS>,
    /// Coarser, since it is only averaged over many points. Paths from its own points are traced
    /// ray by ray.
    beyond: Level<BANDS>,
    /// Bright directions found by both.
    bright: GuidingRecords,
    /// Hashes of the sets of rays for which it was gathered ([`ray_set`]); these need no further
    /// gathers.
    served: Vec<u64>,
}

/// The cache of one bounce, and the data from which it was gathered.
#[derive(Debug)]
struct Level<const BANDS: usize> {
    cache: Cache<BANDS>,
    /// Allowed relative standard error.
    noise: f64,
    /// Number of first records that were merged from another cache; they do not gather again.
    merged: usize,
    /// Number of first records that are already saved.
    saved: usize,
    /// The cache points of the other records.
    cache_points: Vec<CachePoint<BANDS>>,
    /// The hemisphere of a gather, and that of the first cache points.
    hemisphere: Hemisphere,
    first_hemisphere: Hemisphere,
    /// Rays used so far, and their maximum.
    rays: usize,
    budget: usize,
    /// Gathers so far: each has its own random numbers.
    gathers: u64,
    /// Minimum number of own rays of each of the newest records, whatever their neighbours have.
    least_own_rays: f64,
    /// Relative number of rays of each of the newest records ([`sample_allocation`]).
    allocations: Vec<f64>,
}

impl<const BANDS: usize> GatheredIrradiance<BANDS> {
    fn new(plan: &RenderPlan) -> Self {
        let (limits, noise) = (gathering_limits(plan), plan.options.gathering.noise);
        let coarse = Limits {
            accuracy: limits.accuracy * COARSER,
            min_reach: limits.min_reach * COARSER,
            explained: 1.0,
            ..limits
        };
        GatheredIrradiance {
            seen: Level::new(plan, limits, noise, 0),
            beyond: Level::new(plan, coarse, second_cache_noise(plan, usize::MAX), FIRST_SECONDARY_GATHER),
            bright: GuidingRecords::default(),
            served: Vec::new(),
        }
    }

    /// Number of records.
    pub(crate) fn len(&self) -> usize {
        self.seen.cache.len() + self.beyond.cache.len()
    }

    /// Appends it to some bytes.
    pub(crate) fn save(&mut self, bytes: &mut Vec<u8>) {
        self.seen.save(bytes);
        self.beyond.save(bytes);
        (self.served.len() as u64).store(bytes);
        self.served.iter().for_each(|served| served.store(bytes));
    }

    /// Restores saved irradiance for this plan; `None` if the bytes were not written by
    /// [`GatheredIrradiance::save`].
    pub(crate) fn restored(plan: &RenderPlan, bytes: &mut StoredBytes<'_>) -> Option<Self> {
        let mut gathered = GatheredIrradiance::new(plan);
        gathered.seen.restore(plan, bytes)?;
        gathered.beyond.restore(plan, bytes)?;
        for _ in 0..u64::restore(bytes)? {
            gathered.served.push(u64::restore(bytes)?);
        }
        Some(gathered)
    }

    /// Adds the records gathered here since the last save, where no other record reaches.
    pub(crate) fn merge(&mut self, plan: &RenderPlan, own: GatheredIrradiance<BANDS>) {
        self.seen.merge(plan, own.seen);
        self.beyond.merge(plan, own.beyond);
        self.bright = own.bright;
        for served in own.served {
            if !self.served.contains(&served) {
                self.served.push(served);
            }
        }
    }

    /// The relative standard error due to rays, including direct light: rms over all records.
    pub(crate) fn noise(&self) -> f64 {
        let cache = &self.seen.cache;
        let typical = cache.typical();
        let share = |index: usize| {
            let fit = cache.fitted(index).1;
            fit.standard_error() / weighed_against(fit, typical).max(f64::MIN_POSITIVE)
        };
        // The sum over no records would be -0.
        let squares = (0..cache.len()).fold(0.0, |sum, index| sum + share(index).powi(2));
        (squares / cache.len().max(1) as f64).sqrt()
    }

    /// Number of rays that were gathered for the records that rays of pixels look up.
    pub(crate) fn rays(&self) -> f64 {
        self.seen.cache.rays()
    }

    /// The caches of the first and of the second bounce.
    pub(crate) fn caches(&self) -> Caches<'_, BANDS> {
        [Some(&self.seen.cache), Some(&self.beyond.cache)]
    }
}

impl<const BANDS: usize> Level<BANDS> {
    fn new(plan: &RenderPlan, limits: Limits, noise: f64, first_gather: u64) -> Self {
        let needed = plan.options.gathering.rays();
        let divided = |share: usize| Hemisphere::with_divisions((needed / share).max(MIN_RAYS.min(needed)));
        let (hemisphere, first_hemisphere) = (divided(FIRST_SHARE), divided(FIRST_POINTS_SHARE));
        let cache = Cache::new(limits);
        Level {
            cache,
            noise,
            merged: 0,
            saved: 0,
            cache_points: Vec::new(),
            hemisphere,
            first_hemisphere,
            rays: 0,
            budget: 0,
            gathers: first_gather,
            least_own_rays: 0.0,
            allocations: Vec::new(),
        }
    }

    fn save(&mut self, bytes: &mut Vec<u8>) {
        self.gathers.store(bytes);
        self.cache.save(bytes);
        self.saved = self.cache.len();
    }

    fn restore(&mut self, plan: &RenderPlan, bytes: &mut StoredBytes<'_>) -> Option<()> {
        self.gathers = u64::restore(bytes)?;
        self.cache = Cache::restored(bytes, *self.cache.limits())?;
        self.settle(plan);
        self.saved = self.cache.len();
        self.merged = self.saved;
        Some(())
    }

    /// Adds the unsaved records of another level, and its rays to the total.
    fn merge(&mut self, plan: &RenderPlan, other: Level<BANDS>) {
        self.cache.merge(&other.cache, other.saved, &OpaqueSurfaces(plan));
        self.settle(plan);
        self.merged = self.cache.len();
        self.gathers = self.gathers.max(other.gathers);
        self.rays = other.rays;
    }

    /// Number of hemisphere samples allowed for these rays.
    fn allowance(&self, rays: &[Option<Ray>]) -> usize {
        let usual = MAX_RAYS_OF_FEW.max(MAX_RAYS * rays.len());
        (usual as f64 * self.noise_reduction()) as usize
    }

    /// Factor by which the allowed noise is smaller than usual, at least 1.
    fn noise_reduction(&self) -> f64 {
        (USUAL_NOISE / self.noise.max(f64::MIN_POSITIVE)).clamp(1.0, MAX_NOISE_REDUCTION)
    }

    /// Fills the cache for pre-pass rays.
    fn gather(
        &mut self,
        (plan, stops): (&RenderPlan, &Stops<'_>),
        (caches, bright): (Caches<'_, BANDS>, &mut GuidingRecords),
        mut points: PrepassPoints<'_, BANDS>,
    ) {
        let before = self.cache.len();
        self.least_own_rays = least_own_rays(plan, points.len());
        let passes = if plan.has_caustics { PREPASSES_FOR_CAUSTICS } else { PREPASSES };
        for round in 0..passes {
            if stops() {
                return;
            }
            if round > 0 {
                self.cache.reduce_reaches();
            }
            let known = self.cache.len();
            self.fill((plan, stops), (caches, bright), &mut points);
            if self.cache.len() == known {
                break;
            }
            self.settle(plan);
            if plan.has_caustics {
                self.count_served(plan, before, &mut points);
                if self.gather_again((plan, stops), (caches, bright), before) > 0 {
                    self.settle(plan);
                }
            }
        }
        if self.cache.len() == before {
            return;
        }
        self.count_served(plan, before, &mut points);
        for _ in 0..FURTHER_ROUNDS {
            if self.gather_again((plan, stops), (caches, bright), before) == 0 {
                break;
            }
            self.settle(plan);
        }
        self.cache.rebuild_index();
    }

    /// Gathers where pre-pass rays need irradiance and no record reaches.
    fn fill(
        &mut self,
        (plan, stops): (&RenderPlan, &Stops<'_>),
        (caches, bright): (Caches<'_, BANDS>, &mut GuidingRecords),
        points: &mut PrepassPoints<'_, BANDS>,
    ) {
        let (mut first, mut batch) = (0, FIRST_BATCH);
        while first < points.len() && self.rays < self.budget && !stops() {
            let end = (first + batch).min(points.len());
            let missing = points.missing(first..end, &self.cache);
            for group in missing.chunks(GROUP) {
                let uncovered: Vec<_> = group
                    .iter()
                    .filter(|cache_point| !cache_point.is_covered(plan, &self.cache))
                    .map(|cache_point| (cache_point.clone(), cache_point.next_gather(&self.cache)))
                    .collect();
                let had_no_data = self.has_no_data(bright);
                let mut records = self.gather_at((plan, stops), (caches, bright), &uncovered);
                if had_no_data && !bright.is_empty() {
                    // The first records may have missed bright directions by chance: they gather
                    // again with guiding.
                    records = self.gather_at((plan, stops), (caches, bright), &uncovered);
                }
                for ((cache_point, gather), record) in uncovered.into_iter().zip(records) {
                    self.cache.insert(record, gather);
                    self.cache_points.push(cache_point);
                }
            }
            first = end;
            batch = (2 * batch).min(MAX_BATCH);
        }
    }

    /// Counts how often pre-pass rays use each record from `first` on, for the allocation of rays.
    fn count_served(&mut self, plan: &RenderPlan, first: usize, points: &mut PrepassPoints<'_, BANDS>) {
        let mut served = vec![0.0; self.cache.len() - first];
        let counted = points.len().min(MAX_COUNTED);
        for start in (0..counted).step_by(MAX_BATCH) {
            for (record, share) in points.served(start..(start + MAX_BATCH).min(counted), &self.cache) {
                if let Some(served) = (record as usize).checked_sub(first).and_then(|index| served.get_mut(index)) {
                    *served += share;
                }
            }
        }
        self.allocations = sample_allocation(&served, plan.options.gathering.allocation_floor);
    }

    /// Gathers again at records with too few rays, and returns their number.
    fn gather_again(
        &mut self,
        (plan, stops): (&RenderPlan, &Stops<'_>),
        known: (Caches<'_, BANDS>, &mut GuidingRecords),
        first: usize,
    ) -> usize {
        let missing: Vec<usize> = (first..)
            .zip(self.rays_needed(plan, first))
            .zip(&self.allocations)
            .map(|((index, needed), allocation)| self.gathers_missing(index, allocation * needed))
            .collect();
        let needed = missing.iter().sum::<usize>() * self.hemisphere.len();
        // If there are not enough rays for all, all get the same fraction.
        let gathering = &plan.options.gathering;
        let most = gathering.record_share * (self.cache.len() * gathering.rays()) as f64;
        let left = (self.budget as f64).min(most) - self.rays as f64;
        let share = (left / needed.max(1) as f64).clamp(0.0, 1.0);
        let (mut weak, mut again, mut due) = (Vec::new(), Vec::new(), 0.0);
        for (index, gathers) in (first..).zip(missing) {
            due += gathers as f64 * share;
            while due >= 1.0 {
                due -= 1.0;
                weak.push(index);
                again.push((self.cache_points[index - self.merged].clone(), self.cache.take_gather(index)));
            }
        }
        let records = self.gather_at((plan, stops), known, &again);
        for (index, record) in weak.iter().zip(records) {
            self.cache.add(*index, &record);
        }
        weak.len()
    }

    /// Number of rays that the fit of each record from `first` on needs. The records around it
    /// decide, since its own noise depends on its irradiance: the mean of all rays would be too low.
    fn rays_needed(&self, plan: &RenderPlan, first: usize) -> Vec<f64> {
        let requested = plan.options.gathering.rays() as f64;
        let least = (SPARING_NOISE / self.noise.max(f64::MIN_POSITIVE)).clamp(MIN_FIT_RAYS, 1.0);
        let most = MAX_FURTHER * self.noise_reduction();
        let typical = self.cache.typical();
        let needed = |index: usize| {
            let (_, fit) = self.cache.fitted(index);
            let allowed = self.noise * weighed_against(fit, typical);
            let needed = (fit.standard_error() / allowed.max(f64::MIN_POSITIVE)).powi(2) * fit.rays();
            needed.clamp(least * requested, most * requested)
        };
        let needed: Vec<f64> = (first..self.cache.len()).map(needed).collect();
        let cache_points = &self.cache_points[first - self.merged..];
        let points: Vec<_> = cache_points.iter().map(|cache_point| (cache_point.point, cache_point.normal)).collect();
        local_means(&points, &needed)
    }

    /// Number of additional gathers of a record whose fit needs this number of rays, if its
    /// neighbours gather as often: the rays of a fit grow in proportion.
    fn gathers_missing(&self, index: usize, needed: f64) -> usize {
        let (record, fit) = self.cache.fitted(index);
        let missing = record.rays() * (needed / fit.rays() - 1.0);
        let missing = missing.max(self.least_own_rays - record.rays());
        (missing / self.hemisphere.len() as f64 - 0.5).ceil().max(0.0) as usize
    }

    /// Whether nothing was gathered yet, nor found bright.
    fn has_no_data(&self, bright: &GuidingRecords) -> bool {
        self.cache_points.is_empty() && bright.is_empty()
    }

    fn gather_at(
        &mut self,
        (plan, stops): (&RenderPlan, &Stops<'_>),
        (caches, bright): (Caches<'_, BANDS>, &mut GuidingRecords),
        cache_points: &[(CachePoint<BANDS>, usize)],
    ) -> Vec<Record<BANDS>> {
        let hemisphere = if self.has_no_data(bright) { &self.first_hemisphere } else { &self.hemisphere };
        let (first, limits, known) = (self.gathers, self.cache.limits(), &*bright);
        let gathered_records: Vec<_> = cache_points
            .par_iter()
            .enumerate()
            .map_init(
                || PathIntegrator::new(plan, caches),
                |tracer, (index, (cache_point, sample))| {
                    if stops() {
                        return None;
                    }
                    let number = first + index as u64;
                    let gather = HemisphereGather { hemisphere, sample: Some(*sample), number, bright: Some(known) };
                    let (record, around) = tracer.gather_at(cache_point, &gather, limits);
                    // The record contains the sums of the cells; keeping the cells of a million
                    // gathers would fill the memory.
                    let HemisphereSamples { bright, rays, .. } = around;
                    Some((record.with_ungathered(tracer.direct_irradiance(cache_point, number)), bright, rays))
                },
            )
            .while_some()
            .collect();
        self.gathers += cache_points.len() as u64;
        let mut records = Vec::with_capacity(gathered_records.len());
        for ((cache_point, _), (record, found, rays)) in cache_points.iter().zip(gathered_records) {
            bright.note(cache_point.point, cache_point.normal, found);
            self.rays += rays;
            records.push(record);
        }
        bright.settle();
        records
    }

    /// Updates stale fits.
    fn settle(&mut self, plan: &RenderPlan) {
        let stale = self.cache.stale();
        let fits: Vec<_> = stale.par_iter().map(|index| self.cache.fit(*index, &OpaqueSurfaces(plan))).collect();
        for (index, fit) in stale.into_iter().zip(fits) {
            self.cache.adopt(index, fit);
        }
    }
}

/// The irradiance to which an error is relative: the total, including direct light.
fn weighed_against<const BANDS: usize>(fit: &Fit<BANDS>, typical: f64) -> f64 {
    fit.brightness().max(DARK_FRACTION * typical)
}

/// The allocation of rays to records by the parts of the picture that they serve, relative to equal
/// noise everywhere. The squared noise of a record is proportional to one over its rays, so for a
/// fixed total the visible noise is least with rays in proportion to the root of what a record
/// serves. Scaled so that the visible noise equals that of equal noise everywhere.
fn sample_allocation(served: &[f64], allocation_floor: f64) -> Vec<f64> {
    let least = allocation_floor * served.iter().sum::<f64>() / served.len().max(1) as f64;
    let roots = || served.iter().map(|served| (served + least).max(f64::MIN_POSITIVE).sqrt());
    let scale = roots().sum::<f64>() / roots().map(|root| root * root).sum::<f64>();
    roots().map(|root| scale * root).collect()
}

#[cfg(test)]
mod tests {
    use super::sample_allocation;

    #[test]
    fn as_little_noise_is_seen_for_fewer_rays() {
        let served: Vec<f64> = (0..1000).map(|index| f64::from(index % 10).powi(2)).collect();
        let sample_allocation = sample_allocation(&served, 0.1);
        let (rays, pixels) = (sample_allocation.iter().sum::<f64>(), served.iter().sum::<f64>());
        let seen: f64 = served.iter().zip(&sample_allocation).map(|(served, allocation)| served / allocation).sum();
        // With equal noise each pixel has one ray, and the visible noise equals the number of
        // pixels.
        assert!((0.79..0.81).contains(&(rays / served.len() as f64)), "{rays} rays");
        assert!((0.9..1.01).contains(&(seen / pixels)), "{seen} of {pixels}");
        assert!(sample_allocation.iter().all(|allocation| *allocation > 0.1));
        assert_eq!(super::sample_allocation(&[0.0; 3], 0.5), [1.0; 3]);
        assert_eq!(super::sample_allocation(&[], 0.5), [0.0; 0]);
    }
}
