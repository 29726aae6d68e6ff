//! Fresnel reflectance of a smooth interface. Born and Wolf, *Principles of Optics*, §1.5;
//! unpolarised.

/// Reflectance of an interface to a dielectric of relative index `index`, at the cosine of the
/// angle of incidence (0…1). One for total reflection.
#[inline]
#[must_use]
pub fn fresnel_dielectric(cosine: f64, index: f64) -> f64 {
    let transmitted_squared = index * index - (1.0 - cosine * cosine);
    if transmitted_squared <= 0.0 {
        return 1.0;
    }
    // n cos θ_t.
    let inner = transmitted_squared.sqrt();
    let perpendicular = (cosine - inner) / (cosine + inner);
    let parallel = (index * index * cosine - inner) / (index * index * cosine + inner);
    0.5 * (perpendicular * perpendicular + parallel * parallel)
}

/// Schlick, "An Inexpensive BRDF Model for Physically-Based Rendering", Eurographics 1994, eq. 15.
#[inline]
#[must_use]
pub(crate) fn fresnel_schlick(cosine: f64, at_normal_incidence: f64) -> f64 {
    at_normal_incidence + (1.0 - at_normal_incidence) * (1.0 - cosine).clamp(0.0, 1.0).powi(5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glass_reflects_four_percent_and_one_polarisation_at_brewsters_angle() {
        assert!((fresnel_dielectric(1.0, 1.5) - 0.04).abs() < 1e-15);
        // At Brewster's angle only the perpendicular polarisation is reflected: ½ ((1 − n²)/(1 +
        // n²))².
        let brewster = (1.0f64 / (1.0 + 1.5 * 1.5)).sqrt();
        let expected = 0.5 * ((1.0 - 2.25f64) / 3.25).powi(2);
        assert!((fresnel_dielectric(brewster, 1.5) - expected).abs() < 1e-15);
        assert_eq!(fresnel_dielectric(0.1, 1.0 / 1.5), 1.0);
    }
}
