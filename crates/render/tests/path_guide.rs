//! Guided paths have the mean of unguided ones and less noise, where a patch of sun lights a room.
//!
//! The room is a box of 4 × 4 × 3. The sun shines straight down through a hole in the ceiling onto
//! the floor, so all other surfaces are lit by that patch. With black walls the truth is a
//! quadrature of `E = ∫ L cos θ cos θ'/r² dA`.

mod build;

use build::{Builder, plan};
use glam::DVec3;
use radsight_ir::{Facing, Sphere};
use radsight_render::{Quantity, Ray, RaySpacing, RenderOptions, Renderer};
use std::f64::consts::PI;

const SIZE: DVec3 = DVec3::new(4.0, 4.0, 3.0);
const FLOOR: f64 = 0.5;
const HOLE: [DVec3; 2] = [DVec3::new(1.0, 1.2, 0.0), DVec3::new(1.3, 1.4, 0.0)];

/// Radiance of a sun of 0.1°, which determines that of the patch.
const SUN: f64 = 1e6;
const SUN_ANGLE: f64 = 0.1 * PI / 180.0;

fn patch_radiance() -> f64 {
    FLOOR * SUN * (0.5 * SUN_ANGLE).sin().powi(2)
}

/// The room with walls and ceiling of a reflectance, and optionally a mirror over the wall at x =
/// 0.
fn room(walls: f64, mirror: Option<f64>) -> Builder {
    let mut scene = Builder::default();
    let floor = scene.plastic([FLOOR; 3], 0.0, 0.0);
    let wall = scene.plastic([walls; 3], 0.0, 0.0);
    let sun = scene.light([SUN; 3]);
    scene.source(sun, DVec3::Z, SUN_ANGLE);
    let DVec3 { x, y, z } = SIZE;
    let at = DVec3::new;
    let level = |[left, front]: [f64; 2], [right, back]: [f64; 2], z: f64| {
        [at(left, front, z), at(right, front, z), at(right, back, z), at(left, back, z)]
    };
    scene.polygon(floor, &level([0.0; 2], [x, y], 0.0));
    let [low, high] = HOLE;
    for (from, to) in [
        ([0.0, 0.0], [low.x, y]),
        ([high.x, 0.0], [x, y]),
        ([low.x, 0.0], [high.x, low.y]),
        ([low.x, high.y], [high.x, y]),
    ] {
        let mut strip = level(from, to, z);
        strip.reverse();
        scene.polygon(wall, &strip);
    }
    scene.polygon(wall, &[at(0.0, 0.0, 0.0), at(0.0, 0.0, z), at(x, 0.0, z), at(x, 0.0, 0.0)]);
    scene.polygon(wall, &[at(0.0, y, 0.0), at(x, y, 0.0), at(x, y, z), at(0.0, y, z)]);
    scene.polygon(wall, &[at(x, 0.0, 0.0), at(x, 0.0, z), at(x, y, z), at(x, y, 0.0)]);
    let left = mirror.map_or(wall, |reflectance| scene.mirror([reflectance; 3]));
    scene.polygon(left, &[at(0.0, 0.0, 0.0), at(0.0, y, 0.0), at(0.0, y, z), at(0.0, 0.0, z)]);
    scene
}

/// The patch itself, or its mirror image.
#[derive(Clone, Copy, PartialEq, Eq)]
enum PatchSource {
    Direct,
    Image,
}

/// Irradiance from the patch, or from its mirror image.
fn from_patch(point: DVec3, normal: DVec3, source: PatchSource) -> f64 {
    let [low, high] = HOLE;
    let cells = 64;
    let step = (high - low) / f64::from(cells);
    let mut sum = 0.0;
    for cell in 0..cells * cells {
        let mut place = low + step * DVec3::new(f64::from(cell % cells) + 0.5, f64::from(cell / cells) + 0.5, 0.0);
        if source == PatchSource::Image {
            place.x = -place.x;
        }
        let way = place - point;
        let squared = way.length_squared();
        sum += normal.dot(way).max(0.0) * point.z / (squared * squared);
    }
    sum * step.x * step.y * patch_radiance()
}

fn options(bounces: u32, seed: u64) -> RenderOptions {
    RenderOptions { quantity: Quantity::Irradiance, ambient_bounces: bounces, seed, ..RenderOptions::default() }
}

/// Points on the ceiling and the walls, with their normals.
fn sensors() -> Vec<Ray> {
    let mut sensors = Vec::new();
    for step in 0..24 {
        let [u, v] = [0.754_877_666, 0.569_840_291].map(|step_size| 0.1 + 0.8 * (f64::from(step) * step_size).fract());
        let (x, y, z) = (SIZE.x * u, SIZE.y * v, SIZE.z * v);
        let (origin, normal) = match step % 3 {
            0 => (DVec3::new(0.5 * SIZE.x + 0.5 * x, y, SIZE.z - 1e-3), -DVec3::Z),
            1 => (DVec3::new(SIZE.x - 1e-3, SIZE.y * u, z), -DVec3::X),
            _ => (DVec3::new(x, SIZE.y - 1e-3, z), -DVec3::Y),
        };
        sensors.extend(Ray::new(origin, normal));
    }
    sensors
}

const RAYS: usize = 2048;

/// Mean of each sensor, and its standard error.
fn measured(scene: &Builder, options: RenderOptions, guided: Guided) -> Vec<(f64, f64)> {
    let mut renderer = Renderer::new(plan(scene, options));
    let sensors = sensors();
    if let Guided::Yes = guided {
        let rays: Vec<Option<Ray>> = sensors.iter().cycle().take(1024).copied().map(Some).collect();
        assert!(renderer.guide_paths(&rays, RaySpacing::UNKNOWN) > 0, "the patch is found");
    }
    let of_one = |(index, sensor): (usize, &Ray)| {
        let traced = renderer.trace_all((index * RAYS) as u64, &vec![Some(*sensor); RAYS]);
        // Neighbours in the sequence are dependent; groups of them are not.
        let group = |rays: &[Option<radsight_render::Traced>]| {
            rays.iter().map(|traced| traced.expect("an answer").value[0]).sum::<f64>() / rays.len() as f64
        };
        let groups: Vec<f64> = traced.chunks(64).map(group).collect();
        let count = groups.len() as f64;
        let mean = groups.iter().sum::<f64>() / count;
        let spread = groups.iter().map(|group| (group - mean).powi(2)).sum::<f64>() / (count - 1.0);
        (mean, (spread / count).sqrt())
    };
    sensors.iter().enumerate().map(of_one).collect()
}

#[derive(Clone, Copy)]
enum Guided {
    Yes,
    No,
}

/// The deviation of all sensors together from the truth, in standard errors, and the mean relative
/// variance.
fn compared(found: &[(f64, f64)], truth: impl Fn(usize) -> (f64, f64)) -> (f64, f64) {
    let (mut excess, mut variance, mut relative) = (0.0, 0.0, 0.0);
    for (index, (mean, error)) in found.iter().enumerate() {
        let (truth, uncertainty) = truth(index);
        excess += mean - truth;
        variance += error * error + uncertainty * uncertainty;
        relative += (error / truth).powi(2) / found.len() as f64;
    }
    (excess / variance.sqrt(), relative)
}

#[test]
fn a_patch_of_sun_is_found_and_counted_once() {
    let scene = room(0.0, None);
    let sensors = sensors();
    let truth = |index: usize| (from_patch(sensors[index].origin, sensors[index].direction, PatchSource::Direct), 0.0);
    let (plain, noise) = compared(&measured(&scene, options(1, 1), Guided::No), truth);
    let (guided, less) = compared(&measured(&scene, options(1, 1), Guided::Yes), truth);
    assert!(plain.abs() < 3.0 && guided.abs() < 3.0, "{plain} and {guided} standard errors off");
    assert!(less < 0.05 * noise, "{less} of the variance {noise}");
}

#[test]
fn a_patch_is_found_in_a_mirror() {
    let scene = room(0.0, Some(0.8));
    let sensors = sensors();
    let truth = |index: usize| {
        let Ray { origin, direction } = sensors[index];
        (
            from_patch(origin, direction, PatchSource::Direct)
                + 0.8 * from_patch(origin, direction, PatchSource::Image),
            0.0,
        )
    };
    let (plain, noise) = compared(&measured(&scene, options(1, 2), Guided::No), truth);
    let (guided, less) = compared(&measured(&scene, options(1, 2), Guided::Yes), truth);
    assert!(plain.abs() < 3.0 && guided.abs() < 3.0, "{plain} and {guided} standard errors off");
    assert!(less < 0.1 * noise, "{less} of the variance {noise}");
}

#[test]
fn paths_of_several_bounces_have_the_mean_of_plain_ones() {
    let scene = room(0.6, None);
    for seed in 3..6 {
        let plain = measured(&scene, options(3, seed), Guided::No);
        let found = measured(&scene, options(3, seed), Guided::Yes);
        let (excess, _) = compared(&found, |index| plain[index]);
        let squares = |sensors: &[(f64, f64)]| sensors.iter().map(|(_, error)| error * error).sum::<f64>();
        let [less, noise] = [squares(&found), squares(&plain)];
        assert!(excess.abs() < 3.0, "{excess} standard errors off");
        assert!(less < 0.5 * noise, "{less} of the variance {noise}");
    }
}

#[test]
fn where_nothing_is_uneven_paths_stay_as_they_are() {
    let mut scene = Builder::default();
    let paint = scene.plastic([0.5; 3], 0.0, 0.0);
    let light = scene.light([100.0; 3]);
    scene.sphere(paint, Sphere { center: DVec3::ZERO, radius: 2.0, facing: Facing::Inward });
    scene.sphere(light, Sphere { center: DVec3::ZERO, radius: 0.1, facing: Facing::Outward });
    let rays: Vec<Option<Ray>> =
        (0..256).map(|i| Ray::new(DVec3::new(0.5, 0.0, 0.0), DVec3::new(1.0, 0.01 * f64::from(i), 0.3))).collect();
    let options = RenderOptions { ambient_bounces: 2, ..RenderOptions::default() };
    let mut renderer = Renderer::new(plan(&scene, options));
    let values = |renderer: &Renderer| -> Vec<[f64; 3]> {
        renderer.trace_all(0, &rays).into_iter().flatten().map(|traced| traced.value).collect()
    };
    let before = values(&renderer);
    assert_eq!(renderer.guide_paths(&rays, RaySpacing::UNKNOWN), 0);
    assert_eq!(values(&renderer), before);
}

#[test]
fn what_is_learned_does_not_depend_on_threads() {
    let scene = room(0.6, None);
    let of = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| {
            let mut renderer = Renderer::new(plan(&scene, options(2, 7)));
            let rays: Vec<Option<Ray>> = sensors().into_iter().cycle().take(1024).map(Some).collect();
            let found = renderer.guide_paths(&rays, RaySpacing::UNKNOWN);
            (found, renderer.trace_all(0, &rays).into_iter().flatten().map(|traced| traced.value).collect::<Vec<_>>())
        })
    };
    let one = of(1);
    assert!(one.0 > 0);
    assert_eq!(one, of(3));
}
