//! Radiance of scenes with a closed form.

mod build;

use build::{Builder, mean, values};
use glam::DVec3;
use radsight_ir::{Cone, Facing, Material, Rgb, Ring, Sphere};
use radsight_render::{LightDivision, PathLimit, Quantity, RenderOptions, Skipping};
use std::f64::consts::PI;

const DOWN: DVec3 = DVec3::new(0.0, 0.0, -1.0);

fn irradiance() -> RenderOptions {
    RenderOptions { quantity: Quantity::Irradiance, ..RenderOptions::default() }
}

#[track_caller]
fn assert_close(found: f64, expected: f64, tolerance: f64) {
    assert!((found / expected - 1.0).abs() < tolerance, "found {found}, expected {expected}");
}

#[test]
fn a_disk_light_gives_the_irradiance_of_its_form_factor() {
    let mut scene = Builder::default();
    let light = scene.light([7.0; 3]);
    let (radius, height) = (0.8, 1.5);
    scene.ring(light, Ring { center: DVec3::Z * height, normal: DOWN, inner_radius: 0.0, outer_radius: radius });
    // E = πL r²/(r² + h²) below the centre of a disk.
    let expected = PI * 7.0 * radius * radius / (radius * radius + height * height);
    assert_close(mean(&scene, irradiance(), DVec3::ZERO, DVec3::Z, 4096), expected, 1e-4);
}

#[test]
fn a_narrow_beam_of_a_large_light_is_found_from_near() {
    let mut scene = Builder::default();
    // It emits to rays within 2.56° of its normal.
    let light = scene.patterned("if(Dz-.999,5,0)", Material::Light { radiance: Rgb::WHITE });
    let corner = |x: f64, y: f64| DVec3::new(x, y, 1.0);
    scene.polygon(light, &[corner(5.0, 5.0), corner(5.0, -5.0), corner(-5.0, -5.0), corner(-5.0, 5.0)]);
    // E = πL sin²θ of a cone about the normal.
    let expected = PI * 5.0 * (1.0 - 0.999f64 * 0.999);
    for place in [DVec3::ZERO, DVec3::new(4.1, -2.3, 0.0)] {
        assert_close(mean(&scene, irradiance(), place, DVec3::Z, 4096), expected, 0.01);
    }
}

/// Previews select one of several points of such a light for each sample.
#[test]
fn a_narrow_beam_in_a_preview_has_its_mean_and_less_noise() {
    let corner = |x: f64, y: f64| DVec3::new(x, y, 1.0);
    // E = 2π ∫ L cos θ sin θ dθ: πL sin²θ of a cone, and 2πL/(n + 2) of a power of the cosine.
    let beams = [
        ("if(Dz-.999,5,0)", PI * 5.0 * (1.0 - 0.999f64 * 0.999)),
        ("5*abs(Dz)^200", 2.0 * PI * 5.0 / 202.0),
        ("5*abs(Dz)^30", 2.0 * PI * 5.0 / 32.0),
    ];
    for (pattern, expected) in beams {
        let mut scene = Builder::default();
        let light = scene.patterned(pattern, Material::Light { radiance: Rgb::WHITE });
        scene.polygon(light, &[corner(9.0, 9.0), corner(9.0, -9.0), corner(-9.0, -9.0), corner(-9.0, 9.0)]);
        for place in [DVec3::ZERO, DVec3::new(4.1, -2.3, 0.0)] {
            let [single, selected] = [LightDivision::Whole, LightDivision::BySize(1e-3)].map(|light_division| {
                let options = RenderOptions { light_division, ..irradiance() };
                statistics(&values(&scene, options, place, DVec3::Z, 4096))
            });
            for [mean, deviation] in [single, selected] {
                assert!((mean - expected).abs() < 3.0 * deviation / 64.0, "{mean} ± {deviation} for {expected}");
            }
            assert!(selected[1] < 0.6 * single[1], "{selected:?} and {single:?} of {pattern}");
        }
    }
}

/// Mean and standard deviation.
fn statistics(values: &[f64]) -> [f64; 2] {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    [mean, (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()]
}

#[test]
fn a_sphere_light_gives_the_irradiance_of_a_point_light_off_its_axis() {
    let mut scene = Builder::default();
    let light = scene.light([2.0; 3]);
    let (radius, center) = (0.4, DVec3::new(1.0, 0.5, 2.0));
    scene.sphere(light, Sphere { center, radius, facing: Facing::Outward });
    // A sphere entirely above the horizon: E = π L (r/d)² cos θ.
    let distance = center.length();
    let expected = PI * 2.0 * (radius / distance).powi(2) * center.z / distance;
    assert_close(mean(&scene, irradiance(), DVec3::ZERO, DVec3::Z, 4096), expected, 1e-3);
}

#[test]
fn a_parallelogram_and_an_l_shape_of_the_same_place_agree() {
    let rectangle = |scene: &mut Builder, x0: f64, x1: f64, y0: f64, y1: f64| {
        let light = scene.light([3.0; 3]);
        let corner = |x, y| DVec3::new(x, y, 1.0);
        // Clockwise from above: it emits downwards.
        scene.polygon(light, &[corner(x0, y0), corner(x0, y1), corner(x1, y1), corner(x1, y0)]);
    };
    let mut two = Builder::default();
    rectangle(&mut two, 0.0, 1.0, 0.0, 0.3);
    rectangle(&mut two, 0.0, 0.3, 0.3, 1.0);
    let mut one = Builder::default();
    let light = one.light([3.0; 3]);
    let l = [(0.0, 0.0), (0.0, 1.0), (0.3, 1.0), (0.3, 0.3), (1.0, 0.3), (1.0, 0.0)];
    one.polygon(light, &l.map(|(x, y)| DVec3::new(x, y, 1.0)));
    let of = |scene: &Builder| mean(scene, irradiance(), DVec3::new(0.2, 0.1, 0.0), DVec3::Z, 1 << 14);
    assert_close(of(&one), of(&two), 2e-3);
}

#[test]
fn a_cylinder_light_gives_the_irradiance_of_a_long_line() {
    let mut scene = Builder::default();
    let light = scene.light([1.0; 3]);
    let (radius, height, half) = (0.01, 1.0, 200.0);
    let (base, apex) = (DVec3::new(-half, 0.0, height), DVec3::new(half, 0.0, height));
    scene.cone(light, Cone { base, apex, base_radius: radius, apex_radius: radius, facing: Facing::Outward });
    // An infinite cylinder of radius r at height h: E = π L r / h to first order in r/h.
    assert_close(mean(&scene, irradiance(), DVec3::ZERO, DVec3::Z, 1 << 16), PI * radius / height, 0.02);
}

#[test]
fn a_small_sun_gives_its_solid_angle_times_the_cosine() {
    let mut scene = Builder::default();
    let light = scene.light([1e6; 3]);
    let direction = DVec3::new(0.3, -0.2, 0.8).normalize();
    let full_angle = 0.533f64.to_radians();
    scene.source(light, direction, full_angle);
    let solid_angle = 2.0 * PI * (1.0 - (0.5 * full_angle).cos());
    let found = mean(&scene, irradiance(), DVec3::ZERO, DVec3::Z, 256);
    assert_close(found, 1e6 * solid_angle * direction.z, 1e-4);
}

/// In a closed sphere of reflectance ρ whose wall glows, the radiance is L/(1 − ρ) in the limit of
/// many bounces.
#[test]
fn a_white_furnace_keeps_its_energy() {
    let mut scene = Builder::default();
    let wall = scene.plastic([0.6; 3], 0.0, 0.0);
    let glow = scene.light([1.0; 3]);
    scene.sphere(wall, Sphere { center: DVec3::ZERO, radius: 2.0, facing: Facing::Inward });
    scene.sphere(glow, Sphere { center: DVec3::ZERO, radius: 0.5, facing: Facing::Outward });
    let options = RenderOptions { ambient_bounces: 200, path_limit: PathLimit::Roulette, ..RenderOptions::default() };
    let found = mean(&scene, options, DVec3::new(0.0, 0.0, 1.0), DVec3::Z, 1 << 14);
    // Power balance: Φ = πL·A_lamp. A fraction F of the light reflected by the wall hits the black
    // lamp, F = A_lamp/A_wall = 1/16. The wall's irradiance E obeys E·A_wall = Φ + ρ·E·A_wall·(1 −
    // F), and its radiance is ρE/π.
    let (rho, f) = (0.6, 1.0 / 16.0);
    let irradiance = PI * f / (1.0 - rho * (1.0 - f));
    assert_close(found, rho * irradiance / PI, 5e-3);
}

/// A dielectric without absorption is invisible in uniform light: reflected and refracted rays add
/// up.
#[test]
fn a_clear_body_in_a_white_furnace_is_invisible() {
    let mut scene = Builder::default();
    let clear = scene.dielectric([1.0; 3], 1.5);
    let glow = scene.glow([2.0; 3], 0.0);
    scene.sphere(clear, Sphere { center: DVec3::ZERO, radius: 1.0, facing: Facing::Outward });
    scene.source(glow, DVec3::Z, 2.0 * PI);
    let options = RenderOptions { path_limit: PathLimit::Roulette, least_weight: 1e-3, ..RenderOptions::default() };
    for height in [0.0, 0.5, 0.9, 0.99] {
        let found = mean(&scene, options.clone(), DVec3::new(-3.0, height, 0.0), DVec3::X, 256);
        assert_close(found, 2.0, 1e-3);
        // Within the body radiance is larger by the square of its index.
        let inside = mean(&scene, options.clone(), DVec3::new(0.0, 0.5 * height, 0.1), DVec3::X, 256);
        assert_close(inside, 2.0 * 2.25, 1e-3);
    }
}

/// A dielectric attenuates by its transmissivity to the power of the distance.
#[test]
fn an_absorbing_body_dims_by_beers_law() {
    let mut scene = Builder::default();
    let body = scene.dielectric([0.7; 3], 1.0);
    let glow = scene.glow([2.0; 3], 0.0);
    scene.sphere(body, Sphere { center: DVec3::ZERO, radius: 1.0, facing: Facing::Outward });
    scene.source(glow, DVec3::Z, 2.0 * PI);
    for height in [0.0, 0.5, 0.9] {
        let through = 2.0 * (1.0f64 - height * height).sqrt();
        let found = mean(&scene, RenderOptions::default(), DVec3::new(-3.0, height, 0.0), DVec3::X, 1);
        assert_close(found, 2.0 * 0.7f64.powf(through), 1e-9);
    }
}

/// The ambient value replaces light after the last bounce: a Lambertian surface reflects its
/// reflectance times it.
#[test]
fn the_ambient_value_lights_where_no_bounce_is_left() {
    let mut scene = Builder::default();
    let wall = scene.plastic([0.6; 3], 0.0, 0.0);
    scene.sphere(wall, Sphere { center: DVec3::ZERO, radius: 2.0, facing: Facing::Inward });
    for (bounces, expected) in [(0, 0.6 * 3.0), (1, 0.36 * 3.0), (2, 0.216 * 3.0)] {
        let options =
            RenderOptions { ambient_bounces: bounces, ambient_value: Rgb([3.0; 3]), ..RenderOptions::default() };
        assert_close(mean(&scene, options, DVec3::ZERO, DVec3::Z, 64), expected, 1e-9);
    }
}

#[test]
fn a_perfect_mirror_corner_returns_the_light() {
    let mut scene = Builder::default();
    let mirror = scene.mirror([0.9; 3]);
    let light = scene.light([5.0; 3]);
    let corner = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    scene
        .polygon(mirror, &[corner(0.0, 0.0, 0.0), corner(4.0, 0.0, 0.0), corner(4.0, 4.0, 0.0), corner(0.0, 4.0, 0.0)]);
    scene
        .polygon(mirror, &[corner(0.0, 0.0, 0.0), corner(0.0, 4.0, 0.0), corner(0.0, 4.0, 4.0), corner(0.0, 0.0, 4.0)]);
    scene.sphere(light, Sphere { center: DVec3::new(2.8, 2.0, 2.1), radius: 0.3, facing: Facing::Outward });
    let origin = DVec3::new(2.0, 2.0, 1.5);
    let direction = (DVec3::new(0.0, 2.0, 0.01) - origin).normalize();
    let found = mean(&scene, RenderOptions::default(), origin, direction, 1);
    // At the edge and off it: reflected twice, back near the start, into the lamp.
    assert_close(found, 5.0 * 0.9 * 0.9, 1e-9);
}

/// A diffuse floor lit through a plane mirror: equal to an unfolded light.
#[test]
fn a_plane_mirror_relays_a_light() {
    let disk = Ring { center: DVec3::new(-1.0, 0.0, 1.0), normal: DVec3::X, inner_radius: 0.0, outer_radius: 0.2 };
    let mut folded = Builder::default();
    let light = folded.light([10.0; 3]);
    let mirror = folded.mirror([0.8; 3]);
    folded.ring(light, disk);
    let wall = |y: f64, z: f64| DVec3::new(2.0, y, z);
    folded.polygon(mirror, &[wall(-9.0, 9.0), wall(9.0, 9.0), wall(9.0, -9.0), wall(-9.0, -9.0)]);
    let mut unfolded = Builder::default();
    let light = unfolded.light([8.0; 3]);
    unfolded.ring(light, Ring { center: DVec3::new(5.0, 0.0, 1.0), normal: -DVec3::X, ..disk });
    let direct_only = unfolded_direct(&disk);
    let of = |scene: &Builder| mean(scene, irradiance(), DVec3::ZERO, DVec3::Z, 1 << 12);
    assert_close(of(&folded) - of(&direct_only), of(&unfolded), 1e-3);
}

fn unfolded_direct(disk: &Ring) -> Builder {
    let mut scene = Builder::default();
    let light = scene.light([10.0; 3]);
    scene.ring(light, *disk);
    scene
}

#[test]
fn glass_between_lamp_and_floor_takes_its_share() {
    let mut scene = Builder::default();
    let light = scene.light([4.0; 3]);
    let glass = scene.glass([0.96; 3], 1.52);
    scene.ring(light, Ring { center: DVec3::Z * 3.0, normal: DOWN, inner_radius: 0.0, outer_radius: 0.05 });
    let open = mean(&scene, irradiance(), DVec3::ZERO, DVec3::Z, 64);
    let at = |x: f64, y: f64| DVec3::new(x, y, 1.0);
    scene.polygon(glass, &[at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)]);
    let paned = mean(&scene, irradiance(), DVec3::ZERO, DVec3::Z, 64);
    // Normal incidence: r = ((n−1)/(n+1))², T = (1−r)² t / (1 − r² t²).
    let (r, t) = ((0.52f64 / 2.52).powi(2), 0.96);
    assert_close(paned / open, (1.0 - r) * (1.0 - r) * t / (1.0 - r * r * t * t), 1e-3);
}

/// Rough metal under a large lamp: sampling lights and sampling the highlight have the same mean.
#[test]
fn combined_sampling_agrees_with_itself_for_narrow_and_wide_highlights() {
    for roughness in [0.02, 0.1, 0.4] {
        let build = |relit: bool| {
            let mut scene = Builder::default();
            let metal = scene.metal([0.9; 3], 1.0, roughness);
            let floor = |x: f64, y: f64| DVec3::new(x, y, 0.0);
            scene.polygon(metal, &[floor(-5.0, -5.0), floor(5.0, -5.0), floor(5.0, 5.0), floor(-5.0, 5.0)]);
            // Only the highlight finds a glow that is not sampled.
            let lamp = if relit { scene.light([1.0; 3]) } else { scene.glow([1.0; 3], 0.0) };
            scene.ring(
                lamp,
                Ring { center: DVec3::new(0.0, 1.3, 2.0), normal: DOWN, inner_radius: 0.0, outer_radius: 0.7 },
            );
            scene
        };
        let (origin, direction) = (DVec3::new(0.0, -1.0, 1.0), DVec3::new(0.0, 1.0, -1.2).normalize());
        let of = |scene: &Builder| mean(scene, RenderOptions::default(), origin, direction, 1 << 16);
        assert_close(of(&build(true)), of(&build(false)), 0.01);
    }
}

#[test]
fn skipping_shadow_rays_changes_no_bit() {
    let mut scene = Builder::default();
    let plastic = scene.plastic([0.5, 0.4, 0.3], 0.05, 0.1);
    let light = scene.light([9.0; 3]);
    let floor = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    scene.polygon(plastic, &[floor(-5.0, -5.0), floor(5.0, -5.0), floor(5.0, 5.0), floor(-5.0, 5.0)]);
    for k in 0..5 {
        let center = DVec3::new(f64::from(k) - 2.0, 0.3, 2.0);
        scene.ring(light, Ring { center, normal: DOWN, inner_radius: 0.0, outer_radius: 0.2 });
    }
    scene.sphere(plastic, Sphere { center: DVec3::new(0.5, 0.0, 1.0), radius: 0.4, facing: Facing::Outward });
    for k in 0..40 {
        let origin = DVec3::new(-2.0 + 0.1 * f64::from(k), -1.5, 1.7);
        let direction = DVec3::new(0.1, 0.8, -1.0);
        let with = |skipping| {
            let options = RenderOptions { skipping, ..RenderOptions::default() };
            build::values(&scene, options, origin, direction, 8)
        };
        assert_eq!(with(Skipping::ALLOWED), with(Skipping::FORBIDDEN));
    }
}

#[test]
fn many_lights_that_are_drawn_by_promise_agree_with_the_sum_of_each() {
    let lamps = 200;
    let place = |k: i32| DVec3::new(f64::from(k % 20) - 10.0, f64::from(k / 20) - 5.0, 3.0);
    let mut all = Builder::default();
    let light = all.light([2.0; 3]);
    let mut expected = 0.0;
    for k in 0..lamps {
        let ring = Ring { center: place(k), normal: DOWN, inner_radius: 0.0, outer_radius: 0.1 };
        all.ring(light, ring);
        let mut one = Builder::default();
        let light = one.light([2.0; 3]);
        one.ring(light, ring);
        expected += mean(&one, irradiance(), DVec3::new(0.3, 0.2, 0.0), DVec3::Z, 16);
    }
    let found = mean(&all, irradiance(), DVec3::new(0.3, 0.2, 0.0), DVec3::Z, 1 << 12);
    assert_close(found, expected, 2e-3);
}

#[test]
fn a_hollow_ball_of_glass_dims_a_shadow_ray_twice() {
    let lit = |scene: &mut Builder| {
        let light = scene.light([100.0; 3]);
        let center = DVec3::Z * 4.0;
        scene.ring(light, Ring { center, normal: DOWN, inner_radius: 0.0, outer_radius: 0.01 });
    };
    let (mut bare, mut covered) = (Builder::default(), Builder::default());
    lit(&mut bare);
    lit(&mut covered);
    let glass = covered.glass([0.5; 3], 1.52);
    covered.sphere(glass, Sphere { center: DVec3::Z, radius: 0.5, facing: Facing::Outward });
    let of = |scene: &Builder| mean(scene, irradiance(), DVec3::ZERO, DVec3::Z, 64);
    // A pane at normal incidence: t(1 − r)²/(1 − r²t²), r = ((n − 1)/(n + 1))².
    let r = (0.52f64 / 2.52).powi(2);
    let once = 0.5 * (1.0 - r) * (1.0 - r) / (1.0 - r * r * 0.25);
    assert_close(of(&covered) / of(&bare), once * once, 1e-3);
}
