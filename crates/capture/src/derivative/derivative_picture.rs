//! The derivative of a picture, and its error.

use super::RANDOMISATIONS;

/// The derivative of an exposed picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Derivative {
    /// dE/dθ of each pixel, J/m² per unit of the parameter, in scanline order from the top left.
    pub values: Vec<f64>,
    /// Its standard error, by independent randomisations of the samples.
    pub standard_errors: Vec<f64>,
    /// Rms of the standard errors, relative to the rms of the derivative (or, if that is larger, to
    /// the derivative that changes the exposure by 0.003 % over the step).
    pub relative_error: f64,
    /// Estimated rms error due to the finite step, relative to the rms of the derivative.
    pub step_error: f64,
    /// Number of rays.
    pub rays: u64,
    /// Number of pixels whose samples move with an outline; where pixels share rays, of those of the film
    /// that see a moving part.
    pub outline_pixels: usize,
}

/// Radius of the window over which squared errors are averaged, pixels.
pub(super) const WINDOW: usize = 1;

/// Weight of a pixel's own squared error beside that of its window: it has 7 degrees of freedom.
const OWN_WEIGHT: f64 = 0.5;

/// Change of the exposure over a step, rms relative to the rms of the exposure, below which a
/// derivative counts as zero.
const LEAST_CHANGE: f64 = 3e-5;

/// The mean of the randomisations of a value, and its squared standard error.
pub(super) fn mean_and_squared_error(randomised: &[f64; RANDOMISATIONS as usize]) -> (f64, f64) {
    let mean = randomised.iter().sum::<f64>() / f64::from(RANDOMISATIONS);
    let squares: f64 = randomised.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, squares / f64::from(RANDOMISATIONS * (RANDOMISATIONS - 1)))
}

/// The squared error of a pixel, from its own and the mean of its window.
pub(super) fn pooled(own: f64, near: f64) -> f64 {
    OWN_WEIGHT * own + (1.0 - OWN_WEIGHT) * near
}

/// The root of a squared error relative to the size of a derivative.
pub(super) fn relative_to(squared: f64, size: f64) -> f64 {
    if squared > 0.0 { squared.sqrt() / size } else { 0.0 }
}

/// Mean square of the derivative without its noise, to which errors relate. A derivative that
/// changes next to nothing over the step counts as if it changed [`LEAST_CHANGE`].
pub(super) fn signal((slopes, exposures): (&[f64], &[f64]), squared_errors: &[f64], step: f64) -> f64 {
    let square = mean_square(slopes);
    let least = (LEAST_CHANGE / step).powi(2) * mean_square(exposures);
    // Where noise dominates, the difference says nothing.
    (square - mean(squared_errors)).max(0.1 * square).max(least)
}

fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64
}

pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}
