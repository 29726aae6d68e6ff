//! Flat polygons: convex, concave, and with holes joined by seams.

use crate::ray::{Ray, sheared_axes};
use glam::DVec3;
use std::ops::Range;

/// A shear that maps the ray to the axis along which it is longest, which reduces the test to two
/// dimensions.
///
/// Two polygons that share an edge project its ends to the same numbers, so no ray passes between
/// them or through both (Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1),
/// 2013).
#[derive(Clone, Copy, Debug)]
pub struct RayFrame {
    /// The axes of u and v, and the longest one.
    pub(crate) axes: [usize; 3],
    /// The ray's origin along these axes.
    pub(crate) origin: [f64; 3],
    /// By how much u and v change along the longest axis.
    pub(crate) slopes: [f64; 2],
}

impl RayFrame {
    /// The shear of a ray.
    #[inline(always)]
    #[must_use]
    pub fn new(ray: &Ray) -> RayFrame {
        let axes = sheared_axes(ray.direction.abs().to_array());
        let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
        let along = direction[axes[2]];
        RayFrame {
            axes,
            origin: [origin[axes[0]], origin[axes[1]], origin[axes[2]]],
            slopes: [-direction[axes[0]] / along, -direction[axes[1]] / along],
        }
    }

    /// The coordinates u and v of a point.
    #[inline(always)]
    fn project(&self, point: &DVec3) -> (f64, f64) {
        let point: &[f64; 3] = point.as_ref();
        let along = point[self.axes[2]] - self.origin[2];
        let [u, v] = [point[self.axes[0]] - self.origin[0], point[self.axes[1]] - self.origin[1]];
        (u + self.slopes[0] * along, v + self.slopes[1] * along)
    }
}

/// Distance along the ray to the polygon's plane, if the ray passes through the polygon.
#[inline]
pub(crate) fn intersect(vertices: &[DVec3], ray: &Ray, frame: &RayFrame, range: Range<f64>) -> Option<f64> {
    if passes_through(vertices, frame) { distance(vertices, ray, range) } else { None }
}

/// Distance along the ray to the plane of a polygon.
#[inline(always)]
pub(crate) fn distance(vertices: &[DVec3], ray: &Ray, range: Range<f64>) -> Option<f64> {
    let normal = area_vector(vertices);
    let distance = normal.dot(vertices[0] - ray.origin) / normal.dot(ray.direction);
    (distance > range.start && distance < range.end).then_some(distance)
}

/// [`intersect`] for three vertices.
#[inline(always)]
pub(crate) fn intersect_triangle(vertices: &[DVec3; 3], ray: &Ray, frame: &RayFrame, range: Range<f64>) -> Option<f64> {
    let [a, b, c] = [frame.project(&vertices[0]), frame.project(&vertices[1]), frame.project(&vertices[2])];
    if !(crosses(c, a) ^ crosses(a, b) ^ crosses(b, c)) {
        return None;
    }
    let normal = (vertices[1] - vertices[0]).cross(vertices[2] - vertices[0]);
    let distance = normal.dot(vertices[0] - ray.origin) / normal.dot(ray.direction);
    (distance > range.start && distance < range.end).then_some(distance)
}

/// Whether the line of the ray crosses the polygon: the parity of edges that cross the positive
/// half axis.
#[inline(always)]
pub(crate) fn passes_through(vertices: &[DVec3], frame: &RayFrame) -> bool {
    let mut inside = false;
    let mut previous = frame.project(&vertices[vertices.len() - 1]);
    for vertex in vertices {
        let next = frame.project(vertex);
        inside ^= crosses(previous, next);
        previous = next;
    }
    inside
}

/// Whether an edge crosses the positive half of the u axis.
#[inline(always)]
fn crosses((u0, v0): (f64, f64), (u1, v1): (f64, f64)) -> bool {
    // The sign of the crossing's u is that of this determinant over v1 − v0. Swapping the ends
    // changes both signs, and a crossing at zero counts for neither of the polygons that share the
    // edge.
    let determinant = u0 * v1 - u1 * v0;
    let rises = v1 > v0;
    // Branch-free, since the signs are unpredictable.
    ((v0 >= 0.0) != (v1 >= 0.0)) & ((rises & (determinant > 0.0)) | (!rises & (determinant < 0.0)))
}

/// Twice the vector area, relative to the first vertex for precision far from the origin (Newell).
#[inline(always)]
pub(crate) fn area_vector(vertices: &[DVec3]) -> DVec3 {
    let first = vertices[0];
    let mut sum = DVec3::ZERO;
    let mut previous = vertices[1] - first;
    for vertex in &vertices[2..] {
        let next = *vertex - first;
        sum += previous.cross(next);
        previous = next;
    }
    sum
}

/// Unit normal on the side from which the vertices are counter-clockwise.
#[inline]
pub(crate) fn normal(vertices: &[DVec3]) -> DVec3 {
    area_vector(vertices).normalize_or(DVec3::Z)
}
