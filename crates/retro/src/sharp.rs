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
//! | ρ_s | fraction of the light returned at normal incidence by a narrow lobe | 1 | 0…1 |
//! | δ_h | observation angle at which the lobe has half its peak | rad | 1e-5…0.5 |
//! | n | order: 2 is the Gaussian of `gauss_reciprocal`, with α = δ_h/√(4 ln 2); a large one approaches a disk | 1 | 1…64 |
//!
//! C is the inverse of the integral of the exponential over all directions, without a cosine. At
//! normal incidence the sheet returns `ρ_s · ∫ exp(…) cos δ dω / ∫ exp(…) dω`. That is ρ_s for narrow
//! lobes (.9997 ρ_s for δ_h = 0.02 and n = 2) and less for wide ones (.993 ρ_s for δ_h = 0.1, .84 ρ_s
//! for δ_h = 0.5). At every incidence it returns at most ρ_s. With the cosine in C a wide lobe of order
//! 1 would return more light at oblique incidence than it receives.
//!
//! The model is reciprocal and conserves energy.

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

    /// The fraction of the light from an angle to the normal that a lobe with ρ_s = 1 returns.
    fn returned(lobe: &SharpLobe, incidence: f64) -> f64 {
        const STEPS: u32 = 400;
        let cell = |index: u32, extent: f64| (f64::from(index) + 0.5) * extent / f64::from(STEPS);
        let at = |[polar, azimuth]: [f64; 2]| {
            let [cos_in, cos_out] = [incidence.cos(), polar.cos()];
            let cos = cos_in * cos_out + incidence.sin() * polar.sin() * azimuth.cos();
            lobe.value(cos.clamp(-1.0, 1.0).acos()) * cos_out / cos_in.max(cos_out) * polar.sin()
        };
        let cells = (0..STEPS).flat_map(|row| (0..STEPS).map(move |column| [cell(row, 0.5 * PI), cell(column, TAU)]));
        cells.map(at).sum::<f64>() * 0.5 * PI * TAU / f64::from(STEPS * STEPS)
    }

    #[test]
    fn a_wide_lobe_returns_less_than_its_share_at_any_incidence() {
        let cases = [(0.5, 1.0, 0.542), (0.5, 2.0, 0.840), (0.3, 2.0, 0.938), (0.5, 6.0, 0.931), (0.1, 2.0, 0.993)];
        for (half_width, order, at_normal) in cases {
            let lobe = SharpLobe::new(half_width, order);
            let found = returned(&lobe, 0.0);
            assert!((found - at_normal).abs() < 0.002, "{half_width} {order}: {found}");
            for degrees in [20.0_f64, 45.0, 70.0, 85.0] {
                let found = returned(&lobe, degrees.to_radians());
                assert!(found < 1.0, "{half_width} {order}, {degrees}°: {found}");
            }
        }
    }

    #[test]
    fn with_the_cosine_a_lobe_would_return_more_light_than_it_receives() {
        let lobe = SharpLobe::new(0.5, 1.0);
        assert!(returned(&lobe, 45.0_f64.to_radians()) > 1.01 * returned(&lobe, 0.0));
    }

    #[test]
    fn a_steep_lobe_is_a_disk() {
        let lobe = SharpLobe::new(0.01, 64.0);
        // Γ(1 + 2/n)/(ln 2)^(2/n) = .9935 of the disk's area at n = 64.
        assert!((lobe.value(0.0) * PI * 1e-4 - 1.0).abs() < 0.02, "{}", lobe.value(0.0) * PI * 1e-4);
    }
}
