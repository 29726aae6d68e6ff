//! Cubature over small lights gives the mean of many samples, and leaves the rest alone.

mod build;

use build::Builder;
use glam::DVec3;
use radsight_ir::{Cone, Facing, Material, ModifierHandle, Rgb, Ring, Sphere};
use radsight_render::{CubatureError, Ray, RayWorker, RenderOptions, Renderer};
use std::f64::consts::TAU;

/// Height of the lamps and of the eye above the sheet.
const HEIGHT: f64 = 0.48;

/// Full angle of a lamp's cone, radians.
const CONE: f64 = 0.122;

/// A square sheet of this material at z = 0.
fn sheet(scene: &mut Builder, material: ModifierHandle) {
    let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    scene.polygon(material, &[corner(-0.3, -0.3), corner(0.3, -0.3), corner(0.3, 0.3), corner(-0.3, 0.3)]);
}

/// The centres of the lamps. The bounding boxes of the second and the third overlap.
fn lamp_centers() -> [DVec3; 4] {
    [0.0_f64, 30.0, 60.0, 110.0].map(|angle| {
        let (sin, cos) = angle.to_radians().sin_cos();
        DVec3::new(0.0127 * cos, 0.0127 * sin, HEIGHT)
    })
}

/// Lamps beside the eye that shine straight down.
fn lamps(scene: &mut Builder, radius: f64) {
    let light = scene.spotlight([1e3; 3], CONE, -DVec3::Z);
    for center in lamp_centers() {
        scene.ring(light, Ring { center, normal: -DVec3::Z, inner_radius: 0.0, outer_radius: radius });
    }
}

fn renderer(scene: &Builder) -> Renderer {
    Renderer::new(build::plan(scene, RenderOptions::default()))
}

/// The ray from the eye to a point of the sheet.
fn ray_to(x: f64, y: f64) -> Ray {
    let eye = DVec3::new(0.0, 0.0, HEIGHT);
    Ray::new(eye, DVec3::new(x, y, 0.0) - eye).expect("the sheet is below the eye")
}

fn integrated(renderer: &Renderer, ray: &Ray, error: f64) -> f64 {
    let mut worker = renderer.worker();
    worker.integrate_lights(Some(CubatureError(error)));
    let value = worker.trace(1, ray).value[0];
    assert_eq!(value, worker.trace(7, ray).value[0], "no sample has a part in it");
    value
}

/// Mean of many samples, and its standard error.
fn sampled(renderer: &Renderer, ray: &Ray) -> [f64; 2] {
    let (count, mut worker) = (1 << 14, renderer.worker());
    let values: Vec<f64> = (0..count).map(|index| worker.trace(index, ray).value[0]).collect();
    let mean = values.iter().sum::<f64>() / count as f64;
    let squares = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count as f64;
    [mean, (squares / count as f64).sqrt()]
}

/// From the middle of all cones over the edges of both to the dark.
const POINTS: [(f64, f64); 7] =
    [(0.0, 0.0), (0.01, 0.02), (0.0405, 0.002), (0.0425, -0.001), (-0.004, 0.0395), (-0.005, 0.041), (0.08, 0.0)];

fn assert_agrees(scene: &Builder, at: (f64, f64), allowed: f64) {
    let (renderer, ray) = (renderer(scene), ray_to(at.0, at.1));
    let (value, [mean, error]) = (integrated(&renderer, &ray, allowed), sampled(&renderer, &ray));
    assert!((value - mean).abs() <= 4.0 * error + 4.0 * allowed * mean, "{at:?}: {value}, not {mean} ± {error}");
    assert!((value > 0.0) == (at.0 < 0.05), "{at:?}: {value}");
}

#[test]
fn a_diffuse_sheet_has_the_mean_of_many_samples() {
    let mut scene = Builder::default();
    let white = scene.plastic([0.8; 3], 0.0, 0.0);
    sheet(&mut scene, white);
    lamps(&mut scene, 0.0025);
    POINTS.into_iter().for_each(|at| assert_agrees(&scene, at, 1e-4));
}

#[test]
fn retroreflective_sheeting_has_the_mean_of_many_samples() {
    for (roughness, radius) in [(0.00612, 0.0025), (0.02, 0.003), (0.00612, 0.0005)] {
        let mut scene = Builder::default();
        let material = scene.sheeting(0.086, roughness);
        sheet(&mut scene, material);
        lamps(&mut scene, radius);
        // The edge of the cone of a lamp of .5 mm is narrow.
        let is_clear = |at: &(f64, f64)| radius > 0.001 || at.0 != 0.0425;
        POINTS.into_iter().filter(is_clear).for_each(|at| assert_agrees(&scene, at, 5e-4));
    }
}

/// Lamps whose radiance depends on the direction.
fn patterned_lamps(scene: &mut Builder, pattern: &str) {
    let light = scene.patterned(pattern, Material::Light { radiance: Rgb([1e3; 3]) });
    for center in lamp_centers() {
        scene.ring(light, Ring { center, normal: -DVec3::Z, inner_radius: 0.0, outer_radius: 0.0025 });
    }
}

/// Mean of many rays with lights integrated, its standard error, and the variance of one ray.
fn integrated_mean(renderer: &Renderer, ray: &Ray) -> [f64; 3] {
    let (count, mut worker) = (1 << 12, renderer.worker());
    worker.integrate_lights(Some(CubatureError(1e-4)));
    let values: Vec<f64> = (0..count).map(|index| worker.trace(index, ray).value[0]).collect();
    let mean = values.iter().sum::<f64>() / count as f64;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count as f64;
    [mean, (variance / count as f64).sqrt(), variance]
}

/// A pattern is integrated by its linear part; a sample adds what is left. Cones, kinks and jumps
/// are right in the mean.
#[test]
fn patterned_lamps_have_the_mean_of_many_samples() {
    // Smooth; with a kink; with a jump; and by the place on the lamp.
    let patterns = ["Dz*Dz*Dz", "1+20*abs(acos(Dz)-.06)", "if(Dz-.9982,1,.7)", "1+40*(Px-.0127)+if(Py-.001,.1,0)"];
    for (pattern, gain) in patterns.into_iter().zip([50.0, 10.0, 1.5, 2.0]) {
        let mut scene = Builder::default();
        let material = scene.sheeting(0.086, 0.00612);
        sheet(&mut scene, material);
        patterned_lamps(&mut scene, pattern);
        let renderer = renderer(&scene);
        for at in [(0.0, 0.0), (0.01, 0.02), (0.028, 0.002), (-0.004, 0.0295)] {
            let ray = ray_to(at.0, at.1);
            let ([mean, error, variance], [truth, truth_error]) =
                (integrated_mean(&renderer, &ray), sampled(&renderer, &ray));
            let allowed = 4.0 * error.hypot(truth_error) + 4e-4 * truth;
            assert!((mean - truth).abs() <= allowed, "{pattern} {at:?}: {mean}, not {truth} ± {truth_error}");
            let of_sampling = truth_error * truth_error * f64::from(1 << 14);
            assert!(variance * gain < of_sampling, "{pattern} {at:?}: {variance}, sampled {of_sampling}");
        }
    }
}

/// A washer of which the sheet sees the lamps past: its outer wall, its inner wall and its top may
/// hide them, and do so nowhere but beside the walls.
#[test]
fn lamps_are_integrated_beside_and_within_a_washer() {
    let mut scene = Builder::default();
    let material = scene.sheeting(0.086, 0.00612);
    sheet(&mut scene, material);
    lamps(&mut scene, 0.0025);
    let black = scene.plastic([0.0; 3], 0.0, 0.0);
    let (base, apex) = (DVec3::ZERO, DVec3::new(0.0, 0.0, 0.002));
    for radius in [0.0065, 0.0125] {
        let facing = Facing::Outward;
        scene.cone(black, Cone { base, apex, base_radius: radius, apex_radius: radius, facing });
    }
    scene.ring(black, Ring { center: apex, normal: DVec3::Z, inner_radius: 0.0065, outer_radius: 0.0125 });
    let renderer = renderer(&scene);
    let mut worker = renderer.worker();
    worker.integrate_lights(Some(CubatureError(5e-4)));
    let varies = |worker: &mut RayWorker<'_>, x: f64| {
        let ray = ray_to(x, 0.0);
        worker.trace(1, &ray).value != worker.trace(7, &ray).value
    };
    for (x, is_near) in [(0.0, false), (0.006, false), (0.00649, true), (0.01257, true), (0.013, false), (0.03, false)]
    {
        assert_eq!(varies(&mut worker, x), is_near, "{x}");
        if !is_near {
            assert_agrees(&scene, (x, 0.0), 5e-4);
        }
    }
}

/// A column of eight facets: too many blockers for a list, so that bounds around them decide.
#[test]
fn lamps_are_integrated_past_a_part_of_many_facets() {
    let mut scene = Builder::default();
    let material = scene.sheeting(0.086, 0.00612);
    sheet(&mut scene, material);
    lamps(&mut scene, 0.0025);
    let alone = renderer(&scene);
    let black = scene.plastic([0.0; 3], 0.0, 0.0);
    let corner = |k: u32, height: f64| {
        let (sin, cos) = (f64::from(k) * TAU / 8.0).sin_cos();
        DVec3::new(0.01 + 0.002 * cos, 0.002 * sin, height)
    };
    for k in 0..8 {
        scene.polygon(black, &[corner(k, 0.0), corner(k + 1, 0.0), corner(k + 1, 0.01), corner(k, 0.01)]);
    }
    let renderer = renderer(&scene);
    for at in [(0.005, 0.0), (0.02, 0.002), (0.0, 0.02), (0.01, -0.006)] {
        let ray = ray_to(at.0, at.1);
        assert_eq!(integrated(&renderer, &ray, 5e-4), integrated(&alone, &ray, 5e-4), "{at:?}");
    }
    let mut shaded = 0;
    for k in 0..24 {
        let (sin, cos) = (f64::from(k) * TAU / 24.0).sin_cos();
        let ray = ray_to(0.01 + 0.0021 * cos, 0.0021 * sin);
        let ([mean, error, _], [truth, truth_error]) = (integrated_mean(&renderer, &ray), sampled(&renderer, &ray));
        let allowed = 4.5 * error.hypot(truth_error) + 1e-3 * truth;
        assert!((mean - truth).abs() <= allowed, "{k}: {mean} ± {error}, not {truth} ± {truth_error}");
        shaded += u32::from(mean < 0.9 * integrated(&alone, &ray, 5e-4));
    }
    assert!((3..21).contains(&shaded), "{shaded} of 24 points beside it are in the shadow of a lamp");
}

/// Whether every ray has the same bits with cubature as without.
fn is_sampled(scene: &Builder) -> bool {
    let renderer = renderer(scene);
    let (mut integrating, mut sampling) = (renderer.worker(), renderer.worker());
    integrating.integrate_lights(Some(CubatureError(1e-3)));
    (0..40).all(|k| {
        let ray = ray_to(0.001 * k as f64, 0.0005 * k as f64);
        integrating.trace(k, &ray).value == sampling.trace(k, &ray).value
    })
}

#[test]
fn lights_that_no_rule_suits_are_sampled() {
    let mut lit = Builder::default();
    let white = lit.plastic([0.8; 3], 0.0, 0.0);
    sheet(&mut lit, white);
    let mut plain = lit.clone();
    lamps(&mut plain, 0.0025);
    assert!(!is_sampled(&plain), "uniform disks are integrated");

    let mut hidden = plain.clone();
    let black = hidden.plastic([0.0; 3], 0.0, 0.0);
    for lamp in lamp_centers() {
        let center = lamp - 0.04 * DVec3::Z;
        hidden.sphere(black, Sphere { center, radius: 0.003, facing: Facing::Outward });
    }
    assert!(is_sampled(&hidden), "a ball below each lamp may hide it");

    let mut ring = lit.clone();
    let light = ring.light([1e3; 3]);
    let center = DVec3::new(0.0127, 0.0, HEIGHT);
    ring.ring(light, Ring { center, normal: -DVec3::Z, inner_radius: 0.001, outer_radius: 0.0025 });
    assert!(is_sampled(&ring), "a ring is no disk");

    for (outer_radius, is_near) in [(0.04, false), (0.06, true)] {
        let mut large = lit.clone();
        let light = large.light([1e3; 3]);
        large.ring(light, Ring { center, normal: -DVec3::Z, inner_radius: 0.0, outer_radius });
        assert_eq!(is_sampled(&large), is_near, "a disk of radius {outer_radius} m at {HEIGHT} m");
    }

    let mut narrow = Builder::default();
    let material = narrow.sheeting(0.086, 0.001);
    sheet(&mut narrow, material);
    lamps(&mut narrow, 0.0025);
    assert!(is_sampled(&narrow), "the lobe is narrower than a lamp");
}
