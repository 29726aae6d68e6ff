//! Caustics of lamps by curved mirrors and dielectrics, compared with sums over all directions and
//! with the same lamps as glows, which diffuse rays hit by chance.

mod build;

use build::{Builder, plan, values};
use glam::DVec3;
use radsight_ir::{Cone, Facing, ModifierHandle, Sphere};
use radsight_render::{Caustics, Quantity, RenderOptions};
use std::f64::consts::TAU;

const RADIANCE: f64 = 100.0;

fn options(caustics: Caustics, ambient_bounces: u32) -> RenderOptions {
    RenderOptions { quantity: Quantity::Irradiance, caustics, ambient_bounces, ..RenderOptions::default() }
}

fn ball(center: DVec3, radius: f64) -> Sphere {
    Sphere { center, radius, facing: Facing::Outward }
}

/// Irradiance at the origin, facing up, and its standard error.
fn irradiance(scene: &Builder, options: RenderOptions, count: usize) -> (f64, f64) {
    let values = values(scene, options, DVec3::ZERO, DVec3::Z, count);
    let mean = values.iter().sum::<f64>() / count as f64;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1) as f64;
    (mean, (variance / count as f64).sqrt())
}

/// Caustics minus Radiance's light, for a lamp and one object in front of it.
#[track_caller]
fn assert_finds_what_chance_finds(thing: impl Fn(&mut Builder), lamp: Sphere) {
    let scene = |lamp_material: fn(&mut Builder) -> ModifierHandle| {
        let mut scene = Builder::default();
        thing(&mut scene);
        let material = lamp_material(&mut scene);
        scene.sphere(material, lamp);
        scene
    };
    let light = scene(|scene| scene.light([RADIANCE; 3]));
    let glow = scene(|scene| scene.glow([RADIANCE; 3], 0.0));
    let (expected, expected_error) = irradiance(&glow, options(Caustics::Discarded, 1), 1 << 20);
    let (found, error) = irradiance(&light, options(Caustics::Sampled, 0), 1 << 13);
    let (without, _) = irradiance(&light, options(Caustics::Discarded, 0), 1 << 10);
    let bound = 3.5 * expected_error.hypot(error);
    assert!((found - expected).abs() < bound, "found {found} ± {error}, by chance {expected} ± {expected_error}");
    assert!(found - without > 4.0 * bound, "{found} with caustics, {without} without: the test shows nothing");
    let per_ray = [(error, 1 << 13), (expected_error, 1 << 20)].map(|(error, rays)| error * f64::from(rays).sqrt());
    assert!(per_ray[0] < per_ray[1], "errors of one ray, solved for and by chance: {per_ray:?}");
}

#[test]
fn a_convex_mirror_shows_the_lamp_with_its_solid_angle() {
    let (center, radius) = (DVec3::new(1.2, 0.3, 1.0), 0.5);
    let lamp = ball(DVec3::new(-0.8, 0.5, 2.0), 0.04);
    let mut scene = Builder::default();
    let mirror = scene.mirror([0.8; 3]);
    scene.sphere(mirror, ball(center, radius));
    let light = scene.light([RADIANCE; 3]);
    scene.sphere(light, lamp);
    let reflected = {
        let (axis, distance) = (center.normalize(), center.length());
        let (x, y) = axis.any_orthonormal_pair();
        let widest = (radius / distance).asin();
        let (rings, turns) = (2000, 2000);
        let mut sum = 0.0;
        for cell in 0..rings * turns {
            let angle = widest * (f64::from(cell / turns) + 0.5) / f64::from(rings);
            let (sin, cos) = (TAU * (f64::from(cell % turns) + 0.5) / f64::from(turns)).sin_cos();
            let direction = axis * angle.cos() + (x * cos + y * sin) * angle.sin();
            let along = center.dot(direction);
            let inside = radius * radius - (center - direction * along).length_squared();
            let met = direction * (along - inside.max(0.0).sqrt());
            let onward = direction.reflect((met - center).normalize());
            let to_lamp = lamp.center - met;
            let passes = to_lamp - onward * to_lamp.dot(onward);
            if direction.z > 0.0 && to_lamp.dot(onward) > 0.0 && passes.length() < lamp.radius {
                let solid_angle = angle.sin() * widest / f64::from(rings) * TAU / f64::from(turns);
                sum += 0.8 * RADIANCE * direction.z * solid_angle;
            }
        }
        sum
    };
    let (found, error) = irradiance(&scene, options(Caustics::Sampled, 0), 1 << 15);
    let (without, _) = irradiance(&scene, options(Caustics::Discarded, 0), 1 << 15);
    let (found, bound) = (found - without, 3.5 * error);
    assert!((found - reflected).abs() < bound, "found {found} ± {error}, expected {reflected}");
    assert!(bound < 0.1 * reflected, "a bound of {bound} shows nothing");
}

#[test]
fn a_ball_of_glass_focuses_a_lamp() {
    assert_finds_what_chance_finds(
        |scene| {
            let glass = scene.dielectric([1.0; 3], 1.5);
            scene.sphere(glass, ball(DVec3::new(0.1, 0.0, 0.9), 0.5));
        },
        ball(DVec3::new(0.4, 0.1, 3.0), 0.15),
    );
}

#[test]
fn a_ball_of_glass_makes_a_bright_spot() {
    assert_finds_what_chance_finds(
        |scene| {
            let glass = scene.dielectric([1.0; 3], 1.5);
            scene.sphere(glass, ball(DVec3::new(0.0, 0.0, 0.9), 0.5));
        },
        ball(DVec3::new(0.05, 0.02, 3.0), 0.15),
    );
}

#[test]
fn a_tube_throws_light_into_its_inside() {
    assert_finds_what_chance_finds(
        |scene| {
            let mirror = scene.metal([0.9; 3], 1.0, 0.0);
            let (base, radius, height) = (DVec3::new(0.2, 0.1, 0.0), 0.8, 0.7);
            scene.cone(
                mirror,
                Cone {
                    base,
                    apex: base + DVec3::Z * height,
                    base_radius: radius,
                    apex_radius: radius,
                    facing: Facing::Inward,
                },
            );
        },
        ball(DVec3::new(1.2, 0.4, 2.0), 0.15),
    );
}

#[test]
fn what_has_no_curved_mirrors_samples_no_caustics() {
    let mut scene = Builder::default();
    let light = scene.light([RADIANCE; 3]);
    scene.sphere(light, ball(DVec3::new(0.4, 0.1, 3.0), 0.15));
    assert!(!plan(&scene, options(Caustics::Sampled, 1)).samples_caustics());
    let glass = scene.dielectric([1.0; 3], 1.5);
    scene.sphere(glass, ball(DVec3::new(0.1, 0.0, 0.9), 0.5));
    assert!(plan(&scene, options(Caustics::Sampled, 1)).samples_caustics());
    assert!(!plan(&scene, options(Caustics::Discarded, 1)).samples_caustics());
}
