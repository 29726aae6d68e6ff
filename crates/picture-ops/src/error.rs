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
    /// A picture has no light that could be shown.
    #[error("the picture is black, or brighter than {most} cd/m² everywhere")]
    NothingVisible {
        /// The largest luminance that is looked at.
        most: f64,
    },
    /// The view of a picture is too wide for what is asked of it.
    #[error("the picture's view is {degrees} degrees of the fovea wide in all, expected at most {most}")]
    TooManyGlances {
        /// Square degrees of the view.
        degrees: usize,
        /// The most that are looked at.
        most: usize,
    },
    /// The view of a picture is no view.
    #[error("the view in the picture's header: {0}")]
    View(radsight_picture::ViewError),
    /// Primaries from which no colour can be made.
    #[error("the primaries lie on a line, or white is impossible")]
    Primaries,
    /// A calibration of red, green and blue cannot take X, Y and Z.
    #[error("a calibration by macbethcal takes pictures in RGBE, not in XYZE")]
    CalibratedXyz,
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
