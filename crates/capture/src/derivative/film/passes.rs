//! Passes of samples over a film.

use super::kernel::PixelKernel;
use super::strata::{SlopeSums, Strata, Stratum};
use super::velocity::FilmVelocity;
use crate::derivative::derivative_picture::{
    Derivative, WINDOW, mean, mean_and_squared_error, pooled, relative_to, signal,
};
use crate::derivative::pixel_derivative::StepWorkers;
use crate::derivative::ray_index::MAX_FILM_PASSES;
use crate::derivative::{ParameterStep, RANDOMISATIONS};
use crate::film::UnblurredFilm;
use crate::neighbourhood::window_means;
use crate::radiance::radiance;
use crate::{Exposer, Progress, Workers};
use glam::{DMat2, DVec2};
use radsight_sampling::{DimensionSet, RaySampler, unit_disk};
use rayon::prelude::*;
use std::ops::Range;

/// Passes after which the error may be believed.
const MIN_PASSES: usize = 3;

/// Maximum number of samples by pixel of the picture and randomisation.
const MOST_SAMPLES_PER_PIXEL: f64 = 16_384.0;

/// Samples of a pass relative to those of the last one.
const GROWTH: [f64; 2] = [0.5, 2.0];

/// More samples than the error asks for, since it is an estimate itself.
const MARGIN: f64 = 1.1;

/// Passes with fewer samples than this part of the largest one's are not used: they knew too little.
const USED_PART: f64 = 1.0 / 8.0;

/// Samples that estimate the error of the step, as a part of those of the last pass.
const STEP_PART: f64 = 0.25;

/// Parts of the film that are exposed side by side.
const PARTS: usize = 8;

/// The passes over a film.
pub(super) struct Passes<'a> {
    pub(super) step: &'a ParameterStep<'a>,
    pub(super) film: &'a UnblurredFilm,
    pub(super) velocity: &'a FilmVelocity,
    pub(super) kernel: &'a PixelKernel,
    pub(super) progress: &'a dyn Progress,
    /// Number of rays.
    pub(super) traced: u64,
}

/// What a pass finds.
struct PassPictures {
    /// The derivative of the exposure of each pixel, by randomisation.
    slopes: Vec<Vec<f64>>,
    /// The exposure.
    exposure: Vec<f64>,
    /// Samples of each randomisation.
    samples: f64,
}

impl PassPictures {
    /// Larger passes know more, so a sample of theirs has less noise.
    fn weight(&self) -> f64 {
        self.samples * self.samples
    }
}

/// Rows of a picture that some strata expose.
struct ExposedRows {
    first: usize,
    slopes: Vec<f64>,
    exposure: Vec<f64>,
}

/// The derivative by passes.
struct PassEstimate {
    values: Vec<f64>,
    squared_errors: Vec<f64>,
    /// Rms of the derivative.
    size: f64,
}

impl PassEstimate {
    fn relative_error(&self) -> f64 {
        relative_to(mean(&self.squared_errors), self.size)
    }
}

impl Passes<'_> {
    pub(super) fn until_error(&mut self, error: f64) -> Option<Derivative> {
        let mut strata = Strata::new(self.film, self.velocity);
        let (mut passes, mut number, mut samples) = (Vec::new(), 0, 0.0);
        let most = MOST_SAMPLES_PER_PIXEL * self.film.picture_pixels() as f64;
        let estimate = loop {
            let (pass, sums) = self.pass(self.step, &strata, number)?;
            let last = pass.samples;
            (number, samples) = (number + 1, samples + last);
            passes.push(pass);
            forget_small_passes(&mut passes);
            let estimate = self.estimate(&passes);
            let relative = estimate.relative_error();
            if number >= MIN_PASSES && relative <= error || samples >= most || number == MAX_FILM_PASSES {
                break estimate;
            }
            strata.divide(&sums);
            let missing = samples * (MARGIN * (relative / error).powi(2) - 1.0);
            strata.distribute(missing.clamp(GROWTH[0] * last, GROWTH[1] * last).min(most));
        };
        let step_error = relative_to(self.squared_step_error(&mut strata)?, estimate.size);
        Some(Derivative {
            relative_error: estimate.relative_error(),
            step_error,
            standard_errors: estimate.squared_errors.iter().map(|squared| squared.sqrt()).collect(),
            values: estimate.values,
            rays: self.traced,
            outline_pixels: self.velocity.moving_pixels(),
        })
    }

    /// The mean of passes, with weights that do not depend on what they found.
    fn estimate(&self, passes: &[PassPictures]) -> PassEstimate {
        let total: f64 = passes.iter().map(PassPictures::weight).sum();
        let pixels = self.film.picture_pixels();
        let mean_of = |picture: &dyn Fn(&PassPictures) -> f64| {
            passes.iter().map(|pass| pass.weight() * picture(pass)).sum::<f64>() / total
        };
        let slope = |randomisation: usize, pixel: usize| mean_of(&|pass| pass.slopes[randomisation][pixel]);
        let of_pixel = |pixel: usize| {
            let slopes: [f64; RANDOMISATIONS as usize] =
                std::array::from_fn(|randomisation| slope(randomisation, pixel));
            mean_and_squared_error(&slopes)
        };
        let (values, own): (Vec<f64>, Vec<f64>) = (0..pixels).into_par_iter().map(of_pixel).unzip();
        let columns = self.step.center.rays.camera().columns() as usize;
        let near = window_means(&own, columns, WINDOW);
        let squared_errors: Vec<f64> = own.iter().zip(near).map(|(own, near)| pooled(*own, near)).collect();
        let exposures: Vec<f64> = (0..pixels).map(|pixel| mean_of(&|pass| pass.exposure[pixel])).collect();
        let size = signal((&values, &exposures), &squared_errors, self.step.step).sqrt();
        PassEstimate { values, squared_errors, size }
    }

    /// Mean squared error due to the finite step: a third of the difference from twice the step, with
    /// the same samples. Products of independent randomisations have no noise in the mean.
    fn squared_step_error(&mut self, strata: &mut Strata) -> Option<f64> {
        let Some(doubled) = self.step.doubled() else { return Some(0.0) };
        strata.distribute(STEP_PART * strata.samples());
        let (near, _) = self.pass(self.step, strata, MAX_FILM_PASSES)?;
        let (far, _) = self.pass(&doubled, strata, MAX_FILM_PASSES)?;
        let of_pixel = |pixel: usize| {
            let slopes: [f64; RANDOMISATIONS as usize] = std::array::from_fn(|randomisation| {
                (far.slopes[randomisation][pixel] - near.slopes[randomisation][pixel]) / 3.0
            });
            let (mean, squared_error) = mean_and_squared_error(&slopes);
            mean * mean - squared_error
        };
        let squares: Vec<f64> = (0..self.film.picture_pixels()).map(of_pixel).collect();
        Some(mean(&squares).max(0.0))
    }

    /// One pass, with what it learns of the quarters of strata. `None` if the work was stopped.
    fn pass(
        &mut self,
        step: &ParameterStep<'_>,
        strata: &Strata,
        number: usize,
    ) -> Option<(PassPictures, Vec<[SlopeSums; 4]>)> {
        let parts = parts(&strata.all);
        let tasks: Vec<(u32, &Range<usize>)> =
            (0..RANDOMISATIONS).flat_map(|randomisation| parts.iter().map(move |part| (randomisation, part))).collect();
        let expose = |workers: &mut StepWorkers<'_>, (randomisation, part): (u32, &Range<usize>)| {
            let sequence = (number as u64) * u64::from(RANDOMISATIONS) + u64::from(randomisation);
            self.expose(step, workers, (&strata.all, part), sequence)
        };
        let found: Vec<(ExposedRows, Vec<[SlopeSums; 4]>)> =
            tasks.par_iter().map_init(|| step.step_workers(), |workers, task| expose(workers, *task)).collect();
        if self.progress.stops() {
            return None;
        }
        let pixels = self.film.picture_pixels();
        let columns = step.center.rays.camera().columns() as usize;
        let mut slopes = vec![vec![0.0; pixels]; RANDOMISATIONS as usize];
        let mut exposure = vec![0.0; pixels];
        let mut sums = vec![[SlopeSums::default(); 4]; strata.all.len()];
        for ((randomisation, part), (rows, found)) in tasks.iter().zip(&found) {
            let first = rows.first * columns;
            add(&mut slopes[*randomisation as usize][first..], &rows.slopes);
            add(&mut exposure[first..], &rows.exposure);
            for (sums, found) in sums[(*part).clone()].iter_mut().zip(found) {
                sums.iter_mut().zip(found).for_each(|(sum, found)| sum.add(found));
            }
        }
        exposure.iter_mut().for_each(|value| *value /= f64::from(RANDOMISATIONS));
        let samples = strata.samples();
        self.traced += 2 * u64::from(RANDOMISATIONS) * samples as u64;
        self.progress.report(self.traced, self.traced);
        Some((PassPictures { slopes, exposure, samples }, sums))
    }

    /// The light of some strata in one randomisation.
    fn expose(
        &self,
        step: &ParameterStep<'_>,
        workers: &mut StepWorkers<'_>,
        (strata, part): (&[Stratum], &Range<usize>),
        sequence: u64,
    ) -> (ExposedRows, Vec<[SlopeSums; 4]>) {
        let camera = step.center.rays.camera();
        let cells = camera.pixel_count();
        let mut rows = self.rows_of(&strata[part.clone()]);
        let mut learned = Vec::with_capacity(part.len());
        for (number, stratum) in part.clone().zip(&strata[part.clone()]) {
            let mut quarters = [SlopeSums::default(); 4];
            if self.progress.stops() {
                break;
            }
            let weight = camera.exposure_per_radiance() * stratum.area() / f64::from(stratum.samples);
            for sample in 0..stratum.samples {
                // Strata a picture apart share a scramble.
                let index = step.index_of_pass(sequence, number as u64 % cells, sample);
                let u = RaySampler::new(step.center.rays.seed(), index).take(DimensionSet::CAMERA);
                let at = DVec2::new(u[0], u[1]);
                let moving = self.moving_point(step, workers, (stratum.corner + stratum.side * at, u), index);
                let quarter = at.cmpge(DVec2::splat(0.5));
                quarters[usize::from(quarter.x) + 2 * usize::from(quarter.y)]
                    .add(&moving.sums(step.step, self.film.shift()));
                self.spread(&moving, (weight, step.step), &mut rows);
            }
            learned.push(quarters);
        }
        learned.resize(part.len(), [SlopeSums::default(); 4]);
        (rows, learned)
    }

    fn rows_of(&self, strata: &[Stratum]) -> ExposedRows {
        let camera = self.step.center.rays.camera();
        let (columns, rows) = (camera.columns() as usize, camera.rows() as usize);
        // A point moves by less than a pixel over a step.
        let reach = self.kernel.reach().y + 1.0;
        let row = |on_film: f64| ((on_film - self.film.margins().y).max(0.0) as usize).min(rows);
        let top = strata.iter().map(|stratum| stratum.corner.y).fold(f64::INFINITY, f64::min);
        let bottom = strata.iter().map(|stratum| stratum.corner.y + stratum.side).fold(0.0, f64::max);
        let first = row(top - reach);
        let pixels = row(bottom + reach + 1.0).saturating_sub(first) * columns;
        ExposedRows { first, slopes: vec![0.0; pixels], exposure: vec![0.0; pixels] }
    }

    /// The light of a moving point on both sides of the step.
    fn moving_point(
        &self,
        step: &ParameterStep<'_>,
        workers: &mut StepWorkers<'_>,
        (point, u): (DVec2, [f64; 4]),
        index: u64,
    ) -> MovingPoint {
        let (velocity, by_point) = self.velocity.at(point);
        let (shift, stretch) = (velocity * step.step, by_point * step.step);
        let on_pinhole = unit_disk(u[2], u[3]).into();
        let light = |side: &Exposer<'_>, worker: &mut Workers<'_>, at: DVec2| {
            let Some(seen) = self.film.ray_to_point(side.rays, at, on_pinhole) else { return 0.0 };
            seen.ray.cos4 * radiance(worker, index, (side.rays, 0), &seen.ray, side.weights)
        };
        let [before, after] = workers.sides();
        let below = light(&step.below, before, point - shift) * (DMat2::IDENTITY - stretch).determinant();
        let above = light(&step.above, after, point + shift) * (DMat2::IDENTITY + stretch).determinant();
        MovingPoint { point: self.film.picture_point(point), shift, below, above }
    }

    /// Adds the light of a moving point to the pixels that see it.
    fn spread(&self, moving: &MovingPoint, (weight, step): (f64, f64), rows: &mut ExposedRows) {
        let MovingPoint { point, shift, below, above } = *moving;
        let columns = self.step.center.rays.camera().columns() as usize;
        let reach = self.kernel.reach() + shift.abs();
        let end = (rows.first + rows.slopes.len() / columns) as f64;
        let range = |at: f64, reach: f64, first: f64, end: f64| {
            let from = (at - 0.5 - reach).ceil().max(first);
            from as usize..(((at - 0.5 + reach).floor() + 1.0).min(end).max(from) as usize)
        };
        let (scale, half) = (weight / (2.0 * step), 0.5 * weight);
        for row in range(point.y, reach.y, rows.first as f64, end) {
            for column in range(point.x, reach.x, 0.0, columns as f64) {
                let offset = point - DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
                let below = below * self.kernel.at(offset - shift);
                let above = above * self.kernel.at(offset + shift);
                let pixel = (row - rows.first) * columns + column;
                rows.slopes[pixel] += scale * (above - below);
                rows.exposure[pixel] += half * (above + below);
            }
        }
    }
}

/// Removes the passes that are not used.
fn forget_small_passes(passes: &mut Vec<PassPictures>) {
    let most = passes.iter().map(|pass| pass.samples).fold(0.0, f64::max);
    passes.retain(|pass| pass.samples >= USED_PART * most);
}

/// A point of the film that moves, and its light on both sides of the step.
struct MovingPoint {
    /// At the parameter's value, pixels from the left and the top of the picture.
    point: DVec2,
    /// Its motion over the step, pixels.
    shift: DVec2,
    below: f64,
    above: f64,
}

impl MovingPoint {
    fn sums(&self, step: f64, radius: DVec2) -> SlopeSums {
        let slope = (self.above - self.below) / (2.0 * step);
        let shifted = 0.5 * (self.above + self.below) * (self.shift / (step * radius)).length();
        SlopeSums::of_sample(slope, shifted)
    }
}

fn add(sums: &mut [f64], added: &[f64]) {
    sums.iter_mut().zip(added).for_each(|(sum, added)| *sum += added);
}

/// Ranges of strata with about equally many samples.
fn parts(strata: &[Stratum]) -> Vec<Range<usize>> {
    let total: u64 = strata.iter().map(|stratum| u64::from(stratum.samples)).sum();
    let (mut parts, mut first, mut sum) = (Vec::new(), 0, 0);
    for (index, stratum) in strata.iter().enumerate() {
        sum += u64::from(stratum.samples);
        if sum * PARTS as u64 >= total * (parts.len() as u64 + 1) {
            parts.push(first..index + 1);
            first = index + 1;
        }
    }
    parts
}
