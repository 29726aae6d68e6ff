//! Microfacets with the distribution of Trowbridge and Reitz (GGX).
//!
//! Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007, eqs. 33 and
//! 34; Heitz, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 3(2),
//! 2014, eqs. 72 and 99; sampling of visible normals: Dupuy and Benyoub, "Sampling Visible GGX
//! Normals with Spherical Caps", HPG 2023.

use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// An isotropic microfacet distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx {
    /// Roughness α, above 0.
    pub roughness: f64,
}

impl Ggx {
    /// Distribution of normals `D(h)`, 1/sr: facet area with the unit normal `half`, per surface
    /// area and solid angle.
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

    /// Smith's `Λ(v)`: ratio of masked to visible projected facet area from `direction`.
    #[inline]
    #[must_use]
    pub fn lambda(&self, direction: DVec3) -> f64 {
        let tan_squared = (direction.x * direction.x + direction.y * direction.y) / (direction.z * direction.z);
        0.5 * ((1.0 + self.roughness * self.roughness * tan_squared).sqrt() - 1.0)
    }

    /// `D G₂/(4 cos θ_i cos θ_o)` in 1/sr, the single-scattering BRDF of perfectly reflecting
    /// facets, and the density of [`Ggx::sample`].
    #[inline]
    #[must_use]
    pub fn reflect(&self, outgoing: DVec3, incident: DVec3) -> Reflection {
        let sum = outgoing + incident;
        if outgoing.z <= 0.0 || incident.z <= 0.0 {
            return Reflection { value: 0.0, pdf: 0.0, cosine: 0.0 };
        }
        let half = sum.normalize();
        let hidden = self.lambda(outgoing);
        let density = self.density(half);
        Reflection {
            value: density / (4.0 * outgoing.z * incident.z * (1.0 + hidden + self.lambda(incident))),
            pdf: density / (4.0 * outgoing.z * (1.0 + hidden)),
            // For unit vectors h·o = |o + i|/2.
            cosine: (0.5 * sum.length()).min(1.0),
        }
    }

    /// Samples an incident direction by reflection at a facet visible from `outgoing`; it may be
    /// below the horizon.
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

/// Result of [`Ggx::reflect`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflection {
    /// Value in 1/sr, to be multiplied by the facets' reflectance.
    pub value: f64,
    /// Density of [`Ggx::sample`], 1/sr.
    pub pdf: f64,
    /// Cosine of the angle between either direction and the facet's normal.
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
                    // Uniform steps in s, with tan θ = s/(1 − s).
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
