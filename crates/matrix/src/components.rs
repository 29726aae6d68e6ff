//! Transforms of components: each new component is a linear combination of the old ones.

use crate::{Matrix, MatrixError, Stored};
use radsight_picture::{Encoding, RgbPrimaries, WHITE_EFFICACY};
use radsight_spectrum::{Conversion, MELANOPIC_OF_RGB, Response, SCOTOPIC_OF_RGB, Sampling, xyz_of_whole_bands};

/// Argument of `-c`.
#[derive(Clone, Debug, PartialEq)]
pub enum Transform {
    /// Coefficients by rows, each row as long as the number of components.
    Coefficients(Vec<f64>),
    /// Components by letters: `R G B`, `X Y Z`, scotopic (`S`), melanopic (`M`), mean (`A`);
    /// lower-case `y z x s m` are in watts, capitals in lumens.
    Letters(String),
    /// Components of another file: storage format, number, and limits of its wavelengths.
    As(Stored, usize, [f32; 4]),
}

/// Coefficients, and the format of the result.
struct Rows {
    coefficients: Vec<f64>,
    stored: Option<Stored>,
    splits: [f32; 4],
}

impl Matrix {
    /// Components of this matrix, as [`Transform::As`].
    #[must_use]
    pub fn kind(&self) -> Transform {
        Transform::As(self.stored, self.components(), self.splits)
    }

    /// Other components of the same elements, multiplied by `factors` if there are any.
    ///
    /// # Errors
    /// If they cannot be computed from the existing components.
    pub fn transformed(&self, transform: &Transform, factors: &[f64]) -> Result<Matrix, MatrixError> {
        let components = self.components();
        let Some(Rows { mut coefficients, stored, splits }) = self.rows_of(transform)? else {
            let mut same = self.clone();
            if !factors.is_empty() {
                same.scale(factors)?;
            }
            return Ok(same);
        };
        if coefficients.is_empty() || coefficients.len() % components != 0 {
            return Err(MatrixError::Coefficients { found: coefficients.len(), components });
        }
        let made = coefficients.len() / components;
        if !factors.is_empty() && factors.len() != 1 && factors.len() != made {
            return Err(MatrixError::Factors { found: factors.len(), components: made });
        }
        for (row, factor) in coefficients.chunks_exact_mut(components).zip(factors.iter().cycle()) {
            row.iter_mut().for_each(|coefficient| *coefficient *= factor);
        }
        let mut values = Vec::with_capacity(Matrix::length(self.size(), made)?);
        for element in self.values().chunks_exact(components) {
            for row in coefficients.chunks_exact(components) {
                let sum: f64 = row.iter().zip(element).map(|(share, value)| share * f64::from(*value)).sum();
                values.push(sum as f32);
            }
        }
        let mut result = self.with_values(self.size(), made, values);
        result.splits = splits;
        result.stored = match stored {
            // More than three components that are not a spectrum cannot be stored as a picture.
            _ if made > 3 && self.stored.is_picture() => Stored::Float,
            Some(stored) => stored,
            None => self.stored,
        };
        Ok(result)
    }

    /// Coefficients of a transform; `None` if nothing changes.
    fn rows_of(&self, transform: &Transform) -> Result<Option<Rows>, MatrixError> {
        let (components, usual) = (self.components(), Encoding::USUAL_SPLITS);
        match transform {
            Transform::Coefficients(coefficients) => {
                Ok(Some(Rows { coefficients: coefficients.clone(), stored: None, splits: usual }))
            }
            Transform::Letters(letters) => self.rows_of_letters(letters).map(Some),
            Transform::As(stored, 3, _) => {
                let letters = if *stored == Stored::Xyze { "XYZ" } else { "RGB" };
                self.rows_of_letters(letters).map(Some)
            }
            Transform::As(_, 1, _) => self.rows_of_letters("Y").map(Some),
            Transform::As(_, wanted, splits) if *wanted == components && *splits == self.splits => Ok(None),
            Transform::As(_, wanted, splits) => {
                let range = |splits: &[f32; 4]| [splits[0], splits[3]].map(f64::from);
                let sampling = Sampling::new(*wanted, range(splits)).filter(|to| to.bands() == *wanted);
                let Some(sampling) = sampling.filter(|_| components > 3) else {
                    return Err(MatrixError::Components { found: components, expected: *wanted });
                };
                let conversion = Conversion::new(&sampling, components, range(&self.splits));
                let mut coefficients = vec![0.0; wanted * components];
                let mut response = vec![0.0; *wanted];
                for band in 0..components {
                    conversion.apply((0..components).map(|at| f64::from(u8::from(at == band))), &mut response);
                    for (row, value) in coefficients.chunks_exact_mut(components).zip(&response) {
                        row[band] = *value;
                    }
                }
                Ok(Some(Rows { coefficients, stored: None, splits: *splits }))
            }
        }
    }

    fn rows_of_letters(&self, letters: &str) -> Result<Rows, MatrixError> {
        let mut coefficients = Vec::new();
        for letter in letters.chars() {
            coefficients.extend(self.row_of_letter(letter)?);
        }
        let stored = match letters.to_ascii_uppercase().as_str() {
            "XYZ" if self.stored.is_picture() => Some(Stored::Xyze),
            "RGB" if self.stored.is_picture() => Some(Stored::Rgbe),
            "XYZ" | "RGB" => None,
            _ if self.stored == Stored::Spectra => Some(Stored::Float),
            _ => None,
        };
        Ok(Rows { coefficients, stored, splits: Encoding::USUAL_SPLITS })
    }

    /// Coefficients of one component.
    fn row_of_letter(&self, letter: char) -> Result<Vec<f64>, MatrixError> {
        let components = self.components();
        if components < 3 {
            return Err(MatrixError::Made { letter, components, expected: "at least 3" });
        }
        let (is_xyz, is_capital) = (self.stored == Stored::Xyze, letter.is_ascii_uppercase());
        let single = |at: usize| (0..components).map(|component| f64::from(u8::from(component == at))).collect();
        let standard = RgbPrimaries::STANDARD;
        let (Some(to_xyz), Some(from_xyz)) = (standard.rgb_to_xyz(), standard.xyz_to_rgb()) else {
            return Err(MatrixError::Letter { letter });
        };
        let place = |of: &str| of.find(letter.to_ascii_uppercase());
        if let Some(part) = place("RGB") {
            return Ok(match (is_xyz, components) {
                (true, _) => {
                    let scale = if is_capital { 1.0 / WHITE_EFFICACY } else { 1.0 };
                    (from_xyz.row(part) * scale).to_array().to_vec()
                }
                (false, 3) => single(part),
                // A single band may have a negative value: only sums are colours.
                (false, _) => self.bands().map(|xyz| from_xyz.row(part).dot(xyz.into())).collect(),
            });
        }
        if let Some(part) = place("XYZ") {
            let scale = if is_capital && !is_xyz { WHITE_EFFICACY } else { 1.0 };
            return Ok(match (is_xyz, components) {
                (true, _) => single(part),
                (false, 3) => (to_xyz.row(part) * scale).to_array().to_vec(),
                (false, _) => self.bands().map(|xyz| scale * xyz[part]).collect(),
            });
        }
        if letter.eq_ignore_ascii_case(&'A') {
            return Ok(vec![1.0 / components as f64; components]);
        }
        let (weights, response) = match letter.to_ascii_uppercase() {
            'S' => (SCOTOPIC_OF_RGB, Response::Scotopic),
            'M' => (MELANOPIC_OF_RGB, Response::Melanopic),
            _ => return Err(MatrixError::Letter { letter }),
        };
        let white = response.white_efficacy();
        if components != 3 {
            let scale = if is_capital { white } else { 1.0 };
            let range = [self.splits[0], self.splits[3]].map(f64::from);
            return Ok(response.of_whole_bands(components, range).map(|share| share * scale).collect());
        }
        let scale = if is_capital { 1.0 } else { 1.0 / white };
        Ok(weights.map(|weight| weight * scale).to_vec())
    }

    /// X, Y and Z of each band alone.
    fn bands(&self) -> impl Iterator<Item = [f64; 3]> {
        xyz_of_whole_bands(self.components(), [self.splits[0], self.splits[3]].map(f64::from))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn white(components: usize) -> Matrix {
        Matrix::new([1, 1], components, vec![1.0; components]).unwrap()
    }

    #[test]
    fn white_has_the_luminance_of_white() {
        for components in [3, 6, 18] {
            let luminance = white(components).transformed(&Transform::Letters("Y".into()), &[]).unwrap();
            assert!((luminance.values()[0] - 179.0).abs() < 0.5, "{:?}", luminance.values());
        }
    }

    #[test]
    fn impossible_components_are_rejected() {
        let letters = |text: &str| Transform::Letters(text.into());
        assert!(matches!(white(1).transformed(&letters("Y"), &[]), Err(MatrixError::Made { .. })));
        assert!(matches!(white(2).transformed(&letters("S"), &[]), Err(MatrixError::Made { .. })));
        assert!(matches!(white(3).transformed(&letters("q"), &[]), Err(MatrixError::Letter { letter: 'q' })));
        let four = Transform::Coefficients(vec![1.0; 4]);
        assert!(matches!(white(3).transformed(&four, &[]), Err(MatrixError::Coefficients { .. })));
    }
}
