//! Which pixels get more samples, so that the error of the whole picture is lowest for all samples together.
//!
//! The error of a pixel's mean falls with its samples N, its square by a factor [`PooledVariance::gain`] with each doubling. What a doubling takes from the picture's
//! squared error, for each of its samples, goes with r/N (r is the pixel's squared relative error). The least sum of errors for all
//! samples is where no pixel has more of that than another: those are doubled where it is above a bound, and the bound is lowered as far as the asked error needs.

/// What is known of the pixels of a block.
#[derive(Clone, Debug)]
pub(crate) struct PooledVariance {
    /// Squared relative error of each pixel's mean, estimated.
    pub(crate) errors: Vec<f64>,
    /// What doubling a pixel's samples leaves of its squared error.
    pub(crate) gain: f64,
}

/// A pixel that can still get samples.
struct Open {
    index: usize,
    error: f64,
    /// What a doubling takes from the squared error, for each sample, up to a common factor.
    worth: f64,
    /// How often its samples can be doubled.
    room: f64,
}

/// The pixels (by their place in the block) to be doubled now; none where the mean squared relative error is `wanted`², or no sample can lower it.
///
/// A pixel gets no more than `most` samples, and others do not make up for it: it counts as one that is as exact as wanted, if it is
/// not.
pub(crate) fn chosen(pooled: &PooledVariance, samples: impl Fn(usize) -> u32, wanted: f64, most: u32) -> Vec<usize> {
    let wanted = wanted * wanted;
    let open: Vec<Open> = (pooled.errors.iter().enumerate())
        .map(|(index, &error)| {
            let samples = samples(index);
            let room = (f64::from(most) / f64::from(samples)).log2().ceil().max(0.0);
            Open { index, error, worth: error / f64::from(samples), room }
        })
        .collect();
    let allowed = wanted * open.len() as f64;
    let now = |pixel: &Open| if pixel.room > 0.0 { pixel.error } else { pixel.error.min(wanted) };
    if open.iter().map(now).sum::<f64>() <= allowed {
        return Vec::new();
    }
    let highest = open.iter().map(|pixel| pixel.worth).fold(0.0, f64::max);
    let [mut low, mut high] = [-HALVINGS, 0.0];
    for _ in 0..STEPS {
        let middle = 0.5 * (low + high);
        let bound = highest * f64::exp2(middle);
        let left: f64 = open.iter().map(|pixel| left_over(pixel, bound, pooled.gain, wanted)).sum();
        *(if left > allowed { &mut high } else { &mut low }) = middle;
    }
    let bound = highest * f64::exp2(low);
    open.iter().filter(|pixel| pixel.room > 0.0 && pixel.worth > bound).map(|pixel| pixel.index).collect()
}

/// The bound is no lower than the highest worth by so many halvings, and is found in so many steps.
const HALVINGS: f64 = 60.0;
const STEPS: u32 = 24;

/// The squared error of a pixel once it is doubled as long as that is worth more than the bound.
fn left_over(pixel: &Open, bound: f64, gain: f64, wanted: f64) -> f64 {
    if pixel.worth <= bound {
        return if pixel.room > 0.0 { pixel.error } else { pixel.error.min(wanted) };
    }
    // A doubling lowers the error by the gain and has twice the samples.
    let doublings = (pixel.worth / bound).log2() / (2.0 / gain).log2();
    let left = pixel.error * gain.powf(doublings.min(pixel.room));
    if doublings >= pixel.room { left.min(wanted) } else { left }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Doubles pixels with known noise until nothing is chosen; gives their samples.
    fn spend(noise: &[f64], gain: f64, wanted: f64, most: u32) -> Vec<u32> {
        let mut samples = vec![4; noise.len()];
        loop {
            let halvings = |index: usize| f64::from(samples[index]).log2();
            let errors = (0..noise.len()).map(|index| noise[index] * gain.powf(halvings(index))).collect();
            let chosen = chosen(&PooledVariance { errors, gain }, |index| samples[index], wanted, most);
            if chosen.is_empty() {
                return samples;
            }
            chosen.into_iter().for_each(|index| samples[index] *= 2);
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
