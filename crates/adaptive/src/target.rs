//! The target of the adaptive sampler, and the selection of pixels.

use crate::allocation::{PixelError, doublings};
use crate::pixel_samples::MAX_SAMPLES;

/// The quality that a user requests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorTarget {
    /// Relative error, rms over the pixels; above 0. For a picture `sqrt(mean(d²/(v² +
    /// (0.01·m)²)))` over the bands of all pixels, with the error d of a value v and the typical
    /// value m of the band; it includes noise and interpolation bias of cached irradiance. For an
    /// exposure relative to its mean.
    pub error: f64,
    /// Maximum number of samples of a pixel, at most [`MAX_SAMPLES`].
    pub most_samples: u32,
}

impl ErrorTarget {
    /// With as many samples as a pixel can have.
    #[must_use]
    pub fn new(error: f64) -> ErrorTarget {
        ErrorTarget { error, most_samples: MAX_SAMPLES }
    }
}

/// Why the work ended with more error than requested.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The maximum number of rays per pixel, or of passes, was reached.
    Rays,
    /// What is left is the error of light that pixels share, which more rays do not lower.
    Shared,
    /// The time limit was reached, or the user stopped it.
    Time,
}

/// The pixels whose samples a pass doubles, if the target needs a fraction of a doubling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Selection {
    /// All of them.
    Every,
    /// A fraction of the pixels, spread evenly over the picture.
    Fraction,
    /// The same; if that is none, the pixel that needs most.
    FractionOrFirst,
}

/// How certain it must be that the target is reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Certainty {
    /// The estimate is within the target.
    Estimate,
    /// The estimate plus one standard error is within the target. Where a few pixels have most of
    /// the noise, its estimate is uncertain; the target is then lowered, to a limit.
    StandardError {
        /// Number of pixels per independent estimate: the inverse of the sum of the squared weights
        /// with which an estimate averages over neighbours.
        pixels_per_estimate: f64,
    },
}

/// When the noise of pixels is low enough, and what may be done for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseTarget {
    /// Mean squared error of the pixels, in units of [`crate::ErrorEstimate::unit`].
    pub squared: f64,
    /// Maximum number of samples of a pixel.
    pub most_samples: u32,
    /// Maximum number of passes, counted in [`crate::SamplingState::passes`].
    pub most_passes: u32,
    /// The pixels whose samples are doubled.
    pub selection: Selection,
    /// How certain it must be.
    pub certainty: Certainty,
}

/// The factor by which the target is lowered at a time, and the least target.
const TARGET_STEP: f64 = 0.7;
const MIN_TARGET: f64 = 0.03;

impl NoiseTarget {
    /// With as many samples and passes as possible, for the estimate alone.
    #[must_use]
    pub fn new(squared: f64, selection: Selection) -> NoiseTarget {
        NoiseTarget {
            squared,
            most_samples: MAX_SAMPLES,
            most_passes: u32::MAX,
            selection,
            certainty: Certainty::Estimate,
        }
    }

    /// Selects the pixels to double; none where the target is reached or cannot be. `target` is
    /// [`NoiseTarget::squared`] at first, and lowered where the estimate is uncertain.
    pub(crate) fn choose(&self, pixels: &[PixelError], unit: f64, target: &mut f64) -> (Vec<usize>, Option<Stop>) {
        let wanted = self.squared * unit;
        loop {
            let chosen = choose(pixels, *target * unit, self.most_samples, self.selection);
            if !chosen.is_empty() {
                return (chosen, None);
            }
            let Certainty::StandardError { pixels_per_estimate } = self.certainty else {
                let mean = pixels.iter().map(|pixel| pixel.squared).sum::<f64>() / pixels.len() as f64;
                return (chosen, (mean > wanted && is_exhausted(pixels, self.most_samples)).then_some(Stop::Rays));
            };
            let mut errors = SquaredErrors::default();
            pixels.iter().for_each(|pixel| errors.add(pixel.squared));
            let [mean, variance] = errors.mean_and_variance(pixels_per_estimate);
            if mean > wanted {
                return (chosen, Some(Stop::Rays));
            }
            if mean + variance.sqrt() <= wanted || *target <= MIN_TARGET * self.squared {
                return (chosen, None);
            }
            *target *= TARGET_STEP;
        }
    }
}

/// Whether a pixel has as many samples as it may.
fn is_exhausted(pixels: &[PixelError], most: u32) -> bool {
    pixels.iter().any(|pixel| pixel.samples >= most)
}

/// Sums of the squared errors of pixels.
#[derive(Clone, Copy, Debug, Default)]
pub struct SquaredErrors {
    pixels: f64,
    errors: f64,
    squares: f64,
}

impl SquaredErrors {
    /// Adds the squared error of a pixel.
    pub fn add(&mut self, squared: f64) {
        self.pixels += 1.0;
        self.errors += squared;
        self.squares += squared * squared;
    }

    /// Number of pixels.
    #[must_use]
    pub fn pixels(&self) -> f64 {
        self.pixels
    }

    /// The mean, and its variance where that many pixels are one independent estimate.
    #[must_use]
    pub fn mean_and_variance(&self, pixels_per_estimate: f64) -> [f64; 2] {
        let mean = self.errors / self.pixels;
        let spread = (self.squares / self.pixels - mean * mean).max(0.0);
        [mean, spread * pixels_per_estimate / self.pixels]
    }
}

/// The pixels whose samples are to be doubled, for a mean squared error of `target`; no pixel gets
/// more than about `most` samples.
///
/// ```
/// use radsight_adaptive::{PixelError, Selection, choose};
/// let pixel = |squared| PixelError { squared, gain: 0.5, samples: 16 };
/// assert_eq!(choose(&[pixel(1e-6), pixel(1e-2), pixel(1e-6)], 1e-4, 1 << 16, Selection::Fraction), [1]);
/// ```
#[must_use]
pub fn choose(pixels: &[PixelError], target: f64, most: u32, selection: Selection) -> Vec<usize> {
    let needed = doublings(pixels, target, most);
    let threshold = |index| if selection == Selection::Every { 0.0 } else { selection_threshold(index) };
    let mut chosen: Vec<usize> = (0..needed.len()).filter(|&index| needed[index] > threshold(index)).collect();
    if chosen.is_empty() && selection == Selection::FractionOrFirst {
        let needy = (0..needed.len()).filter(|&index| needed[index] > 0.0);
        chosen.extend(needy.max_by(|&a, &b| needed[a].total_cmp(&needed[b])));
    }
    chosen
}

/// Fractional part of the golden ratio. The fractional parts of its multiples are uniform in [0,
/// 1).
const GOLDEN_RATIO: f64 = 0.618_033_988_749_894_9;

/// A number in [0, 1) for each pixel, even over the picture: pixels with lower ones are chosen
/// first.
#[must_use]
pub fn selection_threshold(pixel: usize) -> f64 {
    (pixel as f64 * GOLDEN_RATIO).fract()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen(target: &NoiseTarget, pixels: &[PixelError]) -> (Vec<usize>, Option<Stop>) {
        target.choose(pixels, 1.0, &mut target.squared.clone())
    }

    fn even(squared: f64, samples: u32) -> Vec<PixelError> {
        vec![PixelError { squared, gain: 0.5, samples }; 1000]
    }

    #[test]
    fn a_fraction_of_the_pixels_is_doubled_where_all_need_a_fraction_of_a_doubling() {
        // A doubling of all would halve the error: to lower it by a fifth takes a third of one.
        let pixels = even(1.25e-4, 16);
        let chosen = choose(&pixels, 1e-4, 1 << 16, Selection::Fraction).len() as f64 / 1000.0;
        assert!((chosen - 1.25_f64.log2()).abs() < 0.01, "{chosen}");
        assert_eq!(choose(&pixels, 1e-4, 1 << 16, Selection::Every).len(), 1000);
    }

    #[test]
    fn a_lone_pixel_with_a_small_fraction_is_chosen_if_asked() {
        let pixels = [PixelError { squared: 1.01e-4, gain: 0.5, samples: 16 }; 2];
        let one = &pixels[1..];
        assert_eq!(choose(one, 1e-4, 1 << 16, Selection::FractionOrFirst), [0]);
        assert_eq!(choose(&pixels, 1e-3, 1 << 16, Selection::FractionOrFirst), [0; 0]);
    }

    #[test]
    fn an_uncertain_estimate_lowers_the_target() {
        let mut pixels = even(1e-9, 16);
        pixels[7].squared = 0.09;
        let certain = Certainty::StandardError { pixels_per_estimate: 7.1 };
        let target = NoiseTarget { certainty: certain, ..NoiseTarget::new(1e-4, Selection::Every) };
        assert_eq!(chosen(&target, &pixels), (vec![7], None));
        let target = NoiseTarget::new(1e-4, Selection::Every);
        assert_eq!(chosen(&target, &pixels), (Vec::new(), None));
    }

    #[test]
    fn pixels_without_room_stop_the_work() {
        let target = NoiseTarget { most_samples: 64, ..NoiseTarget::new(1e-4, Selection::Every) };
        assert_eq!(chosen(&target, &even(1.0, 64)), (Vec::new(), Some(Stop::Rays)));
        assert_eq!(chosen(&target, &even(1.0, 32)).0.len(), 1000);
    }
}
