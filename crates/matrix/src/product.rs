//! Products and transposes.

use crate::{Matrix, MatrixError, Stored};
use rayon::prelude::*;

impl Matrix {
    /// Product with a matrix on the right, for each component.
    ///
    /// # Errors
    /// If rows and columns, or components, do not match.
    pub fn times(&self, right: &Matrix) -> Result<Matrix, MatrixError> {
        if self.columns() != right.rows() {
            return Err(MatrixError::Product { left: self.size(), right: right.size() });
        }
        if self.components() != right.components() {
            return Err(MatrixError::Components { found: right.components(), expected: self.components() });
        }
        let (size, components) = ([self.rows(), right.columns()], self.components());
        let mut values = Matrix::zeros(size, components)?;
        let length = right.columns() * components;
        values.par_chunks_exact_mut(length).enumerate().for_each_init(
            || vec![0.0f64; length],
            |sums, (row, values)| {
                self.add_row(row, right, sums);
                for (value, sum) in values.iter_mut().zip(sums) {
                    *value = *sum as f32;
                    *sum = 0.0;
                }
            },
        );
        let mut product = Matrix::new(size, components, values)?;
        product.splits = self.splits;
        product.stored = self.stored.with(right.stored).unwrap_or(Stored::Float);
        Ok(product)
    }

    /// Adds one row of the product. Zeros are skipped: skies are dark at night, and most directions
    /// see no window.
    fn add_row(&self, row: usize, right: &Matrix, sums: &mut [f64]) {
        let components = self.components();
        for (middle, left) in self.row(row).chunks_exact(components).enumerate() {
            if left.iter().all(|factor| *factor == 0.0) {
                continue;
            }
            for (sums, values) in sums.chunks_exact_mut(components).zip(right.row(middle).chunks_exact(components)) {
                for ((sum, value), factor) in sums.iter_mut().zip(values).zip(left) {
                    *sum += f64::from(*factor) * f64::from(*value);
                }
            }
        }
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
