//! Custom cameras.

use crate::error::Error;
use glam::DVec3;
use radsight_render::Ray;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A ray of a camera.
///
/// ```
/// use glam::DVec3;
/// let ray = radsight::CameraRay { origin: DVec3::ZERO, direction: DVec3::Y, weight: 0.5 };
/// assert_eq!(ray.weight * 2.0, 1.0); // a filter that transmits half of the light
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraRay {
    /// Origin, scene units.
    pub origin: DVec3,
    /// Direction; need not be normalised.
    pub direction: DVec3,
    /// Factor of its radiance, such as cos⁴ or vignetting.
    pub weight: f64,
}

/// Generates rays for points on the film.
///
/// ```
/// use radsight::{Camera, CameraRay, Renderer, Scene};
/// # use glam::DVec3;
/// /// Looks along +y, without perspective; the film is two units wide.
/// struct Orthographic;
/// impl Camera for Orthographic {
///     fn ray(&self, [x, y]: [f64; 2], _aperture: [f64; 2]) -> Option<CameraRay> {
///         let origin = DVec3::new(2.0 * x - 1.0, 0.0, 1.0 - 2.0 * y);
///         Some(CameraRay { origin, direction: DVec3::Y, weight: 1.0 })
///     }
/// }
/// let scene = Scene::from_text("void glow white 0 0 4 1 1 1 0 white sphere ball 0 0 4 0 5 0 .5")?;
/// let image = Renderer::new(&scene)?.samples(64).render_camera(&Orthographic, 32, 32)?;
/// let share: f32 = image.pixels().iter().map(|pixel| pixel[0]).sum::<f32>() / 1024.0;
/// assert!((share - std::f32::consts::PI / 16.0).abs() < 0.002, "{share}");
/// # Ok::<(), radsight::Error>(())
/// ```
pub trait Camera: Sync {
    /// The ray through a film point, (0, 0) at the top left and (1, 1) at the bottom right, and an
    /// aperture point in the unit square; `None` where the camera sees nothing. Both are uniformly
    /// distributed. A number that is not finite, or a direction without a length, is
    /// [`Error::OwnCamera`].
    fn ray(&self, film: [f64; 2], aperture: [f64; 2]) -> Option<CameraRay>;

    /// The rays of many pairs of points, one for each. Renderers call this method; override it if a
    /// single call is expensive.
    fn rays(&self, film: &[[f64; 2]], aperture: &[[f64; 2]]) -> Vec<Option<CameraRay>> {
        film.iter().zip(aperture).map(|(film, aperture)| self.ray(*film, *aperture)).collect()
    }

    /// Checks the camera's own parameters before its first ray.
    ///
    /// # Errors
    /// Such as [`Error::Option`]; the default finds none.
    fn check(&self) -> Result<(), Error> {
        Ok(())
    }
}

/// The ray of a custom camera through a film point, or what is wrong with it.
pub(crate) fn checked(ray: CameraRay, [x, y]: [f64; 2]) -> Result<(Ray, f64), String> {
    let CameraRay { origin, direction, weight } = ray;
    match Ray::new(origin, direction) {
        Some(ray) if weight.is_finite() => Ok((ray, weight)),
        _ => Err(format!(
            "its ray for the film point ({x}, {y}) has the origin {origin}, the direction {direction} and the weight {weight}, expected finite numbers and a direction with a length, or no ray"
        )),
    }
}

/// A custom camera whose rays are checked.
pub(crate) struct CheckedCamera<'c> {
    camera: &'c dyn Camera,
    fault: CameraFault,
}

/// The first mistake of a custom camera or integrator.
#[derive(Debug, Default)]
pub(crate) struct CameraFault(Mutex<Option<Error>>);

impl CameraFault {
    pub(crate) fn set(&self, error: Error) {
        // Later mistakes mostly have the same cause.
        self.first().get_or_insert(error);
    }

    pub(crate) fn is_set(&self) -> bool {
        self.first().is_some()
    }

    /// Returns the mistake, and forgets it.
    pub(crate) fn take(&self) -> Result<(), Error> {
        self.first().take().map_or(Ok(()), Err)
    }

    fn first(&self) -> MutexGuard<'_, Option<Error>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<'c> CheckedCamera<'c> {
    pub(crate) fn new(camera: &'c dyn Camera) -> CheckedCamera<'c> {
        CheckedCamera { camera, fault: CameraFault::default() }
    }

    /// The first mistake, which ends the work.
    pub(crate) fn fault(&self) -> &CameraFault {
        &self.fault
    }

    /// The rays of many pairs of points, with their weights; none after a mistake.
    pub(crate) fn rays(&self, film: &[[f64; 2]], aperture: &[[f64; 2]]) -> Vec<Option<(Ray, f64)>> {
        let given = self.camera.rays(film, aperture);
        let checked = if given.len() == film.len() {
            given.into_iter().zip(film).map(|(ray, point)| ray.map(|ray| checked(ray, *point)).transpose()).collect()
        } else {
            Err(format!("it returned {} rays for {} film points", given.len(), film.len()))
        };
        checked.unwrap_or_else(|mistake| {
            self.fault.set(Error::OwnCamera(mistake));
            vec![None; film.len()]
        })
    }
}
