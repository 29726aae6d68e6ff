//! The shapes of single surfaces: their boxes, points and normals.

use crate::bounds::Bounds;
use crate::hierarchy_triangles::Triangle;
use crate::{cone, disk, polygon, sphere};
use glam::DVec3;
use radsight_ir::{Scene, Shape};

/// Whether a surface is flat.
#[must_use]
pub fn is_flat(shape: Shape) -> bool {
    matches!(shape, Shape::Polygon { .. } | Shape::Ring(_))
}

/// The point projected onto the surface where that is cheap, and the unit normal on the front side.
#[inline]
pub(crate) fn surface_point(scene: &Scene, shape: Shape, point: DVec3) -> (DVec3, DVec3) {
    match shape {
        Shape::Polygon { start, count } => (point, polygon::normal(scene.polygon_vertices(start, count))),
        Shape::Sphere(handle) => sphere::surface_point(&scene.spheres[handle], point),
        Shape::Cone(handle) => (point, cone::normal(&scene.cones[handle], point)),
        Shape::Ring(handle) => (point, scene.rings[handle].normal),
        Shape::Source(_) | Shape::Mesh(_) | Shape::Instance(_) => (point, DVec3::Z),
    }
}

/// The front normal of a flat surface.
#[must_use]
pub fn flat_normal(scene: &Scene, shape: Shape) -> Option<DVec3> {
    is_flat(shape).then(|| surface_point(scene, shape, DVec3::ZERO).1)
}

/// The bounding box of a surface that contains no others; `None` for one at infinity.
pub(crate) fn bounds_of_plain(scene: &Scene, shape: Shape) -> Option<Bounds> {
    match shape {
        Shape::Polygon { start, count } => {
            let vertices = scene.polygon_vertices(start, count);
            vertices.iter().map(|vertex| Bounds::point(*vertex)).reduce(Bounds::union)
        }
        Shape::Sphere(handle) => {
            let sphere = &scene.spheres[handle];
            Some(Bounds::around(sphere.center, DVec3::splat(sphere.radius)))
        }
        Shape::Cone(handle) => {
            let cone = &scene.cones[handle];
            let reach = disk::reach((cone.apex - cone.base).normalize());
            let base = Bounds::around(cone.base, reach * cone.base_radius);
            Some(base.union(Bounds::around(cone.apex, reach * cone.apex_radius)))
        }
        Shape::Ring(handle) => {
            let ring = &scene.rings[handle];
            Some(Bounds::around(ring.center, disk::reach(ring.normal) * ring.outer_radius))
        }
        Shape::Source(_) | Shape::Mesh(_) | Shape::Instance(_) => None,
    }
}

/// The shape as a triangle, if it is one.
pub(crate) fn triangle_of(scene: &Scene, shape: Shape) -> Option<Triangle> {
    let Shape::Polygon { start, count: 3 } = shape else { return None };
    let corners = scene.vertices[start as usize..][..3].try_into().ok()?;
    Some(Triangle { corners, start: Some(start) })
}

/// Unit normal of a polygon, if it has an area.
#[must_use]
pub fn polygon_normal(vertices: &[DVec3]) -> Option<DVec3> {
    polygon::area_vector(vertices).try_normalize()
}
