//! Views of Radiance's.

use crate::Error;
use radsight_picture::ViewOptions;
use std::str::FromStr;

/// A view: type, viewpoint, direction, up vector, angles, shift, lift and clipping planes, as Radiance has them.
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
    /// The view that options of Radiance's describe, such as `-vp 0 0 1.7 -vd 0 1 0 -vh 60`.
    ///
    /// # Errors
    /// [`Error::View`] for an unknown or incomplete option, and for a view that does not exist.
    pub fn from_args(arguments: &str) -> Result<View, Error> {
        let words: Vec<String> = arguments.split_whitespace().map(str::to_owned).collect();
        let mut options = ViewOptions::default();
        let mut rest = &words[..];
        while let Some(word) = rest.first() {
            match options.apply_option(rest) {
                Ok(0) => return Err(Error::View(format!("\"{word}\" is no view option with all its numbers"))),
                Ok(used) => rest = &rest[used..],
                Err(error) => return Err(Error::View(error.to_string())),
            }
        }
        View::new(options)
    }

    /// The view of a view file (`.vf`), or that of a picture's header.
    ///
    /// # Errors
    /// When there is no view in it, or one that does not exist.
    pub fn from_file(bytes: &[u8]) -> Result<View, Error> {
        let mut options = ViewOptions::default();
        options.apply_file(bytes).map_err(|error| Error::View(error.to_string()))?;
        View::new(options)
    }

    fn new(options: ViewOptions) -> Result<View, Error> {
        radsight_picture::View::new(options).map(View).map_err(|error| Error::View(error.to_string()))
    }

    /// The options that describe it.
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
