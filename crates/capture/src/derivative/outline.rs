//! The pixels that see the outline of something that moves in the picture.

use super::ParameterStep;
use crate::neighbourhood::around;
use crate::{Progress, Workers};
use glam::DVec3;
use radsight_pinhole::CameraRay;
use radsight_render::Ray;
use radsight_sampling::{DimensionSet, RaySampler};
use rayon::prelude::*;

/// How a parameter moves the scene before the camera.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// Not at all: it changes light only.
    Still,
    /// The parameter moves the camera's rays: all outlines move in the picture.
    Camera,
    /// The parameter moves a part.
    Part(PartMotion),
}

/// The rigid motion of a part, per unit of the parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct PartMotion {
    /// Indices of its surfaces in the scene, sorted.
    pub surfaces: Vec<usize>,
    /// Velocity of the pivot, scene units.
    pub shift: DVec3,
    /// Axis of rotation, with the angular velocity in radians as length.
    pub turn: DVec3,
    /// A point of the axis, scene units.
    pub pivot: DVec3,
}

impl Motion {
    /// The velocity of a point of what moves, scene units.
    pub(super) fn velocity(&self, point: DVec3) -> DVec3 {
        match self {
            Motion::Part(part) => part.shift + part.turn.cross(point - part.pivot),
            Motion::Still | Motion::Camera => DVec3::ZERO,
        }
    }

    fn moves(&self, surface: usize) -> bool {
        match self {
            Motion::Part(part) => part.moves(surface),
            Motion::Still | Motion::Camera => true,
        }
    }
}

impl PartMotion {
    /// Whether the part has this surface.
    pub(super) fn moves(&self, surface: usize) -> bool {
        self.surfaces.binary_search(&surface).is_ok()
    }
}

/// Rays traced per pixel to find outlines. Those of the neighbouring pixels count as well.
const RAYS_PER_PIXEL: u32 = 8;

/// The surfaces that some rays of a pixel hit.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    /// The surface that the first ray hits.
    first: Option<u64>,
    /// Whether others see something else.
    is_mixed: bool,
    /// The nearest point of what moves, and its distance.
    nearest: Option<(f64, DVec3)>,
}

/// Key of a ray that hits nothing.
const NOTHING: u64 = u64::MAX;

impl Seen {
    fn add(&mut self, key: u64) {
        self.is_mixed |= self.first.is_some_and(|first| first != key);
        self.first = self.first.or(Some(key));
    }

    fn add_point(&mut self, distance: f64, point: DVec3) {
        if self.nearest.is_none_or(|(nearest, _)| distance < nearest) {
            self.nearest = Some((distance, point));
        }
    }

    fn union(mut self, other: &Seen) -> Seen {
        self.is_mixed |= other.is_mixed;
        other.first.into_iter().for_each(|key| self.add(key));
        other.nearest.into_iter().for_each(|(distance, point)| self.add_point(distance, point));
        self
    }
}

/// The rays of a grid of pixels.
pub(super) struct PixelRays<'a> {
    /// Columns and rows.
    pub(super) size: [usize; 2],
    /// Of a pixel, for a point of the unit cube.
    pub(super) ray: &'a (dyn Fn(u64, [f64; 4]) -> Option<CameraRay> + Sync),
}

/// What moves, as a pixel sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SeenPart {
    /// The point of it nearest to the camera that the pixel or its neighbours see.
    pub(super) point: DVec3,
    /// Whether they may see an outline, too.
    pub(super) has_outline: bool,
}

/// For each pixel what moves there, if anything does. `None` for all if the work was stopped.
pub(super) fn seen_parts(
    step: &ParameterStep<'_>,
    pixels: &PixelRays<'_>,
    progress: &dyn Progress,
) -> Vec<Option<SeenPart>> {
    let [columns, rows] = pixels.size;
    if *step.motion == Motion::Still {
        return vec![None; columns * rows];
    }
    let seen: Vec<Seen> = (0..columns * rows)
        .into_par_iter()
        .with_min_len(32)
        .map_init(
            || step.center.workers(),
            |workers, pixel| {
                if progress.stops() { Seen::default() } else { seen(step, workers, (pixels, pixel as u64)) }
            },
        )
        .collect();
    with_neighbours(&seen, columns)
}

fn seen(step: &ParameterStep<'_>, workers: &mut Workers<'_>, (pixels, pixel): (&PixelRays<'_>, u64)) -> Seen {
    let rays = step.center.rays;
    let mut seen = Seen::default();
    for sample in 0..RAYS_PER_PIXEL {
        let index = step.index(0, pixel % rays.camera().pixel_count(), sample);
        let ray = (pixels.ray)(pixel, RaySampler::new(rays.seed(), index).take(DimensionSet::CAMERA));
        let Some(ray) = ray.and_then(|ray| Ray::new(ray.origin, ray.direction)) else { continue };
        let traced = workers.main.trace(index, &ray);
        let Some(hit) = traced.first_hit else {
            seen.add(NOTHING);
            continue;
        };
        seen.add(traced.surface_key ^ ((hit.surface.index() as u64) << 32));
        if hit.distance.is_finite() && step.motion.moves(hit.surface.index()) {
            seen.add_point(hit.distance, hit.point);
        }
    }
    seen
}

fn with_neighbours(seen: &[Seen], columns: usize) -> Vec<Option<SeenPart>> {
    let size = [columns, seen.len() / columns.max(1)];
    let of_pixel = |pixel: usize| {
        let all = around(pixel, size).fold(Seen::default(), |all, near| all.union(&seen[near]));
        all.nearest.map(|(_, point)| SeenPart { point, has_outline: all.is_mixed })
    };
    (0..seen.len()).map(of_pixel).collect()
}
