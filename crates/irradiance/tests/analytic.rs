//! Records against scenes whose irradiance is known.

use glam::DVec3;
use radsight_irradiance::{Cache, Gathered, Hemisphere, Limits, Record};
use radsight_sampling::{DimensionSet, RaySampler};
use std::f64::consts::PI;

const LIMITS: Limits = Limits { accuracy: 0.2, least: 1e-3, most: 10.0 };

/// A record of a world in which a ray meets radiance and distance.
fn record(at: DVec3, normal: DVec3, divisions: usize, world: impl Fn(DVec3, DVec3) -> (f64, f64)) -> Record<1> {
    let hemisphere = Hemisphere::with_divisions(divisions);
    let [x, y, z] = Record::<1>::frame(normal);
    let seen: Vec<Gathered<1>> = (0..hemisphere.len())
        .map(|cell| {
            let u = RaySampler::new(1, cell as u64).take(DimensionSet::CAMERA);
            let local = hemisphere.direction(cell, [u[0], u[1]]);
            let (radiance, distance) = world(at, x * local.x + y * local.y + z * local.z);
            Gathered { radiance: [radiance], distance }
        })
        .collect();
    Record::new(at, normal, &hemisphere, &seen, &LIMITS)
}

/// A glowing disk of radius 1 above the origin at height 1, seen from a point on the plane z = 0 on its axis or off it.
fn disk(at: DVec3, direction: DVec3) -> (f64, f64) {
    let distance = (1.0 - at.z) / direction.z;
    let hit = at + direction * distance;
    if direction.z > 0.0 && hit.x.hypot(hit.y) < 1.0 { (1.0, distance) } else { (0.0, 100.0) }
}

/// Irradiance of a horizontal point at distance `a` from the axis of that disk: π times the view factor from a small plane to a parallel
/// disk (Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-13).
fn disk_irradiance(a: f64) -> f64 {
    let z = 1.0 + 1.0 + a * a;
    0.5 * PI * (1.0 - (1.0 + a * a - 1.0) / (z * z - 4.0 * a * a).sqrt())
}

fn at(record: Record<1>, position: DVec3, normal: DVec3) -> f64 {
    let mut cache = Cache::new(LIMITS);
    cache.insert(record);
    cache.irradiance(position, normal, normal).expect("the record reaches")[0]
}

#[test]
fn irradiance_of_a_disk() {
    for a in [0.0, 0.3, 0.9] {
        let place = DVec3::new(a, 0.0, 0.0);
        let found = at(record(place, DVec3::Z, 20_000, disk), place, DVec3::Z);
        assert!((found / disk_irradiance(a) - 1.0).abs() < 5e-3, "{found} against {}", disk_irradiance(a));
    }
}

#[test]
fn a_small_move_follows_the_gradient() {
    let place = DVec3::new(0.5, 0.2, 0.0);
    let record = record(place, DVec3::Z, 20_000, disk);
    for step in [DVec3::new(0.02, 0.0, 0.0), DVec3::new(0.0, 0.03, 0.0), DVec3::new(-0.02, 0.01, 0.0)] {
        let found = at(record, place + step, DVec3::Z) - at(record, place, DVec3::Z);
        let right = disk_irradiance((place + step).length()) - disk_irradiance(place.length());
        assert!((found - right).abs() < 0.1 * right.abs() + 2e-4, "{step}: {found} against {right}");
    }
}

/// A world that is bright to one side: the irradiance follows the turned normal.
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

#[test]
fn a_record_does_not_reach_round_an_edge() {
    let mut cache = Cache::new(LIMITS);
    cache.insert(record(DVec3::ZERO, DVec3::Z, 256, |_, _| (1.0, 1.0)));
    assert!(cache.irradiance(DVec3::new(0.05, 0.0, 0.0), DVec3::Z, DVec3::Z).is_some());
    assert!(cache.irradiance(DVec3::new(0.05, 0.0, 0.0), DVec3::X, DVec3::X).is_none());
    assert!(cache.irradiance(DVec3::new(0.05, 0.0, -0.1), DVec3::Z, DVec3::Z).is_none());
}

#[test]
fn a_near_neighbour_shortens_the_reach() {
    let mut cache = Cache::new(LIMITS);
    cache.insert(record(DVec3::ZERO, DVec3::Z, 256, |_, _| (1.0, 10.0)));
    let far = DVec3::new(0.5, 0.0, 0.0);
    assert!(cache.irradiance(far, DVec3::Z, DVec3::Z).is_some());
    cache.insert(record(DVec3::new(-0.1, 0.0, 0.0), DVec3::Z, 256, |_, _| (1.0, 0.1)));
    assert!(cache.irradiance(far, DVec3::Z, DVec3::Z).is_none());
}
