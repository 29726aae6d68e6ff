//! Averages samples of an interpolated picture that agree within their noise.
//!
//! The noise is known from pixels with several rays, and pooled over the samples around a pixel that
//! see the same surface (non-local means: Buades, Coll and Morel 2005; Rousselle, Knaus and Zwicker
//! 2012).

use crate::interpolated::Block;
use crate::pixel_sample::{SEVERAL, Sample, mean};
use rayon::prelude::*;

/// Radius of the filter, in steps of the grid.
const FILTER_RADIUS: usize = 2;

/// The minimum weight ([`Steps`]) of samples one step away.
const ADJACENT_WEIGHT: f64 = 4.0;

impl Block<'_> {
    /// The values of all samples, each averaged with those around it; black between them.
    pub(crate) fn all_averaged(&self) -> Vec<[f64; 3]> {
        let all = || (0..self.samples.len()).into_par_iter().with_min_len(256);
        let patches: Vec<Patch> = all().map(|at| self.patch(at)).collect();
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

    /// Calls `visit` for the samples on the grid of a pixel, up to two steps away, with their place
    /// in the square around it and the weight of their distance; includes the pixel.
    #[inline]
    fn for_each_around(&self, at: usize, mut visit: impl FnMut(u32, usize, &Sample, Steps)) {
        let columns = self.camera.columns();
        let (column, row) = (at % columns, at / columns);
        let step = self.step_around((column, row));
        // The steps that stay inside of the picture.
        let steps = |place: usize, count: usize| {
            let before = (place / step).min(FILTER_RADIUS) as isize;
            let after = ((count - 1 - place) / step).min(FILTER_RADIUS) as isize;
            -before..=after
        };
        let weight = |steps: isize| FILTER_RADIUS + 1 - steps.unsigned_abs();
        for down in steps(row, self.rows) {
            let first = row.wrapping_add_signed(down * step as isize) * columns;
            for right in steps(column, columns) {
                let other = first + column.wrapping_add_signed(right * step as isize);
                let Some(near) = &self.samples[other] else { continue };
                let radius = FILTER_RADIUS as isize;
                let place = ((down + radius) * (2 * radius + 1) + right + radius) as u32;
                visit(place, other, near, Steps { step, weight: (weight(right) * weight(down)) as f64 });
            }
        }
    }

    /// The samples around a pixel that see the same surface, if the noise of any is known.
    fn neighbors(&self, at: usize) -> Neighbors {
        let Some(own) = self.samples[at].as_ref().filter(|sample| sample.surface.key != SEVERAL) else {
            return Neighbors::default();
        };
        let mut is_noise_known = false;
        self.for_each_around(at, |_, _, near, _| is_noise_known |= near.rays > 1);
        let mut neighbors = Neighbors::default();
        if is_noise_known {
            self.for_each_around(at, |place, other, near, Steps { step, .. }| {
                // Between samples that are not adjacent light may change arbitrarily, unless they
                // agree.
                let joins = other == at || own.surface.joins(&near.surface) && (step == 1 || self.agree(own, near));
                neighbors.0 |= u32::from(joins) << place;
            });
        }
        neighbors
    }

    /// Calls `visit` for the neighbours of a pixel, with their index and the weight of their
    /// distance.
    #[inline]
    fn for_each_neighbor(&self, at: usize, neighbors: Neighbors, mut visit: impl FnMut(usize, &Sample, f64)) {
        self.for_each_around(at, |place, other, near, Steps { weight, .. }| {
            if neighbors.0 >> place & 1 == 1 {
                visit(other, near, weight);
            }
        });
    }

    /// The combined statistics of the samples around a pixel.
    fn patch(&self, at: usize) -> Patch {
        let neighbors = self.neighbors(at);
        let Some(sample) = self.samples[at].as_ref().filter(|_| neighbors.0 != 0) else { return Patch::default() };
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

/// The position of a sample relative to a pixel.
#[derive(Clone, Copy, Debug)]
struct Steps {
    /// A step of the pixel's grid, pixels.
    step: usize,
    /// The weight of the distance; [`ADJACENT_WEIGHT`] or more one step away.
    weight: f64,
}

/// The samples around a pixel with which it is averaged: a bit for each place in the square around
/// it.
#[derive(Clone, Copy, Debug, Default)]
struct Neighbors(u32);

/// Statistics of a sample and its adjacent samples.
#[derive(Clone, Copy, Debug, Default)]
struct Patch {
    /// Squared standard error of a single sample, from the variance of adjacent rays; 0 if unknown.
    variance: f64,
    mean: f64,
    variance_of_mean: f64,
    neighbors: Neighbors,
}
