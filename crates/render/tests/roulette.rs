//! Russian roulette, compared with complete paths.

mod build;

use build::{Builder, plan, traced, values};
use glam::DVec3;
use radsight_ir::{Facing, Ring, Sphere};
use radsight_render::{Gathering, PathLimit, Quantity, Ray, RayTreeOutput, RenderOptions, Renderer};
use std::f64::consts::{PI, TAU};

const RAYS: usize = 16_384;

/// A lamp's highlight on a rough ceiling, behind four dark panes.
fn highlight_behind_panes() -> Builder {
    let mut scene = Builder::default();
    let pane = scene.glass([0.3; 3], 1.52);
    let ceiling = scene.metal([0.9; 3], 1.0, 0.05);
    let lamp = scene.light([1e4; 3]);
    let square = |height: f64, half: f64| {
        [[half, half], [half, -half], [-half, -half], [-half, half]].map(|[x, y]| DVec3::new(x, y, height))
    };
    for height in [0.1, 0.2, 0.3, 0.4] {
        scene.polygon(pane, &square(height, 10.0));
    }
    scene.polygon(ceiling, &square(1.0, 10.0));
    scene.ring(
        lamp,
        Ring { center: DVec3::new(0.3, 0.0, 0.5), normal: DVec3::Z, inner_radius: 0.0, outer_radius: 0.05 },
    );
    scene
}

/// Mean, and its relative standard error.
fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (count * (count - 1.0))).sqrt() / mean)
}

#[test]
fn a_highlight_behind_dark_panes_is_found_by_most_rays_that_look_there() {
    let scene = highlight_behind_panes();
    // Camera rays through panes are all traced: here cosine-distributed over the hemisphere.
    let around: Vec<Ray> = (0..RAYS)
        .map(|index| {
            let share = (index as f64 + 0.5) / RAYS as f64;
            let (sin, cos) = (TAU * (index as f64 * 0.618_033_988_749_895).fract()).sin_cos();
            let direction = DVec3::new(share.sqrt() * cos, share.sqrt() * sin, (1.0 - share).sqrt());
            Ray::new(DVec3::ZERO, direction).expect("the test's ray is one")
        })
        .collect();
    let seen: Vec<f64> =
        traced(&scene, RenderOptions::default(), &around).iter().map(|traced| traced.value[0]).collect();
    let (radiance, error_of_eye) = mean_and_error(&seen);
    let gathering = Gathering { accuracy: 0.0, ..Gathering::default() };
    let options =
        RenderOptions { quantity: Quantity::Irradiance, ambient_bounces: 1, gathering, ..RenderOptions::default() };
    let (irradiance, error) = mean_and_error(&values(&scene, options, DVec3::ZERO, DVec3::Z, RAYS));
    let expected = PI * radiance;
    assert!((irradiance / expected - 1.0).abs() < 3.0 * error.hypot(error_of_eye), "{irradiance} against {expected}");
    assert!(error < 2.0 * error_of_eye, "±{error}, where rays of the eye leave ±{error_of_eye}");
}

/// Clear spheres about the origin in a sphere that glows with radiance 1: no light is lost at their
/// surfaces, whose index of refraction is that of glass.
fn clear_shells_in_a_furnace() -> Builder {
    let mut scene = Builder::default();
    let clear = scene.dielectric([1.0; 3], 1.5);
    let glow = scene.glow([1.0; 3], 0.0);
    for shell in 1..=64 {
        let facing = if shell % 2 == 1 { Facing::Inward } else { Facing::Outward };
        scene.sphere(clear, Sphere { center: DVec3::ZERO, radius: f64::from(shell), facing });
    }
    scene.sphere(glow, Sphere { center: DVec3::ZERO, radius: 1000.0, facing: Facing::Inward });
    scene
}

#[test]
fn the_tree_of_a_lossless_scene_is_limited_and_loses_no_light() {
    let options = RenderOptions {
        path_limit: PathLimit::Roulette,
        least_weight: 1e-4,
        ray_tree: Some(RayTreeOutput::All),
        ..RenderOptions::default()
    };
    let renderer = Renderer::new(plan(&clear_shells_in_a_furnace(), options));
    let ray = Ray::new(DVec3::new(0.0, 0.0, 0.1), DVec3::new(0.6, 0.0, 0.8)).expect("the test's ray is one");
    let mut values = Vec::new();
    let mut largest = 0;
    for index in 0..64 {
        let (traced, tree) = renderer.worker().tree(index, &ray);
        values.push(traced.value[0]);
        largest = largest.max(tree.len());
    }
    let (radiance, error) = mean_and_error(&values);
    assert!((radiance - 1.0).abs() < 3.0 * error && error < 0.1, "{radiance} ± {error}");
    assert!(largest < 30_000, "{largest} rays");
}
