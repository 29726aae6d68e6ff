//! Microfacets with the distribution of Trowbridge and Reitz (GGX), for the sheen of films and for
//! [`crate::mrm`].
//!
//! Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007, eq. 33;
//! Heitz, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 3(2),
//! 2014, eqs. 72 and 99; visible normals are sampled by Dupuy and Benyoub, "Sampling Visible GGX
//! Normals with Spherical Caps", HPG 2023.

use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// An isotropic microfacet distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ggx {
    /// Roughness α, above 0.
    pub(crate) roughness: f64,
}

/// Microfacet reflection for one pair of directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Facets {
    /// `D G₂/(4 cos θ_i cos θ_o)`, 1/sr; to be multiplied by the facets' reflectance.
    pub(crate) value: f64,
    /// Density of [`Ggx::sample`], 1/sr.
    pub(crate) pdf: f64,
    /// Cosine of the angle between either direction and the facet's normal.
    pub(crate) cosine: f64,
}

impl Ggx {
    /// Distribution of normals `D(h)`, 1/sr.
    fn density(&self, half: DVec3) -> f64 {
        let alpha_squared = self.roughness * self.roughness;
        let shape = half.z * half.z + (half.x * half.x + half.y * half.y) / alpha_squared;
        1.0 / (PI * alpha_squared * shape * shape)
    }

    /// Smith's `Λ(v)`.
    fn lambda(&self, direction: DVec3) -> f64 {
        let tan_squared = (direction.x * direction.x + direction.y * direction.y) / (direction.z * direction.z);
        0.5 * ((1.0 + self.roughness * self.roughness * tan_squared).sqrt() - 1.0)
    }

    /// Reflection for a pair of directions; zero if one of them is below the surface.
    pub(crate) fn reflect(&self, outgoing: DVec3, incident: DVec3) -> Facets {
        if outgoing.z <= 0.0 || incident.z <= 0.0 {
            return Facets { value: 0.0, pdf: 0.0, cosine: 0.0 };
        }
        let sum = outgoing + incident;
        let density = self.density(sum.normalize());
        let hidden = self.lambda(outgoing);
        Facets {
            value: density / (4.0 * outgoing.z * incident.z * (1.0 + hidden + self.lambda(incident))),
            pdf: density / (4.0 * outgoing.z * (1.0 + hidden)),
            // For unit vectors h·o = |o + i|/2.
            cosine: (0.5 * sum.length()).min(1.0),
        }
    }

    /// Samples an incident direction by reflection at a visible normal; it may be below the
    /// horizon.
    pub(crate) fn sample(&self, outgoing: DVec3, u: [f64; 2]) -> DVec3 {
        let alpha = self.roughness;
        let stretched = DVec3::new(alpha * outgoing.x, alpha * outgoing.y, outgoing.z).normalize();
        let z = (1.0 - u[1]) * (1.0 + stretched.z) - stretched.z;
        let radius = (1.0 - z * z).max(0.0).sqrt();
        let (sin, cos) = (TAU * u[0]).sin_cos();
        let cap = DVec3::new(radius * cos, radius * sin, z) + stretched;
        let half = DVec3::new(alpha * cap.x, alpha * cap.y, cap.z.max(1e-300)).normalize();
        (half * (2.0 * half.dot(outgoing)) - outgoing).normalize()
    }
}
