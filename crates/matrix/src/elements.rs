//! Element-wise operations.

use crate::{Matrix, MatrixError};

impl Matrix {
    /// Adds a matrix of equal size and components.
    ///
    /// # Errors
    /// If they differ.
    pub fn add(&mut self, other: &Matrix) -> Result<(), MatrixError> {
        self.check_alike(other)?;
        self.stored = self.stored.with(other.stored).unwrap_or(self.stored);
        self.values_mut().iter_mut().zip(other.values()).for_each(|(value, other)| *value += other);
        Ok(())
    }

    /// Multiplies by a matrix of equal size, with as many components or one.
    ///
    /// # Errors
    /// If size or components do not match.
    pub fn multiply(&mut self, other: &Matrix) -> Result<(), MatrixError> {
        self.change_by(other, |value, other| *value *= other)
    }

    /// Divides by a matrix of equal size, with as many components or one. Division by zero gives
    /// zero; returns how often that happened.
    ///
    /// # Errors
    /// If size or components do not match.
    pub fn divide(&mut self, other: &Matrix) -> Result<usize, MatrixError> {
        let mut zeros = 0;
        self.change_by(other, |value, other| {
            zeros += usize::from(other == 0.0);
            *value = if other == 0.0 { 0.0 } else { *value / other };
        })?;
        Ok(zeros)
    }

    /// Checks that another matrix has equal size and components.
    pub(crate) fn check_alike(&self, other: &Matrix) -> Result<(), MatrixError> {
        self.check_size(other)?;
        let [found, expected] = [other.components(), self.components()];
        if found == expected { Ok(()) } else { Err(MatrixError::Components { found, expected }) }
    }

    fn check_size(&self, other: &Matrix) -> Result<(), MatrixError> {
        if self.size() != other.size() {
            return Err(MatrixError::Size { found: other.size(), expected: self.size() });
        }
        Ok(())
    }

    fn change_by(&mut self, other: &Matrix, mut change: impl FnMut(&mut f32, f32)) -> Result<(), MatrixError> {
        self.check_size(other)?;
        let (components, of_other) = (self.components(), other.components());
        if of_other != 1 && of_other != components {
            return Err(MatrixError::Components { found: of_other, expected: components });
        }
        self.stored = self.stored.with(other.stored).unwrap_or(self.stored);
        let elements = self.values_mut().chunks_exact_mut(components).zip(other.values().chunks_exact(of_other));
        for (element, by) in elements {
            for (component, value) in element.iter_mut().enumerate() {
                change(value, by[component.min(of_other - 1)]);
            }
        }
        Ok(())
    }

    /// Multiplies all elements by one factor, or each component by its own.
    ///
    /// # Errors
    /// [`MatrixError::Factors`] for any other number of factors.
    pub fn scale(&mut self, factors: &[f64]) -> Result<(), MatrixError> {
        let components = self.components();
        if factors.len() != 1 && factors.len() != components {
            return Err(MatrixError::Factors { found: factors.len(), components });
        }
        for element in self.values_mut().chunks_exact_mut(components) {
            for (component, value) in element.iter_mut().enumerate() {
                *value *= factors[component.min(factors.len() - 1)] as f32;
            }
        }
        Ok(())
    }

    /// A matrix with other values and the same header.
    pub(crate) fn with_values(&self, size: [usize; 2], components: usize, values: Vec<f32>) -> Matrix {
        let made = Matrix::new(size, components, values).expect("as many values as the size takes");
        made.described_as(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn division_by_zero_gives_zero() {
        let mut matrix = Matrix::new([1, 2], 2, vec![1.0, 2.0, 3.0, 4.0]).unwrap();
        let by = Matrix::new([1, 2], 1, vec![2.0, 0.0]).unwrap();
        assert_eq!(matrix.divide(&by), Ok(2));
        assert_eq!(matrix.values(), [0.5, 1.0, 0.0, 0.0]);
        assert!(matrix.add(&by).is_err() && matrix.scale(&[1.0; 3]).is_err());
    }
}
