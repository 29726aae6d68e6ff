//! The spacing of rays.

/// The spacing of neighbouring rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RaySpacing {
    /// Distance of their origins, scene units.
    pub width: f64,
    /// Angle between them, radians.
    pub angle: f64,
}

impl RaySpacing {
    /// Unrelated rays.
    pub const UNKNOWN: RaySpacing = RaySpacing { width: 0.0, angle: 0.0 };

    /// Distance between neighbouring rays after this distance, scene units.
    pub(crate) fn at(&self, distance: f64) -> f64 {
        self.width + self.angle * distance
    }

    /// The same, times a factor.
    pub(crate) fn scaled(&self, factor: f64) -> RaySpacing {
        RaySpacing { width: factor * self.width, angle: factor * self.angle }
    }
}
