//! Flat polygons: convex, concave, and with holes joined by seams.

use crate::ray::Ray;
use glam::DVec3;
use std::ops::Range;

/// A shear that maps the ray to the z axis, which reduces the test to two dimensions.
///
/// Two polygons that share an edge project its ends to the same numbers, so no ray passes between
/// them or through both (Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1),
/// 2013).
#[derive(Clone, Copy, Debug)]
pub struct RayFrame {
    /// The axis along which the ray is longest, and the two others.
    axes: [usize; 3],
    /// Shear of the two others along the first.
    shear: [f64; 2],
}

impl RayFrame {
    /// The shear of a ray.
    #[inline]
    #[must_use]
    pub fn new(ray: &Ray) -> RayFrame {
        let size = ray.direction.abs();
        let axes = if size.x > size.y && size.x > size.z {
            [0, 1, 2]
        } else if size.y > size.z {
            [1, 2, 0]
        } else {
            [2, 0, 1]
        };
        let [along, u, v] = axes.map(|axis| ray.direction[axis]);
        RayFrame { axes, shear: [-u / along, -v / along] }
    }

    /// The coordinates of a point in the order of the axes.
    #[inline]
    fn ordered(&self, point: &DVec3) -> [f64; 3] {
        let point: &[f64; 3] = point.as_ref();
        self.axes.map(|axis| point[axis])
    }

    /// A point relative to an origin with ordered coordinates, perpendicular to the ray.
    #[inline]
    fn project(&self, point: &DVec3, origin: &[f64; 3]) -> (f64, f64) {
        let point = self.ordered(point);
        let along = point[0] - origin[0];
        (point[1] - origin[1] + self.shear[0] * along, point[2] - origin[2] + self.shear[1] * along)
    }
}

/// Distance along the ray to the polygon's plane, if the ray passes through the polygon.
#[inline]
pub(crate) fn intersect(vertices: &[DVec3], ray: &Ray, frame: &RayFrame, range: Range<f64>) -> Option<f64> {
    if !passes_through(vertices, ray.origin, frame) {
        return None;
    }
    let normal = area_vector(vertices);
    let distance = normal.dot(vertices[0] - ray.origin) / normal.dot(ray.direction);
    (distance > range.start && distance < range.end).then_some(distance)
}

/// [`intersect`] for three vertices.
#[inline]
pub(crate) fn intersect_triangle(vertices: &[DVec3; 3], ray: &Ray, frame: &RayFrame, range: Range<f64>) -> Option<f64> {
    let origin = frame.ordered(&ray.origin);
    let [a, b, c] = [0, 1, 2].map(|corner| frame.project(&vertices[corner], &origin));
    if !(crosses(c, a) ^ crosses(a, b) ^ crosses(b, c)) {
        return None;
    }
    let normal = (vertices[1] - vertices[0]).cross(vertices[2] - vertices[0]);
    let distance = normal.dot(vertices[0] - ray.origin) / normal.dot(ray.direction);
    (distance > range.start && distance < range.end).then_some(distance)
}

/// Whether the line of the ray crosses the polygon: the parity of edges that cross the positive
/// half axis.
#[inline]
fn passes_through(vertices: &[DVec3], origin: DVec3, frame: &RayFrame) -> bool {
    let mut inside = false;
    let origin = frame.ordered(&origin);
    let mut previous = frame.project(&vertices[vertices.len() - 1], &origin);
    for vertex in vertices {
        let next = frame.project(vertex, &origin);
        inside ^= crosses(previous, next);
        previous = next;
    }
    inside
}

/// Whether an edge crosses the positive half of the u axis.
#[inline]
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
#[inline]
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
