//! Records in scenes with known irradiance.

use glam::DVec3;
use radsight_irradiance_cache::{
    Cache, GatherHit, GatheredRadiance, Hemisphere, Limits, Occluders, Record, STRATA, StoredBytes, Unobstructed,
};
use radsight_sampling::{DimensionSet, RaySampler};
use std::f64::consts::PI;

const LIMITS: Limits = Limits { accuracy: 0.2, min_reach: 1e-3, max_reach: 10.0, explained: 1.0 };

/// A record of a function that gives radiance and distance of a ray.
fn record(at: DVec3, normal: DVec3, divisions: usize, world: impl Fn(DVec3, DVec3) -> (f64, f64)) -> Record<1> {
    record_of_seed(1, at, normal, divisions, world)
}

fn record_of_seed(
    seed: u64,
    at: DVec3,
    normal: DVec3,
    divisions: usize,
    world: impl Fn(DVec3, DVec3) -> (f64, f64),
) -> Record<1> {
    let hemisphere = Hemisphere::with_divisions(divisions);
    let [x, y, z] = Record::<1>::frame(normal);
    let share = PI / hemisphere.len() as f64;
    let (seen, hits): (Vec<GatheredRadiance<1>>, Vec<GatherHit<1>>) = (0..hemisphere.len())
        .map(|cell| {
            let u = RaySampler::new(seed, cell as u64).take(DimensionSet::CAMERA);
            let local = hemisphere.direction(cell, [u[0], u[1]]);
            let direction = x * local.x + y * local.y + z * local.z;
            let (radiance, distance) = world(at, direction);
            let hit = GatherHit { direction, distance, normal: None, irradiance: [share * radiance] };
            (GatheredRadiance { radiance: [radiance], distance }, hit)
        })
        .unzip();
    Record::new(at, normal, &hemisphere, &seen, &LIMITS).with_hits(&hits, 0.5)
}

/// A glowing disk of radius 1 above the origin at height 1, seen from any point of the plane z = 0.
fn disk(at: DVec3, direction: DVec3) -> (f64, f64) {
    let distance = (1.0 - at.z) / direction.z;
    let hit = at + direction * distance;
    if direction.z > 0.0 && hit.x.hypot(hit.y) < 1.0 { (1.0, distance) } else { (0.0, 100.0) }
}

/// Irradiance of a horizontal point at distance `a` from the axis of that disk: π times the view
/// factor from a small plane to a parallel disk (Howell, A Catalog of Radiation Heat Transfer
/// Configuration Factors, B-13).
fn disk_irradiance(a: f64) -> f64 {
    let z = 1.0 + 1.0 + a * a;
    0.5 * PI * (1.0 - (1.0 + a * a - 1.0) / (z * z - 4.0 * a * a).sqrt())
}

fn at(record: Record<1>, position: DVec3, normal: DVec3) -> f64 {
    let mut cache = Cache::new(LIMITS);
    cache.insert(record, 0);
    cache.irradiance(position, normal, normal, &Unobstructed).expect("the record reaches")[0]
}

#[test]
fn irradiance_of_a_disk() {
    for a in [0.0, 0.3, 0.9] {
        let position = DVec3::new(a, 0.0, 0.0);
        let found = at(record(position, DVec3::Z, 20_000, disk), position, DVec3::Z);
        assert!((found / disk_irradiance(a) - 1.0).abs() < 5e-3, "{found} against {}", disk_irradiance(a));
    }
}

#[test]
fn a_small_move_follows_the_gradient() {
    let position = DVec3::new(0.5, 0.2, 0.0);
    let record = record(position, DVec3::Z, 20_000, disk);
    for step in [DVec3::new(0.02, 0.0, 0.0), DVec3::new(0.0, 0.03, 0.0), DVec3::new(-0.02, 0.01, 0.0)] {
        let found = at(record, position + step, DVec3::Z) - at(record, position, DVec3::Z);
        let right = disk_irradiance((position + step).length()) - disk_irradiance(position.length());
        assert!((found - right).abs() < 0.1 * right.abs() + 2e-4, "{step}: {found} against {right}");
    }
}

/// Brighter to one side: the irradiance varies with the normal.
#[test]
fn a_small_turn_follows_the_gradient() {
    let sky = |_: DVec3, direction: DVec3| (1.0 + 0.5 * direction.x, 50.0);
    let before = record(DVec3::ZERO, DVec3::Z, 20_000, sky);
    let turned = DVec3::new(0.1, 0.05, 1.0).normalize();
    let found = at(before, DVec3::ZERO, turned);
    // ∫(1 + n·x/2) cos θ dω = π (1 + ⅓ n_x).
    let right = PI * (1.0 + turned.x / 3.0);
    assert!((found / right - 1.0).abs() < 3e-3, "{found} against {right}");
}

/// The tangents at the centres of as many cells as rays would be 17 and 13 % too small.
#[test]
fn few_cells_give_the_whole_gradient_of_a_turn() {
    let sky = |_: DVec3, direction: DVec3| (1.0 + 0.9 * direction.x, 50.0);
    let facet = DVec3::new(0.8, 0.0, 0.6);
    for (divisions, tolerance) in [(16, 0.02), (64, 0.02), (256, 0.01)] {
        let seeds = 256;
        let found: Vec<f64> = (0..seeds)
            .map(|seed| {
                let record = record_of_seed(seed, DVec3::ZERO, DVec3::Z, divisions, sky);
                record.irradiance_on(facet)[0] - record.irradiance_on(DVec3::Z)[0]
            })
            .collect();
        let mean = found.iter().sum::<f64>() / seeds as f64;
        // 0.9 n_x ∫ ω_x² dω over the hemisphere.
        let right = 0.9 * facet.x * 2.0 * PI / 3.0;
        assert!((mean / right - 1.0).abs() < tolerance, "{divisions}: {mean} against {right}");
    }
}

#[test]
fn a_record_does_not_reach_round_an_edge() {
    let mut cache = Cache::new(LIMITS);
    cache.insert(record(DVec3::ZERO, DVec3::Z, 256, |_, _| (1.0, 1.0)), 0);
    assert!(cache.irradiance(DVec3::new(0.05, 0.0, 0.0), DVec3::Z, DVec3::Z, &Unobstructed).is_some());
    assert!(cache.irradiance(DVec3::new(0.05, 0.0, 0.0), DVec3::X, DVec3::X, &Unobstructed).is_none());
    assert!(cache.irradiance(DVec3::new(0.05, 0.0, -0.1), DVec3::Z, DVec3::Z, &Unobstructed).is_none());
}

#[test]
fn fine_irradiance_uses_records_of_small_reach() {
    let mut cache = Cache::new(LIMITS);
    cache.insert(record(DVec3::ZERO, DVec3::Z, 256, |_, _| (1.0, 1.0)), 0);
    let within =
        |reach: f64| cache.fine_irradiance(DVec3::new(0.05, 0.0, 0.0), DVec3::Z, DVec3::Z, &Unobstructed, reach);
    let reach = LIMITS.accuracy;
    assert_eq!(within(0.9 * reach), None);
    let fine = within(1.1 * reach).expect("the record reaches less far");
    assert!((fine[0] / PI - 1.0).abs() < 1e-9, "{fine:?}");
}

#[test]
fn rebuilding_the_index_changes_no_value() {
    let mut cache = Cache::new(LIMITS);
    cache.insert(record(DVec3::ZERO, DVec3::Z, 256, |_, _| (1.0, 10.0)), 0);
    cache.insert(record(DVec3::new(-0.1, 0.0, 0.0), DVec3::Z, 256, |_, _| (2.0, 0.1)), 0);
    let mut sorted = cache.clone();
    sorted.rebuild_index();
    for x in -20..40 {
        let position = DVec3::new(0.01 * f64::from(x), 0.0, 0.0);
        let of = |cache: &Cache<1>| cache.irradiance(position, DVec3::Z, DVec3::Z, &Unobstructed);
        assert_eq!(of(&cache), of(&sorted), "at {position}");
    }
}

#[test]
fn a_near_neighbour_limits_the_reach() {
    let mut cache = Cache::new(LIMITS);
    cache.insert(record(DVec3::ZERO, DVec3::Z, 256, |_, _| (1.0, 10.0)), 0);
    let far = DVec3::new(0.5, 0.0, 0.0);
    assert!(cache.irradiance(far, DVec3::Z, DVec3::Z, &Unobstructed).is_some());
    cache.insert(record(DVec3::new(-0.1, 0.0, 0.0), DVec3::Z, 256, |_, _| (1.0, 0.1)), 0);
    assert!(cache.irradiance(far, DVec3::Z, DVec3::Z, &Unobstructed).is_none());
}

/// Records on a square grid over part of the plane below the disk.
fn field(divisions: usize, world: impl Fn(DVec3, DVec3) -> (f64, f64)) -> Cache<1> {
    field_within(LIMITS, divisions, world)
}

fn field_within(limits: Limits, divisions: usize, world: impl Fn(DVec3, DVec3) -> (f64, f64)) -> Cache<1> {
    let mut cache = Cache::new(limits);
    let mut strata = [0; STRATA];
    for row in -5..=5 {
        for column in -5..=5 {
            let position = DVec3::new(0.1 * f64::from(column), 0.1 * f64::from(row), 0.0);
            // A different function of the same numbers in each hemisphere.
            let turned = |at: DVec3, direction: DVec3| {
                let angle = 2.4 * f64::from(11 * row + column);
                let (sin, cos) = angle.sin_cos();
                let DVec3 { x, y, z } = direction;
                world(at, DVec3::new(cos * x - sin * y, sin * x + cos * y, z))
            };
            let gather = cache.next_gather(position, DVec3::Z);
            strata[gather % STRATA] += 1;
            cache.insert(record(position, DVec3::Z, divisions, turned), gather);
        }
    }
    // Neighbourhoods are wide enough to sample all strata, even at the rim of the field, though
    // less evenly.
    assert!(strata.iter().all(|gathers| 2 * STRATA * gathers >= 11 * 11), "gathers through each stratum: {strata:?}");
    let fits: Vec<_> = cache.stale().into_iter().map(|index| (index, cache.fit(index, &Unobstructed))).collect();
    fits.into_iter().for_each(|(index, fit)| cache.adopt(index, fit));
    cache.reduce_reaches();
    assert!(cache.stale().is_empty());
    cache
}

#[test]
fn neighbouring_records_share_rays() {
    // Bright and dark patches finer than the cells: noise around an irradiance of π.
    let patches = |_: DVec3, direction: DVec3| (1.0 + (400.0 * direction.x).sin() * (500.0 * direction.y).sin(), 1.0);
    let cache = field(48, patches);
    let (mut alone, mut together) = (0.0, 0.0);
    for index in 0..cache.len() {
        let (record, fit) = cache.fitted(index);
        assert!(fit.rays() > 3.0 * record.rays(), "{} of {}", fit.rays(), record.rays());
        let position = DVec3::new(0.1 * (index % 11) as f64 - 0.5, 0.1 * (index / 11) as f64 - 0.5, 0.0);
        alone += (record.irradiance_on(DVec3::Z)[0] - PI).powi(2);
        together +=
            (cache.irradiance(position, DVec3::Z, DVec3::Z, &Unobstructed).expect("a record is here")[0] - PI).powi(2);
    }
    assert!(together < 0.4 * alone, "squared error {together} together, {alone} alone");
}

#[test]
fn shadows_determine_the_brightness() {
    // An irradiance of π, of which a lamp gives half of the plane three times as much.
    let even = |_: DVec3, _: DVec3| (1.0, 1.0);
    let mut cache = Cache::new(LIMITS);
    for column in -5..=5 {
        let position = DVec3::new(0.1 * f64::from(column), 0.0, 0.0);
        let from_lamp = if column > 0 { 3.0 * PI } else { 0.0 };
        cache.insert(
            record(position, DVec3::Z, 48, even).with_ungathered(from_lamp),
            cache.next_gather(position, DVec3::Z),
        );
    }
    let fits: Vec<_> = cache.stale().into_iter().map(|index| (index, cache.fit(index, &Unobstructed))).collect();
    fits.into_iter().for_each(|(index, fit)| cache.adopt(index, fit));
    let brightness = |index: usize| cache.fitted(index).1.brightness() / PI;
    assert!((brightness(0) - 1.0).abs() < 1e-6, "in the shadow {}", brightness(0));
    assert!((brightness(10) - 4.0).abs() < 1e-6, "in the light {}", brightness(10));
    // With half of each, the harmonic mean is 2 / (1 + 1/4), the arithmetic mean 2.5.
    assert!((1.2..2.0).contains(&brightness(5)), "on the border {}", brightness(5));
}

#[test]
fn the_reach_is_smaller_where_the_irradiance_jumps() {
    let step = |at: DVec3, _: DVec3| (if at.x < 0.05 { 1.0 } else { 2.0 }, 1.0);
    let cache = field(48, step);
    let between = |x: f64| cache.irradiance(DVec3::new(x, 0.05, 0.0), DVec3::Z, DVec3::Z, &Unobstructed);
    assert!(between(-0.45).is_some_and(|found| (found[0] / PI - 1.0).abs() < 0.02), "{:?}", between(-0.45));
    assert!(between(0.45).is_some_and(|found| (found[0] / PI - 2.0).abs() < 0.02), "{:?}", between(0.45));
    let in_gap = cache
        .trusted_irradiance(DVec3::new(0.05, 0.05, 0.0), DVec3::Z, DVec3::Z, &Unobstructed, f64::INFINITY)
        .expect("records are near");
    assert!((PI..2.0 * PI).contains(&in_gap[0]), "{in_gap:?}");
    assert!(between(0.05).is_none(), "on the step something new is needed, found {:?}", between(0.05));
}

#[test]
fn weak_nonlinearity_is_found_with_less_explained_noise() {
    // The light from above varies with direction, which looks like noise to the rays. It is equal
    // at all positions except for a step of a quarter.
    let small_step = |at: DVec3, direction: DVec3| {
        let step = if at.x < 0.05 { 1.0 } else { 1.25 };
        (step * (1.0 + 0.9 * (9.0 * direction.z).sin()), 1.0)
    };
    let reached = |explained: f64| {
        let cache = field_within(Limits { explained, ..LIMITS }, 48, small_step);
        (-4..5)
            .filter(|row| cache.reaches(DVec3::new(0.05, 0.1 * f64::from(*row) + 0.05, 0.0), DVec3::Z, &Unobstructed))
            .count()
    };
    let [hidden, found] = [1.0, 0.02].map(reached);
    assert!(hidden == 9 && found < 5, "of 9 places on the step records reach {hidden} and {found}");
}

#[test]
fn large_interpolation_errors_are_rejected() {
    let step = |at: DVec3, _: DVec3| (if at.x < 0.05 { 1.0 } else { 10.0 }, 1.0);
    let cache = field(48, step);
    let [with_ungathered, far] = [0.0, -0.4].map(|x| DVec3::new(x, 0.0, 0.0));
    assert!(
        cache.irradiance(with_ungathered, DVec3::Z, DVec3::Z, &Unobstructed).is_some()
            && cache.irradiance(far, DVec3::Z, DVec3::Z, &Unobstructed).is_some()
    );
    let trusted = |position: DVec3| cache.trusted_irradiance(position, DVec3::Z, DVec3::Z, &Unobstructed, 0.2);
    assert_eq!(trusted(with_ungathered), None);
    assert_eq!(trusted(far), cache.irradiance(far, DVec3::Z, DVec3::Z, &Unobstructed));
    let in_gap = DVec3::new(0.05, 0.05, 0.0);
    let unlimited = cache.trusted_irradiance(in_gap, DVec3::Z, DVec3::Z, &Unobstructed, f64::INFINITY);
    assert!(
        cache.irradiance(in_gap, DVec3::Z, DVec3::Z, &Unobstructed).is_none()
            && unlimited.is_some()
            && trusted(in_gap).is_none()
    );
}

#[test]
fn shares_are_the_weights_of_the_records() {
    let cache = field(48, |at, _| (1.0 + at.x, 1.0));
    let position = DVec3::new(0.13, 0.02, 0.0);
    let mut shares = vec![(7, 0.25)];
    cache.shares(position, DVec3::Z, &Unobstructed, &mut shares);
    assert_eq!(shares[0], (7, 0.25), "what was there stays");
    let total: f64 = shares[1..].iter().map(|(_, share)| share).sum();
    assert!((total - 1.0).abs() < 1e-12 && shares.len() > 1);
    let before = shares.len();
    cache.shares(DVec3::Z * 1e3, DVec3::Z, &Unobstructed, &mut shares);
    assert_eq!(shares.len(), before, "nothing reaches there");
}

/// Most records have none of the few bright rays: those of the neighbours count as well.
#[test]
fn rare_bright_rays_do_not_bias_the_mean() {
    let (mut sum, mut own, mut count) = (0.0, 0.0, 0.0);
    for turn in 0..20 {
        let sparks = |at: DVec3, direction: DVec3| {
            let key = direction.dot(DVec3::new(127.1, 311.7, 74.7)) + at.dot(DVec3::new(269.5, 183.3, 1.0));
            let by_chance = ((key + f64::from(turn)).sin() * 43_758.545_3).rem_euclid(1.0);
            (if by_chance < 0.01 { 100.0 } else { 0.0 }, 1.0)
        };
        let cache = field(48, sparks);
        for index in 0..cache.len() {
            let position = DVec3::new(0.1 * (index % 11) as f64 - 0.5, 0.1 * (index / 11) as f64 - 0.5, 0.0);
            own += cache.fitted(index).0.irradiance_on(DVec3::Z)[0] / PI;
            let shared = cache.trusted_irradiance(position, DVec3::Z, DVec3::Z, &Unobstructed, f64::INFINITY);
            sum += shared.expect("a record is here")[0] / PI;
            count += 1.0;
        }
    }
    assert!((sum / own - 1.0).abs() < 0.05, "the mean is {} where places found {}", sum / count, own / count);
}

/// Irradiance at many points of the plane.
fn everywhere(cache: &Cache<1>) -> Vec<Option<[f64; 1]>> {
    let position = |index: i32| DVec3::new(0.017 * f64::from(index % 64 - 32), 0.019 * f64::from(index / 64 - 32), 0.0);
    (0..4096).map(|index| cache.irradiance(position(index), DVec3::Z, DVec3::Z, &Unobstructed)).collect()
}

#[test]
fn a_saved_cache_gives_the_same_bits() {
    let cache = field(48, disk);
    let mut bytes = Vec::new();
    cache.save(&mut bytes);
    let mut stored = StoredBytes::new(&bytes);
    let restored = Cache::restored(&mut stored, LIMITS).unwrap();
    assert!(stored.is_empty() && restored.stale().is_empty());
    assert_eq!(everywhere(&restored), everywhere(&cache));
    let mut again = Vec::new();
    restored.save(&mut again);
    assert_eq!(again, bytes);
}

#[test]
fn a_cache_with_other_limits_is_stale() {
    let cache = field(48, disk);
    let mut bytes = Vec::new();
    cache.save(&mut bytes);
    let finer = Limits { accuracy: 0.5 * LIMITS.accuracy, ..LIMITS };
    let mut restored = Cache::restored(&mut StoredBytes::new(&bytes), finer).unwrap();
    let fits: Vec<_> = restored.stale().into_iter().map(|index| (index, restored.fit(index, &Unobstructed))).collect();
    assert_eq!(fits.len(), cache.len());
    fits.into_iter().for_each(|(index, fit)| restored.adopt(index, fit));
    let pairs = everywhere(&restored).into_iter().zip(everywhere(&cache));
    let both: Vec<_> = pairs.filter_map(|(one, two)| Some((one?[0], two?[0]))).collect();
    assert!(both.len() > 100 && both.iter().all(|(one, two)| (one / two - 1.0).abs() < 0.2), "{both:?}");
}

#[test]
fn damaged_bytes_are_refused() {
    let mut bytes = Vec::new();
    field(48, disk).save(&mut bytes);
    let restored = |bytes: &[u8]| Cache::<1>::restored(&mut StoredBytes::new(bytes), LIMITS);
    assert!((0..bytes.len()).step_by(97).all(|length| restored(&bytes[..length]).is_none()));
    // NaN, an infinite reach, a huge count.
    let first_record = 4 * 8 + 8;
    for (offset, number) in [(first_record, f64::NAN), (first_record + 3 * 8, 2.0), (0, 0.0), (16, f64::INFINITY)] {
        let mut changed = bytes.clone();
        changed[offset..offset + 8].copy_from_slice(&number.to_le_bytes());
        assert!(restored(&changed).is_none(), "{number} at {offset}");
    }
    bytes[4 * 8..5 * 8].copy_from_slice(&u64::MAX.to_le_bytes());
    assert!(restored(&bytes).is_none());
}

#[test]
fn merging_adds_records_where_none_reach() {
    let far = |x: f64| record(DVec3::new(x, 0.0, 0.0), DVec3::Z, 256, |_, _| (1.0, 1.0));
    let [mut one, mut two] = [Cache::new(LIMITS), Cache::new(LIMITS)];
    one.insert(far(0.0), 0);
    two.insert(far(0.01), 0);
    two.insert(far(5.0), 0);
    assert_eq!(one.merge(&two, 0, &Unobstructed), 1);
    let knows = |x: f64| one.irradiance(DVec3::new(x, 0.0, 0.0), DVec3::Z, DVec3::Z, &Unobstructed).is_some();
    assert!(one.len() == 2 && knows(0.0) && knows(5.0));
}

/// A wall in the plane x = 0 that stands on the plane z = 0.
struct Wall;

impl Occluders for Wall {
    fn separate(&self, from: DVec3, _normal: DVec3, to: DVec3) -> bool {
        from.x * to.x < 0.0
    }

    fn cover(&self, _from: DVec3, _normal: DVec3, _height: f64) -> bool {
        false
    }
}

/// A panel in the plane z = 0.01 above the half x > 0 of the plane z = 0.
struct Panel;

impl Occluders for Panel {
    fn separate(&self, _from: DVec3, _normal: DVec3, _to: DVec3) -> bool {
        false
    }

    fn cover(&self, from: DVec3, normal: DVec3, height: f64) -> bool {
        from.x > 0.0 && from.z < 0.01 && from.z + height * normal.z > 0.01
    }
}

#[test]
fn records_on_a_panel_are_not_used_below_it_nor_those_below_it_on_the_panel() {
    let on_panel = |x: f64| DVec3::new(x, 0.0, 0.01);
    let below = |x: f64| DVec3::new(x, 0.0, 0.0);
    for (known, asked, is_hidden) in [
        (on_panel(0.1), below(0.11), true),
        (below(0.1), on_panel(0.11), true),
        (on_panel(0.1), on_panel(0.11), false),
        (below(0.1), below(0.11), false),
        // Beside the panel.
        (on_panel(0.005), below(-0.005), false),
    ] {
        let mut cache = Cache::new(LIMITS);
        cache.insert(record(known, DVec3::Z, 256, |_, _| (1.0, 1.0)), 0);
        let at = |occluders: &dyn Occluders| cache.irradiance(asked, DVec3::Z, DVec3::Z, occluders);
        assert!(at(&Unobstructed).is_some(), "the record at {known} reaches {asked}");
        assert_eq!(at(&Panel).is_none(), is_hidden, "from {known} to {asked}");
    }
}

#[test]
fn records_behind_a_wall_contribute_neither_to_points_nor_to_fits() {
    let mut cache = Cache::new(LIMITS);
    let hemisphere = Hemisphere::with_divisions(64);
    for (x, radiance) in [(-0.15, 1.0), (-0.05, 1.0), (0.05, 0.01), (0.15, 0.01)] {
        let position = DVec3::new(x, 0.0, 0.0);
        // The distance of everything is 1 for the reach, but rays along the surface hit the wall.
        let seen = vec![GatheredRadiance { radiance: [radiance], distance: 1.0 }; hemisphere.len()];
        let towards_wall = DVec3::new(-x.signum(), 0.0, 0.1).normalize();
        let wall = GatherHit { direction: towards_wall, distance: x.abs(), normal: None, irradiance: [0.0] };
        let record = Record::new(position, DVec3::Z, &hemisphere, &seen, &LIMITS).with_hits(&[wall], 0.5);
        cache.insert(record, 0);
    }
    let fit = |cache: &mut Cache<1>, occluders: &dyn Occluders| {
        let fits: Vec<_> = (0..cache.len()).map(|index| (index, cache.fit(index, occluders))).collect();
        fits.into_iter().for_each(|(index, fit)| cache.adopt(index, fit));
    };
    let dark = DVec3::new(0.02, 0.0, 0.0);
    let at = |cache: &Cache<1>, occluders: &dyn Occluders| {
        cache.irradiance(dark, DVec3::Z, DVec3::Z, occluders).expect("a record reaches")[0] / PI
    };
    fit(&mut cache, &Unobstructed);
    assert!(at(&cache, &Unobstructed) > 0.1, "light leaks: {}", at(&cache, &Unobstructed));
    fit(&mut cache, &Wall);
    assert!((at(&cache, &Wall) - 0.01).abs() < 1e-6, "{}", at(&cache, &Wall));
}
