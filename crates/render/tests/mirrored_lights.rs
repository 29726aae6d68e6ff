//! The search for images of lights in mirrors.

mod build;

use build::Builder;
use glam::DVec3;
use radsight_ir::{Cone, Facing, Material, Rgb, Ring, Sphere};
use radsight_render::{MirroredLight, Ray, RenderOptions, Renderer};
use std::sync::Arc;

/// From here a washer shows the lamp in its top.
const OBSERVER: DVec3 = DVec3::new(0.3, 0.0, 5.0);

/// A lamp above a mirrored washer: a flat ring and its wall.
fn washer_and_lamp() -> Builder {
    let mut scene = Builder::default();
    let (light, mirror) = (scene.light([50.0; 3]), scene.mirror([0.8; 3]));
    let ring = |z: f64, normal: DVec3, radii: [f64; 2]| Ring {
        center: DVec3::new(0.0, 0.0, z),
        normal,
        inner_radius: radii[0],
        outer_radius: radii[1],
    };
    scene.ring(mirror, ring(0.1, DVec3::Z, [0.1, 1.0]));
    let (base, apex) = (DVec3::ZERO, DVec3::new(0.0, 0.0, 0.1));
    scene.cone(mirror, Cone { base, apex, base_radius: 1.0, apex_radius: 1.0, facing: Facing::Outward });
    scene.ring(light, Ring { center: DVec3::new(0.3, 0.0, 5.0), ..ring(5.0, DVec3::NEG_Z, [0.0, 0.1]) });
    scene
}

#[test]
fn a_light_in_a_plane_mirror_is_not_searched() {
    let renderer = Renderer::new(build::plan(&washer_and_lamp(), RenderOptions::default()));
    let known = MirroredLight::in_plane_mirrors(renderer.plan(), OBSERVER);
    assert_eq!(known.len(), 1);
    let found = renderer.worker().mirrored_lights(OBSERVER, |_, _| true);
    assert!(found.is_empty(), "{found:?}");
    let (axis, tangent) = known[0].mirror_cone().expect("the observer is outside the washer");
    let centre = DVec3::new(0.0, 0.0, 0.1) - OBSERVER;
    assert!(axis.angle_between(centre.normalize()) < 1e-9);
    assert!(tangent > 1.0 / centre.length() && tangent < 2.0 / centre.length(), "{tangent}");
}

#[test]
fn a_light_in_a_ball_on_a_plane_mirror_is_found() {
    let mut scene = washer_and_lamp();
    let mirror = scene.mirror([0.8; 3]);
    let ball = Sphere { center: DVec3::new(-0.6, 0.0, 0.2), radius: 0.1, facing: Facing::Outward };
    scene.sphere(mirror, ball);
    let renderer = Renderer::new(build::plan(&scene, RenderOptions::default()));
    let found = renderer.worker().mirrored_lights(OBSERVER, |_, _| true);
    let to_ball = (DVec3::new(-0.6, 0.0, 0.2) - OBSERVER).normalize();
    assert!(found.iter().any(|image| image.direction().angle_between(to_ball) < 0.02), "{found:?}");
}

/// By Fresnel's equations a ball of index 1.5 reflects 4 % at normal incidence.
#[test]
fn a_ball_of_glass_divides_a_ray_into_ends_by_fresnel() {
    let mut scene = Builder::default();
    let glass = scene.dielectric([1.0; 3], 1.5);
    scene.sphere(glass, Sphere { center: DVec3::ZERO, radius: 1.0, facing: Facing::Outward });
    let light = scene.light([50.0; 3]);
    scene.sphere(light, Sphere { center: DVec3::new(0.0, 0.0, 9.0), radius: 0.1, facing: Facing::Outward });
    let renderer = Renderer::new(build::plan(&scene, RenderOptions::default()));
    let ray = Ray::new(DVec3::new(1e-3, 0.0, 5.0), DVec3::NEG_Z).expect("a direction");
    let mut ends = Vec::new();
    renderer.worker().specular_ends(&ray, &mut ends);
    let weight = |chain: u32| ends.iter().find(|end| end.chain == chain).map_or(0.0, |end| end.weight);
    // Reflected; refracted twice; with a reflection in between.
    for (chain, expected) in [(0b11, 0.04), (0b100, 0.96 * 0.96), (0b1010, 0.96 * 0.96 * 0.04)] {
        assert!((weight(chain) - expected).abs() < 1e-5, "{ends:?}");
    }
    assert!(ends.iter().map(|end| end.weight).sum::<f64>() <= 1.0);
    let beside = Ray::new(DVec3::new(2.0, 0.0, 5.0), DVec3::NEG_Z).expect("a direction");
    ends.clear();
    renderer.worker().specular_ends(&beside, &mut ends);
    assert!(ends.is_empty());
}

/// The profile of a patterned lamp takes milliseconds, so that of a ring of lamps is computed once.
#[test]
fn lamps_with_the_same_emission_share_its_profile() {
    let mut scene = Builder::default();
    let [narrow, other] = ["abs(Dz)^60", "abs(Dz)^90"]
        .map(|pattern| scene.patterned(pattern, Material::Light { radiance: Rgb([50.0; 3]) }));
    let floor = scene.plastic([0.5; 3], 0.0, 0.0);
    let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    scene.polygon(floor, &[corner(-3.0, -3.0), corner(3.0, -3.0), corner(3.0, 3.0), corner(-3.0, 3.0)]);
    for (light, x) in [(narrow, 0.0), (narrow, 0.5), (other, 1.0)] {
        let center = DVec3::new(x, 0.0, 0.5);
        scene.ring(light, Ring { center, normal: DVec3::NEG_Z, inner_radius: 0.0, outer_radius: 0.1 });
    }
    let plan = build::plan(&scene, RenderOptions::default());
    let profiles: Vec<_> = plan.lights.iter().map(|light| light.profile.clone().expect("a narrow lamp")).collect();
    assert!(Arc::ptr_eq(&profiles[0], &profiles[1]) && !Arc::ptr_eq(&profiles[0], &profiles[2]));
}
