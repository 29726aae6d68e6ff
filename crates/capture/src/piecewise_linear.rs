//! Sampling of functions that are linear between equidistant points.

use radsight_sampling::choose;

/// A position from 0 to 1 drawn in proportion to a piecewise linear function of positive values, at
/// least two, and its pdf. `None` if the values are not finite.
pub(crate) fn sample_linear(values: &[f64], u: f64) -> Option<(f64, f64)> {
    let pieces = (values.len() - 1) as f64;
    let integrals = || values.windows(2).map(|ends| 0.5 * (ends[0] + ends[1]));
    let total: f64 = integrals().sum();
    let (piece, u) = choose(integrals().map(|integral| integral / total), u)?;
    let (low, high) = (values[piece], values[piece + 1]);
    // The root of the quadratic equation of the integral, without cancellation.
    let within = (u * (low + high) / (low + (low * low + u * (high * high - low * low)).sqrt())).min(1.0);
    let pdf = (low + (high - low) * within) * pieces / total;
    (pdf.is_finite() && pdf > 0.0).then_some(((piece as f64 + within) / pieces, pdf))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_follow_the_density() {
        let values = [0.1, 2.0, 0.5, 0.5, 1e-9];
        let count = 100_000;
        let mut sums = [0.0; 3];
        for index in 0..count {
            let (position, pdf) =
                sample_linear(&values, (f64::from(index) + 0.5) / f64::from(count)).expect("positive");
            let powers = [1.0, position, position * position];
            sums.iter_mut().zip(powers).for_each(|(sum, power)| *sum += power / pdf / f64::from(count));
        }
        // Integrals over the unit interval.
        for (sum, correct) in sums.into_iter().zip([1.0, 0.5, 1.0 / 3.0]) {
            assert!((sum - correct).abs() < 2e-3, "{sums:?}");
        }
    }
}
