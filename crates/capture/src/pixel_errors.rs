//! The errors of pixels, estimated from the differences between halves of their samples.
//!
//! The number of samples of a pixel is doubled. The two halves of a low-discrepancy sequence
//! complement each other, so the variance of single samples says little about the error of their
//! mean. The difference between the means of the two halves does. Let `e(n)` be the error of the
//! mean of n samples, and `d(n)` half the difference between the means of its halves. For
//! exchangeable halves `⟨e(n)²⟩ = ⟨e(n/2)²⟩ − ⟨d(n)²⟩`, so `⟨e(n)²⟩ = ⟨d(2n)²⟩ + ⟨d(4n)²⟩ + …`. If
//! `⟨d²⟩` falls by a factor q at each doubling, the sum is `⟨d(n)²⟩·q/(1−q)`: all of `⟨d²⟩` for
//! independent samples (q = ½), and much less for smooth integrands. q is estimated in a window
//! around each pixel, since smooth regions converge faster than edges.

use crate::PixelStatistics;
use crate::neighbourhood::window_means;
use crate::sums::Pixel;
use crate::window_sums::WindowSums;
use radsight_adaptive::{ErrorEstimate, FIRST_SAMPLES, PixelError, PixelSamples, SampleSums};

/// Limits of the estimated factor q by which `⟨d²⟩` falls.
const GAIN_RANGE: (f64, f64) = (0.25, 0.5);

/// Correction of the selection bias: pixels whose halves agree by chance are not refined, so the
/// estimated error is too low. On pictures with sharp shadow edges it was a quarter too low,
/// measured against pictures that were integrated by other means.
pub(crate) const SELECTION_BIAS: f64 = 1.33;

/// Radius of the window for d², in pixels: a single squared difference says little.
const ERROR_WINDOW: usize = 1;

/// Radius of the window for the factor by which d² falls, in pixels.
const GAIN_WINDOW: usize = 3;

/// Weight of the prior for that factor: independent samples.
const PRIOR_WEIGHT: f64 = 0.1;

/// The estimated error.
pub(crate) struct Estimate {
    /// Squared error of each pixel, relative to the mean of all pixels.
    pub(crate) pixels: Vec<PixelError>,
    /// The mean radiance·cos⁴ over all pixels.
    pub(crate) mean: f64,
}

impl Estimate {
    pub(crate) fn new(pixels: &[Pixel], columns: usize) -> Estimate {
        let mean = pixels.iter().map(Pixel::mean).sum::<f64>() / pixels.len() as f64;
        let unit = relative_unit(mean);
        // Scaled to one sample, so that pixels with different numbers of samples can be added.
        let of_one = |squared: fn(&Pixel) -> f64| -> Vec<f64> {
            pixels.iter().map(|pixel| squared(pixel) * f64::from(pixel.samples)).collect()
        };
        let (last, before) = (of_one(|pixel| pixel.last), of_one(|pixel| pixel.before));
        let near = window_means(&last, columns, ERROR_WINDOW);
        let (wide, wide_before) =
            (window_means(&last, columns, GAIN_WINDOW), window_means(&before, columns, GAIN_WINDOW));
        let estimate = |(index, pixel): (usize, &Pixel)| {
            let gain = gain(wide[index], wide_before[index]);
            unit_error(pixel, near[index], gain, unit)
        };
        Estimate { pixels: pixels.iter().enumerate().map(estimate).collect(), mean }
    }

    pub(crate) fn relative_error(&self) -> f64 {
        let mean_square = self.pixels.iter().map(|pixel| pixel.squared).sum::<f64>() / self.pixels.len() as f64;
        SELECTION_BIAS * mean_square.sqrt()
    }

    /// The statistics of each pixel; `scale` is the exposure for a radiance of 1, J/m².
    pub(crate) fn statistics(&self, scale: f64) -> PixelStatistics {
        let error = |pixel: &PixelError| SELECTION_BIAS * scale * self.mean * pixel.squared.sqrt();
        PixelStatistics {
            standard_errors: self.pixels.iter().map(error).collect(),
            samples: self.pixels.iter().map(|pixel| pixel.samples).collect(),
        }
    }
}

/// The factor of squared errors that makes them relative to a mean. 0 without light, and where it is so little that
/// its square is nothing: there is no relative error.
pub(crate) fn relative_unit(mean: f64) -> f64 {
    let unit = (mean * mean).recip();
    if mean > 0.0 && unit.is_finite() { unit } else { 0.0 }
}

impl ErrorEstimate for Estimate {
    fn pixels(&self) -> &[PixelError] {
        &self.pixels
    }
}

/// The factor by which `⟨d²⟩` falls at a doubling, from its last two values around a pixel.
pub(crate) fn gain(last: f64, before: f64) -> f64 {
    let prior = PRIOR_WEIGHT * before;
    let gain = (last + prior * GAIN_RANGE.1) / (before + prior);
    if gain.is_finite() { gain.clamp(GAIN_RANGE.0, GAIN_RANGE.1) } else { GAIN_RANGE.1 }
}

/// Squared error of a pixel times `unit`. `near` is the mean d² around it, scaled to one sample.
pub(crate) fn unit_error<S>(pixel: &PixelSamples<S>, near: f64, gain: f64, unit: f64) -> PixelError
where
    S: SampleSums<HalfDifference = f64>,
{
    let pooled = (near / f64::from(pixel.samples)).max(0.25 * pixel.last);
    // Convergence slows down when only edges are left.
    let later = 0.5 * (gain + GAIN_RANGE.1);
    PixelError { squared: unit * pooled * later / (1.0 - later), gain, samples: pixel.samples }
}

/// How the noise of a pixel is pooled with that of pixels around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NoisePooling {
    /// With the pixels beside it.
    Near,
    /// With a wider window until the pixel has [`MIN_KNOWN`] samples, then with the pixels beside it.
    /// Glossy surfaces that are lit by way of others, and what dielectrics show, have rare and bright
    /// rays. A pixel whose first rays met some would get more of them, and one whose rays met none
    /// would stay too dark.
    WideFirst,
}

impl NoisePooling {
    /// Whether the noise of a pixel is that of a wider window.
    fn is_wide(self, pixel: &Pixel) -> bool {
        self == NoisePooling::WideFirst && pixel.samples < MIN_KNOWN
    }
}

/// Number of samples from which a pixel's own noise counts, where some rays are rare and bright.
const MIN_KNOWN: u32 = 16;

/// The noise of some pixels, pooled with the others near them. `stride` gives the distance between
/// them around a pixel, and 0 for all other pixels. Those without a second half of samples are not
/// pooled.
pub(crate) fn pooled_errors(
    (pixels, pooling): (&[Pixel], NoisePooling),
    columns: usize,
    stride: impl Fn(usize) -> usize,
) -> Vec<(usize, PixelError)> {
    let counted = |(index, pixel): (usize, &Pixel)| {
        let samples = f64::from(pixel.samples);
        let is_pooled = pixel.samples >= FIRST_SAMPLES && stride(index) > 0;
        if is_pooled { [1.0, pixel.last * samples, pixel.before * samples] } else { [0.0; 3] }
    };
    let sums = WindowSums::new(pixels.iter().enumerate().map(counted), columns);
    let everywhere = pixels.len().max(columns);
    let of_pixel = |index: usize| {
        let stride = stride(index);
        let wide = sums.around(index, GAIN_WINDOW * stride);
        let wide = if wide[0] < 0.5 { sums.around(index, everywhere) } else { wide };
        let near = sums.around(index, ERROR_WINDOW * stride);
        let near = if near[0] < 0.5 { wide } else { near };
        let gain = gain(wide[1] / wide[0].max(1.0), wide[2] / wide[0].max(1.0));
        if pooling.is_wide(&pixels[index]) {
            let unknown = Pixel { last: 0.0, ..pixels[index] };
            return (index, unit_error(&unknown, wide[1] / wide[0].max(1.0), gain, 1.0));
        }
        (index, unit_error(&pixels[index], near[1] / near[0].max(1.0), gain, 1.0))
    };
    (0..pixels.len()).filter(|pixel| stride(*pixel) > 0).map(of_pixel).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sums::Sums;

    #[test]
    fn light_whose_square_is_nothing_has_no_relative_error() {
        for light in [0.0, 1e-200, 1e-170] {
            let sums = Sums { whole: light, ..Sums::default() };
            let pixel = Pixel { samples: 1, sums, last: light * light, before: light * light };
            assert_eq!(Estimate::new(&[pixel; 9], 3).relative_error(), 0.0, "{light}");
        }
    }

    #[test]
    fn pixels_without_a_second_half_take_the_noise_of_the_others() {
        let pair = Pixel { samples: 2, ..Pixel::default() };
        let known = Pixel { samples: FIRST_SAMPLES, last: 0.5, before: 1.0, ..Pixel::default() };
        let mut pixels = vec![pair; 30];
        pixels[7] = known;
        let errors = pooled_errors((&pixels, NoisePooling::Near), 10, |_| 1);
        let squared = |pixel: usize| errors[pixel].1.squared;
        assert_eq!(squared(7), 0.5);
        // Half as many samples, beside it and far away.
        assert_eq!([squared(6), squared(17), squared(20), squared(29)], [1.0; 4]);
    }

    #[test]
    fn a_pixel_with_few_samples_has_the_noise_of_a_wider_window() {
        let quiet = Pixel { samples: FIRST_SAMPLES, ..Pixel::default() };
        let mut pixels = vec![quiet; 100];
        pixels[33] = Pixel { last: 0.5, before: 1.0, ..quiet };
        let squared = |pixels: &[Pixel], pixel: usize| {
            pooled_errors((pixels, NoisePooling::WideFirst), 10, |_| 1)[pixel].1.squared
        };
        // The 49 pixels around it have the same noise, and those beyond have none.
        assert_eq!([33, 34, 66].map(|pixel| squared(&pixels, pixel)), [0.5 / 49.0; 3]);
        assert_eq!(squared(&pixels, 37), 0.0);
        pixels[33].samples = MIN_KNOWN;
        assert!(squared(&pixels, 33) > 0.1);
    }
}
