//! Adaptive sampling of a single ray.

use crate::SamplingBudget;
use radsight_adaptive::{ErrorTarget, MAX_SAMPLES, ray_number};
use radsight_render::{Ray, RayWorker, Traced};

/// Samples before the first error estimate: more than for pixels, since there are no neighbours.
const FIRST_SAMPLES: u32 = 16;

/// The error is at most this many times as low as that of independent samples. Halves that agree by
/// chance do not make it lower.
const MAX_GAIN: f64 = 8.0;

/// The mean radiance of a ray over many samples of the light at its hit point. `number` is the
/// ray's number in its stream; hit data are those of the first sample.
///
/// With one sample the result equals that of [`RayWorker::trace`], with the same random numbers.
#[must_use]
pub fn average(worker: &mut RayWorker<'_>, number: u64, ray: &Ray, budget: SamplingBudget) -> Traced {
    if matches!(budget, SamplingBudget::Samples(1) | SamplingBudget::Interpolated(_)) {
        return worker.trace(number, ray);
    }
    let first = ray_number(number, 0);
    let mut traced = worker.trace(first, ray);
    let mut sum = traced.value;
    let mut spectrum = traced.spectrum;
    let mut squares = sum.iter().sum::<f64>().powi(2);
    let mut sum_up = |sum: &mut [f64; 3], squares: &mut f64, samples: std::ops::Range<u32>| {
        for sample in samples {
            let more = worker.trace(first | u64::from(sample), ray);
            *sum = std::array::from_fn(|band| sum[band] + more.value[band]);
            *squares += more.value.iter().sum::<f64>().powi(2);
            if let (Some(spectrum), Some(more)) = (&mut spectrum, &more.spectrum) {
                spectrum.add(more);
            }
        }
    };
    let mut samples = 1;
    match budget {
        SamplingBudget::Interpolated(_) => {}
        SamplingBudget::Samples(wanted) => {
            samples = wanted.clamp(1, MAX_SAMPLES);
            sum_up(&mut sum, &mut squares, 1..samples);
        }
        SamplingBudget::Error(ErrorTarget { error, most_samples }) => {
            let mut before = f64::INFINITY;
            while samples < most_samples.min(MAX_SAMPLES) {
                let mut second_half = [0.0; 3];
                sum_up(&mut second_half, &mut squares, samples..2 * samples);
                samples *= 2;
                let whole: f64 = sum.iter().chain(&second_half).sum();
                let difference = (second_half.iter().sum::<f64>() - sum.iter().sum::<f64>()).abs();
                sum = std::array::from_fn(|band| sum[band] + second_half[band]);
                let is_good = difference <= error * whole
                    && before <= 2.0 * error * whole
                    && independent_error(whole, squares, samples) <= MAX_GAIN * error * whole;
                if samples >= FIRST_SAMPLES && is_good {
                    break;
                }
                // The difference of a sum of twice as many samples would be twice as large.
                before = 2.0 * difference;
            }
        }
    }
    // Rays from facets that face away from the light may count negatively.
    traced.value = sum.map(|sum| sum.max(0.0) / f64::from(samples));
    if let Some(spectrum) = &mut spectrum {
        spectrum.scale(f64::from(samples).recip());
    }
    traced.spectrum = spectrum;
    traced
}

/// The standard error of a sum of independent samples, from the sum of their squares.
fn independent_error(sum: f64, squares: f64, samples: u32) -> f64 {
    let samples = f64::from(samples);
    let variance = (squares - sum * sum / samples).max(0.0) / (samples - 1.0);
    (samples * variance).sqrt()
}
