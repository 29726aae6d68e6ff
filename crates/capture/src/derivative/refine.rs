//! Samples pixels until the derivative has its error.

use super::flow::Flow;
use super::outline::outlines;
use super::pixel_derivative::StepWorkers;
use super::{DerivativeSamples, ParameterStep, RANDOMISATIONS};
use crate::Progress;
use crate::domain::Domain;
use crate::neighbourhood::window_means;
use radsight_adaptive::{
    ErrorEstimate, NoiseTarget, PixelError, PixelSamples, PixelSource, SampleSums, SamplingState, Selection, begin,
    double, refine,
};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

/// The derivative of an exposed picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Derivative {
    /// dE/dθ of each pixel, J/m² per unit of the parameter, in scanline order from the top left.
    pub values: Vec<f64>,
    /// Its standard error, by independent randomisations of the samples.
    pub standard_errors: Vec<f64>,
    /// Rms of the standard errors, relative to the rms of the derivative (or, if that is larger, to
    /// the derivative that changes the exposure by 0.003 % over the step).
    pub relative_error: f64,
    /// Estimated rms error due to the finite step, relative to the rms of the derivative.
    pub step_error: f64,
    /// Number of rays.
    pub rays: u64,
    /// Number of pixels whose samples move with an outline.
    pub outline_pixels: usize,
}

/// Sums over the samples of one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct StepSums {
    /// Of the derivative, by randomisation.
    slopes: [f64; RANDOMISATIONS as usize],
    /// Of the exposure.
    exposure: f64,
}

/// Samples of one pixel so far, of each randomisation.
type Pixel = PixelSamples<StepSums>;

impl SampleSums for StepSums {
    /// The error follows from the randomisations.
    type HalfDifference = ();
    type Mean = f64;

    fn add(&mut self, other: &StepSums) {
        self.slopes.iter_mut().zip(other.slopes).for_each(|(sum, added)| *sum += added);
        self.exposure += other.exposure;
    }

    fn half_difference(_first: &StepSums, _second: &StepSums, _samples: u32) {}

    fn mean(&self, samples: u32) -> f64 {
        self.slopes.iter().sum::<f64>() / f64::from(RANDOMISATIONS * samples)
    }
}

/// Largest number of samples of a randomisation.
const MAX_SAMPLES: u32 = 1 << 14;

/// Factor by which a doubling of the samples lowers the squared error, for the choice of pixels.
const GAIN: f64 = 0.4;

/// Radius of the window over which squared errors are averaged, pixels.
const WINDOW: usize = 1;

/// Weight of a pixel's own squared error beside that of its window: it has 7 degrees of freedom.
const OWN_WEIGHT: f64 = 0.5;

const MAX_PASSES: u32 = 48;

/// Change of the exposure over a step, rms relative to the rms of the exposure, below which a
/// derivative counts as zero.
const LEAST_CHANGE: f64 = 3e-5;

/// First samples of each randomisation. Fewer miss the few samples that change sides at a shadow
/// edge, and with them the noise.
const FIRST_SAMPLES: u32 = 8;

/// The error of the step is estimated in one of this many pixels.
const STEP_LATTICE: usize = 7;

/// Its largest number of samples of a randomisation.
const STEP_SAMPLES: u32 = 64;

/// Squared standard error of the mean.
fn squared_error(pixel: &Pixel) -> f64 {
    let (mean, samples) = (pixel.mean(), f64::from(pixel.samples.max(1)));
    let squares: f64 = pixel.sums.slopes.iter().map(|sum| (sum / samples - mean).powi(2)).sum();
    squares / f64::from(RANDOMISATIONS * (RANDOMISATIONS - 1))
}

pub(super) fn derivative(
    step: &ParameterStep<'_>,
    samples: DerivativeSamples,
    progress: &dyn Progress,
) -> Option<Derivative> {
    let rays = step.center.rays;
    if !rays.hole().has_points() {
        return None;
    }
    let domain = Domain::of(rays.hole());
    let outlines = outlines(step, progress);
    let flow = |(pixel, outline): (usize, &Option<_>)| Flow::following(step, domain, pixel as u64, (*outline)?);
    let flows: Vec<Option<Flow>> = outlines.par_iter().enumerate().map(flow).collect();
    let sampler = Sampler { step, flows: &flows, progress, traced: AtomicU64::new(0) };
    let mut state = SamplingState::new(flows.len());
    begin(&sampler, &mut state);
    match samples {
        DerivativeSamples::ToError(error) => sampler.refine(&mut state, error),
        DerivativeSamples::PerPixel(samples) => {
            let enough = |state: &SamplingState<StepSums>| state.pixels[0].samples * RANDOMISATIONS >= samples;
            while !state.pixels.is_empty() && !enough(&state) && !progress.stops() {
                state.pending = (0..flows.len()).collect();
                double(&sampler, &mut state);
            }
        }
    }
    let pixels = state.pixels;
    if progress.stops() {
        return None;
    }
    let squared = squared_errors(&pixels, rays.camera().columns() as usize);
    let values: Vec<f64> = pixels.iter().map(Pixel::mean).collect();
    let size = signal(&pixels, &squared, step.step).sqrt();
    let relative = |squared: f64| if squared > 0.0 { squared.sqrt() / size } else { 0.0 };
    Some(Derivative {
        relative_error: relative(mean(&squared)),
        step_error: relative(sampler.squared_step_error(&pixels)),
        values,
        standard_errors: squared.iter().map(|squared| squared.sqrt()).collect(),
        rays: sampler.traced.load(Ordering::Relaxed),
        outline_pixels: flows.iter().flatten().count(),
    })
}

struct Sampler<'a> {
    step: &'a ParameterStep<'a>,
    flows: &'a [Option<Flow>],
    progress: &'a dyn Progress,
    traced: AtomicU64,
}

impl Sampler<'_> {
    /// Doubles samples where that lowers the error most, until the error is reached.
    fn refine(&self, state: &mut SamplingState<StepSums>, error: f64) {
        let columns = self.step.center.rays.camera().columns() as usize;
        let target = NoiseTarget {
            most_samples: MAX_SAMPLES,
            most_passes: MAX_PASSES,
            ..NoiseTarget::new(error * error, Selection::FractionOrFirst)
        };
        refine(self, state, &target, |pixels| DerivativeErrors::new(pixels, columns, self.step.step));
    }

    /// Samples of a pixel with this step.
    fn sums_of_step(
        &self,
        step: &ParameterStep<'_>,
        workers: &mut StepWorkers<'_>,
        pixel: usize,
        range: Range<u32>,
    ) -> StepSums {
        let flow = self.flows[pixel].as_ref();
        let samples = range.len() as u32;
        let mut added = StepSums::default();
        for (randomisation, sum) in (0..).zip(&mut added.slopes) {
            let [slope, exposure] = step.sum(workers, (pixel as u64, flow), randomisation, range.clone());
            *sum = slope;
            added.exposure += exposure;
        }
        let rays = u64::from(samples * RANDOMISATIONS) * if flow.is_some() { 3 } else { 2 };
        let done = self.traced.fetch_add(rays, Ordering::Relaxed) + rays;
        self.progress.report(done, done);
        added
    }

    /// Mean squared error due to the finite step, from a lattice of pixels. Products of the
    /// differences of independent randomisations have no noise in the mean.
    fn squared_step_error(&self, pixels: &[Pixel]) -> f64 {
        let Some(doubled) = self.step.doubled() else { return 0.0 };
        let squares: Vec<f64> = (0..pixels.len())
            .into_par_iter()
            .step_by(STEP_LATTICE)
            .map_init(
                || [self.step.step_workers(), doubled.step_workers()],
                |[near, far], pixel| {
                    let range = 0..pixels[pixel].samples.min(STEP_SAMPLES);
                    let [near, far] = [(self.step, near), (&doubled, far)]
                        .map(|(step, workers)| self.sums_of_step(step, workers, pixel, range.clone()));
                    let mut slopes = far.slopes;
                    slopes.iter_mut().zip(near.slopes).for_each(|(far, near)| *far = (*far - near) / 3.0);
                    let difference = Pixel::of(StepSums { slopes, exposure: 0.0 }, range.len() as u32);
                    difference.mean().powi(2) - squared_error(&difference)
                },
            )
            .collect();
        mean(&squares).max(0.0)
    }
}

impl<'a> PixelSource for Sampler<'a> {
    type Sums = StepSums;
    type Worker = StepWorkers<'a>;

    fn worker(&self) -> StepWorkers<'a> {
        self.step.step_workers()
    }

    fn sums(&self, workers: &mut StepWorkers<'a>, pixel: usize, samples: Range<u32>) -> StepSums {
        self.sums_of_step(self.step, workers, pixel, samples)
    }

    /// Without doublings: the error follows from the randomisations.
    fn first(&self, workers: &mut StepWorkers<'a>, pixel: usize) -> Pixel {
        Pixel::of(self.sums(workers, pixel, 0..FIRST_SAMPLES), FIRST_SAMPLES)
    }

    fn stops(&self) -> bool {
        self.progress.stops()
    }
}

/// The errors of the pixels' derivatives.
struct DerivativeErrors {
    pixels: Vec<PixelError>,
    /// Mean square of the derivative.
    signal: f64,
}

impl DerivativeErrors {
    fn new(pixels: &[Pixel], columns: usize, step: f64) -> DerivativeErrors {
        let squared = squared_errors(pixels, columns);
        let of_pixel =
            |(pixel, squared): (&Pixel, &f64)| PixelError { squared: *squared, gain: GAIN, samples: pixel.samples };
        let errors = pixels.iter().zip(&squared).map(of_pixel).collect();
        DerivativeErrors { pixels: errors, signal: signal(pixels, &squared, step) }
    }
}

impl ErrorEstimate for DerivativeErrors {
    fn pixels(&self) -> &[PixelError] {
        &self.pixels
    }

    fn unit(&self) -> f64 {
        self.signal
    }
}

/// Squared standard error of each pixel: its own, and that of its window for equally many samples.
fn squared_errors(pixels: &[Pixel], columns: usize) -> Vec<f64> {
    let own: Vec<f64> = pixels.iter().map(squared_error).collect();
    let of_one: Vec<f64> = own.iter().zip(pixels).map(|(own, pixel)| own * f64::from(pixel.samples)).collect();
    let near = window_means(&of_one, columns, WINDOW);
    let pooled = |((own, near), pixel): ((&f64, &f64), &Pixel)| {
        OWN_WEIGHT * own + (1.0 - OWN_WEIGHT) * near / f64::from(pixel.samples.max(1))
    };
    own.iter().zip(&near).zip(pixels).map(pooled).collect()
}

/// Mean square of the derivative without its noise, to which errors relate. A derivative that
/// changes next to nothing over the step counts as if it changed [`LEAST_CHANGE`].
fn signal(pixels: &[Pixel], squared_errors: &[f64], step: f64) -> f64 {
    let square = mean_square(pixels.iter().map(Pixel::mean));
    let exposure = |pixel: &Pixel| pixel.sums.exposure / f64::from(RANDOMISATIONS * pixel.samples.max(1));
    let least = (LEAST_CHANGE / step).powi(2) * mean_square(pixels.iter().map(exposure));
    // Where noise dominates, the difference says nothing.
    (square - mean(squared_errors)).max(0.1 * square).max(least)
}

fn mean_square(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len().max(1) as f64;
    values.map(|value| value * value).sum::<f64>() / count
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}
