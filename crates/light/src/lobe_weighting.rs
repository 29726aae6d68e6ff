//! Drawing places on a light where the highlight is bright.
//!
//! The retroreflecting lobe of the paper changes by a factor of 40 from one side of an LED to the other. Places that are uniform by area would
//! meet all of that as noise. The logarithm of a highlight is nearly linear over a small light, so places are drawn with a density that
//! grows along its gradient: in a disk by a Möbius map of the disk to itself, which keeps strata whole and has a density in closed form, in a
//! parallelogram by truncated exponentials.

use glam::DVec3;

/// A highlight, as far as the drawing of places needs it: `height·exp(−width·δ²) + floor`, δ the angle from `axis`.
#[derive(Clone, Copy, Debug)]
pub struct LobePeak {
    /// Unit.
    pub axis: DVec3,
    /// 1/rad².
    pub width: f64,
    /// 1/sr.
    pub height: f64,
    /// The part without a direction, 1/sr.
    pub floor: f64,
}

/// No tilt is stronger: beyond it the linear picture fails, and sampling the highlight itself does better.
const STRONGEST: f64 = 0.72;

impl LobePeak {
    /// Nothing to follow.
    pub const NONE: LobePeak = LobePeak { axis: DVec3::Z, width: 0.0, height: 0.0, floor: 1.0 };

    /// Gradient of the logarithm of the highlight by the unit direction, at `towards`.
    #[inline]
    pub fn gradient(&self, towards: DVec3) -> DVec3 {
        if self.width == 0.0 {
            return DVec3::ZERO;
        }
        let off = towards - self.axis;
        let share = if self.floor > 0.0 {
            let highlight = self.height * (-self.width * off.length_squared()).exp();
            highlight / (highlight + self.floor)
        } else {
            1.0
        };
        (off - towards * towards.dot(off)) * (-2.0 * self.width * share)
    }
}

/// A map of the unit disk to itself that gathers points on one side, with its density in closed form.
///
/// It is a Möbius map; its tilt is a vector shorter than one, towards where the density is highest.
#[derive(Clone, Copy, Debug)]
pub struct DiskWarp {
    x: f64,
    y: f64,
    squared: f64,
}

impl DiskWarp {
    /// The map whose density follows a gradient of the logarithm, per radius, at the centre.
    #[inline]
    #[must_use]
    pub fn new(x: f64, y: f64) -> DiskWarp {
        // The logarithm of the density grows by four times the tilt per radius.
        let (x, y) = (0.25 * x, 0.25 * y);
        let length = (x * x + y * y).sqrt();
        let scale = if length > STRONGEST { STRONGEST / length } else { 1.0 };
        let (x, y) = (x * scale, y * scale);
        DiskWarp { x, y, squared: x * x + y * y }
    }

    /// Where a point of the disk goes: `(z + t)/(1 + t̄·z)` in complex numbers.
    #[inline]
    #[must_use]
    pub fn apply(&self, (a, b): (f64, f64)) -> (f64, f64) {
        let (top_x, top_y) = (a + self.x, b + self.y);
        let (bottom_x, bottom_y) = (1.0 + self.x * a + self.y * b, self.x * b - self.y * a);
        let scale = 1.0 / (bottom_x * bottom_x + bottom_y * bottom_y);
        ((top_x * bottom_x + top_y * bottom_y) * scale, (top_y * bottom_x - top_x * bottom_y) * scale)
    }

    /// Density at a point, as a multiple of the uniform one: `(1 − t²)²/|1 − t̄·z|⁴`.
    #[inline]
    #[must_use]
    pub fn pdf(&self, (a, b): (f64, f64)) -> f64 {
        let along = self.x * a + self.y * b;
        let bottom = 1.0 - 2.0 * along + self.squared * (a * a + b * b);
        let ratio = (1.0 - self.squared) / bottom;
        ratio * ratio
    }
}

/// A point of the unit interval with density in proportion to `exp(rate·x)`, and that density.
#[inline]
pub(crate) fn exponential(rate: f64, u: f64) -> (f64, f64) {
    let rate = rate.clamp(-STEEPEST, STEEPEST);
    let x = if rate.abs() < 1e-6 { u } else { ((rate.exp_m1()) * u).ln_1p() / rate };
    (x, exponential_pdf(rate, x))
}

/// The density of [`exponential`].
#[inline]
pub(crate) fn exponential_pdf(rate: f64, x: f64) -> f64 {
    let rate = rate.clamp(-STEEPEST, STEEPEST);
    if rate.abs() < 1e-6 { 1.0 } else { rate * (rate * x).exp() / rate.exp_m1() }
}

/// No exponential is steeper over the unit interval.
const STEEPEST: f64 = 5.0;

#[cfg(test)]
mod tests {
    use super::*;
    use radsight_sampling::unit_disk;

    #[test]
    fn the_tilted_disk_has_the_density_that_it_claims() {
        for (x, y) in [(1.8, 0.0), (-0.9, 2.0), (0.0, 30.0), (0.0, 0.0)] {
            let warp = DiskWarp::new(x, y);
            let steps = 400;
            // The mean of 1/density over drawn points is one, and so it is with weights: ∫ g = ⟨g/density⟩.
            let (mut ones, mut moment) = (0.0, 0.0);
            for i in 0..steps {
                for j in 0..steps {
                    let at = |k: i32| (f64::from(k) + 0.5) / f64::from(steps);
                    let point = warp.apply(unit_disk(at(i), at(j)));
                    assert!(point.0.hypot(point.1) <= 1.0 + 1e-9);
                    ones += 1.0 / warp.pdf(point);
                    moment += (point.0 * point.0 + 0.3 * point.1) / warp.pdf(point);
                }
            }
            let count = f64::from(steps * steps);
            assert!((ones / count - 1.0).abs() < 2e-3, "{x} {y}: {}", ones / count);
            assert!((moment / count - 0.25).abs() < 2e-3, "{x} {y}: {}", moment / count);
        }
    }

    #[test]
    fn the_exponential_has_the_density_that_it_claims() {
        for rate in [-3.0, -1e-9, 0.0, 0.7, 4.0, 50.0] {
            let steps = 100_000;
            let (mut ones, mut moment) = (0.0, 0.0);
            for step in 0..steps {
                let (x, pdf) = exponential(rate, (f64::from(step) + 0.5) / f64::from(steps));
                assert!((pdf / exponential_pdf(rate, x) - 1.0).abs() < 1e-9);
                ones += 1.0 / pdf;
                moment += x / pdf;
            }
            assert!((ones / f64::from(steps) - 1.0).abs() < 1e-3);
            assert!((moment / f64::from(steps) - 0.5).abs() < 1e-3);
        }
    }
}
