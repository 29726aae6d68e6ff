//! How many rays the points of an irradiance cache get: more where they are few and share no
//! neighbours, and where they are bounded about as many as Radiance traces in the same time.

use radsight_compile::{Quantity, RenderOptions, RenderPlan};

/// Minimum number of sample rays of a cache point that find the points of the second cache, and
/// total of those of sensors.
const SAMPLES_PER_POINT: usize = 16;
const SENSOR_SAMPLES: usize = 1024;

/// With fewer rays than this there is no second cache: their own paths cost less.
const MIN_RAYS_FOR_SECOND_CACHE: usize = 256;

/// Factor of the noise of the second cache. Pixels average it; sensors, which use the same few of its
/// records, do not.
const NOISIER: f64 = 8.0;
const NOISIER_FOR_SENSORS: f64 = 3.0;

/// Up to this many points are few. Each gets this many times the requested rays, as paths of one
/// ray per bounce, since it has few neighbours. Radiance takes about as long, since every point hit
/// sends as many rays again if there are more bounces. More points share as many rays.
const FEW_POINTS: f64 = 16.0;
const RAYS_OF_A_POINT: f64 = 8.0;

/// The same where rays are bounded, for more bounces than one and for one; for one, single points
/// get more, which take no time. More points share more rays: Radiance's time grows with the first
/// power of their number up to the given one, and with the second or third beyond, for one bounce
/// and for more.
const BOUNDED_RAYS_OF_A_POINT: f64 = 4.0;
const BOUNDED_RAYS_OF_ONE_BOUNCE: f64 = 1.2;
const BOUNDED_RAYS_OF_SINGLE_POINT: f64 = 2.0;
const SOME_POINTS: f64 = 1024.0;
const GROWTH_OF_FEW: f64 = 0.4;
const GROWTH_OF_MANY: f64 = 0.7;
const GROWTH_OF_MANY_FURTHER_BOUNCES: f64 = 0.5;

/// Up to this many points with more than one bounce are sensors, whose values are used one by one.
/// Each gets this many times the requested rays. From the given total number of rays on, a second
/// cache pays, where these rays end. Then each gets fewer, down to the given share, if less than the
/// given number is requested, since Radiance's sensors cost little there.
const MAX_SENSORS: usize = 128;
const RAYS_OF_A_SENSOR: f64 = 12.0;
const LEAST_SENSOR_SHARE: f64 = 1.0 / 3.0;
const ACCURATE_SENSOR_RAYS: f64 = 2048.0;
const MIN_SENSOR_RAYS: f64 = 16_384.0;

/// With a smaller resolution (`-ar`) than this, Radiance has so few records of further bounces that
/// the first one decides about its time: points get rays in proportion, down to this fraction. More
/// points than sensors share records of the first bounce as well: the second number and
/// fraction. With a larger `-aa` than the third number, fewer records cover an area.
const FINE_RESOLUTION: f64 = 64.0;
const MIN_COARSE_SHARE: f64 = 0.35;
const FINE_RESOLUTION_OF_MANY: f64 = 128.0;
const MIN_COARSE_SHARE_OF_MANY: f64 = 0.2;
const FINE_ACCURACY: f64 = 0.2;

/// Maximum number of rays of bounded points, relative to their minimum: in the first cache and in the
/// second.
pub(crate) const MOST_RAYS: f64 = 1.2;
pub(crate) const MOST_RAYS_BEYOND: f64 = 0.7;

/// Whether this many points are sensors with light of more than one bounce.
fn are_sensors(plan: &RenderPlan, points: usize) -> bool {
    let options = &plan.options;
    options.quantity != Quantity::Radiance && options.ambient_bounces > 1 && points <= MAX_SENSORS
}

/// Whether a second cache pays for this many points.
pub(crate) fn pays_for_second_cache(plan: &RenderPlan, points: usize) -> bool {
    points >= MIN_RAYS_FOR_SECOND_CACHE || are_sensors(plan, points) && pays_for_sensors(plan, points)
}

/// Whether a second cache pays for this many sensors.
fn pays_for_sensors(plan: &RenderPlan, points: usize) -> bool {
    shared_rays(&plan.options, RAYS_OF_A_SENSOR, points) * points as f64 >= MIN_SENSOR_RAYS
}

/// Allowed relative standard error of the second cache, for this number of points.
pub(crate) fn second_cache_noise(plan: &RenderPlan, points: usize) -> f64 {
    let factor = if are_sensors(plan, points) { NOISIER_FOR_SENSORS } else { NOISIER };
    factor * plan.options.gathering.noise
}

/// Number of sample rays of a cache point that find the points of the second cache.
pub(crate) fn sample_rays(plan: &RenderPlan, points: usize) -> usize {
    let share = if are_sensors(plan, points) { SENSOR_SAMPLES / points.max(1) } else { SAMPLES_PER_POINT };
    share.max(SAMPLES_PER_POINT)
}

/// Minimum number of own rays of a record, for this total number of points.
pub(crate) fn least_own_rays(plan: &RenderPlan, points: usize) -> f64 {
    let options = &plan.options;
    let factor = if options.ambient_bounces == 1 && options.gathering.bounded {
        if points == 1 { BOUNDED_RAYS_OF_SINGLE_POINT } else { BOUNDED_RAYS_OF_ONE_BOUNCE }
    } else if !are_sensors(plan, points) {
        if options.gathering.bounded { BOUNDED_RAYS_OF_A_POINT } else { RAYS_OF_A_POINT }
    } else if pays_for_sensors(plan, points) {
        (options.gathering.rays() as f64 / ACCURATE_SENSOR_RAYS).clamp(LEAST_SENSOR_SHARE, 1.0) * RAYS_OF_A_SENSOR
    } else {
        RAYS_OF_A_SENSOR
    };
    coarse_share(options, points) * shared_rays(options, factor, points)
}

/// Maximum number of rays of all points, relative to the minimum; no limit unless they are bounded.
pub(crate) fn most_rays(plan: &RenderPlan, points: usize, share: f64) -> usize {
    if plan.options.gathering.bounded {
        (share * least_own_rays(plan, points) * points as f64) as usize
    } else {
        usize::MAX
    }
}

/// The fraction of rays that bounded points get for the resolution and accuracy of the cache.
fn coarse_share(options: &RenderOptions, points: usize) -> f64 {
    let gathering = &options.gathering;
    let resolution = f64::from(gathering.resolution);
    if !gathering.bounded || options.ambient_bounces <= 1 || resolution == 0.0 {
        return 1.0;
    }
    let (fine, least) = if points <= MAX_SENSORS {
        (FINE_RESOLUTION, MIN_COARSE_SHARE)
    } else {
        (FINE_RESOLUTION_OF_MANY, MIN_COARSE_SHARE_OF_MANY)
    };
    let by_accuracy = (FINE_ACCURACY / gathering.accuracy.max(FINE_ACCURACY)).powi(2);
    (by_accuracy * (resolution / fine).min(1.0)).max(least)
}

/// This multiple of the requested rays (`-ad`, `-as`) for each of few points, which have hardly any
/// neighbours; more points share as many, or more if they are bounded.
fn shared_rays(options: &RenderOptions, factor: f64, points: usize) -> f64 {
    let times = (points as f64 / FEW_POINTS).max(1.0);
    let growth = if options.gathering.bounded { growth_by_points(options, points as f64) } else { 1.0 };
    factor * options.gathering.rays() as f64 * growth / times
}

/// Factor by which more points than few share more rays if they are bounded.
fn growth_by_points(options: &RenderOptions, points: f64) -> f64 {
    let of_many = if options.ambient_bounces > 1 { GROWTH_OF_MANY_FURTHER_BOUNCES } else { GROWTH_OF_MANY };
    let few = (points.min(SOME_POINTS) / FEW_POINTS).max(1.0);
    few.powf(GROWTH_OF_FEW) * (points / SOME_POINTS).max(1.0).powf(of_many)
}

#[cfg(test)]
mod tests {
    use super::*;
    use radsight_compile::Gathering;

    fn options(divisions: u32) -> RenderOptions {
        let gathering = Gathering { divisions, super_samples: 0, ..Gathering::default() };
        RenderOptions { gathering, ..RenderOptions::default() }
    }

    #[test]
    fn few_points_trace_more_rays_than_are_asked_for_and_pixels_do_not_have_to() {
        for points in [1, 9, 16] {
            assert!(shared_rays(&options(2304), RAYS_OF_A_POINT, points) > 2304.0, "{points} points");
        }
        assert!(shared_rays(&options(1000), RAYS_OF_A_POINT, 100_000) < 2.0);
    }

    #[test]
    fn many_points_share_the_rays_of_few_and_bounded_ones_more() {
        let unbounded = options(100);
        let mut bounded = unbounded.clone();
        bounded.gathering.bounded = true;
        let total = |options: &RenderOptions, points: usize| points as f64 * shared_rays(options, 8.0, points);
        let few = total(&unbounded, 16);
        assert_eq!(few, total(&bounded, 16));
        assert!((17..5000).all(|points| (total(&unbounded, points) - few).abs() < 1e-6));
        let growth = |points: usize| total(&bounded, points) / few;
        assert!((17..=1024).all(|points| growth(points) > 1.0 && growth(points) < (points as f64 / 16.0).sqrt()));
        assert!((1025..5000).all(|points| growth(points) > growth(1024) && growth(points) < points as f64 / 16.0));
    }
}
