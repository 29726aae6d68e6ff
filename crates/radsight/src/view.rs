//! Radiance's views.

use crate::Error;
use radsight_picture::ViewOptions;
use std::str::FromStr;

/// A view as in Radiance: type, viewpoint, direction, up vector, angles, shift, lift and clipping
/// planes.
///
/// ```
/// use radsight::View;
/// let view = View::from_args("-vtv -vp 2 -3 1.7 -vd 0 1 0 -vh 60 -vv 40")?;
/// assert!(view.to_args().contains("-vh 60"));
/// assert!(View::from_args("-vp 1 2").is_err());
/// # Ok::<(), radsight::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct View(pub(crate) radsight_picture::View);

impl View {
    /// Parses a view from options such as `-vp 0 0 1.7 -vd 0 1 0 -vh 60`.
    ///
    /// # Errors
    /// [`Error::View`] for an unknown or incomplete option, and for an invalid view.
    pub fn from_args(arguments: &str) -> Result<View, Error> {
        let words: Vec<String> = arguments.split_whitespace().map(str::to_owned).collect();
        let mut options = ViewOptions::default();
        let mut rest = &words[..];
        while let Some(word) = rest.first() {
            match options.apply_option(rest) {
                Ok(0) => return Err(Error::View(format!("\"{word}\" is not a complete view option"))),
                Ok(used) => rest = &rest[used..],
                Err(error) => return Err(Error::View(error.to_string())),
            }
        }
        View::new(options)
    }

    /// Reads the view of a view file (`.vf`) or of a picture's header.
    ///
    /// # Errors
    /// When there is no view, or an invalid one.
    pub fn from_file(bytes: &[u8]) -> Result<View, Error> {
        let mut options = ViewOptions::default();
        options.apply_file(bytes).map_err(|error| Error::View(error.to_string()))?;
        View::new(options)
    }

    fn new(options: ViewOptions) -> Result<View, Error> {
        radsight_picture::View::new(options).map(View).map_err(|error| Error::View(error.to_string()))
    }

    /// The options of the view.
    #[must_use]
    pub fn to_args(&self) -> String {
        self.0.options().to_full_string()
    }
}

impl FromStr for View {
    type Err = Error;

    fn from_str(arguments: &str) -> Result<View, Error> {
        View::from_args(arguments)
    }
}
