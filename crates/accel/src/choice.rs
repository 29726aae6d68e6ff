//! Selects one of several coincident surfaces, by the rule of `coincident.rs`.

use crate::coincident::{Rank, Substance, rounding};
use crate::geometry::Geometry;
use crate::hierarchy::{AnyOrder, Visited};
use crate::ids::{MemberId, PrimitiveId};
use crate::intersection::Crossing;
use crate::limits::Limits;
use crate::mesh;
use crate::polygon::RayFrame;
use crate::ray::Ray;
use crate::shape::surface_point;
use glam::DVec3;
use radsight_ir::{ModifierHandle, Scene, Shape, SurfaceHandle, ValidScene};
use std::cmp::Reverse;

/// Minimum cosine between the normals of coincident surfaces.
const MIN_COSINE: f64 = 1.0 - 1e-6;

impl Geometry {
    /// The hit that the ray meets, among those nearly as near as the first and before `farthest`.
    #[cold]
    pub(crate) fn choose(&self, scene: &Scene, ray: &Ray, mut hits: Vec<Crossing>, farthest: f64) -> Option<Crossing> {
        hits.retain(|hit| hit.distance < farthest);
        // Radiance tests surfaces in reverse order of the scene.
        hits.sort_unstable_by_key(|hit| Reverse(self.surface_of(self.member_of(hit.primitive).0).index()));
        hits.into_iter().reduce(|best, next| if self.replaces(scene, ray, best, next) { next } else { best })
    }

    /// Whether `next`, which precedes `best` in the scene, replaces it.
    fn replaces(&self, scene: &Scene, ray: &Ray, best: Crossing, next: Crossing) -> bool {
        if !self.is_plain(self.member_of(next.primitive).0) {
            return next.distance < best.distance - rounding(ray, best.distance);
        }
        if (next.distance - best.distance).abs() > self.tolerance {
            return next.distance < best.distance;
        }
        self.rank(scene, ray, next) > self.rank(scene, ray, best)
    }

    /// The surface that a ray meets first among those within the tolerance of `distance`.
    #[cold]
    #[must_use]
    pub fn chosen_near(
        &self,
        scene: &ValidScene,
        ray: &Ray,
        from: Option<PrimitiveId>,
        distance: f64,
    ) -> Option<PrimitiveId> {
        let nearest = (distance - self.tolerance).max(self.nearest);
        let limits = Limits { nearest, farthest: distance + self.tolerance };
        let frame = RayFrame::new(ray);
        let mut hits = Vec::new();
        self.hierarchy.visit(AnyOrder, self.search(scene, ray, limits.farthest), |Visited { slot, .. }| {
            hits.extend(self.crossing(scene, MemberId(slot), ray, &frame, from, &limits));
            limits.farthest
        });
        self.choose(scene, ray, hits, limits.farthest).map(|crossing| crossing.primitive)
    }

    /// Maximum distance between hits that count as equally near, scene units.
    #[inline]
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Whether the rule treats a surface that contains no others as opaque.
    #[must_use]
    pub fn counts_as_opaque(&self, scene: &Scene, surface: SurfaceHandle) -> bool {
        (self.substance_of)(scene, scene.surfaces[surface].modifier) == Substance::Opaque
    }

    /// Whether a ray that starts on the surface `from` crosses a coincident surface at its origin:
    /// Radiance never reports that hit.
    #[inline]
    pub(crate) fn lies_on_start(&self, scene: &Scene, ray: &Ray, from: Option<PrimitiveId>, met: &Crossing) -> bool {
        met.distance <= self.tolerance && self.lies_along(scene, ray, from, met)
    }

    #[cold]
    fn lies_along(&self, scene: &Scene, ray: &Ray, from: Option<PrimitiveId>, met: &Crossing) -> bool {
        let Some(from) = from.filter(|from| *from != met.primitive && from.0 < self.primitive_count()) else {
            return false;
        };
        let [start, here] = [(from, ray.origin), (met.primitive, ray.at(met.distance))]
            .map(|(primitive, point)| self.front(scene, primitive, point));
        start.dot(here).abs() > MIN_COSINE
    }

    fn rank(&self, scene: &Scene, ray: &Ray, crossing: Crossing) -> Rank {
        let front = self.front(scene, crossing.primitive, ray.at(crossing.distance));
        let (substance, modifier) = self.substance(scene, crossing.primitive, 0);
        Rank { substance, faces_the_ray: ray.direction.dot(front) < 0.0, modifier }
    }

    /// The material class of a primitive, and the order of its modifier, `depth` scenes inside
    /// another.
    fn substance(&self, scene: &Scene, primitive: PrimitiveId, depth: u32) -> (Substance, (u32, usize)) {
        let (member, inner) = self.member_of(primitive);
        let surface = &scene.surfaces[self.surface_of(member)];
        let of = |modifier: Option<ModifierHandle>, depth| {
            ((self.substance_of)(scene, modifier), modifier.map_or((0, 0), |handle| (depth, handle.index() + 1)))
        };
        match surface.shape {
            Shape::Mesh(placed) if surface.modifier.is_none() => {
                let mesh = scene.mesh_instances[placed].mesh;
                of(self.meshes[mesh.index()].triangle(&scene.meshes[mesh], inner).modifier, depth + 1)
            }
            Shape::Instance(placed) if surface.modifier.is_none() => {
                let octree = scene.instances[placed].octree;
                let geometry = &self.octrees[octree.index()];
                geometry.substance(&scene.octrees[octree].scene, inner, depth + 1)
            }
            _ => of(surface.modifier, depth),
        }
    }

    /// The unit normal of a primitive on its front side.
    fn front(&self, scene: &Scene, primitive: PrimitiveId, point: DVec3) -> DVec3 {
        let (member, inner) = self.member_of(primitive);
        match self.shapes[member.0 as usize] {
            Shape::Mesh(handle) => {
                let placed = &scene.mesh_instances[handle];
                let mesh = &scene.meshes[placed.mesh];
                let triangle = self.meshes[placed.mesh.index()].triangle(mesh, inner);
                placed.to_scene.direction(mesh::front(mesh, triangle))
            }
            Shape::Instance(handle) => {
                let placed = &scene.instances[handle];
                let geometry = &self.octrees[placed.octree.index()];
                let point = placed.to_scene.inverse().point(point);
                placed.to_scene.direction(geometry.front(&scene.octrees[placed.octree].scene, inner, point))
            }
            shape => surface_point(scene, shape, point).1,
        }
    }
}
