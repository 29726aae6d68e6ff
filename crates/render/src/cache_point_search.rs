//! Rays that find cache points: those of the picture, and samples from other cache points.

use crate::cache_query::{CachePoint, CacheQuery, Caches, HemisphereGather};
use crate::ray_spacing::RaySpacing;
use crate::trace::PathIntegrator;
use radsight_accel::Ray;
use radsight_compile::RenderPlan;
use radsight_irradiance_cache::{Cache, Hemisphere};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Number of cache points that trace sample rays to find the points of the second cache.
const MAX_SAMPLE_POINTS: usize = 1024;

/// The cache queries of some rays.
pub(crate) fn cache_query<const BANDS: usize>(
    plan: &RenderPlan,
    cache: &Cache<BANDS>,
    rays: &[Option<Ray>],
    order: &[usize],
    requested: &CacheQuery<BANDS>,
) -> Vec<CacheQuery<BANDS>> {
    queries(plan, [Some(cache), None], order, requested, |integrator, index| {
        if let Some(ray) = &rays[index] {
            let _ = integrator.trace(index as u64, ray);
        }
    })
}

/// The cache queries of rays. `trace` traces the ray of an index.
fn queries<const BANDS: usize>(
    plan: &RenderPlan,
    caches: Caches<'_, BANDS>,
    order: &[usize],
    requested: &CacheQuery<BANDS>,
    trace: impl Fn(&mut PathIntegrator<'_, BANDS>, usize) + Sync,
) -> Vec<CacheQuery<BANDS>> {
    let of_ray = |integrator: &mut PathIntegrator<'_, BANDS>, index: &usize| {
        integrator.cache_query = Some(requested.clone());
        trace(integrator, *index);
        integrator.cache_query.take()
    };
    order.par_iter().map_init(|| PathIntegrator::new(plan, caches), of_ray).flatten_iter().collect()
}

/// Rays like the hemisphere samples of cache points.
pub(crate) struct SecondaryGathers<const BANDS: usize> {
    from: Vec<CachePoint<BANDS>>,
    hemisphere: Hemisphere,
    /// Of the final number of rays of cache points.
    pub(crate) spread: RaySpacing,
}

impl<const BANDS: usize> SecondaryGathers<BANDS> {
    /// The cache points from which some of these rays start, with this number of samples each.
    pub(crate) fn new(
        plan: &RenderPlan,
        cache: &Cache<BANDS>,
        rays: &[Option<Ray>],
        spread: RaySpacing,
        samples: usize,
    ) -> Self {
        let order = scattered(rays.len());
        let some = &order[..order.len().min(MAX_SAMPLE_POINTS)];
        let queries = cache_query(plan, cache, rays, some, &CacheQuery::Missing(Vec::new(), spread));
        let from: Vec<CachePoint<BANDS>> = queries.into_iter().flat_map(CacheQuery::missing).collect();
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

    /// The cache queries of some of these rays.
    pub(crate) fn cache_query(
        &self,
        plan: &RenderPlan,
        cache: &Cache<BANDS>,
        order: &[usize],
        requested: &CacheQuery<BANDS>,
    ) -> Vec<CacheQuery<BANDS>> {
        let cells = self.hemisphere.len();
        queries(plan, [None, Some(cache)], order, requested, |integrator, index| {
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
