//! Rays of cameras that have neither a pinhole nor a thin lens.

use crate::camera_ray::CameraRay;
use glam::DVec3;
use std::fmt::Debug;

/// A ray of such a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmRay {
    /// Origin, scene frame, scene units.
    pub origin: DVec3,
    /// Into the scene; any length above 0.
    pub direction: DVec3,
    /// Factor of its radiance, in place of cos⁴θ. A mean of weight times radiance of 1 W/(sr·m²) is
    /// the exposure [`crate::PinholeCamera::exposure_per_radiance`].
    pub weight: f64,
}

/// The rays of a camera as a function of points of the film and of the aperture.
pub trait FilmRays: Debug + Send + Sync {
    /// The ray through a film point, (0, 0) at the top left of the picture and (1, 1) at the bottom
    /// right, and an aperture point in the unit square, both uniform; `None` where the camera sees
    /// nothing.
    fn ray(&self, film: [f64; 2], aperture: [f64; 2]) -> Option<FilmRay>;
}

impl CameraRay {
    /// `None` and a ray without a direction see nothing.
    pub(crate) fn from_film(ray: Option<FilmRay>) -> CameraRay {
        let known = ray.and_then(|ray| Some((ray, ray.direction.try_normalize()?)));
        match known {
            Some((FilmRay { origin, weight, .. }, direction)) => {
                CameraRay { origin, direction, cos4: weight, pattern_cell: 0 }
            }
            None => CameraRay { origin: DVec3::ZERO, direction: DVec3::Z, cos4: 0.0, pattern_cell: 0 },
        }
    }
}
