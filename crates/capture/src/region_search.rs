//! Where on a film lights may be seen behind several mirrors.
//!
//! In the hole of a torus each light appears behind one, two and three reflections, and a mesh breaks
//! such images into pieces of a thousandth of a pixel: too many to find each. But where rays pass the
//! lights is known at the corners of a square of the film, and so is about how much of the square
//! shows a light: the area of the light relative to that over which the corners spread. Squares are
//! divided where that lowers the variance most, as long as the rays that it takes are fewer than those
//! that it saves.

use crate::Exposer;
use crate::film::UnblurredFilm;
use crate::film_images::FilmImages;
use crate::image_region::{ImageRegion, MAX_LEVEL, RegionSquare};
use crate::radiance::radiance;
use glam::{DMat2, DVec2, DVec3, UVec2, Vec2};
use radsight_adaptive::ray_number;
use radsight_render::{CountedLight, MAX_MIRRORED_LIGHTS, Ray, RayWorker, SpecularEnd, light_offset};
use rustc_hash::FxHashMap;
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f64::consts::PI;
use std::ops::Range;

/// How far from the corners of a square a light may be, relative to their extent, since the map to
/// the light's plane is not linear.
const MARGIN: f64 = 0.3;

/// Relative error of offsets in single precision, at the most.
const ROUNDING: f32 = 1e-4;

/// The extent of corners that is not known, in radii of the light.
const UNKNOWN_EXTENT: f64 = 100.0;

/// Distance from a pixel that sees a mirror in another one within which others may do, pixels.
const DOUBLY_NEAR: f64 = 2.0;

/// All squares are divided so many times: the rays of neighbouring pixels have little in common.
const FIRST_LEVEL: u32 = 1;

/// Squares whose corners are seen by different mirrors are divided so many times. Between them may be a thin
/// part that is seen by others, and lights in it: with one division half of the light in the hole of a torus
/// was not expected, with up to four 8 %.
const MIXED_LEVEL: u32 = 4;

/// Variance of rays that are drawn by the expected light, relative to what is expected: lit fractions are
/// estimated high, and mirrors absorb. Measured with a torus of 20,000 triangles.
const VARIANCE_RATIO: f64 = 0.1;

/// Rays that a division takes, by its time: it has five new corners, most of them shared by two squares.
const RAYS_OF_DIVISION: f64 = 16.0;

/// A region that would take fewer rays than this is left to chance.
const MIN_RAYS: f64 = 100.0;

/// Points along each side of a film whose mean radiance stands for that of the picture.
const MEAN_SIDE: u32 = 8;

/// Their ray numbers are those of this pixel.
const MEAN_PIXEL: u64 = 1 << 43;

/// Maximum number of rays of a search.
const MAX_RAYS: usize = 200_000;

/// Maximum number of offsets of all corners.
const MAX_OFFSETS: usize = 4_000_000;

/// A square to be divided.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Candidate {
    /// By how much that lowers the rms light at the most.
    gain: f64,
    square: usize,
    /// Extent of its corners, in radii of a light.
    extent: f64,
}

impl Eq for Candidate {}

impl Ord for Candidate {
    fn cmp(&self, other: &Candidate) -> Ordering {
        self.gain.total_cmp(&other.gain).then(other.square.cmp(&self.square))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Candidate) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The ray through a corner of squares.
#[derive(Clone, Debug, Default)]
struct Corner {
    /// The greatest number of mirrors to which it leads.
    mirrors: usize,
    /// Its ends.
    ends: Range<usize>,
}

/// An end of a corner's ray.
#[derive(Clone, Copy, Debug)]
struct End {
    /// [`SpecularEnd::chain`].
    chain: u32,
    /// Fraction of a light's radiance that it shows, squared.
    squared_weight: f64,
    /// Index of the first of its offsets; `None` where it passes no light.
    offsets: Option<usize>,
    /// The last mirror.
    origin: DVec3,
}

/// What a search finds.
#[derive(Debug)]
pub(crate) enum FoundRegion {
    /// Hardly any light is expected.
    Dark,
    /// Where unknown images may be seen.
    Lit(ImageRegion),
    /// There is too much to search.
    Unknown,
}

/// What is known of the images of a film before the search.
pub(crate) struct RegionSearch<'s> {
    exposer: &'s Exposer<'s>,
    film: &'s UnblurredFilm,
    worker: RayWorker<'s>,
    /// Images that have rays of their own.
    known: &'s FilmImages,
    /// Unit directions from the pinhole to the lights.
    towards: Vec<DVec3>,
    /// In the order in which they were traced.
    corners: Vec<Corner>,
    ends: Vec<End>,
    /// By their place in sides of the smallest squares.
    by_place: FxHashMap<UVec2, usize>,
    /// Where the ends pass the lights, in radii from their centres; all lights of an end together.
    offsets: Vec<Option<Vec2>>,
    squares: Vec<RegionSquare>,
    /// Of each square, the indices of its corners, in turn around it.
    corners_of: Vec<[usize; 4]>,
    waiting: BinaryHeap<Candidate>,
}

impl<'s> RegionSearch<'s> {
    pub(crate) fn new(exposer: &'s Exposer<'s>, film: &'s UnblurredFilm, known: &'s FilmImages) -> RegionSearch<'s> {
        let camera = exposer.rays.camera();
        let position = camera.position_m() / camera.scene_unit_m();
        let lights = exposer.renderer.plan().lights.iter();
        RegionSearch {
            exposer,
            film,
            worker: exposer.renderer.worker(),
            known,
            towards: lights.map(|light| (light.center - position).normalize_or(DVec3::Z)).collect(),
            corners: Vec::new(),
            ends: Vec::new(),
            by_place: FxHashMap::default(),
            offsets: Vec::new(),
            squares: Vec::new(),
            corners_of: Vec::new(),
            waiting: BinaryHeap::new(),
        }
    }

    /// The region of the film that may show unknown images. `allowed` is the squared error that images
    /// may add to pixels, relative to the squared mean.
    pub(crate) fn region(mut self, allowed: f64) -> FoundRegion {
        let Some(pixels) = self.mirroring_pixels() else { return FoundRegion::Unknown };
        if self.add_pixels(&pixels).is_none() {
            return FoundRegion::Unknown;
        }
        let mut rms_light: f64 = self.squares.iter().map(RegionSquare::rms_light).sum();
        if rms_light <= 0.0 {
            return FoundRegion::Dark;
        }
        let variance = VARIANCE_RATIO * self.radiance().powi(2);
        let rays_needed = self.rays_needed(variance, allowed);
        let is_needed = |rms_light: f64| rms_light * rms_light * rays_needed > MIN_RAYS;
        if !is_needed(rms_light) {
            return FoundRegion::Dark;
        }
        while let Some(Candidate { gain, square, extent }) = self.waiting.pop() {
            let saved = 2.0 * rms_light * gain * rays_needed;
            if saved < RAYS_OF_DIVISION || self.corners.len() > self.max_rays() {
                break;
            }
            rms_light += self.divide(square, extent);
        }
        let columns = self.film.size()[0];
        let region = is_needed(rms_light).then(|| ImageRegion::new(self.squares, pixels, columns, variance)).flatten();
        region.map_or(FoundRegion::Dark, FoundRegion::Lit)
    }

    /// Adds the squares of pixels, divided as often as their number allows. `None` where there are too many,
    /// which are left to chance.
    fn add_pixels(&mut self, pixels: &[usize]) -> Option<()> {
        let most = self.max_rays() / 4;
        let level = (0..=FIRST_LEVEL).rev().find(|level| pixels.len() << (2 * level) <= most)?;
        for pixel in pixels {
            let corners = self.corners_of_pixel(*pixel);
            self.add(self.corner_place(*pixel), 0, (corners, UNKNOWN_EXTENT));
        }
        let mut next = 0;
        while let Some(RegionSquare { level: own, .. }) = self.squares.get(next) {
            let is_mixed = || *own < MIXED_LEVEL && self.corners.len() < most && self.is_mixed(next);
            if *own < level || is_mixed() {
                self.divide(next, UNKNOWN_EXTENT);
                self.squares[next].lit = 0.0;
            }
            next += 1;
        }
        let squares = &self.squares;
        self.waiting.retain(|candidate| squares[candidate.square].quarters.is_none());
        Some(())
    }

    /// Whether the corners of a square are seen by different chains of mirrors.
    fn is_mixed(&self, square: usize) -> bool {
        let ends = self.corners_of[square].map(|corner| &self.ends[self.corners[corner].ends.clone()]);
        let [first, others @ ..] = &ends;
        let chains = || first.iter().map(|end| end.chain);
        others.iter().any(|ends| !ends.iter().map(|end| end.chain).eq(chains()))
    }

    /// Maximum number of rays. Each keeps an offset from each light.
    fn max_rays(&self) -> usize {
        MAX_RAYS.min(MAX_OFFSETS / self.towards.len().max(1))
    }

    /// The number of rays for the allowed error, if the rms of the light over the film were that of one whole
    /// pixel of radiance 1.
    fn rays_needed(&mut self, variance: f64, allowed: f64) -> f64 {
        let Exposer { rays, weights, .. } = *self.exposer;
        let mut worker = self.exposer.workers();
        worker.count(CountedLight::WithoutImages);
        let size = self.film.size().map(|count| count as f64 / f64::from(MEAN_SIDE));
        let seen = (0..MEAN_SIDE * MEAN_SIDE).filter_map(|index| {
            let at = DVec2::new(f64::from(index % MEAN_SIDE) + 0.5, f64::from(index / MEAN_SIDE) + 0.5);
            let seen = self.film.ray_to_point(rays, at * DVec2::from(size), DVec2::ZERO)?;
            Some(radiance(&mut worker, ray_number(MEAN_PIXEL, index), (rays, 0), &seen.ray, weights))
        });
        let mean = seen.sum::<f64>() / f64::from(MEAN_SIDE * MEAN_SIDE);
        let relative = variance / (mean * mean * allowed * self.film.picture_pixels() as f64);
        let rays = relative * self.film.squared_weights(1.0, 1.0);
        if rays.is_finite() { rays } else { f64::MAX.sqrt() }
    }

    /// The pixels of the film that see a mirror, and near which a corner of a pixel sees one in another.
    /// `None` where there are too many, or too many lights.
    fn mirroring_pixels(&mut self) -> Option<Vec<usize>> {
        if self.towards.len() > MAX_MIRRORED_LIGHTS {
            return None;
        }
        let near_reflectors = self.pixels_near_reflectors();
        if near_reflectors.len() > self.max_rays() {
            return None;
        }
        // The most mirrors to which a corner leads, by pixel.
        let mut mirrors = vec![0; self.film.pixel_count()];
        for pixel in &near_reflectors {
            let corners = self.corners_of_pixel(*pixel);
            mirrors[*pixel] = corners.map(|corner| self.corners[corner].mirrors).into_iter().max().unwrap_or(0);
        }
        let is_doubly_near = |pixel: usize| {
            let middle = self.film.picture_point(self.film.corner(pixel) + 0.5);
            self.film.pixels_around(middle, DVec2::splat(DOUBLY_NEAR)).any(|near| mirrors[near] > 1)
        };
        Some(near_reflectors.into_iter().filter(|pixel| mirrors[*pixel] > 0 && is_doubly_near(*pixel)).collect())
    }

    /// The pixels of the film that may see a mirror, by the cones around them. Any may see a pane.
    fn pixels_near_reflectors(&self) -> Vec<usize> {
        let (film, rays) = (self.film, self.exposer.rays);
        let plan = self.exposer.renderer.plan();
        let (reflectors, has_panes) = (&plan.reflectors, plan.has_panes);
        // A single flat one shows no mirror in a mirror.
        let is_single = plan.flat_reflectors.hold_all_panes && plan.flat_reflectors.surfaces.len() == 1;
        if reflectors.is_empty() && (!has_panes || is_single) {
            return Vec::new();
        }
        let is_near = |pixel: &usize| {
            let [corner, middle] = [0.0, 0.5].map(|at| film.ray_of_point(rays, film.corner(*pixel) + at));
            let (Some(corner), Some(middle)) = (corner, middle) else { return false };
            // Pixels are not exactly square.
            let around = 2.0 * corner.direction.distance(middle.direction);
            let meets = |(axis, reach): (DVec3, f64)| axis.distance(middle.direction) <= reach + around;
            has_panes || reflectors.iter().any(|reflector| reflector.cone(middle.origin).is_none_or(meets))
        };
        (0..film.pixel_count()).filter(|pixel| film.share(*pixel) > 0.0).filter(is_near).collect()
    }

    /// Divides a square, whose corners have an extent; by how much the rms light changes.
    fn divide(&mut self, square: usize, extent: f64) -> f64 {
        let RegionSquare { corner, level, .. } = self.squares[square];
        let before = self.squares[square].rms_light();
        let first = self.squares.len();
        self.squares[square].quarters = Some(first);
        let half = 1 << (MAX_LEVEL - level - 1);
        let [a, b, c, d] = self.corners_of[square];
        let mut end = |column: u32, row: u32| self.end(corner + half * UVec2::new(column, row));
        let (ab, bc, cd, da, middle) = (end(1, 0), end(2, 1), end(1, 2), end(0, 1), end(1, 1));
        let quarters = [
            (UVec2::ZERO, [a, ab, middle, da]),
            (UVec2::X, [ab, b, bc, middle]),
            (UVec2::Y, [da, middle, cd, d]),
            (UVec2::ONE, [middle, bc, c, cd]),
        ];
        for (at, corners) in quarters {
            self.add(corner + half * at, level + 1, (corners, extent));
        }
        self.squares[first..].iter().map(RegionSquare::rms_light).sum::<f64>() - before
    }

    /// Adds a square, from its corners, in one whose corners have an extent `around`.
    fn add(&mut self, corner: UVec2, level: u32, (corners, around): ([usize; 4], f64)) {
        let (lit, extent) = self.lit((corner, level), corners, around);
        let square = RegionSquare::new(corner, level, lit);
        if level < MAX_LEVEL && lit > 0.0 {
            let gain = square.area() * (lit.sqrt() - lit);
            self.waiting.push(Candidate { gain, square: self.squares.len(), extent });
        }
        self.squares.push(square);
        self.corners_of.push(corners);
    }

    /// The fraction of a square that may show a light of unknown images, and the extent of its corners.
    /// What is seen dimly counts by its squared radiance.
    fn lit(&self, (corner, level): (UVec2, u32), corners: [usize; 4], around: f64) -> (f64, f64) {
        let (unit, side) = (RegionSquare::side(MAX_LEVEL), RegionSquare::side(level));
        let seen = |place: DVec2| {
            let point = unit * corner.as_dvec2() + side * place;
            self.film.ray_to_point(self.exposer.rays, point, DVec2::ZERO)
        };
        let ends = corners.map(|corner| &self.ends[self.corners[corner].ends.clone()]);
        let (mut lit, mut extent) = (0.0, 0.0_f64);
        for (first, End { chain, squared_weight, .. }) in
            ends.iter().enumerate().flat_map(|(first, ends)| ends.iter().map(move |end| (first, end)))
        {
            let same = ends.map(|ends| ends.iter().find(|end| end.chain == *chain));
            if same[..first].iter().any(Option::is_some) {
                continue;
            }
            let offsets = same.map(|end| end.and_then(|end| end.offsets));
            if offsets.iter().all(Option::is_none) {
                continue;
            }
            for light in 0..self.towards.len() {
                let offset = |offsets: usize| self.offsets[offsets + light];
                let corners = offsets.map(|offsets| offsets.and_then(offset));
                if is_far(corners) {
                    continue;
                }
                let passing = Passing::new(corners.map(|offset| offset.map(Vec2::as_dvec2)), around);
                let fraction = passing.lit();
                let is_known =
                    |place: DVec2| seen(place).is_some_and(|seen| self.known.is_known(&seen, (light, *chain)));
                if fraction > 0.0 && !passing.place().is_some_and(is_known) {
                    lit += squared_weight * fraction;
                    extent = extent.max(passing.extent);
                }
            }
        }
        if lit > 0.0 && seen(DVec2::splat(0.5)).is_some_and(|seen| self.known.shows_light(&seen)) {
            return (0.0, around);
        }
        (f64::min(lit, 1.0), extent.min(around))
    }

    /// The corner of a pixel on the left and above, in sides of the smallest squares.
    fn corner_place(&self, pixel: usize) -> UVec2 {
        self.film.corner(pixel).as_uvec2() << MAX_LEVEL
    }

    /// The corners of a pixel, in turn around it.
    fn corners_of_pixel(&mut self, pixel: usize) -> [usize; 4] {
        let place = self.corner_place(pixel);
        [UVec2::ZERO, UVec2::X, UVec2::ONE, UVec2::Y].map(|at| self.end(place + (at << MAX_LEVEL)))
    }

    fn end(&mut self, at: UVec2) -> usize {
        if let Some(known) = self.by_place.get(&at) {
            return *known;
        }
        let (corner, index) = (self.traced(at).unwrap_or_default(), self.corners.len());
        self.by_place.insert(at, index);
        self.corners.push(corner);
        index
    }

    /// The ray that sees a point of the film through the middle of the pinhole; `None` where it meets no
    /// mirror.
    fn traced(&mut self, at: UVec2) -> Option<Corner> {
        let ray = self.film.ray_of_point(self.exposer.rays, RegionSquare::side(MAX_LEVEL) * at.as_dvec2())?;
        let mut ends = Vec::new();
        self.worker.specular_ends(&ray, &mut ends);
        let first = self.ends.len();
        for SpecularEnd { chain, weight, ray, .. } in &ends {
            let offsets = self.add_offsets(ray);
            self.ends.push(End { chain: *chain, squared_weight: weight * weight, offsets, origin: ray.origin });
        }
        let mirrors = ends.iter().map(|end| end.mirrors).max()?;
        Some(Corner { mirrors, ends: first..self.ends.len() })
    }

    /// Adds where a ray passes the lights, if it passes any; the index of the first offset.
    fn add_offsets(&mut self, ray: &Ray) -> Option<usize> {
        let (plan, first) = (self.exposer.renderer.plan(), self.offsets.len());
        let offset =
            |(light, towards): (usize, &DVec3)| light_offset(plan, light, *towards, ray).map(|offset| offset.as_vec2());
        self.offsets.extend(self.towards.iter().enumerate().map(offset));
        let passes_any = self.offsets[first..].iter().any(Option::is_some);
        if !passes_any {
            self.offsets.truncate(first);
        }
        passes_any.then_some(first)
    }

    /// The radiance of the brightest light, from where rays lead nearest to it.
    fn radiance(&mut self) -> f64 {
        let plan = self.exposer.renderer.plan();
        let mut brightest = 0.0_f64;
        for light in 0..self.towards.len() {
            let passing = self.ends.iter().filter_map(|end| {
                let offset = self.offsets[end.offsets? + light]?;
                Some((offset.length_squared(), end.origin))
            });
            let Some((_, origin)) = passing.min_by(|(a, _), (b, _)| a.total_cmp(b)) else { continue };
            let ray = Ray::new(origin, plan.lights[light].center - origin);
            brightest = ray.map_or(brightest, |ray| brightest.max(self.worker.trace(0, &ray).value.iter().sum()));
        }
        brightest
    }
}

/// Where the rays of a square's corners pass a light, in radii from its centre.
struct Passing {
    /// In turn around the square; `None` where a ray does not pass it.
    corners: [Option<DVec2>; 4],
    /// Largest distance between them.
    extent: f64,
}

impl Passing {
    /// Where corners are missing, the extent is that of the square `around` it, by its size.
    fn new(corners: [Option<DVec2>; 4], around: f64) -> Passing {
        let pairs = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]].map(|[a, b]| corners[a].zip(corners[b]));
        let squared = pairs.iter().flatten().map(|(a, b)| a.distance_squared(*b)).fold(0.0, f64::max);
        let is_whole = corners.iter().all(Option::is_some);
        Passing { corners, extent: if is_whole { squared.sqrt() } else { squared.sqrt().max(0.5 * around) } }
    }

    /// The fraction of the square that may show the light: the probability that a disk at random within
    /// reach of the corners covers a point.
    fn lit(&self) -> f64 {
        if self.corners.iter().all(Option::is_none) {
            return 0.0;
        }
        let reach = 1.0 + MARGIN * self.extent;
        let nearest = self.corners.iter().flatten().map(|at| at.length_squared()).fold(f64::INFINITY, f64::min).sqrt();
        // No point of the square is farther from the nearest corner than its extent.
        if nearest - self.extent > reach {
            return 0.0;
        }
        let (area, perimeter, distance) = match self.corners {
            [Some(a), Some(b), Some(c), Some(d)] => of_quadrangle([a, b, c, d]),
            _ => (self.extent * self.extent, 4.0 * self.extent, (nearest - self.extent).max(0.0)),
        };
        if distance > reach { 0.0 } else { PI / (area + perimeter * reach + PI * reach * reach) }
    }

    /// The place in the square that passes the centre of the light, from 0 to 1 along both axes, by a
    /// linear map. `None` far outside.
    fn place(&self) -> Option<DVec2> {
        let [Some(a), Some(b), Some(c), Some(d)] = self.corners else { return None };
        let map = DMat2::from_cols(0.5 * (b - a + c - d), 0.5 * (d - a + c - b));
        let place = DVec2::splat(0.5) - map.inverse() * (0.25 * (a + b + c + d));
        (place.is_finite() && place.abs().max_element() <= 2.0).then_some(place)
    }
}

/// Whether [`Passing::lit`] is 0 without doubt, in single precision: most squares are far from most lights.
#[inline]
fn is_far(corners: [Option<Vec2>; 4]) -> bool {
    let [Some(a), Some(b), Some(c), Some(d)] = corners else { return false };
    let pairs = [[a, b], [a, c], [a, d], [b, c], [b, d], [c, d]];
    let squared_extent = pairs.map(|[a, b]| a.distance_squared(b)).into_iter().fold(0.0, f32::max);
    let nearest = [a, b, c, d].map(Vec2::length_squared).into_iter().fold(f32::INFINITY, f32::min);
    let extent = squared_extent.sqrt();
    nearest.sqrt() > (1.0 + ROUNDING) * (1.0 + extent + MARGIN as f32 * extent)
}

/// Area and perimeter of a quadrangle, and the distance of the origin from it.
fn of_quadrangle([a, b, c, d]: [DVec2; 4]) -> (f64, f64, f64) {
    let sides = [[a, b], [b, c], [c, d], [d, a]];
    let turns = sides.map(|[from, to]| (to - from).perp_dot(-from) >= 0.0);
    let is_inside = turns.iter().all(|turn| *turn == turns[0]);
    let nearest = sides.iter().map(|[from, to]| distance_from_origin(*from, *to)).fold(f64::INFINITY, f64::min);
    let perimeter = sides.iter().map(|[from, to]| from.distance(*to)).sum();
    (0.5 * (c - a).perp_dot(d - b).abs(), perimeter, if is_inside { 0.0 } else { nearest })
}

/// Distance of a segment from the origin.
fn distance_from_origin(from: DVec2, to: DVec2) -> f64 {
    let along = to - from;
    let nearest = (-from.dot(along) / along.length_squared()).clamp(0.0, 1.0);
    (if nearest.is_finite() { from + along * nearest } else { from }).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(corner: DVec2, side: f64) -> [Option<DVec2>; 4] {
        [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y].map(|at| Some(corner + side * at))
    }

    #[test]
    fn a_small_square_within_a_light_is_lit() {
        let lit = Passing::new(square(DVec2::new(0.2, -0.3), 1e-3), 10.0).lit();
        assert!((lit - 1.0).abs() < 0.01, "{lit}");
        assert!(Passing::new(square(DVec2::new(2.0, 0.0), 1e-3), 10.0).lit() == 0.0);
    }

    #[test]
    fn a_large_square_around_a_light_is_lit_by_the_ratio_of_areas() {
        let passing = Passing::new(square(DVec2::new(-300.0, -500.0), 1000.0), 1e4);
        let by_area = PI / 1e6;
        assert!(passing.lit() > 0.2 * by_area && passing.lit() < by_area);
        assert!(passing.place().is_some_and(|place| place.distance(DVec2::new(0.3, 0.5)) < 1e-9));
    }

    #[test]
    fn a_broken_square_has_the_extent_of_the_one_around_it() {
        let mut corners = square(DVec2::new(5.0, 0.0), 1.0);
        corners[2] = None;
        let passing = Passing::new(corners, 40.0);
        assert!(passing.extent == 20.0 && passing.lit() > 0.0 && passing.place().is_none());
        assert!(Passing::new([None; 4], 40.0).lit() == 0.0);
    }
}
