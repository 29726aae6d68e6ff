//! Exact intersections under bounding volume hierarchies.
//!
//! Each mesh and each scene that is placed in another has one hierarchy, in its own coordinates, which all its copies share: a ray that
//! meets the box of a copy goes on in there. [`PrimitiveId`]s number what a ray can hit through all copies: first the members, then the
//! content of each mesh and instance, one after the other.

mod bounds;
mod coincident;
mod cone;
mod disk;
mod hierarchy;
mod hierarchy_block;
mod hierarchy_build;
mod hierarchy_collapse;
mod hierarchy_node;
mod mesh;
mod polygon;
mod sphere;

use crate::cast::material_name;
use crate::compile::ShaderTable;
use crate::ray::{Crossing, Intersection, MemberId, PrimitiveId, Ray, ShaderId};
use crate::surface_interaction::Placed;
use bounds::Bounds;
use glam::DVec3;
use hierarchy::Hierarchy;
use mesh::MeshGeometry;
use radsight_diag::Diagnostic;
use radsight_ir::{
    Instance, Mesh, MeshInstance, MeshTriangle, Scene, Shape, Surface, SurfaceHandle, Transform, ValidScene,
};
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::sync::Arc;

pub(crate) use polygon::RayFrame;

/// A hit nearer than this share of the scene's largest coordinate is the surface that the ray starts from.
const SELF_HIT: f64 = 1e-10;

/// What Radiance calls a triangle of a mesh that has its own modifier.
const TRIANGLE_NAME: &str = "M-Tri";

/// Which part of a ray counts, as distances along it.
#[derive(Clone, Copy, Debug)]
struct Limits {
    nearest: f64,
    farthest: f64,
}

impl Limits {
    #[inline]
    fn range(&self) -> Range<f64> {
        self.nearest..self.farthest
    }

    /// In the coordinates of something that is placed with this scale.
    fn seen_from(&self, scale: f64) -> Limits {
        Limits { nearest: self.nearest / scale, farthest: self.farthest / scale }
    }
}

/// All surfaces of a scene that a ray can hit at a finite distance.
#[derive(Debug, Default)]
pub(crate) struct Geometry {
    /// The surface of each member; members stand in the order of the hierarchy's slots.
    members: Vec<SurfaceHandle>,
    /// Their shapes, beside each other for the rays.
    shapes: Vec<Shape>,
    /// The members that hold others, ascending.
    holders: Vec<MemberId>,
    /// The first primitive in each of them, and the number of all primitives.
    firsts: Vec<u64>,
    hierarchy: Hierarchy,
    nearest: f64,
    /// Hits no farther apart than this are equally near.
    tolerance: f64,
    /// By mesh handle.
    meshes: Vec<MeshGeometry>,
    /// By octree handle.
    octrees: Vec<Arc<Geometry>>,
}

/// What is known of a point of a surface before the surface is placed.
struct Described {
    shader: ShaderId,
    point: DVec3,
    front: DVec3,
    placed: Option<Placed>,
}

impl Geometry {
    /// `wanted` tells which surfaces can matter at all.
    ///
    /// # Errors
    /// A scene with more copies of surfaces than can be numbered.
    pub(crate) fn build(scene: &Scene, wanted: impl Fn(SurfaceHandle) -> bool) -> Result<Geometry, Diagnostic> {
        Geometry::build_sharing(scene, &wanted, &mut HashMap::new())
    }

    /// A scene that several others place has one geometry.
    fn build_sharing(
        scene: &Scene,
        wanted: &dyn Fn(SurfaceHandle) -> bool,
        known: &mut HashMap<*const Scene, Arc<Geometry>>,
    ) -> Result<Geometry, Diagnostic> {
        let meshes: Vec<MeshGeometry> = scene.meshes.items().iter().map(MeshGeometry::build).collect();
        let mut octrees = Vec::with_capacity(scene.octrees.len());
        for octree in scene.octrees.items() {
            let key = Arc::as_ptr(&octree.scene);
            let geometry = match known.get(&key) {
                Some(geometry) => geometry.clone(),
                None => Arc::new(Geometry::build_sharing(&octree.scene, &|_| true, known)?),
            };
            known.insert(key, geometry.clone());
            octrees.push(geometry);
        }
        let mut geometry = Geometry { meshes, octrees, ..Geometry::default() };
        let has_content = |handle: SurfaceHandle, shape| match shape {
            Shape::Source(_) => false,
            Shape::Mesh(_) | Shape::Instance(_) => geometry.primitives_in(scene, shape) > 0,
            _ => wanted(handle),
        };
        let handles: Vec<SurfaceHandle> = scene
            .surfaces
            .iter()
            .filter(|(handle, surface)| has_content(*handle, surface.shape))
            .map(|(h, _)| h)
            .collect();
        let bounds_of = |index: usize| {
            let shape = scene.surfaces[handles[index]].shape;
            geometry.bounds(scene, shape).unwrap_or(Bounds::point(DVec3::ZERO))
        };
        let triangle_of = |index: usize| triangle_of(scene, scene.surfaces[handles[index]].shape);
        let (hierarchy, order) = Hierarchy::build(handles.len(), bounds_of, triangle_of);
        geometry.nearest = SELF_HIT * hierarchy.bounds().reach();
        geometry.tolerance = coincident::tolerance(hierarchy.bounds().reach());
        geometry.hierarchy = hierarchy;
        geometry.members = order.into_iter().map(|index| handles[index as usize]).collect();
        geometry.shapes = geometry.members.iter().map(|handle| scene.surfaces[*handle].shape).collect();
        geometry.number_primitives(scene)?;
        Ok(geometry)
    }

    fn number_primitives(&mut self, scene: &Scene) -> Result<(), Diagnostic> {
        let mut end = self.members.len() as u64;
        self.firsts.push(end);
        for (index, shape) in self.shapes.iter().enumerate() {
            if matches!(shape, Shape::Mesh(_) | Shape::Instance(_)) {
                end = end
                    .checked_add(self.primitives_in(scene, *shape))
                    .filter(|end| *end < u64::MAX)
                    .ok_or_else(too_many)?;
                self.holders.push(MemberId(index as u32));
                self.firsts.push(end);
            }
        }
        Ok(())
    }

    /// How many primitives a mesh or an instance holds.
    fn primitives_in(&self, scene: &Scene, shape: Shape) -> u64 {
        match shape {
            Shape::Mesh(handle) => scene.meshes[scene.mesh_instances[handle].mesh].triangles.len() as u64,
            Shape::Instance(handle) => self.octrees[scene.instances[handle].octree.index()].primitive_count(),
            _ => 1,
        }
    }

    /// How many primitives there are, those of all copies counted.
    pub(crate) fn primitive_count(&self) -> u64 {
        self.firsts[self.firsts.len() - 1]
    }

    /// Whether something without a material stands in the hierarchies, because a copy could give it one.
    pub(crate) fn holds_void(&self, scene: &Scene, shaders: &ShaderTable, is_void: impl Fn(ShaderId) -> bool) -> bool {
        let mut seen = HashSet::new();
        let mut waiting = vec![(self, scene, shaders)];
        while let Some((geometry, scene, shaders)) = waiting.pop() {
            if geometry.members_hold_void(scene, shaders, &is_void) {
                return true;
            }
            let octrees = geometry.octrees.iter().zip(scene.octrees.items()).zip(&shaders.octrees);
            let unseen = octrees.filter(|((geometry, _), _)| seen.insert(Arc::as_ptr(geometry)));
            waiting.extend(unseen.map(|((geometry, octree), shaders)| (&**geometry, &*octree.scene, &**shaders)));
        }
        false
    }

    fn members_hold_void(&self, scene: &Scene, shaders: &ShaderTable, is_void: impl Fn(ShaderId) -> bool) -> bool {
        let in_mesh = |mesh: &Mesh| mesh.triangles.iter().any(|triangle| is_void(shaders.of(triangle.modifier)));
        let void_in_mesh: Vec<bool> = scene.meshes.items().iter().map(in_mesh).collect();
        self.members.iter().any(|handle| {
            let surface = &scene.surfaces[*handle];
            match (surface.shape, surface.modifier) {
                (Shape::Mesh(placed), None) => void_in_mesh[scene.mesh_instances[placed].mesh.index()],
                (Shape::Instance(_), None) => false,
                (_, modifier) => is_void(shaders.of(modifier)),
            }
        })
    }

    /// Centre and radius of a sphere around all surfaces.
    pub(crate) fn bounding_sphere(&self) -> (DVec3, f64) {
        self.hierarchy.bounding_sphere()
    }

    /// Memory of the hierarchies here and in meshes and octrees, with what stands in the order of their slots, bytes.
    pub(crate) fn hierarchy_bytes(&self) -> usize {
        let members = size_of::<SurfaceHandle>() + size_of::<Shape>();
        let meshes: usize = self.meshes.iter().map(MeshGeometry::bytes).sum();
        let octrees: usize = self.octrees.iter().map(|octree| octree.hierarchy_bytes()).sum();
        self.hierarchy.bytes() + self.members.len() * members + meshes + octrees
    }

    /// How many members there are.
    pub(crate) fn len(&self) -> usize {
        self.members.len()
    }

    /// The surfaces, by member.
    pub(crate) fn members(&self) -> impl Iterator<Item = (MemberId, SurfaceHandle)> {
        self.members.iter().enumerate().map(|(index, handle)| (MemberId(index as u32), *handle))
    }

    /// Whether a member holds no other surfaces, so that its own name is that of its primitive.
    #[inline]
    pub(crate) fn is_plain(&self, member: MemberId) -> bool {
        !matches!(self.shapes[member.0 as usize], Shape::Mesh(_) | Shape::Instance(_))
    }

    /// The member that a primitive belongs to, and the number of the primitive within it.
    fn member_of(&self, primitive: PrimitiveId) -> (MemberId, PrimitiveId) {
        if primitive.0 < self.members.len() as u64 {
            return (MemberId(primitive.0 as u32), PrimitiveId(0));
        }
        let holder = self.firsts.partition_point(|first| *first <= primitive.0) - 1;
        (self.holders[holder], PrimitiveId(primitive.0 - self.firsts[holder]))
    }

    /// The primitives of a member that holds others.
    fn primitives_of(&self, member: MemberId) -> Range<u64> {
        let holder = self.holders.partition_point(|holder| holder.0 < member.0);
        self.firsts[holder]..self.firsts[holder + 1]
    }

    /// The number of a primitive among those of a member, if it is one of them.
    fn within(range: &Range<u64>, primitive: Option<PrimitiveId>) -> Option<PrimitiveId> {
        primitive
            .filter(|primitive| range.contains(&primitive.0))
            .map(|primitive| PrimitiveId(primitive.0 - range.start))
    }

    /// The first surface along the ray, `from` excluded where it is flat.
    pub(crate) fn first_hit(
        &self,
        scene: &ValidScene,
        shaders: &ShaderTable,
        ray: &Ray,
        from: Option<PrimitiveId>,
    ) -> Option<Intersection> {
        let crossing = self.first_off(scene, ray, from)?;
        Some(self.hit(scene, shaders, ray, crossing))
    }

    /// How far away the first surface along the ray is.
    pub(crate) fn distance(&self, scene: &Scene, ray: &Ray) -> Option<f64> {
        self.first_off(scene, ray, None).map(|crossing| crossing.distance)
    }

    /// The first surface along the ray that does not lie on the one where it starts.
    fn first_off(&self, scene: &Scene, ray: &Ray, from: Option<PrimitiveId>) -> Option<Crossing> {
        let mut limits = Limits { nearest: self.nearest, farthest: f64::INFINITY };
        loop {
            let crossing = self.first(scene, ray, from, limits)?;
            if !self.lies_on_start(scene, ray, from, &crossing) {
                return Some(crossing);
            }
            limits.nearest = crossing.distance * (1.0 + 1e-12) + self.nearest;
        }
    }

    fn first(&self, scene: &Scene, ray: &Ray, from: Option<PrimitiveId>, mut limits: Limits) -> Option<Crossing> {
        let frame = RayFrame::new(ray);
        let mut best: Option<Crossing> = None;
        let mut ties = Vec::new();
        // What is farther than the best hit by less than the tolerance is looked at still.
        let mut tied_from = f64::INFINITY;
        self.hierarchy.visit(ray, limits.farthest, |index| {
            if let Some(crossing) = self.crossing(scene, MemberId(index), ray, &frame, from, &limits) {
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

    /// Where a ray first crosses a member before `farthest`.
    #[inline]
    pub(crate) fn intersect(
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
    fn crossing(
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
            // A flat surface is never met again by a ray that starts on it.
            Shape::Polygon { .. } | Shape::Ring(_) if from_here => None,
            Shape::Polygon { start, count } => {
                let vertices = &scene.vertices[start as usize..][..count as usize];
                match vertices.try_into() {
                    Ok(triangle) => polygon::intersect_triangle(triangle, ray, frame, range),
                    Err(_) => polygon::intersect(vertices, ray, frame, range),
                }
            }
            Shape::Sphere(handle) => sphere::intersect(&scene.spheres[handle], ray, range),
            Shape::Cone(handle) => cone::intersect(&scene.cones[handle], ray, range),
            Shape::Ring(handle) => disk::intersect(&scene.rings[handle], ray, range),
            Shape::Source(_) => None,
            Shape::Mesh(_) | Shape::Instance(_) => return self.first_within(scene, member, ray, from, limits),
        }?;
        Some(Crossing { distance, primitive: member.primitive() })
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
                (to_scene.scale, inner.first(&scene.octrees[*octree].scene, &ray, from, local))
            }
            _ => return None,
        };
        let Crossing { distance, primitive } = found?;
        let distance = distance * scale;
        let primitive = PrimitiveId(primitives.start + primitive.0);
        (distance < limits.farthest).then_some(Crossing { distance, primitive })
    }

    /// Calls `block` for each crossing between `origin` and `origin + direction·distance`, until it returns true.
    pub(crate) fn any_between(
        &self,
        scene: &ValidScene,
        ray: &Ray,
        from: Option<PrimitiveId>,
        distance: f64,
        mut block: impl FnMut(Crossing) -> bool,
    ) -> bool {
        let mut block = |crossing: Crossing| !self.lies_on_start(scene, ray, from, &crossing) && block(crossing);
        self.any(scene, ray, from, &Limits { nearest: self.nearest, farthest: distance }, &mut block)
    }

    fn any(
        &self,
        scene: &Scene,
        ray: &Ray,
        from: Option<PrimitiveId>,
        limits: &Limits,
        block: &mut dyn FnMut(Crossing) -> bool,
    ) -> bool {
        let frame = RayFrame::new(ray);
        let mut blocked = false;
        self.hierarchy.visit(ray, limits.farthest, |index| {
            let member = MemberId(index);
            if !blocked {
                blocked = if self.is_plain(member) {
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
    pub(crate) fn any_of_member(
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

    /// Calls `block` for each crossing of a plain member: a curved one may be in the way twice.
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
                inner.any(&scene.octrees[*octree].scene, &ray, from, &local, &mut shifted(block, first, to_scene.scale))
            }
            _ => false,
        }
    }

    /// All that the shading of a crossing asks for.
    #[inline]
    pub(crate) fn hit(&self, scene: &ValidScene, shaders: &ShaderTable, ray: &Ray, crossing: Crossing) -> Intersection {
        let Crossing { distance, primitive } = crossing;
        if primitive.0 < self.members.len() as u64 {
            let surface = self.members[primitive.0 as usize];
            let (modifier, shape) = (scene.surfaces[surface].modifier, self.shapes[primitive.0 as usize]);
            let (point, front) = surface_point(scene, shape, ray.at(distance));
            return Intersection {
                distance,
                primitive,
                surface,
                shader: shaders.of(modifier),
                point,
                front,
                placed: None,
            };
        }
        self.hit_within(scene, shaders, ray, crossing)
    }

    #[cold]
    fn hit_within(&self, scene: &Scene, shaders: &ShaderTable, ray: &Ray, crossing: Crossing) -> Intersection {
        let Crossing { distance, primitive } = crossing;
        let surface = self.members[self.member_of(primitive).0.0 as usize];
        let Described { shader, point, front, placed } = self.describe(scene, shaders, primitive, ray.at(distance));
        Intersection { distance, primitive, surface, shader, point, front, placed }
    }

    fn describe(&self, scene: &Scene, shaders: &ShaderTable, primitive: PrimitiveId, point: DVec3) -> Described {
        let (member, inner) = self.member_of(primitive);
        let surface = &scene.surfaces[self.members[member.0 as usize]];
        let shader = shaders.of(surface.modifier);
        match surface.shape {
            Shape::Mesh(handle) => {
                let MeshInstance { mesh, to_scene } = &scene.mesh_instances[handle];
                let triangle = self.meshes[mesh.index()].triangle(&scene.meshes[*mesh], inner);
                describe_triangle((&scene.meshes[*mesh], triangle), to_scene, surface, shaders, point)
            }
            Shape::Instance(handle) => {
                let Instance { octree, to_scene } = &scene.instances[handle];
                let to_local = to_scene.inverse();
                let scene = &scene.octrees[*octree].scene;
                let geometry = &self.octrees[octree.index()];
                let found = geometry.describe(scene, &shaders.octrees[octree.index()], inner, to_local.point(point));
                let own = surface.modifier.is_some();
                place(found, to_scene, &to_local, own.then_some(shader))
            }
            shape => {
                let (point, front) = surface_point(scene, shape, point);
                Described { shader, point, front, placed: None }
            }
        }
    }

    /// The names of the surface that a primitive is, of its modifier and of its material, as Radiance tells them.
    pub(crate) fn names<'s>(&self, scene: &'s Scene, primitive: PrimitiveId) -> [&'s str; 3] {
        let (member, inner) = self.member_of(primitive);
        let handle = self.members[member.0 as usize];
        let surface = &scene.surfaces[handle];
        let named = |name, modifier| [name, scene.modifier_name(modifier), material_name(scene, modifier)];
        match surface.shape {
            Shape::Mesh(placed) if surface.modifier.is_none() => {
                let mesh = scene.mesh_instances[placed].mesh;
                match self.meshes[mesh.index()].triangle(&scene.meshes[mesh], inner).modifier {
                    None => named(scene.surface_name(handle), None),
                    modifier => named(TRIANGLE_NAME, modifier),
                }
            }
            Shape::Instance(placed) if surface.modifier.is_none() => {
                let octree = scene.instances[placed].octree;
                self.octrees[octree.index()].names(&scene.octrees[octree].scene, inner)
            }
            _ => named(scene.surface_name(handle), surface.modifier),
        }
    }

    /// The surface of a member.
    pub(crate) fn surface_of(&self, member: MemberId) -> SurfaceHandle {
        self.members[member.0 as usize]
    }

    /// The box around a surface; none for what has no place.
    pub(crate) fn bounds(&self, scene: &Scene, shape: Shape) -> Option<Bounds> {
        match shape {
            Shape::Mesh(handle) => {
                let MeshInstance { mesh, to_scene } = &scene.mesh_instances[handle];
                Some(self.meshes[mesh.index()].bounds().placed(to_scene))
            }
            Shape::Instance(handle) => {
                let Instance { octree, to_scene } = &scene.instances[handle];
                Some(self.octrees[octree.index()].hierarchy.bounds().placed(to_scene))
            }
            shape => bounds_of_plain(scene, shape),
        }
    }
}

/// Tells `block` of crossings in a member whose first primitive is `first` and that is placed with this scale.
fn shifted(block: &mut dyn FnMut(Crossing) -> bool, first: u64, scale: f64) -> impl FnMut(Crossing) -> bool + use<'_> {
    move |Crossing { distance, primitive }| {
        block(Crossing { distance: distance * scale, primitive: PrimitiveId(first + primitive.0) })
    }
}

/// A triangle has its own modifier, in the coordinates of the mesh, unless the surface's modifier overrides it.
fn describe_triangle(
    (mesh, triangle): (&Mesh, &MeshTriangle),
    to_scene: &Transform,
    surface: &Surface,
    shaders: &ShaderTable,
    point: DVec3,
) -> Described {
    let to_local = to_scene.inverse();
    let found = mesh::mesh_point(mesh, triangle, to_local.point(point));
    let front = to_scene.direction(found.front);
    let perturbation = found.smooth.map_or(DVec3::ZERO, |smooth| to_scene.direction(smooth) - front);
    let own = surface.modifier.is_none();
    let shader = shaders.of(if own { triangle.modifier } else { surface.modifier });
    let placed = Placed { to_object: own.then_some(to_local), uv: found.uv, perturbation };
    Described { shader, point, front, placed: Some(placed) }
}

/// What was found in an instance, in the coordinates around it; a modifier of the instance overrides those within, and stands in the
/// coordinates of the scene around.
fn place(found: Described, to_scene: &Transform, to_local: &Transform, overriding: Option<ShaderId>) -> Described {
    let inner = found.placed.unwrap_or(Placed { to_object: None, uv: [0.0; 2], perturbation: DVec3::ZERO });
    let to_object = match overriding {
        Some(_) => None,
        None => Some(inner.to_object.map_or(*to_local, |onward| to_local.then(&onward))),
    };
    Described {
        shader: overriding.unwrap_or(found.shader),
        point: to_scene.point(found.point),
        front: to_scene.direction(found.front),
        placed: Some(Placed { to_object, uv: inner.uv, perturbation: to_scene.direction(inner.perturbation) }),
    }
}

fn too_many() -> Diagnostic {
    Diagnostic::error("the instances of the scene make more than 2^64 surfaces")
}

/// Whether all of a surface lies in one plane.
pub(crate) fn is_flat(shape: Shape) -> bool {
    matches!(shape, Shape::Polygon { .. } | Shape::Ring(_))
}

/// The point moved onto the surface where that is cheap, and the unit normal on the front side.
fn surface_point(scene: &Scene, shape: Shape, point: DVec3) -> (DVec3, DVec3) {
    match shape {
        Shape::Polygon { start, count } => {
            (point, polygon::normal(&scene.vertices[start as usize..][..count as usize]))
        }
        Shape::Sphere(handle) => sphere::surface_point(&scene.spheres[handle], point),
        Shape::Cone(handle) => (point, cone::normal(&scene.cones[handle], point)),
        Shape::Ring(handle) => (point, scene.rings[handle].normal),
        Shape::Source(_) | Shape::Mesh(_) | Shape::Instance(_) => (point, DVec3::Z),
    }
}

/// The front normal of a flat surface.
pub(crate) fn flat_normal(scene: &Scene, shape: Shape) -> Option<DVec3> {
    is_flat(shape).then(|| surface_point(scene, shape, DVec3::ZERO).1)
}

/// The box around a surface that holds no others; none for what has no place.
fn bounds_of_plain(scene: &Scene, shape: Shape) -> Option<Bounds> {
    match shape {
        Shape::Polygon { start, count } => {
            let vertices = &scene.vertices[start as usize..][..count as usize];
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

/// The corners of a polygon that has three.
fn triangle_of(scene: &Scene, shape: Shape) -> Option<[DVec3; 3]> {
    let Shape::Polygon { start, count: 3 } = shape else { return None };
    scene.vertices[start as usize..][..3].try_into().ok()
}

/// Unit normal of a polygon, if it has an area.
pub(crate) fn polygon_normal(vertices: &[DVec3]) -> Option<DVec3> {
    polygon::area_vector(vertices).try_normalize()
}
