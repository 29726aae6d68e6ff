//! Reading and writing matrices.

use crate::MatrixError;
use radsight_picture::{Encoding, FileFormat, FloatMatrix, Header, Image, MatrixFormat, Picture, RgbPrimaries};

/// Maximum number of values: a product of two small matrices could exceed it.
const MOST_VALUES: usize = 1 << 33;

/// Storage format of a file. Of two combined matrices the result has the format of the lower
/// precision, if they are compatible.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stored {
    /// Pixels of red, green and blue.
    Rgbe,
    /// Pixels of X, Y and Z.
    Xyze,
    /// Pixels of spectra.
    Spectra,
    /// Single precision.
    Float,
    /// Text.
    Ascii,
    /// Double precision.
    Double,
}

impl Stored {
    /// Whether values share exponents, as in pictures.
    #[must_use]
    pub fn is_picture(self) -> bool {
        self <= Stored::Spectra
    }

    /// Format of a combination; `None` if the formats are incompatible: a picture and a
    /// non-picture, or two different kinds of picture.
    #[must_use]
    pub fn with(self, other: Stored) -> Option<Stored> {
        let goes_together = self == other || !(self.is_picture() || other.is_picture());
        goes_together.then_some(self.min(other))
    }
}

/// Rows and columns of elements with one or more components.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    /// Header of the file, with its history.
    pub header: Header,
    /// Storage format.
    pub stored: Stored,
    /// Longest wavelength, ends of red and of green, shortest wavelength, nm; used with more than
    /// three components.
    pub(crate) splits: [f32; 4],
    rows: usize,
    columns: usize,
    components: usize,
    values: Vec<f32>,
}

impl Matrix {
    /// A matrix of values by rows, with the components of each element together.
    ///
    /// # Errors
    /// [`MatrixError::TooLarge`] if the number of values does not match.
    pub fn new([rows, columns]: [usize; 2], components: usize, values: Vec<f32>) -> Result<Matrix, MatrixError> {
        if Matrix::length([rows, columns], components)? != values.len() {
            return Err(MatrixError::TooLarge { size: [rows, columns], components });
        }
        let header = Header::default();
        let splits = Encoding::USUAL_SPLITS;
        Ok(Matrix { header, stored: Stored::Float, splits, rows, columns, components, values })
    }

    /// Number of values, if it is below [`MOST_VALUES`].
    pub(crate) fn length([rows, columns]: [usize; 2], components: usize) -> Result<usize, MatrixError> {
        let count = rows.checked_mul(columns).and_then(|count| count.checked_mul(components));
        let too_large = MatrixError::TooLarge { size: [rows, columns], components };
        count.filter(|count| (1..=MOST_VALUES).contains(count)).ok_or(too_large)
    }

    /// Zeros, if memory suffices.
    pub(crate) fn zeros(size: [usize; 2], components: usize) -> Result<Vec<f32>, MatrixError> {
        let count = Matrix::length(size, components)?;
        let mut values = Vec::new();
        values.try_reserve_exact(count).map_err(|_| MatrixError::TooLarge { size, components })?;
        values.resize(count, 0.0);
        Ok(values)
    }

    /// Reads a picture or a float matrix; exposures are undone.
    ///
    /// # Errors
    /// If the bytes are neither.
    pub fn read(bytes: &[u8]) -> Result<Matrix, MatrixError> {
        let is_matrix = FileFormat::from_content(bytes) != Some(FileFormat::Picture);
        let (header, stored, image) = if is_matrix {
            let matrix = FloatMatrix::read(bytes)?;
            let stored = match matrix.format {
                MatrixFormat::Ascii => Stored::Ascii,
                MatrixFormat::Float => Stored::Float,
                MatrixFormat::Double => Stored::Double,
            };
            (matrix.header.clone(), stored, matrix.into_f32())
        } else {
            let picture = Picture::read(bytes)?;
            let stored = match picture.encoding() {
                Encoding::Xyze => Stored::Xyze,
                Encoding::Spectral { .. } => Stored::Spectra,
                _ => Stored::Rgbe,
            };
            (picture.header().clone(), stored, picture.values())
        };
        let components = image.components();
        let scale = header.radiance_scale()?;
        let splits = header.wavelength_splits()?.unwrap_or(Encoding::USUAL_SPLITS);
        let size = [image.height(), image.width()];
        let mut matrix = Matrix::new(size, components, image.into_data())?;
        if scale != [1.0; 3] {
            let scale: Vec<f32> = (0..components).map(|i| if i == 0 || i == 2 { scale[i] } else { scale[1] }).collect();
            matrix.values.chunks_exact_mut(components).for_each(|value| {
                value.iter_mut().zip(&scale).for_each(|(value, scale)| *value *= scale);
            });
        }
        let mut header = header.history();
        for undone in ["EXPOSURE", "COLORCORR"] {
            header.remove(undone);
        }
        Ok(Matrix { header, stored, splits, ..matrix })
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Rows and columns.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        [self.rows, self.columns]
    }

    /// Number of components of an element.
    #[must_use]
    pub fn components(&self) -> usize {
        self.components
    }

    /// All values, row by row.
    #[must_use]
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    pub(crate) fn values_mut(&mut self) -> &mut [f32] {
        &mut self.values
    }

    /// Values of a row.
    pub(crate) fn row(&self, row: usize) -> &[f32] {
        let length = self.columns * self.components;
        &self.values[row * length..][..length]
    }

    /// The same values with the header and format of another matrix.
    pub(crate) fn described_as(self, other: &Matrix) -> Matrix {
        Matrix { header: other.header.clone(), stored: other.stored, splits: other.splits, ..self }
    }

    /// A single column.
    ///
    /// # Panics
    /// If there is no such column.
    #[must_use]
    pub fn column(&self, column: usize) -> Matrix {
        assert!(column < self.columns, "column {column} of {}", self.columns);
        let of_row = |row: usize| &self.row(row)[column * self.components..][..self.components];
        let values = (0..self.rows).flat_map(of_row).copied().collect();
        Matrix { columns: 1, values, header: self.header.clone(), ..*self }
    }

    /// The same values in other rows and columns; one of the two may be 0, which computes it.
    ///
    /// # Errors
    /// [`MatrixError::Arrangement`] if the number of elements does not match.
    pub fn arranged(self, [rows, columns]: [usize; 2]) -> Result<Matrix, MatrixError> {
        let count = self.rows * self.columns;
        let wanted = match [rows, columns] {
            [0, 0] => self.size(),
            [0, columns] => [count / columns, columns],
            [rows, 0] => [rows, count / rows],
            both => both,
        };
        if wanted[0].checked_mul(wanted[1]) != Some(count) {
            return Err(MatrixError::Arrangement { found: self.size(), wanted });
        }
        Ok(Matrix { rows: wanted[0], columns: wanted[1], ..self })
    }

    /// Bytes of a file with the given header. As in Radiance's programs, a picture of more than
    /// three components is stored as spectra, and X, Y and Z stay X, Y and Z.
    ///
    /// # Errors
    /// [`MatrixError::Picture`] if a picture cannot have this number of components.
    pub fn write(&self, header: &Header, stored: Stored) -> Result<Vec<u8>, MatrixError> {
        let has_xyz_primaries = || matches!(header.primaries(), Ok(Some(RgbPrimaries::XYZ)));
        let stored = match stored {
            Stored::Rgbe | Stored::Xyze if self.components > 3 => Stored::Spectra,
            Stored::Rgbe if self.stored == Stored::Xyze || has_xyz_primaries() => Stored::Xyze,
            Stored::Xyze if self.stored == Stored::Rgbe => Stored::Rgbe,
            stored => stored,
        };
        let mut header = header.clone();
        if self.components > 3 && self.splits != Encoding::USUAL_SPLITS {
            header.push_variable("WAVELENGTH_SPLITS", &self.splits.map(|split| split.to_string()).join(" "));
        }
        let grey = self.components == 1 && matches!(stored, Stored::Rgbe | Stored::Xyze);
        let (values, components) = match grey {
            true => (self.values.iter().flat_map(|value| [*value; 3]).collect(), 3),
            false => (self.values.clone(), self.components),
        };
        let image = Image::new(self.columns, self.rows, components, values)?;
        Ok(match stored {
            Stored::Rgbe => Picture::from_rgb(header, &image)?.to_bytes(),
            Stored::Xyze => Picture::from_xyz(header, &image)?.to_bytes(),
            Stored::Spectra => Picture::from_spectra(header, &image, self.splits)?.to_bytes(),
            Stored::Float => FloatMatrix::write_f32(&header, &image, MatrixFormat::Float),
            Stored::Ascii => FloatMatrix::write_f32(&header, &image, MatrixFormat::Ascii),
            Stored::Double => FloatMatrix::write_f32(&header, &image, MatrixFormat::Double),
        })
    }
}
