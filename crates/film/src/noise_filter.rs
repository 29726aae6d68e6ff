//! Averages samples of an interpolated picture that agree within their noise.
//!
//! The noise is known from pixels with several rays, and pooled over the samples around a pixel that
//! see the same surface (non-local means: Buades, Coll and Morel 2005; Rousselle, Knaus and Zwicker
//! 2012).

use crate::interpolated::Block;
use crate::pixel_sample::{SEVERAL, Sample, mean};
use rayon::prelude::*;
use std::ops::Range;

/// Radius of the filter, in steps of the grid.
const FILTER_RADIUS: usize = 2;

/// The minimum weight of samples one step away.
const ADJACENT_WEIGHT: f64 = 4.0;

/// Width of the square around a pixel, in steps of the grid; the number of places in it, and the
/// pixel's own.
const WIDTH: usize = 2 * FILTER_RADIUS + 1;
const PLACES: usize = WIDTH * WIDTH;
const OWN_PLACE: usize = PLACES / 2;

/// The weight of the distance of a column or row of the square.
const WEIGHTS: [f64; WIDTH] = [1.0, 2.0, 3.0, 2.0, 1.0];

impl Block<'_> {
    /// The values of all samples, each averaged with those around it; black between them.
    pub(crate) fn all_averaged(&self) -> Vec<[f64; 3]> {
        let all = || (0..self.samples.len()).into_par_iter().with_min_len(256);
        let several: Vec<bool> = all().map(|at| self.samples[at].is_some_and(|sample| sample.rays > 1)).collect();
        let later: Vec<Later> = all().map(|at| self.later(&several, at)).collect();
        let patches: Vec<Patch> = all().map(|at| self.patch((&several, &later), at)).collect();
        all().map(|at| self.averaged(&patches, at)).collect()
    }

    /// The spacing of the finest grid that has samples next to a pixel.
    fn step_around(&self, (column, row): (usize, usize)) -> usize {
        let spacing = usize::from(self.spacing[self.at((column, row))]);
        let has = |x: usize, y: usize| x < self.camera.columns() && y < self.rows && self.sampled((x, y)).is_some();
        let mut step = 1;
        while step < spacing
            && !has(column + step, row)
            && !has(column, row + step)
            && !has(column.wrapping_sub(step), row)
            && !has(column, row.wrapping_sub(step))
        {
            step *= 2;
        }
        step.max(1)
    }

    /// The step of a pixel's square, and the places of it that lie inside of the picture: the columns
    /// and rows, as steps from the pixel.
    fn square(&self, at: usize) -> (usize, [Range<isize>; 2]) {
        let columns = self.camera.columns();
        let (column, row) = (at % columns, at / columns);
        let step = self.step_around((column, row));
        let steps = |place: usize, count: usize| {
            let before = (place / step).min(FILTER_RADIUS) as isize;
            let after = ((count - 1 - place) / step).min(FILTER_RADIUS) as isize;
            -before..after + 1
        };
        (step, [steps(column, columns), steps(row, self.rows)])
    }

    /// The places of a square with their pixels.
    #[inline]
    fn places(
        &self,
        at: usize,
        (step, [columns, rows]): (usize, [Range<isize>; 2]),
    ) -> impl Iterator<Item = (usize, usize)> + use<'_> {
        let width = self.camera.columns();
        rows.flat_map(move |down| {
            let first = at.wrapping_add_signed(down * (step * width) as isize);
            let place = ((down + FILTER_RADIUS as isize) * WIDTH as isize + FILTER_RADIUS as isize) as usize;
            let columns = columns.clone();
            columns
                .map(move |right| (place.wrapping_add_signed(right), first.wrapping_add_signed(right * step as isize)))
        })
    }

    /// Which later samples of its square see the same surface as a pixel whose square has the step 1
    /// and known noise.
    fn later(&self, several: &[bool], at: usize) -> Later {
        let Some(own) = self.single_surface(at) else { return Later::UNKNOWN };
        let (step, square) = self.square(at);
        if step > 1 || !self.places(at, (step, square.clone())).any(|(_, other)| several[other]) {
            return Later::UNKNOWN;
        }
        let mut later = 0;
        for (place, other) in self.places(at, (step, square)).filter(|(place, _)| *place > OWN_PLACE) {
            let joins = self.samples[other].as_ref().is_some_and(|near| own.surface.joins(&near.surface));
            later |= u16::from(joins) << (place - OWN_PLACE - 1);
        }
        Later(later)
    }

    /// The sample of a pixel that sees a single surface.
    fn single_surface(&self, at: usize) -> Option<&Sample> {
        self.samples[at].as_ref().filter(|sample| sample.surface.key != SEVERAL)
    }

    /// The samples around a pixel that see the same surface, if the noise of any is known.
    fn neighbors(&self, (several, later): (&[bool], &[Later]), at: usize) -> Neighbors {
        let none = Neighbors::default();
        let Some(own) = self.single_surface(at) else { return none };
        let (step, square) = self.square(at);
        let is_known = later[at].is_known();
        // With the step 1 it would be known.
        if !is_known && (step == 1 || !self.places(at, (step, square.clone())).any(|(_, other)| several[other])) {
            return none;
        }
        let mut places = 1 << OWN_PLACE;
        for (place, other) in self.places(at, (step, square)) {
            let Some(near) = &self.samples[other] else { continue };
            // Between samples that are not adjacent light may change arbitrarily, unless they agree.
            let joins = || own.surface.joins(&near.surface) && (step == 1 || self.agree(own, near));
            let joins = match place {
                OWN_PLACE => true,
                // Two samples join each other.
                ..OWN_PLACE if is_known && later[other].is_known() => later[other].holds(PLACES - 1 - place),
                OWN_PLACE.. if is_known => later[at].holds(place),
                _ => joins(),
            };
            places |= u32::from(joins) << place;
        }
        Neighbors { places, step: step as u32 }
    }

    /// Calls `visit` for the neighbours of a pixel, with their index and the weight of their
    /// distance.
    #[inline]
    fn for_each_neighbor(&self, at: usize, neighbors: Neighbors, mut visit: impl FnMut(usize, &Sample, f64)) {
        let (step, columns) = (neighbors.step as isize, self.camera.columns() as isize);
        let mut left = neighbors.places;
        while left != 0 {
            let place = left.trailing_zeros() as usize;
            left &= left - 1;
            let [down, right] = [place / WIDTH, place % WIDTH].map(|steps| steps as isize - FILTER_RADIUS as isize);
            let other = at.wrapping_add_signed(step * (down * columns + right));
            if let Some(near) = &self.samples[other] {
                visit(other, near, WEIGHTS[place / WIDTH] * WEIGHTS[place % WIDTH]);
            }
        }
    }

    /// The combined statistics of the samples around a pixel.
    fn patch(&self, known: (&[bool], &[Later]), at: usize) -> Patch {
        let neighbors = self.neighbors(known, at);
        let Some(sample) = self.samples[at].as_ref().filter(|_| neighbors.places != 0) else { return Patch::default() };
        let (mut variance, mut weights) = (0.0, 0.0);
        let (mut sum, mut near) = (0.0, 0.0);
        self.for_each_neighbor(at, neighbors, |_, other, weight| {
            let rays = f64::from(other.rays);
            if other.rays > 1 {
                variance += weight * (rays - 1.0) * other.variance * rays;
                weights += weight * (rays - 1.0);
            }
            if weight >= ADJACENT_WEIGHT {
                sum += rays * mean(&other.value);
                near += rays;
            }
        });
        if weights <= 0.0 || near <= 0.0 {
            return Patch::default();
        }
        let variance = variance / weights;
        let own = variance / f64::from(sample.rays);
        Patch { variance: own, mean: sum / near, variance_of_mean: variance / near, neighbors }
    }

    /// The mean of a sample and of those around it that see the same surface and differ by no more
    /// than noise, as samples and as patches.
    fn averaged(&self, patches: &[Patch], at: usize) -> [f64; 3] {
        let Some(sample) = &self.samples[at] else { return [0.0; 3] };
        let patch = &patches[at];
        if patch.variance <= 0.0 {
            return sample.value;
        }
        let (mut sum, mut weights) = ([0.0; 3], 0.0);
        self.for_each_neighbor(at, patch.neighbors, |index, other, weight| {
            let near = &patches[index];
            let own = (mean(&sample.value) - mean(&other.value)).powi(2) / (patch.variance + near.variance);
            let together = (patch.mean - near.mean).powi(2) / (patch.variance_of_mean + near.variance_of_mean);
            let difference = if index == at { 0.0 } else { 0.5 * own.max(together) };
            let weight = weight * f64::from(other.rays) / (1.0 + difference.powi(2));
            sum = std::array::from_fn(|band| sum[band] + weight * other.value[band]);
            weights += weight;
        });
        sum.map(|band| band / weights)
    }
}

/// The samples around a pixel with which it is averaged.
#[derive(Clone, Copy, Debug, Default)]
struct Neighbors {
    /// A bit for each place in the square around it.
    places: u32,
    /// A step of the pixel's grid, pixels.
    step: u32,
}

/// The later samples of the square around a pixel that see the same surface, a bit for each place
/// after its own: the others know of the earlier ones.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Later(u16);

impl Later {
    const UNKNOWN: Later = Later(u16::MAX);

    fn is_known(self) -> bool {
        self != Later::UNKNOWN
    }

    fn holds(self, place: usize) -> bool {
        self.0 >> (place - OWN_PLACE - 1) & 1 == 1
    }
}

/// Statistics of a sample and its adjacent samples.
#[derive(Clone, Copy, Debug, Default)]
struct Patch {
    /// Squared standard error of a single sample, from the variance of adjacent rays; 0 if unknown.
    variance: f64,
    mean: f64,
    variance_of_mean: f64,
    neighbors: Neighbors,
}
