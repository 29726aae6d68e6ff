//! How much of a glow is near enough to be a light.
//!
//! A glow's radius says how far its light reaches. Radiance measures from a random place of the glow, which for a round body lies in its volume: where
//! the border of the range runs through the body, light comes from a share of the places only. Here the share is computed.

use crate::disk_overlap::Overlap;
use crate::form::LightForm;
use crate::light::Light;
use glam::DVec3;
use std::f64::consts::PI;

impl Light {
    /// The share of a glow that has a receiver within its radius, 0…1, for light from the place at `distance` along `direction`. Of a sphere it is that of
    /// the volume's light, of a cone or cylinder that of the section at the place's height; other places are in or out of range by themselves.
    #[inline]
    pub fn share_in_radius(&self, receiver: DVec3, direction: DVec3, distance: f64) -> f64 {
        let range = self.max_distance;
        if range == f64::INFINITY {
            return 1.0;
        }
        match &self.form {
            LightForm::Sphere { center, radius, .. } => share_of_ball(*radius, range, receiver.distance(*center)),
            LightForm::Cone { base, axis, length, radii, .. } => {
                let place = axis.dot(receiver + direction * distance - *base);
                let offset = receiver - (*base + *axis * place);
                let along = offset.dot(*axis);
                let section = range * range - along * along;
                let radius = radii[0] + (radii[1] - radii[0]) * (place / length).clamp(0.0, 1.0);
                share_of_disk(radius, section.max(0.0).sqrt(), (offset - *axis * along).length())
            }
            _ if distance <= range => 1.0,
            _ => 0.0,
        }
    }
}

/// The share of a ball that is no farther than `range` from a point at `distance` from its centre, where each place counts as the inverse square of its
/// distance s, as its light does. The ball holds an area of `2πs² (1 − (d² + s² − r²) / 2ds)` of the sphere of radius s about the point, for
/// the ball's radius r and the distance d, and all of that sphere where `s < r − d`.
fn share_of_ball(radius: f64, range: f64, distance: f64) -> f64 {
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

/// A point nearer to the middle than this share of the radius is the middle.
const LEAST_DISTANCE: f64 = 1e-6;

/// The share of a disk's area that is no farther than `range` from a point of its plane at `distance` from its middle.
fn share_of_disk(radius: f64, range: f64, distance: f64) -> f64 {
    match Overlap::new(radius, range, distance) {
        Overlap::None => 0.0,
        Overlap::Whole => 1.0,
        Overlap::Part(lens) => lens.area() / (PI * radius * radius),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Shares of places on a grid: of a ball, each by the inverse square of its distance, and of a disk.
    fn counted(radius: f64, range: f64, distance: f64) -> [f64; 2] {
        let steps = 80;
        let place = |step: i32| radius * ((f64::from(step) + 0.5) / f64::from(steps) * 2.0 - 1.0);
        let [mut ball, mut ball_near, mut disk, mut disk_near] = [0.0; 4];
        for (x, y) in (0..steps * steps).map(|step| (place(step % steps), place(step / steps))) {
            for z in (0..steps).map(place).filter(|z| x * x + y * y + z * z < radius * radius) {
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
    fn shares_in_range_are_those_of_the_places() {
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
            // Within the ball the grid is coarse where places count most.
            let tolerance = if distance < radius { 1e-2 } else { 2e-3 };
            let found = share_of_ball(radius, range, distance);
            assert!((found - ball).abs() < tolerance, "ball {radius} {range} {distance}: {found}, counted {ball}");
            let found = share_of_disk(radius, range, distance);
            assert!((found - disk).abs() < 5e-3, "disk {radius} {range} {distance}: {found}, counted {disk}");
        }
    }
}
