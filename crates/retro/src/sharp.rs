//! `sharp`: a flat top and a steep fall-off.
//!
//! The paper's comparison with photographs ends with "a Gaussian does not adequately model the
//! sharp fall-off in the retroreflectance, and … another function should be used" (section 4). A
//! super-Gaussian is the smallest generalisation:
//!
//! `f = ρ_s · C · exp(−ln 2 · (δ/δ_h)ⁿ) / max(cos θ_i, cos θ_o)`
//!
//! | parameter | meaning | unit | range |
//! |---|---|---|---|
//! | ρ_s | fraction of the light returned at normal incidence | 1 | 0…1 |
//! | δ_h | observation angle at which the lobe has half its peak | rad | 1e-5…0.5 |
//! | n | order: 2 is the Gaussian of `gauss_reciprocal`, with α = δ_h/√(4 ln 2); a large one approaches a disk | 1 | 1…64 |
//!
//! C normalises the integral of `f cos θ_i` to ρ_s at normal incidence. The model is reciprocal and
//! conserves energy.

use crate::radial::RadialDensity;
use std::f64::consts::{LN_2, PI, TAU};

/// The shape of the lobe.
#[derive(Clone, Debug)]
pub(crate) struct SharpLobe {
    half_width: f64,
    order: f64,
    /// Normalisation C, 1/sr.
    peak: f64,
    /// Angle at which the lobe ends, radians: it is 1e-16 of its peak there.
    end: f64,
    density: RadialDensity,
}

/// Number of cells of the tabulated density.
const CELLS: u32 = 512;
/// `−ln` of the lobe relative to its peak, at its end.
const END: f64 = 36.8;

impl SharpLobe {
    pub(crate) fn new(half_width: f64, order: f64) -> SharpLobe {
        let shape = |angle: f64| (-LN_2 * (angle / half_width).powf(order)).exp();
        let end = (half_width * (END / LN_2).powf(1.0 / order)).min(PI);
        let angles: Vec<f64> = (0..=CELLS).map(|knot| end * f64::from(knot) / f64::from(CELLS)).collect();
        let peak = 1.0 / integral(shape, end);
        SharpLobe { half_width, order, peak, end, density: RadialDensity::new(&angles, shape) }
    }

    /// `f · max(cos θ_i, cos θ_o) / ρ_s` at observation angle δ, 1/sr.
    pub(crate) fn value(&self, angle: f64) -> f64 {
        if angle > self.end { 0.0 } else { self.peak * (-LN_2 * (angle / self.half_width).powf(self.order)).exp() }
    }

    pub(crate) fn density(&self) -> &RadialDensity {
        &self.density
    }
}

/// `∫ shape dω` up to `end` by Simpson's rule.
fn integral(shape: impl Fn(f64) -> f64, end: f64) -> f64 {
    let steps = 8 * CELLS;
    let width = end / f64::from(steps);
    let sum: f64 = (0..=steps)
        .map(|step| {
            let angle = f64::from(step) * width;
            let weight = if step == 0 || step == steps { 1.0 } else { f64::from(2 + 2 * (step % 2)) };
            weight * shape(angle) * TAU * angle.sin()
        })
        .sum();
    sum * width / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_two_is_the_gaussian_of_the_paper() {
        let alpha = 0.00612;
        let lobe = SharpLobe::new(alpha * (4.0 * LN_2).sqrt(), 2.0);
        let sheet = crate::Paper1991 { reflectance: [1.0], spread: alpha };
        for angle in [0.0, 0.003, 0.0122, 0.03] {
            let (found, expected) = (lobe.value(angle), sheet.reflected_density(angle));
            // The paper's lobe is normalised in the plane, this one on the sphere: 1 + 2α²/3.
            assert!((found / expected - 1.0).abs() < 2.0 * alpha * alpha, "δ = {angle}: {found} against {expected}");
        }
    }

    #[test]
    fn half_of_the_peak_is_at_the_half_width_and_the_top_is_flat() {
        let lobe = SharpLobe::new(0.01, 12.0);
        assert!((lobe.value(0.01) / lobe.value(0.0) - 0.5).abs() < 1e-12);
        assert!(lobe.value(0.007) / lobe.value(0.0) > 0.98);
        assert!(lobe.value(0.013) / lobe.value(0.0) < 1e-6);
    }

    #[test]
    fn a_steep_lobe_is_a_disk() {
        let lobe = SharpLobe::new(0.01, 64.0);
        // Γ(1 + 2/n)/(ln 2)^(2/n) = .9935 of the disk's area at n = 64.
        assert!((lobe.value(0.0) * PI * 1e-4 - 1.0).abs() < 0.02, "{}", lobe.value(0.0) * PI * 1e-4);
    }
}
