//! Microfacets with the distribution of Trowbridge and Reitz ("GGX").
//!
//! Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007, eqs. 33 and 34; Heitz, "Understanding the
//! Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 3(2), 2014, eqs. 72 and 99; drawing visible facets: Dupuy and
//! Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023.

use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// An isotropic distribution of facets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx {
    /// α: rms-like slope of the facets, above 0.
    pub roughness: f64,
}

impl Ggx {
    /// `D(h)`, 1/sr: facets whose normal is the unit vector `half`, per area of the surface.
    #[inline]
    #[must_use]
    pub fn density(&self, half: DVec3) -> f64 {
        if half.z <= 0.0 {
            return 0.0;
        }
        let alpha_squared = self.roughness * self.roughness;
        let shape = half.z * half.z + (half.x * half.x + half.y * half.y) / alpha_squared;
        1.0 / (PI * alpha_squared * shape * shape)
    }

    /// `Λ(v)`: how many times as many facets are hidden as are seen from `direction`.
    #[inline]
    #[must_use]
    pub fn hidden(&self, direction: DVec3) -> f64 {
        let tan_squared = (direction.x * direction.x + direction.y * direction.y) / (direction.z * direction.z);
        0.5 * ((1.0 + self.roughness * self.roughness * tan_squared).sqrt() - 1.0)
    }

    /// `D G₂/(4 cos θ_i cos θ_o)` in 1/sr, the BRDF of facets that reflect everything once, and the density of [`Ggx::sample`].
    #[inline]
    #[must_use]
    pub fn reflect(&self, outgoing: DVec3, incident: DVec3) -> Reflection {
        let sum = outgoing + incident;
        if outgoing.z <= 0.0 || incident.z <= 0.0 {
            return Reflection { value: 0.0, pdf: 0.0, cosine: 0.0 };
        }
        let half = sum.normalize();
        let hidden = self.hidden(outgoing);
        let density = self.density(half);
        Reflection {
            value: density / (4.0 * outgoing.z * incident.z * (1.0 + hidden + self.hidden(incident))),
            pdf: density / (4.0 * outgoing.z * (1.0 + hidden)),
            // For unit vectors h·o = |o + i|/2.
            cosine: (0.5 * sum.length()).min(1.0),
        }
    }

    /// An incident direction by reflection at a facet that is visible from `outgoing`; it may point below the horizon.
    #[inline]
    #[must_use]
    pub fn sample(&self, outgoing: DVec3, u0: f64, u1: f64) -> DVec3 {
        let alpha = self.roughness;
        let stretched = DVec3::new(alpha * outgoing.x, alpha * outgoing.y, outgoing.z).normalize();
        let z = (1.0 - u1) * (1.0 + stretched.z) - stretched.z;
        let radius = (1.0 - z * z).max(0.0).sqrt();
        let (sin, cos) = (TAU * u0).sin_cos();
        let cap = DVec3::new(radius * cos, radius * sin, z) + stretched;
        let half = DVec3::new(alpha * cap.x, alpha * cap.y, cap.z.max(1e-300)).normalize();
        (half * (2.0 * half.dot(outgoing)) - outgoing).normalize()
    }
}

/// What [`Ggx::reflect`] finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflection {
    /// 1/sr, to be multiplied by the facets' reflectance.
    pub value: f64,
    /// 1/sr.
    pub pdf: f64,
    /// Of the angle between either direction and the facet's normal.
    pub cosine: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn projected_facets_add_up_to_the_surface() {
        for roughness in [0.05, 0.3, 1.0] {
            let ggx = Ggx { roughness };
            let steps = 200_000;
            let sum: f64 = (0..steps)
                .map(|step| {
                    // Steps in tan θ from 0 on, by the substitution t = s/(1 − s).
                    let s = (f64::from(step) + 0.5) / f64::from(steps);
                    let tan = s / (1.0 - s);
                    let cos = 1.0 / (1.0 + tan * tan).sqrt();
                    let half = DVec3::new(tan * cos, 0.0, cos);
                    ggx.density(half) * cos * TAU * tan * cos.powi(3) / (1.0 - s).powi(2) / f64::from(steps)
                })
                .sum();
            assert!((sum - 1.0).abs() < 1e-4, "roughness {roughness}: {sum}");
        }
    }
}
