//! What can be wrong with what a page is made from.

/// Why there is no page.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The picture has a number of components that a page cannot show.
    #[error("the picture has {components} components, expected 1 or 3")]
    Components {
        /// Its components.
        components: usize,
    },
    /// A map has another size than the picture.
    #[error(
        "the {map} has {columns} by {rows} pixels of {components} components, \
         expected 1 component and the picture's {expected_columns} by {expected_rows}"
    )]
    Size {
        /// What it shows.
        map: &'static str,
        /// Its pixels in a row.
        columns: usize,
        /// Its rows.
        rows: usize,
        /// Its components.
        components: usize,
        /// The picture's pixels in a row.
        expected_columns: usize,
        /// The picture's rows.
        expected_rows: usize,
    },
    /// The pixels' proportions are impossible.
    #[error("the height over the width of a pixel is {aspect}, expected 0.001 to 1000")]
    PixelAspect {
        /// As given.
        aspect: f64,
    },
    /// A run record is no JSON, or says what a record does not say.
    #[error("line {line}, column {column}: {reason}")]
    Record {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What is wrong there.
        reason: String,
    },
    /// A run record of another program's version.
    #[error("the run record has format {format}, expected {expected}")]
    RecordFormat {
        /// As it stands.
        format: u32,
        /// What is read.
        expected: u32,
    },
}
