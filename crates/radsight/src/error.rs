//! Errors as data.

use radsight_diag::{Diagnostic, SourceMap};
use std::fmt;

/// Diagnostics of a text, with the sources needed to print them.
///
/// ```
/// use radsight::{Error, Scene};
/// let Err(Error::Scene(report)) = Scene::from_text("void plastic grey 0 0 5 .5 .5") else { panic!("no error") };
/// let (name, line, column) = report.position(&report.diagnostics[0]).unwrap();
/// println!("{name}:{line}:{column}: {}", report.diagnostics[0].message);
/// assert_eq!(line, 1);
/// ```
#[derive(Clone)]
pub struct Report {
    /// The diagnostics in text order. Spans refer to the sources.
    pub diagnostics: Vec<Diagnostic>,
    pub(crate) sources: SourceMap,
}

impl Report {
    pub(crate) fn new(diagnostics: Vec<Diagnostic>, sources: SourceMap) -> Box<Report> {
        Box::new(Report { diagnostics, sources })
    }

    /// File name, line and column (from 1) of a diagnostic; `None` if it has no span.
    ///
    /// ```
    /// use radsight::{Error, Scene};
    /// let Err(Error::Scene(report)) = Scene::from_text("void plastic\n") else { panic!("it is incomplete") };
    /// assert!(report.position(&report.diagnostics[0]).is_some());
    /// ```
    #[must_use]
    pub fn position(&self, diagnostic: &Diagnostic) -> Option<(&str, u32, u32)> {
        let span = diagnostic.span?;
        let at = self.sources.position(span);
        Some((self.sources.name(span.source), at.line, at.column))
    }
}

/// Prints all diagnostics, each with its line, a caret and hints.
impl fmt::Display for Report {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.diagnostics.iter().try_for_each(|diagnostic| formatter.write_str(&diagnostic.render(&self.sources)))
    }
}

/// Prints the same as `Display`, since `main` shows this form.
impl fmt::Debug for Report {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, formatter)
    }
}

/// Why an operation failed.
///
/// ```
/// use radsight::{Error, View};
/// let message = match View::from_args("-vp 0 0") {
///     Err(Error::View(message)) => message,
///     _ => panic!("-vp takes three numbers"),
/// };
/// assert!(message.contains("-vp"));
/// ```
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A scene is wrong.
    #[error("the scene is wrong:\n{0}")]
    Scene(Box<Report>),
    /// A camera file is wrong.
    #[error("the camera file is wrong:\n{0}")]
    Camera(Box<Report>),
    /// A series file is wrong.
    #[error("the series is wrong:\n{0}")]
    Series(Box<Report>),
    /// A word is not a replaceable key of a camera file.
    #[error("key \"{key}\": {expected}")]
    Key {
        /// The key.
        key: String,
        /// What was expected.
        expected: String,
    },
    /// A capture cannot be differentiated by a parameter.
    #[error("parameter \"{parameter}\": {reason}")]
    Parameter {
        /// Its name.
        parameter: String,
        /// The reason.
        reason: String,
    },
    /// A render job is wrong.
    #[error("the job is wrong:\n{0}")]
    Job(Box<Report>),
    /// A part of a picture cannot be merged.
    #[error("\"{name}\" is not part of this picture: {reason}")]
    Part {
        /// Its name.
        name: String,
        /// The reason.
        reason: String,
    },
    /// A ray met an unusable material.
    #[error("a material is unusable:\n{0}")]
    Material(Box<Report>),
    /// A file could not be read.
    #[error(transparent)]
    Load(#[from] radsight_loader::LoadError),
    /// A view is invalid.
    #[error("bad view: {0}")]
    View(String),
    /// An option is out of range.
    #[error("{option} is {value}, expected {expected}")]
    Option {
        /// Its name.
        option: &'static str,
        /// Its value.
        value: String,
        /// The valid range.
        expected: &'static str,
    },
    /// A picture exceeds the largest supported size.
    #[error("the picture has {columns} by {rows} pixels, expected 1 to {most} pixels")]
    Size {
        /// Number of columns.
        columns: usize,
        /// Number of rows.
        rows: usize,
        /// Largest number of pixels.
        most: usize,
    },
    /// A custom camera gave rays that cannot be traced.
    #[error("the custom camera is wrong: {0}")]
    OwnCamera(String),
    /// A custom integrator gave a value that is not finite.
    #[error("the integrator is wrong: {0}")]
    OwnIntegrator(String),
    /// The camera has no sensor.
    #[error("the camera file has no [sensor], which is needed for grey values")]
    NoSensor,
    /// A saved irradiance cache cannot be used.
    #[error("the irradiance cache: {0}")]
    Cache(#[from] radsight_render::CacheError),
    /// Band weights do not fit the scene.
    #[error("{0}")]
    Bands(String),
    /// A picture cannot be saved.
    #[error("cannot save \"{path}\": {reason}")]
    Save {
        /// The file.
        path: String,
        /// The reason.
        reason: String,
    },
}
