//! Flat rings and disks.

use crate::ray::Ray;
use glam::DVec3;
use radsight_ir::Ring;
use std::ops::Range;

/// Distance to the ring.
#[inline]
pub(crate) fn intersect(ring: &Ring, ray: &Ray, range: Range<f64>) -> Option<f64> {
    let distance = ring.normal.dot(ring.center - ray.origin) / ring.normal.dot(ray.direction);
    if !(distance > range.start && distance < range.end) {
        return None;
    }
    let radius_squared = ray.at(distance).distance_squared(ring.center);
    let within = radius_squared <= ring.outer_radius * ring.outer_radius
        && radius_squared >= ring.inner_radius * ring.inner_radius;
    within.then_some(distance)
}

/// How far a unit disk with this unit normal reaches along each axis.
pub(crate) fn reach(normal: DVec3) -> DVec3 {
    (DVec3::ONE - normal * normal).max(DVec3::ZERO).map(f64::sqrt)
}
