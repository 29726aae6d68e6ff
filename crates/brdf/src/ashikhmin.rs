//! The anisotropic Phong highlight of Radiance's `ashik2`.
//!
//! Ashikhmin and Shirley, "An Anisotropic Phong BRDF Model", Journal of Graphics Tools 5(2), 2000,
//! eq. 4, with the unit half vector h:
//!
//! `f = ρ_s · √((n_x+1)(n_y+1))/(8π) · h_z^((n_x h_x² + n_y h_y²)/(1−h_z²)) / (h·i · max(i_z,
//! o_z))`
//!
//! Radiance scales ρ_s by Schlick's formula in the outgoing angle alone. The caller applies that
//! factor; without it the model is reciprocal.

use crate::lobe::Lobe;
use crate::{Brdf, BrdfSample, Lobes};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// A highlight with two Phong exponents around the mirror direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AshikhminShirley<const BANDS: usize> {
    /// ρ_s, in each band.
    pub specularity: [f64; BANDS],
    /// n along x and y, at least zero.
    pub exponents: [f64; 2],
}

impl<const BANDS: usize> AshikhminShirley<BANDS> {
    /// `f/ρ_s` in 1/sr, and the density of [`Brdf::sample`] in 1/sr (eq. 8 there: the half vector's
    /// density over `4 h·i`).
    #[inline]
    #[must_use]
    pub fn shape(&self, outgoing: DVec3, incident: DVec3) -> (f64, f64) {
        if outgoing.z <= 0.0 || incident.z <= 0.0 {
            return (0.0, 0.0);
        }
        let Some(half) = (outgoing + incident).try_normalize() else { return (0.0, 0.0) };
        let [n_x, n_y] = self.exponents;
        let off_squared = half.x * half.x + half.y * half.y;
        // ln h_z over 1 − h_z², by the form without cancellation: h_z² = 1 − (h_x² + h_y²).
        let logarithm = if off_squared > 0.5 { half.z.ln() } else { 0.5 * (-off_squared).ln_1p() };
        let slope = if off_squared < 1e-12 { -0.5 } else { logarithm / off_squared };
        let power = ((n_x * half.x * half.x + n_y * half.y * half.y) * slope).exp();
        let peak = ((n_x + 1.0) * (n_y + 1.0)).sqrt() * power / (8.0 * PI * half.dot(incident));
        (peak / incident.z.max(outgoing.z), peak)
    }
}

impl<const BANDS: usize> Lobe<BANDS> for AshikhminShirley<BANDS> {
    fn scale(&self) -> &[f64; BANDS] {
        &self.specularity
    }

    fn shape(&self, outgoing: DVec3, incident: DVec3) -> (f64, f64) {
        AshikhminShirley::shape(self, outgoing, incident)
    }
}

impl<const BANDS: usize> Brdf for AshikhminShirley<BANDS> {
    fn lobes(&self) -> Lobes {
        Lobes { glossy: true, ..Lobes::default() }
    }

    fn eval_pdf(&self, outgoing: DVec3, incident: &[DVec3], values: &mut [f64], pdfs: &mut [f64]) {
        self.eval_lobe(outgoing, incident, values, pdfs);
    }

    fn sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> Option<BrdfSample> {
        let [n_x, n_y] = self.exponents;
        let (sin, cos) = (TAU * u[1]).sin_cos();
        // The azimuth's tangent is scaled by √((n_x+1)/(n_y+1)) (eq. 9 there).
        let (x, y) = ((n_y + 1.0).sqrt() * cos, (n_x + 1.0).sqrt() * sin);
        let scale = x.hypot(y).recip();
        let (x, y) = (x * scale, y * scale);
        let exponent = n_x * x * x + n_y * y * y;
        // 1 − h_z², accurate for narrow lobes.
        let off_squared = -(2.0 * (1.0 - u[0]).ln() / (exponent + 1.0)).exp_m1();
        let off = off_squared.sqrt();
        let half = DVec3::new(x * off, y * off, (1.0 - off_squared).sqrt());
        let incident = half * (2.0 * half.dot(outgoing)) - outgoing;
        self.weigh(outgoing, incident, weights)
    }
}
