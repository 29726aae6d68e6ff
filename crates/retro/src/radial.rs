//! Sampling of a lobe that depends on the observation angle alone.
//!
//! The density is piecewise linear in `1 − cos δ`, in which solid angle is uniform:
//! `dω = 2π d(1 − cos δ)`. Its integral is quadratic in each cell and inverted in closed form, so
//! that the density of the samples is exact.

use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// A density about the retroreflection direction, 1/sr, with integral one over the sphere.
#[derive(Clone, Debug)]
pub(crate) struct RadialDensity {
    /// `1 − cos δ` of the knots, ascending from 0.
    falls: Vec<f64>,
    /// Density at the knots, 1/sr.
    densities: Vec<f64>,
    /// Cumulative probability before each knot.
    cumulative: Vec<f64>,
}

/// `1 − cos δ`, accurate for small angles.
#[inline]
pub(crate) fn fall_of(angle: f64) -> f64 {
    let sin = (0.5 * angle).sin();
    2.0 * sin * sin
}

impl RadialDensity {
    /// Density proportional to `shape`, which is evaluated at the ascending `angles` (radians, from
    /// 0 to at most π). A jump of the shape takes two adjacent knots. At least two angles must
    /// differ, and the shape must be positive at one of them.
    pub(crate) fn new(angles: &[f64], shape: impl Fn(f64) -> f64) -> RadialDensity {
        let falls: Vec<f64> = angles.iter().map(|angle| fall_of(*angle)).collect();
        let mut densities: Vec<f64> = angles.iter().map(|angle| shape(*angle).max(0.0)).collect();
        let mut cumulative = vec![0.0];
        for cell in 1..falls.len() {
            let mass = PI * (falls[cell] - falls[cell - 1]) * (densities[cell] + densities[cell - 1]);
            cumulative.push(cumulative[cell - 1] + mass);
        }
        let total = cumulative[cumulative.len() - 1];
        densities.iter_mut().chain(&mut cumulative).for_each(|number| *number /= total);
        RadialDensity { falls, densities, cumulative }
    }

    /// Density at a chord `|o − i|` of the unit sphere, 1/sr; `1 − cos δ` is half its square.
    #[inline]
    pub(crate) fn at_chord(&self, chord_squared: f64) -> f64 {
        let fall = 0.5 * chord_squared;
        let after = self.falls.partition_point(|knot| *knot <= fall);
        if after == 0 || after == self.falls.len() {
            return 0.0;
        }
        let (low, high) = (self.falls[after - 1], self.falls[after]);
        let share = (fall - low) / (high - low);
        self.densities[after - 1] + share * (self.densities[after] - self.densities[after - 1])
    }

    /// Samples a direction about `axis`.
    pub(crate) fn sample(&self, axis: DVec3, u: [f64; 2]) -> DVec3 {
        let last = self.cumulative.len() - 1;
        let after = self.cumulative.partition_point(|below| *below <= u[0]).clamp(1, last);
        let (low, high) = (self.densities[after - 1], self.densities[after]);
        let mass = self.cumulative[after] - self.cumulative[after - 1];
        let left = ((u[0] - self.cumulative[after - 1]) / mass).clamp(0.0, 1.0);
        let root = (low * low + left * (high * high - low * low)).max(0.0).sqrt();
        let share = if low + root > 0.0 { left * (low + high) / (low + root) } else { 1.0 };
        let fall = self.falls[after - 1] + share * (self.falls[after] - self.falls[after - 1]);
        direction_near(axis, 2.0 * (0.5 * fall).sqrt().min(1.0).asin(), TAU * u[1])
    }
}

/// Unit vector at `angle` radians from the unit vector `axis`.
pub(crate) fn direction_near(axis: DVec3, angle: f64, azimuth: f64) -> DVec3 {
    let (x, y) = axis.any_orthonormal_pair();
    let ((sin, cos), (sin_azimuth, cos_azimuth)) = (angle.sin_cos(), azimuth.sin_cos());
    ((x * cos_azimuth + y * sin_azimuth) * sin + axis * cos).normalize()
}

/// Angles from 0 to π: `per_decade` of them per decade above `least` (radians), and one on either
/// side of each jump.
pub(crate) fn logarithmic_angles(least: f64, per_decade: u32, jumps: &[f64]) -> Vec<f64> {
    let step = (10f64).powf(1.0 / f64::from(per_decade));
    let rising = std::iter::successors(Some(least), |angle| Some(angle * step)).take_while(|angle| *angle < PI);
    let mut angles: Vec<f64> = std::iter::once(0.0).chain(rising).chain([PI]).collect();
    angles.extend(jumps.iter().flat_map(|jump| [jump * (1.0 - 1e-9), jump * (1.0 + 1e-9)]));
    angles.sort_by(f64::total_cmp);
    angles
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_have_the_density_of_at_chord() {
        // Equal intervals of u have equal probability, whatever the shape.
        let lobe = RadialDensity::new(&[0.0, 0.01, 0.02, 0.3, PI], |angle| if angle < 0.05 { 2.0 } else { 0.1 });
        let axis = DVec3::Z;
        let angle = |u: f64| lobe.sample(axis, [u, 0.3]).distance(axis);
        for step in 1..99 {
            let u = f64::from(step) / 100.0;
            let (low, high) = (angle(u - 1e-4), angle(u + 1e-4));
            let solid_angle = PI * (high * high - low * low);
            let density = lobe.at_chord(angle(u).powi(2));
            assert!(
                (2e-4 / solid_angle / density - 1.0).abs() < 2e-3,
                "u = {u}: {} against {density}",
                2e-4 / solid_angle
            );
        }
    }
}
