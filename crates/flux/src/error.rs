//! What can be wrong with senders and receivers.

/// Why a matrix cannot be asked for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FluxError {
    /// A word after `#@rfluxmtx` is none.
    #[error("\"{word}\" is no parameter, expected h=, u= or o=")]
    Parameter {
        /// The word.
        word: String,
    },
    /// What stands after `h=` is none.
    #[error("\"{word}\" is no basis, expected u, kf, kh, kq, r and a number, sc and a number, or cie")]
    Basis {
        /// The word.
        word: String,
    },
    /// What stands after `u=` is none.
    #[error("\"{word}\" is no direction, expected X, Y or Z with a sign, or three numbers with commas")]
    Direction {
        /// The word.
        word: String,
    },
    /// Nothing stands after `o=`, or a quotation mark is not closed.
    #[error("\"o=\" names no file")]
    Output,
    /// Nothing says which basis surfaces have.
    #[error("surfaces of \"{modifier}\" have no basis, expected a comment \"#@rfluxmtx h=\" before them")]
    NoBasis {
        /// The modifier.
        modifier: String,
    },
    /// The surfaces face all ways.
    #[error("surfaces of \"{modifier}\" have no normal in the mean")]
    NoNormal {
        /// The modifier.
        modifier: String,
    },
    /// The up direction is that of the normal.
    #[error("the up direction is the normal of the surfaces of \"{modifier}\"")]
    Up {
        /// The modifier.
        modifier: String,
    },
    /// A surface's numbers are not those of its type.
    #[error("surface \"{surface}\" {what}")]
    Surface {
        /// Its name.
        surface: String,
        /// What is wrong.
        what: &'static str,
    },
    /// A distant source sends no rays.
    #[error("source \"{surface}\" cannot send rays, expected polygons and rings")]
    SendingSource {
        /// Its name.
        surface: String,
    },
    /// A distant source is not a hemisphere.
    #[error("source \"{surface}\" is not 180 degrees wide, which only h=u allows")]
    SmallSource {
        /// Its name.
        surface: String,
    },
    /// No rays can be sent by this basis.
    #[error("basis \"cie\" is for receivers only")]
    SendingCie,
    /// No surface faces a direction of the basis.
    #[error("no surface of \"{modifier}\" faces one of the directions of its basis")]
    Behind {
        /// The modifier.
        modifier: String,
    },
    /// There is none.
    #[error("no surface is named, expected a polygon, ring or source")]
    Nothing,
}
