//! The ray of a camera.

use glam::DVec3;

/// A ray that leaves the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraRay {
    /// A point of the pinhole, scene frame, scene units. The space between sensor and pinhole is
    /// empty, so rays start here.
    pub origin: DVec3,
    /// From the sensor point to the pinhole point and on into the scene; unit.
    pub direction: DVec3,
    /// cos⁴θ, with θ the angle from the axis to the ray behind the pinhole: the ray's weight. For a
    /// tilted sensor it is cos³θ times the cosine at the sensor, for a distorted picture it
    /// includes the ratio of areas, and it is 0 where a stop blocks the ray.
    pub cos4: f64,
    /// The cell of the diffraction pattern from which it was drawn.
    pub(crate) pattern_cell: u32,
}
