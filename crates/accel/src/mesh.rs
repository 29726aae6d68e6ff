//! Triangle meshes, in their own coordinates.

use crate::bounds::Bounds;
use crate::builder::Builder;
use crate::coincident;
use crate::hierarchy::{AnyOrder, Hierarchy, NearestFirst, Search, Visited};
use crate::hierarchy_triangles::Triangle;
use crate::ids::PrimitiveId;
use crate::intersection::Crossing;
use crate::limits::{Limits, SELF_HIT};
use crate::polygon::{self, RayFrame};
use crate::ray::Ray;
use glam::DVec3;
use radsight_ir::{Mesh, MeshTriangle};

/// The hierarchy of a mesh, shared by all its copies.
#[derive(Debug)]
pub(crate) struct MeshGeometry {
    hierarchy: Hierarchy,
    /// The vertices by slot, and the index of the triangle.
    slots: Vec<([u32; 3], u32)>,
    nearest: f64,
}

/// The normals and local coordinates at a point of a mesh.
pub(crate) struct MeshPoint {
    /// Of the triangle, counter-clockwise seen from the front.
    pub(crate) front: DVec3,
    /// Interpolated between the vertex normals, if there are any.
    pub(crate) smooth: Option<DVec3>,
    pub(crate) uv: [f64; 2],
}

impl MeshGeometry {
    pub(crate) fn build(mesh: &Mesh, builder: Builder) -> MeshGeometry {
        let bounds_of = |index: usize| bounds(mesh, mesh.triangles[index].vertices);
        let triangle_of =
            |index: usize| Some(Triangle { corners: corners(mesh, mesh.triangles[index].vertices), start: None });
        let (hierarchy, order, _) = Hierarchy::build(mesh.triangles.len(), bounds_of, triangle_of, builder);
        let slots: Vec<([u32; 3], u32)> =
            order.into_iter().map(|index| (mesh.triangles[index as usize].vertices, index)).collect();
        let nearest = SELF_HIT * hierarchy.bounds().reach();
        MeshGeometry { hierarchy, slots, nearest }
    }

    /// The triangle of a primitive.
    pub(crate) fn triangle<'m>(&self, mesh: &'m Mesh, primitive: PrimitiveId) -> &'m MeshTriangle {
        &mesh.triangles[self.slots[primitive.0 as usize].1 as usize]
    }

    /// Memory of the hierarchy and its slots.
    pub(crate) fn bytes(&self) -> usize {
        self.hierarchy.bytes() + size_of_val(&*self.slots)
    }

    pub(crate) fn bounds(&self) -> Bounds {
        self.hierarchy.bounds()
    }

    /// The first triangle along the ray, except `from`; primitives are triangles, by slot.
    pub(crate) fn first(&self, mesh: &Mesh, ray: &Ray, from: Option<PrimitiveId>, limits: Limits) -> Option<Crossing> {
        let frame = RayFrame::new(ray);
        let mut limits = Limits { nearest: limits.nearest.max(self.nearest), ..limits };
        let mut best: Option<Crossing> = None;
        let search = Search { ray, limit: limits.farthest, vertices: &[] };
        self.hierarchy.visit(NearestFirst, search, |visited| {
            if let Some(crossing) = self.crossing(mesh, visited, ray, &frame, from, &limits)
                && best.is_none_or(|best| self.replaces(best, crossing, ray))
            {
                limits.farthest = crossing.distance + coincident::rounding(ray, crossing.distance);
                best = Some(crossing);
            }
            limits.farthest
        });
        best
    }

    /// Whether a triangle replaces the best one so far: of coincident ones the last one in the mesh
    /// wins.
    fn replaces(&self, best: Crossing, next: Crossing, ray: &Ray) -> bool {
        let order = |crossing: Crossing| self.slots[crossing.primitive.0 as usize].1;
        if (next.distance - best.distance).abs() > coincident::rounding(ray, best.distance) {
            return next.distance < best.distance;
        }
        order(next) > order(best)
    }

    /// Calls `block` for each triangle within the limits, until it returns true; returns whether it
    /// did.
    pub(crate) fn any(
        &self,
        mesh: &Mesh,
        ray: &Ray,
        from: Option<PrimitiveId>,
        limits: Limits,
        block: &mut dyn FnMut(Crossing) -> bool,
    ) -> bool {
        let frame = RayFrame::new(ray);
        let limits = Limits { nearest: limits.nearest.max(self.nearest), ..limits };
        let mut blocked = false;
        let search = Search { ray, limit: limits.farthest, vertices: &[] };
        self.hierarchy.visit(AnyOrder, search, |visited| {
            blocked = blocked || self.crossing(mesh, visited, ray, &frame, from, &limits).is_some_and(&mut *block);
            if blocked { -1.0 } else { limits.farthest }
        });
        blocked
    }

    #[inline]
    fn crossing(
        &self,
        mesh: &Mesh,
        Visited { slot, corners: copied }: Visited<'_>,
        ray: &Ray,
        frame: &RayFrame,
        from: Option<PrimitiveId>,
        limits: &Limits,
    ) -> Option<Crossing> {
        let primitive = PrimitiveId(u64::from(slot));
        Crossing::of_flat(primitive, from, limits, |range| match copied {
            Some(corners) => polygon::intersect_triangle(corners, ray, frame, range),
            None => polygon::intersect_triangle(&corners(mesh, self.slots[slot as usize].0), ray, frame, range),
        })
    }
}

#[inline]
fn corners(mesh: &Mesh, vertices: [u32; 3]) -> [DVec3; 3] {
    vertices.map(|vertex| mesh.vertices[vertex as usize])
}

fn bounds(mesh: &Mesh, vertices: [u32; 3]) -> Bounds {
    let [a, b, c] = corners(mesh, vertices);
    Bounds { min: a.min(b).min(c), max: a.max(b).max(c) }
}

/// The unit normal of a triangle, on the side from which its vertices are counter-clockwise.
pub(crate) fn front(mesh: &Mesh, triangle: &MeshTriangle) -> DVec3 {
    polygon::normal(&corners(mesh, triangle.vertices))
}

/// The data of a mesh at a point of a triangle.
pub(crate) fn mesh_point(mesh: &Mesh, triangle: &MeshTriangle, point: DVec3) -> MeshPoint {
    let corners = corners(mesh, triangle.vertices);
    let area = polygon::area_vector(&corners);
    let front = area.normalize_or(DVec3::Z);
    let mut found = MeshPoint { front, smooth: None, uv: [0.0; 2] };
    let weights = barycentric(&corners, area, point);
    if triangle.smooth {
        let normals = triangle.vertices.map(|vertex| mesh.normals[vertex as usize]);
        let sum = normals[0] * weights[0] + normals[1] * weights[1] + normals[2] * weights[2];
        found.smooth = sum.try_normalize();
    }
    if triangle.textured {
        let uvs = triangle.vertices.map(|vertex| mesh.uvs[vertex as usize]);
        let mix = |axis: usize| (0..3).map(|corner| weights[corner] * uvs[corner][axis]).sum();
        found.uv = [mix(0), mix(1)];
    }
    found
}

/// The barycentric coordinates of a point; `area` is twice the vector area.
fn barycentric(corners: &[DVec3; 3], area: DVec3, point: DVec3) -> [f64; 3] {
    let squared = area.length_squared();
    let share = |a: DVec3, b: DVec3| (a - point).cross(b - point).dot(area) / squared;
    let (first, second) = (share(corners[1], corners[2]), share(corners[2], corners[0]));
    if first.is_finite() && second.is_finite() { [first, second, 1.0 - first - second] } else { [1.0, 0.0, 0.0] }
}
