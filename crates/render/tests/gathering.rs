//! Cached or gathered irradiance, compared with closed forms and with independent rays.

mod build;

use build::{Builder, plan, square};
use glam::DVec3;
use radsight_ir::{Facing, Sphere};
use radsight_render::{Gathering, LightDivision, Quantity, Ray, RaySpacing, RenderOptions, Renderer, Traced, Uncached};
use std::f64::consts::PI;

/// An integrating sphere: a small light in the centre of a diffuse bubble.
fn integrating_sphere() -> Builder {
    let mut scene = Builder::default();
    let paint = scene.plastic([0.5; 3], 0.0, 0.0);
    let light = scene.light([100.0; 3]);
    scene.sphere(paint, Sphere { center: DVec3::ZERO, radius: 2.0, facing: Facing::Inward });
    scene.sphere(light, Sphere { center: DVec3::ZERO, radius: 0.1, facing: Facing::Outward });
    scene
}

/// A floor and two walls with a glow above: nonuniform irradiance.
fn corner() -> Builder {
    let mut scene = Builder::default();
    let white = scene.plastic([0.7; 3], 0.0, 0.0);
    let red = scene.plastic([0.6, 0.2, 0.1], 0.0, 0.0);
    let light = scene.light([30.0, 30.0, 20.0]);
    let polygon = |corners: [[f64; 3]; 4]| corners.map(DVec3::from_array);
    scene.polygon(white, &polygon([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]]));
    scene.polygon(red, &polygon([[0.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 2.0, 2.0], [0.0, 0.0, 2.0]]));
    scene.polygon(white, &polygon([[0.0, 2.0, 0.0], [2.0, 2.0, 0.0], [2.0, 2.0, 2.0], [0.0, 2.0, 2.0]]));
    scene.polygon(light, &polygon([[1.0, 1.0, 2.0], [1.0, 1.3, 2.0], [1.3, 1.3, 2.0], [1.3, 1.0, 2.0]]));
    scene
}

fn renderer(scene: &Builder, options: RenderOptions) -> Renderer {
    Renderer::new(plan(scene, options))
}

fn options(bounces: u32, accuracy: f64) -> RenderOptions {
    let gathering = Gathering { accuracy, divisions: 1024, ..Gathering::default() };
    RenderOptions { ambient_bounces: bounces, gathering, ..RenderOptions::default() }
}

/// Rays from one point down into the corner, distributed over it.
fn view(count: usize) -> Vec<Option<Ray>> {
    let eye = DVec3::new(1.9, 0.1, 1.8);
    (0..count)
        .map(|index| {
            let u = (index as f64 * 0.754_877_666).fract();
            let v = (index as f64 * 0.569_840_291).fract();
            let target =
                if index % 2 == 0 { DVec3::new(2.0 * u, 2.0 * v, 0.0) } else { DVec3::new(0.0, 2.0 * u, 2.0 * v) };
            Ray::new(eye, target - eye)
        })
        .collect()
}

#[test]
fn an_integrating_sphere_has_the_series_of_its_bounces() {
    let scene = integrating_sphere();
    // Irradiance from the light, and then ρ times as much from each bounce.
    let direct = PI * 100.0 * (0.1f64 / 2.0).powi(2);
    for bounces in 1..=3 {
        let mut renderer = renderer(&scene, options(bounces, 0.1));
        let rays: Vec<_> =
            (0..256).map(|i| Ray::new(DVec3::new(0.5, 0.0, 0.0), DVec3::new(1.0, 0.01 * f64::from(i), 0.3))).collect();
        let records = renderer.gather_irradiance(&rays, RaySpacing::UNKNOWN);
        assert!(records > 0 && records < 64, "{records} records");
        let expected: f64 = (0..=bounces).map(|k| 0.5f64.powi(k as i32)).sum::<f64>() * direct * 0.5 / PI;
        for traced in renderer.trace_all(0, &rays).into_iter().flatten() {
            assert!((traced.value[0] / expected - 1.0).abs() < 0.02, "{} against {expected}", traced.value[0]);
        }
    }
}

#[test]
fn shared_irradiance_agrees_with_rays_drawn_one_by_one() {
    let scene = corner();
    let rays = view(4096);
    let mut shared = renderer(&scene, options(2, 0.1));
    shared.gather_irradiance(&rays, RaySpacing::UNKNOWN);
    let drawn = renderer(&scene, options(2, 0.0));
    let mut difference = [0.0; 3];
    let mut whole = [0.0; 3];
    let few: Vec<_> = rays[..256].to_vec();
    let found = shared.trace_all(0, &few);
    for (ray, found) in few.iter().zip(found) {
        let again = vec![*ray; 512];
        let expected = drawn.trace_all(0, &again);
        for band in 0..3 {
            let mean = expected.iter().flatten().map(|traced| traced.value[band]).sum::<f64>() / 512.0;
            // Light sampling at the first point is noise of the single ray.
            difference[band] += found.expect("a ray").value[band] - mean;
            whole[band] += mean;
        }
    }
    for band in 0..3 {
        assert!((difference[band] / whole[band]).abs() < 0.02, "band {band}: {difference:?} of {whole:?}");
    }
}

#[test]
fn a_single_ray_looks_around_with_all_its_rays() {
    let scene = integrating_sphere();
    let gathering = Gathering { divisions: 512, uncached: Uncached::Split, ..Gathering::default() };
    let options = RenderOptions { quantity: Quantity::Irradiance, gathering, ..options(1, 0.0) };
    let renderer = renderer(&scene, options);
    let ray = Ray::new(DVec3::new(1.5, 0.0, 0.0), -DVec3::X);
    let traced = renderer.trace_all(0, &[ray])[0].expect("a ray");
    let direct = PI * 100.0 * (0.1f64 / 1.5).powi(2);
    // Everything except the light's disk is wall.
    let wall = PI * 100.0 * (0.1f64 / 2.0).powi(2) * 0.5 * (1.0 - (0.1f64 / 1.5).powi(2));
    assert!((traced.value[0] / (direct + wall) - 1.0).abs() < 0.01, "{} against {}", traced.value[0], direct + wall);
}

#[test]
fn what_is_small_and_bright_is_looked_for_where_it_was_found() {
    // A glowing sphere that fills less than a three-thousandth of the floor's view, under a dim
    // sky.
    let (radius, height, radiance, sky) = (0.05, 3.0, 100.0, 0.05);
    let mut scene = Builder::default();
    let white = scene.plastic([1.0; 3], 0.0, 0.0);
    let lamp = scene.glow([radiance; 3], 0.0);
    let dim = scene.glow([sky; 3], 0.0);
    let ball = |radius: f64, height: f64, facing| Sphere { center: DVec3::new(0.0, 0.0, height), radius, facing };
    scene.sphere(dim, ball(50.0, 0.0, Facing::Inward));
    scene.sphere(lamp, ball(radius, height, Facing::Outward));
    let floor = [[-2.0, -2.0], [2.0, -2.0], [2.0, 2.0], [-2.0, 2.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
    scene.polygon(white, &floor);
    let rays: Vec<_> = (0..2048)
        .map(|index| {
            let [x, y] = [0.754_877_666, 0.569_840_291].map(|step| 3.9 * (f64::from(index) * step).fract() - 1.95);
            Ray::new(DVec3::new(x, y, 1.0), -DVec3::Z)
        })
        .collect();
    let mut renderer = renderer(&scene, options(1, 0.1));
    renderer.gather_irradiance(&rays, RaySpacing::UNKNOWN);
    let error = |(ray, traced): (&Option<Ray>, Option<Traced>)| {
        let (ray, traced) = (ray.expect("a ray"), traced.expect("an answer"));
        let squared = ray.origin.truncate().length_squared() + height * height;
        let ball = radius * radius * (height / squared.sqrt()) / squared;
        let expected = (radiance - sky) * ball + sky;
        traced.value[0] / expected - 1.0
    };
    let errors: Vec<f64> = rays.iter().zip(renderer.trace_all(0, &rays)).map(error).collect();
    let count = errors.len() as f64;
    let mean = errors.iter().sum::<f64>() / count;
    let rms = (errors.iter().map(|error| error * error).sum::<f64>() / count).sqrt();
    // Unguided rays have an error of a quarter.
    assert!(mean.abs() < 0.06 && rms < 0.1, "{mean} in the mean, {rms} rms");
}

#[test]
fn gathering_does_not_depend_on_threads() {
    let scene = corner();
    let rays = view(512);
    let of = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| {
            let mut renderer = renderer(&scene, options(3, 0.2));
            let records = renderer.gather_irradiance(&rays, RaySpacing::UNKNOWN);
            let values: Vec<_> =
                renderer.trace_all(0, &rays).into_iter().flatten().map(|traced| traced.value).collect();
            (records, values)
        })
    };
    let one = of(1);
    assert!(one.0 > 10, "{} records", one.0);
    assert_eq!(one, of(3));
}

#[test]
fn caustics_are_as_fine_as_the_rays_that_see_them() {
    // A panel that is not sampled, and its image on the floor under a glass sphere.
    let mut scene = Builder::default();
    let white = scene.plastic([0.7; 3], 0.0, 0.0);
    let glass = scene.dielectric([1.0; 3], 1.5);
    let panel = scene.glow([20.0; 3], 0.0);
    scene.polygon(white, &square(4.0, 0.0));
    let mut panel_corners = square(0.5, 3.0);
    panel_corners.reverse();
    scene.polygon(panel, &panel_corners);
    scene.sphere(glass, Sphere { center: DVec3::new(0.0, 0.0, 0.7), radius: 0.4, facing: Facing::Outward });
    let eye = DVec3::new(2.5, 0.0, 0.8);
    let step = 0.02;
    let ray = |x: i32, y: i32| Ray::new(eye, DVec3::new(step * f64::from(x), step * f64::from(y), 0.0) - eye);
    let rays: Vec<_> = (-25..=25).flat_map(|x| (-25..=25).map(move |y| ray(x, y))).collect();
    let mut shared = renderer(&scene, options(1, 0.2));
    shared.gather_irradiance(&rays, RaySpacing { width: 0.0, angle: step / 2.5 });
    let drawn = renderer(&scene, options(1, 0.0));
    let (mut squares, mut whole) = (0.0, 0.0);
    for x in -15..=15 {
        let found = shared.trace_all(0, &[ray(x, 0)])[0].expect("a ray").value[0];
        let expected = drawn.trace_all(0, &vec![ray(x, 0); 4096]);
        let expected = expected.iter().flatten().map(|traced| traced.value[0]).sum::<f64>() / 4096.0;
        squares += (found - expected).powi(2);
        whole += expected * expected;
    }
    let error = (squares / whole).sqrt();
    assert!(error < 0.08, "{error}");
}

#[test]
fn a_surface_behind_a_panel_gets_nothing_from_records_on_the_panel() {
    let mut scene = corner();
    let grey = scene.plastic([0.3; 3], 0.0, 0.0);
    let corner = |x: f64, y: f64| DVec3::new(x, y, 0.005);
    scene.polygon(grey, &[corner(0.1, 0.1), corner(1.9, 0.1), corner(1.9, 1.9), corner(0.1, 1.9)]);
    let mut options = RenderOptions { quantity: Quantity::Irradiance, ..options(1, 0.2) };
    // Records below the panel reach farther than it is high.
    options.gathering.resolution = 8;
    let mut renderer = renderer(&scene, options);
    // In turns below the panel and above it.
    let sensor = |index: u32| {
        let at = 0.7 + 0.15 * f64::from(index / 2);
        Ray::new(DVec3::new(at, at, if index.is_multiple_of(2) { 0.0 } else { 0.01 }), DVec3::Z)
    };
    let rays: Vec<_> = (0..10).map(sensor).collect();
    renderer.gather_irradiance(&rays, RaySpacing::UNKNOWN);
    let values: Vec<f64> = renderer.trace_all(0, &rays).iter().flatten().map(|traced| traced.value[0]).collect();
    assert_eq!(values.len(), rays.len());
    for pair in values.chunks(2) {
        // Below there is only what comes through the gap at the rim.
        assert!(pair[0] < 5e-4 * pair[1], "{pair:?}");
    }
}

/// A highlight ray ends on a floor whose records are elsewhere, below a small bright patch.
#[test]
fn a_preview_averages_several_rays_where_a_highlight_ray_ends() {
    let mut scene = Builder::default();
    let paint = scene.plastic([0.5; 3], 0.0, 0.0);
    let patch = scene.glow([10.0; 3], 0.0);
    let metal = scene.metal([0.9; 3], 0.9, 0.1);
    scene.polygon(paint, &square(20.0, 0.0));
    scene.polygon(patch, &[[1.0, 1.0], [1.0, 2.0], [2.0, 2.0], [2.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 2.0)));
    scene.polygon(paint, &square(20.0, 8.0));
    scene.polygon(metal, &square(0.2, 3.0));
    let down_to = |point: DVec3| Ray::new(DVec3::new(0.0, 0.0, 6.0), point - DVec3::new(0.0, 0.0, 6.0));
    let spread = |light_division: LightDivision| {
        let options = RenderOptions { light_division, ..options(1, 0.01) };
        let mut renderer = renderer(&scene, options);
        assert_eq!(renderer.gather_irradiance(&[down_to(DVec3::new(15.0, 0.0, 0.0))], RaySpacing::UNKNOWN), 1);
        let up: Vec<_> = (0..4096).map(|_| Ray::new(DVec3::new(0.0, 0.0, 1.0), DVec3::Z)).collect();
        let traced = renderer.trace_all(0, &up);
        let values: Vec<f64> = traced.iter().flatten().map(|traced| traced.value[0]).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64;
        (mean, variance)
    };
    let ((one, of_one), (several, of_several)) = (spread(LightDivision::Whole), spread(LightDivision::BySize(1.0)));
    assert!((several / one - 1.0).abs() < 4.0 * (2.0 * of_one / 4096.0).sqrt() / one, "{several} against {one}");
    assert!(of_several < 0.4 * of_one, "{of_several} against {of_one}");
}
