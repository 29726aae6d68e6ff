//! Sampling points on a light in proportion to a lobe.
//!
//! The retroreflecting lobe of the paper changes by a factor of 40 across an LED, which uniform
//! sampling by area would turn into noise. The logarithm of a lobe is nearly linear over a small
//! light, so the density follows its gradient: on a disk by a Möbius map of the disk to itself,
//! which preserves stratification and has a closed-form density, and on a parallelogram by
//! truncated exponentials.

use glam::DVec3;

/// Shape of a lobe for sampling points on lights: `height·exp(−width·δ²) + floor`, with δ the angle
/// from `axis` in radians.
#[derive(Clone, Copy, Debug)]
pub struct LobePeak {
    /// Unit vector.
    pub axis: DVec3,
    /// Reciprocal of the squared 1/e half-width, 1/rad².
    pub width: f64,
    /// Height of the lobe, 1/sr.
    pub height: f64,
    /// Constant part, 1/sr.
    pub floor: f64,
    /// The cosine by which the constant part is multiplied.
    pub cosine: ReceiverCosine,
}

/// The cosine between the direction of a light and the normal of a receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReceiverCosine {
    /// There is none, as in mist.
    Unknown,
    /// To this unit normal; light from behind is lost.
    Front(DVec3),
    /// The same, without its sign.
    Both(DVec3),
}

impl ReceiverCosine {
    /// The cosine of a direction, times its length; 1 if it is unknown.
    #[inline]
    pub(crate) fn of(&self, towards: DVec3) -> f64 {
        match self {
            ReceiverCosine::Unknown => 1.0,
            ReceiverCosine::Front(normal) => normal.dot(towards).max(0.0),
            ReceiverCosine::Both(normal) => normal.dot(towards).abs(),
        }
    }

    /// Gradient of its logarithm by the unit direction, at `towards`; `least` is the smallest cosine
    /// that is distinguished, above zero.
    #[inline]
    pub(crate) fn gradient(&self, towards: DVec3, least: f64) -> DVec3 {
        let normal = match self {
            ReceiverCosine::Unknown => return DVec3::ZERO,
            ReceiverCosine::Both(normal) if normal.dot(towards) < 0.0 => -*normal,
            ReceiverCosine::Front(normal) | ReceiverCosine::Both(normal) => *normal,
        };
        let cosine = normal.dot(towards);
        (normal - towards * cosine) / cosine.max(least)
    }
}

/// Largest warp. Beyond it the linear approximation fails, and sampling the lobe itself is better.
const STRONGEST: f64 = 0.72;

impl LobePeak {
    /// A constant lobe.
    pub const NONE: LobePeak =
        LobePeak { axis: DVec3::Z, width: 0.0, height: 0.0, floor: 1.0, cosine: ReceiverCosine::Unknown };

    #[inline]
    pub(crate) fn is_constant(&self) -> bool {
        self.width == 0.0
    }

    /// Gradient of the lobe's logarithm by the unit direction, at `towards`.
    #[inline]
    pub fn gradient(&self, towards: DVec3) -> DVec3 {
        if self.is_constant() {
            return DVec3::ZERO;
        }
        let off = towards - self.axis;
        (off - towards * towards.dot(off)) * (-2.0 * self.width * self.share(towards))
    }

    /// The share of the lobe without its constant part, in a unit direction.
    #[inline]
    pub(crate) fn share(&self, towards: DVec3) -> f64 {
        if self.is_constant() {
            return 0.0;
        }
        if self.floor <= 0.0 {
            return 1.0;
        }
        let highlight = self.height * (-self.width * towards.distance_squared(self.axis)).exp();
        highlight / (highlight + self.floor)
    }
}

/// Möbius map of the unit disk to itself, which moves points to one side; its density has a closed
/// form.
///
/// The parameter t is a vector shorter than one that points to the highest density.
#[derive(Clone, Copy, Debug)]
pub struct DiskWarp {
    x: f64,
    y: f64,
    squared: f64,
}

impl DiskWarp {
    /// The map whose density has this gradient of the logarithm at the centre, per radius.
    #[inline]
    #[must_use]
    pub fn new(x: f64, y: f64) -> DiskWarp {
        if x == 0.0 && y == 0.0 {
            return DiskWarp { x: 0.0, y: 0.0, squared: 0.0 };
        }
        // The logarithm of the density has the gradient 4t per radius.
        let (x, y) = (0.25 * x, 0.25 * y);
        let length = (x * x + y * y).sqrt();
        let scale = if length > STRONGEST { STRONGEST / length } else { 1.0 };
        let (x, y) = (x * scale, y * scale);
        DiskWarp { x, y, squared: x * x + y * y }
    }

    /// Maps a point of the disk: `(z + t)/(1 + t̄·z)` in complex numbers.
    #[inline]
    #[must_use]
    pub fn apply(&self, (a, b): (f64, f64)) -> (f64, f64) {
        if self.squared == 0.0 {
            return (a, b);
        }
        let (top_x, top_y) = (a + self.x, b + self.y);
        let (bottom_x, bottom_y) = (1.0 + self.x * a + self.y * b, self.x * b - self.y * a);
        let scale = 1.0 / (bottom_x * bottom_x + bottom_y * bottom_y);
        ((top_x * bottom_x + top_y * bottom_y) * scale, (top_y * bottom_x - top_x * bottom_y) * scale)
    }

    /// Density at a point, relative to the uniform one: `(1 − t²)²/|1 − t̄·z|⁴`.
    #[inline]
    #[must_use]
    pub fn pdf(&self, (a, b): (f64, f64)) -> f64 {
        if self.squared == 0.0 {
            return 1.0;
        }
        let along = self.x * a + self.y * b;
        let bottom = 1.0 - 2.0 * along + self.squared * (a * a + b * b);
        let ratio = (1.0 - self.squared) / bottom;
        ratio * ratio
    }
}

/// Maps a number of the unit interval to a density proportional to `exp(rate·x)`; returns x and its
/// density.
#[inline]
pub(crate) fn exponential(rate: f64, u: f64) -> (f64, f64) {
    let rate = rate.clamp(-STEEPEST, STEEPEST);
    if rate.abs() < NEARLY_FLAT {
        return (u, 1.0);
    }
    let growth = rate.exp() - 1.0;
    let risen = 1.0 + growth * u;
    (risen.ln() / rate, rate * risen / growth)
}

/// Density of [`exponential`].
#[inline]
pub(crate) fn exponential_pdf(rate: f64, x: f64) -> f64 {
    let rate = rate.clamp(-STEEPEST, STEEPEST);
    if rate.abs() < NEARLY_FLAT { 1.0 } else { rate * (rate * x).exp() / (rate.exp() - 1.0) }
}

/// Rates below this are sampled uniformly, which changes the density by at most .05 %. Above it
/// `exp(rate) − 1` has a relative error below 10⁻¹².
const NEARLY_FLAT: f64 = 1e-3;

/// Largest rate of an exponential over the unit interval.
const STEEPEST: f64 = 5.0;

#[cfg(test)]
mod tests {
    use super::*;
    use radsight_sampling::unit_disk;

    #[test]
    fn samples_of_the_warped_disk_have_the_density_of_pdf() {
        for (x, y) in [(1.8, 0.0), (-0.9, 2.0), (0.0, 30.0), (0.0, 0.0)] {
            let warp = DiskWarp::new(x, y);
            let steps = 400;
            // With weights 1/pdf the mean over samples is the integral: ∫ g = ⟨g/pdf⟩.
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
    fn samples_of_the_exponential_have_the_density_of_pdf() {
        for rate in [-3.0, -1e-9, 0.0, 0.0009, -0.0011, 0.7, 4.0, 50.0] {
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
