//! What can be wrong with a file.

use radsight_picture::PictureError;
use std::borrow::Cow;

/// Why bytes are not what they should be, or what is to be written has no place in the format.
///
/// Offsets count bytes from the first that was given.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FormatError {
    /// The information header is damaged.
    #[error(transparent)]
    Header(#[from] PictureError),
    /// The header says that this is something else.
    #[error("the format is {found}, expected {expected}")]
    Format {
        /// What the header says.
        found: String,
        /// What it must say.
        expected: &'static str,
    },
    /// The file ends too early.
    #[error("byte {offset}: the file ends, expected {expected}")]
    Truncated {
        /// The length of what there is.
        offset: usize,
        /// What must follow.
        expected: Cow<'static, str>,
    },
    /// Something else stands where a certain thing must be.
    #[error("byte {offset}: expected {expected}, found {found}")]
    Unexpected {
        /// Where.
        offset: usize,
        /// What must stand there.
        expected: Cow<'static, str>,
        /// What stands there.
        found: String,
    },
    /// A count or index is more than the format can hold.
    #[error("{what} is {found}, a file holds at most {most}")]
    TooMany {
        /// What was to be written.
        what: String,
        /// How many or which.
        found: usize,
        /// The largest possible.
        most: usize,
    },
}
