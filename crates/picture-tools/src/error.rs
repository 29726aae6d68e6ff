//! What can stop a picture program.

use radsight_diag::Diagnostic;
use radsight_picture::PictureError;

/// Why a picture program cannot do what was asked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ToolError {
    /// A picture cannot be read or written.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// No pixel has a brightness that could be averaged.
    #[error(
        "the picture is too dark or too bright for an average brightness, expected a pixel above 0 and below {hot}"
    )]
    NoAverage {
        /// The brightness above which pixels are left out.
        hot: f64,
    },
    /// Not even one row of the output can be made of what there is of the picture.
    #[error("the picture ends after {rows} of {expected} scanlines, expected enough for a row of the output")]
    EmptyFrame {
        /// Complete scanlines.
        rows: usize,
        /// What the resolution says.
        expected: usize,
    },
    /// One of several pictures cannot be read.
    #[error("{error}")]
    Input {
        /// Which one, from 0.
        index: usize,
        /// What is wrong.
        error: PictureError,
    },
    /// Pictures that should have one size have several.
    #[error("{} x {} pixels, expected {} x {} as the first picture has", found[0], found[1], expected[0], expected[1])]
    OtherSize {
        /// Pixels a scanline, and scanlines.
        found: [usize; 2],
        /// Those of the first picture.
        expected: [usize; 2],
    },
    /// A definition cannot be computed.
    #[error("{}", words(.0))]
    Definition(Vec<Diagnostic>),
}

fn words(diagnostics: &[Diagnostic]) -> String {
    diagnostics.iter().map(|found| found.message.as_str()).collect::<Vec<_>>().join("; ")
}
