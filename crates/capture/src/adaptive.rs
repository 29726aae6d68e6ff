//! As many rays as an asked error needs, where they are needed.
//!
//! A pixel's samples are doubled. Halves of a low-discrepancy sequence complement each other, so the spread of samples says little
//! about the error of their mean; the difference of the means of the two halves does. With `e(n)` the error of the mean of n samples and
//! `d(n)` half the difference of its halves' means, `⟨e(n)²⟩ = ⟨e(n/2)²⟩ − ⟨d(n)²⟩` for exchangeable halves, so
//! `⟨e(n)²⟩ = ⟨d(2n)²⟩ + ⟨d(4n)²⟩ + …`. If `⟨d²⟩` falls by a factor q at each doubling, the sum is `⟨d(n)²⟩·q/(1−q)`: all of `⟨d²⟩` for
//! independent samples (q = ½), and much less for smooth integrands. q is measured over all pixels of one level.

use crate::fixed::radiance;
use crate::{Exposure, PixelStatistics, Progress};
use radsight_pinhole::{BandWeights, Rays};
use radsight_render::Renderer;
use radsight_sampling::{DimensionSet, RaySampler};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// No pixel gets more samples: what one scramble of the sequence holds.
pub const MAX_SAMPLES: u32 = 1 << SEQUENCE_LOG2;

const SEQUENCE_LOG2: u32 = 16;

/// Samples of every pixel before anything is decided.
const FIRST_SAMPLES: u32 = 16;

/// The factor by which `⟨d²⟩` falls is trusted between these.
const DECAY_RANGE: (f64, f64) = (0.4, 0.5);

/// Pixels whose halves agree by chance are left alone, so the estimate comes out low: by a quarter on pictures with sharp edges of
/// light, measured against pictures that were integrated by other means.
const CHANCE_AGREEMENT: f64 = 1.33;

/// Passes after which the work ends whatever the error is.
const MAX_PASSES: u32 = 64;

/// One pixel's samples so far.
#[derive(Clone, Copy, Debug, Default)]
struct Pixel {
    /// Sum of radiance·cos⁴ over all samples.
    sum: f64,
    samples: u32,
    /// d² of the last two doublings: half differences of the means of halves.
    last: f64,
    before: f64,
}

impl Pixel {
    /// 0 before the first sample.
    fn mean(&self) -> f64 {
        self.sum / f64::from(self.samples.max(1))
    }

    /// Takes in the second half of its samples.
    fn double(&mut self, second_half: f64) {
        let half_difference = (second_half - self.sum) / f64::from(2 * self.samples);
        self.before = self.last;
        self.last = half_difference * half_difference;
        self.sum += second_half;
        self.samples *= 2;
    }
}

/// Exposes until the estimated rms error over the pixels is `error` times the mean exposure.
///
/// `rays` gives camera and seed; its number of samples is not used.
#[must_use]
pub fn expose_to_error(
    renderer: &Renderer,
    rays: &Rays,
    weights: &BandWeights,
    error: f64,
    progress: &dyn Progress,
) -> Exposure {
    let work = Work { renderer, rays, weights };
    let (columns, rows) = (rays.camera().columns() as usize, rays.camera().rows() as usize);
    let mut pixels = vec![Pixel::default(); columns * rows];
    let all: Vec<usize> = (0..pixels.len()).collect();
    let traced = AtomicU64::new(0);
    let planned = AtomicU64::new(all.len() as u64 * u64::from(FIRST_SAMPLES));
    let report = |count: u64| {
        let done = traced.fetch_add(count, Ordering::Relaxed) + count;
        progress.report(done, planned.load(Ordering::Relaxed).max(done));
    };
    work.begin(&mut pixels, progress, &report);
    let scale = rays.camera().exposure_per_radiance();
    let pixels_done = pixels.iter().filter(|pixel| pixel.samples > 0).count();
    if pixels_done < pixels.len() {
        return Exposure {
            values: pixels.iter().map(|pixel| scale * pixel.mean()).collect(),
            rays: traced.into_inner(),
            estimated_error: None,
            pixels_done: pixels_done as u64,
            is_partial: true,
            pixels: None,
        };
    }
    let mut estimate = Estimate::new(&pixels, columns, rows);
    let mut is_partial = false;
    for _ in 0..MAX_PASSES {
        let chosen = estimate.choose(&pixels, error);
        if chosen.is_empty() {
            break;
        }
        planned.fetch_add(chosen.iter().map(|&index| u64::from(pixels[index].samples)).sum(), Ordering::Relaxed);
        work.double(&mut pixels, &chosen, progress, &report);
        estimate = Estimate::new(&pixels, columns, rows);
        if progress.stops() {
            is_partial = estimate.relative_error() > error;
            break;
        }
    }
    Exposure {
        values: pixels.iter().map(|pixel| scale * pixel.mean()).collect(),
        rays: traced.into_inner(),
        estimated_error: Some(estimate.relative_error()),
        pixels_done: pixels_done as u64,
        is_partial,
        pixels: Some(estimate.statistics(&pixels, scale)),
    }
}

struct Work<'a> {
    renderer: &'a Renderer,
    rays: &'a Rays,
    weights: &'a BandWeights,
}

impl Work<'_> {
    /// The first samples of every pixel, with two doublings to see how the error falls.
    fn begin(&self, pixels: &mut [Pixel], progress: &dyn Progress, report: &(impl Fn(u64) + Sync)) {
        pixels.par_iter_mut().enumerate().with_min_len(32).for_each_init(
            || self.renderer.worker(),
            |worker, (index, pixel)| {
                if progress.stops() {
                    return;
                }
                pixel.samples = FIRST_SAMPLES / 4;
                pixel.sum = self.sum(worker, index, 0..pixel.samples);
                for _ in 0..2 {
                    pixel.double(self.sum(worker, index, pixel.samples..2 * pixel.samples));
                }
                report(u64::from(FIRST_SAMPLES));
            },
        );
    }

    /// Doubles the samples of some pixels, as far as the work goes on.
    fn double(&self, pixels: &mut [Pixel], chosen: &[usize], progress: &dyn Progress, report: &(impl Fn(u64) + Sync)) {
        let before: &[Pixel] = pixels;
        let second_halves: Vec<Option<f64>> = chosen
            .par_iter()
            .with_min_len(4)
            .map_init(
                || self.renderer.worker(),
                |worker, &index| {
                    if progress.stops() {
                        return None;
                    }
                    let samples = before[index].samples;
                    let sum = self.sum(worker, index, samples..2 * samples);
                    report(u64::from(samples));
                    Some(sum)
                },
            )
            .collect();
        for (&index, second_half) in chosen.iter().zip(second_halves) {
            second_half.into_iter().for_each(|half| pixels[index].double(half));
        }
    }

    /// Sum of radiance·cos⁴ over some of a pixel's samples; every pixel has a scramble of the sequence of its own.
    fn sum(&self, worker: &mut radsight_render::RayWorker<'_>, pixel: usize, samples: std::ops::Range<u32>) -> f64 {
        let first = (pixel as u64) << SEQUENCE_LOG2;
        samples
            .map(|sample| {
                let index = first | u64::from(sample);
                let u = RaySampler::new(self.rays.seed(), index).take(DimensionSet::CAMERA);
                let ray = self.rays.ray(pixel as u64, u);
                ray.cos4 * radiance(worker, index, (self.rays, pixel as u64), &ray, self.weights)
            })
            .sum()
    }
}

/// What is known of the error.
struct Estimate {
    /// Squared error of each pixel.
    squared: Vec<f64>,
    /// Decay of the squared error of each pixel's next doubling.
    decay: Vec<f64>,
    mean: f64,
}

impl Estimate {
    fn new(pixels: &[Pixel], columns: usize, rows: usize) -> Estimate {
        let mean = pixels.iter().map(Pixel::mean).sum::<f64>() / pixels.len() as f64;
        let by_level = decay_by_level(pixels);
        let decay: Vec<f64> = pixels.iter().map(|pixel| by_level[pixel.samples.ilog2() as usize]).collect();
        let squared = (0..pixels.len())
            .map(|index| neighbourhood(pixels, columns, rows, index) * decay[index] / (1.0 - decay[index]))
            .collect();
        Estimate { squared, decay, mean }
    }

    fn relative_error(&self) -> f64 {
        let mean_square = self.squared.iter().sum::<f64>() / self.squared.len() as f64;
        if self.mean > 0.0 { CHANCE_AGREEMENT * mean_square.sqrt() / self.mean } else { 0.0 }
    }

    /// What it says of each pixel; `scale` is the exposure for a radiance of 1.
    fn statistics(&self, pixels: &[Pixel], scale: f64) -> PixelStatistics {
        PixelStatistics {
            standard_errors: self.squared.iter().map(|squared| CHANCE_AGREEMENT * scale * squared.sqrt()).collect(),
            samples: pixels.iter().map(|pixel| pixel.samples).collect(),
        }
    }

    /// The pixels whose doubling lowers the error most for its cost, as many as it takes to reach the asked error.
    fn choose(&self, pixels: &[Pixel], error: f64) -> Vec<usize> {
        let target = (error / CHANCE_AGREEMENT * self.mean).powi(2) * self.squared.len() as f64;
        let mut left: f64 = self.squared.iter().sum();
        if left <= target {
            return Vec::new();
        }
        let mut open: Vec<usize> = (0..pixels.len())
            .filter(|&index| pixels[index].samples < MAX_SAMPLES && self.squared[index] > 0.0)
            .collect();
        let gain = |index: usize| self.squared[index] * (1.0 - self.decay[index]) / f64::from(pixels[index].samples);
        open.sort_by(|&a, &b| gain(b).total_cmp(&gain(a)).then(a.cmp(&b)));
        let enough = open
            .iter()
            .position(|&index| {
                left -= self.squared[index] * (1.0 - self.decay[index]);
                left <= target
            })
            .map_or(open.len(), |position| position + 1);
        open.truncate(enough);
        open.sort_unstable();
        open
    }
}

/// The factor by which d² fell at the last doubling, over all pixels of each level.
fn decay_by_level(pixels: &[Pixel]) -> [f64; 33] {
    let mut last = [0.0; 33];
    let mut before = [0.0; 33];
    for pixel in pixels {
        let level = pixel.samples.ilog2() as usize;
        last[level] += pixel.last;
        before[level] += pixel.before;
    }
    std::array::from_fn(|level| {
        let ratio = if before[level] > 0.0 { last[level] / before[level] } else { DECAY_RANGE.1 };
        ratio.clamp(DECAY_RANGE.0, DECAY_RANGE.1)
    })
}

/// d² averaged over a pixel and its neighbours, each scaled to the pixel's number of samples: one difference alone says little.
fn neighbourhood(pixels: &[Pixel], columns: usize, rows: usize, index: usize) -> f64 {
    let (column, row) = (index % columns, index / columns);
    let own = &pixels[index];
    let (mut sum, mut count) = (0.0, 0.0);
    for y in row.saturating_sub(1)..=(row + 1).min(rows - 1) {
        for x in column.saturating_sub(1)..=(column + 1).min(columns - 1) {
            let other = &pixels[y * columns + x];
            sum += other.last * f64::from(other.samples) / f64::from(own.samples);
            count += 1.0;
        }
    }
    (sum / count).max(0.25 * own.last)
}
