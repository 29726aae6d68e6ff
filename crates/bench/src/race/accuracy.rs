//! The error of a picture relative to its reference.

use radsight_picture::Image;

/// Values below this share of the picture's mean are raised to it in relative errors, so that the
/// darkest corner does not dominate.
const DARK_FRACTION: f64 = 0.01;

/// Side of pixel blocks, in which noise averages out and visible errors remain.
pub(crate) const BLOCK: usize = 8;

/// The relative errors of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Accuracy {
    /// `sqrt(mean(d²/(r² + (0.01·m)²)))` over the values of all pixels: d the difference, r the
    /// reference, m the mean of its band.
    pub(crate) error: f64,
    /// 95 % of the values have a relative difference `|d|/sqrt(r² + (0.01·m)²)` below this.
    pub(crate) percentile_95: f64,
    /// The largest relative difference of the means of blocks of 8×8 pixels.
    pub(crate) worst_block: f64,
    /// Ratio of the means, minus 1.
    pub(crate) bias: f64,
}

impl Accuracy {
    /// Compares a picture with a reference of the same size.
    pub(crate) fn new(picture: &Image<f32>, reference: &Image<f32>) -> Accuracy {
        let floors = floors(reference);
        let bands = floors.len();
        let mut differences: Vec<f64> = (picture.data().iter().zip(reference.data()).enumerate())
            .map(|(at, (p, r))| relative(f64::from(*p), f64::from(*r), floors[at % bands]))
            .collect();
        let squares: f64 = differences.iter().map(|difference| difference * difference).sum();
        let count = differences.len();
        differences.sort_by(f64::total_cmp);
        Accuracy {
            error: (squares / count as f64).sqrt(),
            percentile_95: differences[(0.95 * (count - 1) as f64).ceil() as usize],
            worst_block: worst_block(picture, reference, &floors),
            bias: sum(picture) / sum(reference) - 1.0,
        }
    }

    /// The same with the reference's noise subtracted in squares.
    pub(crate) fn less(self, noise: f64) -> Accuracy {
        Accuracy { error: (self.error * self.error - noise * noise).max(0.0).sqrt(), ..self }
    }
}

/// The term added in squares to a value of each band.
fn floors(reference: &Image<f32>) -> Vec<f64> {
    let mut sums = vec![0.0; reference.components()];
    for pixel in reference.pixels() {
        sums.iter_mut().zip(pixel).for_each(|(sum, value)| *sum += f64::from(*value));
    }
    let pixels = (reference.width() * reference.height()) as f64;
    // A band without light has no error.
    sums.into_iter().map(|sum| (DARK_FRACTION * sum / pixels).max(f64::MIN_POSITIVE.sqrt())).collect()
}

fn relative(value: f64, reference: f64, floor: f64) -> f64 {
    (value - reference).abs() / reference.hypot(floor)
}

/// The sum of all values of all bands.
pub(crate) fn sum(image: &Image<f32>) -> f64 {
    image.data().iter().map(|value| f64::from(*value)).sum()
}

fn worst_block(picture: &Image<f32>, reference: &Image<f32>, floors: &[f64]) -> f64 {
    let mut worst = 0.0_f64;
    for block in blocks(reference) {
        for (band, floor) in floors.iter().enumerate() {
            let difference = relative(block.mean(picture, band), block.mean(reference, band), *floor);
            worst = worst.max(difference);
        }
    }
    worst
}

/// A block of pixels; those at the right and at the bottom may be smaller.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Block {
    left: usize,
    top: usize,
    right: usize,
    bottom: usize,
}

/// All blocks of an image.
pub(crate) fn blocks(image: &Image<f32>) -> impl Iterator<Item = Block> {
    let (width, height) = (image.width(), image.height());
    (0..height).step_by(BLOCK).flat_map(move |top| {
        (0..width).step_by(BLOCK).map(move |left| Block {
            left,
            top,
            right: (left + BLOCK).min(width),
            bottom: (top + BLOCK).min(height),
        })
    })
}

impl Block {
    /// The mean of one band.
    pub(crate) fn mean(&self, image: &Image<f32>, band: usize) -> f64 {
        let rows = (self.top..self.bottom).map(|y| &image.row(y)[self.left * image.components()..]);
        let values = rows.flat_map(|row| row.chunks_exact(image.components()).take(self.right - self.left));
        let sum: f64 = values.map(|pixel| f64::from(pixel[band])).sum();
        sum / self.pixels()
    }

    /// The standard error of the mean of one band, from those of the pixels.
    pub(crate) fn error_of_mean(&self, errors: &Image<f32>, band: usize) -> f64 {
        let rows = (self.top..self.bottom).map(|y| &errors.row(y)[self.left * errors.components()..]);
        let values = rows.flat_map(|row| row.chunks_exact(errors.components()).take(self.right - self.left));
        values.map(|pixel| f64::from(pixel[band]).powi(2)).sum::<f64>().sqrt() / self.pixels()
    }

    fn pixels(&self) -> f64 {
        ((self.right - self.left) * (self.bottom - self.top)) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn even(value: f32) -> Image<f32> {
        Image::filled(16, 12, 3, value).unwrap()
    }

    #[test]
    fn an_even_excess_is_the_error_of_every_measure() {
        let accuracy = Accuracy::new(&even(1.1), &even(1.0));
        // The floor of a hundredth of the mean reduces the error by half of a ten-thousandth.
        for value in [accuracy.error, accuracy.percentile_95, accuracy.worst_block] {
            assert!((value - 0.1).abs() < 1e-5, "{accuracy:?}");
        }
        assert!((accuracy.bias - 0.1).abs() < 1e-6);
    }

    #[test]
    fn noise_that_averages_out_is_no_bias() {
        let mut picture = even(1.0);
        picture
            .data_mut()
            .iter_mut()
            .enumerate()
            .for_each(|(at, value)| *value += if at % 2 == 0 { 0.2 } else { -0.2 });
        let accuracy = Accuracy::new(&picture, &even(1.0));
        assert!((accuracy.error - 0.2).abs() < 1e-4 && accuracy.bias.abs() < 1e-6, "{accuracy:?}");
        assert!((accuracy.less(0.16).error - 0.12).abs() < 1e-4);
    }

    #[test]
    fn black_is_compared_with_a_hundredth_of_the_mean() {
        let mut reference = even(1.0);
        reference.pixel_mut(0, 0).fill(0.0);
        let mut picture = reference.clone();
        picture.pixel_mut(0, 0)[0] = 0.02;
        let worst = Accuracy::new(&picture, &reference).error * (16.0 * 12.0 * 3.0_f64).sqrt();
        assert!((worst - 2.0).abs() < 0.02, "{worst}");
    }
}
