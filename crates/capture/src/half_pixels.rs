//! The unblurred film between its pixels, beside outlines.
//!
//! A film is blurred as the cubic interpolation of its pixels' means. Beside the outline of a surface
//! the means alone do not tell where in a pixel the outline is. First hits do: they are cheap, and with
//! the light of each surface they give the light of each quadrant of a pixel
//! ([`two_phase`](crate::two_phase)). Two or four quadrants of neighbouring pixels make up the mean of
//! a square half a pixel beside them. By how much it exceeds the interpolation is blurred as well: a
//! hierarchical surplus, in a basis of bilinear hats half a pixel wide (Bungartz and Griebel 2004).

use crate::Workers;
use crate::adaptive::{AdaptiveSampler, CHOICE_SET, DrawnRay};
use crate::neighbourhood::around;
use crate::shared_rays::{UnblurredFilm, cubic_weights, kernel_points};
use crate::two_phase::choose;
use glam::DVec2;
use radsight_adaptive::ray_number;
use radsight_sampling::{DimensionSet, RaySampler, unit_disk};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Rays of an outline's pixel that find the first surface, and those of them whose light is computed.
const FIRST_HITS: u32 = 64;
const LIT: u32 = 4;

/// Ray numbers begin at this pixel, so that their samples are independent of others.
const FIRST_PIXEL: u64 = 3 << 41;

/// Offsets of the points between pixels from the pixel before them, in half pixels.
const OFFSETS: [[usize; 2]; 3] = [[1, 0], [0, 1], [1, 1]];

/// By how much the light of each quadrant of some pixels exceeds the pixel's: of the left and the
/// right one at the top, then at the bottom.
type QuadrantSurplus = BTreeMap<usize, [f64; 4]>;

/// For each of [`OFFSETS`] the weights of the points around a pixel of the picture, by the pixels
/// before them.
type Kernels = [BTreeMap<[isize; 2], f64>; 3];

/// By how much the film exceeds its cubic interpolation at points half a pixel beside pixels.
#[derive(Debug)]
pub(crate) struct HalfPixels {
    columns: usize,
    quadrants: QuadrantSurplus,
    kernels: Kernels,
    /// By [`OFFSETS`] and pixel.
    surplus: [BTreeMap<usize, f64>; 3],
}

impl HalfPixels {
    fn new(film: &UnblurredFilm, quadrants: QuadrantSurplus) -> HalfPixels {
        let kernels = if quadrants.is_empty() { Kernels::default() } else { kernels(film.shift()) };
        HalfPixels { columns: film.size()[0], quadrants, kernels, surplus: Default::default() }
    }

    /// Takes the values of the film's pixels.
    pub(crate) fn refine(&mut self, values: &[f64]) {
        let (columns, quadrants) = (self.columns, &self.quadrants);
        let film = Quadrants { values, columns, rows: values.len() / columns, surplus: quadrants };
        let of_offset = |offset: [usize; 2]| {
            let [right, down] = offset;
            // The pixels before the points whose interpolation an outline's pixel takes part in.
            let reach = |half: usize| if half == 1 { 0..4 } else { 1..2 };
            let before = |pixel: &usize| {
                let steps = reach(down).flat_map(move |y| reach(right).map(move |x| y * columns + x));
                let first = pixel + columns + 1;
                steps.filter_map(|step| first.checked_sub(step)).collect::<Vec<usize>>()
            };
            let points: BTreeSet<usize> = quadrants.keys().flat_map(before).collect();
            let points = points.into_iter();
            points.filter_map(|pixel| Some((pixel, film.surplus(pixel, offset)?))).collect()
        };
        self.surplus = OFFSETS.map(of_offset);
    }

    /// Interpolated at an offset from the middle of a pixel of the film, along columns and rows.
    pub(crate) fn at(&self, pixel: usize, offset: DVec2) -> f64 {
        let of_kind = |(kind, surplus): (&[usize; 2], &BTreeMap<usize, f64>)| {
            let ([x, across], [y, down]) = (hat(offset.x, kind[0]), hat(offset.y, kind[1]));
            let index = pixel as isize + y as isize * self.columns as isize + x as isize;
            surplus.get(&(index as usize)).map_or(0.0, |surplus| across * down * surplus)
        };
        OFFSETS.iter().zip(&self.surplus).map(of_kind).sum()
    }

    /// Adds what it blurs to, to a picture in the frame of the film.
    pub(crate) fn add_blurred(&self, film: &UnblurredFilm, picture: &mut [f64]) {
        for (surplus, kernel) in self.surplus.iter().zip(&self.kernels) {
            for (pixel, surplus) in surplus {
                for ([x, y], weight) in kernel {
                    let index = *pixel as isize - y * self.columns as isize - x;
                    if let Ok(index) = usize::try_from(index)
                        && film.in_picture(index).is_some()
                    {
                        picture[index] += surplus * weight;
                    }
                }
            }
        }
    }
}

/// The point of a kind that is nearest along an axis, whole or half a pixel on, as the pixel before it;
/// and the weight of its hat.
fn hat(at: f64, half: usize) -> [f64; 2] {
    let pixel = if half == 1 { at.floor() } else { at.round() };
    [pixel, 1.0 - 2.0 * (at - pixel - 0.5 * half as f64).abs()]
}

/// For a shift by radius of the pinhole.
fn kernels(shift: DVec2) -> Kernels {
    let mut kernels = Kernels::default();
    let points = kernel_points();
    let count = points.len() as f64;
    for u in points {
        let at = shift * DVec2::from(unit_disk(u[0], u[1]));
        for (offset, kernel) in OFFSETS.iter().zip(&mut kernels) {
            let ([x, across], [y, down]) = (hat(at.x, offset[0]), hat(at.y, offset[1]));
            *kernel.entry([x as isize, y as isize]).or_default() += across * down / count;
        }
    }
    kernels
}

/// A film with the quadrants of its pixels.
struct Quadrants<'a> {
    values: &'a [f64],
    columns: usize,
    rows: usize,
    surplus: &'a QuadrantSurplus,
}

impl Quadrants<'_> {
    /// The light of a quadrant, `[right, down]` in its pixel. Pixels without an outline are linear,
    /// as they are on the sides without one.
    fn light(&self, pixel: usize, [right, down]: [usize; 2]) -> f64 {
        let own = self.values[pixel];
        if let Some(surplus) = self.surplus.get(&pixel) {
            return own + surplus[2 * down + right];
        }
        let slope = |step: usize| {
            let side = |other: usize| (!self.surplus.contains_key(&other)).then(|| self.values[other] - own);
            match (side(pixel - step), side(pixel + step)) {
                (Some(before), Some(after)) => 0.5 * (after - before),
                (Some(before), None) => -before,
                (None, after) => after.unwrap_or(0.0),
            }
        };
        let quarter = |side: usize| 0.5 * side as f64 - 0.25;
        own + quarter(right) * slope(1) + quarter(down) * slope(self.columns)
    }

    /// By how much the mean of the square half a pixel on exceeds the cubic interpolation of pixels.
    /// `None` near the border of the film.
    fn surplus(&self, pixel: usize, [right, down]: [usize; 2]) -> Option<f64> {
        let (x, y) = (pixel % self.columns, pixel / self.columns);
        if x < 2 || y < 2 || x + 4 > self.columns || y + 4 > self.rows {
            return None;
        }
        // The quadrants of a whole or of two half pixels along an axis: pixel and side.
        let halves = |half: usize| if half == 1 { [[0, 1], [1, 0]] } else { [[0, 0], [0, 1]] };
        let mut mean = 0.0;
        for [row, lower] in halves(down) {
            for [column, side] in halves(right) {
                mean += 0.25 * self.light(pixel + row * self.columns + column, [side, lower]);
            }
        }
        let weights = |half: usize| cubic_weights(0.5 * half as f64);
        let mut interpolated = 0.0;
        for (row, by_row) in weights(down).into_iter().enumerate() {
            for (column, by_column) in weights(right).into_iter().enumerate() {
                let other = pixel + row * self.columns + column - self.columns - 1;
                interpolated += by_row * by_column * self.values[other];
            }
        }
        Some(mean - interpolated)
    }
}

impl<'a> AdaptiveSampler<'a> {
    /// A film between its pixels, from the quadrants of all pixels that see several surfaces, at
    /// outlines and beside them.
    pub(crate) fn half_pixels(&self, film: &UnblurredFilm) -> HalfPixels {
        let columns = self.columns();
        let grid = [columns, self.outlines.len() / columns];
        let sees_outline = |pixel: &usize| around(*pixel, grid).any(|near| self.outlines[near]);
        let pixels: Vec<usize> = (0..self.outlines.len()).filter(sees_outline).collect();
        let of_pixel = |worker: &mut Workers<'a>, pixel: usize| Some((pixel, self.quadrants_of(worker, pixel)?));
        let found = pixels.into_par_iter().with_min_len(4).map_init(|| self.picture_worker(), of_pixel);
        HalfPixels::new(film, found.collect::<Vec<_>>().into_iter().flatten().collect())
    }

    /// `None` if the pixel sees one surface.
    fn quadrants_of(&self, worker: &mut Workers<'a>, pixel: usize) -> Option<[f64; 4]> {
        let seed = self.exposer.rays.seed();
        let number = |sample: u32| ray_number(FIRST_PIXEL + pixel as u64, sample);
        let mut drawn: Vec<(usize, Option<DrawnRay>)> = (0..FIRST_HITS)
            .map(|sample| {
                let u = RaySampler::new(seed, number(sample)).take(DimensionSet::CAMERA);
                let quadrant = usize::from(u[0] >= 0.5) + 2 * usize::from(u[1] >= 0.5);
                (quadrant, self.drawn(pixel, number(sample), u))
            })
            .collect();
        let strata: Vec<Option<_>> = drawn.iter().map(|(_, ray)| self.stratum(ray.as_ref()?)).collect();
        if strata.iter().all(|stratum| *stratum == strata[0]) {
            return None;
        }
        let [offset, ..] = RaySampler::new(seed, number(0)).take(DimensionSet::render(CHOICE_SET));
        // The weight and the weighted light of each stratum.
        let mut lights: Vec<(_, [f64; 2])> = Vec::new();
        for chosen in choose(&strata, LIT, offset) {
            let Some(ray) = drawn[chosen.index].1.take() else { continue };
            let light = ray.weight * chosen.weight * self.light_of(worker, pixel, ray);
            let Some(stratum) = strata[chosen.index] else { continue };
            match lights.iter_mut().find(|(known, _)| *known == stratum) {
                Some((_, sums)) => *sums = [sums[0] + chosen.weight, sums[1] + light],
                None => lights.push((stratum, [chosen.weight, light])),
            }
        }
        let mut quadrants = [0.0; 4];
        for ((quadrant, _), stratum) in drawn.iter().zip(&strata) {
            // Strata beyond the most that are told apart belong to the last one.
            let Some(stratum) = stratum else { continue };
            let light = lights.iter().find(|(known, _)| known == stratum).or(lights.last());
            quadrants[*quadrant] += light.map_or(0.0, |(_, [weight, light])| light / weight);
        }
        let mean = quadrants.iter().sum::<f64>() / f64::from(FIRST_HITS);
        Some(quadrants.map(|sum| 4.0 * sum / f64::from(FIRST_HITS) - mean))
    }

    fn light_of(&self, worker: &mut Workers<'a>, pixel: usize, ray: DrawnRay) -> f64 {
        self.report_discarded(1);
        self.summed(worker, pixel, std::iter::once(DrawnRay { weight: 1.0, ..ray })).whole
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pinhole_derivatives::PinholeDerivatives;
    use crate::shared_rays::tests::{film, left_of};

    const RADIUS: f64 = 3.6;
    const SIZE: [usize; 2] = [24, 3];

    /// The film of an upright edge, bright on its left, and what it is between its pixels.
    fn edge(film: &UnblurredFilm, at: f64) -> (Vec<f64>, HalfPixels) {
        let columns = film.size()[0];
        let share = |from: f64, width: f64| ((at - from) / width).clamp(0.0, 1.0);
        let of_pixel = |pixel: usize| {
            let left = (pixel % columns) as f64;
            let [own, first, second] = [share(left, 1.0), share(left, 0.5), share(left + 0.5, 0.5)];
            (own, [first - own, second - own, first - own, second - own])
        };
        let values: Vec<f64> = (0..film.pixel_count()).map(|pixel| of_pixel(pixel).0).collect();
        let divided = (0..film.pixel_count()).filter(|pixel| (pixel % columns) as f64 == at.floor());
        let mut half = HalfPixels::new(film, divided.map(|pixel| (pixel, of_pixel(pixel).1)).collect());
        half.refine(&values);
        (values, half)
    }

    #[test]
    fn edges_are_blurred_with_a_third_of_the_error() {
        let film = film([RADIUS; 2], SIZE);
        let (columns, derivatives) = (film.size()[0], PinholeDerivatives::zero(&film));
        let [mut before, mut after, mut mean] = [0.0; 3];
        for step in 0..40 {
            let at = 15.0 + f64::from(step) * 0.025;
            let (values, half) = edge(&film, at);
            let blurred = film.picture(&values, &derivatives).values;
            let mut added = vec![0.0; film.pixel_count()];
            half.add_blurred(&film, &mut added);
            for pixel in (0..film.pixel_count()).filter(|pixel| film.in_picture(*pixel).is_some()) {
                let steps = 100;
                let place = |step: i32| (pixel % columns) as f64 + (f64::from(step) + 0.5) / f64::from(steps);
                let exact = (0..steps).map(|step| left_of(RADIUS, at - place(step))).sum::<f64>() / f64::from(steps);
                before += (blurred[pixel] - exact).powi(2);
                after += (blurred[pixel] + added[pixel] - exact).powi(2);
                mean += added[pixel];
            }
        }
        assert!(after.sqrt() < before.sqrt() / 3.0, "{} instead of {}", after.sqrt(), before.sqrt());
        assert!(mean.abs() / (40.0 * 72.0) < 2e-4, "{mean}");
    }

    /// What is blurred is the mean over the pinhole of what is predicted for its points.
    #[test]
    fn the_blurred_surplus_is_the_mean_of_what_is_predicted() {
        let film = film([RADIUS; 2], SIZE);
        let (_, half) = edge(&film, 15.3);
        let mut picture = vec![0.0; film.pixel_count()];
        half.add_blurred(&film, &mut picture);
        let points = 1 << 14;
        let of_point = |pixel: usize, index: u32| {
            let u =
                [(f64::from(index) + 0.5) / f64::from(points), (f64::from(index) * 0.754_877_666_246_692_8).fract()];
            half.at(pixel, film.shift() * DVec2::from(unit_disk(u[0], u[1])))
        };
        for pixel in (0..picture.len()).filter(|pixel| film.in_picture(*pixel).is_some()) {
            let mean = (0..points).map(|index| of_point(pixel, index)).sum::<f64>() / f64::from(points);
            assert!((picture[pixel] - mean).abs() < 1e-4, "{} for {mean}", picture[pixel]);
        }
        assert!(picture.iter().any(|value| value.abs() > 1e-3));
    }
}
