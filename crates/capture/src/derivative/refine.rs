//! Samples pixels until the derivative has its error.

use super::flow::Flow;
use super::outline::outlines;
use super::pixel_derivative::StepWorkers;
use super::{DerivativeSamples, ParameterStep, RANDOMISATIONS};
use crate::Progress;
use crate::adaptive::{GOLDEN_RATIO, window_means};
use crate::domain::Domain;
use radsight_pinhole::Hole;
use radsight_sampling::{PixelError, doublings};
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

/// Samples of one pixel so far.
#[derive(Clone, Copy, Debug)]
struct PixelSums {
    /// Of the derivative, by randomisation.
    sums: [f64; RANDOMISATIONS as usize],
    /// Of the exposure.
    exposure: f64,
    /// Of each randomisation.
    samples: u32,
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

impl PixelSums {
    const NONE: PixelSums = PixelSums { sums: [0.0; RANDOMISATIONS as usize], exposure: 0.0, samples: 0 };

    fn mean(&self) -> f64 {
        self.sums.iter().sum::<f64>() / f64::from(RANDOMISATIONS * self.samples.max(1))
    }

    /// Squared standard error of the mean.
    fn squared_error(&self) -> f64 {
        let (mean, samples) = (self.mean(), f64::from(self.samples.max(1)));
        let squares: f64 = self.sums.iter().map(|sum| (sum / samples - mean).powi(2)).sum();
        squares / f64::from(RANDOMISATIONS * (RANDOMISATIONS - 1))
    }
}

pub(super) fn derivative(
    step: &ParameterStep<'_>,
    samples: DerivativeSamples,
    progress: &dyn Progress,
) -> Option<Derivative> {
    let rays = step.center.rays;
    if rays.hole() == Hole::Pattern {
        return None;
    }
    let domain = Domain::of(rays.hole());
    let outlines = outlines(step, progress);
    let flow = |(pixel, outline): (usize, &Option<_>)| Flow::following(step, domain, pixel as u64, (*outline)?);
    let flows: Vec<Option<Flow>> = outlines.par_iter().enumerate().map(flow).collect();
    let sampler = Sampler { step, flows: &flows, progress, traced: AtomicU64::new(0) };
    let mut pixels = vec![PixelSums::NONE; flows.len()];
    let all: Vec<usize> = (0..pixels.len()).collect();
    match samples {
        DerivativeSamples::ToError(error) => sampler.refine(&mut pixels, &all, error),
        DerivativeSamples::PerPixel(samples) => {
            while pixels.first().is_some_and(|pixel| pixel.samples * RANDOMISATIONS < samples) {
                sampler.double(&mut pixels, &all);
                if progress.stops() {
                    break;
                }
            }
        }
    }
    if progress.stops() {
        return None;
    }
    let squared = squared_errors(&pixels, rays.camera().columns() as usize);
    let values: Vec<f64> = pixels.iter().map(PixelSums::mean).collect();
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
    fn refine(&self, pixels: &mut [PixelSums], all: &[usize], error: f64) {
        let columns = self.step.center.rays.camera().columns() as usize;
        self.double(pixels, all);
        for _ in 0..MAX_PASSES {
            let squared = squared_errors(pixels, columns);
            let target = error * error * signal(pixels, &squared, self.step.step);
            let of_pixel = |(pixel, squared): (&PixelSums, &f64)| PixelError {
                squared: *squared,
                gain: GAIN,
                samples: pixel.samples,
            };
            let errors: Vec<PixelError> = pixels.iter().zip(&squared).map(of_pixel).collect();
            let needed = doublings(&errors, target, MAX_SAMPLES);
            let is_chosen = |(index, needed): &(usize, f64)| *needed > (*index as f64 * GOLDEN_RATIO).fract();
            let mut chosen: Vec<usize> =
                needed.iter().copied().enumerate().filter(is_chosen).map(|(index, _)| index).collect();
            if chosen.is_empty() {
                // All need too small a fraction of a doubling to be chosen: the one that needs most.
                chosen.extend(
                    (0..needed.len())
                        .filter(|&index| needed[index] > 0.0)
                        .max_by(|&a, &b| needed[a].total_cmp(&needed[b])),
                );
            }
            if chosen.is_empty() || self.progress.stops() {
                break;
            }
            self.double(pixels, &chosen);
        }
    }

    /// Doubles the samples of some pixels; those without samples get the first ones.
    fn double(&self, pixels: &mut [PixelSums], chosen: &[usize]) {
        let before: &[PixelSums] = pixels;
        let added: Vec<PixelSums> = chosen
            .par_iter()
            .with_min_len(4)
            .map_init(
                || self.step.step_workers(),
                |workers, &pixel| {
                    if self.progress.stops() { PixelSums::NONE } else { self.added(workers, pixel, before[pixel]) }
                },
            )
            .collect();
        for (&pixel, added) in chosen.iter().zip(added) {
            pixels[pixel].sums.iter_mut().zip(added.sums).for_each(|(sum, added)| *sum += added);
            pixels[pixel].exposure += added.exposure;
            pixels[pixel].samples += added.samples;
        }
    }

    fn added(&self, workers: &mut StepWorkers<'_>, pixel: usize, before: PixelSums) -> PixelSums {
        let samples = before.samples.max(FIRST_SAMPLES);
        self.sums(self.step, workers, pixel, before.samples..before.samples + samples)
    }

    /// Samples of a pixel with this step.
    fn sums(
        &self,
        step: &ParameterStep<'_>,
        workers: &mut StepWorkers<'_>,
        pixel: usize,
        range: Range<u32>,
    ) -> PixelSums {
        let flow = self.flows[pixel].as_ref();
        let samples = range.len() as u32;
        let mut added = PixelSums { samples, ..PixelSums::NONE };
        for (randomisation, sum) in (0..).zip(&mut added.sums) {
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
    fn squared_step_error(&self, pixels: &[PixelSums]) -> f64 {
        let Some(doubled) = self.step.doubled() else { return 0.0 };
        let squares: Vec<f64> = (0..pixels.len())
            .into_par_iter()
            .step_by(STEP_LATTICE)
            .map_init(
                || [self.step.step_workers(), doubled.step_workers()],
                |[near, far], pixel| {
                    let range = 0..pixels[pixel].samples.min(STEP_SAMPLES);
                    let [near, far] = [(self.step, near), (&doubled, far)]
                        .map(|(step, workers)| self.sums(step, workers, pixel, range.clone()));
                    let mut difference = far;
                    difference.sums.iter_mut().zip(near.sums).for_each(|(far, near)| *far = (*far - near) / 3.0);
                    difference.mean().powi(2) - difference.squared_error()
                },
            )
            .collect();
        mean(&squares).max(0.0)
    }
}

/// Squared standard error of each pixel: its own, and that of its window for equally many samples.
fn squared_errors(pixels: &[PixelSums], columns: usize) -> Vec<f64> {
    let own: Vec<f64> = pixels.iter().map(PixelSums::squared_error).collect();
    let of_one: Vec<f64> = own.iter().zip(pixels).map(|(own, pixel)| own * f64::from(pixel.samples)).collect();
    let near = window_means(&of_one, columns, WINDOW);
    let pooled = |((own, near), pixel): ((&f64, &f64), &PixelSums)| {
        OWN_WEIGHT * own + (1.0 - OWN_WEIGHT) * near / f64::from(pixel.samples.max(1))
    };
    own.iter().zip(&near).zip(pixels).map(pooled).collect()
}

/// Mean square of the derivative without its noise, to which errors relate. A derivative that
/// changes next to nothing over the step counts as if it changed [`LEAST_CHANGE`].
fn signal(pixels: &[PixelSums], squared_errors: &[f64], step: f64) -> f64 {
    let square = mean_square(pixels.iter().map(PixelSums::mean));
    let exposure = |pixel: &PixelSums| pixel.exposure / f64::from(RANDOMISATIONS * pixel.samples.max(1));
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
