//! The part of a glow that is close enough to act as a light source.
//!
//! A glow's radius limits how far its light reaches. Radiance measures the distance to a random
//! point of the glow, which for a round shape lies in its volume: at the limit only some points are
//! in range. This module computes the expected fraction.

use crate::disk_overlap::Overlap;
use crate::form::LightForm;
use crate::light::Light;
use glam::DVec3;
use std::f64::consts::PI;

impl Light {
    /// Fraction, 0…1, of the glow's light that has a receiver within its radius, for the light that
    /// arrives from the point at `distance` along `direction`. For a sphere it is a fraction of the
    /// volume, weighted by inverse squared distance; for a cone or cylinder a fraction of the
    /// cross-section at that point's height. Other shapes are in or out of range point by point.
    #[inline]
    pub fn fraction_in_radius(&self, receiver: DVec3, direction: DVec3, distance: f64) -> f64 {
        let range = self.max_distance;
        if range == f64::INFINITY {
            return 1.0;
        }
        match &self.form {
            LightForm::Sphere { center, radius, .. } => fraction_of_ball(*radius, range, receiver.distance(*center)),
            LightForm::Cone { base, axis, length, radii, .. } => {
                let height = axis.dot(receiver + direction * distance - *base);
                let offset = receiver - (*base + *axis * height);
                let along = offset.dot(*axis);
                let section = range * range - along * along;
                let radius = radii[0] + (radii[1] - radii[0]) * (height / length).clamp(0.0, 1.0);
                fraction_of_disk(radius, section.max(0.0).sqrt(), (offset - *axis * along).length())
            }
            _ if distance <= range => 1.0,
            _ => 0.0,
        }
    }
}

/// Fraction of a ball within `range` of a point at `distance` from its centre, where each volume
/// element counts by its inverse squared distance s. The sphere of radius s about the point has the
/// area `2πs² (1 − (d² + s² − r²) / 2ds)` within the ball, for the ball's radius r and the distance
/// d, and lies wholly within it where `s < r − d`.
fn fraction_of_ball(radius: f64, range: f64, distance: f64) -> f64 {
    if distance + radius <= range {
        return 1.0;
    }
    if distance >= radius + range {
        return 0.0;
    }
    if distance <= LEAST_DISTANCE * radius {
        return range / radius;
    }
    let (nearest, whole) = ((distance - radius).abs(), (radius - distance).max(0.0));
    let antiderivative =
        |s: f64| s - (distance * distance - radius * radius) * s.ln() / (2.0 * distance) - s * s / (4.0 * distance);
    let within = |s: f64| {
        let crossed =
            if s > nearest { antiderivative(s) - antiderivative(nearest.max(f64::MIN_POSITIVE)) } else { 0.0 };
        2.0 * whole.min(s) + crossed
    };
    within(range) / within(distance + radius)
}

/// Distance from the centre, relative to the radius, below which the point counts as the centre.
const LEAST_DISTANCE: f64 = 1e-6;

/// Fraction of a disk's area within `range` of a point of its plane at `distance` from its centre.
fn fraction_of_disk(radius: f64, range: f64, distance: f64) -> f64 {
    match Overlap::new(radius, range, distance) {
        Overlap::None => 0.0,
        Overlap::Whole => 1.0,
        Overlap::Part(overlap) => overlap.area() / (PI * radius * radius),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same fractions by a grid: of a ball, weighted by inverse squared distance, and of a
    /// disk.
    fn counted(radius: f64, range: f64, distance: f64) -> [f64; 2] {
        let steps = 80;
        let height = |step: i32| radius * ((f64::from(step) + 0.5) / f64::from(steps) * 2.0 - 1.0);
        let [mut ball, mut ball_near, mut disk, mut disk_near] = [0.0; 4];
        for (x, y) in (0..steps * steps).map(|step| (height(step % steps), height(step / steps))) {
            for z in (0..steps).map(height).filter(|z| x * x + y * y + z * z < radius * radius) {
                let squared = DVec3::new(x + distance, y, z).length_squared();
                ball += 1.0 / squared;
                ball_near += if squared <= range * range { 1.0 / squared } else { 0.0 };
            }
            if x * x + y * y < radius * radius {
                disk += 1.0;
                disk_near += if (x + distance).hypot(y) <= range { 1.0 } else { 0.0 };
            }
        }
        [ball_near / ball, disk_near / disk]
    }

    #[test]
    fn fractions_in_range_agree_with_a_grid() {
        for (radius, range, distance) in [
            (0.25, 1.5, 1.3),
            (0.25, 1.5, 1.7),
            (0.8, 1.5, 2.2),
            (1.0, 0.4, 0.3),
            (1.0, 0.9, 0.4),
            (0.5, 2.0, 1.4),
            (0.5, 1.0, 1.6),
        ] {
            let [ball, disk] = counted(radius, range, distance);
            // Within the ball the grid is too coarse close to the point, where weights are large.
            let tolerance = if distance < radius { 1e-2 } else { 2e-3 };
            let found = fraction_of_ball(radius, range, distance);
            assert!((found - ball).abs() < tolerance, "ball {radius} {range} {distance}: {found}, counted {ball}");
            let found = fraction_of_disk(radius, range, distance);
            assert!((found - disk).abs() < 5e-3, "disk {radius} {range} {distance}: {found}, counted {disk}");
        }
    }
}
