//! A telecentric lens: the parallel view of machine vision.

use crate::own_rays::{FilmRay, FilmRays};
use crate::{CameraError, PinholeCamera};
use glam::DVec3;
use radsight_sampling::unit_disk;

/// A lens that is telecentric on both sides and free of aberrations.
///
/// All chief rays are parallel to the axis, so that an object has the same size on the sensor at
/// every distance. Every sensor point receives a cone of the same aperture (Abbe's sine condition:
/// `NA_object = m·NA_image`), so a uniform scene exposes all pixels alike, by `τ π L NA_image²`
/// with `NA_image = 1/(2 N)` for the working f-number N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TelecentricLens {
    /// Size on the sensor over size of the object.
    pub magnification: f64,
    /// Working f-number N, on the side of the sensor.
    pub f_number: f64,
    /// From the camera's position to the plane of focus along the axis, metres.
    pub focus_distance_m: f64,
}

impl TelecentricLens {
    /// Checks the quantities.
    ///
    /// # Errors
    /// If a quantity is not positive and finite, or a numerical aperture is 1 or more.
    pub fn checked(self) -> Result<Self, CameraError> {
        let all = [
            ("magnification", self.magnification),
            ("f-number", self.f_number),
            ("focus distance", self.focus_distance_m),
        ];
        if let Some((quantity, value)) = all.into_iter().find(|(_, value)| !(value.is_finite() && *value > 0.0)) {
            return Err(CameraError::NotPositive { quantity, value });
        }
        let aperture = self.image_aperture().max(self.object_aperture());
        if aperture < 1.0 { Ok(self) } else { Err(CameraError::TooWide { aperture }) }
    }

    /// Numerical aperture on the side of the sensor: the sine of the half angle of its cones.
    #[must_use]
    pub fn image_aperture(&self) -> f64 {
        0.5 / self.f_number
    }

    /// Numerical aperture on the side of the scene.
    #[must_use]
    pub fn object_aperture(&self) -> f64 {
        self.magnification * self.image_aperture()
    }
}

/// The rays of a camera with a telecentric lens.
#[derive(Clone, Debug)]
pub(crate) struct TelecentricRays {
    lens: TelecentricLens,
    camera: PinholeCamera,
}

impl TelecentricRays {
    pub(crate) fn new(lens: TelecentricLens, camera: &PinholeCamera) -> TelecentricRays {
        TelecentricRays { lens, camera: camera.clone() }
    }
}

impl FilmRays for TelecentricRays {
    fn ray(&self, [x, y]: [f64; 2], [u, v]: [f64; 2]) -> Option<FilmRay> {
        let TelecentricRays { lens, camera } = self;
        let place = camera.on_plane(x * f64::from(camera.columns()), y * f64::from(camera.rows()));
        let film = camera.optics().film.unwrap_or_default();
        let [across, along] = [0, 1].map(|axis| (place[axis] + film.shift_m[axis]) / lens.magnification);
        // Uniform in sines: equal areas of the aperture carry equal flux.
        let (a, b) = unit_disk(u, v);
        let sines = [a, b].map(|sine| sine * lens.object_aperture());
        let ahead = (1.0 - sines[0] * sines[0] - sines[1] * sines[1]).sqrt();
        let in_scene = |[x, y]: [f64; 2], z: f64| camera.right() * x + camera.up() * y + camera.direction() * z;
        let slopes = sines.map(|sine| sine / ahead);
        let start = [0, 1].map(|axis| [across, along][axis] - slopes[axis] * lens.focus_distance_m);
        let origin: DVec3 = (camera.position_m() + in_scene(start, 0.0)) / camera.scene_unit_m();
        Some(FilmRay { origin, direction: in_scene(sines, ahead), weight: 1.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rays;
    use crate::camera::tests::paper_description;

    const LENS: TelecentricLens = TelecentricLens { magnification: 0.1, f_number: 5.0, focus_distance_m: 0.3 };

    fn camera() -> PinholeCamera {
        PinholeCamera::new(&paper_description()).unwrap().with_telecentric_lens(LENS).unwrap()
    }

    /// Where the middle of the rays of a pixel's centre, and its farthest ray, meet a plane.
    fn seen(pixel: u64, distance: f64) -> ([f64; 2], f64) {
        let (camera, count) = (camera(), 1024);
        let rays = Rays::new(&camera, count, 0);
        let at = |sample: u32| {
            let mut u = rays.sampler(pixel, sample).take(radsight_sampling::DimensionSet::CAMERA);
            (u[0], u[1]) = (0.5, 0.5);
            let ray = rays.ray(pixel, u);
            let offset = ray.origin - camera.position_m();
            let at = offset + ray.direction * (distance / ray.direction.dot(camera.direction()));
            [at.dot(camera.right()), at.dot(camera.up())]
        };
        let all: Vec<[f64; 2]> = (0..count).map(at).collect();
        let middle = [0, 1].map(|axis| all.iter().map(|at| at[axis]).sum::<f64>() / f64::from(count));
        (middle, all.iter().map(|at| (at[0] - middle[0]).hypot(at[1] - middle[1])).fold(0.0, f64::max))
    }

    #[test]
    fn magnification_is_independent_of_distance() {
        let (first, second) = (40 * 192 + 30, 120 * 192 + 170);
        for distance in [0.2, 0.3, 0.5, 4.0] {
            let (a, b) = (seen(first, distance).0, seen(second, distance).0);
            assert!((b[0] - a[0] - 140.0 * 13.75e-6 / 0.1).abs() < 1e-4 * distance, "{distance}: {a:?} {b:?}");
            assert!((a[1] - b[1] - 80.0 * 16e-6 / 0.1).abs() < 1e-4 * distance, "{distance}: {a:?} {b:?}");
        }
    }

    #[test]
    fn objects_out_of_focus_are_blurred_by_the_numerical_aperture() {
        assert!(seen(1234, 0.3).1 < 1e-12);
        let sine: f64 = 0.1 / (2.0 * 5.0);
        let radius = 0.2 * sine / (1.0 - sine * sine).sqrt();
        assert!((seen(1234, 0.5).1 / radius - 1.0).abs() < 1e-2, "{} {radius}", seen(1234, 0.5).1);
    }

    #[test]
    fn a_uniform_scene_exposes_every_pixel_as_the_closed_form_says() {
        let camera = camera();
        let rays = Rays::new(&camera, 4, 0);
        let expected = 0.01 * std::f64::consts::PI / (4.0 * 5.0 * 5.0);
        for pixel in [0, 191, 82 * 192 + 96] {
            let mean = (0..4).map(|sample| rays.of_sample(pixel, sample).cos4).sum::<f64>() / 4.0;
            assert!((mean * camera.exposure_per_radiance() / expected - 1.0).abs() < 1e-12);
            assert_eq!(camera.central_cos4(pixel), 1.0);
        }
    }

    #[test]
    fn apertures_of_more_than_a_hemisphere_are_refused() {
        let wide = TelecentricLens { f_number: 0.5, ..LENS };
        assert!(wide.checked().unwrap_err().to_string().contains("numerical aperture"));
        assert!(TelecentricLens { focus_distance_m: 0.0, ..LENS }.checked().is_err());
    }
}
