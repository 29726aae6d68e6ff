//! Gathering irradiance before the picture is made, where its rays will want it.

use crate::gather::{Look, Place, Survey};
use crate::plan::RenderPlan;
use crate::ray::{Ray, Spread};
use crate::trace::Tracer;
use radsight_irradiance::{Cache, Hemisphere, Limits, Record};
use rayon::prelude::*;

/// Rays that are surveyed together at first; later more, as fewer of them find something missing.
const FIRST_BATCH: usize = 64;
const LARGEST_BATCH: usize = 4096;

/// Places from which is looked around at once: few, since they do not know of each other.
const GROUP: usize = 16;

/// Looking around takes at most so many rays for each that is surveyed, and in small pictures at most so many in all: beyond that drawing
/// single rays is the better use of time, and places that no record reaches do that.
const MOST_RAYS: usize = 64;
const MOST_RAYS_OF_FEW: usize = 1 << 23;

/// A place looks around with this share of the rays on which its irradiance shall rest, since those of its neighbours count too.
const FIRST_SHARE: usize = 8;

/// But with at least so many, which say how far away things are.
const FEWEST_RAYS: usize = 32;

/// Irradiance rests on at most so many times the rays that are asked for, where they leave too much noise.
const MOST_FURTHER: f64 = 8.0;

/// What is darker than this share of the typical irradiance need not be more exact than that is.
const DARK: f64 = 0.1;

/// How often the rays are surveyed: where the irradiance bends, records are trusted less far than they seemed at first.
const SURVEYS: usize = 3;

/// Rounds of further rays where there are too few neighbours.
const FURTHER_ROUNDS: usize = 3;

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
    gathered: &mut Option<GatheredIrradiance<BANDS>>,
    rays: &[Option<Ray>],
    spread: Spread,
) -> usize {
    let gathered = gathered.get_or_insert_with(|| GatheredIrradiance::new(plan));
    let before = gathered.cache.len();
    gathered.budget = gathered.rays + MOST_RAYS_OF_FEW.max(MOST_RAYS * rays.len());
    for survey in 0..SURVEYS {
        if survey > 0 {
            gathered.cache.shorten_reaches();
        }
        let known = gathered.cache.len();
        gathered.fill(plan, rays, spread);
        if gathered.cache.len() == known {
            break;
        }
        gathered.settle();
    }
    for _ in 0..FURTHER_ROUNDS {
        if gathered.look_again(plan, before) == 0 {
            break;
        }
        gathered.settle();
    }
    gathered.cache.len() - before
}

/// Irradiance that is shared, and what it was gathered from.
#[derive(Debug)]
pub(crate) struct GatheredIrradiance<const BANDS: usize> {
    pub(crate) cache: Cache<BANDS>,
    /// Where each record looked around.
    places: Vec<Place<BANDS>>,
    /// The hemisphere of a first look.
    hemisphere: Hemisphere,
    /// Rays spent so far, and how many may be.
    rays: usize,
    budget: usize,
    /// Looks so far: each has random numbers of its own.
    looks: u64,
}

impl<const BANDS: usize> GatheredIrradiance<BANDS> {
    fn new(plan: &RenderPlan) -> Self {
        let wanted = plan.options.gathering.rays();
        let hemisphere = Hemisphere::with_divisions((wanted / FIRST_SHARE).max(FEWEST_RAYS.min(wanted)));
        let cache = Cache::new(plan.gathering_limits());
        GatheredIrradiance { cache, places: Vec::new(), hemisphere, rays: 0, budget: 0, looks: 0 }
    }

    /// Looks around where these rays want irradiance that is not there.
    fn fill(&mut self, plan: &RenderPlan, rays: &[Option<Ray>], spread: Spread) {
        let order = scattered(rays.len());
        let (mut first, mut batch) = (0, FIRST_BATCH);
        while first < order.len() && self.rays < self.budget {
            let end = (first + batch).min(order.len());
            let missing = survey(plan, &self.cache, rays, &order[first..end], spread);
            for group in missing.chunks(GROUP) {
                let uncovered: Vec<_> = group
                    .iter()
                    .filter(|place| !place.is_covered(&self.cache))
                    .map(|place| (place.clone(), place.next_stratum(&self.cache)))
                    .collect();
                let records = self.look_around(plan, &uncovered);
                for ((place, stratum), record) in uncovered.into_iter().zip(records) {
                    self.cache.insert(record, stratum);
                    self.places.push(place);
                }
            }
            first = end;
            batch = (2 * batch).min(LARGEST_BATCH);
        }
    }

    /// Looks again from where irradiance rests on too few rays, and says from how many places.
    fn look_again(&mut self, plan: &RenderPlan, first: usize) -> usize {
        let typical = self.cache.typical();
        let missing: Vec<usize> =
            (first..self.cache.len()).map(|index| self.looks_missing(plan, index, typical)).collect();
        let wanted = missing.iter().sum::<usize>() * self.hemisphere.len();
        // Where there is not enough for all, all get the same share.
        let share = (self.budget.saturating_sub(self.rays) as f64 / wanted.max(1) as f64).min(1.0);
        let (mut weak, mut again, mut due) = (Vec::new(), Vec::new(), 0.0);
        for (index, looks) in (first..).zip(missing) {
            due += looks as f64 * share;
            while due >= 1.0 {
                due -= 1.0;
                weak.push(index);
                again.push((self.places[index].clone(), self.cache.take_stratum(index)));
            }
        }
        let records = self.look_around(plan, &again);
        for (index, record) in weak.iter().zip(records) {
            self.cache.add(*index, &record);
        }
        weak.len()
    }

    /// How many more looks a record needs if its neighbours look as often again: the rays that all rest on grow as those of each.
    fn looks_missing(&self, plan: &RenderPlan, index: usize, typical: f64) -> usize {
        let gathering = &plan.options.gathering;
        let (record, fit) = self.cache.fitted(index);
        let wanted = gathering.rays() as f64;
        let allowed = gathering.noise * fit.strength().max(DARK * typical);
        let noisy = (fit.standard_error() / allowed.max(f64::MIN_POSITIVE)).powi(2) * fit.rays();
        let wanted = noisy.clamp(wanted, MOST_FURTHER * wanted);
        let missing = record.rays() * (wanted / fit.rays() - 1.0);
        (missing / self.hemisphere.len() as f64 - 0.5).ceil().max(0.0) as usize
    }

    fn look_around(&mut self, plan: &RenderPlan, places: &[(Place<BANDS>, usize)]) -> Vec<Record<BANDS>> {
        let (first, limits, hemisphere) = (self.looks, self.cache.limits(), &self.hemisphere);
        self.looks += places.len() as u64;
        self.rays += places.len() * hemisphere.len();
        places
            .par_iter()
            .enumerate()
            .map_init(
                || Tracer::new(plan, None),
                |tracer, (index, (place, stratum))| {
                    let look = Look { hemisphere, stratum: Some(*stratum), number: first + index as u64 };
                    tracer.look_around(place, &look, limits)
                },
            )
            .collect()
    }

    /// Fits the irradiance to what is known by now.
    fn settle(&mut self) {
        let stale = self.cache.stale();
        let fits: Vec<_> = stale.par_iter().map(|index| self.cache.fit(*index)).collect();
        for (index, fit) in stale.into_iter().zip(fits) {
            self.cache.adopt(index, fit);
        }
    }
}

/// Where these rays want irradiance that the cache does not have.
fn survey<const BANDS: usize>(
    plan: &RenderPlan,
    cache: &Cache<BANDS>,
    rays: &[Option<Ray>],
    order: &[usize],
    spread: Spread,
) -> Vec<Place<BANDS>> {
    order
        .par_iter()
        .map_init(
            || Tracer::new(plan, Some(cache)),
            |tracer, index| {
                tracer.survey = Some(Survey { places: Vec::new(), spread });
                if let Some(ray) = &rays[*index] {
                    let _ = tracer.trace(*index as u64, ray);
                }
                tracer.survey.take().map(|survey| survey.places).unwrap_or_default()
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
