//! Truncated cones and cylinders, without caps.

use crate::coincident;
use crate::ray::Ray;
use glam::DVec3;
use radsight_ir::{Cone, Facing};
use std::ops::Range;

/// Relative rounding error of a discriminant, with respect to its terms.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// What of a cone does not depend on the ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ConeAxis {
    /// Unit, from the base to the apex.
    direction: DVec3,
    /// Scene units.
    length: f64,
    /// By how much the radius changes along the axis.
    slope: f64,
}

impl ConeAxis {
    pub(crate) fn of(cone: &Cone) -> ConeAxis {
        let axis = cone.apex - cone.base;
        let length = axis.length();
        ConeAxis { direction: axis / length, length, slope: (cone.apex_radius - cone.base_radius) / length }
    }
}

/// Distance to the cone.
///
/// With `h` the height of a point above the base along the axis, the surface is
/// `|radial part| = r₀ + k·h` for `0 ≤ h ≤ length`. The quadratic is expressed about the point of
/// the ray nearest to the centre of the axis, so that a distant origin loses no precision. The wall
/// is extended by the rounding error, so that no ray passes between it and a ring at its end.
#[inline]
pub(crate) fn intersect(cone: &Cone, axis: &ConeAxis, ray: &Ray, range: Range<f64>) -> Option<f64> {
    let ConeAxis { direction: axis, length, slope } = *axis;
    let middle = (cone.apex + cone.base) * 0.5;
    let shift = (middle - ray.origin).dot(ray.direction);
    let from_base = ray.at(shift) - cone.base;
    let height = from_base.dot(axis);
    let climb = ray.direction.dot(axis);
    let radial = from_base - axis * height;
    let radial_rate = ray.direction - axis * climb;
    let radius = cone.base_radius + slope * height;
    let radius_rate = slope * climb;
    let a = radial_rate.length_squared() - radius_rate * radius_rate;
    let half_b = radial.dot(radial_rate) - radius * radius_rate;
    let c = radial.length_squared() - radius * radius;
    let roots = solve(a, half_b, c)?;
    let inside = |root: &f64| {
        let distance = *root + shift;
        let at = height + climb * *root;
        let rounding = coincident::rounding(ray, distance);
        distance > range.start && distance < range.end && at >= -rounding && at <= length + rounding
    };
    roots.into_iter().find(inside).map(|root| root + shift)
}

/// The roots of `a·t² + 2·half_b·t + c`, the smaller one first. A ray through the apex of a cone
/// has a double root; if rounding makes the discriminant slightly negative, the root is kept.
fn solve(a: f64, half_b: f64, c: f64) -> Option<[f64; 2]> {
    let (squared, product) = (half_b * half_b, a * c);
    let discriminant = squared - product;
    if discriminant < -ROUNDING * (squared + product.abs()) {
        return None;
    }
    let discriminant = discriminant.max(0.0);
    let q = -(half_b + discriminant.sqrt().copysign(half_b));
    let (first, second) = (q / a, c / q);
    match (first.is_finite(), second.is_finite()) {
        (true, true) => Some(if first < second { [first, second] } else { [second, first] }),
        (true, false) => Some([first; 2]),
        (false, true) => Some([second; 2]),
        (false, false) => None,
    }
}

/// Unit normal on the front side at a point of the surface.
pub(crate) fn normal(cone: &Cone, point: DVec3) -> DVec3 {
    let ConeAxis { direction: axis, slope, .. } = ConeAxis::of(cone);
    let from_base = point - cone.base;
    let radial = (from_base - axis * from_base.dot(axis)).normalize_or(axis.any_orthonormal_vector());
    let outward = (radial - axis * slope).normalize();
    match cone.facing {
        Facing::Outward => outward,
        Facing::Inward => -outward,
    }
}
