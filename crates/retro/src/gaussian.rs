//! The Gaussian lobe of Rushmeier, Parker and Lee, "Physically Accurate Synthetic Images for
//! Computer Vision System Design", GIT-GVU-91-25, 1991, eq. 6, and a reciprocal form of it.
//!
//! | parameter | meaning | unit | range |
//! |---|---|---|---|
//! | `reflectance` | ρ_s: fraction of the light that the lobe returns, each band | 1 | 0…1 |
//! | `spread` | α: the lobe falls to 1/e at δ = 2α | rad | above 0 |

use glam::DVec3;
use radsight_brdf::{Brdf, BrdfSample, Density, Lobes};
use std::f64::consts::{PI, TAU};

/// Eq. 6 verbatim: `f = ρ_s · exp(−δ²/4α²) / (4πα² cos θ_i)`. It is not reciprocal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paper1991<const BANDS: usize> {
    /// ρ_s.
    pub reflectance: [f64; BANDS],
    /// α, radians.
    pub spread: f64,
}

/// The same lobe in a reciprocal form: `f = ρ_s · exp(−δ²/4α²) / (4πα² max(cos θ_i, cos θ_o))`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReciprocalGaussian<const BANDS: usize> {
    /// ρ_s.
    pub reflectance: [f64; BANDS],
    /// α, radians.
    pub spread: f64,
}

/// δ: the angle between two unit directions, radians, accurate for small angles.
#[inline]
#[must_use]
pub fn observation_angle(outgoing: DVec3, incident: DVec3) -> f64 {
    2.0 * (0.5 * outgoing.distance(incident)).min(1.0).asin()
}

/// `exp(−δ²/4α²)/(4πα²)`: the lobe in 1/sr for ρ_s = 1, times the cosine in eq. 6's denominator.
#[inline]
fn lobe(spread: f64, angle: f64) -> f64 {
    let width = 4.0 * spread * spread;
    (-angle * angle / width).exp() / (PI * width)
}

/// Density of [`sample_lobe`] by solid angle: the density of δ, `δ/(2α²)·exp(−δ²/4α²)`, over the
/// circumference `2π sin δ`.
#[inline]
fn density(spread: f64, angle: f64) -> f64 {
    lobe(spread, angle) * if angle > 1e-4 { angle / angle.sin() } else { 1.0 + angle * angle / 6.0 }
}

/// Samples a direction at angle δ from `outgoing`, with δ² exponential of mean 4α².
pub(crate) fn sample_lobe(spread: f64, outgoing: DVec3, u: f64, v: f64) -> Option<(DVec3, f64)> {
    let angle = 2.0 * spread * (-(1.0 - u).ln()).sqrt();
    if angle >= PI {
        return None;
    }
    let (x, y) = outgoing.any_orthonormal_pair();
    let (sin, cos) = angle.sin_cos();
    let (sin_azimuth, cos_azimuth) = (TAU * v).sin_cos();
    Some((outgoing * cos + (x * cos_azimuth + y * sin_azimuth) * sin, angle))
}

impl<const BANDS: usize> Paper1991<BANDS> {
    /// `f·cos θ_i / ρ_s` at observation angle δ in radians, 1/sr.
    #[inline]
    #[must_use]
    pub fn reflected_density(&self, observation_angle: f64) -> f64 {
        lobe(self.spread, observation_angle)
    }

    /// Sampling density at observation angle δ, 1/sr.
    #[inline]
    #[must_use]
    pub fn sampling_density(&self, observation_angle: f64) -> f64 {
        density(self.spread, observation_angle)
    }
}

macro_rules! gaussian_brdf {
    ($model:ident, $cosine:expr) => {
        impl<const BANDS: usize> Brdf for $model<BANDS> {
            fn lobes(&self) -> Lobes {
                Lobes { glossy: true, ..Lobes::default() }
            }

            fn eval_pdf(&self, outgoing: DVec3, incident: &[DVec3], values: &mut [f64], pdfs: &mut [f64]) {
                for ((direction, value), pdf) in incident.iter().zip(values.chunks_exact_mut(BANDS)).zip(pdfs) {
                    let lit = outgoing.z > 0.0 && direction.z > 0.0;
                    let angle = observation_angle(outgoing, *direction);
                    *pdf = if lit { density(self.spread, angle) } else { 0.0 };
                    let cosine: f64 = $cosine(outgoing.z, direction.z);
                    let shape = if lit { lobe(self.spread, angle) / cosine } else { 0.0 };
                    for (value, reflectance) in value.iter_mut().zip(self.reflectance) {
                        *value = reflectance * shape;
                    }
                }
            }

            fn sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> Option<BrdfSample> {
                let (incident, angle) = sample_lobe(self.spread, outgoing, u[0], u[1])?;
                if outgoing.z <= 0.0 || incident.z <= 0.0 {
                    return None;
                }
                let pdf = density(self.spread, angle);
                let cosine: f64 = $cosine(outgoing.z, incident.z);
                let weight = lobe(self.spread, angle) / cosine * incident.z / pdf;
                for (weight_band, reflectance) in weights.iter_mut().zip(self.reflectance) {
                    *weight_band = reflectance * weight;
                }
                Some(BrdfSample { incident, density: Density::Continuous(pdf) })
            }
        }
    };
}

gaussian_brdf!(Paper1991, |_outgoing: f64, incident: f64| incident);
gaussian_brdf!(ReciprocalGaussian, |outgoing: f64, incident: f64| outgoing.max(incident));

#[cfg(test)]
mod tests {
    use super::*;

    fn value(model: &dyn Brdf, outgoing: DVec3, incident: DVec3) -> f64 {
        let (mut value, mut pdf) = ([0.0], [0.0]);
        model.eval_pdf(outgoing, &[incident], &mut value, &mut pdf);
        value[0]
    }

    fn tilted(angle: f64) -> DVec3 {
        DVec3::new(angle.sin(), 0.0, angle.cos())
    }

    #[test]
    fn retro_peak_is_at_zero_observation_angle() {
        let sheet = Paper1991 { reflectance: [0.086], spread: 0.00612 };
        let outgoing = tilted(0.4);
        let peak = value(&sheet, outgoing, outgoing);
        for off in [1e-4, 1e-3, 0.01] {
            assert!(value(&sheet, outgoing, tilted(0.4 + off)) < peak);
            assert!(value(&sheet, outgoing, tilted(0.4 - off)) < peak);
        }
    }

    #[test]
    fn the_lobe_has_the_numbers_of_equation_6() {
        let sheet = Paper1991 { reflectance: [0.086], spread: 0.00612 };
        let (incidence, delta) = (0.3f64, 0.0265f64);
        let expected = 0.086 * (-delta * delta / (4.0 * 0.00612 * 0.00612)).exp()
            / (4.0 * PI * 0.00612 * 0.00612 * incidence.cos());
        let found = value(&sheet, tilted(incidence + delta), tilted(incidence));
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} against {expected}");
    }

    #[test]
    fn the_lobe_returns_rho() {
        // ∫ f cos θ_i dω over the lobe, by quadrature in δ.
        for spread in [0.0005, 0.00612, 0.05] {
            let (steps, widest) = (200_000, 16.0 * spread);
            let width = widest / f64::from(steps);
            let sum: f64 = (0..steps)
                .map(|step| (f64::from(step) + 0.5) * width)
                .map(|angle| lobe(spread, angle) * TAU * angle.sin() * width)
                .sum();
            assert!((sum - 1.0).abs() < 2.0 * spread * spread + 1e-6, "α = {spread}: {sum}");
        }
    }

    #[test]
    fn the_density_integrates_to_one() {
        let (spread, steps) = (0.02, 100_000);
        let width = 20.0 * spread / f64::from(steps);
        let sum: f64 = (0..steps)
            .map(|step| (f64::from(step) + 0.5) * width)
            .map(|angle| density(spread, angle) * TAU * angle.sin() * width)
            .sum();
        assert!((sum - 1.0).abs() < 1e-7, "{sum}");
    }

    #[test]
    fn the_reciprocal_form_is_reciprocal_and_the_paper_s_is_not() {
        let (a, b) = (tilted(1.0), tilted(1.01));
        let fair = ReciprocalGaussian { reflectance: [0.5], spread: 0.01 };
        assert!((value(&fair, a, b) / value(&fair, b, a) - 1.0).abs() < 1e-12);
        let verbatim = Paper1991 { reflectance: [0.5], spread: 0.01 };
        assert!((value(&verbatim, a, b) / value(&verbatim, b, a) - 1.0).abs() > 1e-3);
    }

    #[test]
    fn small_observation_angles_are_accurate() {
        let tiny = 1e-7;
        let angle = observation_angle(tilted(0.7), tilted(0.7 + tiny));
        assert!((angle / tiny - 1.0).abs() < 1e-8, "{angle}");
    }

    #[test]
    fn sample_weights_agree_with_value_and_density() {
        let sheet = Paper1991 { reflectance: [0.086], spread: 0.00612 };
        let outgoing = tilted(0.8);
        for step in 0..50 {
            let u = f64::from(step) / 50.0;
            let mut weight = [0.0];
            let sample = sheet.sample(outgoing, [u, 0.37, 0.0], &mut weight).unwrap();
            let (mut f, mut pdf) = ([0.0], [0.0]);
            sheet.eval_pdf(outgoing, &[sample.incident], &mut f, &mut pdf);
            let Density::Continuous(density) = sample.density else { panic!("not a delta lobe") };
            // The angle of a sampled direction has the rounding error 1e-16 over δ.
            assert!((density / pdf[0] - 1.0).abs() < 1e-6);
            assert!((weight[0] / (f[0] * sample.incident.z / pdf[0]) - 1.0).abs() < 1e-6);
        }
    }
}
