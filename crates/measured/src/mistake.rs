//! Errors in BSDF files.

use std::ops::Range;

/// Byte range in the file.
pub type Place = Range<usize>;

/// An error, with its position and what was expected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Mistake {
    /// The file has no tag at all: the program that should have written it failed.
    #[error("there is no XML in it")]
    NoXml {
        /// First line of the file.
        place: Place,
    },
    /// The file is not well-formed XML, has a document type, or has far more elements than a BSDF.
    #[error("this is not XML that can be read: {what}")]
    Xml {
        /// Message of the XML reader.
        what: String,
        /// Position of the error.
        place: Place,
    },
    /// A required element is missing.
    #[error("there is no <{element}> in <{inside}>")]
    Missing {
        /// The missing element.
        element: &'static str,
        /// The element that should contain it.
        inside: String,
        /// Position of that element.
        place: Place,
    },
    /// A word or number is not valid here.
    #[error("{what} is \"{found}\", expected {expected}")]
    Unexpected {
        /// The element or number.
        what: String,
        /// Text as written, shortened.
        found: String,
        /// What is valid here.
        expected: String,
        /// Position of the text.
        place: Place,
    },
    /// Scattering data have too few numbers, or too many.
    #[error("the scattering data hold {found} numbers, expected {expected}")]
    Count {
        /// Number of numbers found.
        found: usize,
        /// Number of numbers expected.
        expected: String,
        /// Position of the data.
        place: Place,
    },
    /// The braces of a tensor tree do not match.
    #[error("the tensor tree has {found}, expected {expected}")]
    Tree {
        /// Token that was found.
        found: String,
        /// Token that was expected.
        expected: String,
        /// Position of the token.
        place: Place,
    },
}

impl Mistake {
    /// Byte range of the error.
    #[must_use]
    pub fn place(&self) -> Place {
        let (Mistake::NoXml { place }
        | Mistake::Xml { place, .. }
        | Mistake::Missing { place, .. }
        | Mistake::Unexpected { place, .. }
        | Mistake::Count { place, .. }
        | Mistake::Tree { place, .. }) = self;
        place.clone()
    }

    pub(crate) fn place_mut(&mut self) -> &mut Place {
        let (Mistake::NoXml { place }
        | Mistake::Xml { place, .. }
        | Mistake::Missing { place, .. }
        | Mistake::Unexpected { place, .. }
        | Mistake::Count { place, .. }
        | Mistake::Tree { place, .. }) = self;
        place
    }

    /// Hint for the user, if there is one.
    #[must_use]
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Mistake::NoXml { .. } | Mistake::Xml { .. } => {
                Some("BSDF files are XML, as written by genBSDF, WINDOW or pabopto2bsdf")
            }
            Mistake::Missing { element: "Visible", .. } => Some("colour data need visible data as well"),
            Mistake::Count { .. } => Some("a matrix has a number for each pair of the directions of its two bases"),
            _ => None,
        }
    }

    pub(crate) fn unexpected(what: impl Into<String>, found: &str, expected: impl Into<String>, place: Place) -> Self {
        const LONGEST: usize = 40;
        let mut shown: String = found.trim().chars().take(LONGEST).collect();
        if shown.len() < found.trim().len() {
            shown.push('…');
        }
        Mistake::Unexpected { what: what.into(), found: shown, expected: expected.into(), place }
    }
}
