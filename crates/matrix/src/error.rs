//! What can be wrong with matrices.

use radsight_diag::Diagnostic;
use radsight_picture::PictureError;

/// Why a matrix cannot be read, written or computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MatrixError {
    /// Its file is malformed, or a format cannot hold it.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A BSDF file is malformed.
    #[error("{0}")]
    Bsdf(String),
    /// The columns of one are not the rows of the other.
    #[error("a product of {} x {} and {} x {}, expected as many rows as the left one has columns", left[0], left[1], right[0], right[1])]
    Product {
        /// Rows and columns.
        left: [usize; 2],
        /// Rows and columns.
        right: [usize; 2],
    },
    /// Two that should have one size have several.
    #[error("{} x {}, expected {} x {} as the one before", found[0], found[1], expected[0], expected[1])]
    Size {
        /// Rows and columns.
        found: [usize; 2],
        /// Those of the one before.
        expected: [usize; 2],
    },
    /// A number of components that does not go with the other's.
    #[error("{found} components, expected {expected}")]
    Components {
        /// Of this one.
        found: usize,
        /// Of the other.
        expected: usize,
    },
    /// Factors that are neither one nor one for each component.
    #[error("{found} factors for {components} components, expected 1 or {components}")]
    Factors {
        /// How many.
        found: usize,
        /// Of the matrix.
        components: usize,
    },
    /// Coefficients that are no whole rows.
    #[error("{found} coefficients for {components} components, expected a multiple of {components}")]
    Coefficients {
        /// How many.
        found: usize,
        /// Of the matrix.
        components: usize,
    },
    /// A letter that names no component.
    #[error("component \"{letter}\" is not known, expected some of R G B X Y Z S M A")]
    Letter {
        /// The letter.
        letter: char,
    },
    /// A letter that needs other components than there are.
    #[error("component \"{letter}\" cannot be made of {components}, expected {expected}")]
    Made {
        /// The letter.
        letter: char,
        /// Of the matrix.
        components: usize,
        /// What it takes.
        expected: &'static str,
    },
    /// Rows and columns that do not hold what there is.
    #[error("{} x {} cannot be arranged as {} x {}", found[0], found[1], wanted[0], wanted[1])]
    Arrangement {
        /// Rows and columns.
        found: [usize; 2],
        /// Rows and columns.
        wanted: [usize; 2],
    },
    /// A result that memory cannot hold.
    #[error("a matrix of {} x {} with {components} components is too large", size[0], size[1])]
    TooLarge {
        /// Rows and columns.
        size: [usize; 2],
        /// Values of an element.
        components: usize,
    },
    /// A definition cannot be computed.
    #[error("{}", words(.0))]
    Definition(Vec<Diagnostic>),
}

fn words(diagnostics: &[Diagnostic]) -> String {
    diagnostics.iter().map(|found| found.message.as_str()).collect::<Vec<_>>().join("; ")
}
