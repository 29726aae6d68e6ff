//! The error of a capture relative to the truth.

use crate::error::BenchError;
use crate::figure::Subject;

/// A capture compared with its truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Accuracy {
    /// `rms(E−T)/mean(T)` as measured, including the truth's own noise.
    pub(crate) error: f64,
    /// The same with the truth's noise subtracted in squares; 0 if only noise is left.
    pub(crate) own_error: f64,
    /// Share of pixels whose grey value is within one of the truth's, with the figure's sensor.
    pub(crate) within_one_grey: f64,
}

impl Accuracy {
    /// Compares exposures in J/m², in scanline order from the top left.
    pub(crate) fn new(what: &str, exposures: &[f64], subject: &Subject) -> Result<Accuracy, BenchError> {
        let truth = &subject.truth;
        if exposures.len() != truth.len() {
            let what = what.to_owned();
            return Err(BenchError::Size { what, found: exposures.len(), expected: truth.len() });
        }
        let error = relative_error(exposures, truth);
        let (greys, true_greys) = (subject.sensor.greys(exposures, 0), subject.sensor.greys(truth, 0));
        let near = greys.iter().zip(&true_greys).filter(|(grey, truth)| grey.abs_diff(**truth) <= 1).count();
        Ok(Accuracy {
            error,
            own_error: (error * error - subject.truth_noise * subject.truth_noise).max(0.0).sqrt(),
            within_one_grey: near as f64 / truth.len() as f64,
        })
    }
}

/// `rms(E−T)/mean(T)`.
fn relative_error(exposures: &[f64], truth: &[f64]) -> f64 {
    let count = truth.len() as f64;
    let squares: f64 = exposures.iter().zip(truth).map(|(e, t)| (e - t) * (e - t)).sum();
    (squares / count).sqrt() / (truth.iter().sum::<f64>() / count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_is_the_root_mean_square_over_the_mean() {
        assert_eq!(relative_error(&[2.0, 1.0, 2.0, 3.0], &[2.0, 2.0, 2.0, 2.0]), 0.5 * 0.5f64.sqrt());
    }
}
