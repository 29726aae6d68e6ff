//! Fits Eq. 5 of the paper to measured (exposure, grey) pairs.
//!
//! The model is `G = min(K·E^γ + G₀, G_max)`. For a given γ and a given set of saturated points it
//! is linear in K and G₀, so only γ is searched (variable projection, Golub and Pereyra, SIAM J.
//! Numer. Anal. 10(2), 1973). The search starts from several guesses of the onset of saturation.
//! Each onset moves to the intersection of curve and plateau until it is stable, and the best fit
//! is kept.

use crate::ExposureUnit;
use crate::interval::Estimate;
use crate::plot::{Curve, Mark, Plot, Scale};

/// Search range of γ.
const GAMMA_RANGE: [f64; 2] = [0.02, 10.0];
/// Steps of the initial geometric scan over γ.
const GAMMA_STEPS: i32 = 48;
/// Number of initial guesses of the onset of saturation.
const GUESSES: usize = 24;
/// Number of points that suffice to compare guesses.
const POINTS_FOR_GUESSES: usize = 1024;
/// Maximum number of moves of the onset of saturation.
const ROUNDS: usize = 32;
/// Minimum number of points below saturation: one more than K, γ and G₀.
const FEWEST_POINTS: usize = 4;
/// Minimum number of points on a plateau.
const FEWEST_SATURATED: usize = 2;

/// A measured pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// Exposure, in the unit of K.
    pub exposure: f64,
    /// Grey level of a pixel, or a mean over pixels.
    pub grey: f64,
}

/// A fitted sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// K, grey levels at 1 unit of exposure.
    pub k: f64,
    /// γ.
    pub gamma: f64,
    /// G₀, grey levels. Noisy data may give a slightly negative value.
    pub grey_background: f64,
    /// G_max, grey levels; `None` if the data do not reach saturation.
    pub grey_max: Option<f64>,
    /// Root mean square of the residuals, grey levels.
    pub rms_residual: f64,
    /// Number of points on the plateau.
    pub saturated: usize,
    /// Confidence intervals of the four parameters.
    pub intervals: CalibrationIntervals,
    /// Unit of exposure of K.
    pub exposure_unit: ExposureUnit,
}

/// 99 % confidence intervals of the parameters of Eq. 5, from the scatter of the data about the
/// fit. They are those of the linearised model (Seber and Wild, Nonlinear Regression, 1989, section
/// 5.1), with K by its logarithm, in which the model is nearly linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CalibrationIntervals {
    /// Interval of K.
    pub k: Estimate,
    /// Interval of γ.
    pub gamma: Estimate,
    /// Interval of G₀.
    pub grey_background: Estimate,
    /// Interval of G_max, if the data reach saturation.
    pub grey_max: Option<Estimate>,
}

impl Calibration {
    /// Plot of the data and of the fit with its saturation.
    #[must_use]
    pub fn plot(&self, pairs: &[Measurement]) -> Plot {
        let largest = pairs.iter().map(|pair| pair.exposure).fold(0.0, f64::max);
        let steps = 0..=200;
        let fitted = steps.map(|step| f64::from(step) / 200.0 * largest).map(|at| [at, self.grey(at)]).collect();
        let measured = pairs.iter().map(|pair| [pair.exposure, pair.grey]).collect();
        let curve = |name: &str, mark, values| Curve { name: name.to_owned(), mark, values };
        Plot {
            title: format!("G = K E^gamma + G0, K = {:.5}, gamma = {:.4}", self.k, self.gamma),
            axes: [format!("exposure ({})", self.exposure_unit.name()), "grey level".to_owned()],
            scales: [Scale::Linear; 2],
            curves: vec![curve("measured", Mark::Points, measured), curve("fitted", Mark::Line, fitted)],
        }
    }

    /// Fitted grey level without rounding, at an exposure in the calibration's unit.
    #[must_use]
    pub fn grey(&self, exposure: f64) -> f64 {
        let rising = self.k * exposure.max(0.0).powf(self.gamma) + self.grey_background;
        rising.min(self.grey_max.unwrap_or(f64::INFINITY))
    }
}

/// Why the data cannot be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CalibrationError {
    /// There are too few points for K, γ and G₀.
    #[error("{found} different exposures below saturation, expected at least {FEWEST_POINTS}")]
    TooFewPoints {
        /// Number of different exposures.
        found: usize,
    },
    /// A value is impossible for a measurement.
    #[error(
        "pair {index} (from 0) is ({exposure}, {grey}): expected an exposure of at least 0 and a finite grey level"
    )]
    BadMeasurement {
        /// Index of the pair, from 0.
        index: usize,
        /// Exposure of the pair.
        exposure: f64,
        /// Grey level of the pair.
        grey: f64,
    },
    /// Grey levels do not increase with exposure.
    #[error("grey levels do not rise with exposure")]
    NotRising,
}

/// Fits pairs in any order.
///
/// # Errors
/// If there are too few different exposures, a value is impossible, or grey levels do not increase
/// with exposure.
pub fn calibrate(pairs: &[Measurement], exposure_unit: ExposureUnit) -> Result<Calibration, CalibrationError> {
    let bad = |pair: &Measurement| !(pair.exposure.is_finite() && pair.exposure >= 0.0 && pair.grey.is_finite());
    if let Some(index) = pairs.iter().position(bad) {
        let Measurement { exposure, grey } = pairs[index];
        return Err(CalibrationError::BadMeasurement { index, exposure, grey });
    }
    let mut sorted = pairs.to_vec();
    sorted.sort_by(|a, b| a.exposure.total_cmp(&b.exposure));
    let found = distinct(&sorted);
    if found < FEWEST_POINTS {
        return Err(CalibrationError::TooFewPoints { found });
    }
    // Exposures are scaled to at most 1, so that no power of them overflows.
    let largest = sorted[sorted.len() - 1].exposure;
    sorted.iter_mut().for_each(|pair| pair.exposure /= largest);
    let fit = best_split(&sorted).ok_or(CalibrationError::NotRising)?;
    let intervals = intervals(&sorted, &fit, largest);
    Ok(Calibration {
        intervals,
        k: fit.k / largest.powf(fit.gamma),
        gamma: fit.gamma,
        grey_background: fit.background,
        grey_max: (fit.saturated > 0).then_some(fit.plateau),
        rms_residual: (fit.squares / sorted.len() as f64).sqrt(),
        saturated: fit.saturated,
        exposure_unit,
    })
}

/// A fit, with its sum of squared residuals over all points.
#[derive(Clone, Copy, Debug)]
struct Fit {
    k: f64,
    gamma: f64,
    background: f64,
    plateau: f64,
    saturated: usize,
    squares: f64,
}

/// Confidence intervals from the Jacobian over (ln K, γ, G₀) at the best fit; exposures were
/// divided by `largest`.
fn intervals(sorted: &[Measurement], fit: &Fit, largest: f64) -> CalibrationIntervals {
    let (rising, flat) = sorted.split_at(sorted.len() - fit.saturated);
    let mut normal = [[0.0; 3]; 3];
    let mut squares = 0.0;
    for pair in rising {
        let power = fit.k * pair.exposure.powf(fit.gamma);
        // Derivative by γ in the exposure's own unit, that of K; at exposure 0 the power is 0 for
        // every γ.
        let by_gamma = if pair.exposure > 0.0 { power * (pair.exposure * largest).ln() } else { 0.0 };
        let slopes = [power, by_gamma, 1.0];
        for (row, slope) in normal.iter_mut().zip(slopes) {
            row.iter_mut().zip(slopes).for_each(|(sum, other)| *sum += slope * other);
        }
        squares += (power + fit.background - pair.grey).powi(2);
    }
    let degrees = rising.len() as f64 - 3.0;
    let errors = inverse_diagonal(normal).map(|element| (element * squares / degrees).sqrt());
    let log_k = Estimate::student(fit.k.ln() - fit.gamma * largest.ln(), errors[0], degrees);
    let grey_max = (fit.saturated > 0).then(|| {
        let scatter: f64 = flat.iter().map(|pair| (pair.grey - fit.plateau).powi(2)).sum();
        // The plateau has the scatter of all points, which is known more precisely.
        let degrees = degrees + flat.len() as f64 - 1.0;
        Estimate::student(fit.plateau, ((scatter + squares) / degrees / flat.len() as f64).sqrt(), degrees)
    });
    CalibrationIntervals {
        k: Estimate { value: log_k.value.exp(), low: log_k.low.exp(), high: log_k.high.exp() },
        gamma: Estimate::student(fit.gamma, errors[1], degrees),
        grey_background: Estimate::student(fit.background, errors[2], degrees),
        grey_max,
    }
}

/// Diagonal of the inverse of a symmetric matrix, by cofactors after scaling to a unit diagonal.
/// Infinite for a singular matrix.
fn inverse_diagonal(matrix: [[f64; 3]; 3]) -> [f64; 3] {
    let scale: [f64; 3] = std::array::from_fn(|i| matrix[i][i].sqrt());
    let scaled = |i: usize, j: usize| matrix[i][j] / (scale[i] * scale[j]);
    let cofactor = |i: usize| {
        let (a, b) = ((i + 1) % 3, (i + 2) % 3);
        scaled(a, a) * scaled(b, b) - scaled(a, b) * scaled(b, a)
    };
    let determinant =
        cofactor(0) + 2.0 * scaled(0, 1) * scaled(1, 2) * scaled(2, 0) - scaled(0, 1).powi(2) - scaled(0, 2).powi(2);
    std::array::from_fn(|i| {
        let element = cofactor(i) / (determinant * scale[i] * scale[i]);
        if element.is_finite() && element >= 0.0 { element } else { f64::INFINITY }
    })
}

fn distinct(sorted: &[Measurement]) -> usize {
    1 + sorted.windows(2).filter(|pair| pair[0].exposure < pair[1].exposure).count() - usize::from(sorted.is_empty())
}

/// Best fit over many guesses of the onset of saturation. With many points, a subset is used to
/// compare the guesses.
fn best_split(sorted: &[Measurement]) -> Option<Fit> {
    let thinned: Vec<Measurement> = sorted.iter().step_by(sorted.len().div_ceil(POINTS_FOR_GUESSES)).copied().collect();
    let mut best: Option<Fit> = None;
    for guess in (0..thinned.len()).step_by(thinned.len().div_ceil(GUESSES)) {
        if let Some(fit) = settle(&thinned, guess) {
            best = Some(best.filter(|best| best.squares <= fit.squares).unwrap_or(fit));
        }
    }
    if thinned.len() == sorted.len() {
        return best;
    }
    let guess = best?.saturated * (sorted.len() / thinned.len());
    settle(sorted, guess).or_else(|| fit_split(sorted, guess))
}

/// Moves the onset of saturation to the intersection of curve and plateau, until it is stable.
/// Noise at the knee can make it cycle: then the best of these fits is taken.
fn settle(sorted: &[Measurement], mut saturated: usize) -> Option<Fit> {
    let mut best: Option<Fit> = None;
    for round in 0..ROUNDS {
        let fit = fit_split(sorted, saturated)?;
        if round >= ROUNDS / 2 && fit.saturated > 0 && best.is_none_or(|best| fit.squares < best.squares) {
            best = Some(fit);
        }
        let below = sorted.partition_point(|pair| fit.k * pair.exposure.powf(fit.gamma) + fit.background < fit.plateau);
        let next = sorted.len() - below;
        if next == saturated || (next < FEWEST_SATURATED && saturated == 0) {
            return Some(fit);
        }
        saturated = if next < FEWEST_SATURATED { 0 } else { next };
    }
    best
}

/// Fit with the last `saturated` points on the plateau.
fn fit_split(sorted: &[Measurement], saturated: usize) -> Option<Fit> {
    let (rising, flat) = sorted.split_at(sorted.len().checked_sub(saturated)?);
    if rising.is_empty() || distinct(rising) < FEWEST_POINTS {
        return None;
    }
    let mut fit = fit_gamma(rising)?;
    fit.saturated = saturated;
    if saturated > 0 {
        fit.plateau = flat.iter().map(|pair| pair.grey).sum::<f64>() / saturated as f64;
        fit.squares += flat.iter().map(|pair| (pair.grey - fit.plateau).powi(2)).sum::<f64>();
    }
    Some(fit)
}

/// Best γ for unsaturated points: a geometric scan, then golden-section search around its minimum.
fn fit_gamma(rising: &[Measurement]) -> Option<Fit> {
    let ratio = (GAMMA_RANGE[1] / GAMMA_RANGE[0]).powf(1.0 / f64::from(GAMMA_STEPS));
    let scanned = (0..=GAMMA_STEPS).map(|step| fit_linear(rising, GAMMA_RANGE[0] * ratio.powi(step)));
    let best = scanned.min_by(|a, b| a.squares.total_cmp(&b.squares))?;
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let (mut low, mut high) = ((best.gamma / ratio).ln(), (best.gamma * ratio).ln());
    for _ in 0..60 {
        let (left, right) = (high - golden * (high - low), low + golden * (high - low));
        if fit_linear(rising, left.exp()).squares < fit_linear(rising, right.exp()).squares {
            high = right;
        } else {
            low = left;
        }
    }
    let fit = fit_linear(rising, (0.5 * (low + high)).exp());
    (fit.k > 0.0 && fit.squares.is_finite()).then_some(fit)
}

/// Least squares in K and G₀ for one γ.
fn fit_linear(rising: &[Measurement], gamma: f64) -> Fit {
    let count = rising.len() as f64;
    let powers: Vec<f64> = rising.iter().map(|pair| pair.exposure.powf(gamma)).collect();
    let mean_power = powers.iter().sum::<f64>() / count;
    let mean_grey = rising.iter().map(|pair| pair.grey).sum::<f64>() / count;
    let (mut covariance, mut variance) = (0.0, 0.0);
    for (pair, power) in rising.iter().zip(&powers) {
        let off = power - mean_power;
        covariance += off * (pair.grey - mean_grey);
        variance += off * off;
    }
    let k = if variance > 0.0 { covariance / variance } else { 0.0 };
    let background = mean_grey - k * mean_power;
    let residual = |(pair, power): (&Measurement, &f64)| k * power + background - pair.grey;
    let squares = rising.iter().zip(&powers).map(|both| residual(both).powi(2)).sum();
    Fit { k, gamma, background, plateau: f64::INFINITY, saturated: 0, squares }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    const UNIT: ExposureUnit = ExposureUnit::MicrojoulePerSquareCentimetre;

    /// Data of the paper's sensor with exposures up to `largest` µJ/cm² and Gaussian noise on the
    /// grey level.
    fn measured(count: u32, largest: f64, noise: f64, seed: u64) -> Vec<Measurement> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let pair = |index: u32| {
            let exposure = largest * f64::from(index) / f64::from(count - 1);
            let normal: f64 = StandardNormal.sample(&mut random);
            Measurement { exposure, grey: (33844.0 * exposure.powf(0.85) + 12.0).min(161.0) + noise * normal }
        };
        (0..count).map(pair).collect()
    }

    #[test]
    fn exact_data_give_the_exact_sensor() {
        let fit = calibrate(&measured(24, 2.5e-3, 0.0, 0), UNIT).unwrap();
        assert!((fit.k / 33844.0 - 1.0).abs() < 1e-5, "{fit:?}");
        assert!((fit.gamma - 0.85).abs() < 1e-6 && (fit.grey_background - 12.0).abs() < 1e-5, "{fit:?}");
        assert!((fit.grey_max.unwrap() - 161.0).abs() < 1e-9 && fit.rms_residual < 1e-5, "{fit:?}");
        assert_eq!(fit.exposure_unit, UNIT);
    }

    #[test]
    fn noisy_and_rounded_data_give_the_sensor_within_the_noise() {
        for seed in 0..20 {
            let mut pairs = measured(80, 2.5e-3, 0.5, seed);
            pairs.iter_mut().for_each(|pair| pair.grey = pair.grey.round());
            pairs.reverse();
            let fit = calibrate(&pairs, UNIT).unwrap();
            assert!((fit.gamma - 0.85).abs() < 0.04, "seed {seed}: {fit:?}");
            assert!((fit.grey_background - 12.0).abs() < 1.5, "seed {seed}: {fit:?}");
            assert!((fit.grey_max.unwrap() - 161.0).abs() < 0.5, "seed {seed}: {fit:?}");
            assert!((0.3..0.8).contains(&fit.rms_residual), "seed {seed}: {fit:?}");
            // The curve is compared, because K and γ are correlated.
            for pair in measured(50, 2.5e-3, 0.0, 0) {
                assert!((fit.grey(pair.exposure) - pair.grey).abs() < 1.5, "seed {seed} at {}", pair.exposure);
            }
        }
    }

    #[test]
    fn the_inverse_of_a_matrix_has_the_diagonal_found_by_hand() {
        // [[4, 2, 0], [2, 3, 1], [0, 1, 2]]: determinant 12, cofactors 5, 8, 8.
        let found = inverse_diagonal([[4.0, 2.0, 0.0], [2.0, 3.0, 1.0], [0.0, 1.0, 2.0]]);
        for (found, expected) in found.into_iter().zip([5.0, 8.0, 8.0]) {
            assert!((found - expected / 12.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_papers_numbers_lie_in_their_intervals_in_95_of_100_seeds() {
        let mut within = [0; 4];
        let mut within_half = [0; 4];
        for seed in 0..100 {
            let mut pairs = measured(60, 2.5e-3, 0.7, 500 + seed);
            pairs.iter_mut().for_each(|pair| pair.grey = pair.grey.round());
            let found = calibrate(&pairs, UNIT).unwrap().intervals;
            let all = [found.k, found.gamma, found.grey_background, found.grey_max.unwrap()];
            for (index, truth) in [33844.0, 0.85, 12.0, 161.0].into_iter().enumerate() {
                let Estimate { value, low, high } = all[index];
                within[index] += u32::from(all[index].contains(truth));
                within_half[index] += u32::from((0.5 * (low + value)..=0.5 * (high + value)).contains(&truth));
            }
        }
        assert!(within.iter().all(|&count| count >= 95), "{within:?}");
        // Intervals twice as wide as they should be would contain all values.
        assert!(within_half.iter().all(|&count| count < 95), "{within_half:?}");
    }

    #[test]
    fn data_below_saturation_give_no_grey_max() {
        for seed in 0..20 {
            let fit = calibrate(&measured(40, 1.2e-3, 0.3, seed), UNIT).unwrap();
            assert!(fit.saturated <= 2, "seed {seed}: {fit:?}");
            assert!((fit.grey(6e-4) - (33844.0 * 6e-4f64.powf(0.85) + 12.0)).abs() < 0.4, "seed {seed}: {fit:?}");
        }
        let exact = calibrate(&measured(40, 1.2e-3, 0.0, 0), UNIT).unwrap();
        assert_eq!((exact.grey_max, exact.saturated), (None, 0));
    }

    #[test]
    fn much_data_is_fitted_in_bounded_time() {
        let fit = calibrate(&measured(20_000, 2.5e-3, 1.0, 3), UNIT).unwrap();
        assert!((fit.gamma - 0.85).abs() < 0.01 && (fit.grey_max.unwrap() - 161.0).abs() < 0.2, "{fit:?}");
    }

    #[test]
    fn degenerate_data_are_rejected() {
        let flat: Vec<_> = (0..9).map(|i| Measurement { exposure: f64::from(i), grey: 50.0 - f64::from(i) }).collect();
        assert_eq!(calibrate(&flat, UNIT), Err(CalibrationError::NotRising));
        let same = [Measurement { exposure: 1.0, grey: 5.0 }; 9];
        assert_eq!(calibrate(&same, UNIT), Err(CalibrationError::TooFewPoints { found: 1 }));
        assert_eq!(calibrate(&[], UNIT), Err(CalibrationError::TooFewPoints { found: 0 }));
        let bad = [Measurement { exposure: f64::NAN, grey: 5.0 }];
        assert!(calibrate(&bad, UNIT).unwrap_err().to_string().starts_with("pair 0 (from 0) is (NaN, 5)"));
    }
}
