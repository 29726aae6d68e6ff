//! What can be wrong with a picture, a matrix, a header or a view.

use std::borrow::Cow;
use std::io;

/// Why bytes are not a picture, or an image cannot be written in a format.
///
/// Byte offsets count from the first byte that was given, header lines from 1.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
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
    /// The bytes end too early.
    #[error("byte {offset}: the file ends, expected {expected}")]
    Truncated {
        /// The length of what there is.
        offset: usize,
        /// What must follow.
        expected: Cow<'static, str>,
    },
    /// A header line has a value that cannot be.
    #[error("header line {line}: {name} is \"{value}\", expected {expected}")]
    HeaderValue {
        /// The line, from 1.
        line: usize,
        /// The variable, without its `=`.
        name: &'static str,
        /// As it stands.
        value: String,
        /// What would do.
        expected: &'static str,
    },
    /// The header claims more pixels than the bytes after it can hold.
    #[error(
        "byte {offset}: {width} x {height} pixels of {components} components are claimed, \
         which {available} bytes cannot hold"
    )]
    TooLarge {
        /// Where the pixels begin.
        offset: usize,
        /// Claimed pixels a row.
        width: u64,
        /// Claimed rows.
        height: u64,
        /// Claimed values a pixel.
        components: u64,
        /// What follows `offset`.
        available: usize,
    },
    /// The file is of a kind that is not read.
    #[error("{format} with {what} is not read, expected {expected}")]
    Unsupported {
        /// The file format.
        format: &'static str,
        /// What stands in the way.
        what: String,
        /// What would do.
        expected: &'static str,
    },
    /// An image of this shape has no place in the format, or the shape disagrees with the number of values.
    #[error("{width} x {height} pixels of {components} components with {values} values, expected {expected}")]
    Shape {
        /// Pixels a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Values a pixel.
        components: usize,
        /// Values there are.
        values: usize,
        /// What would do.
        expected: &'static str,
    },
    /// The package that reads or writes the format refused.
    #[error("{format}: {reason}")]
    Codec {
        /// The file format.
        format: &'static str,
        /// Its own words.
        reason: String,
    },
    /// Reading or writing failed, whatever the format.
    #[error("{reason}")]
    Stream {
        /// What kind of failure.
        kind: io::ErrorKind,
        /// The system's own words.
        reason: String,
    },
    /// The view cannot be.
    #[error("view: {0}")]
    View(#[from] crate::ViewError),
}

impl PictureError {
    /// Whether more bytes could help.
    pub(crate) fn is_truncation(&self) -> bool {
        matches!(self, PictureError::Truncated { .. })
    }

    /// The same, found in bytes that begin at this offset.
    pub(crate) fn at(mut self, start: usize) -> PictureError {
        if let PictureError::Unexpected { offset, .. }
        | PictureError::Truncated { offset, .. }
        | PictureError::TooLarge { offset, .. } = &mut self
        {
            *offset += start;
        }
        self
    }
}

impl From<io::Error> for PictureError {
    fn from(error: io::Error) -> PictureError {
        PictureError::Stream { kind: error.kind(), reason: error.to_string() }
    }
}

/// Shows up to 24 bytes for a message, with everything unprintable escaped.
pub(crate) fn shown(bytes: &[u8]) -> String {
    const LONGEST: usize = 24;
    if bytes.is_empty() {
        return "the end".to_owned();
    }
    let more = if bytes.len() > LONGEST { "…" } else { "" };
    let text = bytes[..bytes.len().min(LONGEST)].escape_ascii().to_string().replace("\\'", "'");
    format!("\"{text}{more}\"")
}
