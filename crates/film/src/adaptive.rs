//! Adaptive sampling of pictures.
//!
//! The samples of a pixel are doubled where that lowers the error of the picture most
//! ([`refine`]), until the estimated error is the requested one. The estimate uses half the
//! difference h between the means of the two halves of a pixel's samples. If the squared error of a
//! mean falls by a factor g with each doubling, so does h², and the squared error of both halves
//! together is h²·g/(1 − g). For independent samples g = ½ and the factor is 1; for a
//! low-discrepancy sequence both are smaller. A single difference says little, so the squares of
//! neighbours are averaged, including those of the previous doubling; g is estimated for a whole
//! block. What no sample has hit yet, such as the corner of a lamp, is assumed to be like the
//! neighbour that differs most.
//!
//! Where irradiance is cached, its error counts as well. It is estimated and corrected by
//! independent paths (`residual.rs`).

use crate::interpolated::{self, Interpolation};
use crate::part::radiance;
use crate::residual::{Assessment, Residuals};
use crate::view_camera::{CameraRay, ViewCamera, traced};
use radsight_adaptive::{
    Certainty, ErrorEstimate, ErrorTarget, MAX_SAMPLES, NoiseTarget, PixelError, PixelSamples, PixelSource,
    SamplingState, Selection, Stop, begin, ray_number, refine,
};
use radsight_render::{RayWorker, Renderer};
use rayon::prelude::*;
use std::ops::Range;

/// Number of pixels that are finished together; rounded to whole rows.
const BLOCK: usize = 1 << 14;

/// Number of rows that are finished together with interpolation, which also needs some samples of
/// adjacent rows. A multiple of every cell size.
const INTERPOLATED_ROWS: usize = 64;

/// Relative errors are relative to `sqrt(v² + (DARK_FRACTION·m)²)` with a pixel's value v and the
/// typical value m of the picture, so darker pixels need no more accuracy.
const DARK_FRACTION: f64 = 0.01;

/// The typical value limits pixels to this multiple of the median.
const BRIGHT_LIMIT: f64 = 10.0;

/// Fraction of the squared error allotted to the pixels' own noise where irradiance is cached.
const NOISE_FRACTION: f64 = 0.4;

/// Distance of a ray that hits nothing, as in Radiance.
const NO_HIT_DISTANCE: f64 = 1e10;

/// The number of rays of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SamplingBudget {
    /// A fixed number.
    Samples(u32),
    /// As few as the error allows.
    Error(ErrorTarget),
    /// As in Radiance: smooth regions are interpolated.
    Interpolated(Interpolation),
}

type Pixel = PixelSamples<[f64; 3]>;

/// The quality of a picture, estimated from its own samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The remaining error, as defined by [`SamplingBudget::Error`].
    pub error: f64,
    /// Half width of its 95 % confidence interval.
    pub uncertainty: f64,
    /// Mean number of rays per pixel.
    pub rays: f64,
    /// The part of the error due to noise of the pixels' own rays. Its square and that of `cache`
    /// add up to that of `error`.
    pub noise: f64,
    /// The part due to cached irradiance; `None` where none is cached.
    pub cache: Option<f64>,
    /// Why the work ended before the requested error was reached.
    pub stopped: Option<Stop>,
}

/// Whether there is time left for a block, given the fraction of the picture that is finished after
/// it.
pub type TimeLeft<'t> = dyn Fn(f64) -> bool + Sync + 't;

/// Sums over finished pixels.
#[derive(Clone, Copy, Debug, Default)]
struct Finished {
    pixels: f64,
    rays: f64,
    /// Of squared errors due to noise, and of their squares.
    errors: f64,
    squares: f64,
    /// Of squared errors due to cached irradiance, and the variance of that sum; `None` where none
    /// is cached.
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

    /// The mean squared error due to noise, and its variance.
    fn noise(&self) -> [f64; 2] {
        let mean = self.errors / self.pixels;
        let spread = (self.squares / self.pixels - mean * mean).max(0.0);
        [mean, spread * PIXELS_PER_ESTIMATE / self.pixels]
    }

    /// Keeps the first reason; lack of time counts most.
    fn add_stop(&mut self, stop: Option<Stop>) {
        self.stopped = if stop == Some(Stop::Time) { stop } else { self.stopped.or(stop) };
    }

    fn add_cached(&mut self, assessment: &Assessment) {
        let [squared, variance] = self.cached.unwrap_or_default();
        self.cached = Some([squared + assessment.squared.max(0.0), variance + assessment.variance]);
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

/// Half width of a 95 % confidence interval, in standard deviations of a normal distribution.
const CONFIDENCE: f64 = 1.96;

/// Number of pixels per independent estimate, since each is a mean over its neighbours: the inverse
/// of the sum of their squared weights.
const PIXELS_PER_ESTIMATE: f64 = 7.1;

/// A picture that is being rendered.
pub struct Film<'r> {
    renderer: &'r Renderer,
    camera: ViewCamera,
    budget: SamplingBudget,
    state: SamplingState<[f64; 3]>,
    /// Added in squares to the bands of a pixel where an error is relative to them.
    floors: [f64; 3],
    finished: Finished,
    /// Squared relative errors of the finished pixels, if an error was requested.
    errors: Vec<f32>,
    /// Rays besides those of the pixels' own samples.
    extra_rays: Vec<u32>,
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
    /// Begins a picture. With a requested error this traces the first rays of all pixels, for the
    /// typical value.
    #[must_use]
    pub fn new(renderer: &'r Renderer, camera: ViewCamera, budget: SamplingBudget) -> Film<'r> {
        let pixels = camera.columns() * camera.rows();
        let finished = Finished::default();
        let mut frame = Film {
            renderer,
            camera,
            budget,
            state: SamplingState::new(pixels),
            floors: [0.0; 3],
            finished,
            errors: Vec::new(),
            extra_rays: Vec::new(),
            time_left: None,
        };
        if let SamplingBudget::Error(_) = budget {
            frame.errors = vec![f32::NAN; pixels];
            frame.extra_rays = vec![0; pixels];
            begin(&FilmRays { renderer, camera: &camera, has_time: &|| true }, &mut frame.state);
            frame.floors = typical(&frame.state.pixels).map(|band| DARK_FRACTION * band);
        }
        frame
    }

    /// Stops adaptive sampling when there is no time left.
    #[must_use]
    pub fn while_time_is_left(mut self, time_left: Box<TimeLeft<'r>>) -> Film<'r> {
        self.time_left = Some(time_left);
        self
    }

    /// Columns.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.camera.columns()
    }

    /// The rows that are finished together with a row. Requesting all of them costs no more than
    /// requesting one.
    #[must_use]
    pub fn block_of(&self, row: usize) -> Range<usize> {
        let height = match self.budget {
            SamplingBudget::Interpolated(_) => INTERPOLATED_ROWS,
            _ => (BLOCK / self.camera.columns().max(1)).max(1),
        };
        let first = row - row % height;
        first..(first + height).min(self.camera.rows())
    }

    /// Finishes a block of rows and returns its pixels.
    pub fn finish_block(&mut self, block: Range<usize>) -> Vec<[f32; 3]> {
        let columns = self.camera.columns();
        let range = block.start * columns..block.end * columns;
        match self.budget {
            SamplingBudget::Interpolated(interpolation) => {
                return interpolated::block(self.renderer, &self.camera, interpolation, &block);
            }
            SamplingBudget::Samples(samples) => self.trace_all(range.clone(), samples.clamp(1, MAX_SAMPLES)),
            SamplingBudget::Error(target) => return self.finish_to_error(&range, target),
        }
        self.state.pixels[range].iter().map(|pixel| pixel.mean().map(|band| band as f32)).collect()
    }

    /// Finishes pixels to a requested error.
    fn finish_to_error(&mut self, range: &Range<usize>, target: ErrorTarget) -> Vec<[f32; 3]> {
        let ErrorTarget { error, most_samples } = target;
        let most = most_samples.min(MAX_SAMPLES);
        let is_cached = self.renderer.irradiance_noise().is_some();
        let share = if is_cached { NOISE_FRACTION } else { 1.0 };
        let pooled = self.reduce_noise(range, share * error * error, most);
        let noise: f64 = pooled.iter().map(|pixel| pixel.squared).sum();
        let assessment = is_cached.then(|| self.correct(range, error * error * range.len() as f64 - noise, most));
        let (mut corrections, mut of_pixels) = (vec![[0.0; 3]; range.len()], vec![0.0; range.len()]);
        if let Some(assessment) = assessment {
            self.finished.add_cached(&assessment);
            (corrections, of_pixels) = (assessment.corrections, assessment.of_pixels);
        }
        for ((index, pixel), of_cache) in range.clone().zip(&pooled).zip(of_pixels) {
            self.finished.add(pixel.squared, pixel.samples + self.extra_rays[index]);
            self.errors[index] = (pixel.squared + of_cache) as f32;
        }
        let corrected = |(pixel, correction): (&Pixel, [f64; 3])| {
            let mean = pixel.mean();
            std::array::from_fn(|band| (mean[band] + correction[band]).max(0.0) as f32)
        };
        self.state.pixels[range.clone()].iter().zip(corrections).map(corrected).collect()
    }

    /// Doubles samples until the pixels' own squared noise plus one standard error is `squared`;
    /// returns what is left.
    fn reduce_noise(&mut self, range: &Range<usize>, squared: f64, most: u32) -> Vec<PixelError> {
        let mut state = std::mem::take(&mut self.state);
        let (this, finished) = (&*self, range.end as f64 / state.pixels.len() as f64);
        let has_time = || this.time_left.as_ref().is_none_or(|time_left| time_left(finished));
        let rays = FilmRays { renderer: this.renderer, camera: &this.camera, has_time: &has_time };
        let target = NoiseTarget {
            most_samples: most,
            certainty: Certainty::StandardError { pixels_per_estimate: PIXELS_PER_ESTIMATE },
            ..NoiseTarget::new(squared, Selection::Every)
        };
        let estimate = |pixels: &[Pixel]| BlockErrors { pixels: this.pool(pixels, range), first: range.start };
        let (left, stop) = refine(&rays, &mut state, &target, estimate);
        self.state = state;
        self.finished.add_stop(stop);
        left.pixels
    }

    /// Corrects cached irradiance until the estimated sum of its squared errors is at most
    /// `allowed`.
    fn correct(&mut self, range: &Range<usize>, allowed: f64, most: u32) -> Assessment {
        let units = self.state.pixels[range.clone()].iter().map(|pixel| self.units(pixel)).collect();
        let mut residuals = Residuals::new(range.clone(), self.camera.columns(), units);
        let mut wanted = residuals.first_pixels();
        loop {
            residuals.trace(self.renderer, &self.camera, &wanted);
            let assessment = residuals.assess(most);
            let is_enough = assessment.upper() <= allowed;
            wanted = if is_enough { Vec::new() } else { assessment.wanted(allowed) };
            if !is_enough && wanted.is_empty() {
                self.finished.add_stop(Some(Stop::Rays));
            }
            if wanted.is_empty() || !self.has_time(range) {
                for index in range.clone() {
                    self.extra_rays[index] = residuals.rays_of(index - range.start);
                }
                return assessment;
            }
        }
    }

    /// Whether there is time left for a block; records it if there is not.
    fn has_time(&mut self, range: &Range<usize>) -> bool {
        let share = range.end as f64 / self.state.pixels.len() as f64;
        let has_time = self.time_left.as_ref().is_none_or(|time_left| time_left(share));
        if !has_time {
            self.finished.add_stop(Some(Stop::Time));
        }
        has_time
    }

    /// The values to which the errors of a pixel's bands are relative.
    fn units(&self, pixel: &Pixel) -> [f64; 3] {
        let mean = pixel.mean();
        std::array::from_fn(|band| mean[band].hypot(self.floors[band]).max(f64::MIN_POSITIVE.sqrt()))
    }

    /// The quality of the finished pixels; `None` if no error was requested.
    #[must_use]
    pub fn estimate(&self) -> Option<Estimate> {
        self.finished.estimate()
    }

    /// The standard errors of all pixels relative to their values: the rms over the bands, as in
    /// [`SamplingBudget::Error`]. NaN for unfinished pixels; `None` if no error was requested.
    #[must_use]
    pub fn relative_errors(&self) -> Option<Vec<f32>> {
        (!self.errors.is_empty()).then(|| self.errors.iter().map(|squared| squared.sqrt()).collect())
    }

    /// Number of rays of each pixel; `None` with interpolation.
    #[must_use]
    pub fn samples(&self) -> Option<Vec<u32>> {
        let is_interpolated = matches!(self.budget, SamplingBudget::Interpolated(_));
        let further = |index: usize| self.extra_rays.get(index).copied().unwrap_or(0);
        (!is_interpolated).then(|| {
            self.state.pixels.iter().enumerate().map(|(index, pixel)| pixel.samples + further(index)).collect()
        })
    }

    /// Distances along the rays through the centres of the pixels of some rows, through mirrors and
    /// panes, scene units; 1e10 for nothing.
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
                    ray.map_or(NO_HIT_DISTANCE, |ray| distance(worker, ray_number(pixel, 0), &ray)) as f32
                },
            )
            .collect()
    }

    fn trace_all(&mut self, range: Range<usize>, samples: u32) {
        let (rays, first) =
            (FilmRays { renderer: self.renderer, camera: &self.camera, has_time: &|| true }, range.start);
        self.state.pixels[range].par_iter_mut().enumerate().with_min_len(16).for_each_init(
            || rays.worker(),
            |worker, (index, pixel)| *pixel = Pixel::of(rays.sums(worker, first + index, 0..samples), samples),
        );
    }

    /// The estimated errors of the pixels of a block.
    fn pool(&self, pixels: &[Pixel], range: &Range<usize>) -> Vec<PixelError> {
        let gain = self.gain(&pixels[range.clone()]);
        let error = |index: usize| {
            let pixel = &pixels[index];
            let squared = self.relative(pixel, self.squared_error((pixels, range), index, gain));
            PixelError { squared, gain, samples: pixel.samples }
        };
        range.clone().into_par_iter().with_min_len(1024).map(error).collect()
    }

    /// The mean squared error of a pixel's bands, relative to their values.
    fn relative(&self, pixel: &Pixel, squares: [f64; 3]) -> f64 {
        let of_band = |band: usize| {
            let [value, floor] = [pixel.mean()[band], self.floors[band]];
            squares[band] / (value * value + floor * floor).max(f64::MIN_POSITIVE)
        };
        (of_band(0) + of_band(1) + of_band(2)) / 3.0
    }

    /// The factor by which doubling samples reduces squared errors in a block, from the last two
    /// doublings of its pixels.
    ///
    /// A single square says little, and a few large ones would hide the majority, so each pixel
    /// contributes the ratio of its second square to the sum of both. If the squares are those of
    /// two normally distributed numbers with variance ratio g, the means of these ratios have the
    /// ratio √g.
    fn gain(&self, block: &[Pixel]) -> f64 {
        let (mut last, mut before) = (0.0, 0.0);
        for pixel in block {
            let squares = [pixel.last, pixel.before].map(|bands| self.relative(pixel, bands.map(square)));
            let weight = 1.0 / (NEGLIGIBLE_ERROR + squares[0] + squares[1]);
            last += weight * squares[0];
            before += weight * squares[1];
        }
        if before > 0.0 { (last / before).powi(2).clamp(GAINS[0], GAINS[1]) } else { GAINS[1] }
    }

    /// The estimated squared errors of a pixel's bands, from its own samples and those of its
    /// neighbours in the block.
    fn squared_error(&self, (pixels, range): (&[Pixel], &Range<usize>), index: usize, gain: f64) -> [f64; 3] {
        let columns = self.camera.columns();
        let (first, last) = (range.start / columns, range.end / columns - 1);
        let (column, row) = (index % columns, index / columns);
        let samples = f64::from(pixels[index].samples);
        let own = pixels[index].mean();
        let (mut sums, mut weights, mut steps) = ([0.0; 3], 0.0, [0.0_f64; 3]);
        for y in row.saturating_sub(1).max(first)..=(row + 1).min(last) {
            for x in column.saturating_sub(1)..=(column + 1).min(columns - 1) {
                let other = &pixels[y * columns + x];
                let weight = f64::from((2 - y.abs_diff(row) as u32) * (2 - x.abs_diff(column) as u32));
                // Scaled to the number of samples of this pixel.
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
        let unseen = |band: usize| UNSEEN_PROBABILITY * (steps[band] / samples).powi(2);
        std::array::from_fn(|band| sums[band] / weights * gain / (1.0 - gain) + unseen(band))
    }
}

fn square(difference: f32) -> f64 {
    f64::from(difference) * f64::from(difference)
}

/// A feature that a neighbour sees may cover about 1/N of this pixel without being hit by any of
/// its N samples. This is its assumed probability.
const UNSEEN_PROBABILITY: f64 = 0.1;

/// Pixels with squared relative errors well below this say little about the rate of convergence.
const NEGLIGIBLE_ERROR: f64 = 1e-6;

/// Limits of the factor by which doubling reduces squared errors: a low-discrepancy sequence of a
/// smooth integrand, and independent samples.
const GAINS: [f64; 2] = [0.35, 0.5];

/// The rays of a film's pixels, for the adaptive sampler.
struct FilmRays<'f, 'r> {
    renderer: &'r Renderer,
    camera: &'f ViewCamera,
    /// Whether there is time left.
    has_time: &'f (dyn Fn() -> bool + Sync),
}

impl<'r> PixelSource for FilmRays<'_, 'r> {
    type Sums = [f64; 3];
    type Worker = RayWorker<'r>;

    fn worker(&self) -> RayWorker<'r> {
        self.renderer.worker()
    }

    /// Sum of the radiances of some rays of a pixel.
    fn sums(&self, worker: &mut RayWorker<'r>, pixel: usize, samples: Range<u32>) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for sample in samples {
            let value = radiance(worker, self.renderer, self.camera, pixel, sample);
            sum = std::array::from_fn(|band| sum[band] + value[band]);
        }
        sum
    }

    fn stops(&self) -> bool {
        !(self.has_time)()
    }

    /// Passes are finished, so that threads do not change the picture.
    fn pauses(&self) -> bool {
        false
    }
}

/// The estimated errors of a block of pixels.
struct BlockErrors {
    pixels: Vec<PixelError>,
    first: usize,
}

impl ErrorEstimate for BlockErrors {
    fn pixels(&self) -> &[PixelError] {
        &self.pixels
    }

    fn first_pixel(&self) -> usize {
        self.first
    }
}

fn distance(worker: &mut RayWorker<'_>, index: u64, ray: &CameraRay) -> f64 {
    traced(worker, index, ray).map_or(NO_HIT_DISTANCE, |traced| traced.effective_distance.min(NO_HIT_DISTANCE))
}

/// The mean of each band over the pixels that are not black in it, with bright pixels limited.
fn typical(pixels: &[Pixel]) -> [f64; 3] {
    std::array::from_fn(|band| {
        let mut values: Vec<f64> = pixels.iter().map(|pixel| pixel.mean()[band]).filter(|value| *value > 0.0).collect();
        if values.is_empty() {
            return 0.0;
        }
        let center = values.len() / 2;
        let (_, median, _) = values.select_nth_unstable_by(center, f64::total_cmp);
        let most = BRIGHT_LIMIT * *median;
        values.iter().map(|value| value.min(most)).sum::<f64>() / values.len() as f64
    })
}
