//! Directions towards a light.

use crate::surface::FluxSurface;
use glam::DVec3;
use std::f64::consts::TAU;

/// A light whose points are sampled as seen from other points.
#[derive(Clone, Debug)]
pub enum Toward {
    /// A flat light at a finite distance, which emits from its front.
    Surface(FluxSurface),
    /// A sphere.
    Ball {
        /// Centre, scene coordinates.
        middle: DVec3,
        /// Radius, scene units.
        radius: f64,
    },
    /// A distant disk of directions.
    Distant {
        /// Unit vector towards its centre.
        direction: DVec3,
        /// Cosine of its half angle.
        cosine: f64,
    },
}

impl Toward {
    /// Maps a point of the unit square to a unit direction from a point to the light; returns it
    /// with the reciprocal of its density, in sr. `None` if the light is not visible.
    #[must_use]
    pub fn sample(&self, from: DVec3, point: [f64; 2]) -> Option<(DVec3, f64)> {
        match self {
            Toward::Surface(surface) => {
                let way = surface.point(point) - from;
                let direction = way.try_normalize()?;
                let cosine = -surface.normal.dot(direction);
                let solid_angle = surface.area * cosine / way.length_squared();
                (cosine > 0.0 && !surface.is_distant()).then_some((direction, solid_angle))
            }
            Toward::Ball { middle, radius } => {
                let way = *middle - from;
                let sin = radius / way.length();
                if sin.is_nan() || sin >= 1.0 {
                    return None;
                }
                Some(in_cone(way.normalize(), (1.0 - sin * sin).sqrt(), point))
            }
            Toward::Distant { direction, cosine } => Some(in_cone(*direction, *cosine, point)),
        }
    }
}

/// Uniform direction in a cone about an axis, and the cone's solid angle.
fn in_cone(axis: DVec3, cosine: f64, [a, b]: [f64; 2]) -> (DVec3, f64) {
    let height = 1.0 - a * (1.0 - cosine);
    let side = (1.0 - height * height).max(0.0).sqrt();
    let (u, v) = axis.any_orthonormal_pair();
    let (sin, cos) = (TAU * b).sin_cos();
    let direction = u * (side * cos) + v * (side * sin) + axis * height;
    (direction.normalize(), TAU * (1.0 - cosine))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Shape;

    #[test]
    fn solid_angles_are_those_of_the_shapes() {
        let square = [-1., -1., 2., -1., 1., 2., 1., 1., 2., 1., -1., 2.];
        let square = Toward::Surface(FluxSurface::new("s", Shape::Polygon, &square).unwrap());
        let ball = Toward::Ball { middle: DVec3::new(0.0, 0.0, 4.0), radius: 2.0 };
        let sun = Toward::Distant { direction: DVec3::Z, cosine: 0.5 };
        let count = 64;
        // The square of side 2 from a height of 2 has the solid angle 4·asin(1/5).
        for (light, solid_angle) in
            [(square, 4.0 * 0.2f64.asin()), (ball, TAU * (1.0 - 0.75f64.sqrt())), (sun, 0.5 * TAU)]
        {
            let at = |k: usize| (k as f64 + 0.5) / f64::from(count);
            let mut sum = 0.0;
            for k in 0..(count * count) as usize {
                let point = [at(k % count as usize), at(k / count as usize)];
                let (direction, solid_angle) = light.sample(DVec3::ZERO, point).unwrap();
                assert!(direction.is_normalized() && direction.z > 0.0, "{direction}");
                sum += solid_angle / f64::from(count * count);
            }
            assert!((sum / solid_angle - 1.0).abs() < 1e-3, "{sum} {solid_angle}");
        }
    }

    #[test]
    fn lights_are_not_seen_from_behind_or_within() {
        let back = [-1., -1., 2., 1., -1., 2., 1., 1., 2., -1., 1., 2.];
        let back = Toward::Surface(FluxSurface::new("s", Shape::Polygon, &back).unwrap());
        assert!(back.sample(DVec3::ZERO, [0.5; 2]).is_none());
        assert!(Toward::Ball { middle: DVec3::X, radius: 2.0 }.sample(DVec3::ZERO, [0.5; 2]).is_none());
    }
}
