//! The histogram of adaptation brightness. Brightness is the natural logarithm of luminance in
//! cd/m².

use super::foveal::Fovea;
use super::luminance::Luminance;
use super::{TINY, VISIBLE, reopened};
use crate::ToolError;
use crate::drand48::Drand48;
use radsight_picture::{Resolution, decode_rgbe};
use std::f64::consts::LN_10;
use std::io::{Read, Seek};

/// Number of bins.
pub(super) const BINS: usize = 100;

/// The source of adaptation.
#[derive(Clone, Debug, PartialEq)]
pub enum Adaptation {
    /// The whole picture.
    Everything {
        /// Whether samples near the centre have more weight.
        center_weighted: bool,
        /// Fixation points, as column and row from the lower left, and their weight in the
        /// adaptation.
        fixations: Option<(Vec<[i64; 2]>, f64)>,
    },
    /// A histogram given by the user.
    Measured(MeasuredHistogram),
}

impl Default for Adaptation {
    fn default() -> Adaptation {
        Adaptation::Everything { center_weighted: false, fixations: None }
    }
}

/// A histogram over the decimal logarithm of luminance in cd/m².
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredHistogram {
    start: f64,
    step: f64,
    counts: Vec<f64>,
}

impl MeasuredHistogram {
    /// From pairs of a logarithm and a count, at equal steps; at most 1024.
    ///
    /// # Errors
    /// A description of the mistake.
    pub fn new(pairs: &[[f64; 2]]) -> Result<MeasuredHistogram, &'static str> {
        const UNEVEN: f64 = 1e-3;
        const MOST: usize = 1024;
        let [[start, _], [second, _], ..] = pairs else { return Err("expected at least two pairs of numbers") };
        if pairs.len() > MOST {
            return Err("more than 1024 pairs");
        }
        let step = second - start;
        if step.is_nan() || step <= TINY {
            return Err("the logarithms of luminance do not increase");
        }
        if pairs.windows(2).any(|two| (two[1][0] - two[0][0] - step).abs() > UNEVEN) {
            return Err("the logarithms of luminance have unequal steps");
        }
        let counts: Vec<f64> = pairs.iter().map(|pair| pair[1]).collect();
        if counts.iter().all(|count| *count <= TINY) {
            return Err("all counts are zero");
        }
        Ok(MeasuredHistogram { start: *start, step, counts })
    }
}

/// A histogram and derived values.
#[derive(Clone, Debug)]
pub(super) struct Histogram {
    pub(super) counts: [f64; BINS],
    pub(super) total: f64,
    /// The smallest brightness.
    pub(super) low: f64,
    /// The largest brightness.
    pub(super) high: f64,
    /// The mean brightness.
    pub(super) mean: f64,
}

impl Histogram {
    /// Builds the histogram by sampling pixels of the source, as the adaptation requires.
    pub(super) fn new<S: Read + Seek>(
        adaptation: &Adaptation,
        fovea: &Fovea,
        luminance: &Luminance,
        random: &mut Drand48,
        source: &mut S,
    ) -> Result<Histogram, ToolError> {
        let histogram = match adaptation {
            Adaptation::Measured(measured) => Histogram::measured(measured),
            Adaptation::Everything { center_weighted, fixations } => {
                let sampled = sampled_luminances(fovea, luminance, random, source)?;
                let weight = |i: usize| if *center_weighted { nearness(fovea, i) } else { 1.0 };
                let fixations = fixations.as_ref().map(|(pixels, share)| (samples_at(pixels, fovea), *share));
                let fixed = Histogram::of_picture(fovea, luminance, &sampled, weight, fixations);
                // If all fixated samples are black, or there are none, the eye adapts to the whole
                // picture.
                match fixed.has_light() {
                    true => fixed,
                    false => Histogram::of_picture(fovea, luminance, &sampled, weight, None),
                }
            }
        };
        if histogram.has_light() {
            return Ok(histogram);
        }
        Err(ToolError::NothingVisible { most: VISIBLE[1] })
    }

    fn has_light(&self) -> bool {
        self.total > 0.0 && self.high > self.low
    }

    /// An empty histogram between two luminances. The lowest bin is duplicated.
    fn empty(least: f64, most: f64) -> Histogram {
        let high = (most * 1.01).min(VISIBLE[1]).ln();
        let low = match least < VISIBLE[0] {
            true => VISIBLE[0].ln(),
            false => high - (high - least.ln()) * BINS as f64 / (BINS - 1) as f64,
        };
        Histogram { counts: [0.0; BINS], total: 0.0, low, high, mean: 0.0 }
    }

    fn of_picture(
        fovea: &Fovea,
        luminance: &Luminance,
        sampled: &[f32],
        weight: impl Fn(usize) -> f64,
        fixations: Option<(Vec<usize>, f64)>,
    ) -> Histogram {
        let samples: Vec<f64> = fovea.colors.iter().map(|color| luminance.of(*color)).collect();
        let all = samples.iter().copied().chain(sampled.iter().map(|value| f64::from(*value)));
        let (least, most) = all.fold((1e10f64, 0.0f64), |(least, most), value| (least.min(value), most.max(value)));
        let mut histogram = Histogram::empty(least, most);
        let share = fixations.as_ref().map_or(0.0, |(_, share)| *share);
        if share < 1.0 - TINY {
            for (i, value) in samples.iter().enumerate() {
                histogram.add(*value, weight(i));
            }
            let each = histogram.total / sampled.len() as f64;
            sampled.iter().for_each(|value| histogram.add(f64::from(*value), each));
        }
        if let Some((pixels, share)) = fixations {
            let each = match histogram.total > TINY {
                true => share / (1.0 - share) * histogram.total / pixels.len() as f64,
                false => 1.0,
            };
            pixels.iter().for_each(|pixel| histogram.add(samples[*pixel], each));
        }
        histogram.finish();
        histogram
    }

    fn measured(measured: &MeasuredHistogram) -> Histogram {
        let MeasuredHistogram { start, step, counts } = measured;
        let (start, step) = (start * LN_10, step * LN_10);
        let counted = |count: &f64| *count > TINY;
        let first = counts.iter().position(counted).unwrap_or(0) as f64;
        let last = counts.iter().rposition(counted).unwrap_or(0) as f64;
        let high = (start + (last + 1.001) * step).min(VISIBLE[1].ln());
        let lowest = start + (first - 0.001) * step;
        let low = match lowest < VISIBLE[0].ln() {
            true => VISIBLE[0].ln(),
            false => high - (high - lowest) * BINS as f64 / (BINS - 1) as f64,
        };
        let mut histogram = Histogram { counts: [0.0; BINS], total: 0.0, low, high, mean: 0.0 };
        for (i, count) in counts.iter().enumerate() {
            let brightness = start + i as f64 * step;
            if brightness >= low + TINY && brightness < high - TINY {
                histogram.count(brightness, *count);
            }
        }
        histogram.finish();
        histogram
    }

    fn add(&mut self, luminance: f64, weight: f64) {
        let (least, most) = (self.low.exp(), self.high.exp());
        if luminance >= least + TINY && luminance < most - TINY {
            self.count(luminance.ln(), weight);
        }
    }

    fn count(&mut self, brightness: f64, weight: f64) {
        let bin = (BINS as f64 * (brightness - self.low) / (self.high - self.low)) as usize;
        self.mean += weight * brightness;
        self.counts[bin.min(BINS - 1)] += weight;
        self.total += weight;
    }

    /// Computes the mean, and distributes the lowest bin over two.
    fn finish(&mut self) {
        self.mean /= self.total;
        if self.low > VISIBLE[0].ln() + TINY {
            self.counts[1] *= 0.5;
            self.counts[0] += self.counts[1];
        }
    }

    /// The largest brightness minus the smallest.
    pub(super) fn range(&self) -> f64 {
        self.high - self.low
    }

    /// The brightness at the centre of a bin.
    pub(super) fn middle(&self, bin: usize) -> f64 {
        self.low + (bin as f64 + 0.5) * self.range() / BINS as f64
    }

    /// The brightness below which a share of the histogram lies.
    pub(super) fn percentile(&self, share: f64) -> f64 {
        let mut left = self.total * share;
        let reached = |count: &f64| {
            left -= count;
            left <= 0.0
        };
        let bin = self.counts.iter().position(reached).unwrap_or(BINS);
        self.middle(bin)
    }
}

/// The weight of a foveal sample: a paraboloid that reaches 0 at 90 degrees from the centre.
fn nearness(fovea: &Fovea, sample: usize) -> f64 {
    let from_middle = |at: usize, size: usize| (at as f64 - 0.5 * (size as f64 - 1.0)) / 90.0;
    let x = from_middle(sample % fovea.columns(), fovea.columns());
    let y = from_middle(sample / fovea.columns(), fovea.rows());
    (1.0 - x * x - y * y).max(0.0)
}

/// The foveal samples at fixation points, each with its eight neighbours, without duplicates.
fn samples_at(pixels: &[[i64; 2]], fovea: &Fovea) -> Vec<usize> {
    let (columns, rows) = (fovea.columns() as i64, fovea.rows() as i64);
    let mut is_taken = vec![false; fovea.colors.len()];
    let mut samples = Vec::new();
    for pixel in pixels {
        let [x, y] = sample_of(*pixel, &fovea.picture, &fovea.resolution);
        for column in (x - 1).max(0)..=(x + 1).min(columns - 1) {
            for row in (y - 1).max(0)..=(y + 1).min(rows - 1) {
                let sample = (row * columns + column) as usize;
                if !std::mem::replace(&mut is_taken[sample], true) {
                    samples.push(sample);
                }
            }
        }
    }
    samples
}

/// Position and scanline of the foveal sample of a pixel, counted from the lower left.
fn sample_of(pixel: [i64; 2], picture: &Resolution, fovea: &Resolution) -> [i64; 2] {
    // Radiance rounds to the nearest border of a foveal sample, not to its centre.
    let part = |at: i64, pixels: usize, samples: usize| {
        ((at as f64 + 0.5) / pixels as f64 * samples as f64).round().clamp(-2.0, samples as f64 + 1.0) as i64
    };
    let (mut x, mut y) = (part(pixel[0], picture.width, fovea.width), part(pixel[1], picture.height, fovea.height));
    if fovea.orientation.x_falls {
        x = fovea.width as i64 - 1 - x;
    }
    if fovea.orientation.y_falls {
        y = fovea.height as i64 - 1 - y;
    }
    if fovea.orientation.scanlines_are_rows { [x, y] } else { [y, x] }
}

/// Luminances of random pixels, 16 per foveal sample, each pixel at most once; the last one sampled
/// comes first.
fn sampled_luminances<S: Read + Seek>(
    fovea: &Fovea,
    luminance: &Luminance,
    random: &mut Drand48,
    source: &mut S,
) -> Result<Vec<f32>, ToolError> {
    const A_GLANCE: usize = 16;
    let mut reader = reopened(source)?;
    let length = fovea.picture.scanline_length();
    let mut pixels_left = fovea.picture.width * fovea.picture.height;
    let mut wanted = (fovea.colors.len() * A_GLANCE).min(pixels_left);
    let mut sampled = vec![0.0; wanted];
    let mut scanline = vec![[0; 4]; length];
    let mut left = 0;
    while wanted > 0 {
        if left == 0 {
            if reader.scanlines_left() == 0 {
                break;
            }
            reader.read_pixels(&mut scanline)?;
            left = length;
        }
        let target = random.next_fraction();
        let (mut skipped, mut probability) = (0, 0.0);
        while pixels_left > skipped {
            probability += (1.0 - probability) * wanted as f64 / (pixels_left - skipped) as f64;
            if probability >= target {
                break;
            }
            skipped += 1;
        }
        skipped += 1;
        if left < skipped {
            pixels_left = pixels_left.saturating_sub(left);
            left = 0;
            continue;
        }
        left -= skipped;
        wanted -= 1;
        sampled[wanted] = luminance.of(decode_rgbe(scanline[left])) as f32;
        pixels_left = pixels_left.saturating_sub(skipped);
    }
    Ok(sampled)
}
