//! Antimatter subtraction.

mod build;

use build::{Builder, mean, traced};
use glam::DVec3;
use radsight_ir::{Facing, Material, ModifierHandle, Ring, Sphere};
use radsight_render::{Quantity, Ray, RenderOptions};

const DOWN: DVec3 = DVec3::new(0.0, 0.0, -1.0);

fn ball(scene: &mut Builder, modifier: ModifierHandle, z: f64, radius: f64) {
    scene.sphere(modifier, Sphere { center: DVec3::Z * z, radius, facing: Facing::Outward });
}

/// A unit sphere at the origin, and antimatter in a sphere of radius 0.5 around its upper pole.
fn bitten(shade: impl Fn(&mut Builder, ModifierHandle) -> Option<ModifierHandle>) -> Builder {
    let mut scene = Builder::default();
    let paint = scene.plastic([0.5; 3], 0.0, 0.0);
    let shade = shade(&mut scene, paint);
    let antimatter = scene.material(Material::Antimatter { cuts: vec![shade, Some(paint)] });
    ball(&mut scene, paint, 0.0, 1.0);
    ball(&mut scene, antimatter, 1.0, 0.5);
    scene
}

/// Distance to the visible surface, past subtracted ones.
fn distance(scene: &Builder, x: f64) -> f64 {
    let ray = Ray::new(DVec3::new(x, 0.0, 10.0), DOWN).expect("the test's ray is one");
    traced(scene, RenderOptions::default(), &[ray])[0].effective_distance
}

#[test]
fn what_shades_the_cut_shows_the_bottom_of_the_bite() {
    let scene = bitten(|_, paint| Some(paint));
    assert!((distance(&scene, 0.0) - 9.5).abs() < 1e-12);
    assert!((distance(&scene, 0.9) - (10.0 - 0.19_f64.sqrt())).abs() < 1e-12, "beside the bite nothing changes");
}

#[test]
fn with_void_the_body_is_open() {
    let scene = bitten(|_, _| None);
    assert!((distance(&scene, 0.0) - 11.0).abs() < 1e-12, "the far side is seen from within");
}

#[test]
fn the_surface_of_the_cut_faces_out_of_the_body() {
    let scene = bitten(|scene, _| Some(scene.glow_of("Nz")));
    let seen = mean(&scene, RenderOptions::default(), DVec3::Z * 10.0, DOWN, 1);
    assert!((seen - 1.0).abs() < 1e-12, "{seen}");
}

#[test]
fn a_body_that_is_not_named_stays() {
    let mut scene = bitten(|_, paint| Some(paint));
    let other = scene.plastic([0.2; 3], 0.0, 0.0);
    ball(&mut scene, other, 0.8, 0.1);
    assert!((distance(&scene, 0.0) - 9.1).abs() < 1e-12);
}

#[test]
fn light_falls_through_a_hole() {
    let lit = |hole: f64| {
        let mut scene = Builder::default();
        let paint = scene.plastic([0.5; 3], 0.0, 0.0);
        let antimatter = scene.material(Material::Antimatter { cuts: vec![None, Some(paint)] });
        let plate = |z: f64, facing: f64, outer_radius: f64| Ring {
            center: DVec3::Z * z,
            normal: DVec3::Z * facing,
            inner_radius: 0.0,
            outer_radius,
        };
        scene.ring(paint, plate(1.0, 1.0, 5.0));
        ball(&mut scene, antimatter, 1.0, hole);
        let light = scene.light([1.0; 3]);
        scene.source(light, DVec3::Z, 0.01);
        let options = RenderOptions { quantity: Quantity::Irradiance, ..RenderOptions::default() };
        [0.0, 0.4].map(|x| mean(&scene, options.clone(), DVec3::new(x, 0.0, 0.0), DVec3::Z, 64))
    };
    let [below, beside] = lit(0.2);
    assert!(below > 0.0 && beside == 0.0, "{below} {beside}");
}
