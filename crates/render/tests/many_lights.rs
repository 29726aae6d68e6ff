//! Selection of a few of many lights, compared with the sum over all.

mod build;

use build::{Builder, mean, values};
use glam::DVec3;
use radsight_ir::{Facing, ModifierHandle, Sphere};
use radsight_render::{DirectThreshold, Gathering, Quantity, RenderOptions, Uncached};
use std::f64::consts::PI;

fn irradiance() -> RenderOptions {
    RenderOptions { quantity: Quantity::Irradiance, ..RenderOptions::default() }
}

#[track_caller]
fn assert_close(found: f64, expected: f64, tolerance: f64) {
    assert!((found / expected - 1.0).abs() < tolerance, "found {found}, expected {expected}");
}

/// Scattered points of the unit cube.
fn scattered(index: u32) -> DVec3 {
    let share = |step: f64| (f64::from(index + 1) * step).fract();
    DVec3::new(share(0.819_172_513_4), share(0.671_043_606_7), share(0.549_700_477_9))
}

/// A square of one polygon or of many, which emits downwards.
fn ceiling(scene: &mut Builder, light: ModifierHandle, divisions: u32) {
    let side = 4.0 / f64::from(divisions);
    for cell in 0..divisions * divisions {
        let low = DVec3::new(f64::from(cell % divisions) * side - 2.0, f64::from(cell / divisions) * side - 2.0, 1.5);
        scene.polygon(light, &[low, low + DVec3::Y * side, low + DVec3::new(side, side, 0.0), low + DVec3::X * side]);
    }
}

#[test]
fn ten_thousand_spheres_give_the_sum_of_their_irradiances() {
    let mut scene = Builder::default();
    let lamps = [0.2, 1.0, 30.0].map(|radiance| scene.light([radiance; 3]));
    let radius = 2e-3;
    let mut expected = 0.0;
    for index in 0..10_000 {
        let center = (scattered(index) - 0.5) * DVec3::new(6.0, 6.0, 2.0) + DVec3::Z * 0.6;
        let kind = index as usize % 3;
        scene.sphere(lamps[kind], Sphere { center, radius, facing: Facing::Outward });
        let distance = center.length();
        if center.z > 0.0 {
            expected += PI * [0.2, 1.0, 30.0][kind] * (radius / distance).powi(2) * center.z / distance;
        }
    }
    // One in a thousand occludes another.
    assert_close(mean(&scene, irradiance(), DVec3::ZERO, DVec3::Z, 1 << 14), expected, 5e-3);
}

#[test]
fn a_threshold_of_zero_samples_every_light() {
    let mut scene = Builder::default();
    let lamp = scene.light([1.0; 3]);
    let radius = 2e-3;
    let mut expected = 0.0;
    for index in 0..500 {
        let center = scattered(index) * DVec3::new(6.0, 6.0, 2.0) + DVec3::new(-3.0, -3.0, 0.5);
        scene.sphere(lamp, Sphere { center, radius, facing: Facing::Outward });
        expected += PI * (radius / center.length()).powi(2) * center.z / center.length();
    }
    let gathering = Gathering { uncached: Uncached::Split, ..Gathering::default() };
    let worst = |direct_threshold| {
        let options = RenderOptions { direct_threshold, gathering, ..irradiance() };
        let found = values(&scene, options, DVec3::ZERO, DVec3::Z, 16);
        found.into_iter().map(|found| (found / expected - 1.0).abs()).fold(0.0, f64::max)
    };
    let [all, some] = [DirectThreshold::EXACT, DirectThreshold::DEFAULT].map(worst);
    assert!(all < 5e-3 && some > 4.0 * all, "all lights {all}, some of them {some}");
}

#[test]
fn a_luminaire_of_many_polygons_is_as_bright_as_one() {
    let of = |divisions: u32, roughness: f64, count: usize| {
        let mut scene = Builder::default();
        let light = scene.light([3.0; 3]);
        let floor = scene.plastic([0.4; 3], 0.2, roughness);
        scene.polygon(floor, &[[-3.0, -3.0], [3.0, -3.0], [3.0, 3.0], [-3.0, 3.0]].map(|[x, y]| DVec3::new(x, y, 0.0)));
        ceiling(&mut scene, light, divisions);
        let direction = DVec3::new(0.5, 0.3, -0.4);
        mean(&scene, RenderOptions::default(), DVec3::new(-1.0, -0.2, 0.4), direction, count)
    };
    for roughness in [0.0, 0.05, 0.2] {
        assert_close(of(40, roughness, 1 << 14), of(1, roughness, 1 << 14), 5e-3);
    }
}

#[test]
fn lights_that_turn_away_leave_the_work_to_the_others() {
    let mut scene = Builder::default();
    let light = scene.light([5.0; 3]);
    ceiling(&mut scene, light, 10);
    let lit = mean(&scene, irradiance(), DVec3::ZERO, DVec3::Z, 4096);
    for index in 0..2000 {
        // Above the ceiling, and below the measured floor.
        let z = if index % 2 == 0 { 2.0 } else { -1.0 };
        let low = (scattered(index) - 0.5) * DVec3::new(4.0, 4.0, 0.0) + DVec3::Z * z;
        scene.polygon(light, &[low, low + DVec3::X * 0.1, low + DVec3::new(0.1, 0.1, 0.0), low + DVec3::Y * 0.1]);
    }
    assert_close(mean(&scene, irradiance(), DVec3::ZERO, DVec3::Z, 4096), lit, 2e-3);
}

#[test]
fn many_distant_sources_and_near_ones_add_up() {
    let mut scene = Builder::default();
    let light = scene.light([40.0; 3]);
    let full_angle = 1f64.to_radians();
    let solid_angle = 2.0 * PI * (1.0 - (0.5 * full_angle).cos());
    let mut expected = 0.0;
    for index in 0..300 {
        let direction = (scattered(index) - 0.5).normalize();
        // Sources that intersect the horizon are omitted.
        if direction.z.abs() > 0.02 {
            scene.source(light, direction, full_angle);
            expected += 40.0 * solid_angle * direction.z.max(0.0);
        }
    }
    for index in 0..50 {
        let center = DVec3::new(f64::from(index) * 0.1 - 2.5, 0.4, 1.0);
        scene.sphere(light, Sphere { center, radius: 0.01, facing: Facing::Outward });
        let distance = center.length();
        expected += PI * 40.0 * (0.01 / distance).powi(2) / distance;
    }
    assert_close(mean(&scene, irradiance(), DVec3::ZERO, DVec3::Z, 1 << 14), expected, 5e-3);
}

/// Light on a rough highlight: highlight and light sampling are combined.
#[test]
fn highlights_of_many_spheres_do_not_depend_on_how_they_are_found() {
    let of = |more: u32| {
        let mut scene = Builder::default();
        let light = scene.light([50.0; 3]);
        let dark = scene.light([0.0; 3]);
        let floor = scene.metal([0.8; 3], 1.0, 0.1);
        scene.polygon(floor, &[[-3.0, -3.0], [3.0, -3.0], [3.0, 3.0], [-3.0, 3.0]].map(|[x, y]| DVec3::new(x, y, 0.0)));
        for index in 0..20 {
            let center = DVec3::new(0.2 * f64::from(index) - 1.0, 1.0, 0.8);
            scene.sphere(light, Sphere { center, radius: 0.05, facing: Facing::Outward });
        }
        // Black lights elsewhere increase the number so that some are selected.
        for index in 0..more {
            let center = DVec3::new(-2.0, -2.0, 0.5) + 0.5 * scattered(index);
            scene.sphere(dark, Sphere { center, radius: 0.01, facing: Facing::Outward });
        }
        mean(&scene, RenderOptions::default(), DVec3::new(0.0, -1.0, 0.8), DVec3::new(0.0, 1.0, -0.8), 1 << 13)
    };
    assert_close(of(200), of(0), 5e-3);
}
