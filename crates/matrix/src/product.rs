//! Products and transposes.

use crate::tile::Tile;
use crate::{Matrix, MatrixError, Stored};
use rayon::prelude::*;

/// Rows of a product that are summed together: each value on the right is converted once for all.
const MOST_ROWS: usize = 4;

impl Matrix {
    /// Product with a matrix on the right, for each component.
    ///
    /// # Errors
    /// If rows and columns, or components, do not match.
    pub fn times(&self, right: &Matrix) -> Result<Matrix, MatrixError> {
        self.check_product(right)?;
        if self.rows() <= MOST_ROWS {
            return self.dense_product(right);
        }
        let lit = right.lit_columns();
        if lit.is_empty() || 4 * lit.len() > 3 * right.columns() {
            return self.dense_product(right);
        }
        let product = self.dense_product(&right.only_columns(&lit)?)?;
        product.with_columns_at(&lit, right.columns())
    }

    /// Whether the product with a matrix on the right exists.
    pub(crate) fn check_product(&self, right: &Matrix) -> Result<(), MatrixError> {
        if self.columns() != right.rows() {
            return Err(MatrixError::Product { left: self.size(), right: right.size() });
        }
        if self.components() != right.components() {
            return Err(MatrixError::Components { found: right.components(), expected: self.components() });
        }
        Matrix::length([self.rows(), right.columns()], self.components()).map(drop)
    }

    /// The columns that are not all zero: skies are dark at night.
    fn lit_columns(&self) -> Vec<usize> {
        let mut is_lit = vec![false; self.columns()];
        for row in 0..self.rows() {
            for (is_lit, element) in is_lit.iter_mut().zip(self.row(row).chunks_exact(self.components())) {
                *is_lit |= element.iter().any(|value| *value != 0.0);
            }
        }
        (0..self.columns()).filter(|column| is_lit[*column]).collect()
    }

    fn only_columns(&self, columns: &[usize]) -> Result<Matrix, MatrixError> {
        let components = self.components();
        let mut values = Matrix::zeros([self.rows(), columns.len()], components)?;
        for (row, values) in values.chunks_exact_mut(columns.len() * components).enumerate() {
            for (value, column) in values.chunks_exact_mut(components).zip(columns) {
                value.copy_from_slice(&self.row(row)[column * components..][..components]);
            }
        }
        Ok(Matrix::new([self.rows(), columns.len()], components, values)?.described_as(self))
    }

    /// The matrix of `count` columns that has these in the given places and zeros elsewhere.
    fn with_columns_at(&self, places: &[usize], count: usize) -> Result<Matrix, MatrixError> {
        let components = self.components();
        let mut values = Matrix::zeros([self.rows(), count], components)?;
        for (row, values) in values.chunks_exact_mut(count * components).enumerate() {
            for (value, column) in self.row(row).chunks_exact(components).zip(places) {
                values[column * components..][..components].copy_from_slice(value);
            }
        }
        Ok(Matrix::new([self.rows(), count], components, values)?.described_as(self))
    }

    fn dense_product(&self, right: &Matrix) -> Result<Matrix, MatrixError> {
        let (size, components) = ([self.rows(), right.columns()], self.components());
        let mut values = Matrix::zeros(size, components)?;
        let length = right.columns() * components;
        let rows = self.rows().div_ceil(rayon::current_num_threads()).clamp(1, MOST_ROWS);
        values.par_chunks_mut(rows * length).enumerate().for_each_init(Tile::default, |tile, (band, values)| {
            tile.multiply(self, right, band * rows, values);
        });
        let mut product = Matrix::new(size, components, values)?;
        product.splits = self.splits;
        product.stored = self.stored.with(right.stored).unwrap_or(Stored::Float);
        Ok(product)
    }

    /// Transpose.
    #[must_use]
    pub fn transposed(&self) -> Matrix {
        let components = self.components();
        let mut values = Vec::with_capacity(self.values().len());
        for column in 0..self.columns() {
            for row in 0..self.rows() {
                values.extend_from_slice(&self.row(row)[column * components..][..components]);
            }
        }
        self.with_values([self.columns(), self.rows()], components, values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(size: [usize; 2], values: &[f32]) -> Matrix {
        Matrix::new(size, 1, values.to_vec()).unwrap()
    }

    #[test]
    fn a_product_is_sums_of_rows_times_columns() {
        let (left, right) = (matrix([2, 2], &[1.0, 2.0, 0.0, 4.0]), matrix([2, 3], &[1.0, 0.0, 2.0, 3.0, 1.0, 0.0]));
        assert_eq!(left.times(&right).unwrap().values(), [7.0, 2.0, 2.0, 12.0, 4.0, 0.0]);
        assert!(matches!(right.times(&left), Err(MatrixError::Product { .. })));
    }

    #[test]
    fn products_of_any_size_are_the_sums_that_define_them() {
        let matrix = |size: [usize; 2], components: usize, divisor: usize| {
            let value =
                |at: usize| if (at / components).is_multiple_of(divisor) { (at % 13) as f32 - 5.5 } else { 0.0 };
            let values = (0..size[0] * size[1] * components).map(value).collect();
            Matrix::new(size, components, values).unwrap()
        };
        for (components, divisor) in [(1, 1), (3, 1), (3, 5), (5, 2), (12, 3), (20, 1)] {
            let (left, right) = (matrix([11, 9], components, 2), matrix([9, 305], components, divisor));
            let product = left.times(&right).unwrap();
            for at in 0..11 * 305 * components {
                let (row, column, band) = (at / components / 305, at / components % 305, at % components);
                let term = |middle: usize| {
                    let factors =
                        [left.row(row)[middle * components + band], right.row(middle)[column * components + band]];
                    f64::from(factors[0]) * f64::from(factors[1])
                };
                let sum: f64 = (0..9).map(term).sum();
                assert_eq!(product.values()[at], sum as f32, "{components} components, value {at}");
            }
        }
    }

    #[test]
    fn matrices_too_large_for_memory_are_rejected() {
        let (left, right) = (matrix([1 << 18, 1], &[1.0; 1 << 18]), matrix([1, 1 << 18], &[1.0; 1 << 18]));
        assert!(matches!(left.times(&right), Err(MatrixError::TooLarge { .. })));
    }

    #[test]
    fn transposing_twice_is_the_identity() {
        let matrix = Matrix::new([2, 3], 2, (0..12).map(|value| value as f32).collect()).unwrap();
        assert_eq!(matrix.transposed().values()[..4], [0.0, 1.0, 6.0, 7.0]);
        assert_eq!(matrix.transposed().transposed(), matrix);
    }
}
