//! A thin lens instead of the pinhole.

use crate::CameraError;

/// A thin lens. It changes the slope of a ray that meets it at h, measured from its centre, by
/// −h/F, and is its own aperture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinLens {
    /// F, metres.
    pub focal_length_m: f64,
    /// Diameter of the aperture, metres.
    pub aperture_m: f64,
    /// From the lens to the plane of focus along the axis, metres; may be infinite.
    pub focus_distance_m: f64,
    /// A round stop in front of the lens that causes optical vignetting, if there is one.
    pub front_stop: Option<FrontStop>,
}

/// A round aperture in front of a lens, centred on its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrontStop {
    /// From the lens towards the scene, metres.
    pub distance_m: f64,
    /// Its diameter, metres.
    pub diameter_m: f64,
}

impl ThinLens {
    /// Checks the quantities.
    ///
    /// # Errors
    /// If a quantity is not positive, or the focus distance is not larger than the focal length.
    pub fn checked(self) -> Result<Self, CameraError> {
        let mut all = vec![("lens focal length", self.focal_length_m), ("lens aperture", self.aperture_m)];
        if let Some(stop) = self.front_stop {
            all.extend([("front stop distance", stop.distance_m), ("front stop diameter", stop.diameter_m)]);
        }
        if let Some((quantity, value)) = all.into_iter().find(|(_, value)| !(value.is_finite() && *value > 0.0)) {
            return Err(CameraError::NotPositive { quantity, value });
        }
        if self.focus_distance_m.is_nan() || self.focus_distance_m <= self.focal_length_m {
            let (focus_distance_m, focal_length_m) = (self.focus_distance_m, self.focal_length_m);
            return Err(CameraError::NotSharp { focus_distance_m, focal_length_m });
        }
        Ok(self)
    }

    /// From the lens to the sensor, metres: `1/s' = 1/F − 1/s`.
    #[must_use]
    pub fn image_distance_m(&self) -> f64 {
        (self.focal_length_m.recip() - self.focus_distance_m.recip()).recip()
    }

    /// Diameter of the geometric image of a point on the axis at `distance_m`, metres: `A s' |1/s −
    /// 1/D|`.
    #[must_use]
    pub fn blur_circle_m(&self, distance_m: f64) -> f64 {
        self.aperture_m * self.image_distance_m() * (self.focus_distance_m.recip() - distance_m.recip()).abs()
    }
}
