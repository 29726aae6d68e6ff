//! A sun through prisms, against the integral over all directions that they send to it.

mod build;

use build::{Builder, mean};
use glam::DVec3;
use radsight_render::{Quantity, RenderOptions};
use std::f64::consts::TAU;

const SUN: f64 = 0.02;

/// A floor under a prism which turns `(x, y, z)` to `(a·x, b·y, z + c·y)` on the way up and back on the way down.
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

/// The same by trying all directions around the one that leads to the middle of the sun.
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

/// Wherever it is met it sends rays to the middle of the light, so the light keeps its solid angle.
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
