//! As many rays as an asked error needs, where they are needed.
//!
//! A pixel's samples are doubled. Halves of a low-discrepancy sequence complement each other, so the spread of samples says little
//! about the error of their mean; the difference of the means of the two halves does. With `e(n)` the error of the mean of n samples and
//! `d(n)` half the difference of its halves' means, `⟨e(n)²⟩ = ⟨e(n/2)²⟩ − ⟨d(n)²⟩` for exchangeable halves, so
//! `⟨e(n)²⟩ = ⟨d(2n)²⟩ + ⟨d(4n)²⟩ + …`. If `⟨d²⟩` falls by a factor q at each doubling, the sum is `⟨d(n)²⟩·q/(1−q)`: all of `⟨d²⟩` for
//! independent samples (q = ½), and much less for smooth integrands. q is measured over the pixels around each: what is smooth converges faster
//! than an edge.

use crate::checkpoint::{AdaptiveState, Checkpoint, State};
use crate::fixed::{MOST_BANDS, bands_apart, radiance, radiance_apart};
use crate::mirrored_lights::PixelImages;
use crate::{Exposer, Exposure, PixelStatistics, Progress, Workers};
use radsight_sampling::{DimensionSet, PixelError, RaySampler, doublings};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// No pixel gets more samples: what one scramble of the sequence holds.
pub const MAX_SAMPLES: u32 = 1 << SEQUENCE_LOG2;

pub(crate) const SEQUENCE_LOG2: u32 = 16;

/// Samples of every pixel before anything is decided.
pub(crate) const FIRST_SAMPLES: u32 = 4;

/// The factor by which `⟨d²⟩` falls is trusted between these.
const GAIN_RANGE: (f64, f64) = (0.25, 0.5);

/// Pixels whose halves agree by chance are left alone, so the estimate comes out low: by a quarter on pictures with sharp edges of
/// light, measured against pictures that were integrated by other means.
pub(crate) const CHANCE_AGREEMENT: f64 = 1.33;

/// Passes after which the work ends whatever the error is.
pub(crate) const MAX_PASSES: u32 = 64;

/// One pixel's samples so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Pixel {
    /// Sum of radiance·cos⁴ over all samples.
    pub(crate) sum: f64,
    /// 0 before anything is known.
    pub(crate) samples: u32,
    /// d² of the last two doublings: half differences of the means of halves.
    pub(crate) last: f64,
    pub(crate) before: f64,
    /// Sums of the bands that are kept apart, else 0.
    pub(crate) bands: [f64; MOST_BANDS],
}

/// Sums of radiance·cos⁴ over some samples of a pixel.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sums {
    /// Of all bands together.
    pub(crate) whole: f64,
    /// Of the bands that are kept apart, else 0.
    bands: [f64; MOST_BANDS],
}

impl Pixel {
    /// 0 before the first sample.
    pub(crate) fn mean(&self) -> f64 {
        self.sum / f64::from(self.samples.max(1))
    }

    /// Takes in the second half of its samples.
    fn double(&mut self, second_half: &Sums) {
        let half_difference = (second_half.whole - self.sum) / f64::from(2 * self.samples);
        self.before = self.last;
        self.last = half_difference * half_difference;
        self.sum += second_half.whole;
        self.bands.iter_mut().zip(second_half.bands).for_each(|(sum, band)| *sum += band);
        self.samples *= 2;
    }
}

impl Exposer<'_> {
    /// Exposes until the estimated rms error over the pixels is `error` times the mean exposure; goes on with a checkpoint of such an
    /// exposure.
    ///
    /// The number of samples of [`Rays`](radsight_pinhole::Rays) is not used.
    #[must_use]
    pub fn to_error(&self, error: f64, start: Option<Checkpoint>, progress: &dyn Progress) -> Exposure {
        let mut state = match start {
            Some(Checkpoint(State::Adaptive(state))) => state,
            _ => AdaptiveState::default(),
        };
        let camera = self.rays.camera();
        state.pixels.resize(camera.pixel_count() as usize, Pixel::default());
        let work = Work::new(self, progress, &state.pixels);
        state.bands = work.bands;
        let is_new = state.pixels.iter().all(|pixel| pixel.samples == 0);
        let sparse = if is_new { work.sparse(&mut state, error) } else { None };
        if sparse.is_none() && !work.is_on_lattice.load(Ordering::Relaxed) {
            work.begin(&mut state);
        }
        let pixels_done = state.pixels.iter().filter(|pixel| pixel.samples > 0).count();
        let columns = camera.columns() as usize;
        let estimate = match sparse {
            Some(estimate) => Some(estimate),
            None => (pixels_done == state.pixels.len()).then(|| work.refine(&mut state, columns, error)),
        };
        let scale = camera.exposure_per_radiance();
        let values = match estimate {
            None => state.pixels.iter().map(|pixel| scale * pixel.mean()).collect(),
            Some(_) => {
                let mut light = work.means(&state.pixels);
                light.extend(work.around(&state.pixels));
                light.iter_mut().for_each(|mean| *mean *= scale);
                self.rays.picture(light, self.weights)
            }
        };
        let estimated_error = estimate.as_ref().map(Estimate::relative_error);
        Exposure {
            values,
            rays: work.traced.load(Ordering::Relaxed) - work.discarded.load(Ordering::Relaxed),
            estimated_error,
            pixels_done: pixels_done as u64,
            is_partial: progress.stops() && estimated_error.is_none_or(|reached| reached > error),
            pixels: estimate.map(|estimate| estimate.statistics(scale)),
            checkpoint: work.checkpoint(state),
        }
    }
}

pub(crate) struct Work<'a> {
    pub(crate) exposer: &'a Exposer<'a>,
    /// How many bands are kept apart; 0 where they add up.
    pub(crate) bands: usize,
    pub(crate) images: PixelImages,
    pub(crate) progress: &'a dyn Progress,
    traced: AtomicU64,
    /// Traced rays on which no pixel rests: those of a lattice that was given up, and those that audited one.
    pub(crate) discarded: AtomicU64,
    planned: AtomicU64,
    /// Whether some pixels of a lattice are being exposed instead of all.
    pub(crate) is_on_lattice: AtomicBool,
}

impl<'a> Work<'a> {
    fn new(exposer: &'a Exposer<'a>, progress: &'a dyn Progress, pixels: &[Pixel]) -> Work<'a> {
        let traced = pixels.iter().map(|pixel| u64::from(pixel.samples)).sum();
        let first = pixels.iter().filter(|pixel| pixel.samples == 0).count() as u64 * u64::from(FIRST_SAMPLES);
        Work {
            exposer,
            bands: bands_apart(exposer.rays, exposer.weights),
            images: images(exposer),
            progress,
            traced: AtomicU64::new(traced),
            discarded: AtomicU64::new(0),
            planned: AtomicU64::new(traced + first),
            is_on_lattice: AtomicBool::new(false),
        }
    }

    /// Whether the threads are to come together.
    fn pauses(&self) -> bool {
        self.progress.stops() || self.progress.wants_checkpoint()
    }

    pub(crate) fn report(&self, rays: u32) {
        let done = self.traced.fetch_add(u64::from(rays), Ordering::Relaxed) + u64::from(rays);
        self.progress.report(done, self.planned.load(Ordering::Relaxed).max(done));
    }

    /// The first samples of every pixel that has none, as far as the work goes on.
    fn begin(&self, state: &mut AdaptiveState) {
        loop {
            state.pixels.par_iter_mut().enumerate().with_min_len(32).for_each_init(
                || self.exposer.workers(),
                |worker, (index, pixel)| {
                    if pixel.samples == 0 && !self.pauses() {
                        *pixel = self.first(worker, index);
                        self.report(FIRST_SAMPLES);
                    }
                },
            );
            if self.progress.stops() || state.pixels.iter().all(|pixel| pixel.samples > 0) {
                return;
            }
            self.save(state);
        }
    }

    /// The first samples, with two doublings to see how the error falls.
    pub(crate) fn first(&self, worker: &mut Workers<'_>, index: usize) -> Pixel {
        let samples = FIRST_SAMPLES / 4;
        let Sums { whole, bands } = self.sums(worker, index, 0..samples);
        let mut pixel = Pixel { samples, sum: whole, bands, ..Pixel::default() };
        for _ in 0..2 {
            pixel.double(&self.sums(worker, index, pixel.samples..2 * pixel.samples));
        }
        pixel
    }

    /// Doubles samples where that lowers the error most for its cost, until the error is what it is to be or the work is stopped.
    fn refine(&self, state: &mut AdaptiveState, columns: usize, error: f64) -> Estimate {
        self.double(state);
        let mut estimate = Estimate::new(&state.pixels, columns);
        while state.passes < MAX_PASSES && !self.progress.stops() {
            state.pending = estimate.choose(error);
            if state.pending.is_empty() {
                break;
            }
            state.passes += 1;
            self.double(state);
            estimate = Estimate::new(&state.pixels, columns);
        }
        estimate
    }

    /// Doubles the samples of the pixels that are chosen for it, as far as the work goes on.
    pub(crate) fn double(&self, state: &mut AdaptiveState) {
        let rays: u64 = state.pending.iter().map(|&index| u64::from(state.pixels[index].samples)).sum();
        self.planned.fetch_add(rays, Ordering::Relaxed);
        while !state.pending.is_empty() {
            let before: &[Pixel] = &state.pixels;
            let second_halves: Vec<Option<Sums>> = state
                .pending
                .par_iter()
                .with_min_len(4)
                .map_init(
                    || self.exposer.workers(),
                    |worker, &index| {
                        if self.pauses() {
                            return None;
                        }
                        let samples = before[index].samples;
                        let sums = self.sums(worker, index, samples..2 * samples);
                        self.report(samples);
                        Some(sums)
                    },
                )
                .collect();
            let mut halves = second_halves.into_iter();
            let pixels = &mut state.pixels;
            state.pending.retain(|&index| match halves.next().flatten() {
                Some(half) => {
                    pixels[index].double(&half);
                    false
                }
                None => true,
            });
            if self.progress.stops() {
                return;
            }
            if !state.pending.is_empty() {
                self.save(state);
            }
        }
    }

    /// The means of all pixels, in each band that is kept apart.
    fn means(&self, pixels: &[Pixel]) -> Vec<f64> {
        if self.bands == 0 {
            return pixels.iter().map(Pixel::mean).collect();
        }
        let of_pixel = |pixel: &Pixel| pixel.bands.map(|sum| sum / f64::from(pixel.samples.max(1)));
        pixels.iter().flat_map(|pixel| of_pixel(pixel).into_iter().take(self.bands)).collect()
    }

    /// Those of the cells around the picture, each over as many rays as a pixel has on average.
    fn around(&self, pixels: &[Pixel]) -> Vec<f64> {
        let taken: u64 = pixels.iter().map(|pixel| u64::from(pixel.samples)).sum();
        let samples = (taken / pixels.len() as u64).next_power_of_two().clamp(1, u64::from(MAX_SAMPLES)) as u32;
        let around: Vec<Pixel> = (pixels.len()..self.exposer.rays.cells() as usize)
            .into_par_iter()
            .with_min_len(4)
            .map_init(
                || self.exposer.workers(),
                |worker, cell| {
                    self.report(samples);
                    let Sums { whole, bands } = self.sums(worker, cell, 0..samples);
                    Pixel { samples, sum: whole, bands, ..Pixel::default() }
                },
            )
            .collect();
        self.means(&around)
    }

    pub(crate) fn save(&self, state: &AdaptiveState) {
        self.progress.save(self.checkpoint(state.clone()));
    }

    /// The checkpoint of a state. A lattice of pixels takes seconds and depends on no more than the seed, so its checkpoint is an empty
    /// one: a resumed exposure begins the same lattice again and ends with the same bits.
    fn checkpoint(&self, state: AdaptiveState) -> Checkpoint {
        let is_on_lattice = self.is_on_lattice.load(Ordering::Relaxed);
        Checkpoint(State::Adaptive(if is_on_lattice { state.restarted() } else { state }))
    }

    /// Sums of radiance·cos⁴ over some of a pixel's samples; every pixel has a scramble of the sequence of its own.
    pub(crate) fn sums(&self, worker: &mut Workers<'_>, pixel: usize, samples: std::ops::Range<u32>) -> Sums {
        let first = (pixel as u64) << SEQUENCE_LOG2;
        let Exposer { rays, weights, .. } = *self.exposer;
        let number = pixel as u64;
        let drawn = samples.filter_map(|sample| {
            let index = first | u64::from(sample);
            let u = RaySampler::new(rays.seed(), index).take(DimensionSet::CAMERA);
            self.images.ray(rays, pixel, u).map(|(ray, weight)| (index, ray, weight))
        });
        if self.bands == 0 {
            let light = drawn
                .map(|(index, ray, weight)| weight * ray.cos4 * radiance(worker, index, (rays, number), &ray, weights));
            return Sums { whole: light.sum(), ..Sums::default() };
        }
        let mut bands = [0.0; MOST_BANDS];
        for (index, ray, weight) in drawn {
            let light = radiance_apart(worker, index, (rays, number), &ray, weights);
            bands.iter_mut().zip(light).for_each(|(sum, light)| *sum += weight * ray.cos4 * light);
        }
        Sums { whole: weights.combine_apart(number, &bands[..self.bands]), bands }
    }
}

/// The images of the first lights that any pixel shows, by which its rays are aimed.
fn images(exposer: &Exposer<'_>) -> PixelImages {
    let found = PixelImages::find(exposer.renderer, exposer.rays);
    let other = || exposer.by_row.iter().map(|light| PixelImages::find(&light.renderer, exposer.rays));
    if found.is_empty() { other().find(|images| !images.is_empty()).unwrap_or(found) } else { found }
}

/// What is known of the error.
pub(crate) struct Estimate {
    /// Squared error of each pixel relative to the mean of all.
    pub(crate) pixels: Vec<PixelError>,
    /// The mean radiance·cos⁴ over all pixels.
    pub(crate) mean: f64,
}

impl Estimate {
    fn new(pixels: &[Pixel], columns: usize) -> Estimate {
        let mean = pixels.iter().map(Pixel::mean).sum::<f64>() / pixels.len() as f64;
        let unit = if mean > 0.0 { (mean * mean).recip() } else { 0.0 };
        // As if of one sample, so that neighbours with other numbers of samples can be added up.
        let of_one = |squared: fn(&Pixel) -> f64| -> Vec<f64> {
            pixels.iter().map(|pixel| squared(pixel) * f64::from(pixel.samples)).collect()
        };
        let (last, before) = (of_one(|pixel| pixel.last), of_one(|pixel| pixel.before));
        let near = window_means(&last, columns, NEAR);
        let (around, around_before) = (window_means(&last, columns, AROUND), window_means(&before, columns, AROUND));
        let estimate = |(index, pixel): (usize, &Pixel)| {
            let gain = gain(around[index], around_before[index]);
            unit_error(pixel, near[index], gain, unit)
        };
        Estimate { pixels: pixels.iter().enumerate().map(estimate).collect(), mean }
    }

    pub(crate) fn relative_error(&self) -> f64 {
        let mean_square = self.pixels.iter().map(|pixel| pixel.squared).sum::<f64>() / self.pixels.len() as f64;
        CHANCE_AGREEMENT * mean_square.sqrt()
    }

    /// What it says of each pixel; `scale` is the exposure for a radiance of 1, J/m².
    fn statistics(&self, scale: f64) -> PixelStatistics {
        let error = |pixel: &PixelError| CHANCE_AGREEMENT * scale * self.mean * pixel.squared.sqrt();
        PixelStatistics {
            standard_errors: self.pixels.iter().map(error).collect(),
            samples: self.pixels.iter().map(|pixel| pixel.samples).collect(),
        }
    }

    /// The pixels whose doubling lowers the error most for its cost, as many as it takes to reach the asked error. Of pixels that need
    /// a fraction of a doubling that fraction is doubled, evenly over the picture.
    fn choose(&self, error: f64) -> Vec<usize> {
        let needed = doublings(&self.pixels, (error / CHANCE_AGREEMENT).powi(2), MAX_SAMPLES);
        let is_chosen = |(index, needed): &(usize, f64)| *needed > (*index as f64 * GOLDEN).fract();
        needed.into_iter().enumerate().filter(is_chosen).map(|(index, _)| index).collect()
    }
}

/// The factor by which `⟨d²⟩` falls at a doubling, from its last two values around a pixel.
pub(crate) fn gain(last: f64, before: f64) -> f64 {
    let prior = PRIOR * before;
    let gain = (last + prior * GAIN_RANGE.1) / (before + prior);
    if gain.is_finite() { gain.clamp(GAIN_RANGE.0, GAIN_RANGE.1) } else { GAIN_RANGE.1 }
}

/// A pixel's squared error times `unit`, where `near` is d² as if of one sample near it.
pub(crate) fn unit_error(pixel: &Pixel, near: f64, gain: f64, unit: f64) -> PixelError {
    let pooled = (near / f64::from(pixel.samples)).max(0.25 * pixel.last);
    // The fall slows down when only edges are left.
    let later = 0.5 * (gain + GAIN_RANGE.1);
    PixelError { squared: unit * pooled * later / (1.0 - later), gain, samples: pixel.samples }
}

/// Multiples of it are spread evenly between whole numbers.
pub(crate) const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// One squared difference alone says little: they are averaged over a pixel and its neighbours up to this distance.
pub(crate) const NEAR: usize = 1;

/// Their fall from doubling to doubling is taken from neighbours up to this distance.
pub(crate) const AROUND: usize = 3;

/// Share of what is known of that fall that is taken to be of independent samples.
const PRIOR: f64 = 0.1;

/// The mean over the square of pixels within `reach` of each, as far as the picture goes.
fn window_means(values: &[f64], columns: usize, reach: usize) -> Vec<f64> {
    let rows = values.len() / columns.max(1);
    let along = |count: usize, at: &dyn Fn(usize) -> f64| -> Vec<f64> {
        let window = |index: usize| index.saturating_sub(reach)..(index + reach + 1).min(count);
        (0..count).map(|index| window(index).map(at).sum::<f64>() / window(index).len() as f64).collect()
    };
    let in_rows: Vec<f64> =
        values.chunks(columns.max(1)).flat_map(|row| along(row.len(), &|column| row[column])).collect();
    let mut means = vec![0.0; values.len()];
    for column in 0..columns {
        let of_column = along(rows, &|row| in_rows[row * columns + column]);
        of_column.into_iter().enumerate().for_each(|(row, mean)| means[row * columns + column] = mean);
    }
    means
}
