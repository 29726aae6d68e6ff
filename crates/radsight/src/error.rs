//! What can go wrong, as data.

use radsight_diag::{Diagnostic, SourceMap};
use std::fmt;

/// Messages about a text, with what is needed to show where they point.
#[derive(Clone)]
pub struct Report {
    /// The messages, in the order of the text. Spans point into the sources.
    pub diagnostics: Vec<Diagnostic>,
    pub(crate) sources: SourceMap,
}

impl Report {
    pub(crate) fn new(diagnostics: Vec<Diagnostic>, sources: SourceMap) -> Box<Report> {
        Box::new(Report { diagnostics, sources })
    }

    /// File name, line and column (from 1) of a message; `None` for one about no place.
    #[must_use]
    pub fn position(&self, diagnostic: &Diagnostic) -> Option<(&str, u32, u32)> {
        let span = diagnostic.span?;
        let at = self.sources.position(span);
        Some((self.sources.name(span.source), at.line, at.column))
    }
}

/// All messages, each with its line, a caret and hints.
impl fmt::Display for Report {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.diagnostics.iter().try_for_each(|diagnostic| formatter.write_str(&diagnostic.render(&self.sources)))
    }
}

/// The same as for people, since that is what `main` shows.
impl fmt::Debug for Report {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, formatter)
    }
}

/// Why something could not be done.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A scene is wrong.
    #[error("the scene is wrong:\n{0}")]
    Scene(Box<Report>),
    /// A camera file is wrong.
    #[error("the camera file is wrong:\n{0}")]
    Camera(Box<Report>),
    /// The file of a series of captures is wrong.
    #[error("the series is wrong:\n{0}")]
    Series(Box<Report>),
    /// Something is no key of a camera file that could be replaced.
    #[error("key \"{key}\": {expected}")]
    Key {
        /// The key.
        key: String,
        /// What was expected.
        expected: String,
    },
    /// A render job is wrong.
    #[error("the job is wrong:\n{0}")]
    Job(Box<Report>),
    /// A part of a picture cannot be merged.
    #[error("\"{name}\" is no part of this picture: {reason}")]
    Part {
        /// Its name.
        name: String,
        /// Why.
        reason: String,
    },
    /// A ray met a material that cannot be used.
    #[error("a material cannot be used:\n{0}")]
    Material(Box<Report>),
    /// A file could not be read.
    #[error(transparent)]
    Load(#[from] radsight_loader::LoadError),
    /// A view is wrong.
    #[error("bad view: {0}")]
    View(String),
    /// An option is out of its range.
    #[error("{option} is {value}, expected {expected}")]
    Option {
        /// Its name.
        option: &'static str,
        /// What it was.
        value: String,
        /// What it may be.
        expected: &'static str,
    },
    /// A picture has more pixels than can be held.
    #[error("a picture of {columns} by {rows} pixels, expected 1 to {most} pixels")]
    Size {
        /// Pixels in a row.
        columns: usize,
        /// Rows.
        rows: usize,
        /// Most pixels.
        most: usize,
    },
    /// The camera has no sensor.
    #[error("the camera file has no [sensor], expected one for grey values")]
    NoSensor,
    /// An irradiance cache that was saved cannot be used.
    #[error("the irradiance cache: {0}")]
    Cache(#[from] radsight_render::CacheError),
    /// Band weights do not fit the scene.
    #[error("{0}")]
    Bands(String),
    /// A picture cannot be written in this format.
    #[error("cannot save \"{path}\": {reason}")]
    Save {
        /// The file.
        path: String,
        /// Why.
        reason: String,
    },
}
