//! Adaptive sample allocation: which pixels get more samples, for the lowest error of the whole
//! picture.
//!
//! Each doubling of a pixel's samples N multiplies the squared error e² of its mean by
//! [`PixelError::gain`]. A doubling thus lowers the picture's squared error by e²·(1 − gain)/N per
//! added sample. The total error is lowest if this benefit is equal in all pixels: pixels are
//! doubled where it exceeds a bound, and the bound is lowered until the target error is reached.

/// Error estimate of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelError {
    /// Estimated squared error of the mean, in the unit of the target.
    pub squared: f64,
    /// Factor of the squared error per doubling of the samples, between 0 and 1: ½ for independent
    /// samples.
    pub gain: f64,
    /// Number of samples so far.
    pub samples: u32,
}

/// A pixel whose error can still be lowered.
struct Open {
    error: PixelError,
    /// Benefit of a doubling: reduction of the squared error per added sample.
    benefit: f64,
    /// Maximum number of doublings.
    room: f64,
}

/// Number of doublings of each pixel's samples; a fraction among pixels of equal benefit. All are 0
/// if the mean of the squared errors is at most `target`, or if no sample can lower it.
///
/// A pixel gets at most about `most` samples. Other pixels do not compensate for it: it counts as
/// if it had reached the target.
///
/// ```
/// use radsight_adaptive::{PixelError, doublings};
/// let pixel = |squared| PixelError { squared, gain: 0.5, samples: 16 };
/// let needed = doublings(&[pixel(1e-6), pixel(1e-2), pixel(1e-6)], 1e-4, 1 << 16);
/// assert!(needed[0] == 0.0 && needed[1] > 4.0);
/// ```
#[must_use]
pub fn doublings(pixels: &[PixelError], target: f64, most: u32) -> Vec<f64> {
    let open: Vec<Open> = pixels
        .iter()
        .map(|&error| {
            let room = (f64::from(most) / f64::from(error.samples)).log2().ceil().max(0.0);
            Open { error, benefit: error.squared * (1.0 - error.gain) / f64::from(error.samples), room }
        })
        .collect();
    let allowed = target * open.len() as f64;
    let now = |pixel: &Open| if pixel.room > 0.0 { pixel.error.squared } else { pixel.error.squared.min(target) };
    if open.iter().map(now).sum::<f64>() <= allowed {
        return vec![0.0; pixels.len()];
    }
    let highest = open.iter().map(|pixel| pixel.benefit).fold(0.0, f64::max);
    let [mut low, mut high] = [-HALVINGS, 0.0];
    for _ in 0..STEPS {
        let middle = 0.5 * (low + high);
        let bound = highest * f64::exp2(middle);
        let left: f64 = open.iter().map(|pixel| left_over(pixel, bound, target)).sum();
        *(if left > allowed { &mut high } else { &mut low }) = middle;
    }
    let bound = highest * f64::exp2(low);
    open.iter().map(|pixel| pixel.doublings(bound).min(pixel.room)).collect()
}

/// The search interval below the highest benefit, in halvings, which is also the number of steps.
const HALVINGS: f64 = 60.0;
const STEPS: u32 = 24;

impl Open {
    /// Number of doublings while the benefit exceeds the bound: each doubling multiplies the error
    /// by the gain and doubles the samples.
    fn doublings(&self, bound: f64) -> f64 {
        if self.benefit <= bound { 0.0 } else { (self.benefit / bound).log2() / (2.0 / self.error.gain).log2() }
    }
}

/// Squared error of a pixel after these doublings.
fn left_over(pixel: &Open, bound: f64, target: f64) -> f64 {
    let doublings = pixel.doublings(bound);
    let left = pixel.error.squared * pixel.error.gain.powf(doublings.min(pixel.room));
    if doublings >= pixel.room { left.min(target) } else { left }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Doubles pixels of known noise until none is chosen; returns their samples.
    fn spend(noise: &[f64], gain: f64, wanted: f64, most: u32) -> Vec<u32> {
        let mut samples = vec![4; noise.len()];
        loop {
            let halvings = |index: usize| f64::from(samples[index]).log2();
            let pixel = |index: usize| {
                let squared = noise[index] * gain.powf(halvings(index));
                PixelError { squared, gain, samples: samples[index] }
            };
            let pixels: Vec<PixelError> = (0..noise.len()).map(pixel).collect();
            let needed = doublings(&pixels, wanted * wanted, most);
            if needed.iter().all(|doublings| *doublings == 0.0) {
                return samples;
            }
            needed.iter().zip(&mut samples).filter(|(needed, _)| **needed > 0.0).for_each(|(_, samples)| *samples *= 2);
        }
    }

    fn rms(noise: &[f64], gain: f64, samples: &[u32]) -> f64 {
        let squares = noise.iter().zip(samples).map(|(noise, samples)| noise * gain.powf(f64::from(*samples).log2()));
        (squares.sum::<f64>() / noise.len() as f64).sqrt()
    }

    /// Mostly low noise, one pixel in ten noisy, one in a hundred very noisy.
    fn noise() -> Vec<f64> {
        (0..1000)
            .map(|index| {
                if index % 100 == 0 {
                    25.0
                } else if index % 10 == 1 {
                    1.0
                } else {
                    0.01
                }
            })
            .collect()
    }

    #[test]
    fn the_target_error_takes_fewer_samples_than_uniform_sampling() {
        let noise = noise();
        for (gain, wanted) in [(0.5, 0.1), (0.5, 0.03), (0.35, 0.03)] {
            let samples = spend(&noise, gain, wanted, 1 << 16);
            let error = rms(&noise, gain, &samples);
            assert!(error <= wanted && error > 0.7 * wanted, "{error} of {wanted}");
            let mut even = vec![4_u32; noise.len()];
            while rms(&noise, gain, &even) > error {
                even.iter_mut().for_each(|samples| *samples += 1);
            }
            let [own, even] = [&samples, &even].map(|samples| samples.iter().sum::<u32>());
            assert!(2 * own < even, "{own} adaptive and {even} uniform samples");
        }
    }

    #[test]
    fn samples_are_proportional_to_the_standard_deviation() {
        let samples = spend(&noise(), 0.5, 0.02, 1 << 16);
        // 25 times the variance gets five times the samples, up to the rounding to doublings.
        let ratio = f64::from(samples[0]) / f64::from(samples[1]);
        assert!((2.0..=10.0).contains(&ratio), "{ratio}");
    }

    #[test]
    fn pixels_that_converge_fast_need_fewer_samples() {
        let pixel = |gain| PixelError { squared: 1.0, gain, samples: 4 };
        let mut pixels = [pixel(0.25), pixel(0.5)];
        loop {
            let needed = doublings(&pixels, 1e-3, 1 << 16);
            if needed == [0.0; 2] {
                break;
            }
            for (pixel, _) in pixels.iter_mut().zip(needed).filter(|(_, needed)| *needed > 0.0) {
                pixel.squared *= pixel.gain;
                pixel.samples *= 2;
            }
        }
        assert!(pixels[0].squared + pixels[1].squared <= 2e-3);
        assert!(8 * pixels[0].samples <= pixels[1].samples, "{pixels:?}");
    }

    #[test]
    fn other_pixels_do_not_compensate_for_pixels_at_their_limit() {
        let noise = noise();
        let limited = spend(&noise, 0.5, 0.03, 64);
        let calm: u32 =
            limited.iter().zip(&noise).filter(|(_, noise)| **noise < 0.1).map(|(samples, _)| *samples).max().unwrap();
        assert!(limited[0] == 64 && calm <= 16, "{} and {calm}", limited[0]);
        let even = spend(&[0.0; 10], 0.5, 0.01, 64);
        assert_eq!(even, [4; 10]);
    }
}
