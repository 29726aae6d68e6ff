//! Cached irradiance has the mean of the integral, where small bright patches and windows light a
//! room.
//!
//! The room is a box of 6 × 4 × 3 with walls of reflectance 0.5. All of its light comes from a glow
//! on the floor and, in some cases, from a uniform sky through a hole in a wall. No light is
//! sampled directly, so all of it passes through the cache. The truth is a quadrature of `E = ∫ L
//! cos θ cos θ'/r² dA` over patch, hole and walls.

mod build;

use build::{Builder, plan};
use glam::DVec3;
use radsight_render::{Gathering, Quantity, Ray, RaySpacing, RenderOptions, Renderer};
use std::f64::consts::PI;

const SIZE: DVec3 = DVec3::new(6.0, 4.0, 3.0);
const REFLECTANCE: f64 = 0.5;
const SKY: f64 = 3.0;
const SEEDS: u64 = 8;

/// Of a sensor's irradiance in one run.
const MOST_DEVIATION: f64 = 0.005;

/// A rectangle with a corner, two edges and the unit normal `x × y`.
#[derive(Clone, Copy)]
struct Rectangle {
    corner: DVec3,
    x: DVec3,
    y: DVec3,
}

impl Rectangle {
    fn new(corner: [f64; 3], x: [f64; 3], y: [f64; 3]) -> Rectangle {
        Rectangle { corner: DVec3::from_array(corner), x: DVec3::from_array(x), y: DVec3::from_array(y) }
    }

    fn normal(&self) -> DVec3 {
        self.x.cross(self.y).normalize()
    }

    fn corners(&self) -> [DVec3; 4] {
        [self.corner, self.corner + self.x, self.corner + self.x + self.y, self.corner + self.y]
    }

    /// The centres of `columns × rows` cells, and the area of each.
    fn cells(self, columns: u32, rows: u32) -> impl Iterator<Item = (DVec3, f64)> {
        let area = self.x.cross(self.y).length() / f64::from(columns * rows);
        (0..columns * rows).map(move |cell| {
            let (u, v) = ((f64::from(cell % columns) + 0.5) / f64::from(columns), f64::from(cell / columns) + 0.5);
            (self.corner + self.x * u + self.y * (v / f64::from(rows)), area)
        })
    }
}

/// The irradiance of a point with a unit normal per radiance of a small area.
fn geometry(point: DVec3, normal: DVec3, (other, area): (DVec3, f64), other_normal: DVec3) -> f64 {
    let way = other - point;
    let squared = way.length_squared();
    (normal.dot(way).max(0.0) * (-other_normal.dot(way)).max(0.0)) * area / (squared * squared).max(1e-12)
}

/// The walls, with inward normals.
fn walls() -> [Rectangle; 6] {
    let DVec3 { x, y, z } = SIZE;
    [
        Rectangle::new([0.0; 3], [x, 0.0, 0.0], [0.0, y, 0.0]),
        Rectangle::new([0.0, 0.0, z], [0.0, y, 0.0], [x, 0.0, 0.0]),
        Rectangle::new([0.0; 3], [0.0, y, 0.0], [0.0, 0.0, z]),
        Rectangle::new([x, 0.0, 0.0], [0.0, 0.0, z], [0.0, y, 0.0]),
        Rectangle::new([0.0, y, 0.0], [x, 0.0, 0.0], [0.0, 0.0, z]),
        Rectangle::new([0.0; 3], [0.0, 0.0, z], [x, 0.0, 0.0]),
    ]
}

struct Room {
    patch: Rectangle,
    radiance: f64,
    hole: Option<Rectangle>,
}

impl Room {
    fn new(side: f64, hole: Option<Rectangle>) -> Room {
        let patch = Rectangle::new([1.0, 1.0, 0.01], [1.5 * side, 0.0, 0.0], [0.0, side, 0.0]);
        Room { patch, radiance: 9.6 / (1.5 * side * side), hole }
    }

    fn scene(&self) -> Builder {
        let mut scene = Builder::default();
        let paint = scene.plastic([REFLECTANCE; 3], 0.0, 0.0);
        let glow = scene.glow([self.radiance; 3], 0.0);
        scene.polygon(glow, &self.patch.corners());
        let [rest @ .., front] = walls();
        rest.iter().for_each(|wall| scene.polygon(paint, &wall.corners()));
        let Some(hole) = self.hole else {
            scene.polygon(paint, &front.corners());
            return scene;
        };
        let sky = scene.glow([SKY; 3], 0.0);
        scene.source(sky, DVec3::Z, 2.0 * PI);
        let (low, high) = (hole.corner, hole.corner + hole.x + hole.y);
        let mut piece = |from: [f64; 2], to: [f64; 2]| {
            let [[x, z], [right, top]] = [from, to];
            let corners = [[x, 0.0, z], [x, 0.0, top], [right, 0.0, top], [right, 0.0, z]];
            scene.polygon(paint, &corners.map(DVec3::from_array));
        };
        piece([0.0, 0.0], [low.x, SIZE.z]);
        piece([high.x, 0.0], [SIZE.x, SIZE.z]);
        piece([low.x, 0.0], [high.x, low.z]);
        piece([low.x, high.z], [high.x, SIZE.z]);
        scene
    }

    /// Direct irradiance from patch and hole.
    fn first(&self, point: DVec3, normal: DVec3) -> f64 {
        let from = |emitter: &Rectangle, radiance: f64, cells: u32| {
            let facing = emitter.normal();
            let sum: f64 = emitter.cells(cells, cells).map(|cell| geometry(point, normal, cell, facing)).sum();
            radiance * sum
        };
        from(&self.patch, self.radiance, 6) + self.hole.map_or(0.0, |hole| from(&hole, SKY, 16))
    }

    /// Whether a point of a wall is in the hole or on the patch.
    fn is_bare(&self, point: DVec3) -> bool {
        let within = |emitter: &Rectangle| {
            let offset = point - emitter.corner;
            let share = |edge: DVec3| offset.dot(edge) / edge.length_squared();
            let is_inside = |share: f64| (0.0..=1.0).contains(&share);
            is_inside(share(emitter.x)) && is_inside(share(emitter.y)) && offset.dot(emitter.normal()).abs() < 0.02
        };
        within(&self.patch) || self.hole.as_ref().is_some_and(within)
    }

    /// Cells of the walls: their centres, areas and normals, and their radiance after one
    /// reflection.
    fn reflecting(&self) -> Vec<((DVec3, f64), DVec3, f64)> {
        let cells = |wall: Rectangle| {
            let [columns, rows] = [wall.x, wall.y].map(|edge| (edge.length() * 12.0) as u32);
            let normal = wall.normal();
            wall.cells(columns, rows).map(move |cell| (cell, normal))
        };
        let lit = |((point, area), normal): ((DVec3, f64), DVec3)| {
            let radiance = if self.is_bare(point) { 0.0 } else { self.first(point, normal) * REFLECTANCE / PI };
            ((point, area), normal, radiance)
        };
        walls().into_iter().flat_map(cells).map(lit).collect()
    }
}

/// Points of the ceiling and of the far wall, away from their edges, with their normals.
fn points(count: u32) -> Vec<(DVec3, DVec3)> {
    (0..count)
        .map(|index| {
            let [u, v] = [0.754_877_666, 0.569_840_291].map(|step| 0.1 + 0.8 * (f64::from(index) * step).fract());
            if index % 2 == 0 {
                (DVec3::new(SIZE.x * u, SIZE.y * v, SIZE.z), -DVec3::Z)
            } else {
                (DVec3::new(SIZE.x, SIZE.y * u, SIZE.z * v), -DVec3::X)
            }
        })
        .collect()
}

#[test]
fn the_mean_is_right_for_patches_of_all_sizes_with_and_without_windows() {
    let window = Rectangle::new([1.5, 0.0, 0.9], [0.0, 0.0, 1.3], [2.5, 0.0, 0.0]);
    let points = points(240);
    for side in [0.05, 0.2, 0.5, 1.4] {
        for hole in [None, Some(window)] {
            let room = Room::new(side, hole);
            let (scene, reflecting) = (room.scene(), room.reflecting());
            let expected = |(point, normal): &(DVec3, DVec3), bounces: u32| {
                let second = |(cell, facing, radiance): &((DVec3, f64), DVec3, f64)| {
                    radiance * geometry(*point, *normal, *cell, *facing)
                };
                let further = if bounces > 1 { reflecting.iter().map(second).sum() } else { 0.0 };
                (room.first(*point, *normal) + further) * REFLECTANCE / PI
            };
            for bounces in [1, 2] {
                let truth: Vec<f64> = points.iter().map(|point| expected(point, bounces)).collect();
                let whole: f64 = truth.iter().sum();
                let means: Vec<f64> = (1..=SEEDS).map(|seed| cached(&scene, &points, bounces, seed) / whole).collect();
                let mean = means.iter().sum::<f64>() / SEEDS as f64;
                let squares: f64 = means.iter().map(|value| (value - mean).powi(2)).sum();
                let error = (squares / (SEEDS * (SEEDS - 1)) as f64).sqrt();
                let case = format!("a patch of {side}, {bounces} bounces, hole: {}", hole.is_some());
                // The quadrature is accurate to a fifth of a per cent.
                assert!((mean - 1.0).abs() < 3.0 * error + 2e-3, "{case}: {mean} ± {error}");
                assert!(error < 0.02, "{case}: too noisy to tell, ± {error}");
            }
        }
    }
}

/// The sum of the cached radiances of the points.
fn cached(scene: &Builder, points: &[(DVec3, DVec3)], bounces: u32, seed: u64) -> f64 {
    let gathering = Gathering { accuracy: 0.25, divisions: 64, ..Gathering::default() };
    let options = RenderOptions { ambient_bounces: bounces, gathering, seed, ..RenderOptions::default() };
    let mut renderer = Renderer::new(plan(scene, options));
    let eye = 0.5 * SIZE;
    let rays: Vec<_> = points.iter().map(|(point, _)| Ray::new(eye, *point - eye)).collect();
    renderer.gather_irradiance(&rays, RaySpacing::UNKNOWN);
    renderer.trace_all(0, &rays).iter().flatten().map(|traced| traced.value[0]).sum()
}

/// The patch is below the sensors: its light reaches them through ceiling and walls.
#[test]
fn few_sensors_have_the_light_of_a_second_bounce_with_little_noise() {
    let room = Room::new(0.2, None);
    let (scene, reflecting) = (room.scene(), room.reflecting());
    let sensors: Vec<DVec3> = (0..9).map(|index| DVec3::new(2.0 + 0.4 * f64::from(index), 2.1, 0.8)).collect();
    let truth: Vec<f64> = sensors
        .iter()
        .map(|point| {
            let from = |(cell, facing, radiance): &((DVec3, f64), DVec3, f64)| {
                radiance * geometry(*point, DVec3::Z, *cell, *facing)
            };
            reflecting.iter().map(from).sum()
        })
        .collect();
    let rays: Vec<_> = sensors.iter().map(|point| Ray::new(*point, DVec3::Z)).collect();
    let (mut means, mut squares) = (Vec::new(), 0.0);
    for seed in 1..=SEEDS {
        let gathering = Gathering { accuracy: 0.1, divisions: 512, super_samples: 64, ..Gathering::default() };
        let quantity = Quantity::Irradiance;
        let options = RenderOptions { ambient_bounces: 2, gathering, seed, quantity, ..RenderOptions::default() };
        let mut renderer = Renderer::new(plan(&scene, options));
        renderer.gather_irradiance(&rays, RaySpacing::UNKNOWN);
        let traced = renderer.trace_all(0, &rays);
        let ratios: Vec<f64> =
            traced.iter().flatten().zip(&truth).map(|(traced, truth)| traced.value[0] / truth).collect();
        assert_eq!(ratios.len(), sensors.len());
        squares += ratios.iter().map(|ratio| (ratio - 1.0).powi(2)).sum::<f64>();
        means.push(ratios.iter().sum::<f64>() / 9.0);
    }
    let runs = SEEDS as f64;
    let mean = means.iter().sum::<f64>() / runs;
    let error = (means.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (runs * (runs - 1.0))).sqrt();
    let deviation = (squares / (9.0 * runs)).sqrt();
    assert!((mean - 1.0).abs() < 3.0 * error + 2e-3, "{mean} ± {error}");
    // Eight times the requested rays as paths of one ray per bounce would have a deviation of
    // 0.007.
    assert!(deviation < MOST_DEVIATION, "{deviation}");
}

#[test]
fn a_wall_in_the_plane_of_a_window_gets_nothing_from_it() {
    let hole = Rectangle::new([1.5, 0.0, 0.9], [0.0, 0.0, 1.3], [2.5, 0.0, 0.0]);
    let room = Room { radiance: 0.0, ..Room::new(0.2, Some(hole)) };
    let gathering = Gathering { accuracy: 0.2, divisions: 128, ..Gathering::default() };
    let options = RenderOptions { ambient_bounces: 1, gathering, ..RenderOptions::default() };
    let mut renderer = Renderer::new(plan(&room.scene(), options));
    let eye = 0.5 * SIZE;
    // Every other ray hits the floor, whose records see the sky.
    let target = |index: u32| {
        let [u, v] = [0.754_877_666, 0.569_840_291].map(|step| 0.01 + 0.98 * (f64::from(index) * step).fract());
        if index.is_multiple_of(2) {
            DVec3::new(1.4 * u, 0.0, SIZE.z * v)
        } else {
            DVec3::new(SIZE.x * u, SIZE.y * v, 0.0)
        }
    };
    let rays: Vec<_> = (0..800).map(|index| Ray::new(eye, target(index) - eye)).collect();
    renderer.gather_irradiance(&rays, RaySpacing::UNKNOWN);
    let values: Vec<f64> = renderer.trace_all(0, &rays).iter().flatten().map(|traced| traced.value[0]).collect();
    let (on_wall, on_floor): (Vec<_>, Vec<_>) = values.chunks(2).map(|pair| (pair[0], pair[1])).unzip();
    assert!(on_floor.iter().sum::<f64>() > 1.0, "the floor is lit");
    assert!(on_wall.iter().all(|value| *value == 0.0), "{:?}", on_wall.iter().copied().fold(0.0, f64::max));
}
