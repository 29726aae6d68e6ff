//! Radiance's views.

use crate::Error;
use crate::camera::{Camera, CameraRay};
use crate::option_check::check_aperture;
use radsight_film::ViewCamera;
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
pub struct View {
    pub(crate) view: radsight_picture::View,
    /// Diameter of the aperture, scene units.
    pub(crate) aperture: f64,
}

impl View {
    /// Parses a view from options such as `-vp 0 0 1.7 -vd 0 1 0 -vh 60`.
    ///
    /// ```
    /// assert!(radsight::View::from_args("-vta -vp 0 0 2 -vd 0 0 -1 -vu 0 1 0 -vh 180 -vv 180").is_ok());
    /// ```
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
    /// ```
    /// let view = radsight::View::from_file(b"rvu -vtv -vp 1 2 3 -vd 0 1 0 -vh 40 -vv 40\n")?;
    /// assert!(view.to_args().contains("-vp 1 2 3"));
    /// # Ok::<(), radsight::Error>(())
    /// ```
    ///
    /// # Errors
    /// When there is no view, or an invalid one.
    pub fn from_file(bytes: &[u8]) -> Result<View, Error> {
        let mut options = ViewOptions::default();
        options.apply_file(bytes).map_err(|error| Error::View(error.to_string()))?;
        View::new(options)
    }

    fn new(options: ViewOptions) -> Result<View, Error> {
        radsight_picture::View::new(options)
            .map(|view| View { view, aperture: 0.0 })
            .map_err(|error| Error::View(error.to_string()))
    }

    /// The same view through a thin lens: the diameter of its aperture in scene units (`-pd`), 0 or
    /// more. The length of the view direction is the distance of the plane of focus.
    ///
    /// ```
    /// use radsight::{Renderer, Scene, View};
    /// let scene = Scene::from_text("void glow lamp 0 0 4 1 1 1 0  lamp sphere far 0 0 4 0 50 0 .5")?;
    /// // In focus at 5, the sphere at 50 is blurred over a disk.
    /// let view = View::from_args("-vp 0 0 0 -vd 0 5 0 -vh 6 -vv 6")?;
    /// let mut renderer = Renderer::new(&scene)?.samples(64);
    /// let lit = |view: &View, renderer: &mut Renderer| -> Result<usize, radsight::Error> {
    ///     Ok(renderer.render(view, 32, 32)?.pixels().iter().filter(|pixel| pixel[0] > 0.0).count())
    /// };
    /// assert!(lit(&view.thin_lens(0.2), &mut renderer)? > 2 * lit(&view, &mut renderer)?);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn thin_lens(mut self, aperture: f64) -> View {
        self.aperture = aperture;
        self
    }

    /// The options of the view.
    ///
    /// ```
    /// assert!(radsight::example::view().to_args().contains("-vh 40"));
    /// ```
    #[must_use]
    pub fn to_args(&self) -> String {
        self.view.options().to_full_string()
    }
}

impl FromStr for View {
    type Err = Error;

    fn from_str(arguments: &str) -> Result<View, Error> {
        View::from_args(arguments)
    }
}

/// A view as a camera, for [`Capture::with_camera`](crate::Capture::with_camera) and custom
/// integrators. All rays have the weight 1; the aft clipping plane is ignored.
impl Camera for View {
    fn ray(&self, [x, y]: [f64; 2], aperture: [f64; 2]) -> Option<CameraRay> {
        let mut camera = ViewCamera::new(self.view, 1, 1);
        camera.aperture = self.aperture;
        let ray = camera.ray_through([x, 1.0 - y], aperture)?;
        Some(CameraRay { origin: ray.origin, direction: ray.direction, weight: 1.0 })
    }

    fn check(&self) -> Result<(), Error> {
        check_aperture(self.aperture)
    }
}
