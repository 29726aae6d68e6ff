//! Meshes and instances: hits of rays, and the coordinates of functions.

mod build;

use build::{Builder, mean, traced};
use glam::{DMat3, DVec3};
use radsight_ir::{Facing, Material, Mesh, MeshTriangle, ModifierHandle, Rgb, Ring, Sphere, Transform};
use radsight_render::{FirstHit, Quantity, Ray, RenderOptions};
use std::f64::consts::PI;

const DOWN: DVec3 = DVec3::new(0.0, 0.0, -1.0);

/// Rotated, scaled, translated.
fn somewhere() -> Transform {
    Transform {
        rotation: DMat3::from_rotation_z(0.7) * DMat3::from_rotation_x(0.4),
        scale: 2.5,
        translation: DVec3::new(3.0, -1.0, 0.5),
    }
}

fn mirrored() -> Transform {
    Transform { rotation: DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0)), ..Transform::IDENTITY }
}

fn moved(x: f64, y: f64, z: f64) -> Transform {
    Transform { translation: DVec3::new(x, y, z), ..Transform::IDENTITY }
}

fn value(scene: &Builder, origin: DVec3, direction: DVec3) -> f64 {
    mean(scene, RenderOptions::default(), origin, direction, 1)
}

fn first_hit(scene: &Builder, origin: DVec3, direction: DVec3) -> Option<FirstHit> {
    let ray = Ray::new(origin, direction).expect("the test's ray is one");
    traced(scene, RenderOptions::default(), &[ray])[0].first_hit
}

#[track_caller]
fn assert_close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance * expected.abs().max(1.0), "found {found}, expected {expected}");
}

/// A unit square in the plane z = 0 as two triangles, with outward-leaning normals and its own
/// coordinates as (u, v).
fn square(modifier: Option<ModifierHandle>) -> Mesh {
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let triangle = |vertices| MeshTriangle { vertices, smooth: true, textured: true, modifier };
    Mesh {
        file: String::new(),
        cube: Default::default(),
        vertices: corners.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec(),
        normals: corners.map(|(x, y)| DVec3::new(x - 0.5, y - 0.5, 1.0).normalize()).to_vec(),
        uvs: corners.map(|(x, y)| [x, y]).to_vec(),
        triangles: vec![triangle([0, 1, 2]), triangle([0, 2, 3])],
    }
}

/// A globe of triangles inscribed in the unit sphere, seen from outside.
fn globe(rings: u32) -> Mesh {
    let around = 2 * rings;
    let at = |i: u32, j: u32| {
        let (theta, phi) = (PI * f64::from(i) / f64::from(rings), PI * f64::from(j % around) / f64::from(rings));
        DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
    };
    let vertices: Vec<DVec3> =
        (0..=rings).flat_map(|i| (0..around).map(move |j| (i, j))).map(|(i, j)| at(i, j)).collect();
    let index = |i: u32, j: u32| i * around + j % around;
    let mut triangles = Vec::new();
    for i in 0..rings {
        for j in 0..around {
            let corners = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
            for vertices in [[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]] {
                triangles.push(MeshTriangle { vertices, smooth: true, textured: false, modifier: None });
            }
        }
    }
    Mesh {
        file: String::new(),
        cube: Default::default(),
        normals: vertices.clone(),
        uvs: Vec::new(),
        vertices,
        triangles,
    }
}

#[test]
fn a_point_of_a_mesh_has_its_local_coordinates() {
    for (expression, expected) in [("Lu", 0.3), ("Lv", 0.8), ("Px", 0.3), ("Py", 0.8), ("Ts", 0.4), ("S", 0.4)] {
        let mut scene = Builder::default();
        let own = scene.glow_of(expression);
        let place = somewhere();
        scene.mesh(None, square(Some(own)), place);
        let origin = place.point(DVec3::new(0.3, 0.8, 0.4));
        let found = value(&scene, origin, place.direction(DOWN));
        assert_close(found, expected, 1e-12);
    }
}

#[test]
fn a_modifier_of_a_mesh_surface_stands_in_scene_coordinates() {
    let mut scene = Builder::default();
    let own = scene.glow_of("99");
    let overriding = scene.glow_of("Px+10*Lu");
    let place = somewhere();
    scene.mesh(Some(overriding), square(Some(own)), place);
    let at = place.point(DVec3::new(0.3, 0.8, 0.0));
    let found = value(&scene, place.point(DVec3::new(0.3, 0.8, 0.4)), place.direction(DOWN));
    assert_close(found, at.x + 3.0, 1e-12);
}

#[test]
fn normals_of_a_mesh_are_interpolated() {
    let mut scene = Builder::default();
    let paint = scene.plastic([0.5; 3], 0.0, 0.0);
    let place = somewhere();
    scene.mesh(None, square(Some(paint)), place);
    let hit = first_hit(&scene, place.point(DVec3::new(0.5, 0.5, 0.4)), place.direction(DOWN)).expect("it is hit");
    assert_close(hit.distance, 1.0, 1e-12);
    assert!(hit.normal.distance(place.direction(DVec3::Z)) < 1e-12);
    assert!(hit.perturbed_normal.distance(place.direction(DVec3::Z)) < 1e-12);
    let hit = first_hit(&scene, place.point(DVec3::new(0.9, 0.5, 0.4)), place.direction(DOWN)).expect("it is hit");
    let leaning = place.rotation.transpose() * hit.perturbed_normal;
    assert!(leaning.x > 0.2 && leaning.y.abs() < 1e-12, "{leaning}");
}

#[test]
fn a_fine_globe_is_a_sphere() {
    let options = RenderOptions::default();
    let light = |scene: &mut Builder| {
        let light = scene.light([5.0; 3]);
        scene.ring(
            light,
            Ring { center: DVec3::new(4.0, 3.0, 9.0), normal: DOWN, inner_radius: 0.0, outer_radius: 1.0 },
        );
    };
    let place = moved(1.0, 2.0, 3.0);
    let mut of_triangles = Builder::default();
    let paint = of_triangles.plastic([0.6; 3], 0.0, 0.0);
    of_triangles.mesh(Some(paint), globe(64), place);
    light(&mut of_triangles);
    let mut round = Builder::default();
    let paint = round.plastic([0.6; 3], 0.0, 0.0);
    round.sphere(paint, Sphere { center: place.translation, radius: 1.0, facing: Facing::Outward });
    light(&mut round);
    for (x, y) in [(0.0, 0.0), (0.5, 0.3), (-0.2, 0.6), (0.8, 0.1)] {
        let origin = place.point(DVec3::new(x, y, 5.0));
        let of = |scene: &Builder| mean(scene, options.clone(), origin, DOWN, 256);
        assert_close(of(&of_triangles) / of(&round), 1.0, 0.02);
    }
}

#[test]
fn every_ray_at_a_closed_mesh_hits_it_once_in_and_once_out() {
    let mut scene = Builder::default();
    let paint = scene.plastic([0.5; 3], 0.0, 0.0);
    let place = somewhere();
    scene.mesh(Some(paint), globe(23), place);
    let direction = |trial: u32| {
        let angle = |k: f64| (f64::from(trial) * k).fract() * 2.0 * PI;
        DVec3::new(angle(0.7549).cos(), angle(0.7549).sin(), angle(0.5698).cos())
    };
    let rays: Vec<Ray> = (0..2000)
        .flat_map(|trial| [0.0, 10.0].map(|back| (direction(trial), back)))
        .filter_map(|(direction, back)| Ray::new(place.translation - direction.normalize() * back, direction))
        .collect();
    for pair in traced(&scene, RenderOptions::default(), &rays).chunks(2) {
        let distance = |index: usize| pair[index].first_hit.expect("no gap between triangles").distance;
        assert!(distance(0) > 2.5 * 0.98 && distance(0) < 2.5 + 1e-9, "{}", distance(0));
        assert!((distance(1) - 7.5).abs() < 0.06, "{}", distance(1));
    }
}

/// A scene with a glowing sphere of radius 0.25 at the origin; its radiance is the expression's
/// value.
fn ball(expression: &str) -> Builder {
    let mut scene = Builder::default();
    let glow = scene.glow_of(expression);
    scene.sphere(glow, Sphere { center: DVec3::ZERO, radius: 0.25, facing: Facing::Outward });
    scene
}

#[test]
fn functions_within_an_instance_see_its_coordinates() {
    for (expression, expected) in [("Pz", 0.25), ("Nz", 1.0), ("-Dz", 1.0), ("S", 0.4), ("Ts", 0.75)] {
        let inner = ball(expression).shared();
        let mut scene = Builder::default();
        let place = somewhere();
        scene.instance(None, &inner, place);
        assert_close(value(&scene, place.point(DVec3::Z), place.direction(DOWN)), expected, 1e-12);
    }
}

#[test]
fn functions_see_the_composed_transforms_of_nested_instances() {
    let inner = ball("Pz+10*S").shared();
    let mut middle = Builder::default();
    let place = somewhere();
    middle.instance(None, &inner, place);
    let mut scene = Builder::default();
    let outer = Transform { scale: 2.0, ..moved(5.0, 6.0, 7.0) };
    scene.instance(None, &middle.shared(), outer);
    let whole = place.then(&outer);
    assert_close(value(&scene, whole.point(DVec3::Z), whole.direction(DOWN)), 0.25 + 10.0 / 5.0, 1e-12);
}

#[test]
fn a_modifier_of_an_instance_overrides_those_within() {
    let inner = ball("99").shared();
    let mut scene = Builder::default();
    let overriding = scene.glow_of("Pz");
    scene.instance(Some(overriding), &inner, moved(0.0, 0.0, 3.0));
    assert_close(value(&scene, DVec3::Z * 9.0, DOWN), 3.25, 1e-12);
}

#[test]
fn copies_of_copies_are_all_there_and_apart() {
    let inner = ball("1").shared();
    let mut row = Builder::default();
    (0..7).for_each(|x| row.instance(None, &inner, moved(f64::from(x), 0.0, 0.0)));
    let row = row.shared();
    let mut scene = Builder::default();
    (0..7).for_each(|y| scene.instance(None, &row, moved(0.0, f64::from(y), 0.0)));
    for (x, y) in (0..7).flat_map(|x| (0..7).map(move |y| (f64::from(x), f64::from(y)))) {
        let hit = first_hit(&scene, DVec3::new(x, y, 1.0), DOWN).expect("a ball is there");
        assert_close(hit.distance, 0.75, 1e-12);
        assert!(first_hit(&scene, DVec3::new(x + 0.5, y + 0.3, 1.0), DOWN).is_none());
    }
}

#[test]
fn a_flat_surface_of_a_copy_does_not_shade_itself_but_another_copy() {
    let mut leaf = Builder::default();
    let paint = leaf.plastic([0.5; 3], 0.0, 0.0);
    leaf.ring(paint, Ring { center: DVec3::ZERO, normal: DVec3::Z, inner_radius: 0.0, outer_radius: 0.5 });
    let leaf = leaf.shared();
    let mut pair = Builder::default();
    pair.instance(None, &leaf, moved(0.0, 0.0, 0.0));
    pair.instance(None, &leaf, moved(0.0, 0.0, 1.0));
    let mut scene = Builder::default();
    scene.instance(None, &pair.shared(), moved(100.0, 200.0, 300.0));
    let light = scene.light([1.0; 3]);
    scene.source(light, DVec3::Z, 0.01);
    let from_side = |z: f64| value(&scene, DVec3::new(99.0, 200.0, 300.5 + z), DVec3::new(1.0, 0.0, -0.5));
    assert!(from_side(1.0) > 0.0, "the upper leaf is lit");
    assert_eq!(from_side(0.0), 0.0, "the lower leaf is in its shadow");
}

#[test]
fn shadow_rays_go_through_panes_and_what_has_no_material_within_an_instance() {
    let mut window = Builder::default();
    let glass = window.glass([0.5; 3], 1.52);
    let ring = |z: f64| Ring { center: DVec3::Z * z, normal: DVec3::Z, inner_radius: 0.0, outer_radius: 0.5 };
    window.ring(glass, ring(1.0));
    let light = |scene: &mut Builder| {
        let light = scene.light([1.0; 3]);
        scene.source(light, DVec3::Z, 0.01);
    };
    let irradiance = RenderOptions { quantity: Quantity::Irradiance, ..RenderOptions::default() };
    let mut within = Builder::default();
    within.instance(None, &window.clone().shared(), moved(0.0, 0.0, 1.0));
    light(&mut within);
    let mut plain = Builder::default();
    let glass = plain.glass([0.5; 3], 1.52);
    plain.ring(glass, ring(2.0));
    light(&mut plain);
    let of = |scene: &Builder| mean(scene, irradiance.clone(), DVec3::ZERO, DVec3::Z, 64);
    assert_close(of(&within) / of(&plain), 1.0, 1e-9);
    assert!(of(&plain) > 0.0);
}

#[test]
fn a_mirror_image_keeps_its_front() {
    let mut scene = Builder::default();
    let paint = scene.plastic([0.5; 3], 0.0, 0.0);
    scene.mesh(Some(paint), square(None), mirrored());
    let hit = first_hit(&scene, DVec3::new(-0.5, 0.5, 1.0), DOWN).expect("it is hit");
    assert!(hit.normal.distance(DVec3::Z) < 1e-12);
}

#[test]
fn functions_see_a_back_face_as_it_faces() {
    let behind = |expression: &str| {
        let mut scene = ball("1");
        let pane = Material::Glass { transmissivity: Rgb::WHITE, refractive_index: 1.0 };
        let pane = scene.patterned(expression, pane);
        scene.ring(pane, Ring { center: DVec3::Z, normal: DOWN, inner_radius: 0.0, outer_radius: 1.0 });
        value(&scene, DVec3::Z * 2.0, DOWN)
    };
    assert_close(behind("0.5+0.25*Nz"), 0.25, 1e-12);
    assert_close(behind("0.5+0.25*Rdot"), 0.25, 1e-12);
}

#[test]
fn a_light_within_an_instance_is_seen_but_lights_nothing() {
    let mut lamp = Builder::default();
    let light = lamp.light([5.0; 3]);
    lamp.sphere(light, Sphere { center: DVec3::ZERO, radius: 0.5, facing: Facing::Outward });
    let mut scene = Builder::default();
    scene.instance(None, &lamp.shared(), moved(0.0, 0.0, 2.0));
    assert_close(value(&scene, DVec3::ZERO, DVec3::Z), 5.0, 1e-12);
    let options = RenderOptions { quantity: Quantity::Irradiance, ambient_bounces: 1, ..RenderOptions::default() };
    assert_eq!(mean(&scene, options, DVec3::ZERO, DVec3::Z, 256), 0.0);
}

#[test]
fn a_ray_ends_first_where_nothing_happens_to_it() {
    let mut scene = Builder::default();
    scene.mesh(None, square(None), moved(0.0, 0.0, 1.0));
    let glow = scene.glow_of("7");
    scene.ring(glow, Ring { center: DVec3::ZERO, normal: DVec3::Z, inner_radius: 0.0, outer_radius: 5.0 });
    let origin = DVec3::new(0.3, 0.4, 3.0);
    assert_close(first_hit(&scene, origin, DOWN).expect("the mesh is hit").distance, 2.0, 1e-12);
    assert_close(value(&scene, origin, DOWN), 7.0, 1e-12);
}
