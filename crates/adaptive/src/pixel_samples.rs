//! The samples of one pixel.

use std::fmt::Debug;

/// Number of bits of a ray's number that count the samples of a pixel.
const SEQUENCE_LOG2: u32 = 16;

/// Maximum number of samples of a pixel: the length of one scrambled sequence.
pub const MAX_SAMPLES: u32 = 1 << SEQUENCE_LOG2;

/// Samples of every pixel before the first error estimate: one, and two doublings.
pub const FIRST_SAMPLES: u32 = 4;

/// The number of a ray: every pixel, or other stream of rays, has its own scramble of the sequence.
#[must_use]
pub fn ray_number(pixel: u64, sample: u32) -> u64 {
    pixel << SEQUENCE_LOG2 | u64::from(sample)
}

/// The pixel of a ray number.
#[must_use]
pub fn pixel_of_ray(number: u64) -> u64 {
    number >> SEQUENCE_LOG2
}

/// The sums over the samples of a pixel.
pub trait SampleSums: Copy + Debug + Default + PartialEq + Send + Sync {
    /// The difference between the means of the two halves of the samples, from which the error is
    /// estimated: as it is, or squared.
    type HalfDifference: Copy + Debug + Default + PartialEq + Send + Sync;

    /// The mean of a sample.
    type Mean;

    /// Adds the sums of other samples.
    fn add(&mut self, other: &Self);

    /// Half the difference between the means of the halves; `samples` in each half.
    fn half_difference(first: &Self, second: &Self, samples: u32) -> Self::HalfDifference;

    /// The mean, of at least one sample.
    fn mean(&self, samples: u32) -> Self::Mean;
}

/// Red, green and blue; differences have single precision.
impl SampleSums for [f64; 3] {
    type HalfDifference = [f32; 3];
    type Mean = [f64; 3];

    fn add(&mut self, other: &Self) {
        *self = std::array::from_fn(|band| self[band] + other[band]);
    }

    fn half_difference(first: &Self, second: &Self, samples: u32) -> [f32; 3] {
        std::array::from_fn(|band| ((second[band] - first[band]) / f64::from(2 * samples)) as f32)
    }

    fn mean(&self, samples: u32) -> [f64; 3] {
        self.map(|sum| sum / f64::from(samples))
    }
}

/// The samples of one pixel so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelSamples<S: SampleSums> {
    /// Sums over all samples.
    pub sums: S,
    /// 0 before the first sample.
    pub samples: u32,
    /// Of the last doubling.
    pub last: S::HalfDifference,
    /// Of the doubling before it.
    pub before: S::HalfDifference,
}

impl<S: SampleSums> PixelSamples<S> {
    /// A number of samples without differences of their halves.
    #[must_use]
    pub fn of(sums: S, samples: u32) -> PixelSamples<S> {
        PixelSamples { sums, samples, ..PixelSamples::default() }
    }

    /// 0 before the first sample.
    #[must_use]
    pub fn mean(&self) -> S::Mean {
        self.sums.mean(self.samples.max(1))
    }

    /// Adds the second half of the samples.
    pub fn double(&mut self, second_half: &S) {
        self.before = self.last;
        self.last = S::half_difference(&self.sums, second_half, self.samples);
        self.sums.add(second_half);
        self.samples *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_the_difference_of_the_halves_is_the_deviation_of_each_from_the_mean() {
        let mut pixel = PixelSamples::of([4.0, 2.0, 0.0], 2);
        pixel.double(&[8.0, 2.0, 2.0]);
        assert_eq!((pixel.samples, pixel.mean()), (4, [3.0, 1.0, 0.5]));
        assert_eq!((pixel.last, pixel.before), ([1.0, 0.0, 0.5], [0.0; 3]));
        pixel.double(&[12.0, 4.0, 2.0]);
        assert_eq!((pixel.last, pixel.before), ([0.0; 3], [1.0, 0.0, 0.5]));
    }

    #[test]
    fn rays_of_pixels_have_different_numbers() {
        assert_eq!(ray_number(3, MAX_SAMPLES - 1) + 1, ray_number(4, 0));
        assert_eq!(pixel_of_ray(ray_number(3, MAX_SAMPLES - 1)), 3);
    }
}
