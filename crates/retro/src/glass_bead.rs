//! `glass_bead`: G. Ward's fit to a ray simulation of glass beads, distributed with Radiance as
//! `retrorefl.cal` (2002).
//!
//! `f = R · m(δ) · e(θ_i) / max(cos θ_i, cos 89.5°)`
//!
//! | parameter | meaning | unit | range |
//! |---|---|---|---|
//! | R | coefficient of retroreflection at normal incidence and an observation angle of 0.5° | cd/(lx m²) | 0…5000 |
//! | binder | `sheet`: e falls with the entrance angle as measured on a sheet; `paint`: e = 1 | | |
//!
//! With δ and θ_i in degrees, `m = 1 + 3 cos(180° δ)` below 0.5°, `0.07/sin(7.6 δ) + 0.02` up to
//! 20°, `0.157/(δ − 19)` above, and `e = exp(−θ_i²/2220)`. The values equal those of a `metfunc`
//! with the file to all digits. The model is therefore not reciprocal, and since its tail spans the
//! hemisphere it does not conserve energy for large R ([`GlassBead::albedo`]).

use crate::radial::{RadialDensity, logarithmic_angles};
use std::f64::consts::{PI, TAU};

/// Dependence of the coefficient on the entrance angle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Binder {
    /// Falls as measured on 3M's sheet.
    #[default]
    Sheet,
    /// None: beads on paint.
    Paint,
}

/// The lobe.
#[derive(Clone, Debug)]
pub(crate) struct GlassBead {
    coefficient: f64,
    binder: Binder,
    density: RadialDensity,
}

/// Angles at which the parts of the fit meet, degrees.
const JOINTS_DEG: [f64; 2] = [0.5, 20.0];

/// `m`: coefficient at observation angle δ (radians), relative to the one at 0.5°.
#[must_use]
pub fn observation_factor(angle: f64) -> f64 {
    let degrees = angle.to_degrees();
    if degrees < JOINTS_DEG[0] {
        (PI / 2.0 / 0.5 * degrees).cos() * 3.0 + 1.0
    } else if degrees < JOINTS_DEG[1] {
        0.07 / (7.6 * PI / 180.0 * degrees).sin() + 0.02
    } else {
        0.157 / (degrees - 19.0)
    }
}

/// `e`: coefficient at entrance angle θ (radians), relative to normal incidence.
#[must_use]
pub fn entrance_factor(angle: f64) -> f64 {
    let degrees = angle.to_degrees();
    (-degrees * degrees / 2220.0).exp()
}

impl GlassBead {
    pub(crate) fn new(coefficient: f64, binder: Binder) -> GlassBead {
        let angles = logarithmic_angles(2e-4, 60, &JOINTS_DEG.map(f64::to_radians));
        GlassBead { coefficient, binder, density: RadialDensity::new(&angles, observation_factor) }
    }

    /// f in 1/sr at observation angle δ (radians), for the cosine of the entrance angle.
    pub(crate) fn value(&self, angle: f64, incident_cosine: f64) -> f64 {
        // Radiance's lower limit: cos 89.5°.
        let cosine = incident_cosine.max((89.5 * PI / 180.0).cos());
        let entrance = match self.binder {
            Binder::Sheet => entrance_factor(cosine.min(1.0).acos()),
            Binder::Paint => 1.0,
        };
        self.coefficient * observation_factor(angle) * entrance / cosine
    }

    /// Albedo at normal incidence.
    pub(crate) fn albedo(&self) -> f64 {
        let steps = 20_000;
        let width = 0.5 * PI / f64::from(steps);
        let sum: f64 = (0..steps)
            .map(|step| (f64::from(step) + 0.5) * width)
            .map(|angle| observation_factor(angle) * entrance_of(self.binder, angle) * angle.sin() * width)
            .sum();
        TAU * self.coefficient * sum
    }

    pub(crate) fn density(&self) -> &RadialDensity {
        &self.density
    }
}

fn entrance_of(binder: Binder, angle: f64) -> f64 {
    if binder == Binder::Sheet { entrance_factor(angle) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fit_is_relative_to_half_a_degree() {
        assert!((observation_factor(0.0) - 4.0).abs() < 1e-12);
        assert!((observation_factor(0.25f64.to_radians()) - (1.0 + 3.0 * (PI / 4.0).cos())).abs() < 1e-12);
        // 0.07/sin 7.6° + 0.02.
        assert!((observation_factor(1f64.to_radians()) - 0.549_27).abs() < 1e-4);
        assert!((observation_factor(29f64.to_radians()) - 0.0157).abs() < 1e-12);
    }
}
