//! Errors about senders and receivers.

use radsight_triangulation::OutlineError;

/// Why a flux matrix cannot be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FluxError {
    /// A word after `#@rfluxmtx` is not a parameter.
    #[error("\"{word}\" is not a parameter, expected h=, u= or o=")]
    Parameter {
        /// The word.
        word: String,
    },
    /// The value of `h=` is not a basis.
    #[error("\"{word}\" is not a basis, expected u, kf, kh, kq, r and a number, sc and a number, or cie")]
    Basis {
        /// The word.
        word: String,
    },
    /// The value of `u=` is not a direction.
    #[error("\"{word}\" is not a direction, expected X, Y or Z with a sign, or three numbers with commas")]
    Direction {
        /// The word.
        word: String,
    },
    /// The value of `o=` is missing, or a quotation mark is not closed.
    #[error("\"o=\" names no file")]
    Output,
    /// The basis of the surfaces is not given.
    #[error("surfaces of \"{modifier}\" have no basis, expected a comment \"#@rfluxmtx h=\" before them")]
    NoBasis {
        /// The modifier.
        modifier: String,
    },
    /// The surfaces' normals cancel.
    #[error("surfaces of \"{modifier}\" have normals that cancel, expected surfaces that face one way")]
    NoNormal {
        /// The modifier.
        modifier: String,
    },
    /// The up direction is parallel to the normal.
    #[error("the up direction is parallel to the normal of the surfaces of \"{modifier}\"")]
    Up {
        /// The modifier.
        modifier: String,
    },
    /// A surface's numbers do not fit its type.
    #[error("surface \"{surface}\" {what}")]
    Surface {
        /// Name of the surface.
        surface: String,
        /// What is wrong.
        what: &'static str,
    },
    /// A surface has no area.
    #[error("surface \"{surface}\" has no area")]
    NoArea {
        /// Name of the surface.
        surface: String,
    },
    /// A polygon cannot be triangulated.
    #[error("surface \"{surface}\" {outline}")]
    Outline {
        /// Name of the surface.
        surface: String,
        /// What is wrong with it.
        outline: OutlineError,
    },
    /// A distant source cannot send rays.
    #[error("source \"{surface}\" cannot send rays, expected polygons and rings")]
    SendingSource {
        /// Name of the source.
        surface: String,
    },
    /// A distant source is not a hemisphere.
    #[error("source \"{surface}\" is not 180 degrees wide, which only h=u allows")]
    SmallSource {
        /// Name of the source.
        surface: String,
    },
    /// The basis is for receivers only.
    #[error("basis \"cie\" is for receivers only")]
    SendingCie,
    /// No surface faces a direction of the basis.
    #[error("no surface of \"{modifier}\" faces one of the directions of its basis")]
    Behind {
        /// The modifier.
        modifier: String,
    },
    /// There is no surface.
    #[error("no surface is given, expected a polygon, ring or source")]
    Nothing,
}
