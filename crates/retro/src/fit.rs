//! Least-squares fit of a model to measured coefficients of retroreflection.
//!
//! Levenberg–Marquardt (Marquardt, J. SIAM 11(2), 1963) on the logarithms of the parameters, which
//! keeps them positive, with finite differences for derivatives. Confidence is that of the linear
//! model at the minimum: the covariance is `s² (JᵀJ)⁻¹` with `s² = Σr²/(n − p)`, and 95 % intervals
//! use Student's t for n − p degrees of freedom.

use crate::native::{ModelInfo, model, model_info};
use crate::table::Row;
use radsight_brdf::native::ModelError;

/// Residuals whose squares are minimised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Weights {
    /// `(R_model − R)/R`: every row has the same weight.
    #[default]
    Relative,
    /// `R_model − R`: bright rows have the largest weight.
    Absolute,
}

/// A fitted parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitted {
    /// Name in the model's table.
    pub name: &'static str,
    /// Unit of the value.
    pub unit: &'static str,
    /// Best estimate.
    pub value: f64,
    /// Bounds of the 95 % confidence interval. None if the data do not determine the parameter:
    /// there are no more rows than parameters, the estimate is at an end of its range, or other
    /// parameters can compensate for it.
    pub interval: Option<[f64; 2]>,
}

/// Result of a fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Name of the model.
    pub model: &'static str,
    /// Parameters in the model's order; those with a default keep it.
    pub parameters: Vec<Fitted>,
    /// `R_model` of each row, cd/(lx m²).
    pub predicted: Vec<f64>,
    /// `(R_model − R)/R` of each row.
    pub residuals: Vec<f64>,
    /// Root mean square of the relative residuals.
    pub rms: f64,
}

/// Why a fit is impossible.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum FitError {
    /// The model does not exist, or has no parameters that can be fitted.
    Model(String),
    /// There are fewer rows than parameters: rows, parameters.
    FewRows(usize, usize),
    /// A row's coefficient is zero, so its relative residual is undefined; index of the row.
    Dark(usize),
    /// No parameters give a finite result.
    Diverged,
}

impl std::fmt::Display for FitError {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            FitError::Model(name) => write!(out, "model \"{name}\" cannot be fitted"),
            FitError::FewRows(rows, parameters) => {
                write!(out, "{rows} rows cannot determine {parameters} parameters")
            }
            FitError::Dark(row) => {
                write!(out, "row {} has a coefficient of 0, for which a relative residual is undefined", row + 1)
            }
            FitError::Diverged => write!(out, "no parameters of the model approximate the data"),
        }
    }
}

impl std::error::Error for FitError {}

const MOST_STEPS: u32 = 200;
/// Half width of an interval, as a logarithm, above which a parameter counts as undetermined: a
/// factor of 1000.
const VAGUE: f64 = 6.9;

/// A fitting problem: model, data and weights.
struct Problem<'a> {
    info: &'static ModelInfo,
    words: &'a [String],
    rows: &'a [Row],
    weights: Weights,
    /// Number of fitted parameters: those without a default.
    free: usize,
}

/// Fits those parameters of a model that have no default to the rows; `words` are the model's
/// options.
///
/// # Errors
/// See [`FitError`].
pub fn fit(name: &str, words: &[String], rows: &[Row], weights: Weights) -> Result<Fit, FitError> {
    let info = model_info(name).filter(|info| info.name != "table").ok_or_else(|| FitError::Model(name.to_owned()))?;
    let free = info.parameters.iter().filter(|row| row.default.is_none()).count();
    if rows.len() < free {
        return Err(FitError::FewRows(rows.len(), free));
    }
    if let (Weights::Relative, Some(dark)) = (weights, rows.iter().position(|row| row.coefficient <= 0.0)) {
        return Err(FitError::Dark(dark));
    }
    let problem = Problem { info, words, rows, weights, free };
    let starts = problem.starts();
    let best = starts
        .into_iter()
        .filter_map(|start| problem.descend(start))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .ok_or(FitError::Diverged)?;
    problem.report(&best.0).ok_or(FitError::Diverged)
}

impl Problem<'_> {
    /// Logarithmic range of a parameter; a range that begins at zero begins at a tiny value.
    fn bounds(&self, parameter: usize) -> [f64; 2] {
        let [least, most] = self.info.parameters[parameter].range;
        [least.max(most * 1e-7).ln(), most.ln()]
    }

    /// Starting points: combinations of a few values in each range.
    fn starts(&self) -> Vec<Vec<f64>> {
        let mut starts = vec![Vec::new()];
        for parameter in 0..self.free {
            let [low, high] = self.bounds(parameter);
            let places = [0.35, 0.6, 0.85].map(|share| low + share * (high - low));
            starts = starts
                .iter()
                .flat_map(|start| places.map(|place| start.iter().copied().chain([place]).collect()))
                .collect();
        }
        starts
    }

    /// R_A of each row; none if the model rejects the parameters.
    fn predict(&self, logarithms: &[f64]) -> Option<Vec<f64>> {
        let numbers: Vec<f64> = logarithms
            .iter()
            .zip(self.info.parameters)
            .map(|(logarithm, row)| logarithm.exp().clamp(row.range[0], row.range[1]))
            .collect();
        let sheet = match model(self.info.name, self.words, &numbers) {
            Ok(sheet) => sheet,
            Err(ModelError::Numbers(_) | ModelError::Number { .. }) => return None,
            Err(_) => return None,
        };
        let predicted: Vec<f64> = self
            .rows
            .iter()
            .map(|row| {
                let (observer, light) = row.geometry.directions();
                row.geometry.coefficient(sheet.value_and_pdf(observer, light).0)
            })
            .collect();
        predicted.iter().all(|coefficient| coefficient.is_finite()).then_some(predicted)
    }

    fn residuals(&self, logarithms: &[f64]) -> Option<Vec<f64>> {
        let scale = |row: &Row| if self.weights == Weights::Relative { row.coefficient } else { 1.0 };
        let predicted = self.predict(logarithms)?;
        Some(predicted.iter().zip(self.rows).map(|(found, row)| (found - row.coefficient) / scale(row)).collect())
    }

    /// Derivatives of the residuals, one row per parameter.
    fn derivatives(&self, at: &[f64], residuals: &[f64]) -> Option<Vec<Vec<f64>>> {
        const STEP: f64 = 1e-5;
        (0..self.free)
            .map(|parameter| {
                let mut moved = at.to_vec();
                let step = if at[parameter] + STEP > self.bounds(parameter)[1] { -STEP } else { STEP };
                moved[parameter] += step;
                let moved = self.residuals(&moved)?;
                Some(moved.iter().zip(residuals).map(|(after, before)| (after - before) / step).collect())
            })
            .collect()
    }

    /// Local minimum from a starting point, and the sum of squares there.
    fn descend(&self, start: Vec<f64>) -> Option<(Vec<f64>, f64)> {
        let square = |residuals: &[f64]| residuals.iter().map(|residual| residual * residual).sum::<f64>();
        let mut at = start;
        let mut residuals = self.residuals(&at)?;
        let mut sum = square(&residuals);
        let mut damping = 1e-2;
        for _ in 0..MOST_STEPS {
            let derivatives = self.derivatives(&at, &residuals)?;
            let mut improved = false;
            while damping < 1e10 {
                let Some(step) = self.step(&derivatives, &residuals, damping) else {
                    damping *= 10.0;
                    continue;
                };
                let next: Vec<f64> = (0..self.free)
                    .map(|index| {
                        let [low, high] = self.bounds(index);
                        (at[index] + step[index].clamp(-1.5, 1.5)).clamp(low, high)
                    })
                    .collect();
                match self.residuals(&next).map(|residuals| (square(&residuals), residuals)) {
                    Some((next_sum, next_residuals)) if next_sum < sum => {
                        improved = (sum - next_sum) > 1e-14 * sum;
                        (at, sum, residuals) = (next, next_sum, next_residuals);
                        damping = (damping * 0.3f64).max(1e-12);
                        break;
                    }
                    _ => damping *= 4.0,
                }
            }
            if !improved {
                break;
            }
        }
        Some((at, sum))
    }

    /// Solution of the damped normal equations.
    fn step(&self, derivatives: &[Vec<f64>], residuals: &[f64], damping: f64) -> Option<Vec<f64>> {
        let mut matrix = products(derivatives);
        for (index, row) in matrix.iter_mut().enumerate() {
            row[index] = row[index] * (1.0 + damping) + 1e-300;
        }
        let inverse = inverse(matrix)?;
        let gradient: Vec<f64> = derivatives.iter().map(|row| dot(row, residuals)).collect();
        Some(inverse.iter().map(|row| -dot(row, &gradient)).collect())
    }

    fn report(&self, at: &[f64]) -> Option<Fit> {
        let predicted = self.predict(at)?;
        let residuals = self.residuals(at)?;
        let freedom = self.rows.len() - self.free;
        let variance = dot(&residuals, &residuals) / freedom as f64;
        let covariance = self.derivatives(at, &residuals).and_then(|rows| inverse(products(&rows)));
        let interval = |index: usize| {
            let [low, high] = self.bounds(index);
            let is_inside = at[index] > low + 1e-9 && at[index] < high - 1e-9;
            let deviation = (covariance.as_ref()?[index][index] * variance).sqrt();
            let half = student_t(freedom)? * deviation;
            (is_inside && half < VAGUE).then(|| [(at[index] - half).exp(), (at[index] + half).exp()])
        };
        let parameters = (0..self.free)
            .map(|index| {
                let row = &self.info.parameters[index];
                let value = at[index].exp().clamp(row.range[0], row.range[1]);
                Fitted { name: row.name, unit: row.unit, value, interval: interval(index) }
            })
            .collect();
        let relative: Vec<f64> =
            predicted.iter().zip(self.rows).map(|(found, row)| found / row.coefficient - 1.0).collect();
        let rms = (dot(&relative, &relative) / relative.len() as f64).sqrt();
        Some(Fit { model: self.info.name, parameters, predicted, residuals: relative, rms })
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `JᵀJ` of the columns of J.
fn products(columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
    columns.iter().map(|a| columns.iter().map(|b| dot(a, b)).collect()).collect()
}

/// Inverse by Gauss–Jordan elimination with partial pivoting; none for a singular matrix.
fn inverse(mut matrix: Vec<Vec<f64>>) -> Option<Vec<Vec<f64>>> {
    let size = matrix.len();
    for (index, row) in matrix.iter_mut().enumerate() {
        row.extend((0..size).map(|column| f64::from(u8::from(column == index))));
    }
    for column in 0..size {
        let pivot = (column..size).max_by(|a, b| matrix[*a][column].abs().total_cmp(&matrix[*b][column].abs()))?;
        matrix.swap(column, pivot);
        let scale = matrix[column][column];
        if scale == 0.0 || !scale.is_finite() {
            return None;
        }
        matrix[column].iter_mut().for_each(|number| *number /= scale);
        let pivot_row = matrix[column].clone();
        for (_, row) in matrix.iter_mut().enumerate().filter(|(index, _)| *index != column) {
            let factor = row[column];
            row.iter_mut().zip(&pivot_row).for_each(|(number, pivot)| *number -= factor * pivot);
        }
    }
    Some(matrix.into_iter().map(|row| row[size..].to_vec()).collect())
}

/// The 97.5 % quantile of Student's t; from 31 degrees of freedom by the Cornish–Fisher expansion.
/// None for 0.
fn student_t(freedom: usize) -> Option<f64> {
    const QUANTILES: [f64; 30] = [
        12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160, 2.145, 2.131,
        2.120, 2.110, 2.101, 2.093, 2.086, 2.080, 2.074, 2.069, 2.064, 2.060, 2.056, 2.052, 2.048, 2.045, 2.042,
    ];
    let normal = 1.959_964f64;
    match freedom {
        0 => None,
        1..=30 => Some(QUANTILES[freedom - 1]),
        _ => Some(normal + (normal.powi(3) + normal) / (4.0 * freedom as f64)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Geometry;
    use radsight_brdf::check::Random;

    fn made(name: &str, words: &[String], numbers: &[f64], noise: f64, seed: u64) -> Vec<Row> {
        let sheet = model(name, words, numbers).unwrap();
        let mut random = Random::new(seed, 0);
        let mut rows = Vec::new();
        for observation in [0.1, 0.2, 0.33, 0.5, 0.7, 1.0] {
            for entrance in [-4.0, 15.0, 30.0] {
                let geometry = Geometry::from_degrees(observation, entrance, 0.0);
                let (observer, light) = geometry.directions();
                let coefficient = geometry.coefficient(sheet.value_and_pdf(observer, light).0);
                // A sum of twelve uniform numbers is close enough to normal.
                let normal: f64 = (0..12).map(|_| random.uniform()).sum::<f64>() - 6.0;
                rows.push(Row { geometry, coefficient: coefficient * (1.0 + noise * normal) });
            }
        }
        rows
    }

    #[test]
    fn parameters_that_made_the_data_are_found_again() {
        let cases: [(&str, &[f64]); 5] = [
            ("paper1991", &[0.086, 0.00612]),
            ("gauss_reciprocal", &[0.3, 0.004]),
            ("sharp", &[0.2, 0.01, 3.5]),
            ("mrm", &[0.4, 0.01, 1.0]),
            ("glass_bead", &[30.0]),
        ];
        for (name, numbers) in cases {
            let rows = made(name, &[], numbers, 0.0, 1);
            let found = fit(name, &[], &rows, Weights::Relative).unwrap();
            assert!(found.rms < 1e-4, "{name}: {found:?}");
            // The data determine only the product of F0 and the retroreflecting fraction of
            // microfacets.
            let known = if name == "mrm" { 1..2 } else { 0..numbers.len() };
            for index in known {
                let off = found.parameters[index].value / numbers[index] - 1.0;
                assert!(off.abs() < 1e-3, "{name} {}: {off}", found.parameters[index].name);
            }
        }
    }

    #[test]
    fn intervals_contain_the_truth_with_their_confidence() {
        let truth = [0.2, 0.008];
        let trials = 200;
        let mut held = [0; 2];
        for seed in 0..trials {
            let rows = made("gauss_reciprocal", &[], &truth, 0.05, 100 + seed);
            let found = fit("gauss_reciprocal", &[], &rows, Weights::Relative).unwrap();
            for (index, held) in held.iter_mut().enumerate() {
                let [low, high] = found.parameters[index].interval.unwrap();
                *held += u32::from(low <= truth[index] && truth[index] <= high);
            }
        }
        // 95 % of 200 are 190; 5 standard deviations are 15.
        assert!(held.iter().all(|held| (175..=200).contains(held)), "{held:?} of {trials}");
    }

    #[test]
    fn too_few_rows_and_dark_rows_are_rejected() {
        let rows = made("glass_bead", &[], &[30.0], 0.0, 1);
        assert_eq!(fit("sharp", &[], &rows[..2], Weights::Relative), Err(FitError::FewRows(2, 3)));
        let dark = [Row { coefficient: 0.0, ..rows[0] }, rows[1]];
        assert_eq!(fit("glass_bead", &[], &dark, Weights::Relative), Err(FitError::Dark(0)));
        assert!(fit("table", &[], &rows, Weights::Relative).is_err());
    }
}
