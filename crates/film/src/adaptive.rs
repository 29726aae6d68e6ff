//! As many rays as each pixel needs.
//!
//! Samples of pixels are doubled, where that lowers the picture's error most ([`doublings`]), until its estimate is the asked one.
//! It rests on half the difference h of the means of the two halves of a pixel's samples: if the squared error of a mean falls by a factor g with each
//! doubling, so does h², and the squared error of both halves together is h²·g/(1 − g); for independent samples g = ½ and the factor is 1, for those of
//! a low-discrepancy sequence both are smaller. One such difference says little, so the squares of neighbours are averaged, and
//! those of the doubling before count too; g is that of a whole block. What no sample has met so far, such as the corner of a lamp, is expected to be like the
//! neighbour that differs most.
//!
//! Where irradiance is cached, the error of that counts too: single paths tell it, and correct it (`residual.rs`).

use crate::interpolated::{self, Interpolation};
use crate::part::radiance;
use crate::residual::{Judgement, Residuals};
use crate::sequence::{MAX_SAMPLES, SEQUENCE_LOG2};
use crate::view_camera::{CameraRay, ViewCamera, traced};
use radsight_render::{RayWorker, Renderer};
use radsight_sampling::{PixelError, doublings};
use rayon::prelude::*;
use std::ops::Range;

/// Samples of every pixel before anything is decided.
const FIRST_SAMPLES: u32 = 4;

/// Pixels that are finished together; whole rows.
const BLOCK: usize = 1 << 14;

/// Rows that are finished together where pixels are interpolated: that takes some samples of the rows around too. A multiple of every cell's size.
const INTERPOLATED_ROWS: usize = 64;

/// This share of the picture's typical value is added in squares to that of a pixel where an error is taken relative to it: what is darker need not be more exact.
const DARK: f64 = 0.01;

/// Brighter pixels than this many times the median do not count further for what is typical.
const DAZZLING: f64 = 10.0;

/// What of a squared error pixels' own noise may have where irradiance is cached.
const NOISE_SHARE: f64 = 0.4;

/// Where a few pixels have most of the noise, its estimate is uncertain: the target is lowered by this factor until the estimate and one
/// standard error more are within what is asked, down to a share of that.
const STRICTER: f64 = 0.7;
const LEAST_TARGET: f64 = 0.03;

/// What stands for a distance to nothing, as in Radiance.
const NOWHERE: f64 = 1e10;

/// How many rays a pixel gets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SamplingBudget {
    /// As many for each.
    Samples(u32),
    /// As few as the error allows.
    Error {
        /// Estimated error of the picture, `sqrt(mean(d²/(v² + (0.01·m)²)))` over the bands of all pixels: d the error of a value v, m what is
        /// typical of the band. Noise of the pixels, and noise and interpolation bias of cached irradiance together.
        error: f64,
        /// At most so many, at most [`MAX_SAMPLES`].
        most: u32,
    },
    /// As Radiance's options say: what is smooth is interpolated.
    Interpolated(Interpolation),
}

/// One pixel's samples so far.
#[derive(Clone, Copy, Debug, Default)]
struct Pixel {
    sum: [f64; 3],
    samples: u32,
    /// Half differences of the means of halves, for the last two doublings.
    last: [f32; 3],
    before: [f32; 3],
}

impl Pixel {
    fn mean(&self) -> [f64; 3] {
        self.sum.map(|sum| sum / f64::from(self.samples.max(1)))
    }

    /// Takes in the second half of its samples.
    fn double(&mut self, second_half: [f64; 3]) {
        self.before = self.last;
        self.last =
            std::array::from_fn(|band| ((second_half[band] - self.sum[band]) / f64::from(2 * self.samples)) as f32);
        self.sum = std::array::from_fn(|band| self.sum[band] + second_half[band]);
        self.samples *= 2;
    }
}

/// How good a picture is, as far as its own samples tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The error of [`SamplingBudget::Error`] that is left.
    pub error: f64,
    /// With 95 % confidence it is no farther away from this.
    pub uncertainty: f64,
    /// Mean number of rays a pixel.
    pub rays: f64,
    /// What of the error is noise of the pixels' own rays, and what is the error of cached irradiance (`None` where none is cached): their squares add up.
    pub noise: f64,
    /// See `noise`.
    pub cache: Option<f64>,
    /// What stopped the work before the asked error was reached.
    pub stopped: Option<Stop>,
}

/// Why a picture has more error than was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// No pixel may have more rays.
    Rays,
    /// The time was over.
    Time,
}

/// Whether there is time left to work on a block with which this share of the picture is done.
pub type TimeLeft<'t> = dyn Fn(f64) -> bool + Sync + 't;

/// Sums over finished pixels.
#[derive(Clone, Copy, Debug, Default)]
struct Finished {
    pixels: f64,
    rays: f64,
    /// Of squared errors of noise, and of their squares.
    errors: f64,
    squares: f64,
    /// Of squared errors of cached irradiance, and the variance of that sum; `None` where none is cached.
    cached: Option<[f64; 2]>,
    stopped: Option<Stop>,
}

impl Finished {
    fn add(&mut self, error: f64, samples: u32) {
        self.pixels += 1.0;
        self.rays += f64::from(samples);
        self.errors += error;
        self.squares += error * error;
    }

    /// The mean of squared errors of noise, and the variance of that.
    fn noise(&self) -> [f64; 2] {
        let mean = self.errors / self.pixels;
        let spread = (self.squares / self.pixels - mean * mean).max(0.0);
        [mean, spread * SHARING / self.pixels]
    }

    fn add_cached(&mut self, judgement: &Judgement) {
        let [squared, variance] = self.cached.unwrap_or_default();
        self.cached = Some([squared + judgement.squared.max(0.0), variance + judgement.variance]);
    }

    fn estimate(&self) -> Option<Estimate> {
        let [cached, cached_variance] = self.cached.unwrap_or_default().map(|sum| sum / self.pixels);
        let [noise, noise_variance] = self.noise();
        let variance = noise_variance + cached_variance / self.pixels;
        let error = (noise + cached).sqrt();
        let uncertainty = (error * error + CONFIDENCE * variance.sqrt()).sqrt() - error;
        (self.pixels > 0.0).then(|| Estimate {
            error,
            uncertainty,
            rays: self.rays / self.pixels,
            noise: noise.sqrt(),
            cache: self.cached.map(|_| cached.sqrt()),
            stopped: self.stopped,
        })
    }
}

/// Standard errors within which a normally distributed number is in 95 % of all cases.
const CONFIDENCE: f64 = 1.96;

/// So many pixels have one independent estimate: each is a mean over its neighbours (the inverse of the sum of their squared weights).
const SHARING: f64 = 7.1;

/// A picture in the making.
pub struct Film<'r> {
    renderer: &'r Renderer,
    camera: ViewCamera,
    budget: SamplingBudget,
    pixels: Vec<Pixel>,
    /// What is added in squares to the bands of a pixel where an error is taken relative to them.
    floors: [f64; 3],
    finished: Finished,
    /// Squared relative errors of the pixels that are finished, where an error was asked for.
    errors: Vec<f32>,
    /// Rays beside those of the pixels' own samples.
    further_rays: Vec<u32>,
    time_left: Option<Box<TimeLeft<'r>>>,
}

impl std::fmt::Debug for Film<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Film { camera, budget, finished, .. } = self;
        formatter
            .debug_struct("Film")
            .field("camera", camera)
            .field("budget", budget)
            .field("finished", finished)
            .finish_non_exhaustive()
    }
}

impl<'r> Film<'r> {
    /// Begins a picture. With an asked error this traces the first rays of all pixels, to know what is typical.
    #[must_use]
    pub fn new(renderer: &'r Renderer, camera: ViewCamera, budget: SamplingBudget) -> Film<'r> {
        let pixels = vec![Pixel::default(); camera.columns() * camera.rows()];
        let finished = Finished::default();
        let mut frame = Film {
            renderer,
            camera,
            budget,
            pixels,
            floors: [0.0; 3],
            finished,
            errors: Vec::new(),
            further_rays: Vec::new(),
            time_left: None,
        };
        if let SamplingBudget::Error { .. } = budget {
            frame.errors = vec![f32::NAN; frame.pixels.len()];
            frame.further_rays = vec![0; frame.pixels.len()];
            frame.begin();
            frame.floors = typical(&frame.pixels).map(|band| DARK * band);
        }
        frame
    }

    /// Stops work on an asked error where there is no time left.
    #[must_use]
    pub fn while_time_is_left(mut self, time_left: Box<TimeLeft<'r>>) -> Film<'r> {
        self.time_left = Some(time_left);
        self
    }

    /// Pixels in a row.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.camera.columns()
    }

    /// The rows that are finished together with a row: asking for others as well costs nothing, for a part costs as much.
    #[must_use]
    pub fn block_of(&self, row: usize) -> Range<usize> {
        let height = match self.budget {
            SamplingBudget::Interpolated(_) => INTERPOLATED_ROWS,
            _ => (BLOCK / self.camera.columns().max(1)).max(1),
        };
        let first = row - row % height;
        first..(first + height).min(self.camera.rows())
    }

    /// Finishes a block of rows and gives its pixels.
    pub fn finish_block(&mut self, block: Range<usize>) -> Vec<[f32; 3]> {
        let columns = self.camera.columns();
        let range = block.start * columns..block.end * columns;
        match self.budget {
            SamplingBudget::Interpolated(interpolation) => {
                return interpolated::block(self.renderer, &self.camera, interpolation, &block);
            }
            SamplingBudget::Samples(samples) => self.trace_all(range.clone(), samples.clamp(1, MAX_SAMPLES)),
            SamplingBudget::Error { error, most } => return self.finish_to_error(&range, error, most.min(MAX_SAMPLES)),
        }
        self.pixels[range].iter().map(|pixel| pixel.mean().map(|band| band as f32)).collect()
    }

    /// Finishes pixels to an asked error.
    fn finish_to_error(&mut self, range: &Range<usize>, error: f64, most: u32) -> Vec<[f32; 3]> {
        let is_cached = self.renderer.irradiance_noise().is_some();
        let share = if is_cached { NOISE_SHARE } else { 1.0 };
        let pooled = self.reduce_noise(range, share * error * error, most);
        let noise: f64 = pooled.iter().map(|pixel| pixel.squared).sum();
        let judgement = is_cached.then(|| self.correct(range, error * error * range.len() as f64 - noise, most));
        let (mut corrections, mut of_pixels) = (vec![[0.0; 3]; range.len()], vec![0.0; range.len()]);
        if let Some(judgement) = judgement {
            self.finished.add_cached(&judgement);
            (corrections, of_pixels) = (judgement.corrections, judgement.of_pixels);
        }
        for ((index, pixel), of_cache) in range.clone().zip(&pooled).zip(of_pixels) {
            self.finished.add(pixel.squared, pixel.samples + self.further_rays[index]);
            self.errors[index] = (pixel.squared + of_cache) as f32;
        }
        let corrected = |(pixel, correction): (&Pixel, [f64; 3])| {
            let mean = pixel.mean();
            std::array::from_fn(|band| (mean[band] + correction[band]).max(0.0) as f32)
        };
        self.pixels[range.clone()].iter().zip(corrections).map(corrected).collect()
    }

    /// Doubles samples until the pixels' own noise is this, in squares, and one standard error of that more; gives what is left.
    fn reduce_noise(&mut self, range: &Range<usize>, squared: f64, most: u32) -> Vec<PixelError> {
        let mut target = squared;
        loop {
            let pooled = self.pool(range);
            let needed = doublings(&pooled, target, most);
            let chosen: Vec<usize> =
                range.clone().zip(needed).filter(|(_, needed)| *needed > 0.0).map(|(pixel, _)| pixel).collect();
            if chosen.is_empty() {
                let mut found = Finished::default();
                pooled.iter().for_each(|pixel| found.add(pixel.squared, pixel.samples));
                let [mean, variance] = found.noise();
                if mean > squared {
                    self.finished.stopped = self.finished.stopped.or(Some(Stop::Rays));
                } else if mean + variance.sqrt() > squared && target > LEAST_TARGET * squared {
                    target *= STRICTER;
                    continue;
                }
                return pooled;
            }
            if !self.has_time(range) {
                return pooled;
            }
            self.double(&chosen);
        }
    }

    /// Corrects cached irradiance until the sum of squared errors that it leaves is no more than this, as far as can be told.
    fn correct(&mut self, range: &Range<usize>, allowed: f64, most: u32) -> Judgement {
        let units = self.pixels[range.clone()].iter().map(|pixel| self.units(pixel)).collect();
        let mut residuals = Residuals::new(range.clone(), self.camera.columns(), units);
        let mut wanted = residuals.first_pixels();
        loop {
            residuals.trace(self.renderer, &self.camera, &wanted);
            let judgement = residuals.judge(most);
            let is_enough = judgement.upper() <= allowed;
            wanted = if is_enough { Vec::new() } else { judgement.wanted(allowed) };
            if !is_enough && wanted.is_empty() {
                self.finished.stopped = self.finished.stopped.or(Some(Stop::Rays));
            }
            if wanted.is_empty() || !self.has_time(range) {
                for index in range.clone() {
                    self.further_rays[index] = residuals.rays_of(index - range.start);
                }
                return judgement;
            }
        }
    }

    /// Whether there is time left for a block; notes that there is not.
    fn has_time(&mut self, range: &Range<usize>) -> bool {
        let share = range.end as f64 / self.pixels.len() as f64;
        let has_time = self.time_left.as_ref().is_none_or(|time_left| time_left(share));
        if !has_time {
            self.finished.stopped = Some(Stop::Time);
        }
        has_time
    }

    /// What errors of a pixel's bands are relative to.
    fn units(&self, pixel: &Pixel) -> [f64; 3] {
        let mean = pixel.mean();
        std::array::from_fn(|band| mean[band].hypot(self.floors[band]).max(f64::MIN_POSITIVE.sqrt()))
    }

    /// How good the pixels are that are finished; `None` where no error was asked for.
    #[must_use]
    pub fn estimate(&self) -> Option<Estimate> {
        self.finished.estimate()
    }

    /// The standard errors of all pixels, relative to their values: of each the root of the mean of its bands' squares, as
    /// [`SamplingBudget::Error`] counts them. NaN where a pixel is not finished; `None` where no error was asked for.
    #[must_use]
    pub fn relative_errors(&self) -> Option<Vec<f32>> {
        (!self.errors.is_empty()).then(|| self.errors.iter().map(|squared| squared.sqrt()).collect())
    }

    /// How many rays each pixel has; `None` where pixels are interpolated.
    #[must_use]
    pub fn samples(&self) -> Option<Vec<u32>> {
        let is_interpolated = matches!(self.budget, SamplingBudget::Interpolated(_));
        let further = |index: usize| self.further_rays.get(index).copied().unwrap_or(0);
        (!is_interpolated)
            .then(|| self.pixels.iter().enumerate().map(|(index, pixel)| pixel.samples + further(index)).collect())
    }

    /// Distances along the rays through the middles of the pixels of some rows, scene units, by way of mirrors and panes; 1e10 for
    /// nothing.
    #[must_use]
    pub fn depths(&self, rows: Range<usize>) -> Vec<f32> {
        let columns = self.camera.columns();
        let pixels = rows.start * columns..rows.end * columns;
        pixels
            .into_par_iter()
            .with_min_len(64)
            .map_init(
                || self.renderer.worker(),
                |worker, pixel| {
                    let ray = self.camera.central_ray(pixel % columns, pixel / columns);
                    ray.map_or(NOWHERE, |ray| distance(worker, (pixel as u64) << SEQUENCE_LOG2, &ray)) as f32
                },
            )
            .collect()
    }

    fn begin(&mut self) {
        let (renderer, camera) = (self.renderer, self.camera);
        self.pixels.par_iter_mut().enumerate().with_min_len(64).for_each_init(
            || renderer.worker(),
            |worker, (index, pixel)| {
                pixel.samples = 1;
                pixel.sum = sum(worker, &camera, renderer, index, 0..1);
                while pixel.samples < FIRST_SAMPLES {
                    pixel.double(sum(worker, &camera, renderer, index, pixel.samples..2 * pixel.samples));
                }
            },
        );
    }

    fn trace_all(&mut self, range: Range<usize>, samples: u32) {
        let (renderer, camera, first) = (self.renderer, self.camera, range.start);
        self.pixels[range].par_iter_mut().enumerate().with_min_len(16).for_each_init(
            || renderer.worker(),
            |worker, (index, pixel)| {
                pixel.samples = samples;
                pixel.sum = sum(worker, &camera, renderer, first + index, 0..samples);
            },
        );
    }

    fn double(&mut self, chosen: &[usize]) {
        let (renderer, camera, pixels) = (self.renderer, self.camera, &self.pixels);
        let second_halves: Vec<[f64; 3]> = chosen
            .par_iter()
            .with_min_len(4)
            .map_init(
                || renderer.worker(),
                |worker, &index| {
                    let samples = pixels[index].samples;
                    sum(worker, &camera, renderer, index, samples..2 * samples)
                },
            )
            .collect();
        for (&index, second_half) in chosen.iter().zip(second_halves) {
            self.pixels[index].double(second_half);
        }
    }

    /// What is known of the pixels of a block.
    fn pool(&self, range: &Range<usize>) -> Vec<PixelError> {
        let gain = self.gain(range);
        let error = |index: usize| {
            let pixel = &self.pixels[index];
            let squared = self.relative(pixel, self.squared_error(range, index, gain));
            PixelError { squared, gain, samples: pixel.samples }
        };
        range.clone().into_par_iter().with_min_len(1024).map(error).collect()
    }

    /// The mean of squared errors of a pixel's bands, relative to their values.
    fn relative(&self, pixel: &Pixel, squares: [f64; 3]) -> f64 {
        let of_band = |band: usize| {
            let [value, floor] = [pixel.mean()[band], self.floors[band]];
            squares[band] / (value * value + floor * floor).max(f64::MIN_POSITIVE)
        };
        (of_band(0) + of_band(1) + of_band(2)) / 3.0
    }

    /// What doubling samples leaves of squared errors in a block, by its pixels' last two doublings.
    ///
    /// One square says little, and few large ones would hide what holds for most: of each pixel the share of its second square counts. With squares of two
    /// normally distributed numbers, whose variances have the ratio g, the shares' means have the ratio √g.
    fn gain(&self, range: &Range<usize>) -> f64 {
        let (mut last, mut before) = (0.0, 0.0);
        for pixel in &self.pixels[range.clone()] {
            let squares = [pixel.last, pixel.before].map(|bands| self.relative(pixel, bands.map(square)));
            let weight = 1.0 / (SMALL + squares[0] + squares[1]);
            last += weight * squares[0];
            before += weight * squares[1];
        }
        if before > 0.0 { (last / before).powi(2).clamp(GAINS[0], GAINS[1]) } else { GAINS[1] }
    }

    /// The estimated squared errors of a pixel's bands, from its own samples and those of its neighbours in the block.
    fn squared_error(&self, range: &Range<usize>, index: usize, gain: f64) -> [f64; 3] {
        let columns = self.camera.columns();
        let (first, last) = (range.start / columns, range.end / columns - 1);
        let (column, row) = (index % columns, index / columns);
        let samples = f64::from(self.pixels[index].samples);
        let own = self.pixels[index].mean();
        let (mut sums, mut weights, mut steps) = ([0.0; 3], 0.0, [0.0_f64; 3]);
        for y in row.saturating_sub(1).max(first)..=(row + 1).min(last) {
            for x in column.saturating_sub(1)..=(column + 1).min(columns - 1) {
                let other = &self.pixels[y * columns + x];
                let weight = f64::from((2 - y.abs_diff(row) as u32) * (2 - x.abs_diff(column) as u32));
                // With as many samples as this pixel has.
                let scale = 0.5 * weight * (f64::from(other.samples) / samples).powf(-gain.log2());
                for (band, sum) in sums.iter_mut().enumerate() {
                    *sum += scale * (square(other.last[band]) + gain * square(other.before[band]));
                }
                weights += weight;
                for (step, (own, other)) in steps.iter_mut().zip(own.iter().zip(other.mean())) {
                    *step = step.max((own - other).abs());
                }
            }
        }
        let unseen = |band: usize| UNSEEN * (steps[band] / samples).powi(2);
        std::array::from_fn(|band| sums[band] / weights * gain / (1.0 - gain) + unseen(band))
    }
}

fn square(difference: f32) -> f64 {
    f64::from(difference) * f64::from(difference)
}

/// What a neighbour shows may be in the pixel too, on a part that none of its N samples has met: it is about 1/N of the pixel, and this is how often it is
/// there.
const UNSEEN: f64 = 0.1;

/// Squared relative errors well below this share say little of how errors fall.
const SMALL: f64 = 1e-6;

/// What doubling can leave of squared errors: with a low-discrepancy sequence where all is smooth, and with independent samples.
const GAINS: [f64; 2] = [0.35, 0.5];

/// Sum of the radiances of some of a pixel's rays; every pixel has a scramble of the sequence of its own.
fn sum(
    worker: &mut RayWorker<'_>,
    camera: &ViewCamera,
    renderer: &Renderer,
    pixel: usize,
    samples: Range<u32>,
) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for sample in samples {
        let value = radiance(worker, renderer, camera, pixel, sample);
        sum = std::array::from_fn(|band| sum[band] + value[band]);
    }
    sum
}

fn distance(worker: &mut RayWorker<'_>, index: u64, ray: &CameraRay) -> f64 {
    traced(worker, index, ray).map_or(NOWHERE, |traced| traced.effective_distance.min(NOWHERE))
}

/// The mean of each band over the pixels that are not black in it, of which a few may be dazzling.
fn typical(pixels: &[Pixel]) -> [f64; 3] {
    std::array::from_fn(|band| {
        let mut values: Vec<f64> = pixels.iter().map(|pixel| pixel.mean()[band]).filter(|value| *value > 0.0).collect();
        if values.is_empty() {
            return 0.0;
        }
        let middle = values.len() / 2;
        let (_, median, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
        let most = DAZZLING * *median;
        values.iter().map(|value| value.min(most)).sum::<f64>() / values.len() as f64
    })
}
