//! Queries of the hierarchy: first hit and any hit.

use crate::geometry::Geometry;
use crate::hierarchy::{AnyOrder, NearestFirst, Search, Visited};
use crate::ids::{MemberId, PrimitiveId, ShaderTable};
use crate::intersection::{Crossing, Intersection};
use crate::limits::Limits;
use crate::outline::{GridResult, MANY_VERTICES};
use crate::polygon::{self, RayFrame};
use crate::ray::Ray;
use crate::{coincident, cone, disk, quadrilateral, sphere};
use glam::DVec3;
use radsight_ir::{Instance, MeshInstance, Scene, Shape, ValidScene};
use std::ops::Range;

impl Geometry {
    /// The first surface along the ray, except `from` if it is flat.
    #[inline]
    #[must_use]
    pub fn first_hit(
        &self,
        scene: &ValidScene,
        shaders: &ShaderTable,
        ray: &Ray,
        from: Option<PrimitiveId>,
    ) -> Option<Intersection> {
        self.first_hit_near(scene, shaders, ray, from, None)
    }

    /// The same, where the ray probably hits a plain member, which is tested first: nothing behind
    /// it is searched.
    #[inline]
    #[must_use]
    pub fn first_hit_near(
        &self,
        scene: &ValidScene,
        shaders: &ShaderTable,
        ray: &Ray,
        from: Option<PrimitiveId>,
        probable: Option<MemberId>,
    ) -> Option<Intersection> {
        let crossing = self.first_off(scene, ray, from, probable)?;
        Some(self.hit(scene, shaders, ray, crossing))
    }

    /// The distance of the first surface along the ray.
    #[must_use]
    pub fn distance(&self, scene: &Scene, ray: &Ray) -> Option<f64> {
        self.first_off(scene, ray, None, None).map(|crossing| crossing.distance)
    }

    /// The first surface along the ray that is not coincident with the one where it starts.
    fn first_off(
        &self,
        scene: &Scene,
        ray: &Ray,
        from: Option<PrimitiveId>,
        probable: Option<MemberId>,
    ) -> Option<Crossing> {
        let mut limits = Limits { nearest: self.nearest, farthest: f64::INFINITY };
        loop {
            let crossing = self.first(scene, ray, from, limits, probable)?;
            if !self.lies_on_start(scene, ray, from, &crossing) {
                return Some(crossing);
            }
            limits.nearest = crossing.distance * (1.0 + 1e-12) + self.nearest;
        }
    }

    /// `probable` is a member that contains no others.
    fn first(
        &self,
        scene: &Scene,
        ray: &Ray,
        from: Option<PrimitiveId>,
        mut limits: Limits,
        probable: Option<MemberId>,
    ) -> Option<Crossing> {
        let frame = RayFrame::new(ray);
        let mut best = probable.and_then(|member| self.crossing(scene, member, ray, &frame, from, &limits));
        let mut ties = Vec::new();
        // Hits farther than the best one by less than the tolerance are still considered.
        let mut tied_from = f64::INFINITY;
        if let Some(Crossing { distance, .. }) = best {
            tied_from = distance - self.tolerance;
            limits.farthest = limits.farthest.min(distance + self.tolerance);
        }
        let tested = best.and(probable);
        self.hierarchy.visit(NearestFirst, self.search(scene, ray, limits.farthest), |Visited { slot, corners }| {
            if tested == Some(MemberId(slot)) {
                return limits.farthest;
            }
            let member = MemberId(slot);
            let crossing = if let Some(corners) = corners {
                let test = |range| polygon::intersect_triangle(corners, ray, &frame, range);
                Crossing::of_flat(member.primitive(), from, &limits, test)
            } else if let Some(vertices) = self.four_vertices(scene, member) {
                let test = |range| quadrilateral::intersect(vertices, ray, &frame, range);
                Crossing::of_flat(member.primitive(), from, &limits, test)
            } else {
                self.crossing(scene, member, ray, &frame, from, &limits)
            };
            if let Some(crossing) = crossing {
                if crossing.distance < tied_from {
                    ties.clear();
                } else {
                    coincident::note(&mut ties, best, crossing);
                }
                if crossing.distance < best.map_or(f64::INFINITY, |best| best.distance) {
                    best = Some(crossing);
                    tied_from = crossing.distance - self.tolerance;
                    limits.farthest = crossing.distance + self.tolerance;
                }
            }
            limits.farthest
        });
        if ties.is_empty() { best } else { self.choose(scene, ray, ties, limits.farthest) }
    }

    #[inline]
    pub(crate) fn search<'a>(&self, scene: &'a Scene, ray: &'a Ray, limit: f64) -> Search<'a> {
        Search { ray, limit, vertices: &scene.vertices }
    }

    /// The first crossing of a ray with a member before `farthest`.
    #[inline]
    #[must_use]
    pub fn intersect(
        &self,
        scene: &ValidScene,
        member: MemberId,
        ray: &Ray,
        frame: &RayFrame,
        from: Option<PrimitiveId>,
        farthest: f64,
    ) -> Option<Crossing> {
        self.crossing(scene, member, ray, frame, from, &Limits { nearest: self.nearest, farthest })
    }

    #[inline]
    pub(crate) fn crossing(
        &self,
        scene: &Scene,
        member: MemberId,
        ray: &Ray,
        frame: &RayFrame,
        from: Option<PrimitiveId>,
        limits: &Limits,
    ) -> Option<Crossing> {
        let range = limits.range();
        let from_here = from == Some(member.primitive());
        let distance = match self.shapes[member.0 as usize] {
            // A ray never hits the flat surface from which it starts.
            Shape::Polygon { .. } | Shape::Ring(_) if from_here => None,
            Shape::Polygon { count: MANY_VERTICES.., .. } => self.polygon_crossing(scene, member, ray, frame, range),
            Shape::Polygon { start, count } => {
                let vertices = scene.polygon_vertices(start, count);
                match vertices {
                    [_, _, _] => polygon::intersect_triangle(vertices.first_chunk()?, ray, frame, range),
                    [_, _, _, _] => quadrilateral::intersect(vertices.first_chunk()?, ray, frame, range),
                    _ => polygon::intersect(vertices, ray, frame, range),
                }
            }
            Shape::Sphere(handle) => sphere::intersect(&scene.spheres[handle], ray, range),
            Shape::Cone(handle) => cone::intersect(&scene.cones[handle], &self.cones[handle.index()], ray, range),
            Shape::Ring(handle) => disk::intersect(&scene.rings[handle], ray, range),
            Shape::Source(_) => None,
            Shape::Mesh(_) | Shape::Instance(_) => return self.first_within(scene, member, ray, from, limits),
        }?;
        Some(Crossing { distance, primitive: member.primitive() })
    }

    /// The vertices of a member with four of them, which most have: it is tested without a call.
    #[inline(always)]
    fn four_vertices<'s>(&self, scene: &'s Scene, member: MemberId) -> Option<&'s [DVec3; 4]> {
        match self.shapes[member.0 as usize] {
            Shape::Polygon { start, count: 4 } => scene.vertices.get(start as usize..)?.first_chunk(),
            _ => None,
        }
    }

    /// The crossing of a ray with a polygon with many vertices.
    fn polygon_crossing(
        &self,
        scene: &Scene,
        member: MemberId,
        ray: &Ray,
        frame: &RayFrame,
        range: Range<f64>,
    ) -> Option<f64> {
        let Shape::Polygon { start, count } = self.shapes[member.0 as usize] else { return None };
        let vertices = scene.polygon_vertices(start, count);
        match self.outline(member, vertices).map_or(GridResult::Unknown, |outline| outline.classify(ray, &range)) {
            GridResult::Miss => None,
            GridResult::Hit(distance) => Some(distance),
            GridResult::Unknown => polygon::intersect(vertices, ray, frame, range),
        }
    }

    /// The first primitive of a mesh or an instance along the ray.
    #[cold]
    fn first_within(
        &self,
        scene: &Scene,
        member: MemberId,
        ray: &Ray,
        from: Option<PrimitiveId>,
        limits: &Limits,
    ) -> Option<Crossing> {
        let primitives = self.primitives_of(member);
        let from = Geometry::within(&primitives, from);
        let (scale, found) = match self.shapes[member.0 as usize] {
            Shape::Mesh(handle) => {
                let MeshInstance { mesh, to_scene } = &scene.mesh_instances[handle];
                let local = limits.seen_from(to_scene.scale);
                let ray = ray.seen_from(to_scene);
                (to_scene.scale, self.meshes[mesh.index()].first(&scene.meshes[*mesh], &ray, from, local))
            }
            Shape::Instance(handle) => {
                let Instance { octree, to_scene } = &scene.instances[handle];
                let inner = &self.octrees[octree.index()];
                let mut local = limits.seen_from(to_scene.scale);
                local.nearest = local.nearest.max(inner.nearest);
                let ray = ray.seen_from(to_scene);
                (to_scene.scale, inner.first(&scene.octrees[*octree].scene, &ray, from, local, None))
            }
            _ => return None,
        };
        let Crossing { distance, primitive } = found?;
        let distance = distance * scale;
        let primitive = PrimitiveId(primitives.start + primitive.0);
        (distance < limits.farthest).then_some(Crossing { distance, primitive })
    }

    /// Calls `block` for each crossing between `origin` and `origin + direction·distance`, until it
    /// returns true. The surface `target`, where the ray ends, is left out.
    pub fn any_between(
        &self,
        scene: &ValidScene,
        ray: &Ray,
        (from, target): (Option<PrimitiveId>, PrimitiveId),
        distance: f64,
        mut block: impl FnMut(Crossing) -> bool,
    ) -> bool {
        let mut block = |crossing: Crossing| !self.lies_on_start(scene, ray, from, &crossing) && block(crossing);
        let limits = Limits { nearest: self.nearest, farthest: distance };
        self.any(scene, ray, (from, target), &limits, &mut block)
    }

    fn any(
        &self,
        scene: &Scene,
        ray: &Ray,
        (from, target): (Option<PrimitiveId>, PrimitiveId),
        limits: &Limits,
        block: &mut dyn FnMut(Crossing) -> bool,
    ) -> bool {
        let frame = RayFrame::new(ray);
        let mut blocked = false;
        self.hierarchy.visit(AnyOrder, self.search(scene, ray, limits.farthest), |Visited { slot, corners }| {
            let member = MemberId(slot);
            if !blocked && member.primitive() != target {
                blocked = if let Some(corners) = corners {
                    let test = |range| polygon::intersect_triangle(corners, ray, &frame, range);
                    Crossing::of_flat(member.primitive(), from, limits, test).is_some_and(&mut *block)
                } else if let Some(vertices) = self.four_vertices(scene, member) {
                    let test = |range| quadrilateral::intersect(vertices, ray, &frame, range);
                    Crossing::of_flat(member.primitive(), from, limits, test).is_some_and(&mut *block)
                } else if self.is_plain(member) {
                    self.any_crossing(scene, member, (ray, &frame), from, limits, block)
                } else {
                    self.any_within(scene, member, ray, from, limits, block)
                };
            }
            if blocked { -1.0 } else { limits.farthest }
        });
        blocked
    }

    /// Calls `block` for each crossing of one member before `distance`, until it returns true.
    pub fn any_of_member(
        &self,
        scene: &ValidScene,
        member: MemberId,
        (ray, frame): (&Ray, &RayFrame),
        from: Option<PrimitiveId>,
        distance: f64,
        mut block: impl FnMut(Crossing) -> bool,
    ) -> bool {
        let limits = Limits { nearest: self.nearest, farthest: distance };
        let mut block = |crossing: Crossing| !self.lies_on_start(scene, ray, from, &crossing) && block(crossing);
        if self.is_plain(member) {
            self.any_crossing(scene, member, (ray, frame), from, &limits, &mut block)
        } else {
            self.any_within(scene, member, ray, from, &limits, &mut block)
        }
    }

    /// Calls `block` for each crossing of a plain member: a curved one can have two.
    fn any_crossing(
        &self,
        scene: &Scene,
        member: MemberId,
        (ray, frame): (&Ray, &RayFrame),
        from: Option<PrimitiveId>,
        limits: &Limits,
        block: &mut dyn FnMut(Crossing) -> bool,
    ) -> bool {
        let curved = matches!(self.shapes[member.0 as usize], Shape::Sphere(_) | Shape::Cone(_));
        let mut range = *limits;
        while let Some(crossing) = self.crossing(scene, member, ray, frame, from, &range) {
            if block(crossing) {
                return true;
            }
            range.nearest = crossing.distance * (1.0 + 1e-12) + self.nearest;
            if !curved {
                break;
            }
        }
        false
    }

    #[cold]
    fn any_within(
        &self,
        scene: &Scene,
        member: MemberId,
        ray: &Ray,
        from: Option<PrimitiveId>,
        limits: &Limits,
        block: &mut dyn FnMut(Crossing) -> bool,
    ) -> bool {
        let primitives = self.primitives_of(member);
        let from = Geometry::within(&primitives, from);
        let first = primitives.start;
        match self.shapes[member.0 as usize] {
            Shape::Mesh(handle) => {
                let MeshInstance { mesh, to_scene } = &scene.mesh_instances[handle];
                let (local, ray) = (limits.seen_from(to_scene.scale), ray.seen_from(to_scene));
                let geometry = &self.meshes[mesh.index()];
                geometry.any(&scene.meshes[*mesh], &ray, from, local, &mut shifted(block, first, to_scene.scale))
            }
            Shape::Instance(handle) => {
                let Instance { octree, to_scene } = &scene.instances[handle];
                let inner = &self.octrees[octree.index()];
                let mut local = limits.seen_from(to_scene.scale);
                local.nearest = local.nearest.max(inner.nearest);
                let ray = ray.seen_from(to_scene);
                let ends = (from, PrimitiveId::NONE);
                inner.any(&scene.octrees[*octree].scene, &ray, ends, &local, &mut shifted(block, first, to_scene.scale))
            }
            _ => false,
        }
    }
}

/// Passes crossings of a member to `block`, with primitives offset by `first` and distances scaled.
fn shifted(block: &mut dyn FnMut(Crossing) -> bool, first: u64, scale: f64) -> impl FnMut(Crossing) -> bool + use<'_> {
    move |Crossing { distance, primitive }| {
        block(Crossing { distance: distance * scale, primitive: PrimitiveId(first + primitive.0) })
    }
}
