//! Angles and directions that are accurate near zero, as retroreflectors require.

use glam::DVec3;
use std::f64::consts::{FRAC_1_PI, TAU};

/// The angle between two unit vectors, radians, with full relative precision near 0 (`acos` of a
/// dot product has an absolute error of 1e-8 rad).
///
/// Kahan, "How Futile are Mindless Assessments of Roundoff", 2006, §12: `2·atan2(|a−b|, |a+b|)`.
#[inline]
#[must_use]
pub fn angle_between(a: DVec3, b: DVec3) -> f64 {
    2.0 * (a - b).length().atan2((a + b).length())
}

/// The mirror direction of `direction` about the normal.
#[inline]
#[must_use]
pub fn mirror(direction: DVec3) -> DVec3 {
    DVec3::new(-direction.x, -direction.y, direction.z)
}

/// Two unit vectors that form a right-handed frame with the unit vector `axis`.
///
/// Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
#[inline]
#[must_use]
pub fn frame(axis: DVec3) -> (DVec3, DVec3) {
    let sign = 1.0f64.copysign(axis.z);
    let a = -1.0 / (sign + axis.z);
    let b = axis.x * axis.y * a;
    (
        DVec3::new(1.0 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x),
        DVec3::new(b, sign + axis.y * axis.y * a, -axis.y),
    )
}

/// The unit vector at `polar` radians from the unit vector `axis`, at `azimuth` radians about it
/// (from [`frame`]'s first vector towards its second).
#[inline]
#[must_use]
pub fn direction_near(axis: DVec3, polar: f64, azimuth: f64) -> DVec3 {
    let (x, y) = frame(axis);
    let ((sin_polar, cos_polar), (sin_azimuth, cos_azimuth)) = (polar.sin_cos(), azimuth.sin_cos());
    ((x * cos_azimuth + y * sin_azimuth) * sin_polar + axis * cos_polar).normalize()
}

/// Maps a point of the unit square to a direction of the upper hemisphere with density cos θ / π
/// (Malley's method).
#[inline]
#[must_use]
pub fn cosine_hemisphere(u0: f64, u1: f64) -> DVec3 {
    let radius = u0.sqrt();
    let (sin, cos) = (TAU * u1).sin_cos();
    DVec3::new(radius * cos, radius * sin, (1.0 - u0).max(0.0).sqrt())
}

/// The density of [`cosine_hemisphere`], 1/sr.
#[inline]
#[must_use]
pub fn cosine_pdf(direction: DVec3) -> f64 {
    direction.z.max(0.0) * FRAC_1_PI
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tiny_angle_keeps_its_digits() {
        let axis = DVec3::new(0.6, 0.0, 0.8);
        for angle in [1e-9, 1e-6, 1e-3, 0.5, 3.0] {
            let found = angle_between(axis, direction_near(axis, angle, 1.0));
            assert!((found / angle - 1.0).abs() < 1e-6, "{angle} came back as {found}");
        }
    }

    #[test]
    fn the_frame_is_orthonormal_and_right_handed_even_at_the_poles() {
        for axis in [DVec3::Z, -DVec3::Z, DVec3::X, DVec3::new(-0.48, 0.6, -0.64)] {
            let (x, y) = frame(axis);
            assert!((x.cross(y) - axis).length() < 1e-12, "{axis}: {x} {y}");
            assert!(x.dot(y).abs() < 1e-12);
        }
    }
}
