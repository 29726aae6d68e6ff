//! Flat rings and disks.

use crate::coincident;
use crate::ray::Ray;
use glam::DVec3;
use radsight_ir::Ring;
use std::ops::Range;

/// Distance to the ring. It is extended by the rounding error at both edges, so that no ray passes
/// between it and an adjacent cylinder, cone or ring.
#[inline]
pub(crate) fn intersect(ring: &Ring, ray: &Ray, range: Range<f64>) -> Option<f64> {
    let distance = ring.normal.dot(ring.center - ray.origin) / ring.normal.dot(ray.direction);
    if !(distance > range.start && distance < range.end) {
        return None;
    }
    let radius_squared = ray.at(distance).distance_squared(ring.center);
    let rounding = coincident::rounding(ray, distance);
    let [outer, inner] = [ring.outer_radius + rounding, (ring.inner_radius - rounding).max(0.0)];
    (radius_squared <= outer * outer && radius_squared >= inner * inner).then_some(distance)
}

/// Extent of a unit disk with this unit normal along each axis.
pub(crate) fn reach(normal: DVec3) -> DVec3 {
    (DVec3::ONE - normal * normal).max(DVec3::ZERO).map(f64::sqrt)
}
