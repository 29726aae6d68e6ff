//! Spheres and bubbles.

use crate::ray::Ray;
use glam::DVec3;
use radsight_ir::{Facing, Sphere};
use std::ops::Range;

/// Distance to the sphere. The discriminant uses the point of the line closest to the centre, which
/// is precise for a small sphere far away (Haines, Günther, Akenine-Möller, "Precision Improvements
/// for Ray/Sphere Intersection", Ray Tracing Gems, 2019).
#[inline]
pub(crate) fn intersect(sphere: &Sphere, ray: &Ray, range: Range<f64>) -> Option<f64> {
    let from_center = ray.origin - sphere.center;
    let along = from_center.dot(ray.direction);
    let closest = from_center - ray.direction * along;
    let discriminant = sphere.radius * sphere.radius - closest.length_squared();
    if discriminant < 0.0 {
        return None;
    }
    let half_chord = discriminant.sqrt();
    // The root without cancellation, and the other one from the product of both.
    let sum = if along > 0.0 { -along - half_chord } else { -along + half_chord };
    let product = from_center.length_squared() - sphere.radius * sphere.radius;
    let other = if sum != 0.0 { product / sum } else { 0.0 };
    let (near, far) = if sum < other { (sum, other) } else { (other, sum) };
    let inside = |distance: &f64| *distance > range.start && *distance < range.end;
    Some(near).filter(inside).or(Some(far).filter(inside))
}

/// The point projected onto the sphere, and the unit normal on the front side.
pub(crate) fn surface_point(sphere: &Sphere, point: DVec3) -> (DVec3, DVec3) {
    let outward = (point - sphere.center).normalize_or(DVec3::Z);
    let front = match sphere.facing {
        Facing::Outward => outward,
        Facing::Inward => -outward,
    };
    (sphere.center + outward * sphere.radius, front)
}
