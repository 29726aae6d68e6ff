//! Rays that find cache points: those of the picture, and samples from other cache points.

use crate::cache_occluders::OpaqueSurfaces;
use crate::cache_query::{CachePoint, Caches, HemisphereGather, PointSearch};
use crate::caching::gathering_limits;
use crate::ray_spacing::RaySpacing;
use crate::trace::PathIntegrator;
use radsight_accel::Ray;
use radsight_compile::RenderPlan;
use radsight_irradiance_cache::{Cache, Hemisphere};
use rayon::prelude::*;
use std::f64::consts::PI;
use std::ops::Range;

/// Number of cache points that trace sample rays to find the points of the second cache.
const MAX_SAMPLE_POINTS: usize = 1024;

/// The cache points of this many rays are kept.
const MAX_KEPT: usize = 1 << 17;

/// Returns the cache points of each of some rays, by their indices.
type Find<'f, const BANDS: usize> = dyn Fn(&[usize]) -> Vec<Vec<CachePoint<BANDS>>> + 'f;

/// The cache points of pre-pass rays. Every pass needs them, so those of the first rays are kept.
pub(crate) struct PrepassPoints<'f, const BANDS: usize> {
    /// The rays, scattered.
    order: Vec<usize>,
    plan: &'f RenderPlan,
    find: Box<Find<'f, BANDS>>,
    kept: Vec<CachePoint<BANDS>>,
    /// For each ray whose points are kept, the number of points up to it.
    ends: Vec<usize>,
}

impl<'f, const BANDS: usize> PrepassPoints<'f, BANDS> {
    /// Of `count` rays.
    pub(crate) fn new(
        plan: &'f RenderPlan,
        count: usize,
        find: impl Fn(&[usize]) -> Vec<Vec<CachePoint<BANDS>>> + 'f,
    ) -> Self {
        PrepassPoints { order: scattered(count), plan, find: Box::new(find), kept: Vec::new(), ends: Vec::new() }
    }

    /// Number of rays.
    pub(crate) fn len(&self) -> usize {
        self.order.len()
    }

    /// The cache points of consecutive rays of the scattered order that no record reaches.
    pub(crate) fn missing(&mut self, rays: Range<usize>, cache: &Cache<BANDS>) -> Vec<CachePoint<BANDS>> {
        let plan = self.plan;
        let is_missing = |point: &&CachePoint<BANDS>| !point.is_covered(plan, cache);
        self.with_points(rays, |points| {
            points.par_iter().with_min_len(POINTS_OF_A_TASK).filter(is_missing).cloned().collect()
        })
    }

    /// The records that serve the cache points of consecutive rays of the scattered order, with
    /// their weights.
    pub(crate) fn served(&mut self, rays: Range<usize>, cache: &Cache<BANDS>) -> Vec<(u32, f64)> {
        let occluders = OpaqueSurfaces(self.plan);
        let serving = |points: &[CachePoint<BANDS>]| {
            let mut served = Vec::new();
            points.iter().for_each(|point| cache.shares(point.point, point.normal, &occluders, &mut served));
            served
        };
        self.with_points(rays, |points| points.par_chunks(POINTS_OF_A_TASK).flat_map_iter(serving).collect())
    }

    fn with_points<T>(&mut self, rays: Range<usize>, visit: impl FnOnce(&[CachePoint<BANDS>]) -> T) -> T {
        if rays.start > self.ends.len() || rays.end > MAX_KEPT {
            return visit(&(self.find)(&self.order[rays]).concat());
        }
        if rays.end > self.ends.len() {
            for found in (self.find)(&self.order[self.ends.len()..rays.end]) {
                self.kept.extend(found);
                self.ends.push(self.kept.len());
            }
        }
        let end_of = |ray: usize| ray.checked_sub(1).map_or(0, |before| self.ends[before]);
        visit(&self.kept[end_of(rays.start)..end_of(rays.end)])
    }
}

/// Number of cache points that one thread looks up at a time.
const POINTS_OF_A_TASK: usize = 256;

/// The cache points of some of these camera rays.
pub(crate) fn of_camera_rays<const BANDS: usize>(
    plan: &RenderPlan,
    (rays, spread): (&[Option<Ray>], RaySpacing),
    order: &[usize],
) -> Vec<Vec<CachePoint<BANDS>>> {
    let nothing = Cache::new(gathering_limits(plan));
    search((plan, [Some(&nothing), None]), spread, order, |integrator, index| {
        if let Some(ray) = &rays[index] {
            let _ = integrator.trace(index as u64, ray);
        }
    })
}

/// The cache points of rays. `trace` traces the ray of an index.
fn search<const BANDS: usize>(
    (plan, caches): (&RenderPlan, Caches<'_, BANDS>),
    spread: RaySpacing,
    order: &[usize],
    trace: impl Fn(&mut PathIntegrator<'_, BANDS>, usize) + Sync,
) -> Vec<Vec<CachePoint<BANDS>>> {
    let of_ray = |integrator: &mut PathIntegrator<'_, BANDS>, index: &usize| {
        integrator.point_search = Some(PointSearch::new(spread));
        trace(integrator, *index);
        integrator.point_search.take().map_or(Vec::new(), |search| search.found)
    };
    order.par_iter().map_init(|| PathIntegrator::new(plan, caches), of_ray).collect()
}

/// Rays like the hemisphere samples of cache points.
pub(crate) struct SecondaryGathers<const BANDS: usize> {
    from: Vec<CachePoint<BANDS>>,
    hemisphere: Hemisphere,
    /// Of the final number of rays of cache points.
    spread: RaySpacing,
}

impl<const BANDS: usize> SecondaryGathers<BANDS> {
    /// The cache points that lack irradiance from which some of these rays start, with this number
    /// of samples each.
    pub(crate) fn new(
        plan: &RenderPlan,
        cache: &Cache<BANDS>,
        (rays, spread): (&[Option<Ray>], RaySpacing),
        samples: usize,
    ) -> Self {
        let order = scattered(rays.len());
        let some = &order[..order.len().min(MAX_SAMPLE_POINTS)];
        let mut from: Vec<CachePoint<BANDS>> =
            of_camera_rays(plan, (rays, spread), some).into_iter().flatten().collect();
        from.retain(|point| !point.is_covered(plan, cache));
        let angle = (2.0 * PI / plan.options.gathering.rays() as f64).sqrt();
        SecondaryGathers {
            from,
            hemisphere: Hemisphere::with_divisions(samples),
            spread: RaySpacing { width: 0.0, angle },
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.from.len() * self.hemisphere.len()
    }

    /// The cache points of some of these rays.
    pub(crate) fn points(&self, plan: &RenderPlan, order: &[usize]) -> Vec<Vec<CachePoint<BANDS>>> {
        let cells = self.hemisphere.len();
        let nothing = Cache::new(gathering_limits(plan));
        search((plan, [None, Some(&nothing)]), self.spread, order, |integrator, index| {
            let (from, number) = (&self.from[index / cells], (index / cells) as u64);
            let gather = HemisphereGather { hemisphere: &self.hemisphere, sample: None, number, bright: None };
            let sample = integrator.gather_direction(from, &gather, index % cells);
            let _ = integrator.gather_radiance(from, sample.direction, sample.sampler);
        })
    }
}

/// All indices in an order whose every prefix is evenly distributed: steps by the golden ratio
/// (made coprime to the count).
pub(crate) fn scattered(count: usize) -> Vec<usize> {
    let common = |mut a: usize, mut b: usize| {
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    let golden = (count as f64 * 0.618_033_988_749_895) as usize;
    let step = (golden.max(1)..).find(|step| common(*step, count) == 1).unwrap_or(1);
    (0..count)
        .scan(0usize, |at, _| {
            let this = *at;
            *at = (*at + step) % count.max(1);
            Some(this)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::scattered;

    #[test]
    fn scattered_indices_are_all_there_and_spread() {
        for count in [0, 1, 2, 7, 100, 4096] {
            let mut order = scattered(count);
            if count == 4096 {
                let mut first: Vec<usize> = order[..64].to_vec();
                first.sort_unstable();
                assert!(first.windows(2).all(|pair| pair[1] - pair[0] < 200), "{first:?}");
            }
            order.sort_unstable();
            assert_eq!(order, (0..count).collect::<Vec<_>>());
        }
    }
}
