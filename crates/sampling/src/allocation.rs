//! Which pixels get more samples, so that the error of the whole picture is lowest for all samples together.
//!
//! The squared error of a pixel's mean falls by a factor [`PixelError::gain`] with each doubling of its samples N. What a doubling takes
//! from the picture's squared error for each of its samples is e²·(1 − gain)/N. The sum of errors is least for all samples where no pixel has more
//! of that than another: pixels are doubled where it is above a bound, and the bound is lowered as far as the asked error needs.

/// What is known of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelError {
    /// Squared error of its mean, estimated, in the unit of the asked one.
    pub squared: f64,
    /// What doubling its samples leaves of that, between 0 and 1: ½ for independent samples.
    pub gain: f64,
    /// Its samples so far.
    pub samples: u32,
}

/// A pixel with what it can still do.
struct Open {
    error: PixelError,
    /// What a doubling takes from the squared error, for each sample.
    worth: f64,
    /// How often its samples can be doubled.
    room: f64,
}

/// How often the samples of each pixel are to be doubled, a fraction among pixels that are as good as each other; all 0 where the mean of the squared
/// errors is `target` or less, or no sample can lower it.
///
/// A pixel gets no more than about `most` samples, and others do not make up for it: it counts as one that is as exact as asked, if
/// it is not.
///
/// ```
/// use radsight_sampling::{PixelError, doublings};
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
            Open { error, worth: error.squared * (1.0 - error.gain) / f64::from(error.samples), room }
        })
        .collect();
    let allowed = target * open.len() as f64;
    let now = |pixel: &Open| if pixel.room > 0.0 { pixel.error.squared } else { pixel.error.squared.min(target) };
    if open.iter().map(now).sum::<f64>() <= allowed {
        return vec![0.0; pixels.len()];
    }
    let highest = open.iter().map(|pixel| pixel.worth).fold(0.0, f64::max);
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

/// The bound is no lower than the highest worth by so many halvings, and is found in so many steps.
const HALVINGS: f64 = 60.0;
const STEPS: u32 = 24;

impl Open {
    /// How often it is doubled as long as that is worth more than the bound: a doubling lowers the error by the gain and has twice the
    /// samples.
    fn doublings(&self, bound: f64) -> f64 {
        if self.worth <= bound { 0.0 } else { (self.worth / bound).log2() / (2.0 / self.error.gain).log2() }
    }
}

/// The squared error of a pixel after that.
fn left_over(pixel: &Open, bound: f64, target: f64) -> f64 {
    let doublings = pixel.doublings(bound);
    let left = pixel.error.squared * pixel.error.gain.powf(doublings.min(pixel.room));
    if doublings >= pixel.room { left.min(target) } else { left }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Doubles pixels with known noise until nothing is chosen; gives their samples.
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

    /// Mostly calm, one in ten noisy, one in a hundred very noisy.
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
    fn the_asked_error_is_met_with_fewer_samples_than_evenly_spread() {
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
            assert!(2 * own < even, "{own} and evenly {even} samples");
        }
    }

    #[test]
    fn samples_go_with_the_root_of_the_variance() {
        let samples = spend(&noise(), 0.5, 0.02, 1 << 16);
        // 25 times the variance has five times the samples, as far as doublings allow.
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
    fn others_do_not_make_up_for_pixels_that_may_get_no_more() {
        let noise = noise();
        let limited = spend(&noise, 0.5, 0.03, 64);
        let calm: u32 =
            limited.iter().zip(&noise).filter(|(_, noise)| **noise < 0.1).map(|(samples, _)| *samples).max().unwrap();
        assert!(limited[0] == 64 && calm <= 16, "{} and {calm}", limited[0]);
        let even = spend(&[0.0; 10], 0.5, 0.01, 64);
        assert_eq!(even, [4; 10]);
    }
}
