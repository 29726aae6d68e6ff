//! The error of a picture relative to the truth, from two independent references that are both
//! noisy.
//!
//! Let r and s be unbiased references of the same truth t, independent of each other and of the
//! picture p. Then `E[(p − r)(p − s)] = (p − t)²`: their noise cancels in the mean. Its remainder
//! in a sum over pixels is known from `r − s`.

use radsight_picture::Image;

/// Fraction of the typical value of a band that is added in squares to a value (as in `rpict
/// --error`).
const DARK_FRACTION: f64 = 0.01;

/// The typical value limits pixels to this multiple of the median (as in `rpict --error`).
const BRIGHT_LIMIT: f64 = 10.0;

/// Side of the blocks in which noise averages out, pixels.
const BLOCK: usize = 4;

/// Half width of a 95 % confidence interval, in standard deviations of a normal distribution.
pub(super) const CONFIDENCE: f64 = 1.96;

/// A squared error and its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Squared {
    pub(super) value: f64,
    pub(super) standard_error: f64,
}

impl Squared {
    /// The error itself; 0 if noise made its square negative.
    pub(super) fn error(self) -> f64 {
        self.value.max(0.0).sqrt()
    }

    /// The 95 % confidence interval of the error.
    pub(super) fn interval(self) -> [f64; 2] {
        [-CONFIDENCE, CONFIDENCE].map(|widths| (self.value + widths * self.standard_error).max(0.0).sqrt())
    }
}

/// The error of a picture relative to the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Comparison {
    /// Mean over the bands of all pixels of `d²/(v² + (0.01·m)²)`: d is the error of a value v, m
    /// the typical value of its band.
    pub(super) pixels: Squared,
    /// The same for the means of blocks of 4×4 pixels.
    pub(super) blocks: Squared,
}

impl Comparison {
    /// Compares a picture with two references of its size.
    pub(super) fn new(picture: &Image<f32>, references: [&Image<f32>; 2]) -> Comparison {
        let of_side = |side: usize| {
            let [picture, first, second] = [picture, references[0], references[1]].map(|image| Means::new(image, side));
            squared(&picture, [&first, &second])
        };
        Comparison { pixels: of_side(1), blocks: of_side(BLOCK) }
    }
}

/// The means of blocks, three bands each.
struct Means(Vec<[f64; 3]>);

impl Means {
    fn new(image: &Image<f32>, side: usize) -> Means {
        let across = image.width().div_ceil(side);
        let mut sums = vec![([0.0; 3], 0.0); across * image.height().div_ceil(side)];
        for (at, pixel) in image.pixels().enumerate() {
            let (column, row) = (at % image.width(), at / image.width());
            let (sum, count) = &mut sums[row / side * across + column / side];
            *sum = std::array::from_fn(|band| sum[band] + f64::from(pixel[band.min(pixel.len() - 1)]));
            *count += 1.0;
        }
        Means(sums.into_iter().map(|(sum, count)| sum.map(|band| band / count)).collect())
    }
}

fn squared(picture: &Means, [first, second]: [&Means; 2]) -> Squared {
    let truth: Vec<[f64; 3]> =
        first.0.iter().zip(&second.0).map(|(a, b)| std::array::from_fn(|band| 0.5 * (a[band] + b[band]))).collect();
    let floors = typical(&truth).map(|typical| DARK_FRACTION * typical);
    let (mut sum, mut variance) = (0.0, 0.0);
    for (at, truth) in truth.iter().enumerate() {
        let (mut product, mut noise) = (0.0, 0.0);
        for band in 0..3 {
            let unit = truth[band].hypot(floors[band]).max(f64::MIN_POSITIVE.sqrt());
            let apart = [first, second].map(|reference| (picture.0[at][band] - reference.0[at][band]) / unit);
            product += unbiased(apart, truth[band] / unit) / 3.0;
            noise += 0.5 * (apart[0] - apart[1]).powi(2) / 3.0;
        }
        sum += product;
        variance += 2.0 * product.abs() * noise + noise * noise;
    }
    let count = truth.len().max(1) as f64;
    Squared { value: sum / count, standard_error: variance.sqrt() / count }
}

/// The product of two relative differences, corrected for the noise of the references in the value
/// to which they are relative, up to the fourth order of that noise; `share` is the ratio of the
/// truth to that value.
///
/// Let ε be half of both noises in that unit and r the `share`. The inverse square of the unit is
/// then `1 − 2rε + (4r² − 1)ε²`. A difference d and references of variance v give `d² + 2rdv + (4r²
/// − 1)(d²v + v²)/2`; `n = (a − b)²/2` has the mean v, and its square 3v².
fn unbiased([a, b]: [f64; 2], share: f64) -> f64 {
    let (product, noise, excess) = (a * b, 0.5 * (a - b).powi(2), 4.0 * share * share - 1.0);
    product - share * (a + b) * noise - excess * (0.5 * product * noise + noise * noise / 6.0)
}

/// The mean of each band over the values that are not black in it, with bright ones limited.
fn typical(values: &[[f64; 3]]) -> [f64; 3] {
    std::array::from_fn(|band| {
        let mut lit: Vec<f64> = values.iter().map(|value| value[band]).filter(|value| *value > 0.0).collect();
        lit.sort_by(f64::total_cmp);
        let most = BRIGHT_LIMIT * lit.get(lit.len() / 2).copied().unwrap_or(0.0);
        lit.iter().map(|value| value.min(most)).sum::<f64>() / lit.len().max(1) as f64
    })
}

#[cfg(test)]
mod tests {
    use super::super::random::Random;
    use super::*;

    /// A picture of ones with uniform noise of this standard deviation.
    fn noisy(random: &mut Random, value: f32, noise: f64) -> Image<f32> {
        let mut image = Image::filled(64, 48, 3, value).unwrap();
        let half = 3f64.sqrt() * noise;
        image.data_mut().iter_mut().for_each(|value| *value += random.uniform(-half, half) as f32);
        image
    }

    #[test]
    fn noise_of_the_references_does_not_count() {
        let mut random = Random::new(5);
        let references = [0, 1].map(|_| noisy(&mut random, 1.0, 0.2));
        let picture = noisy(&mut random, 1.0, 0.05);
        let found = Comparison::new(&picture, [&references[0], &references[1]]).pixels;
        let [low, high] = found.interval();
        assert!(low < 0.05 && 0.05 < high && high < 0.08, "{found:?}");
    }

    #[test]
    fn an_even_excess_is_the_error_of_pixels_and_of_blocks() {
        let mut random = Random::new(6);
        let references = [0, 1].map(|_| noisy(&mut random, 1.0, 0.1));
        let found = Comparison::new(&noisy(&mut random, 1.08, 0.0), [&references[0], &references[1]]);
        assert!((found.pixels.error() - 0.08).abs() < 0.01, "{found:?}");
        assert!((found.blocks.error() - 0.08).abs() < 0.005, "{found:?}");
    }

    #[test]
    fn noise_averages_out_in_blocks() {
        let mut random = Random::new(7);
        let exact = Image::filled(64, 48, 3, 1.0).unwrap();
        let found = Comparison::new(&noisy(&mut random, 1.0, 0.2), [&exact, &exact]);
        assert!((found.pixels.error() - 0.2).abs() < 0.01, "{found:?}");
        assert!((found.blocks.error() - 0.05).abs() < 0.01, "{found:?}");
    }
}
