//! Direct light from what neighbouring rays recorded, compared with all lights.

mod build;

use build::{Builder, mean, plan, values};
use glam::DVec3;
use radsight_ir::{Facing, Sphere};
use radsight_render::{DirectRecord, DirectThreshold, LightDivision, NearRecord, Ray, RenderOptions, Renderer};
use std::sync::Arc;

const RAYS: u64 = 1 << 11;

/// Distance of the recorded points from the point between them, scene units.
const APART: f64 = 0.1;

/// Lamps of different strength above a floor.
fn lamps(count: u32) -> Builder {
    lamps_above_floor(count, 3.0)
}

/// The same; half the side of the floor is given, scene units.
fn lamps_above_floor(count: u32, half_side: f64) -> Builder {
    let mut scene = Builder::default();
    let floor = scene.plastic([0.5, 0.4, 0.3], 0.04, 0.15);
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    scene.polygon(floor, &corners.map(|[x, y]| DVec3::new(x, y, 0.0) * half_side));
    for index in 0..count {
        let light = scene.light([5.0, 4.0, 3.0].map(|band| band * f64::from(1 + index % 5)));
        let (sine, cosine) = (2.4 * f64::from(index)).sin_cos();
        let center = DVec3::new(cosine, sine, 0.0) * (0.3 + 0.05 * f64::from(index)) + DVec3::Z * 1.5;
        scene.sphere(light, Sphere { center, radius: 0.03, facing: Facing::Outward });
    }
    scene
}

/// A ball on the way from the floor to the lamps; its centre is so many radii above the floor.
fn block(scene: &mut Builder, above: DVec3, radius: f64, height: f64) {
    let black = scene.plastic([0.0; 3], 0.0, 0.0);
    scene.sphere(black, Sphere { center: above + DVec3::Z * (height * radius), radius, facing: Facing::Outward });
}

/// A sun that would give the floor far more light than the lamps, behind a ball that hides it.
fn hidden_sun(scene: &mut Builder) {
    let towards = DVec3::new(1.0, 0.0, 1.0).normalize();
    let sun = scene.light([6e6, 5e6, 4e6]);
    scene.source(sun, towards, 0.01);
    let black = scene.plastic([0.0; 3], 0.0, 0.0);
    scene.sphere(black, Sphere { center: towards * 20.0, radius: 3.0, facing: Facing::Outward });
}

/// A ray from above to a point of the floor.
fn ray(to: DVec3) -> Ray {
    let eye = DVec3::new(0.0, -1.5, 0.4);
    Ray::new(eye, to - eye).unwrap()
}

/// Radiances of the middle, from records of the corners around it, with this threshold of direct
/// light.
fn near_values(scene: &Builder, threshold: f64) -> Vec<f64> {
    let options = RenderOptions {
        light_division: LightDivision::Shared(0.5),
        direct_threshold: DirectThreshold::new(threshold).unwrap(),
        ..RenderOptions::default()
    };
    let renderer = Renderer::new(plan(scene, options));
    assert!(renderer.records_direct_light());
    let mut worker = renderer.worker();
    let corners = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0) * APART);
    let values = (0..RAYS).map(|index| {
        let near = corners.iter().zip(1_u64..).map(|(corner, stream)| {
            let mut record = Some(DirectRecord::default());
            worker.trace_near(stream << 40 | index, &ray(*corner), &[], &mut record);
            NearRecord { record: Arc::new(record.unwrap()), weight: 0.25 }
        });
        let near: Vec<NearRecord> = near.collect();
        worker.trace_near(index, &ray(DVec3::ZERO), &near, &mut None).value[0]
    });
    values.collect()
}

/// Mean and standard deviation of the radiance of the middle, from records of the corners around it.
fn near_records(scene: &Builder) -> [f64; 2] {
    mean_and_deviation(&near_values(scene, 0.05))
}

fn mean_and_deviation(values: &[f64]) -> [f64; 2] {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64;
    [mean, variance.sqrt()]
}

/// The radiance of the middle from all lamps.
fn all_lamps(scene: &Builder) -> f64 {
    let Ray { origin, direction, .. } = ray(DVec3::ZERO);
    mean(scene, RenderOptions::default(), origin, direction, 1 << 13)
}

/// The noise is relative to the light of twenty lamps without shadows.
#[track_caller]
fn assert_same_mean(scene: &Builder, most_noise: f64) {
    assert_mean(scene, all_lamps(scene), most_noise);
}

#[track_caller]
fn assert_mean(scene: &Builder, expected: f64, most_noise: f64) {
    let ([found, deviation], bright) = (near_records(scene), all_lamps(&lamps(20)));
    let error = 4.0 * deviation / (RAYS as f64).sqrt() + 1e-3 * bright;
    assert!((found - expected).abs() < error, "{found} ± {deviation}, not {expected}");
    assert!(deviation < most_noise * bright, "{deviation} of {bright}");
}

#[test]
fn light_that_neighbours_receive_alike_has_little_noise() {
    assert_same_mean(&lamps(20), 0.03);
    assert_same_mean(&lamps(120), 0.04);
}

#[test]
fn shadows_that_no_neighbour_sees_are_as_dark_as_with_all_lamps() {
    // The ball hides all lamps, or a quarter of them.
    for (height, noise) in [(1.5, 0.05), (3.0, 0.1)] {
        let mut scene = lamps(20);
        block(&mut scene, DVec3::ZERO, 0.03, height);
        assert_same_mean(&scene, noise);
    }
}

#[test]
fn lamps_beside_a_hidden_sun_have_no_more_noise() {
    for count in [20, 120] {
        let mut scene = lamps(count);
        let lit = all_lamps(&scene);
        hidden_sun(&mut scene);
        assert_mean(&scene, lit, 0.04);
    }
    // So few lights are not recorded.
    let mut scene = lamps(2);
    let lit = all_lamps(&scene);
    hidden_sun(&mut scene);
    let options = RenderOptions { light_division: LightDivision::BySize(2.0), ..RenderOptions::default() };
    let Ray { origin, direction, .. } = ray(DVec3::ZERO);
    let found = values(&scene, options, origin, direction, RAYS as usize);
    let [mean, deviation] = mean_and_deviation(&found);
    assert!((mean / lit - 1.0).abs() < 0.005 && deviation < 0.02 * lit, "{mean} ± {deviation}, not {lit}");
}

#[test]
fn light_between_shadows_is_as_bright_as_with_all_lamps() {
    let mut scene = lamps(20);
    for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]] {
        block(&mut scene, DVec3::new(x, y, 0.0) * APART, 0.03, 1.5);
    }
    assert_same_mean(&scene, 0.1);
}

#[test]
fn lamps_in_a_mirror_and_a_highlight_count_once() {
    let mut scene = lamps(12);
    let mirror = scene.mirror([0.9, 0.8, 0.7]);
    scene.polygon(mirror, &[[-2.0, 0.1], [2.0, 0.1], [2.0, 1.8], [-2.0, 1.8]].map(|[x, z]| DVec3::new(x, 1.0, z)));
    block(&mut scene, DVec3::ZERO, 0.03, 3.0);
    assert_same_mean(&scene, 0.1);
}

#[test]
fn a_tiled_floor_shares_light_across_its_tiles() {
    // The corners see white tiles, the middle a black one.
    let mut scene = lamps(20);
    let tile = scene.plastic([0.1, 0.2, 0.1], 0.04, 0.15);
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    scene.polygon(tile, &corners.map(|[x, y]| DVec3::new(0.2 * APART * x, 0.2 * APART * y, 1e-4)));
    assert_same_mean(&scene, 0.03);
}

#[test]
fn a_lamp_that_no_record_sees_keeps_its_mean() {
    // The lamp is below the horizon of the floor, and above that of a tilted tile.
    let mut scene = lamps_above_floor(12, 1.2 * APART);
    let lamp = scene.light([50.0, 40.0, 30.0]);
    scene.sphere(lamp, Sphere { center: DVec3::new(2.0, 0.0, -0.05), radius: 0.03, facing: Facing::Outward });
    let tile = scene.plastic([0.5, 0.4, 0.3], 0.04, 0.15);
    let corners = [[-0.03, -0.1], [0.03, -0.1], [0.03, 0.1], [-0.03, 0.1]];
    scene.polygon(tile, &corners.map(|[x, y]| DVec3::new(x, y, 0.02 - 0.36 * x)));
    assert_same_mean(&scene, 0.2);
}

#[test]
fn a_larger_threshold_gives_more_noise_and_the_same_mean() {
    let mut scene = lamps(20);
    block(&mut scene, DVec3::ZERO, 0.03, 3.0);
    let expected = all_lamps(&scene);
    let mut before = 0.0;
    for threshold in [0.0, 0.05, 1.0] {
        let [found, deviation] = mean_and_deviation(&near_values(&scene, threshold));
        let error = 4.0 * deviation / (RAYS as f64).sqrt() + 1e-3 * expected;
        assert!((found - expected).abs() < error, "{threshold}: {found} ± {deviation}, not {expected}");
        assert!(deviation > before, "{threshold}: {deviation} after {before}");
        before = deviation;
    }
}

#[test]
fn a_threshold_of_zero_samples_all_lamps_as_without_records() {
    let scene = lamps(20);
    let options = RenderOptions { light_division: LightDivision::Shared(0.5), ..RenderOptions::default() };
    let renderer = Renderer::new(plan(&scene, options));
    let mut worker = renderer.worker();
    let alone: Vec<f64> =
        (0..RAYS).map(|index| worker.trace_near(index, &ray(DVec3::ZERO), &[], &mut None).value[0]).collect();
    assert_eq!(near_values(&scene, 0.0), alone);
}

#[test]
fn shadow_rays_selected_by_strength_have_the_same_mean_for_each_threshold() {
    let mut scene = lamps(20);
    block(&mut scene, DVec3::ZERO, 0.03, 3.0);
    let expected = all_lamps(&scene);
    let Ray { origin, direction, .. } = ray(DVec3::ZERO);
    for threshold in [0.0, 0.05, 1.0] {
        let direct_threshold = DirectThreshold::new(threshold).unwrap();
        let options =
            RenderOptions { light_division: LightDivision::BySize(2.0), direct_threshold, ..RenderOptions::default() };
        let found = mean(&scene, options, origin, direction, 1 << 14);
        assert!((found / expected - 1.0).abs() < 0.01, "{threshold}: {found}, not {expected}");
    }
}
