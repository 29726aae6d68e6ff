//! Replicas of pixels: pictures of a few pixels have too few differences between halves for an
//! estimate.
//!
//! Two halves of the samples of one pixel may agree by chance, and the work would end. Neighbours
//! make an estimate reliable: a difference of each of them is known. Where there are too few of them, each
//! pixel is divided into replicas. A replica has samples of its own, and the sampler treats it as a
//! pixel. The mean of a pixel is that of its replicas.

use crate::allocation::PixelError;
use crate::pixel_samples::{FIRST_SAMPLES, MAX_SAMPLES, PixelSamples, SampleSums};
use crate::refine::{PixelSource, SamplingState, first_samples};
use std::ops::Range;

/// Least number of pixels, with their replicas, from whose differences an error is estimated. With 16,
/// pictures whose noise is that of a few pixels ended at 1.7 times the requested error.
const LEAST_ESTIMATES: usize = 64;

/// Share of the requested squared error at which replicas end: the estimate of a few ends the work where it
/// is low by chance.
const SHARE_FOR_CHANCE: f64 = 0.8;

/// The number of replicas of each pixel: a power of two, and 1 for pictures of enough pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Replicas(u32);

impl Replicas {
    /// One: the pixel itself.
    pub const ONE: Replicas = Replicas(1);

    /// For a picture of so many pixels that have at most `most_samples` each.
    ///
    /// ```
    /// use radsight_adaptive::{MAX_SAMPLES, Replicas};
    /// let of = |pixels| Replicas::new(pixels, MAX_SAMPLES).count();
    /// assert_eq!([1, 6, 15, 64, 1 << 20].map(of), [64, 16, 8, 1, 1]);
    /// ```
    #[must_use]
    pub fn new(pixels: usize, most_samples: u32) -> Replicas {
        let wanted = LEAST_ESTIMATES.div_ceil(pixels.max(1)).next_power_of_two() as u32;
        let room = (most_samples.clamp(FIRST_SAMPLES, MAX_SAMPLES) / FIRST_SAMPLES).max(1);
        Replicas(wanted.min(1 << room.ilog2()))
    }

    /// Replicas of each pixel.
    #[must_use]
    pub fn count(self) -> usize {
        self.0 as usize
    }

    /// Maximum number of samples of a replica, where a pixel may have `most_samples`.
    #[must_use]
    pub fn most_samples(self, most_samples: u32) -> u32 {
        most_samples.min(MAX_SAMPLES) / self.0
    }

    /// The mean squared error of replicas at which that of their pixels is the requested one.
    #[must_use]
    pub fn squared_target(self, requested: f64) -> f64 {
        if self == Replicas::ONE { requested } else { SHARE_FOR_CHANCE * f64::from(self.0) * requested }
    }

    /// The replica of a sample of a pixel, and the sample's number within it.
    #[must_use]
    pub fn place(self, sample: u32) -> [u32; 2] {
        let length = MAX_SAMPLES / self.0;
        [sample / length, sample % length]
    }

    /// The samples of pixels, from those of all their replicas. The differences between halves are
    /// those of the first replica.
    #[must_use]
    pub fn merged<S: SampleSums>(self, replicas: &[PixelSamples<S>]) -> Vec<PixelSamples<S>> {
        let of_pixel = |replicas: &[PixelSamples<S>]| {
            let mut merged = replicas[0];
            for other in &replicas[1..] {
                merged.sums.add(&other.sums);
                merged.samples += other.samples;
            }
            merged
        };
        replicas.chunks(self.count()).map(of_pixel).collect()
    }

    /// The errors of pixels, from those of all their replicas: each counts by its samples.
    #[must_use]
    pub fn merged_errors(self, replicas: &[PixelError]) -> Vec<PixelError> {
        let parts = self.parts(replicas);
        let of_pixel = |(replicas, parts): (&[PixelError], &[f64])| PixelError {
            squared: parts.iter().sum::<f64>() / parts.len() as f64,
            gain: replicas[0].gain,
            samples: total_samples(replicas),
        };
        replicas.chunks(self.count()).zip(parts.chunks(self.count())).map(of_pixel).collect()
    }

    /// What each replica contributes to the squared error of its pixel, times their number.
    #[must_use]
    pub fn parts(self, replicas: &[PixelError]) -> Vec<f64> {
        let of_pixel = |replicas: &[PixelError]| {
            let (count, samples) = (replicas.len() as f64, f64::from(total_samples(replicas)));
            let part =
                move |replica: &PixelError| count * (f64::from(replica.samples) / samples).powi(2) * replica.squared;
            replicas.iter().map(part).collect::<Vec<f64>>()
        };
        replicas.chunks(self.count()).flat_map(of_pixel).collect()
    }
}

fn total_samples(replicas: &[PixelError]) -> u32 {
    replicas.iter().map(|replica| replica.samples).sum()
}

/// The replicas of the pixels of a source: those of the first pixel, then those of the second. Each
/// has an equal part of the source's samples of its pixel.
#[derive(Clone, Copy, Debug)]
pub struct ReplicatedSource<'s, P> {
    source: &'s P,
    replicas: Replicas,
}

impl<'s, P: PixelSource> ReplicatedSource<'s, P> {
    /// Of a source.
    #[must_use]
    pub fn new(source: &'s P, replicas: Replicas) -> ReplicatedSource<'s, P> {
        ReplicatedSource { source, replicas }
    }
}

impl<P: PixelSource> PixelSource for ReplicatedSource<'_, P> {
    type Sums = P::Sums;
    type Worker = P::Worker;

    fn worker(&self) -> P::Worker {
        self.source.worker()
    }

    fn sums(&self, worker: &mut P::Worker, pixel: usize, samples: Range<u32>) -> P::Sums {
        let count = self.replicas.count();
        let first = (pixel % count) as u32 * (MAX_SAMPLES / self.replicas.0);
        self.source.sums(worker, pixel / count, first + samples.start..first + samples.end)
    }

    fn first(&self, worker: &mut P::Worker, pixel: usize) -> PixelSamples<P::Sums> {
        match self.replicas {
            Replicas::ONE => self.source.first(worker, pixel),
            _ => first_samples(self, worker, pixel),
        }
    }

    fn stops(&self) -> bool {
        self.source.stops()
    }

    fn pauses(&self) -> bool {
        self.source.pauses()
    }

    fn save(&self, state: &SamplingState<P::Sums>) {
        self.source.save(state);
    }

    fn plan(&self, samples: u64) {
        self.source.plan(samples);
    }

    fn traced(&self, samples: u32) {
        self.source.traced(samples);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sum of the numbers of the samples.
    struct Numbers;

    impl PixelSource for Numbers {
        type Sums = [f64; 3];
        type Worker = ();

        fn worker(&self) {}

        fn sums(&self, (): &mut (), pixel: usize, samples: Range<u32>) -> [f64; 3] {
            [samples.map(f64::from).sum(), pixel as f64, 0.0]
        }
    }

    #[test]
    fn replicas_have_samples_of_their_own() {
        let replicas = Replicas::new(20, MAX_SAMPLES);
        let source = ReplicatedSource::new(&Numbers, replicas);
        let [first, second] = [4, 5].map(|replica| source.sums(&mut (), replica, 0..1));
        assert_eq!((first, second), ([0.0, 1.0, 0.0], [f64::from(MAX_SAMPLES / 4), 1.0, 0.0]));
        assert_eq!(replicas.place(MAX_SAMPLES / 4 + 7), [1, 7]);
    }

    #[test]
    fn a_limit_of_samples_leaves_fewer_replicas() {
        assert_eq!([1, 4, 9, 64, 65].map(|most| Replicas::new(1, most).count()), [1, 1, 2, 16, 16]);
    }

    #[test]
    fn replicas_are_merged_by_their_samples() {
        let replica = |samples: u32, value: f64| PixelSamples::of([value * f64::from(samples); 3], samples);
        let pixels = Replicas(2).merged(&[replica(4, 1.0), replica(12, 2.0)]);
        assert_eq!((pixels.len(), pixels[0].samples, pixels[0].mean()), (1, 16, [1.75; 3]));
        let error = |samples, squared| PixelError { squared, gain: 0.5, samples };
        let merged = Replicas(2).merged_errors(&[error(8, 2.0), error(8, 4.0)]);
        assert_eq!(merged, [error(16, 1.5)]);
    }
}
