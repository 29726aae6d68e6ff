//! How far apart rays are.

/// How far apart neighbouring rays are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RaySpacing {
    /// Distance of their origins, scene units.
    pub width: f64,
    /// Angle between them, radians.
    pub angle: f64,
}

impl RaySpacing {
    /// Rays that have nothing to do with each other.
    pub const UNKNOWN: RaySpacing = RaySpacing { width: 0.0, angle: 0.0 };

    /// Distance of neighbouring rays where they have gone so far, scene units.
    pub(crate) fn at(&self, distance: f64) -> f64 {
        self.width + self.angle * distance
    }
}
