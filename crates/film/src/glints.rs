//! Glints: reflections of small lights in curved glossy surfaces.
//!
//! A glint may cover a hundredth of a pixel and be a thousand times brighter than what is around it. Few rays of a pixel
//! miss it, or meet it and give it the whole pixel. But where it lies is known: the *offset* between the direction in
//! which a surface reflects a ray and the direction to the light is 0 there, and nearly linear between neighbouring rays.
//! Pixels in which it may be 0 are divided into parts, and such parts again, until they are as small as the glint. The
//! mean of all parts is the pixel.
//!
//! Only directions decide what is divided, not the light that is found: a glint that is hidden counts as dark, and none
//! counts more than the area that it covers. The directions are those of ray differentials (Igehy 1999), found by
//! differences of adjacent rays.

use crate::grid::Pixel;
use crate::interpolated::{Block, PixelMean};
use crate::pixel_sample::{RayValue, Sample, Surface};
use crate::view_camera::ViewCamera;
use glam::{DMat2, DVec2, DVec3};
use radsight_render::{NearRecord, RayWorker};
use radsight_sampling::{DimensionSet, RaySampler};
use rayon::prelude::*;

/// A highlight is as wide as the light and this many times the roughness of the surface: most of its light is
/// within (Ward 1992, eq. 5, with the half vector's angle half of the reflected direction's).
const WIDTH_OF_ROUGHNESS: f64 = 3.0;

/// Wider highlights are no glints, radians.
const WIDEST: f64 = 0.2;

/// Number of parts along each side of a divided pixel or part, how often it is divided, and the number of rays after
/// which no part of a pixel is divided any more: a bumpy surface has more glints than can be found.
const SIDE: usize = 4;
const PARTS: usize = SIDE * SIDE;
const DIVISIONS: u32 = 5;
const MOST_RAYS: u32 = 1024;

/// A glint in a pixel lies at most so far from its ray along either axis, pixels: both may lie anywhere in the pixel, and
/// the rays beside it, which give the gradient of the offset, in theirs. In parts of pixels, the places of rays are known:
/// glints are looked for in the part and so far beside it, in parts.
const REACH: f64 = 1.25;
const MARGIN: f64 = 0.25;

/// The error of the linear offset, relative to its change over a pixel or part.
const CURVED: f64 = 0.3;
const CURVED_IN_PART: f64 = 0.1;

/// On a bumpy surface reflected directions change by chance. Cells are divided for a glint if the directions at their
/// corners differ from a plane by at most this fraction of their differences.
const MOST_TWIST: f64 = 0.7;

/// Likewise a pixel or part is searched if at most this fraction of the squared differences to those beside it is not
/// that of a plane, where there are so many. In parts the places of rays are known.
const MOST_UNEXPLAINED: f64 = 0.8;
const MOST_UNEXPLAINED_IN_PART: f64 = 0.3;
const MANY_NEIGHBOURS: u32 = 5;

/// A glint is out of reach if the offset is larger than this many times a bound of its differences.
const FAR: f64 = 5.0;

/// Steps of the search for the least offset.
const STEPS: u32 = 4;

/// Neighbours in a line, whose places have a smaller determinant, tell nothing about the other direction. What is added
/// to the moments of the places, so that they have an inverse.
const LEAST_DETERMINANT: f64 = 0.5;
const LEAST_MOMENT: f64 = 1e-3;

/// Number of rays that are cast for glints, relative to those that the picture has cast before, and in any picture; and
/// the number of pixels after which they are counted.
const SHARE_OF_RAYS: f64 = 0.0625;
const RAYS_OF_SMALL_PICTURE: f64 = (1 << 12) as f64;
const COUNTED_TOGETHER: usize = 4;

/// Ray numbers of a pixel, as a power of two, and their offset.
const NUMBERS_LOG2: u32 = 20;
const GLINTS: u64 = 1 << 63 | 1 << 61;

/// Where a ray is reflected, relative to a light.
#[derive(Clone, Copy, Debug)]
struct Offset {
    /// The reflected direction without that to the light.
    offset: DVec3,
    /// Angular radius of the light's highlight, radians.
    width: f64,
}

/// A surface beside another one: by how many columns and rows, in pixels or their parts.
type Neighbour<'s> = (DVec2, &'s Surface);

/// Differences of vectors at places around one, and the plane through them by least squares.
#[derive(Clone, Copy, Debug)]
struct PlaneFit {
    count: u32,
    /// Sums of squared differences, of products of the places, and of both; the largest squared difference.
    squares: f64,
    moments: DMat2,
    products: [DVec3; 2],
    most: f64,
}

impl PlaneFit {
    const EMPTY: PlaneFit =
        PlaneFit { count: 0, squares: 0.0, moments: DMat2::ZERO, products: [DVec3::ZERO; 2], most: 0.0 };

    fn add(&mut self, place: DVec2, change: DVec3) {
        let squared = change.length_squared();
        (self.count, self.squares, self.most) = (self.count + 1, self.squares + squared, self.most.max(squared));
        self.moments += DMat2::from_cols(place * place.x, place * place.y);
        self.products = [self.products[0] + change * place.x, self.products[1] + change * place.y];
    }

    /// The largest difference.
    fn step(&self) -> f64 {
        self.most.sqrt()
    }

    /// Whether the places lie in a line, or there is none.
    fn is_line(&self) -> bool {
        self.moments.determinant() < LEAST_DETERMINANT
    }

    /// The change over a pixel or part along each axis.
    fn gradient(&self) -> [DVec3; 2] {
        let inverse = (self.moments + DMat2::from_diagonal(DVec2::splat(LEAST_MOMENT))).inverse();
        [0, 1].map(|axis| self.products[0] * inverse.col(axis).x + self.products[1] * inverse.col(axis).y)
    }

    /// Whether more than this fraction of many squared differences is not that of a plane.
    fn is_bumpy(&self, unexplained: f64) -> bool {
        let gradient = self.gradient();
        let explained = gradient[0].dot(self.products[0]) + gradient[1].dot(self.products[1]);
        self.count >= MANY_NEIGHBOURS && self.squares - explained > unexplained * self.squares
    }
}

/// A pixel that may show glints of some lights.
struct Glinting<'s> {
    index: usize,
    pixel: Pixel,
    sample: &'s Sample,
    lights: Vec<usize>,
    /// About how far the nearest glint is from its ray, pixels.
    distance: f64,
}

/// A square part of a pixel's unit square.
#[derive(Clone, Copy, Debug)]
struct Part {
    corner: [f64; 2],
    side: f64,
}

impl Part {
    const WHOLE: Part = Part { corner: [0.0; 2], side: 1.0 };

    /// A part of it by its number.
    fn part(&self, number: usize) -> Part {
        let side = self.side / SIDE as f64;
        let corner = [number % SIDE, number / SIDE];
        Part { corner: [0, 1].map(|axis| self.corner[axis] + corner[axis] as f64 * side), side }
    }

    /// A point of it, for one of the unit square.
    fn point(&self, u: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| self.corner[axis] + self.side * u[axis])
    }
}

/// The numbers of the parts beside one.
fn beside(number: usize) -> impl Iterator<Item = usize> {
    let [column, row] = [number % SIDE, number / SIDE];
    let range = |at: usize| at.saturating_sub(1)..(at + 2).min(SIDE);
    range(row).flat_map(move |row| range(column).map(move |column| row * SIDE + column)).filter(move |at| *at != number)
}

/// Where a glint is looked for, in pixels or their parts, relative to a ray.
#[derive(Clone, Copy, Debug)]
struct Region {
    low: [f64; 2],
    high: [f64; 2],
    /// The error of the linear offset, relative to its change over a pixel or part.
    curved: f64,
    /// The fraction of squared differences that may be other than those of a plane.
    unexplained: f64,
}

impl Region {
    /// Around a ray anywhere in its pixel.
    const OF_PIXEL: Region =
        Region { low: [-REACH; 2], high: [REACH; 2], curved: CURVED, unexplained: MOST_UNEXPLAINED };

    /// A part with a ray at this point of its unit square.
    fn of_part(at: [f64; 2]) -> Region {
        let [low, high] = [-MARGIN, 1.0 + MARGIN].map(|end| at.map(|own| end - own));
        Region { low, high, curved: CURVED_IN_PART, unexplained: MOST_UNEXPLAINED_IN_PART }
    }
}

/// From a place to another one, in columns and rows.
fn between(from: Pixel, to: Pixel) -> DVec2 {
    DVec2::new(to.0 as f64 - from.0 as f64, to.1 as f64 - from.1 as f64)
}

/// Whether directions at the corners of a cell, row by row, are far from a plane.
fn is_twisted([first, second, third, fourth]: [DVec3; 4]) -> bool {
    let step = [second, third, fourth].map(|other| other.distance(first)).into_iter().fold(0.0, f64::max);
    (first - second - third + fourth).length() > MOST_TWIST * step
}

/// The place of a region with the least offset, and that offset, if it is linear.
fn least_offset(offset: DVec3, gradient: [DVec3; 2], region: &Region) -> (DVec2, f64) {
    let mut at = [0, 1].map(|axis| 0.0_f64.clamp(region.low[axis], region.high[axis]));
    for _ in 0..STEPS {
        for axis in [0, 1] {
            let rest = offset + gradient[1 - axis] * at[1 - axis];
            let length = gradient[axis].length_squared();
            let least = if length > 0.0 { -rest.dot(gradient[axis]) / length } else { 0.0 };
            at[axis] = least.clamp(region.low[axis], region.high[axis]);
        }
    }
    (at.into(), (offset + gradient[0] * at[0] + gradient[1] * at[1]).length())
}

impl Block<'_> {
    /// Whether a glint of any light may lie between samples at the corners of a cell.
    pub(crate) fn may_show_glint(&self, corners: &[&Sample; 4]) -> bool {
        if self.glint_lights.0.is_empty() || is_twisted(corners.map(|corner| corner.surface.reflected())) {
            return false;
        }
        let place = |index: usize| (index % 2, index / 2);
        (0..corners.len()).any(|index| {
            let own = &corners[index].surface;
            let near = || {
                let others = corners.iter().enumerate().filter(move |(other, _)| *other != index);
                others.map(move |(other, corner)| (between(place(index), place(other)), &corner.surface))
            };
            !self.glints((own, &Region::OF_PIXEL), &self.glint_lights.0, near).is_empty()
        })
    }

    /// Replaces the means of pixels that may show glints.
    pub(crate) fn resolve_glints(&self, means: &mut [PixelMean]) {
        let mut pixels = self.glinting_pixels();
        pixels.sort_by(|one, other| one.distance.total_cmp(&other.distance));
        let mut left = f64::max(RAYS_OF_SMALL_PICTURE * self.fraction(), SHARE_OF_RAYS * self.casts as f64);
        let renderer = self.renderer;
        for pixels in pixels.chunks(COUNTED_TOGETHER) {
            if left <= 0.0 {
                break;
            }
            let resolved = |worker: &mut RayWorker<'_>, pixel: &Glinting<'_>| {
                let before = worker.rays_cast();
                (self.divided_mean(worker, pixel), worker.rays_cast() - before)
            };
            let resolved: Vec<(PixelMean, u64)> = pixels.par_iter().map_init(|| renderer.worker(), resolved).collect();
            for (pixel, (mean, casts)) in pixels.iter().zip(resolved) {
                means[pixel.index] = mean;
                left -= casts as f64;
            }
        }
    }

    fn glinting_pixels(&self) -> Vec<Glinting<'_>> {
        if self.glint_lights.0.is_empty() {
            return Vec::new();
        }
        let glinting = |index: usize| {
            let (at, sample) = self.samples.numbered(index);
            let pixel = self.pixel(at);
            if !sample.surface.is_hit() || self.lights.are_in(self.camera, pixel.0, pixel.1 + self.first_row) {
                return None;
            }
            // Bodies of few pixels do not continue from one to the next, and smooth ones may have parts with a modifier for
            // each.
            let is_near = |near: &Sample| {
                let (own, near) = (&sample.surface, &near.surface);
                own.material() == near.material() || near.is_hit() && own.is_smooth_beside(near)
            };
            let beside = |other: usize| between(pixel, self.pixel(self.samples.numbered(other).0));
            let near = || self.around(pixel).filter(|(other, near)| *other != index && is_near(near));
            let near = || near().map(|(other, near)| (beside(other), &near.surface));
            let found = self.glints((&sample.surface, &Region::OF_PIXEL), &self.glint_lights.0, near);
            let distance = found.iter().map(|(_, distance)| *distance).reduce(f64::min)?;
            let lights = found.into_iter().map(|(light, _)| light).collect();
            Some(Glinting { index, pixel, sample, lights, distance })
        };
        (0..self.samples.count()).into_par_iter().with_min_len(256).filter_map(glinting).collect()
    }

    /// The lights whose glints may lie in a region around a ray, and about how far from it they are, pixels or parts.
    fn glints<'s, Near: Iterator<Item = Neighbour<'s>>>(
        &self,
        (own, region): (&Surface, &Region),
        lights: &[usize],
        near: impl Fn() -> Near,
    ) -> Vec<(usize, f64)> {
        let plan = self.renderer.plan();
        let Some(roughness) = own.material().and_then(|material| plan.mirror_roughness(material)) else {
            return Vec::new();
        };
        let least_width = WIDTH_OF_ROUGHNESS * roughness;
        if least_width > WIDEST {
            return Vec::new();
        }
        let (mut reflected, mut apart) = (PlaneFit::EMPTY, 0.0);
        for (place, surface) in near() {
            reflected.add(place, surface.reflected() - own.reflected());
            apart = f64::max(apart, surface.point().distance(own.point()));
        }
        if reflected.is_bumpy(region.unexplained) {
            return Vec::new();
        }
        let mut found = Vec::new();
        for light in lights {
            // Most are far from any glint, which needs no look at those beside: a bound of the differences of offsets.
            let distance = plan.lights[*light].center_distance(own.point());
            let turn = if distance > apart { apart / (distance - apart) } else { f64::INFINITY };
            let most = reflected.step() + turn;
            if most <= least_width {
                continue;
            }
            let may_lie_near = |Offset { offset, width }: &Offset| {
                *width <= WIDEST && most > *width && offset.length() <= width + FAR * most
            };
            let Some(offset) = self.offset(*light, own).filter(may_lie_near) else { continue };
            found.extend(self.distance_of_glint((*light, offset), region, near()).map(|distance| (*light, distance)));
        }
        found
    }

    /// About how far a glint of a light is from a ray, pixels; `None` if it is out of reach, or wider than the distance
    /// of the rays beside it, which see the same body.
    fn distance_of_glint<'s>(
        &self,
        (light, Offset { offset, width }): (usize, Offset),
        region: &Region,
        near: impl Iterator<Item = Neighbour<'s>>,
    ) -> Option<f64> {
        let mut plane = PlaneFit::EMPTY;
        for (place, surface) in near {
            if let Some(there) = self.offset(light, surface) {
                plane.add(place, there.offset - offset);
            }
        }
        if plane.step() <= width {
            return None;
        }
        let gradient = plane.gradient();
        let (at, least) = least_offset(offset, gradient, region);
        let unknown = if plane.is_line() { REACH * plane.step() } else { 0.0 };
        let allowed = width + region.curved * (gradient[0].length() + gradient[1].length()) + unknown;
        (least <= allowed).then_some(at.length())
    }

    fn offset(&self, light: usize, surface: &Surface) -> Option<Offset> {
        let plan = self.renderer.plan();
        let roughness = plan.mirror_roughness(surface.material()?)?;
        let (direction, radius) = plan.lights[light].angular_extent(surface.point())?;
        Some(Offset { offset: surface.reflected() - direction, width: radius + WIDTH_OF_ROUGHNESS * roughness })
    }

    fn divided_mean(&self, worker: &mut RayWorker<'_>, pixel: &Glinting<'_>) -> PixelMean {
        let mut rays = PartRays {
            block: self,
            camera: self.camera.whole_pixels(),
            pixel: (pixel.pixel.0, pixel.pixel.1 + self.first_row),
            near: self.has_records().then(Vec::new),
            count: 0,
        };
        let mean = rays.mean(worker, Part::WHOLE, &pixel.lights, DIVISIONS);
        PixelMean { mean, rays: pixel.sample.rays + rays.count }
    }
}

/// Rays through the parts of a pixel.
struct PartRays<'b> {
    block: &'b Block<'b>,
    camera: ViewCamera,
    pixel: Pixel,
    /// As for single rays of the block.
    near: Option<Vec<NearRecord>>,
    /// Number of rays so far.
    count: u32,
}

impl PartRays<'_> {
    /// The mean of a part, which is divided at most so many times.
    fn mean(&mut self, worker: &mut RayWorker<'_>, part: Part, lights: &[usize], divisions: u32) -> [f64; 3] {
        let rays: [([f64; 2], RayValue); PARTS] = std::array::from_fn(|number| self.ray(worker, part.part(number)));
        let place =
            |number: usize| DVec2::new((number % SIDE) as f64, (number / SIDE) as f64) + DVec2::from(rays[number].0);
        let mut sum = [0.0; 3];
        for (number, (at, ray)) in rays.iter().enumerate() {
            let own = (&ray.surface, &Region::of_part(*at));
            let near = || beside(number).map(|other| (place(other) - place(number), &rays[other].1.surface));
            let near = || near().filter(|(_, near)| near.is_hit() && ray.surface.is_smooth_beside(near));
            let is_divided = divisions > 1 && self.count < MOST_RAYS;
            let found = if is_divided { self.block.glints(own, lights, near) } else { Vec::new() };
            let found: Vec<usize> = found.into_iter().map(|(light, _)| light).collect();
            let value =
                if found.is_empty() { ray.value } else { self.mean(worker, part.part(number), &found, divisions - 1) };
            sum = [0, 1, 2].map(|band| sum[band] + value[band]);
        }
        sum.map(|band| band / PARTS as f64)
    }

    /// A ray through a part, and its point of the unit square.
    fn ray(&mut self, worker: &mut RayWorker<'_>, part: Part) -> ([f64; 2], RayValue) {
        let (column, row) = self.pixel;
        let pixel = (row * self.camera.columns() + column) as u64;
        let index = GLINTS | pixel << NUMBERS_LOG2 | u64::from(self.count);
        self.count += 1;
        let sampler = RaySampler::new(self.block.renderer.plan().seed(), index);
        let [x, y, ..] = sampler.take(DimensionSet::CAMERA);
        let ray = self.camera.still_ray(column, row, part.point([x, y]));
        let recorded = (self.near.as_deref(), &mut None);
        ([x, y], ray.map_or(RayValue::OUTSIDE, |ray| RayValue::trace(worker, index, &ray, recorded)))
    }
}
