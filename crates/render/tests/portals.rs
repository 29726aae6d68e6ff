//! Light that enters a dark room through portals, compared with form factors.

mod build;

use build::{Builder, mean, values};
use glam::DVec3;
use radsight_render::{Gathering, Quantity, RenderOptions, Uncached};
use std::f64::consts::PI;

fn options(uncached: Uncached) -> RenderOptions {
    let gathering = Gathering { divisions: 256, uncached, ..Gathering::default() };
    RenderOptions { quantity: Quantity::Irradiance, ambient_bounces: 1, gathering, ..RenderOptions::default() }
}

/// Irradiance of a horizontal point from a uniform square of radiance 1 and half side `half` at a
/// height above it.
fn square_overhead(half: f64, height: f64) -> f64 {
    let share = half / half.hypot(height);
    // Four quarters of a corner's form factor, a/√(a² + h²)·atan(a/√(a² + h²))/π each, times π.
    4.0 * share * share.atan()
}

fn square(half: f64, height: f64) -> [DVec3; 4] {
    // Facing down.
    [[-half, -half], [-half, half], [half, half], [half, -half]].map(|[x, y]| DVec3::new(x, y, height))
}

/// A ceiling at `height` with a square hole in its centre.
fn ceiling(scene: &mut Builder, hole: f64, height: f64) {
    let black = scene.plastic([0.0; 3], 0.0, 0.0);
    for turn in 0..4 {
        let strip = [[-hole, hole], [-hole, 5e3], [5e3, 5e3], [5e3, hole]];
        let corner = |[x, y]: [f64; 2]| match turn {
            0 => DVec3::new(x, y, height),
            1 => DVec3::new(y, -x, height),
            2 => DVec3::new(-x, -y, height),
            _ => DVec3::new(-y, x, height),
        };
        scene.polygon(black, &strip.map(corner));
    }
}

/// A dark room under a uniform sky, with panes of clear glass in a hole of the ceiling.
fn skylight(panes: &[f64]) -> Builder {
    let mut scene = Builder::default();
    let sky = scene.glow([3.0; 3], 0.0);
    scene.source(sky, DVec3::Z, PI);
    ceiling(&mut scene, 0.2, 2.0);
    // Index 1: no reflection.
    let glass = scene.glass([1.0; 3], 1.0);
    for height in panes {
        scene.polygon(glass, &square(0.2, *height));
    }
    scene
}

#[track_caller]
fn assert_close(found: f64, expected: f64, tolerance: f64) {
    assert!((found / expected - 1.0).abs() < tolerance, "found {found}, expected {expected}");
}

#[test]
fn a_skylight_gives_the_irradiance_of_its_form_factor() {
    let expected = 3.0 * square_overhead(0.2, 2.0);
    for panes in [&[2.0][..], &[2.0, 2.001, 1.99], &[2.0, 1.7]] {
        let scene = skylight(panes);
        let one_by_one = mean(&scene, options(Uncached::TraceOne), DVec3::ZERO, DVec3::Z, 1 << 13);
        assert_close(one_by_one, expected, 0.01);
        let together = mean(&scene, options(Uncached::Split), DVec3::ZERO, DVec3::Z, 32);
        assert_close(together, expected, 0.01);
    }
}

#[test]
fn a_glow_that_is_no_light_gives_the_irradiance_of_its_form_factor() {
    let mut scene = Builder::default();
    let glow = scene.glow([5.0; 3], 0.0);
    scene.polygon(glow, &square(0.3, 1.5));
    let expected = 5.0 * square_overhead(0.3, 1.5);
    assert_close(mean(&scene, options(Uncached::TraceOne), DVec3::ZERO, DVec3::Z, 1 << 13), expected, 0.01);
    assert_close(mean(&scene, options(Uncached::Split), DVec3::ZERO, DVec3::Z, 32), expected, 0.01);
    let without_bounces = RenderOptions { ambient_bounces: 0, ..options(Uncached::TraceOne) };
    assert_eq!(mean(&scene, without_bounces, DVec3::ZERO, DVec3::Z, 16), 0.0);
}

#[test]
fn lights_beside_a_skylight_count_once() {
    let mut scene = skylight(&[2.0]);
    let light = scene.light([1.0; 3]);
    scene.polygon(light, &square(3.0, 0.5));
    // It hides the skylight; only half of a bright wall above is visible.
    let expected = square_overhead(3.0, 0.5);
    assert_close(mean(&scene, options(Uncached::TraceOne), DVec3::ZERO, DVec3::Z, 1 << 13), expected, 0.01);
}

/// Without guiding, one ray in 300 finds this skylight: a standard deviation of 17 times the mean.
#[test]
fn a_skylight_is_found_by_more_rays_than_chance_would_send_there() {
    let found = values(&skylight(&[2.0]), options(Uncached::TraceOne), DVec3::ZERO, DVec3::Z, 1 << 12);
    let mean = found.iter().sum::<f64>() / found.len() as f64;
    let variance = found.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / found.len() as f64;
    assert!(variance.sqrt() < 1.5 * mean, "standard deviation {} around {mean}", variance.sqrt());
}
