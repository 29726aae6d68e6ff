//! Sums over samples of a pixel.

use crate::radiance::MAX_BANDS;
use radsight_adaptive::{PixelSamples, SampleSums};

/// The samples of one pixel, with the squared half differences d² of the last two doublings.
pub(crate) type Pixel = PixelSamples<Sums>;

/// Sums of radiance·cos⁴ over some samples of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sums {
    /// Of all bands.
    pub(crate) whole: f64,
    /// Of the separate bands, else 0.
    pub(crate) bands: [f64; MAX_BANDS],
}

impl SampleSums for Sums {
    /// Squared.
    type HalfDifference = f64;
    type Mean = f64;

    fn add(&mut self, other: &Sums) {
        self.whole += other.whole;
        self.bands.iter_mut().zip(other.bands).for_each(|(sum, band)| *sum += band);
    }

    fn half_difference(first: &Sums, second: &Sums, samples: u32) -> f64 {
        let half_difference = (second.whole - first.whole) / f64::from(2 * samples);
        half_difference * half_difference
    }

    fn mean(&self, samples: u32) -> f64 {
        self.whole / f64::from(samples)
    }
}
