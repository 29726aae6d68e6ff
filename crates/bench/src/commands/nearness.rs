//! How near a picture is to the truth: means of blocks of pixels.

use radsight_picture::Image;
use radsight_units::color::LUMINANCE_WEIGHTS;

/// Side of the compared blocks, pixels, and their tolerance.
const BLOCK: usize = 8;
const NEAR: f64 = 0.05;

/// Luminances below this share of the median are raised to it in relative errors.
const DARK_FRACTION: f64 = 0.01;

/// The error of a picture relative to the truth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearness {
    /// Share of blocks within [`NEAR`].
    pub(super) blocks: f64,
    /// Rms of the blocks' relative errors, each at most 1.
    pub(super) error: f64,
}

/// Compares the means of blocks of two pictures of one size.
pub(super) fn near(picture: &Image<f32>, truth: &Image<f32>) -> Nearness {
    let columns = truth.width();
    let (picture, truth) = (luminances(picture), luminances(truth));
    let dark = DARK_FRACTION * median_of_lit(&truth);
    let rows = picture.len().min(truth.len()) / columns.max(1);
    let (mut count, mut close, mut squares) = (0.0, 0.0, 0.0);
    for top in (0..(rows / BLOCK) * BLOCK).step_by(BLOCK) {
        for left in (0..(columns / BLOCK) * BLOCK).step_by(BLOCK) {
            let mean = |pixels: &[f64]| {
                let pixel = |at: usize| pixels[(top + at / BLOCK) * columns + left + at % BLOCK];
                (0..BLOCK * BLOCK).map(pixel).sum::<f64>() / (BLOCK * BLOCK) as f64
            };
            let expected = mean(&truth);
            let error = (mean(&picture) - expected) / (expected + dark).max(f64::MIN_POSITIVE);
            count += 1.0;
            close += f64::from(u8::from(error.abs() < NEAR));
            squares += error.powi(2).min(1.0);
        }
    }
    let count = f64::max(count, 1.0);
    Nearness { blocks: close / count, error: (squares / count).sqrt() }
}

fn luminances(image: &Image<f32>) -> Vec<f64> {
    let luminance =
        |pixel: &[f32]| LUMINANCE_WEIGHTS.iter().zip(pixel).map(|(weight, value)| weight * f64::from(*value)).sum();
    image.pixels().map(luminance).collect()
}

fn median_of_lit(luminances: &[f64]) -> f64 {
    let mut lit: Vec<f64> = luminances.iter().copied().filter(|value| *value > 0.0).collect();
    lit.sort_by(f64::total_cmp);
    lit.get(lit.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearness_counts_blocks_and_their_error() {
        let truth = Image::filled(16, 16, 3, 1.0_f32).unwrap();
        let mut picture = truth.clone();
        (0..8).for_each(|y| (0..8).for_each(|x| picture.pixel_mut(x, y).fill(1.5)));
        let found = near(&picture, &truth);
        assert_eq!(found.blocks, 0.75);
        assert!((found.error - 0.25 / 1.01).abs() < 1e-6, "{found:?}");
    }
}
