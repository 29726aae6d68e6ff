//! Errors about matrices.

use radsight_diag::Diagnostic;
use radsight_picture::PictureError;

/// Why a matrix cannot be read, written or computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MatrixError {
    /// The file is malformed, or a format cannot store the matrix.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A BSDF file is malformed.
    #[error("{0}")]
    Bsdf(String),
    /// The left matrix's columns do not match the right one's rows.
    #[error("a product of {} x {} and {} x {}, expected as many rows as the left one has columns", left[0], left[1], right[0], right[1])]
    Product {
        /// Rows and columns.
        left: [usize; 2],
        /// Rows and columns.
        right: [usize; 2],
    },
    /// Matrices that must have equal size differ.
    #[error("{} x {}, expected {} x {} as in the previous matrix", found[0], found[1], expected[0], expected[1])]
    Size {
        /// Rows and columns.
        found: [usize; 2],
        /// Rows and columns of the previous matrix.
        expected: [usize; 2],
    },
    /// The numbers of components do not match.
    #[error("{found} components, expected {expected}")]
    Components {
        /// Components of this matrix.
        found: usize,
        /// Components of the other matrix.
        expected: usize,
    },
    /// The number of factors is neither one nor the number of components.
    #[error("{found} factors for {components} components, expected 1 or {components}")]
    Factors {
        /// Number of factors.
        found: usize,
        /// Components of the matrix.
        components: usize,
    },
    /// The coefficients do not form whole rows.
    #[error("{found} coefficients for {components} components, expected a multiple of {components}")]
    Coefficients {
        /// Number of coefficients.
        found: usize,
        /// Components of the matrix.
        components: usize,
    },
    /// A letter denotes no component.
    #[error("component \"{letter}\" is not known, expected some of R G B X Y Z S M A")]
    Letter {
        /// The letter.
        letter: char,
    },
    /// A letter needs other components.
    #[error("component \"{letter}\" cannot be made of {components}, expected {expected}")]
    Made {
        /// The letter.
        letter: char,
        /// Components of the matrix.
        components: usize,
        /// Components that it needs.
        expected: &'static str,
    },
    /// The elements do not fit the requested rows and columns.
    #[error("{} x {} cannot be arranged as {} x {}", found[0], found[1], wanted[0], wanted[1])]
    Arrangement {
        /// Rows and columns.
        found: [usize; 2],
        /// Rows and columns.
        wanted: [usize; 2],
    },
    /// The result does not fit in memory.
    #[error("a matrix of {} x {} with {components} components is too large", size[0], size[1])]
    TooLarge {
        /// Rows and columns.
        size: [usize; 2],
        /// Components of an element.
        components: usize,
    },
    /// A definition cannot be evaluated.
    #[error("{}", words(.0))]
    Definition(Vec<Diagnostic>),
}

fn words(diagnostics: &[Diagnostic]) -> String {
    diagnostics.iter().map(|found| found.message.as_str()).collect::<Vec<_>>().join("; ")
}
