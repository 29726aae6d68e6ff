//! The kernel by which a diffuse surface receives indirect light.
//!
//! A texture, or a mesh with normals at its vertices, turns the normal n of a surface to the normal
//! n′ of a facet. Radiance takes the irradiance of the surface and its gradient by rotation,
//!
//! E(n′) ≈ E(n) + ∇E·(n × n′) = ∫ L(ω) ω·(n + n′ₜ) dω,
//!
//! over the hemisphere about n, where n′ₜ is the part of n′ along the surface (Ward and Heckbert,
//! "Irradiance Gradients", 1992; `multambient` in Radiance's `ambient.c`). Under a uniform sky a
//! facet receives what the surface does: facets that face each other are lit by each other.
//!
//! Irradiance from the cache changes in this way, and so do sampled rays.

use crate::frame::Frame;
use glam::DVec3;
use radsight_sampling::cosine_hemisphere;
use std::f64::consts::FRAC_1_PI;

/// Kernel of indirect light on one side of a surface.
#[derive(Clone, Copy, Debug)]
pub struct DiffuseLobe {
    /// Unit normal of the surface, on the side of the lobe.
    surface: DVec3,
    /// The unit axis of the cosine.
    axis: DVec3,
    /// Factor of the cosine.
    scale: f64,
    below: BelowSurface,
}

/// A direction from a [`DiffuseLobe`].
#[derive(Clone, Copy, Debug)]
pub struct DiffuseSample {
    /// Unit.
    pub direction: DVec3,
    /// π times the kernel over the density: positive or negative.
    pub weight: f64,
    /// Density, 1/sr.
    pub pdf: f64,
}

/// Directions of the cosine's hemisphere that are below the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum BelowSurface {
    /// Count negatively for the opposite direction.
    Negative,
    /// Do not count.
    Ignored,
}

impl DiffuseLobe {
    /// The irradiance of a facet by the gradient of the surface's irradiance. Both normals are unit.
    pub fn of_facet(surface: DVec3, facet: DVec3) -> Self {
        if facet == surface {
            return DiffuseLobe::above(surface, surface);
        }
        let along = facet - surface * surface.dot(facet);
        let (axis, scale) = (surface + along).normalize_and_length();
        DiffuseLobe { surface, axis, scale, below: BelowSurface::Negative }
    }

    /// A cosine about a unit axis, of which only the part above the surface counts.
    pub fn above(surface: DVec3, axis: DVec3) -> Self {
        DiffuseLobe { surface, axis, scale: 1.0, below: BelowSurface::Ignored }
    }

    /// The sample of a direction; `None` if the lobe does not reach there.
    pub fn at(&self, direction: DVec3) -> Option<DiffuseSample> {
        let cosine = self.axis.dot(direction);
        let counts = match self.below {
            BelowSurface::Negative => cosine != 0.0,
            BelowSurface::Ignored => cosine > 0.0,
        };
        (counts && self.surface.dot(direction) > 0.0).then_some(DiffuseSample {
            direction,
            weight: self.scale.copysign(cosine),
            pdf: cosine.abs() * FRAC_1_PI,
        })
    }

    /// Samples a direction, with [`DiffuseSample::pdf`].
    pub fn sample(&self, u: f64, v: f64) -> Option<DiffuseSample> {
        let direction = Frame::new(self.axis).to_scene(DVec3::from_array(cosine_hemisphere(u, v)));
        let is_below = self.surface.dot(direction) < 0.0;
        self.at(if is_below && self.below == BelowSurface::Negative { -direction } else { direction })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use radsight_sampling::{DimensionSet, RaySampler};
    use std::f64::consts::PI;

    const NORMAL: DVec3 = DVec3::Z;

    fn facets() -> [DVec3; 4] {
        [[0.0, 0.0, 1.0], [0.3, -0.1, 1.0], [-1.7, 0.4, 1.0], [1.0, 0.2, -0.1]]
            .map(|facet| DVec3::from_array(facet).normalize())
    }

    /// Mean and standard error of the irradiance under a sky.
    fn irradiance(lobe: &DiffuseLobe, sky: impl Fn(DVec3) -> f64) -> (f64, f64) {
        let draws = 1 << 16;
        let (mut sum, mut squares) = (0.0, 0.0);
        for draw in 0..draws {
            let [u, v, ..] = RaySampler::new(3, draw).take(DimensionSet::CAMERA);
            let value = lobe.sample(u, v).map_or(0.0, |sample| PI * sample.weight * sky(sample.direction));
            (sum, squares) = (sum + value, squares + value * value);
        }
        let mean = sum / draws as f64;
        (mean, ((squares / draws as f64 - mean * mean) / draws as f64).sqrt())
    }

    fn assert_within((found, error): (f64, f64), expected: f64) {
        assert!((found - expected).abs() < 4.0 * error + 1e-9, "{found} ± {error}, expected {expected}");
    }

    #[test]
    fn a_uniform_sky_lights_all_facets_alike() {
        for facet in facets() {
            assert_within(irradiance(&DiffuseLobe::of_facet(NORMAL, facet), |_| 1.0), PI);
        }
    }

    /// L = 1 for ω_x > 0 and 0.2 elsewhere: 0.6 π + 0.4 π n′_x.
    #[test]
    fn irradiance_changes_by_the_gradient() {
        for facet in facets() {
            let sky = |direction: DVec3| if direction.x > 0.0 { 1.0 } else { 0.2 };
            assert_within(irradiance(&DiffuseLobe::of_facet(NORMAL, facet), sky), PI * (0.6 + 0.4 * facet.x));
        }
    }

    /// A cosine about n′ that is cut off by the surface: π (1 + cos) / 2 under a uniform sky.
    #[test]
    fn directions_below_the_surface_are_lost_where_they_are_to_be() {
        for facet in facets() {
            assert_within(irradiance(&DiffuseLobe::above(NORMAL, facet), |_| 1.0), 0.5 * PI * (1.0 + facet.z));
        }
    }

    #[test]
    fn the_density_is_that_of_the_samples() {
        for facet in facets() {
            let lobe = DiffuseLobe::of_facet(NORMAL, facet);
            // Uniform directions; every sample has the weight and density of its direction.
            let (mut total, directions) = (0.0, 1 << 16);
            for draw in 0..directions {
                let [u, v, s, t] = RaySampler::new(4, draw).take(DimensionSet::CAMERA);
                let (sin, cos) = (2.0 * PI * v).sin_cos();
                let level = (1.0 - u * u).sqrt();
                total += lobe.at(DVec3::new(level * cos, level * sin, u)).map_or(0.0, |sample| sample.pdf);
                if let Some(sample) = lobe.sample(s, t) {
                    let again = lobe.at(sample.direction).expect("it reaches its samples");
                    assert_eq!((again.weight, again.pdf), (sample.weight, sample.pdf));
                    assert!(sample.direction.z > 0.0 && sample.direction.is_normalized());
                }
            }
            let integral = 2.0 * PI * total / directions as f64;
            assert!((integral - 1.0).abs() < 0.01, "{facet}: {integral}");
        }
    }
}
