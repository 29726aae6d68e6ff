//! Errors of the picture programs.

use radsight_diag::Diagnostic;
use radsight_picture::{Encoding, PictureError};

/// Why a picture program failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ToolError {
    /// A picture cannot be read or written.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// No pixel has a brightness in the averaged range.
    #[error(
        "the picture is too dark or too bright for an average brightness, expected a pixel above 0 and below {hot}"
    )]
    NoAverage {
        /// The brightness above which pixels are excluded.
        hot: f64,
    },
    /// A picture has no visible luminance.
    #[error("the picture is black, or brighter than {most} cd/m² everywhere")]
    NothingVisible {
        /// The largest luminance considered, cd/m².
        most: f64,
    },
    /// The view of a picture covers too large a solid angle.
    #[error("the picture's view covers {degrees} square degrees, expected at most {most}")]
    ViewTooWide {
        /// Square degrees of the view.
        degrees: usize,
        /// The largest supported number.
        most: usize,
    },
    /// The view in a picture's header is invalid.
    #[error("the view in the picture's header: {0}")]
    View(radsight_picture::ViewError),
    /// The primaries do not form a colour space.
    #[error("the primaries are collinear or the white is impossible")]
    Primaries,
    /// A calibration of RGB cannot be applied to XYZ.
    #[error("a calibration by macbethcal takes pictures in RGBE, not in XYZE")]
    CalibratedXyz,
    /// The available scanlines do not suffice for one row of the output.
    #[error("the picture ends after {rows} of {expected} scanlines, expected enough for a row of the output")]
    TooFewScanlines {
        /// Complete scanlines.
        rows: usize,
        /// The number in the resolution.
        expected: usize,
    },
    /// One of several pictures cannot be read.
    #[error("{error}")]
    Input {
        /// Its index, from 0.
        index: usize,
        /// The cause.
        error: PictureError,
    },
    /// Pictures that must have the same size differ.
    #[error("{} x {} pixels, expected {} x {} as in the first picture", found[0], found[1], expected[0], expected[1])]
    OtherSize {
        /// Index of the picture that differs, from 0.
        index: usize,
        /// Pixels per scanline, and scanlines.
        found: [usize; 2],
        /// Columns and rows of the first picture.
        expected: [usize; 2],
    },
    /// The pixels of a picture are not red, green and blue.
    #[error("the pixels are {}, expected red, green and blue ({})", found.name(), Encoding::Rgbe.name())]
    NotRgbe {
        /// Its encoding.
        found: Encoding,
    },
    /// A definition cannot be evaluated.
    #[error("{}", words(.0))]
    Definition(Vec<Diagnostic>),
}

fn words(diagnostics: &[Diagnostic]) -> String {
    diagnostics.iter().map(|found| found.message.as_str()).collect::<Vec<_>>().join("; ")
}
