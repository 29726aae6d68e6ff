//! The visible part of a cylinder's or cone's side, for sampling points on it.
//!
//! Let `R` be the radius that the cone would have at the point's height, `D` the distance of the
//! point from the axis, and φ the azimuth about the axis from the point. The side is visible where
//! `D·cos φ > R`, which is the same range of φ over the whole length. From afar the contribution is
//! uniform in `sin φ`, so `sin φ` is sampled uniformly.

use glam::DVec3;
use radsight_ir::Facing;
use std::f64::consts::{PI, TAU};

/// Range of azimuth in which the side is visible.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VisibleSide {
    /// Unit vectors perpendicular to the axis: to the middle of the range, and at a right angle to
    /// it.
    middle: DVec3,
    beside: DVec3,
    spread: VisibleRange,
}

/// Distribution of the azimuth.
#[derive(Clone, Copy, Debug)]
enum VisibleRange {
    /// Uniform in its sine, up to this value.
    Sine(f64),
    /// Uniform, up to this angle in radians.
    Turn(f64),
}

impl VisibleSide {
    /// Visible range for `receiver`, a point relative to the centre of the base; `axis` is a unit
    /// vector, `slope` the growth of the radius per height. `None` if nothing is visible.
    pub(crate) fn new(
        receiver: DVec3,
        axis: DVec3,
        (base_radius, slope): (f64, f64),
        facing: Facing,
    ) -> Option<VisibleSide> {
        let height = receiver.dot(axis);
        let from_axis = receiver - axis * height;
        let distance = from_axis.length();
        let radius = base_radius + slope * height;
        let towards = if distance > 0.0 { from_axis / distance } else { axis.any_orthonormal_vector() };
        let widest = if radius.abs() < distance {
            (radius / distance).acos()
        } else if radius > 0.0 {
            0.0
        } else {
            PI
        };
        let (middle, spread) = match facing {
            Facing::Outward if radius >= 0.0 => (towards, VisibleRange::Sine(widest.sin())),
            Facing::Outward => (towards, VisibleRange::Turn(widest)),
            Facing::Inward => (-towards, VisibleRange::Turn(PI - widest)),
        };
        let (VisibleRange::Sine(most) | VisibleRange::Turn(most)) = spread;
        (most > 0.0).then(|| VisibleSide { middle, beside: axis.cross(middle), spread })
    }

    /// Samples an azimuth: the unit direction from the axis to the point, and its density relative
    /// to the uniform one over the whole side.
    pub(crate) fn sample(&self, v: f64) -> (DVec3, f64) {
        let share = 2.0 * v - 1.0;
        let (sin, cos) = match self.spread {
            VisibleRange::Sine(most) => (share * most, (1.0 - (share * most).powi(2)).sqrt()),
            VisibleRange::Turn(most) => (share * most).sin_cos(),
        };
        (self.middle * cos + self.beside * sin, self.pdf_at(cos))
    }

    /// Relative density of the point in this unit direction from the axis.
    pub(crate) fn pdf(&self, from_axis: DVec3) -> f64 {
        self.pdf_at(from_axis.dot(self.middle))
    }

    fn pdf_at(&self, cos: f64) -> f64 {
        match self.spread {
            VisibleRange::Sine(most) => TAU * cos.max(0.0) / (2.0 * most),
            VisibleRange::Turn(most) => PI / most,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sampled_points_are_visible_and_have_the_density_of_pdf() {
        let axis = DVec3::Z;
        for (base_radius, slope) in [(0.5, 0.0), (0.3, 0.4), (0.3, -0.4)] {
            for facing in [Facing::Outward, Facing::Inward] {
                for receiver in [DVec3::new(1.0, 0.4, 0.3), DVec3::new(0.2, -0.1, 0.5), DVec3::new(0.3, 0.2, 2.0)] {
                    let radius_there = base_radius + slope * receiver.z;
                    let is_seen = |turn: f64| {
                        let shown = receiver.x * turn.cos() + receiver.y * turn.sin() - radius_there;
                        if facing == Facing::Outward { shown > 0.0 } else { shown < 0.0 }
                    };
                    let steps = 20_000;
                    let at = |step: u32| (f64::from(step) + 0.5) / f64::from(steps);
                    let expected: f64 = (0..steps)
                        .map(|step| TAU * at(step))
                        .filter(|turn| is_seen(*turn))
                        .map(|turn| (2.0 + turn.sin()) / f64::from(steps))
                        .sum();
                    let found = match VisibleSide::new(receiver, axis, (base_radius, slope), facing) {
                        None => 0.0,
                        Some(side) => (0..steps)
                            .map(|step| {
                                let (from_axis, pdf) = side.sample(at(step));
                                assert!((side.pdf(from_axis) / pdf - 1.0).abs() < 1e-9);
                                (2.0 + from_axis.y) / (pdf * f64::from(steps))
                            })
                            .sum(),
                    };
                    assert!((found - expected).abs() < 2e-3, "{receiver} {facing:?}: {found}, expected {expected}");
                }
            }
        }
    }
}
