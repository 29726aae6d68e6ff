//! Errors of building a page.

/// Why there is no page.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The picture has an unsupported number of components.
    #[error("the picture has {components} components, expected 1 or 3")]
    Components {
        /// Its components.
        components: usize,
    },
    /// The size of a map differs from the picture's.
    #[error(
        "the {map} has {columns} by {rows} pixels of {components} components, \
         expected 1 component and the picture's {expected_columns} by {expected_rows}"
    )]
    Size {
        /// The name of the map.
        map: &'static str,
        /// Its columns.
        columns: usize,
        /// Its rows.
        rows: usize,
        /// Its components.
        components: usize,
        /// The picture's columns.
        expected_columns: usize,
        /// The picture's rows.
        expected_rows: usize,
    },
    /// The pixel aspect is out of range.
    #[error("the pixel aspect (height divided by width) is {aspect}, expected 0.001 to 1000")]
    PixelAspect {
        /// The value.
        aspect: f64,
    },
    /// A run record is not valid JSON or has an unknown field.
    #[error("line {line}, column {column}: {reason}")]
    Record {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// The mistake.
        reason: String,
    },
    /// A run record of an unsupported version.
    #[error("the run record has format {format}, expected {expected}")]
    RecordFormat {
        /// The version found.
        format: u32,
        /// The supported version.
        expected: u32,
    },
}
