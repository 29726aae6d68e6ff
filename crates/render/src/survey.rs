//! Gathering irradiance before the picture is made, where its rays will want it.

use crate::gather::Place;
use crate::plan::RenderPlan;
use crate::ray::Ray;
use crate::trace::Tracer;
use radsight_irradiance::{Cache, Hemisphere, Limits};
use rayon::prelude::*;

/// Rays that are surveyed together at first; later more, as fewer of them find something missing.
const FIRST_BATCH: usize = 64;
const LARGEST_BATCH: usize = 4096;

/// Places from which is looked around at once: few, since they do not know of each other.
const GROUP: usize = 16;

/// Looking around takes at most so many rays for each that is surveyed: beyond that drawing single rays is the better use of time, and
/// places that no record reaches do that.
const MOST_RAYS: usize = 32;

impl RenderPlan {
    /// Whether irradiance is shared between points at all.
    pub(crate) fn shares_irradiance(&self) -> bool {
        self.layout.sampling().is_rgb()
            && self.options.ambient_bounces > 0
            && self.options.gathering.accuracy > 0.0
            && self.options.gathering.rays() > 1
    }

    /// How near and how far records are trusted: as Radiance does, from the scene's size.
    pub(crate) fn gathering_limits(&self) -> Limits {
        let gathering = &self.options.gathering;
        let size = 2.0 * self.bounding_sphere().1.max(f64::MIN_POSITIVE) / 3f64.sqrt();
        let most = 0.5 * size;
        let accuracy = if gathering.accuracy > 0.0 { gathering.accuracy } else { 1.0 };
        let resolved = size * accuracy / f64::from(gathering.resolution.max(1));
        let least = if gathering.resolution > 0 && resolved < most { resolved } else { most / 64.0 };
        Limits { accuracy, least, most }
    }
}

/// Fills a cache for these rays, and says how many records are new. The result is a function of the plan and all rays so far:
/// threads only share the work of a group.
pub(crate) fn gather<const BANDS: usize>(
    plan: &RenderPlan,
    cache: &mut Option<Cache<BANDS>>,
    rays: &[Option<Ray>],
) -> usize {
    let limits = plan.gathering_limits();
    let cache = cache.get_or_insert_with(|| Cache::new(limits));
    let before = cache.len();
    let hemisphere = Hemisphere::with_divisions(plan.options.gathering.rays());
    let order = scattered(rays.len());
    let most = MOST_RAYS * rays.len() / hemisphere.len();
    let (mut first, mut batch) = (0, FIRST_BATCH);
    while first < order.len() && cache.len() - before < most {
        let end = (first + batch).min(order.len());
        let missing = survey(plan, cache, rays, &order[first..end]);
        for group in missing.chunks(GROUP) {
            let uncovered: Vec<&Place<BANDS>> = group.iter().filter(|place| !place.is_covered(cache)).collect();
            let number = cache.len() as u64;
            let records: Vec<_> = uncovered
                .par_iter()
                .enumerate()
                .map_init(
                    || Tracer::new(plan, None),
                    |tracer, (index, place)| tracer.look_around(place, &hemisphere, number + index as u64, &limits),
                )
                .collect();
            records.into_iter().for_each(|record| cache.insert(record));
        }
        first = end;
        batch = (2 * batch).min(LARGEST_BATCH);
    }
    cache.len() - before
}

/// Where these rays want irradiance that the cache does not have.
fn survey<const BANDS: usize>(
    plan: &RenderPlan,
    cache: &Cache<BANDS>,
    rays: &[Option<Ray>],
    order: &[usize],
) -> Vec<Place<BANDS>> {
    order
        .par_iter()
        .map_init(
            || Tracer::new(plan, Some(cache)),
            |tracer, index| {
                tracer.survey = Some(Vec::new());
                if let Some(ray) = &rays[*index] {
                    let _ = tracer.trace(*index as u64, ray);
                }
                tracer.survey.take().unwrap_or_default()
            },
        )
        .flatten_iter()
        .collect()
}

/// All indices, so that any first part of them is spread evenly: steps by the golden section (made coprime to the count).
fn scattered(count: usize) -> Vec<usize> {
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
