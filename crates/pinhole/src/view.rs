//! The camera as a view of Radiance's programs.

use crate::PinholeCamera;
use glam::DVec3;
use std::fmt;

/// A perspective view and the size of its picture. Prints as view options (`-vtv -vp …`).
///
/// The pixels of a camera need not be square: use `-pa 0` (or `-pa` with the pixel's height over
/// its width) with `-x` and `-y`, since otherwise the program changes the size to make them square.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// The eye point, scene frame, scene units.
    pub position: DVec3,
    /// Viewing direction; unit.
    pub direction: DVec3,
    /// The picture's up; unit.
    pub up: DVec3,
    /// Full horizontal angle, degrees.
    pub horizontal_deg: f64,
    /// Full vertical angle, degrees.
    pub vertical_deg: f64,
    /// Columns and rows of the picture.
    pub pixels: [u32; 2],
}

impl View {
    /// The view through a point of the pinhole's plane, `offset_m` metres right of and above its
    /// centre. Its window is the sensor's plus `margin` pixels on each side (columns, rows),
    /// centred on the view's own axis.
    #[must_use]
    pub fn through_pinhole(camera: &PinholeCamera, offset_m: [f64; 2], margin: [u32; 2]) -> Self {
        let pixels = [camera.columns() + 2 * margin[0], camera.rows() + 2 * margin[1]];
        let full_angle_deg = |axis: usize| {
            let half_width = 0.5 * f64::from(pixels[axis]) * camera.pixel_pitch_m()[axis];
            2.0 * half_width.atan2(camera.focal_distance_m()).to_degrees()
        };
        let position_m = camera.position_m() + camera.right() * offset_m[0] + camera.up() * offset_m[1];
        View {
            position: position_m / camera.scene_unit_m(),
            direction: camera.direction(),
            up: camera.up(),
            horizontal_deg: full_angle_deg(0),
            vertical_deg: full_angle_deg(1),
            pixels,
        }
    }
}

impl fmt::Display for View {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (p, d, u) = (self.position, self.direction, self.up);
        write!(
            out,
            "-vtv -vp {} {} {} -vd {} {} {} -vu {} {} {} -vh {} -vv {} -vs 0 -vl 0 -vo 0 -va 0",
            p.x, p.y, p.z, d.x, d.y, d.z, u.x, u.y, u.z, self.horizontal_deg, self.vertical_deg
        )
    }
}
