//! Errors of reading and writing pictures, matrices, headers and views.

use std::borrow::Cow;
use std::io;

/// Why bytes cannot be read as a picture, or an image cannot be written in a format.
///
/// Byte offsets count from the start of the input, header lines from 1.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
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
    /// The data end too early.
    #[error("byte {offset}: the file ends, expected {expected}")]
    Truncated {
        /// Length of the data.
        offset: usize,
        /// What was expected next.
        expected: Cow<'static, str>,
    },
    /// The file has another format.
    #[error("the file is {found}, expected a Radiance picture")]
    OtherFormat {
        /// Its format.
        found: crate::ForeignFormat,
    },
    /// A header line has an invalid value.
    #[error("header line {line}: {name} is \"{value}\", expected {expected}")]
    HeaderValue {
        /// The line, from 1.
        line: usize,
        /// The variable, without its `=`.
        name: &'static str,
        /// The value as written.
        value: String,
        /// The expected value.
        expected: &'static str,
    },
    /// The header declares more pixels than the bytes after it can hold.
    #[error(
        "byte {offset}: {width} x {height} pixels of {components} components are declared, \
         which {available} bytes cannot hold"
    )]
    TooLarge {
        /// Offset of the pixels.
        offset: usize,
        /// Declared width.
        width: u64,
        /// Declared height.
        height: u64,
        /// Declared number of components.
        components: u64,
        /// Number of bytes from `offset` on.
        available: usize,
    },
    /// The file uses an unsupported variant of its format.
    #[error("{format} with {what} is not supported, expected {expected}")]
    Unsupported {
        /// The file format.
        format: &'static str,
        /// The unsupported property.
        what: String,
        /// The supported values.
        expected: &'static str,
    },
    /// The format cannot hold an image of this shape, or the shape disagrees with the number of
    /// values.
    #[error("{width} x {height} pixels of {components} components with {values} values, expected {expected}")]
    Shape {
        /// Pixels a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Values per pixel.
        components: usize,
        /// Number of values.
        values: usize,
        /// The supported shape.
        expected: &'static str,
    },
    /// The library that reads or writes the format failed.
    #[error("{format}: {reason}")]
    Codec {
        /// The file format.
        format: &'static str,
        /// Its error message.
        reason: String,
    },
    /// Reading or writing the stream failed.
    #[error("{reason}")]
    Stream {
        /// The kind of failure.
        kind: io::ErrorKind,
        /// The error message of the operating system.
        reason: String,
    },
    /// The view is invalid.
    #[error("view: {0}")]
    View(#[from] crate::ViewError),
}

impl PictureError {
    /// Whether more bytes could resolve the error.
    pub(crate) fn is_truncation(&self) -> bool {
        matches!(self, PictureError::Truncated { .. })
    }

    /// The same error, with offsets increased by `start`.
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

/// Up to 24 bytes for a message, with unprintable ones escaped.
pub(crate) fn shown(bytes: &[u8]) -> String {
    const LONGEST: usize = 24;
    if bytes.is_empty() {
        return "the end".to_owned();
    }
    let more = if bytes.len() > LONGEST { "…" } else { "" };
    let text = bytes[..bytes.len().min(LONGEST)].escape_ascii().to_string().replace("\\'", "'");
    format!("\"{text}{more}\"")
}
