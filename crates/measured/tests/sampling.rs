//! Sampling: densities, weights and totals agree with each other and with the values.

use glam::DVec3;
use radsight_measured::{MeasuredBsdf, Scattering, Side};
use radsight_test_support::Random;
use radsight_test_support::bsdf_files::all_forms;
use std::f64::consts::{PI, TAU};

/// Given directions on both sides, one near the horizon.
fn given() -> Vec<DVec3> {
    [(0.02, 0.3), (0.6, 2.0), (1.2, 4.0), (1.5, 5.5)]
        .into_iter()
        .flat_map(|(polar, azimuth): (f64, f64)| {
            let (sine, cosine) = polar.sin_cos();
            [1.0, -1.0].map(|side| DVec3::new(sine * azimuth.cos(), sine * azimuth.sin(), side * cosine))
        })
        .collect()
}

/// Every scattering function of a file, with a given direction that it accepts.
fn each(bsdf: &MeasuredBsdf) -> Vec<(&Scattering, DVec3, Side)> {
    let mut all = Vec::new();
    for direction in given() {
        let side = Side::of(direction);
        all.extend(bsdf.reflection(side).map(|scattering| (scattering, direction, side)));
        all.extend(bsdf.transmission(side).map(|scattering| (scattering, direction, side.opposite())));
    }
    all
}

/// Integral of a function over the projected hemisphere of one side, by the R2 sequence (Roberts,
/// 2018).
fn over_hemisphere(side: Side, mut integrand: impl FnMut(DVec3) -> f64) -> f64 {
    const POINTS: u32 = 50_000;
    const RATIO: f64 = 1.324_717_957_244_746;
    let mut sum = 0.0;
    for point in 0..POINTS {
        let [u, v] = [1.0 / RATIO, 1.0 / (RATIO * RATIO)].map(|step| (f64::from(point) * step + 0.5).fract());
        let (sine, azimuth) = (u.sqrt(), TAU * v);
        let z = (1.0 - u).sqrt();
        let z = if side == Side::Front { z } else { -z };
        sum += integrand(DVec3::new(sine * azimuth.cos(), sine * azimuth.sin(), z));
    }
    PI * sum / f64::from(POINTS)
}

#[test]
fn totals_are_integrals_of_the_values() {
    for (name, text) in all_forms() {
        let bsdf = MeasuredBsdf::read(text.as_bytes()).unwrap().bsdf;
        for (scattering, given, side) in each(&bsdf) {
            let total = scattering.total(given);
            let integral = over_hemisphere(side, |other| scattering.luminance(given, other));
            // An isotropic tree with a given exit direction uses a coarse quadrature.
            let tolerance = if name == "isotropic tree one way" { 0.12 } else { 3e-3 };
            assert!((total - integral).abs() < tolerance * integral + 1e-6, "{name} {given}: {total} {integral}");
        }
    }
}

#[test]
fn densities_integrate_to_one() {
    for (name, text) in all_forms() {
        let bsdf = MeasuredBsdf::read(text.as_bytes()).unwrap().bsdf;
        for (scattering, given, side) in each(&bsdf) {
            let sum = over_hemisphere(side, |other| scattering.density(given, other) / other.z.abs());
            let is_nothing = scattering.total(given) == 0.0;
            let expected = if is_nothing { 0.0 } else { 1.0 };
            assert!((sum - expected).abs() < 3e-3, "{name} {given}: {sum}");
        }
    }
}

/// Pearson's chi² over cells of 10 by 16, equal in projected solid angle.
#[test]
fn samples_have_the_density_of_density() {
    const DRAWS: u32 = 40_000;
    const RINGS: usize = 10;
    const TURNS: usize = 16;
    for (name, text) in all_forms() {
        let bsdf = MeasuredBsdf::read(text.as_bytes()).unwrap().bsdf;
        let mut random = Random(99);
        for (scattering, given, side) in each(&bsdf) {
            let cell = |direction: DVec3| {
                let squared = direction.x * direction.x + direction.y * direction.y;
                let turn = direction.y.atan2(direction.x) / TAU + 0.5;
                let ring = ((squared * RINGS as f64) as usize).min(RINGS - 1);
                ring * TURNS + ((turn * TURNS as f64) as usize).min(TURNS - 1)
            };
            let mut counts = vec![0.0; RINGS * TURNS];
            let mut misses = 0;
            for _ in 0..DRAWS {
                let Some(sample) = scattering.sample(given, [random.number(), random.number()]) else {
                    misses += 1;
                    continue;
                };
                assert!((sample.direction.length() - 1.0).abs() < 1e-9 && Side::of(sample.direction) == side);
                let density = scattering.density(given, sample.direction);
                assert!((sample.density - density).abs() <= 1e-9 * density);
                counts[cell(sample.direction)] += 1.0;
            }
            if scattering.total(given) <= 1e-6 {
                assert_eq!(misses, DRAWS);
                continue;
            }
            assert_eq!(misses, 0, "{name} {given}");
            let mut expected = vec![0.0; RINGS * TURNS];
            over_hemisphere(side, |other| {
                expected[cell(other)] += scattering.density(given, other) / other.z.abs();
                0.0
            });
            let sum: f64 = expected.iter().sum();
            // Cells with few expected samples are merged.
            let (mut chi_squared, mut cells, mut rest) = (0.0, 0, [0.0; 2]);
            for (count, expected) in counts.iter().zip(&expected) {
                let expected = expected / sum * f64::from(DRAWS);
                if expected < 10.0 {
                    rest = [rest[0] + count, rest[1] + expected];
                } else {
                    // The quadrature error of one per cent is added to the counting error.
                    chi_squared += (count - expected).powi(2) / (expected + (0.01 * expected).powi(2));
                    cells += 1;
                }
            }
            assert!((rest[0] - rest[1]).abs() < 5.0 * rest[1].sqrt() + 5.0, "{name} {given}: {rest:?}");
            let freedom = f64::from(cells);
            assert!(chi_squared < freedom + 5.0 * (2.0 * freedom).sqrt(), "{name} {given}: chi² {chi_squared}");
        }
    }
}

#[test]
fn weights_average_to_the_total() {
    for (name, text) in all_forms() {
        let bsdf = MeasuredBsdf::read(text.as_bytes()).unwrap().bsdf;
        for (scattering, given, _) in each(&bsdf) {
            let total = scattering.total(given);
            let steps = 60;
            let mut sum = 0.0;
            for index in 0..steps * steps {
                let u = [index / steps, index % steps].map(|step| (f64::from(step) + 0.5) / f64::from(steps));
                let weight = scattering.sample(given, u).map_or([0.0; 3], |sample| sample.weight);
                sum += 0.265_105_82 * weight[0] + 0.670_105_82 * weight[1] + 0.064_788_36 * weight[2];
            }
            let mean = sum / f64::from(steps * steps);
            // Colours outside the gamut are clipped, which changes the luminance slightly.
            let tolerance = if name.contains("colour") {
                0.03
            } else if name.contains("one way") {
                0.05
            } else {
                1e-3
            };
            assert!((mean - total).abs() <= tolerance * total + 1e-9, "{name} {given}: {mean} {total}");
        }
    }
}

#[test]
fn what_is_given_one_way_is_reciprocal() {
    let mut random = Random(3);
    for (name, text) in all_forms() {
        let bsdf = MeasuredBsdf::read(text.as_bytes()).unwrap().bsdf;
        if !name.contains("one way") {
            continue;
        }
        for _ in 0..500 {
            let (a, b) = (random.direction(), random.direction());
            if Side::of(a) != Side::of(b) {
                assert_eq!(bsdf.value(a, b), bsdf.value(b, a), "{name} {a} {b}");
            }
        }
    }
}
