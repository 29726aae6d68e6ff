//! The coefficient of retroreflection, and its measurement geometry.
//!
//! `R_A = I/(E⊥ A) = f · cos β · cos ν` in cd/(lx m²), with the intensity I towards the observer,
//! the illuminance E⊥ on a plane perpendicular to the light, the area A of the sample, the entrance
//! angle β (from the normal to the light) and the viewing angle ν (from the normal to the
//! observer). ASTM E808 and E810; CIE 54.2.

use glam::DVec3;

/// Measurement geometry: the angles of one measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    /// Observation angle α, from the light to the observer, radians.
    pub observation: f64,
    /// Entrance angle β, from the normal to the light, radians. Its sign is that of coplanar
    /// geometry: if it is positive, the observer is nearer to the normal than the light.
    pub entrance: f64,
    /// Rotation angle ε, about the normal, from the plane of measurement to the datum mark of the
    /// sample (the frame's x axis), radians.
    pub rotation: f64,
}

impl Geometry {
    /// Geometry from all three angles in degrees.
    #[must_use]
    pub fn from_degrees(observation: f64, entrance: f64, rotation: f64) -> Geometry {
        Geometry {
            observation: observation.to_radians(),
            entrance: entrance.to_radians(),
            rotation: rotation.to_radians(),
        }
    }

    /// Unit directions to the observer and to the light, in the sample's frame (ASTM E810,
    /// coplanar).
    #[must_use]
    pub fn directions(self) -> (DVec3, DVec3) {
        let (sin_rotation, cos_rotation) = self.rotation.sin_cos();
        let direction = |polar: f64| {
            let (sin, cos) = polar.sin_cos();
            DVec3::new(sin * cos_rotation, -sin * sin_rotation, cos)
        };
        (direction(self.entrance - self.observation), direction(self.entrance))
    }

    /// `cos β · cos ν`.
    #[must_use]
    pub fn cosines(self) -> f64 {
        self.entrance.cos() * (self.entrance - self.observation).cos()
    }

    /// Coefficient R_A in cd/(lx m²) of a BRDF value in 1/sr.
    #[must_use]
    pub fn coefficient(self, brdf: f64) -> f64 {
        brdf * self.cosines()
    }

    /// BRDF value in 1/sr of a coefficient R_A in cd/(lx m²).
    #[must_use]
    pub fn brdf(self, coefficient: f64) -> f64 {
        coefficient / self.cosines()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_coefficient_survives_a_round_trip() {
        for observation in [0.0, 0.1, 0.2, 0.5, 1.0, 2.0] {
            for entrance in [-60.0, -4.0, 0.0, 5.0, 30.0, 45.0, 75.0] {
                let at = Geometry::from_degrees(observation, entrance, 0.0);
                for coefficient in [1e-3, 86.0, 1200.0] {
                    let back = at.coefficient(at.brdf(coefficient));
                    assert!((back / coefficient - 1.0).abs() < 1e-14);
                }
            }
        }
    }

    #[test]
    fn directions_are_at_the_requested_angles() {
        let at = Geometry::from_degrees(0.33, 30.0, 90.0);
        let (observer, light) = at.directions();
        assert!((crate::observation_angle(observer, light).to_degrees() - 0.33).abs() < 1e-10);
        assert!((light.z - 30f64.to_radians().cos()).abs() < 1e-15);
        assert!(observer.z > light.z);
        assert!(light.x.abs() < 1e-15 && light.y < 0.0);
        assert!((at.cosines() - observer.z * light.z).abs() < 1e-15);
    }
}
