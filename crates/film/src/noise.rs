//! The noise of a picture's pixels, estimated from their own samples and those of their
//! neighbours.
//!
//! The estimate uses half the difference h between the means of the two halves of a pixel's
//! samples. If the squared error of a mean falls by a factor g with each doubling, so does h², and
//! the squared error of both halves together is h²·g/(1 − g). For independent samples g = ½ and the
//! factor is 1; for a low-discrepancy sequence both are smaller. A single difference says little,
//! so the squares of neighbours are averaged, including those of the previous doubling; g is
//! estimated for a whole block. What no sample has hit yet, such as the corner of a lamp, is
//! assumed to be like the neighbour that differs most.

use radsight_adaptive::{
    Certainty, ErrorEstimate, ErrorTarget, FIRST_SAMPLES, NoiseTarget, PixelError, PixelSamples, PixelSource, Replicas,
    ReplicatedSource, SamplingState, Selection, SquaredErrors, Stop, begin, refine,
};
use rayon::prelude::*;
use std::ops::Range;

/// Relative errors are relative to `sqrt(v² + (DARK_FRACTION·m)²)` with a pixel's value v and the
/// typical value m of the picture, so darker pixels need no more accuracy.
const DARK_FRACTION: f64 = 0.01;

/// The typical value limits pixels to this multiple of the median.
const BRIGHT_LIMIT: f64 = 10.0;

/// The samples of a pixel.
pub(crate) type Pixel = PixelSamples<[f64; 3]>;

/// The samples of the pixels of a picture, or of their replicas.
pub type FilmState = SamplingState<[f64; 3]>;

/// Estimates the errors of pixels relative to their values.
#[derive(Clone, Copy, Debug)]
pub struct PixelNoise {
    columns: usize,
    /// Of each pixel, in pictures of a few pixels.
    replicas: Replicas,
    /// Added in squares to the bands of a pixel where an error is relative to them.
    floors: [f64; 3],
}

impl PixelNoise {
    /// Traces the first samples of the pixels of a picture, until the source stops. No pixel will
    /// have more than the target's.
    #[must_use]
    pub fn begin<P>(source: &P, [columns, rows]: [usize; 2], target: ErrorTarget) -> (PixelNoise, FilmState)
    where
        P: PixelSource<Sums = [f64; 3]>,
    {
        let replicas = Replicas::new(columns * rows, target.most_samples);
        let mut state = SamplingState::new(columns * rows * replicas.count());
        begin(&ReplicatedSource::new(source, replicas), &mut state);
        let noise = PixelNoise { replicas, ..PixelNoise::new(&replicas.merged(&state.pixels), columns) };
        (noise, state)
    }

    /// For a picture with so many columns, whose pixels have their first samples.
    #[must_use]
    pub(crate) fn new(pixels: &[Pixel], columns: usize) -> PixelNoise {
        let floors = typical(pixels).map(|band| DARK_FRACTION * band);
        PixelNoise { columns, replicas: Replicas::ONE, floors }
    }

    /// Doubles the samples of some rows of pixels until their mean squared error, plus one standard
    /// error of it, is `squared`. Returns what is left. The replicas of pixels are then merged.
    #[must_use]
    pub fn reduce<P>(
        &mut self,
        (source, state): (&P, &mut FilmState),
        range: &Range<usize>,
        squared: f64,
        most_samples: u32,
    ) -> RemainingNoise
    where
        P: PixelSource<Sums = [f64; 3]>,
    {
        let replicas = self.replicas;
        let count = replicas.count();
        let target = NoiseTarget {
            most_samples: replicas.most_samples(most_samples),
            certainty: Certainty::StandardError { pixels_per_estimate: PIXELS_PER_ESTIMATE },
            ..NoiseTarget::new(replicas.squared_target(squared), Selection::Every)
        };
        let of_replicas = PixelNoise { columns: count * self.columns, ..*self };
        let rows = count * range.start..count * range.end;
        let source = ReplicatedSource::new(source, replicas);
        let (left, stop) = refine(&source, state, &target, |pixels| of_replicas.of_rows(pixels, &rows));
        let pixels = replicas.merged_errors(&left.pixels);
        let parts = replicas.parts(&left.pixels);
        if replicas != Replicas::ONE {
            state.pixels = replicas.merged(&state.pixels);
            self.replicas = Replicas::ONE;
        }
        RemainingNoise { pixels, parts, stop }
    }

    /// The values to which the errors of a pixel's bands are relative.
    pub(crate) fn units(&self, pixel: &Pixel) -> [f64; 3] {
        let mean = pixel.mean();
        std::array::from_fn(|band| mean[band].hypot(self.floors[band]).max(f64::MIN_POSITIVE.sqrt()))
    }

    /// The part of [`PixelNoise::units`] that does not depend on the pixel's value.
    pub(crate) fn floors(&self) -> [f64; 3] {
        self.floors
    }

    /// The errors of some rows of pixels, estimated from these rows alone.
    fn of_rows(&self, pixels: &[Pixel], range: &Range<usize>) -> PixelErrors {
        let gain = self.gain(&pixels[range.clone()]);
        let error = |index: usize| {
            let pixel = &pixels[index];
            let bias = if pixel.samples > FIRST_SAMPLES { SELECTION_BIAS } else { 1.0 };
            let squared = bias * self.relative(pixel, self.squared_error((pixels, range), index, gain));
            PixelError { squared, gain, samples: pixel.samples }
        };
        let errors = range.clone().into_par_iter().with_min_len(1024).map(error).collect();
        PixelErrors { pixels: errors, first: range.start }
    }

    /// The mean squared error of a pixel's bands, relative to their values.
    fn relative(&self, pixel: &Pixel, squares: [f64; 3]) -> f64 {
        let of_band = |band: usize| {
            let [value, floor] = [pixel.mean()[band], self.floors[band]];
            squares[band] / (value * value + floor * floor).max(f64::MIN_POSITIVE)
        };
        (of_band(0) + of_band(1) + of_band(2)) / 3.0
    }

    /// The factor by which doubling samples reduces squared errors in a block, from the last two
    /// doublings of its pixels.
    ///
    /// A single square says little, and a few large ones would hide the majority, so each pixel
    /// contributes the ratio of its second square to the sum of both. If the squares are those of
    /// two normally distributed numbers with variance ratio g, the means of these ratios have the
    /// ratio √g.
    fn gain(&self, block: &[Pixel]) -> f64 {
        let (mut last, mut before) = (0.0, 0.0);
        for pixel in block {
            let squares = [pixel.last, pixel.before].map(|bands| self.relative(pixel, bands.map(square)));
            let weight = 1.0 / (NEGLIGIBLE_ERROR + squares[0] + squares[1]);
            last += weight * squares[0];
            before += weight * squares[1];
        }
        if before > 0.0 { (last / before).powi(2).clamp(GAINS[0], GAINS[1]) } else { GAINS[1] }
    }

    /// The estimated squared errors of a pixel's bands, from its own samples and those of its
    /// neighbours in these rows.
    fn squared_error(&self, (pixels, range): (&[Pixel], &Range<usize>), index: usize, gain: f64) -> [f64; 3] {
        let columns = self.columns;
        let (first, last) = (range.start / columns, range.end / columns - 1);
        let (column, row) = (index % columns, index / columns);
        let samples = f64::from(pixels[index].samples);
        let own = pixels[index].mean();
        let (mut sums, mut weights, mut steps) = ([0.0; 3], 0.0, [0.0_f64; 3]);
        for y in row.saturating_sub(1).max(first)..=(row + 1).min(last) {
            for x in column.saturating_sub(1)..=(column + 1).min(columns - 1) {
                let other = &pixels[y * columns + x];
                let near = f64::from((2 - y.abs_diff(row) as u32) * (2 - x.abs_diff(column) as u32));
                // A pixel with more samples than a neighbour knows its own noise better.
                let weight = near * (f64::from(other.samples) / samples).min(1.0);
                // Scaled to the number of samples of this pixel.
                let scale = 0.5 * weight * (f64::from(other.samples) / samples).powf(-gain.log2());
                let mean = other.mean();
                for (band, sum) in sums.iter_mut().enumerate() {
                    let darker = (MAX_BRIGHTNESS * own[band].hypot(self.floors[band]) / mean[band]).min(1.0);
                    let squares = square(other.last[band]) + gain * square(other.before[band]);
                    *sum += scale * darker * darker * squares;
                }
                weights += weight;
                for (step, (own, other)) in steps.iter_mut().zip(own.iter().zip(mean)) {
                    *step = step.max((own - other).abs());
                }
            }
        }
        let unseen = |band: usize| UNSEEN_PROBABILITY * (steps[band] / samples).powi(2);
        std::array::from_fn(|band| sums[band] / weights * gain / (1.0 - gain) + unseen(band))
    }
}

fn square(difference: f32) -> f64 {
    f64::from(difference) * f64::from(difference)
}

/// Correction of the selection bias of squared errors: pixels whose halves agree by chance are not
/// doubled further, so their estimated errors are too low. In rooms of small lamps, plants and sun
/// patches, the squared error was 1.3 to 1.6 times the estimated one for pictures of independent
/// paths at 10 and 5 %.
const SELECTION_BIAS: f64 = 1.4;

/// The noise of a neighbour that is more than so many times as bright as a pixel says too much of
/// the pixel's noise, and is reduced in proportion. (A pixel whose samples are brighter by chance
/// still counts in its neighbours, where it is not hidden by its own value.)
const MAX_BRIGHTNESS: f64 = 10.0;

/// A feature that a neighbour sees may cover about 1/N of this pixel without being hit by any of
/// its N samples. This is its assumed probability.
const UNSEEN_PROBABILITY: f64 = 0.1;

/// Pixels with squared relative errors well below this say little about the rate of convergence.
const NEGLIGIBLE_ERROR: f64 = 1e-6;

/// Limits of the factor by which doubling reduces squared errors: a low-discrepancy sequence of a
/// smooth integrand, and independent samples.
const GAINS: [f64; 2] = [0.35, 0.5];

/// The estimated errors of a block of pixels.
#[derive(Clone, Debug)]
struct PixelErrors {
    pixels: Vec<PixelError>,
    first: usize,
}

/// The noise of pixels after sampling.
#[derive(Clone, Debug)]
pub struct RemainingNoise {
    pub(crate) pixels: Vec<PixelError>,
    /// The squared errors of each pixel's replicas, whose mean is that of the pixel.
    parts: Vec<f64>,
    /// Why it is more than requested.
    pub stop: Option<Stop>,
}

impl RemainingNoise {
    /// The quality of these pixels, without cached irradiance.
    #[must_use]
    pub fn estimate(&self) -> Option<Estimate> {
        let mut finished = Finished::default();
        self.by_pixel().for_each(|(pixel, parts)| finished.add(parts, 1.0, pixel.samples));
        finished.add_stop(self.stop);
        finished.estimate()
    }

    /// Each pixel with the squared errors of its replicas.
    pub(crate) fn by_pixel(&self) -> impl Iterator<Item = (&PixelError, &[f64])> {
        self.pixels.iter().zip(self.parts.chunks((self.parts.len() / self.pixels.len().max(1)).max(1)))
    }

    /// The standard error of each pixel relative to its value, rms over the bands.
    #[must_use]
    pub fn relative_errors(&self) -> Vec<f32> {
        self.pixels.iter().map(|pixel| (pixel.squared as f32).sqrt()).collect()
    }
}

impl ErrorEstimate for PixelErrors {
    fn pixels(&self) -> &[PixelError] {
        &self.pixels
    }

    fn first_pixel(&self) -> usize {
        self.first
    }
}

/// The quality of a picture, estimated from its own samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The remaining error, as defined by [`ErrorTarget`](radsight_adaptive::ErrorTarget).
    pub error: f64,
    /// Half width of its 95 % confidence interval.
    pub uncertainty: f64,
    /// Mean number of rays per pixel.
    pub rays: f64,
    /// The part of the error due to noise of the pixels' own rays. Its square and that of `cache`
    /// add up to that of `error`.
    pub noise: f64,
    /// The part due to cached irradiance; `None` where none is cached.
    pub cache: Option<f64>,
    /// Why the work ended before the requested error was reached.
    pub stopped: Option<Stop>,
}

/// Sums over finished pixels.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Finished {
    pixels: f64,
    rays: f64,
    /// Due to noise.
    noise: SquaredErrors,
    /// Of squared errors due to cached irradiance, and the variance of that sum; `None` where none
    /// is cached.
    cached: Option<[f64; 2]>,
    stopped: Option<Stop>,
}

impl Finished {
    /// Adds a pixel: the squared errors of its replicas, scaled, and its number of rays.
    pub(crate) fn add(&mut self, parts: &[f64], scale: f64, rays: u32) {
        self.pixels += 1.0;
        self.rays += f64::from(rays);
        parts.iter().for_each(|squared| self.noise.add(scale * squared));
    }

    /// Keeps the first reason; lack of time counts most.
    pub(crate) fn add_stop(&mut self, stop: Option<Stop>) {
        self.stopped = if stop == Some(Stop::Time) { stop } else { self.stopped.or(stop) };
    }

    /// Adds the squared errors of cached irradiance of some pixels, and their variance.
    pub(crate) fn add_cached(&mut self, [squared, variance]: [f64; 2]) {
        let [before, variance_before] = self.cached.unwrap_or_default();
        self.cached = Some([before + squared.max(0.0), variance_before + variance]);
    }

    pub(crate) fn estimate(&self) -> Option<Estimate> {
        let pixels = self.pixels;
        let [cached, cached_variance] = self.cached.unwrap_or_default().map(|sum| sum / pixels);
        let [noise, noise_variance] = self.noise.mean_and_variance(PIXELS_PER_ESTIMATE);
        let variance = noise_variance + cached_variance / pixels;
        let error = (noise + cached).sqrt();
        let uncertainty = (error * error + CONFIDENCE * variance.sqrt()).sqrt() - error;
        (pixels > 0.0).then(|| Estimate {
            error,
            uncertainty,
            rays: self.rays / pixels,
            noise: noise.sqrt(),
            cache: self.cached.map(|_| cached.sqrt()),
            stopped: self.stopped,
        })
    }
}

/// Half width of a 95 % confidence interval, in standard deviations of a normal distribution.
const CONFIDENCE: f64 = 1.96;

/// Number of pixels per independent estimate, since each is a mean over its neighbours: the inverse
/// of the sum of their squared weights.
const PIXELS_PER_ESTIMATE: f64 = 7.1;

/// The mean of each band over the pixels that are not black in it, with bright pixels limited.
fn typical(pixels: &[Pixel]) -> [f64; 3] {
    std::array::from_fn(|band| {
        let mut values: Vec<f64> = pixels.iter().map(|pixel| pixel.mean()[band]).filter(|value| *value > 0.0).collect();
        if values.is_empty() {
            return 0.0;
        }
        let center = values.len() / 2;
        let (_, median, _) = values.select_nth_unstable_by(center, f64::total_cmp);
        let most = BRIGHT_LIMIT * *median;
        values.iter().map(|value| value.min(most)).sum::<f64>() / values.len() as f64
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLUMNS: usize = 8;

    /// A pixel of value 1 whose last doublings differed by so much.
    fn pixel(samples: u32, difference: f32) -> Pixel {
        let (sums, difference) = ([f64::from(samples); 3], [difference; 3]);
        Pixel { sums, samples, last: difference, before: difference }
    }

    #[test]
    fn pixels_with_many_samples_know_their_noise_better_than_neighbours_do() {
        let of = |index: usize| if index % COLUMNS % 4 == 1 { pixel(16, 0.1) } else { pixel(1024, 0.0) };
        let pixels: Vec<Pixel> = (0..COLUMNS * COLUMNS).map(of).collect();
        let estimated = PixelNoise::new(&pixels, COLUMNS).of_rows(&pixels, &(0..pixels.len()));
        let [smooth, noisy] = [2, 1].map(|column| estimated.pixels()[4 * COLUMNS + column].squared);
        let of_noisy_pixel = noisy * 16.0 / 1024.0;
        assert!(0.0 < smooth && smooth < 0.1 * of_noisy_pixel, "{smooth}, and {of_noisy_pixel} like a neighbour");
    }

    /// The estimated squared errors of pixels of one value around one of another value.
    fn around_one(pixel: Pixel, others: Pixel) -> [f64; 2] {
        let center = 4 * COLUMNS + 2;
        let pixels: Vec<Pixel> =
            (0..COLUMNS * COLUMNS).map(|index| if index == center { pixel } else { others }).collect();
        let estimated = PixelNoise::new(&pixels, COLUMNS).of_rows(&pixels, &(0..pixels.len()));
        [center, center + 1].map(|index| estimated.pixels()[index].squared)
    }

    #[test]
    fn noise_of_much_brighter_neighbours_is_not_that_of_a_dark_pixel() {
        let dark = pixel(1024, 0.001);
        let bright = Pixel { sums: [1024.0 * 4000.0; 3], last: [40.0; 3], before: [40.0; 3], ..dark };
        let [of_dark, of_bright] = around_one(dark, bright);
        assert!(of_bright < 2e-4 && of_dark < 200.0 * of_bright, "{of_dark} beside {of_bright}");
    }

    #[test]
    fn a_pixel_that_is_too_bright_by_chance_counts_in_its_neighbours() {
        // One of 64 samples is 6,400 times as bright as the others.
        let quiet = pixel(64, 0.001);
        let chance = Pixel { sums: [64.0 + 6400.0; 3], last: [100.0; 3], ..quiet };
        let [of_chance, of_neighbour] = around_one(chance, quiet);
        assert!(of_chance < 2.0 && of_neighbour > 4.0, "{of_chance} beside {of_neighbour}");
    }
}
