//! Components of spatial variance: rows, columns, and the remainder.

use crate::SpatialDeviation;
use crate::interval::Estimate;

/// Two-way analysis of variance of a picture (rows and columns), with one value per cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SpatialVariance {
    columns: f64,
    rows: f64,
    /// Mean squares of rows, of columns and of the remainder.
    row_square: f64,
    column_square: f64,
    rest_square: f64,
}

impl SpatialVariance {
    pub(super) fn of(values: &[f64], columns: usize) -> SpatialVariance {
        let rows = values.len() / columns;
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let row_means: Vec<f64> = values.chunks(columns).map(|row| row.iter().sum::<f64>() / columns as f64).collect();
        let mut column_means = vec![0.0; columns];
        for row in values.chunks(columns) {
            column_means.iter_mut().zip(row).for_each(|(sum, value)| *sum += value / rows as f64);
        }
        let squares = |means: &[f64]| means.iter().map(|part| (part - mean).powi(2)).sum::<f64>();
        let mut rest = 0.0;
        for (row, row_mean) in values.chunks(columns).zip(&row_means) {
            for (value, column_mean) in row.iter().zip(&column_means) {
                rest += (value - row_mean - column_mean + mean).powi(2);
            }
        }
        let (columns, rows) = (columns as f64, rows as f64);
        SpatialVariance {
            columns,
            rows,
            row_square: columns * squares(&row_means) / (rows - 1.0),
            column_square: rows * squares(&column_means) / (columns - 1.0),
            rest_square: rest / ((rows - 1.0) * (columns - 1.0)),
        }
    }

    /// Total and components, after subtraction of the variance that temporal noise leaves in each
    /// value.
    pub(super) fn estimates(&self, noise: f64) -> [Estimate; 4] {
        let (rows, columns) = (self.rows, self.columns);
        let rest_degrees = (rows - 1.0) * (columns - 1.0);
        let row_part = (self.row_square - self.rest_square) / columns;
        let column_part = (self.column_square - self.rest_square) / rows;
        let total = row_part + column_part + self.rest_square;
        // Satterthwaite's effective degrees of freedom of the sum.
        let variance = 2.0 * (self.row_square / columns).powi(2) / (rows - 1.0)
            + 2.0 * (self.column_square / rows).powi(2) / (columns - 1.0)
            + 2.0 * self.rest_square.powi(2) / rest_degrees;
        [
            Estimate::deviation(total, 2.0 * total * total / variance, noise, 1.0),
            Estimate::deviation(self.rest_square, rest_degrees, noise, 1.0),
            Estimate::deviation(self.row_square, rows - 1.0, self.rest_square, columns.recip()),
            Estimate::deviation(self.column_square, columns - 1.0, self.rest_square, rows.recip()),
        ]
    }

    /// Best values of the components.
    pub(super) fn parts(&self, noise: f64) -> SpatialDeviation {
        let [_, pixel, row, column] = self.estimates(noise).map(|estimate| estimate.value);
        SpatialDeviation { pixel, row, column }
    }
}
