//! Whether diffraction at the pinhole matters.

use crate::PinholeCamera;

/// The Fresnel number of the pinhole for an object at `distance_m`: `N = a² (1/f + 1/D) / λ`.
///
/// a is the pinhole's radius, f the focal distance, D the distance, λ the wavelength. N is the
/// largest phase difference, in half waves, between paths over the edge of the pinhole and the path
/// through its centre (Born and Wolf, Principles of Optics, section 8.3.3). Well above 1 the
/// geometric shadow of the pinhole is a good point spread function; near 1 and below, the point
/// spread function is a diffraction pattern. `None` if the wavelength is not known.
#[must_use]
pub fn fresnel_number(camera: &PinholeCamera, distance_m: f64) -> Option<f64> {
    let radius = 0.5 * camera.pinhole_diameter_m();
    let curvature = camera.focal_distance_m().recip() + distance_m.recip();
    camera.wavelength_m().map(|wavelength| radius * radius * curvature / wavelength)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::tests::paper_camera;

    #[test]
    fn the_papers_pinhole_has_a_fresnel_number_near_0_6() {
        let number = fresnel_number(&paper_camera(), 0.48).unwrap();
        assert!((number - 0.578).abs() < 1e-3, "{number}");
    }

    #[test]
    fn an_object_at_infinity_is_allowed() {
        let number = fresnel_number(&paper_camera(), f64::INFINITY).unwrap();
        assert!((number - 0.5698).abs() < 1e-3, "{number}");
    }
}
