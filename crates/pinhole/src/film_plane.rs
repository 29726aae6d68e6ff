//! Where the sensor stands behind the hole or lens.

use glam::DVec3;

/// The sensor's place and tilt against its nominal one: centred on the axis and perpendicular to it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FilmPlane {
    /// Shift of the image that the sensor sees, right and up, metres: what is on the axis appears so far left and down.
    pub shift_m: [f64; 2],
    /// Rotations of the sensor about the picture's right and up through its middle, radians, small.
    pub tilt: [f64; 2],
}

impl FilmPlane {
    /// The way from a point of the sensor to the middle of the hole, and the sensor's normal, both along (right, up, direction).
    pub(crate) fn chief(&self, [x, y]: [f64; 2], focal_distance_m: f64) -> (DVec3, DVec3) {
        let (sin_x, cos_x) = self.tilt[0].sin_cos();
        let (sin_y, cos_y) = self.tilt[1].sin_cos();
        let across = DVec3::new(cos_y, 0.0, -sin_y);
        let along = DVec3::new(sin_x * sin_y, cos_x, sin_x * cos_y);
        let middle = DVec3::new(self.shift_m[0], self.shift_m[1], focal_distance_m);
        (middle + across * x + along * y, across.cross(along))
    }
}
