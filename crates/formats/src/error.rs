//! Errors of reading and writing compiled files.

use radsight_picture::PictureError;
use std::borrow::Cow;

/// Why a file cannot be read, or data cannot be written in the format.
///
/// Offsets count bytes from the start of the input.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FormatError {
    /// The information header is damaged.
    #[error(transparent)]
    Header(#[from] PictureError),
    /// The header names another format.
    #[error("the format is {found}, expected {expected}")]
    Format {
        /// The format in the header.
        found: String,
        /// The expected format.
        expected: &'static str,
    },
    /// The file ends too early.
    #[error("byte {offset}: the file ends, expected {expected}")]
    Truncated {
        /// The length of the file.
        offset: usize,
        /// What was expected next.
        expected: Cow<'static, str>,
    },
    /// A value differs from what the format requires.
    #[error("byte {offset}: expected {expected}, found {found}")]
    Unexpected {
        /// Offset of the value.
        offset: usize,
        /// The required value.
        expected: Cow<'static, str>,
        /// The value found.
        found: String,
    },
    /// A count or index is more than the format can hold.
    #[error("{what} is {found}, expected at most {most}")]
    TooMany {
        /// The count or index to be written.
        what: String,
        /// Its value.
        found: usize,
        /// The largest value that the format can hold.
        most: usize,
    },
}
