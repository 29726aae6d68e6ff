//! The image of a light in curved mirrors, as a density of rays.
//!
//! To the rays through a small pinhole the image of a small light is the same for all pixels: a
//! shift of the ray's origin acts like a turn of its direction. So the image is traced once, from
//! the middle of the pinhole. A linear map leads from points of the light's disk to directions.
//! Along a torus images are bent, and a mesh breaks them into facets, so cells of the light's plane
//! are filled from the middle as long as their rays show light. The rays of pixels are drawn from
//! these cells in proportion to the light.

use glam::{DMat2, DVec2, DVec3, IVec2};
use radsight_render::{CountedLight, MirroredLight, Ray, RayWorker};
use std::collections::HashSet;
use std::ops::Range;

/// Step of numerical derivatives, as a tangent and in scene units relative to the distance: less
/// than an image's size, more than rounding errors.
const STEP: f64 = 1e-6;

/// Side of a cell, in radii of the light, and the cells on each side of the middle.
const CELL: f64 = 0.2;
const MAX_CELLS: i32 = 80;

/// Density of cells without light, beside others with light, relative to the mean.
const FLOOR: f64 = 0.2;

/// Fraction of the rays that are drawn around the cells, from a disk of this radius, in radii of the
/// light more than the cells.
const AROUND_FRACTION: f64 = 0.05;
const AROUND: f64 = 3.0;

/// The same with cells instead of a disk: they lie within so many cells of those with a density.
const CELLS_AROUND: i32 = 5;

/// The image of a light from all points of a pinhole.
#[derive(Clone, Debug)]
pub(crate) struct CurvedImage {
    /// Index of the light.
    pub(crate) light: usize,
    /// The specular events along its rays, as in [`SpecularEnd::chain`](radsight_render::SpecularEnd::chain).
    pub(crate) chain: u32,
    frame: Frame,
    /// Turn of the direction that acts like a shift of the origin, one row for each component.
    by_origin: [DVec3; 2],
    /// The tangents to the middle, and from places in the light's plane, in radii, to tangents.
    pub(crate) center: DVec2,
    pub(crate) map: DMat2,
    inverse: DMat2,
    pub(crate) footprint: Footprint,
}

/// Where light is seen in the plane of a light.
#[derive(Clone, Debug)]
pub(crate) struct Footprint {
    /// Pdf of each cell per area, row by row.
    density: Vec<f64>,
    /// The cells with a density, each with the sum of the probabilities up to it.
    cells: Vec<(IVec2, f64)>,
    least: IVec2,
    columns: i32,
    /// Distance of the farthest place from the middle.
    reach: f64,
    /// Sum of light over the cells' area.
    light: f64,
    /// Density of the cells around those that are known.
    around: f64,
}

/// Directions around one of them, as tangents.
#[derive(Clone, Copy, Debug)]
struct Frame {
    origin: DVec3,
    axis: DVec3,
    across: [DVec3; 2],
}

impl Frame {
    fn direction(&self, at: DVec2) -> DVec3 {
        (self.axis + self.across[0] * at.x + self.across[1] * at.y).normalize()
    }

    fn tangents(&self, direction: DVec3) -> DVec2 {
        self.across.map(|across| direction.dot(across) / direction.dot(self.axis)).into()
    }
}

impl CurvedImage {
    /// The images of lights that are seen from a point; scene units.
    pub(crate) fn all(worker: &mut RayWorker<'_>, lights: &[MirroredLight], origin: DVec3) -> Vec<CurvedImage> {
        let mut images: Vec<CurvedImage> = Vec::new();
        for light in lights {
            // The parts of an image that a mesh breaks are found from each of them.
            if !images.iter().any(|image| image.shows(light.direction())) {
                images.extend(CurvedImage::new(worker, light, origin));
            }
        }
        images
    }

    /// `None` where the map is singular or no light is seen.
    fn new(worker: &mut RayWorker<'_>, light: &MirroredLight, origin: DVec3) -> Option<CurvedImage> {
        let axis = light.direction();
        let x = axis.any_orthonormal_vector();
        let frame = Frame { origin, axis, across: [x, axis.cross(x)] };
        let mut passing =
            |shift: DVec3, at: DVec2| worker.offset_from(light, &Ray::new(frame.origin + shift, frame.direction(at))?);
        let own = passing(DVec3::ZERO, DVec2::ZERO)?;
        let [x, y] = [DVec2::X, DVec2::Y].map(|side| Some((passing(DVec3::ZERO, side * STEP)? - own) / STEP));
        let map = DMat2::from_cols(x?, y?).inverse();
        if !(map.is_finite() && map.determinant().abs() > f64::MIN_POSITIVE) {
            return None;
        }
        let shifted = |side: DVec3| Some(map * (passing(side * STEP, DVec2::ZERO)? - own) / STEP);
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(shifted);
        let (x, y, z) = (x?, y?, z?);
        let by_origin = [DVec3::new(x.x, y.x, z.x), DVec3::new(x.y, y.y, z.y)];
        let center = -(map * own);
        worker.count(CountedLight::Images);
        let footprint = Footprint::filled(|place| {
            let ray = Ray::new(origin, frame.direction(center + map * place));
            ray.map_or(0.0, |ray| worker.trace(0, &ray).value.iter().sum())
        });
        worker.count(CountedLight::All);
        let (light, chain, inverse) = (light.light(), light.chain(), map.inverse());
        footprint.map(|footprint| CurvedImage { light, chain, frame, by_origin, center, map, inverse, footprint })
    }

    /// The tangents of a ray, with the turn that acts like the shift of its origin.
    pub(crate) fn tangents(&self, origin: DVec3, direction: DVec3) -> DVec2 {
        self.frame.tangents(direction) + self.turn(origin)
    }

    /// The turn, in tangents, that acts like the shift of a ray's origin.
    fn turn(&self, origin: DVec3) -> DVec2 {
        self.by_origin.map(|by_origin| by_origin.dot(origin - self.frame.origin)).into()
    }

    /// The place in the light's plane, in radii, that a ray sees: as on the ray from the middle of the
    /// pinhole to which it is equivalent.
    pub(crate) fn place(&self, origin: DVec3, direction: DVec3) -> DVec2 {
        self.inverse * (self.tangents(origin, direction) - self.center)
    }

    /// The unit direction in which a place is seen from a point of the pinhole: the inverse of
    /// [`CurvedImage::place`].
    pub(crate) fn direction_to(&self, place: DVec2, origin: DVec3) -> DVec3 {
        self.frame.direction(self.center + self.map * place - self.turn(origin))
    }

    /// The solid angle of the directions to places, per area in radii.
    pub(crate) fn solid_angle(&self, direction: DVec3) -> f64 {
        self.map.determinant().abs() * direction.dot(self.frame.axis).powi(3)
    }

    /// The unit direction of the middle.
    pub(crate) fn direction(&self) -> DVec3 {
        self.frame.direction(self.center)
    }

    /// The farthest direction from the middle, as a tangent.
    pub(crate) fn reach(&self) -> f64 {
        self.footprint.reach() * self.map.x_axis.length().hypot(self.map.y_axis.length())
    }

    /// The light of the image, up to a factor that all images have in common.
    pub(crate) fn light(&self) -> f64 {
        self.footprint.light * self.map.determinant().abs()
    }

    /// Whether the image shows light in a unit direction.
    fn shows(&self, direction: DVec3) -> bool {
        let place = self.place(self.frame.origin, direction);
        direction.dot(self.frame.axis) > 0.0 && self.footprint.in_cells(place) > 0.0
    }
}

impl Footprint {
    /// From the light that is seen at a place, by one ray to the middle of each cell. `None` if there is
    /// none near the middle.
    fn filled(mut light_at: impl FnMut(DVec2) -> f64) -> Option<Footprint> {
        let side = 2 * MAX_CELLS + 1;
        let index = |cell: IVec2| ((cell.y + MAX_CELLS) * side + cell.x + MAX_CELLS) as usize;
        let mut is_known = vec![false; (side * side) as usize];
        let mut waiting: Vec<IVec2> = square(3).collect();
        let mut found: Vec<(IVec2, f64)> = Vec::new();
        while let Some(cell) = waiting.pop() {
            if cell.abs().max_element() > MAX_CELLS || std::mem::replace(&mut is_known[index(cell)], true) {
                continue;
            }
            let light = light_at(CELL * cell.as_dvec2());
            found.push((cell, light));
            if light > 0.0 {
                waiting.extend(square(1).map(|beside| cell + beside));
            }
        }
        let lit = found.iter().filter(|(_, light)| *light > 0.0).count();
        let sum: f64 = found.iter().map(|(_, light)| light).sum();
        let floor = FLOOR * sum / lit.max(1) as f64;
        (lit > 0).then(|| Footprint::new(found.into_iter().map(|(cell, light)| (cell, light.max(floor))), sum))
    }

    /// From the weights of cells.
    fn new(weights: impl Iterator<Item = (IVec2, f64)>, light: f64) -> Footprint {
        let weights: Vec<(IVec2, f64)> = weights.collect();
        let least = weights.iter().fold(IVec2::MAX, |least, (cell, _)| least.min(*cell));
        let most = weights.iter().fold(IVec2::MIN, |most, (cell, _)| most.max(*cell));
        let size = most - least + 1;
        let total: f64 = weights.iter().map(|(_, weight)| weight).sum();
        let mut footprint = Footprint {
            density: vec![0.0; (size.x * size.y) as usize],
            cells: Vec::with_capacity(weights.len()),
            least,
            columns: size.x,
            reach: 0.0,
            light: light * CELL * CELL,
            around: 0.0,
        };
        let mut below = 0.0;
        for (cell, weight) in weights {
            below += weight / total;
            footprint.cells.push((cell, below));
            let at = cell - least;
            footprint.density[(at.y * size.x + at.x) as usize] = weight / total / (CELL * CELL);
            footprint.reach = footprint.reach.max(CELL * (cell.as_dvec2().length() + 1.0));
        }
        footprint
    }

    /// Distance of the farthest drawn place from the middle.
    pub(crate) fn reach(&self) -> f64 {
        self.reach + AROUND
    }

    /// A place for a point of the unit square.
    pub(crate) fn sample(&self, u: [f64; 2]) -> DVec2 {
        if u[0] < AROUND_FRACTION {
            return self.reach() * DVec2::from(radsight_sampling::unit_disk(u[0] / AROUND_FRACTION, u[1]));
        }
        self.sample_cells(0..self.cells.len(), [(u[0] - AROUND_FRACTION) / (1.0 - AROUND_FRACTION), u[1]])
    }

    /// A place in some of the cells for a point of the unit square, with the pdf of
    /// [`Footprint::in_cells`] relative to their probability.
    pub(crate) fn sample_cells(&self, among: Range<usize>, u: [f64; 2]) -> DVec2 {
        let before = |index: usize| if index == 0 { 0.0 } else { self.cells[index - 1].1 };
        let chosen = before(among.start) + u[0] * self.probability(among.clone());
        let index = self.cells.partition_point(|(_, below)| *below <= chosen).clamp(among.start, among.end - 1);
        let (cell, below) = self.cells[index];
        let along = ((chosen - before(index)) / (below - before(index))).clamp(0.0, 1.0);
        CELL * (cell.as_dvec2() + DVec2::new(along, u[1]) - 0.5)
    }

    /// The probability of some of the cells.
    pub(crate) fn probability(&self, among: Range<usize>) -> f64 {
        let below = |count: usize| if count == 0 { 0.0 } else { self.cells[count - 1].1 };
        below(among.end) - below(among.start)
    }

    /// The mean place of some of the cells.
    pub(crate) fn middle(&self, among: Range<usize>) -> DVec2 {
        let sum: IVec2 = self.cells[among.clone()].iter().map(|(cell, _)| *cell).sum();
        CELL * sum.as_dvec2() / among.len() as f64
    }

    /// The same light, with the cells around those that are known, which share [`AROUND_FRACTION`] of
    /// the probability evenly. `square_of` gives the square that a place belongs to. The cells of each are
    /// one part, and those around are another; the parts are ranges of cells.
    pub(crate) fn in_parts(&self, square_of: impl Fn(DVec2) -> [i32; 2]) -> (Footprint, Vec<Range<usize>>) {
        let known: HashSet<IVec2> = self.cells.iter().map(|(cell, _)| *cell).collect();
        let near = known.iter().flat_map(|cell| square(CELLS_AROUND).map(|beside| *cell + beside));
        let around: HashSet<IVec2> = near.filter(|cell| !known.contains(cell)).collect();
        let weight_of = |index: usize| (1.0 - AROUND_FRACTION) * self.probability(index..index + 1);
        let inner = self.cells.iter().enumerate().map(|(index, (cell, _))| (*cell, weight_of(index), false));
        let each = AROUND_FRACTION / around.len() as f64;
        let outer = around.iter().map(|cell| (*cell, each, true));
        let part_of = |cell: IVec2, is_around: bool| (is_around, square_of(CELL * cell.as_dvec2()));
        let mut cells: Vec<_> =
            inner.chain(outer).map(|(cell, weight, is_around)| (part_of(cell, is_around), cell, weight)).collect();
        cells.sort_by_key(|(part, cell, _)| (*part, cell.to_array()));
        let mut parts: Vec<Range<usize>> = Vec::new();
        for (index, (part, ..)) in cells.iter().enumerate() {
            match parts.last_mut() {
                Some(last) if cells[last.start].0 == *part => last.end = index + 1,
                _ => parts.push(index..index + 1),
            }
        }
        let weights = cells.into_iter().map(|(_, cell, weight)| (cell, weight));
        let footprint = Footprint::new(weights, self.light / (CELL * CELL));
        (Footprint { around: each / (CELL * CELL), ..footprint }, parts)
    }

    /// The pdf of [`Footprint::sample`] per area.
    pub(crate) fn pdf(&self, place: DVec2) -> f64 {
        let reach = self.reach();
        if place.length_squared() > reach * reach {
            return 0.0;
        }
        let around = (std::f64::consts::PI * reach * reach).recip();
        AROUND_FRACTION * around + (1.0 - AROUND_FRACTION) * self.in_cells(place)
    }

    /// Whether a place is in a cell with light or next to one, and not around them.
    pub(crate) fn is_near_light(&self, place: DVec2) -> bool {
        const ROUNDING: f64 = 1e-9;
        self.in_cells(place) > (1.0 + ROUNDING) * self.around
    }

    /// The pdf of places in the cells, per area.
    pub(crate) fn in_cells(&self, place: DVec2) -> f64 {
        let at = (place / CELL).round().as_ivec2() - self.least;
        let is_inside = at.x >= 0 && at.x < self.columns && at.y >= 0;
        let density = || self.density.get((at.y * self.columns + at.x) as usize);
        if is_inside { density().copied().unwrap_or(0.0) } else { 0.0 }
    }
}

/// The cells within a distance along both axes.
fn square(reach: i32) -> impl Iterator<Item = IVec2> {
    (-reach..=reach).flat_map(move |y| (-reach..=reach).map(move |x| IVec2::new(x, y)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bent strip of light, three times as bright at one end.
    fn light(place: DVec2) -> f64 {
        let across = place.y - 0.3 * place.x * place.x;
        let is_lit = place.x.abs() < 2.0 && across.abs() < 0.4;
        if is_lit { 2.0 + 0.5 * place.x } else { 0.0 }
    }

    /// Evenly distributed points of the unit square.
    fn points(count: u32) -> impl Iterator<Item = [f64; 2]> {
        let of_index = move |index: u32| {
            [(f64::from(index) + 0.5) / f64::from(count), (f64::from(index) * 0.618_033_988_749_894_9).fract()]
        };
        (0..count).map(of_index)
    }

    #[test]
    fn samples_of_a_footprint_integrate_light_with_little_noise() {
        let footprint = Footprint::filled(light).expect("there is light in the middle");
        let weights: Vec<f64> = points(1 << 18)
            .map(|u| {
                let place = footprint.sample(u);
                light(place) / footprint.pdf(place)
            })
            .collect();
        let mean = weights.iter().sum::<f64>() / weights.len() as f64;
        // The strip is 4 by 0.8 with a mean brightness of 2.
        assert!((mean - 6.4).abs() < 0.02, "{mean}");
        let variance = weights.iter().map(|weight| (weight - mean).powi(2)).sum::<f64>() / weights.len() as f64;
        assert!(variance.sqrt() < mean, "{}", variance.sqrt());
    }

    #[test]
    fn the_density_of_a_footprint_is_that_of_its_samples() {
        let footprint = Footprint::filled(light).expect("there is light in the middle");
        let reach = footprint.reach();
        let integral = |of_place: &dyn Fn(DVec2) -> f64| {
            let places = points(1 << 20).map(|u| reach * (2.0 * DVec2::from(u) - 1.0));
            places.map(|place| footprint.pdf(place) * of_place(place)).sum::<f64>() * 4.0 * reach * reach
                / f64::from(1 << 20)
        };
        let sampled = |of_place: &dyn Fn(DVec2) -> f64| {
            points(1 << 18).map(|u| of_place(footprint.sample(u))).sum::<f64>() / f64::from(1 << 18)
        };
        for of_place in [|_: DVec2| 1.0, |place: DVec2| place.x, |place: DVec2| place.y * place.y] {
            let (expected, found) = (integral(&of_place), sampled(&of_place));
            assert!((found - expected).abs() < 0.01 * (1.0 + expected.abs()), "{found} for {expected}");
        }
    }

    #[test]
    fn the_parts_of_a_footprint_make_up_its_light() {
        let known = Footprint::filled(light).expect("there is light in the middle");
        let (footprint, parts) = known.in_parts(|place| place.floor().as_ivec2().into());
        assert!(parts.len() > 8 && parts.iter().map(ExactSizeIterator::len).sum::<usize>() == footprint.cells.len());
        assert!((footprint.probability(0..footprint.cells.len()) - 1.0).abs() < 1e-12);
        let of_part = |part: &Range<usize>| {
            let of_point = |u| {
                let place = footprint.sample_cells(part.clone(), u);
                let density = footprint.in_cells(place);
                // A place on the side of a cell may be rounded to its neighbour.
                if density > 0.0 { light(place) * footprint.probability(part.clone()) / density } else { 0.0 }
            };
            points(1 << 14).map(of_point).sum::<f64>() / f64::from(1 << 14)
        };
        let found: f64 = parts.iter().map(of_part).sum();
        assert!((found - 6.4).abs() < 0.02, "{found}");
        // All known cells, and then those around them.
        let around = footprint.cells.len() - known.cells.len();
        assert!(around > 100 && (footprint.probability(0..known.cells.len()) - 1.0 + AROUND_FRACTION).abs() < 1e-12);
    }

    #[test]
    fn without_light_there_is_no_footprint() {
        assert!(Footprint::filled(|_| 0.0).is_none());
    }
}
