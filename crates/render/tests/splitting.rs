//! Path splitting, compared with closed forms and with independent paths.

mod build;

use build::{Builder, plan, square, values};
use glam::DVec3;
use radsight_ir::{Facing, Sphere};
use radsight_render::{Gathering, PathLimit, Quantity, Ray, RenderOptions, Renderer, Uncached};
use std::f64::consts::PI;

fn options(bounces: u32, divisions: u32, least_weight: f64) -> RenderOptions {
    let gathering = Gathering { divisions, uncached: Uncached::Split, ..Gathering::default() };
    RenderOptions { ambient_bounces: bounces, gathering, least_weight, ..RenderOptions::default() }
}

fn irradiance(options: RenderOptions) -> RenderOptions {
    RenderOptions { quantity: Quantity::Irradiance, ..options }
}

/// A floor under a uniform sky.
fn floor_under_sky() -> Builder {
    let mut scene = Builder::default();
    let paint = scene.plastic([0.5; 3], 0.0, 0.0);
    let sky = scene.glow([1.0; 3], 0.0);
    scene.polygon(paint, &square(10.0, 0.0));
    scene.source(sky, DVec3::Z, PI);
    scene
}

/// Mean and standard error.
fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (count * (count - 1.0))).sqrt())
}

/// How often the branches of a ray to the floor hit the sky.
fn times_the_sky_is_met(options: RenderOptions) -> usize {
    let mut scene = floor_under_sky();
    let options = RenderOptions { tracked_modifiers: vec!["material".to_owned()], ..options };
    // Only the sky emits, so only it contributes along a whole ray; the floor is hit once.
    let paint = scene.plastic([0.0; 3], 0.0, 0.0);
    scene.polygon(paint, &square(0.1, -5.0));
    let renderer = Renderer::new(plan(&scene, options));
    let ray = Ray::new(DVec3::new(0.0, 0.0, 3.0), -DVec3::Z).expect("the test's ray is one");
    let mut met = 0;
    renderer.worker().contributions(0, &ray, |_| met += 1);
    met - 1
}

#[test]
fn a_ray_splits_into_the_rays_that_were_asked_for() {
    assert_eq!(times_the_sky_is_met(options(1, 400, 1e-6)), 400);
    assert_eq!(times_the_sky_is_met(options(1, 1, 1e-6)), 1);
}

#[test]
fn a_ray_splits_into_no_more_than_its_least_weight_allows() {
    let met = times_the_sky_is_met(options(1, 30_000, 1e-2));
    assert!((30..=40).contains(&met), "{met} rays, expected 0.8 · 0.5 / 0.01 or the square below");
}

#[test]
fn a_floor_under_an_even_sky_has_its_irradiance() {
    let found = values(&floor_under_sky(), irradiance(options(1, 256, 1e-6)), DVec3::Z, DVec3::Z, 1)[0];
    assert!((found / PI - 1.0).abs() < 1e-9, "{found}");
}

/// The light fills a four-hundredth of the wall's view, and bounces continue in the rest.
#[test]
fn branches_that_end_by_roulette_lose_no_light() {
    let mut scene = Builder::default();
    let paint = scene.plastic([0.7; 3], 0.0, 0.0);
    let light = scene.light([100.0; 3]);
    scene.sphere(paint, Sphere { center: DVec3::ZERO, radius: 2.0, facing: Facing::Inward });
    scene.sphere(light, Sphere { center: DVec3::ZERO, radius: 0.1, facing: Facing::Outward });
    let direct = 100.0 * PI * (0.1_f64 / 2.0).powi(2);
    // The light absorbs its part of what leaves the wall.
    let back = 0.7 * (1.0 - (0.1_f64 / 2.0).powi(2));
    let expected = 0.7 / PI * direct * (1.0 + back + back * back + back.powi(3));
    for path_limit in [PathLimit::Roulette, PathLimit::RouletteUpTo(10), PathLimit::Cut(10)] {
        for least_weight in [1e-4, 2e-2] {
            let options = RenderOptions { path_limit, ..options(3, 100, least_weight) };
            let found = values(&scene, options, DVec3::new(0.5, 0.0, 0.0), DVec3::new(1.0, 0.3, 0.2), 1 << 10);
            let (mean, error) = mean_and_error(&found);
            let allowed = 3.0 * error + 1e-3 * expected;
            assert!((mean - expected).abs() < allowed, "{path_limit:?}, {least_weight}: {mean} is not {expected}");
        }
    }
}

#[test]
fn splitting_finds_what_single_paths_find() {
    let mut scene = floor_under_sky();
    let metal = scene.metal([0.8, 0.6, 0.4], 0.7, 0.15);
    let wall = [[1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 2.0], [1.0, -1.0, 2.0]].map(DVec3::from_array);
    scene.polygon(metal, &wall);
    let lamp = scene.light([20.0; 3]);
    let panel = [[0.0, 0.0, 2.0], [0.0, 0.5, 2.0], [0.5, 0.5, 2.0], [0.5, 0.0, 2.0]].map(DVec3::from_array);
    scene.polygon(lamp, &panel);
    let (eye, towards) = (DVec3::new(-1.0, 0.2, 1.0), DVec3::new(1.0, 0.0, -0.1));
    let split = values(&scene, options(3, 64, 1e-3), eye, towards, 1 << 9);
    let alone = Gathering { uncached: Uncached::TraceOne, ..Gathering::default() };
    let single = RenderOptions { gathering: alone, ..options(3, 64, 1e-3) };
    let paths = values(&scene, single, eye, towards, 1 << 13);
    let ((one, one_error), (other, other_error)) = (mean_and_error(&split), mean_and_error(&paths));
    let allowed = 3.0 * one_error.hypot(other_error);
    assert!((one - other).abs() < allowed && allowed < 0.03 * one, "{one} ± {one_error}, {other} ± {other_error}");
}

/// If light sampling were balanced against a thousand branches, one of which in a thousand finds
/// it, the sun would be noisy.
#[test]
fn branches_take_no_part_of_a_small_light() {
    let mut scene = floor_under_sky();
    let sun = scene.light([1e6; 3]);
    scene.source(sun, DVec3::new(0.3, 0.2, 1.0).normalize(), 0.0093);
    let found = values(&scene, irradiance(options(1, 1024, 1e-6)), DVec3::Z, DVec3::Z, 64);
    let mean = found.iter().sum::<f64>() / found.len() as f64;
    let outliers = found.iter().filter(|value| (*value / mean - 1.0).abs() > 2e-3).count();
    assert_eq!(outliers, 0, "{outliers} of 64 values are off by more than 0.2 %");
}

#[test]
fn a_large_light_is_sampled_in_more_places_by_a_ray_that_counts_by_itself() {
    let mut scene = Builder::default();
    let lamp = scene.light([10.0; 3]);
    let mut panel = square(1.0, 2.0);
    panel.reverse();
    scene.polygon(lamp, &panel);
    let spread = |source_sampling: f64| {
        let options = RenderOptions { source_sampling, ..irradiance(options(0, 1, 1e-6)) };
        let (mean, error) = mean_and_error(&values(&scene, options, DVec3::ZERO, DVec3::Z, 256));
        error * 16.0 / mean
    };
    let (coarse, usual) = (spread(0.0), spread(0.2));
    assert!(usual < 0.02 && coarse > 4.0 * usual, "standard deviations {coarse} and {usual}");
}

/// A panel above the origin and an optional sphere below it.
fn below_a_panel(ball: Option<(DVec3, f64)>) -> Builder {
    let mut scene = Builder::default();
    let (lamp, paint) = (scene.light([10.0; 3]), scene.plastic([0.0; 3], 0.0, 0.0));
    let mut panel = square(1.0, 2.0);
    panel.reverse();
    scene.polygon(lamp, &panel);
    // An object next to the path to the panel changes nothing.
    scene.sphere(paint, Sphere { center: DVec3::new(2.0, 0.0, 1.0), radius: 0.5, facing: Facing::Outward });
    if let Some((center, radius)) = ball {
        scene.sphere(paint, Sphere { center, radius, facing: Facing::Outward });
    }
    scene
}

/// E = L·F·π with the form factor of a parallel square over a point below its centre, four times
/// that of a quarter.
#[test]
fn a_light_in_clear_view_has_hardly_any_noise() {
    let share = 1.0 / 5.0_f64.sqrt();
    let expected = 10.0 * 4.0 * share * share.atan();
    let options = RenderOptions { source_sampling: 0.2, ..irradiance(options(0, 1, 1e-6)) };
    let found = values(&below_a_panel(None), options, DVec3::ZERO, DVec3::Z, 256);
    let worst = found.iter().map(|value| (value / expected - 1.0).abs()).fold(0.0, f64::max);
    assert!(worst < 0.008, "off by {worst} at most");
}

#[test]
fn whatever_reaches_between_a_point_and_a_light_takes_its_part() {
    for (x, radius) in [(0.0, 0.1), (0.45, 0.06), (0.55, 0.1), (0.7, 0.2), (0.5, 0.02)] {
        let scene = below_a_panel(Some((DVec3::new(x, 0.1, 1.0), radius)));
        let found = |side: f64, rays| {
            let options = RenderOptions { source_sampling: side, ..irradiance(options(0, 1, 1e-6)) };
            mean_and_error(&values(&scene, options, DVec3::ZERO, DVec3::Z, rays))
        };
        // One sample per light never uses a shaft.
        let ((many, many_error), (one, one_error)) = (found(0.2, 1 << 9), found(0.0, 1 << 13));
        let allowed = 4.0 * many_error.hypot(one_error);
        assert!((many - one).abs() < allowed, "ball at {x}: {many} ± {many_error}, {one} ± {one_error}");
    }
}
