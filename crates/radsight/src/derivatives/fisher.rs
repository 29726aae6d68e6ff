//! How precisely a picture determines the parameters.

use super::engine::ExposureDerivatives;
use crate::error::Error;
use radsight_sensor::Sensor;

/// The Fisher information of one picture about the parameters.
///
/// The grey values of the pixels are independent and Gaussian with the sensor's mean and variance:
/// F_ij = Σ ∂μ/∂θ_i · ∂μ/∂θ_j / σ² (Kay, "Fundamentals of Statistical Signal Processing:
/// Estimation Theory", 1993, section 3.9; the term with the derivative of σ², which is smaller by
/// about the number of electrons, is left out). An unbiased estimate of the parameters has at least
/// the covariance F⁻¹ (Cramér and Rao).
#[derive(Clone, Debug, PartialEq)]
pub struct FisherInformation {
    /// Names of the parameters.
    pub parameters: Vec<String>,
    /// Their units.
    pub units: Vec<&'static str>,
    /// F, row by row, per units of the parameters.
    pub matrix: Vec<Vec<f64>>,
    /// Smallest possible standard deviation of each parameter if all others are known:
    /// F_ii^(−1/2). Infinite if the picture does not depend on it.
    pub deviations_alone: Vec<f64>,
    /// The same if all parameters are estimated together: the square root of the diagonal of F⁻¹.
    /// `None` if the picture does not tell the parameters apart.
    pub deviations_together: Option<Vec<f64>>,
}

/// Smallest pivot of the scaled matrix. Below it, the parameters cannot be told apart.
const MIN_PIVOT: f64 = 1e-9;

impl FisherInformation {
    /// The information of the sensor's picture about the parameters.
    ///
    /// # Errors
    /// [`Error::NoSensor`] if there is no sensor.
    pub fn new(exposed: &ExposureDerivatives, sensor: Option<&Sensor>) -> Result<FisherInformation, Error> {
        let sensor = sensor.ok_or(Error::NoSensor)?;
        let weights: Vec<f64> = exposed.exposure.values.iter().map(|value| information(sensor, *value)).collect();
        let derivatives = &exposed.derivatives;
        // The dark current's electrons grow with time as well.
        let dark: Vec<f64> = derivatives
            .iter()
            .map(|by| if by.parameter.is_exposure_time() { sensor.dark_exposure_per_s() } else { 0.0 })
            .collect();
        let entry = |row: usize, column: usize| -> f64 {
            let [a, b] = [row, column].map(|index| &derivatives[index].derivative);
            let values = weights.iter().zip(&a.values).zip(&b.values);
            let products = values.map(|((weight, a), b)| weight * (a + dark[row]) * (b + dark[column]));
            // The square of a noisy derivative is too large by the squared standard error.
            let noise = weights.iter().zip(&a.standard_errors).map(|(weight, error)| weight * error * error);
            products.sum::<f64>() - if row == column { noise.sum::<f64>() } else { 0.0 }
        };
        let count = derivatives.len();
        let matrix: Vec<Vec<f64>> =
            (0..count).map(|row| (0..count).map(|column| entry(row, column)).collect()).collect();
        let deviations_alone = (0..count).map(|index| matrix[index][index].max(0.0).sqrt().recip()).collect();
        Ok(FisherInformation {
            parameters: derivatives.iter().map(|by| by.parameter.name().to_owned()).collect(),
            units: derivatives.iter().map(|by| by.parameter.unit()).collect(),
            deviations_together: deviations(&matrix),
            deviations_alone,
            matrix,
        })
    }

    /// As a JSON object with the keys `parameters`, `units`, `fisher_information`,
    /// `deviations_alone` and `deviations_together`. Infinite numbers are null.
    #[must_use]
    pub fn to_json(&self) -> String {
        let json = serde_json::json!({
            "parameters": self.parameters,
            "units": self.units,
            "fisher_information": self.matrix,
            "deviations_alone": self.deviations_alone,
            "deviations_together": self.deviations_together,
        });
        format!("{json:#}\n")
    }
}

/// (∂μ/∂E)²/σ² of a pixel.
fn information(sensor: &Sensor, exposure: f64) -> f64 {
    let grey = sensor.grey_statistics(exposure);
    if grey.variance > 0.0 { grey.slope * grey.slope / grey.variance } else { 0.0 }
}

/// Square roots of the diagonal of the inverse, by Cholesky's decomposition of the matrix scaled to
/// a unit diagonal.
fn deviations(matrix: &[Vec<f64>]) -> Option<Vec<f64>> {
    let count = matrix.len();
    let scale: Vec<f64> = (0..count).map(|index| matrix[index][index].sqrt().recip()).collect();
    if !scale.iter().all(|scale| scale.is_finite()) {
        return None;
    }
    let mut lower = vec![vec![0.0; count]; count];
    for row in 0..count {
        for column in 0..=row {
            let known: f64 = (0..column).map(|index| lower[row][index] * lower[column][index]).sum();
            let rest = matrix[row][column] * scale[row] * scale[column] - known;
            if row == column && rest < MIN_PIVOT {
                return None;
            }
            lower[row][column] = if row == column { rest.sqrt() } else { rest / lower[column][column] };
        }
    }
    Some((0..count).map(|index| scale[index] * inverse_column(&lower, index).sqrt()).collect())
}

/// Squared length of column `index` of the inverse of a lower triangular matrix: the diagonal of
/// the inverse of L·Lᵀ.
fn inverse_column(lower: &[Vec<f64>], index: usize) -> f64 {
    let mut column = vec![0.0; lower.len()];
    for row in index..lower.len() {
        let known: f64 = (index..row).map(|at| lower[row][at] * column[at]).sum();
        column[row] = (if row == index { 1.0 } else { 0.0 } - known) / lower[row][row];
    }
    column.iter().map(|value| value * value).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bounds_of_two_parameters_are_those_of_the_inverse() {
        let together = deviations(&[vec![4.0, 1.0], vec![1.0, 9.0]]).unwrap();
        // The inverse of [[4, 1], [1, 9]] is [[9, −1], [−1, 4]]/35.
        assert!((together[0] - (9.0_f64 / 35.0).sqrt()).abs() < 1e-12);
        assert!((together[1] - (4.0_f64 / 35.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn parameters_with_proportional_derivatives_have_no_bounds_together() {
        assert_eq!(deviations(&[vec![1.0, 2.0], vec![2.0, 4.0]]), None);
        assert_eq!(deviations(&[vec![0.0]]), None);
    }
}
