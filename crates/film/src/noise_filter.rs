//! Averages samples of an interpolated picture that agree within their noise.
//!
//! The noise is known from pixels with several rays, and pooled over the samples around a pixel that
//! see the same surface (non-local means: Buades, Coll and Morel 2005; Rousselle, Knaus and Zwicker
//! 2012).
//!
//! An outlier, such as the sun in a mirror that one ray of a pixel met, stays in its pixel: the
//! variance of its rays would otherwise let all samples around it agree with it.

use crate::interpolated::Block;
use crate::pixel_sample::{SEVERAL, Sample, mean};
use rayon::prelude::*;

/// Radius of the filter, in steps of the grid.
const FILTER_RADIUS: usize = 2;

/// The minimum distance of an outlier from the samples around it, relative to their range.
const OUTLIER_DISTANCE: f64 = 10.0;

/// The minimum weight of samples one step away.
const ADJACENT_WEIGHT: f64 = 4.0;

/// Width of the square around a pixel, in steps of the grid; the number of places in it, and the
/// pixel's own.
const WIDTH: usize = 2 * FILTER_RADIUS + 1;
const PLACES: usize = WIDTH * WIDTH;
const OWN_PLACE: usize = PLACES / 2;

/// The row and the column of each place.
const POSITIONS: [[u8; 2]; PLACES] = {
    let mut positions = [[0; 2]; PLACES];
    let mut place = 0;
    while place < PLACES {
        positions[place] = [(place / WIDTH) as u8, (place % WIDTH) as u8];
        place += 1;
    }
    positions
};

/// The first place of each row.
const FIRST_COLUMN: u32 = 0b00001_00001_00001_00001_00001;

/// The places before a pixel's own.
const EARLIER: u32 = (1 << OWN_PLACE) - 1;

/// The weight of each place by its distance: a product of those of its row and of its column.
const WEIGHTS: [f64; PLACES] = {
    const ALONG: [f64; WIDTH] = [1.0, 2.0, 3.0, 2.0, 1.0];
    let mut weights = [0.0; PLACES];
    let mut place = 0;
    while place < PLACES {
        weights[place] = ALONG[place / WIDTH] * ALONG[place % WIDTH];
        place += 1;
    }
    weights
};

impl Block<'_> {
    /// The values of all samples, each averaged with those around it.
    pub(crate) fn all_averaged(&self) -> Vec<[f64; 3]> {
        let all = || (0..self.samples.count()).into_par_iter().with_min_len(256);
        let noise = KnownNoise::of(self);
        let later: Vec<Later> = all().map(|index| self.later(&noise, index)).collect();
        let mut results: Vec<PixelResult> = self.samples.iter().map(PixelResult::of).collect();
        let neighbors = |index: usize| self.neighbors((&noise, &later), index);
        let mut patches: Vec<Patch> = all().map(|index| self.patch(neighbors(index), &results, index)).collect();
        let outliers: Vec<usize> = all().filter(|index| self.is_outlier((&results, &patches), *index)).collect();
        if !outliers.is_empty() {
            outliers.iter().for_each(|index| results[*index].rays = 0.0);
            patches.par_iter_mut().with_min_len(256).enumerate().for_each(|(index, patch)| {
                let mut has_outlier = false;
                self.for_each_neighbor(index, patch.neighbors, |place, _| has_outlier |= results[place].rays == 0.0);
                if has_outlier {
                    *patch = self.patch(patch.neighbors, &results, index);
                }
            });
        }
        all().map(|index| self.averaged((&results, &patches), index)).collect()
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

    /// The square around a pixel.
    fn square(&self, at: usize) -> Square {
        let columns = self.camera.columns();
        let (column, row) = (at % columns, at / columns);
        let step = self.step_around((column, row));
        let reach = |place: usize, count: usize| {
            let before = (place / step).min(FILTER_RADIUS);
            (FILTER_RADIUS - before, before + ((count - 1 - place) / step).min(FILTER_RADIUS) + 1)
        };
        let ((left, width), (top, height)) = (reach(column, columns), reach(row, self.rows));
        let in_columns = (((1 << width) - 1) << left) * FIRST_COLUMN;
        let in_rows = ((1 << (height * WIDTH)) - 1) << (top * WIDTH);
        Square { at, step, places: in_columns & in_rows }
    }

    /// Some places of a square with their pixels.
    #[inline]
    fn pixels_at(&self, square: &Square, places: u32) -> impl Iterator<Item = (usize, usize)> + use<> {
        let (step, row) = (square.step, square.step * self.camera.columns());
        // The first place may lie before the picture.
        let first = square.at.wrapping_sub(FILTER_RADIUS * (row + step));
        let mut left = places;
        std::iter::from_fn(move || {
            let place = left.trailing_zeros() as usize;
            left &= left.checked_sub(1)?;
            let [down, right] = POSITIONS[place].map(usize::from);
            Some((place, first.wrapping_add(down * row + right * step)))
        })
    }

    /// Whether the noise of any sample of a square is known.
    fn is_known_in(&self, noise: &KnownNoise, square: &Square) -> bool {
        match square.step {
            1 => noise.near[square.at],
            _ => self.pixels_at(square, square.places).any(|(_, other)| noise.own[other]),
        }
    }

    /// Which later samples of its square see the same surface as a sample whose square has the step
    /// 1 and known noise.
    fn later(&self, noise: &KnownNoise, index: usize) -> Later {
        let (at, own) = self.samples.numbered(index);
        if own.surface.key == SEVERAL || !noise.near[at] {
            return Later::UNKNOWN;
        }
        let square = self.square(at);
        if square.step > 1 {
            return Later::UNKNOWN;
        }
        let mut later = 0;
        for (place, other) in self.pixels_at(&square, square.places & !EARLIER & !(1 << OWN_PLACE)) {
            let joins = self.samples.get(other).is_some_and(|near| own.surface.joins(&near.surface));
            later |= u16::from(joins) << (place - OWN_PLACE - 1);
        }
        Later(later)
    }

    /// The samples around a sample that see the same surface, if the noise of any is known.
    fn neighbors(&self, (noise, later): (&KnownNoise, &[Later]), index: usize) -> Neighbors {
        let none = Neighbors::default();
        let (at, own) = self.samples.numbered(index);
        if own.surface.key == SEVERAL {
            return none;
        }
        let square = self.square(at);
        let is_known = later[index].is_known();
        // With the step 1 it would be known.
        if !is_known && (square.step == 1 || !self.is_known_in(noise, &square)) {
            return none;
        }
        let mut places = 1 << OWN_PLACE;
        let mut unknown = square.places & !places;
        if is_known {
            places |= later[index].places();
            unknown &= EARLIER;
        }
        for (place, other) in self.pixels_at(&square, unknown) {
            let Some(other) = self.samples.index(other) else { continue };
            let near = self.samples.numbered(other).1;
            // Between samples that are not adjacent light may change arbitrarily, unless they agree.
            let joins = || own.surface.joins(&near.surface) && (square.step == 1 || self.agree(own, near));
            // Two samples join each other.
            let joins = if is_known && later[other].is_known() {
                later[other].places() >> (PLACES - 1 - place) & 1 == 1
            } else {
                joins()
            };
            places |= u32::from(joins) << place;
        }
        Neighbors { places, step: square.step as u32 }
    }

    /// Calls `visit` for the neighbours of a sample, with their index and the weight of their
    /// distance.
    #[inline]
    fn for_each_neighbor(&self, index: usize, neighbors: Neighbors, mut visit: impl FnMut(usize, f64)) {
        let (at, _) = self.samples.numbered(index);
        let square = Square { at, step: neighbors.step as usize, places: neighbors.places };
        for (place, other) in self.pixels_at(&square, square.places) {
            if let Some(other) = self.samples.index(other) {
                visit(other, WEIGHTS[place]);
            }
        }
    }

    /// The combined statistics of the samples around a sample.
    fn patch(&self, neighbors: Neighbors, results: &[PixelResult], index: usize) -> Patch {
        if neighbors.places == 0 || results[index].rays == 0.0 {
            return Patch::default();
        }
        let (mut variance, mut weights) = (0.0, 0.0);
        let (mut sum, mut near) = (0.0, 0.0);
        self.for_each_neighbor(index, neighbors, |place, weight| {
            let other = &results[place];
            let rays = other.rays;
            if rays > 1.0 {
                variance += weight * (rays - 1.0) * other.variance * rays;
                weights += weight * (rays - 1.0);
            }
            if weight >= ADJACENT_WEIGHT {
                sum += rays * other.mean;
                near += rays;
            }
        });
        if weights <= 0.0 || near <= 0.0 {
            return Patch::default();
        }
        let variance = variance / weights;
        Patch {
            variance: variance / results[index].rays,
            mean: sum / near,
            variance_of_mean: variance / near,
            neighbors,
        }
    }

    /// Whether a sample is far brighter than those around it, and noisier.
    fn is_outlier(&self, (results, patches): (&[PixelResult], &[Patch]), index: usize) -> bool {
        let (sample, patch) = (&results[index], &patches[index]);
        if patch.variance <= 0.0 || sample.variance < patch.variance || sample.mean <= patch.mean {
            return false;
        }
        // The darkest, and the brightest two: an outlier may have a twin.
        let (mut dark, mut bright) = (f64::INFINITY, [f64::NEG_INFINITY; 2]);
        self.for_each_neighbor(index, patch.neighbors, |place, _| {
            if place != index {
                let mean = results[place].mean;
                dark = dark.min(mean);
                bright = [bright[0].max(mean), bright[1].max(mean.min(bright[0]))];
            }
        });
        bright[1].is_finite() && sample.mean - bright[1] > OUTLIER_DISTANCE * (bright[1] - dark)
    }

    /// The mean of a sample and of those around it that see the same surface and differ by no more
    /// than noise, as samples and as patches.
    fn averaged(&self, (results, patches): (&[PixelResult], &[Patch]), index: usize) -> [f64; 3] {
        let (sample, patch) = (&results[index], &patches[index]);
        if patch.variance <= 0.0 {
            return sample.value;
        }
        let (mut sum, mut weights) = ([0.0; 3], 0.0);
        self.for_each_neighbor(index, patch.neighbors, |place, weight| {
            let (other, near) = (&results[place], &patches[place]);
            let differences = [sample.mean - other.mean, patch.mean - near.mean];
            let variances = [patch.variance + near.variance, patch.variance_of_mean + near.variance_of_mean];
            // Side by side, since divisions take most of the time.
            let ratios: [f64; 2] = std::array::from_fn(|which| differences[which].powi(2) / variances[which]);
            let larger = if ratios[1] > ratios[0] { ratios[1] } else { ratios[0] };
            let difference = if place == index { 0.0 } else { 0.5 * larger };
            let weight = weight * other.rays / (1.0 + difference.powi(2));
            sum = std::array::from_fn(|band| sum[band] + weight * other.value[band]);
            weights += weight;
        });
        sum.map(|band| band / weights)
    }
}

/// What the filter needs of a sample, which is a third of it: each is read many times.
#[derive(Clone, Copy, Debug)]
struct PixelResult {
    value: [f64; 3],
    /// Over the bands.
    mean: f64,
    /// 0 for an outlier.
    rays: f64,
    /// As [`Sample::variance`].
    variance: f64,
}

impl PixelResult {
    fn of(sample: &Sample) -> PixelResult {
        let Sample { value, variance, .. } = *sample;
        PixelResult { value, mean: mean(&value), rays: f64::from(sample.rays), variance }
    }
}

/// The square around a pixel.
struct Square {
    at: usize,
    /// A step of the pixel's grid, pixels.
    step: usize,
    /// A bit for each place that lies inside of the picture.
    places: u32,
}

/// The pixels with several rays, whose noise is known.
struct KnownNoise {
    own: Vec<bool>,
    /// Whether any pixel of the square with the step 1 has several.
    near: Vec<bool>,
}

impl KnownNoise {
    fn of(block: &Block<'_>) -> KnownNoise {
        let columns = block.camera.columns();
        let mut own = vec![false; columns * block.rows];
        for index in 0..block.samples.count() {
            let (at, sample) = block.samples.numbered(index);
            own[at] = sample.rays > 1;
        }
        // Along the rows, then across them.
        let mut in_row = own.clone();
        for (near, own) in in_row.chunks_mut(columns).zip(own.chunks(columns)) {
            for shift in 1..=FILTER_RADIUS.min(columns - 1) {
                near.iter_mut().zip(&own[shift..]).for_each(|(near, own)| *near |= own);
                near[shift..].iter_mut().zip(own).for_each(|(near, own)| *near |= own);
            }
        }
        let mut near = in_row.clone();
        for shift in (1..=FILTER_RADIUS.min(block.rows - 1)).map(|rows| rows * columns) {
            near.iter_mut().zip(&in_row[shift..]).for_each(|(near, own)| *near |= own);
            near[shift..].iter_mut().zip(&in_row).for_each(|(near, own)| *near |= own);
        }
        KnownNoise { own, near }
    }
}

/// The samples around a sample with which it is averaged.
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

    /// The bits of the square.
    fn places(self) -> u32 {
        u32::from(self.0) << (OWN_PLACE + 1)
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
