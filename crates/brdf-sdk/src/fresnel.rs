//! Fresnel reflectance of smooth interfaces. Born and Wolf, *Principles of Optics*, §1.5 and §14.2;
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
    // g = n cos θ_t, so that R_s = ((c − g)/(c + g))² and R_p = ((n² c − g)/(n² c + g))².
    let g = transmitted_squared.sqrt();
    let perpendicular = (cosine - g) / (cosine + g);
    let parallel = (index * index * cosine - g) / (index * index * cosine + g);
    0.5 * (perpendicular * perpendicular + parallel * parallel)
}

/// Reflectance of a conductor of complex index `n + ik`, at the cosine of the angle of incidence
/// (0…1).
#[inline]
#[must_use]
pub fn fresnel_conductor(cosine: f64, n: f64, k: f64) -> f64 {
    let cosine_squared = cosine * cosine;
    let sine_squared = 1.0 - cosine_squared;
    // (a + ib)² = (n + ik)² − sin² θ.
    let real = n * n - k * k - sine_squared;
    let modulus = (real * real + 4.0 * n * n * k * k).sqrt();
    let a = (0.5 * (modulus + real)).max(0.0).sqrt();
    let (sum, cross) = (modulus + cosine_squared, 2.0 * a * cosine);
    let perpendicular = (sum - cross) / (sum + cross);
    let (sum, cross) = (cosine_squared * modulus + sine_squared * sine_squared, cross * sine_squared);
    let ratio = if sum + cross > 0.0 { (sum - cross) / (sum + cross) } else { 1.0 };
    0.5 * perpendicular * (1.0 + ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_incidence_is_the_textbook_formula() {
        assert!((fresnel_dielectric(1.0, 1.5) - 0.04).abs() < 1e-12);
        let (n, k) = (1.5, 7.0);
        let right = ((n - 1.0f64).powi(2) + k * k) / ((n + 1.0f64).powi(2) + k * k);
        assert!((fresnel_conductor(1.0, n, k) - right).abs() < 1e-12);
    }

    #[test]
    fn brewsters_angle_has_no_parallel_part() {
        let brewster = 1.5f64.atan();
        let perpendicular = ((1.5f64 * 1.5 - 1.0) / (1.5 * 1.5 + 1.0)).powi(2);
        assert!((fresnel_dielectric(brewster.cos(), 1.5) - 0.5 * perpendicular).abs() < 1e-12);
    }

    #[test]
    fn a_metal_without_absorption_is_a_dielectric() {
        for cosine in [0.01, 0.3, 0.7, 1.0] {
            assert!((fresnel_conductor(cosine, 1.7, 0.0) - fresnel_dielectric(cosine, 1.7)).abs() < 1e-12);
        }
    }

    #[test]
    fn reflection_is_total_at_grazing_incidence_and_above_the_critical_angle() {
        assert!((fresnel_conductor(0.0, 0.2, 3.0) - 1.0).abs() < 1e-12);
        assert!((fresnel_dielectric(0.0, 1.5) - 1.0).abs() < 1e-12);
        assert_eq!(fresnel_dielectric(0.7, 1.0 / 1.5), 1.0);
    }
}
