//! Custom cameras.

use glam::DVec3;
use radsight_render::Ray;

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
    /// distributed.
    fn ray(&self, film: [f64; 2], aperture: [f64; 2]) -> Option<CameraRay>;

    /// The rays of many pairs of points. Renderers call this method; override it if a single call
    /// is expensive.
    fn rays(&self, film: &[[f64; 2]], aperture: &[[f64; 2]]) -> Vec<Option<CameraRay>> {
        film.iter().zip(aperture).map(|(film, aperture)| self.ray(*film, *aperture)).collect()
    }
}

pub(crate) fn checked(ray: CameraRay) -> Option<(Ray, f64)> {
    Ray::new(ray.origin, ray.direction).map(|traced| (traced, ray.weight))
}
