//! The position of the sensor behind the pinhole or lens.

use glam::DVec3;

/// Shift and tilt of the sensor relative to its nominal position, centred on the axis and
/// perpendicular to it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FilmPlane {
    /// Shift of the visible part of the image, right and up, metres: the axis appears this far left
    /// and down.
    pub shift_m: [f64; 2],
    /// Rotations of the sensor about the picture's right and up through its centre, radians, small.
    pub tilt: [f64; 2],
}

impl FilmPlane {
    /// The vector from a sensor point to the centre of the pinhole, and the sensor's normal, both
    /// along (right, up, direction).
    pub(crate) fn chief(&self, [x, y]: [f64; 2], focal_distance_m: f64) -> (DVec3, DVec3) {
        let (sin_x, cos_x) = self.tilt[0].sin_cos();
        let (sin_y, cos_y) = self.tilt[1].sin_cos();
        let across = DVec3::new(cos_y, 0.0, -sin_y);
        let along = DVec3::new(sin_x * sin_y, cos_x, sin_x * cos_y);
        let middle = DVec3::new(self.shift_m[0], self.shift_m[1], focal_distance_m);
        (middle + across * x + along * y, across.cross(along))
    }
}
