//! A sun through prisms, compared with the integral over all directions that they redirect to it.

mod build;

use build::{Builder, mean};
use glam::DVec3;
use radsight_render::{Quantity, RenderOptions};
use std::f64::consts::TAU;

const SUN: f64 = 0.02;

/// A floor under a prism which maps `(x, y, z)` to `(a·x, b·y, z + c·y)` on the way up and back on
/// the way down.
fn irradiance(sun: DVec3, stretch: [f64; 3]) -> f64 {
    let [a, b, c] = stretch;
    let mut scene = Builder::default();
    let light = scene.light([1e4; 3]);
    scene.source(light, sun, 2.0 * SUN);
    let prism = scene.prism([
        "0.8",
        &format!("if(Dz, {a}*Dx, Dx/{a})"),
        &format!("if(Dz, {b}*Dy, Dy/{b})"),
        &format!("if(Dz, Dz + {c}*Dy, Dz - {c}*Dy/{b})"),
    ]);
    let corners = [[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]];
    scene.polygon(prism, &corners.map(|[x, y]| DVec3::new(x, y, 1.0)));
    let options = RenderOptions { quantity: Quantity::Irradiance, ..RenderOptions::default() };
    mean(&scene, options, DVec3::ZERO, DVec3::Z, 1 << 14)
}

/// The same by brute force over all directions around the one to the centre of the sun.
fn integral(sun: DVec3, [a, b, c]: [f64; 3]) -> f64 {
    let turned = |d: DVec3| DVec3::new(a * d.x, b * d.y, d.z + c * d.y).normalize();
    let image = DVec3::new(sun.x / a, sun.y / b, sun.z - c * sun.y / b).normalize();
    let (x, y) = image.any_orthonormal_pair();
    let (rings, turns, widest) = (1200, 720, 0.25f64);
    let mut sum = 0.0;
    for cell in 0..rings * turns {
        let angle = widest * (f64::from(cell / turns) + 0.5) / f64::from(rings);
        let (sin, cos) = (TAU * f64::from(cell % turns) / f64::from(turns)).sin_cos();
        let direction = image * angle.cos() + (x * cos + y * sin) * angle.sin();
        if 2.0 * (0.5 * turned(direction).distance(sun)).asin() < SUN {
            let solid_angle = angle.sin() * widest / f64::from(rings) * TAU / f64::from(turns);
            sum += 0.8 * 1e4 * direction.z * solid_angle;
        }
    }
    sum
}

#[test]
fn a_sun_through_a_prism_has_its_radiance_and_another_shape() {
    let suns = [DVec3::Z, DVec3::new(0.3, -0.2, 0.8).normalize(), DVec3::new(-0.5, 0.6, 0.4).normalize()];
    for stretch in
        [[1.0, 1.0, 0.0], [2.0, 2.0, 0.0], [0.5, 0.6, 0.0], [0.4, 1.5, 0.0], [1.0, 1.0, 0.4], [1.3, 0.8, -0.3]]
    {
        for sun in suns {
            let (found, expected) = (irradiance(sun, stretch), integral(sun, stretch));
            assert!(
                (found / expected - 1.0).abs() < 0.01,
                "{stretch:?}, sun {sun}: found {found}, expected {expected}"
            );
        }
    }
}

/// At every point it redirects rays to the centre of the light, so the light keeps its solid angle.
#[test]
fn a_prism_that_aims_keeps_the_solid_angle_of_the_sun() {
    let mut scene = Builder::default();
    let light = scene.light([1e4; 3]);
    let sun = DVec3::new(0.3, -0.2, 0.8).normalize();
    scene.source(light, sun, 2.0 * SUN);
    let aims = "DxA*DxA+DyA*DyA+DzA*DzA-.1";
    let component = |axis: &str| format!("if({aims}, D{axis}A, D{axis})");
    let prism = scene.prism(["0.5", &component("x"), &component("y"), &component("z")]);
    let corners = [[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]];
    scene.polygon(prism, &corners.map(|[x, y]| DVec3::new(x, y, 1.0)));
    let options = RenderOptions { quantity: Quantity::Irradiance, ..RenderOptions::default() };
    let found = mean(&scene, options, DVec3::ZERO, DVec3::Z, 1 << 12);
    let expected = 0.5 * 1e4 * sun.z * TAU * (1.0 - SUN.cos());
    assert!((found / expected - 1.0).abs() < 0.01, "found {found}, expected {expected}");
}

/// The centre of a square lamp of two units above the prism, which faces it.
const LAMP: DVec3 = DVec3::new(0.4, -0.3, 2.5);
const HALF_LAMP: f64 = 0.2;

/// A point of the floor under the same prism, with the lamp behind it.
fn irradiance_of_lamp(place: DVec3, [a, b, c]: [f64; 3]) -> f64 {
    let mut scene = Builder::default();
    let light = scene.light([100.0; 3]);
    let corners = [[1.0, 1.0], [1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0]];
    scene.polygon(light, &corners.map(|[x, y]| LAMP + DVec3::new(x, y, 0.0) * HALF_LAMP));
    let prism = scene.prism(["0.8", &format!("{a}*Dx"), &format!("{b}*Dy"), &format!("Dz+{c}*Dy")]);
    let corners = [[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]];
    scene.polygon(prism, &corners.map(|[x, y]| DVec3::new(x, y, 1.0)));
    let options = RenderOptions { quantity: Quantity::Irradiance, ..RenderOptions::default() };
    mean(&scene, options, place, DVec3::Z, 1 << 12)
}

/// The same through all points of the prism.
fn integral_of_lamp(place: DVec3, [a, b, c]: [f64; 3]) -> f64 {
    let (side, widest) = (4000, 1.5);
    let step = 2.0 * widest / f64::from(side);
    let mut sum = 0.0;
    for cell in 0..side * side {
        let along = |index: i32| (f64::from(index) + 0.5) * step - widest;
        let before = DVec3::new(along(cell % side), along(cell / side), 1.0);
        let point = place + before;
        let transmitted = DVec3::new(a * before.x, b * before.y, before.z + c * before.y);
        let met = point + transmitted * ((LAMP.z - point.z) / transmitted.z);
        if transmitted.z > 0.0 && (met - LAMP).abs().max_element() < HALF_LAMP {
            // Radiance times the solid angle of a cell of the prism's plane, times the cosine at
            // the floor.
            sum += 0.8 * 100.0 * step * step / before.length_squared().powi(2);
        }
    }
    sum
}

#[test]
fn a_near_lamp_through_a_prism_is_where_its_rays_come_from() {
    for stretch in [[1.0, 1.0, 0.0], [0.5, 0.6, 0.0], [2.0, 1.5, 0.0], [1.0, 1.0, 0.4], [1.3, 0.8, -0.3]] {
        for place in [DVec3::ZERO, DVec3::new(0.5, 0.7, 0.0), DVec3::new(-1.5, 0.2, 0.0)] {
            let (found, expected) = (irradiance_of_lamp(place, stretch), integral_of_lamp(place, stretch));
            assert!(
                (found / expected - 1.0).abs() < 0.01,
                "{stretch:?} at {place}: found {found}, expected {expected}"
            );
        }
    }
}
