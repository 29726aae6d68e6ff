//! The adaptive sampler: first samples, and doublings until the target is reached.

use crate::allocation::PixelError;
use crate::pixel_samples::{FIRST_SAMPLES, PixelSamples, SampleSums};
use crate::target::{NoiseTarget, Stop};
use rayon::prelude::*;
use std::ops::Range;

/// Traces the samples of pixels.
pub trait PixelSource: Sync {
    /// The sums over the samples of a pixel.
    type Sums: SampleSums;

    /// The state of a thread that traces rays.
    type Worker;

    /// A new one.
    fn worker(&self) -> Self::Worker;

    /// Sums over some samples of a pixel: a function of the pixel and the samples' numbers alone.
    fn sums(&self, worker: &mut Self::Worker, pixel: usize, samples: Range<u32>) -> Self::Sums;

    /// The first samples of a pixel, with two doublings for the rate of convergence.
    fn first(&self, worker: &mut Self::Worker, pixel: usize) -> PixelSamples<Self::Sums> {
        first_samples(self, worker, pixel)
    }

    /// Whether the work should end now. Once true, it stays true.
    fn stops(&self) -> bool {
        false
    }

    /// Whether the threads should return to be joined, because the work ends or its state should be
    /// saved.
    fn pauses(&self) -> bool {
        self.stops()
    }

    /// Receives the state of paused work.
    fn save(&self, _state: &SamplingState<Self::Sums>) {}

    /// Receives the number of further samples that will be traced.
    fn plan(&self, _samples: u64) {}

    /// Receives the number of samples that were traced.
    fn traced(&self, _samples: u32) {}
}

/// The first samples of a pixel, with two doublings for the rate of convergence.
pub(crate) fn first_samples<P: PixelSource + ?Sized>(
    source: &P,
    worker: &mut P::Worker,
    pixel: usize,
) -> PixelSamples<P::Sums> {
    let samples = FIRST_SAMPLES / 4;
    let mut first = PixelSamples::of(source.sums(worker, pixel, 0..samples), samples);
    for _ in 0..2 {
        first.double(&source.sums(worker, pixel, first.samples..2 * first.samples));
    }
    first
}

/// The state of adaptive sampling, which can be saved and resumed with the same bits.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SamplingState<S: SampleSums> {
    /// Passes started.
    pub passes: u32,
    /// The samples of each pixel.
    pub pixels: Vec<PixelSamples<S>>,
    /// Pixels that the last pass selected for doubling and has not doubled yet.
    pub pending: Vec<usize>,
}

impl<S: SampleSums> SamplingState<S> {
    /// The state before the first sample.
    #[must_use]
    pub fn new(pixels: usize) -> SamplingState<S> {
        SamplingState { passes: 0, pixels: vec![PixelSamples::default(); pixels], pending: Vec::new() }
    }

    /// Number of samples of all pixels.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.pixels.iter().map(|pixel| u64::from(pixel.samples)).sum()
    }
}

/// The error of pixels, estimated from their samples.
pub trait ErrorEstimate {
    /// The estimated error of each pixel, from [`ErrorEstimate::first_pixel`] on.
    fn pixels(&self) -> &[PixelError];

    /// The first estimated pixel.
    fn first_pixel(&self) -> usize {
        0
    }

    /// The squared value to which errors are relative, if the estimate does not divide by it.
    fn unit(&self) -> f64 {
        1.0
    }
}

/// Traces the first samples of every pixel that has none, until the work is stopped.
pub fn begin<P: PixelSource>(source: &P, state: &mut SamplingState<P::Sums>) {
    loop {
        state.pixels.par_iter_mut().enumerate().with_min_len(32).for_each_init(
            || source.worker(),
            |worker, (index, pixel)| {
                if pixel.samples == 0 && !source.pauses() {
                    *pixel = source.first(worker, index);
                    source.traced(pixel.samples);
                }
            },
        );
        if source.stops() || state.pixels.iter().all(|pixel| pixel.samples > 0) {
            return;
        }
        source.save(state);
    }
}

/// Doubles the samples of the pending pixels, until the work is stopped.
pub fn double<P: PixelSource>(source: &P, state: &mut SamplingState<P::Sums>) {
    source.plan(state.pending.iter().map(|&index| u64::from(state.pixels[index].samples)).sum());
    while !state.pending.is_empty() {
        let mut halves = second_halves(source, state).into_iter();
        let SamplingState { pixels, pending, .. } = state;
        pending.retain(|&index| match halves.next().flatten() {
            Some(half) => {
                pixels[index].double(&half);
                false
            }
            None => true,
        });
        if source.stops() {
            return;
        }
        if !state.pending.is_empty() {
            source.save(state);
        }
    }
}

/// The second halves of the pending pixels' samples; `None` after a pause.
fn second_halves<P: PixelSource>(source: &P, state: &SamplingState<P::Sums>) -> Vec<Option<P::Sums>> {
    let half = |worker: &mut P::Worker, &index: &usize| {
        if source.pauses() {
            return None;
        }
        let samples = state.pixels[index].samples;
        let sums = source.sums(worker, index, samples..2 * samples);
        source.traced(samples);
        Some(sums)
    };
    state.pending.par_iter().with_min_len(4).map_init(|| source.worker(), half).collect()
}

/// Doubles samples where that lowers the error most for its cost, until the target is reached or
/// the work is stopped. Returns the estimate of the result, and why it misses the target.
pub fn refine<P: PixelSource, E: ErrorEstimate>(
    source: &P,
    state: &mut SamplingState<P::Sums>,
    target: &NoiseTarget,
    estimate: impl Fn(&[PixelSamples<P::Sums>]) -> E,
) -> (E, Option<Stop>) {
    double(source, state);
    let mut squared = target.squared;
    loop {
        let estimated = estimate(&state.pixels);
        let (chosen, stop) = target.choose(estimated.pixels(), estimated.unit(), &mut squared);
        if chosen.is_empty() {
            return (estimated, stop);
        }
        if source.stops() {
            return (estimated, Some(Stop::Time));
        }
        if state.passes >= target.most_passes {
            return (estimated, Some(Stop::Rays));
        }
        state.passes += 1;
        state.pending = chosen.into_iter().map(|index| estimated.first_pixel() + index).collect();
        double(source, state);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::target::Selection;
    use std::sync::atomic::{AtomicU32, Ordering};

    /// Independent noise whose standard deviation is the pixel's number.
    struct Noise {
        traced: AtomicU32,
        /// Number of samples after which the work stops.
        most: u32,
        /// Number of samples after which the work pauses once in a while.
        pause: u32,
    }

    impl PixelSource for Noise {
        type Sums = [f64; 3];
        type Worker = ();

        fn worker(&self) {}

        fn sums(&self, (): &mut (), pixel: usize, samples: Range<u32>) -> [f64; 3] {
            let noise = |sample: u32| {
                let bits = (u64::from(sample) << 32 | pixel as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
                let bits = (bits ^ bits >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9);
                (bits >> 40) as f64 / f64::from(1 << 24) - 0.5
            };
            [samples.map(|sample| 100.0 + pixel as f64 * 12.0_f64.sqrt() * noise(sample)).sum(); 3]
        }

        fn stops(&self) -> bool {
            self.traced.load(Ordering::Relaxed) >= self.most
        }

        fn pauses(&self) -> bool {
            self.stops() || self.traced.load(Ordering::Relaxed) % 64 >= self.pause
        }

        fn save(&self, _state: &SamplingState<[f64; 3]>) {
            let traced = self.traced.load(Ordering::Relaxed);
            self.traced.store(traced.next_multiple_of(64), Ordering::Relaxed);
        }

        fn traced(&self, samples: u32) {
            self.traced.fetch_add(samples, Ordering::Relaxed);
        }
    }

    struct Estimate(Vec<PixelError>);

    impl ErrorEstimate for Estimate {
        fn pixels(&self) -> &[PixelError] {
            &self.0
        }
    }

    /// Means over all pixels of the squared differences, by the known deviations.
    fn estimate(pixels: &[PixelSamples<[f64; 3]>]) -> Estimate {
        let of_one = |pixel: &PixelSamples<[f64; 3]>| f64::from(pixel.last[0]).powi(2) * f64::from(pixel.samples);
        let share: f64 =
            pixels.iter().map(of_one).sum::<f64>() / (0..pixels.len()).map(|p| (p * p) as f64).sum::<f64>();
        let error = |(index, pixel): (usize, &PixelSamples<[f64; 3]>)| PixelError {
            squared: share * (index * index) as f64 / f64::from(pixel.samples),
            gain: 0.5,
            samples: pixel.samples,
        };
        Estimate(pixels.iter().enumerate().map(error).collect())
    }

    fn refined(most: u32, pause: u32) -> (SamplingState<[f64; 3]>, Option<Stop>) {
        let source = Noise { traced: AtomicU32::new(0), most, pause };
        let mut state = SamplingState::new(64);
        begin(&source, &mut state);
        let (_, stop) = refine(&source, &mut state, &NoiseTarget::new(4.0, Selection::Fraction), estimate);
        (state, stop)
    }

    #[test]
    fn the_error_of_the_means_is_the_target() {
        let (state, stop) = refined(u32::MAX, u32::MAX);
        assert_eq!(stop, None);
        let squares = state.pixels.iter().map(|pixel| (pixel.mean()[0] - 100.0).powi(2));
        let found = squares.sum::<f64>() / 64.0;
        assert!((2.0..6.0).contains(&found), "{found} for 4");
        assert!(state.pixels[0].samples == FIRST_SAMPLES && state.pixels[63].samples >= 128);
    }

    #[test]
    fn pauses_do_not_change_the_result() {
        assert_eq!(refined(u32::MAX, u32::MAX), refined(u32::MAX, 40));
    }

    #[test]
    fn stopped_work_says_so() {
        let (_, stop) = refined(400, u32::MAX);
        assert_eq!(stop, Some(Stop::Time));
    }
}
