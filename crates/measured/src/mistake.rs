//! What can be wrong with a BSDF file.

use std::ops::Range;

/// Bytes of the file.
pub type Place = Range<usize>;

/// What is wrong, where, and what was expected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Mistake {
    /// The file has no tag at all: the program that should have written it failed.
    #[error("there is no XML in it")]
    NoXml {
        /// Its first line.
        place: Place,
    },
    /// The file is not well-formed XML, has a document type, or has far more elements than a BSDF.
    #[error("this is not XML that can be read: {what}")]
    Xml {
        /// What the XML reader says.
        what: String,
        /// Where.
        place: Place,
    },
    /// An element that must be there is not.
    #[error("there is no <{element}> in <{inside}>")]
    Missing {
        /// The element.
        element: &'static str,
        /// Where it should be.
        inside: String,
        /// The place of that.
        place: Place,
    },
    /// A word or number is not one that is known here.
    #[error("{what} is \"{found}\", expected {expected}")]
    Unexpected {
        /// Which element or number.
        what: String,
        /// As written, shortened.
        found: String,
        /// What may stand here.
        expected: String,
        /// Where.
        place: Place,
    },
    /// Scattering data hold too few numbers, or too many.
    #[error("the scattering data hold {found} numbers, expected {expected}")]
    Count {
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: String,
        /// Where.
        place: Place,
    },
    /// The braces of a tensor tree do not match.
    #[error("the tensor tree has {found}, expected {expected}")]
    Tree {
        /// What stands here.
        found: String,
        /// What should.
        expected: String,
        /// Where.
        place: Place,
    },
}

impl Mistake {
    /// The bytes that it is about.
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

    /// What may help, where there is something to say.
    #[must_use]
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Mistake::NoXml { .. } | Mistake::Xml { .. } => {
                Some("a BSDF file is XML as genBSDF, WINDOW or pabopto2bsdf write it")
            }
            Mistake::Missing { element: "Visible", .. } => Some("colour is read only beside visible data"),
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
