//! All surfaces of a scene in one hierarchy, and the numbering of primitives.

use crate::bounds::Bounds;
use crate::builder::Builder;
use crate::coincident::{self, SubstanceOf};
use crate::cone::ConeAxis;
use crate::hierarchy::Hierarchy;
use crate::ids::{MemberId, PrimitiveId, ShaderId, ShaderTable};
use crate::limits::SELF_HIT;
use crate::mesh::MeshGeometry;
use crate::outline::{MANY_VERTICES, Outline, PendingOutline};
use crate::shape::{bounds_of_plain, triangle_of};
use glam::DVec3;
use radsight_diag::Diagnostic;
use radsight_ir::{Instance, Mesh, MeshInstance, Scene, Shape, SurfaceHandle};
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::sync::Arc;

/// All local surfaces of a scene.
#[derive(Debug)]
pub struct Geometry {
    /// The surface of each member; members are in the order of the hierarchy's slots.
    pub(crate) members: Vec<SurfaceHandle>,
    /// The members in the order of the quick builder's slots; empty if it is the same.
    listing: Vec<MemberId>,
    /// Their shapes, contiguous for traversal.
    pub(crate) shapes: Vec<Shape>,
    /// The members that contain others, ascending.
    pub(crate) holders: Vec<MemberId>,
    /// The first primitive of each of them, and the total number of primitives.
    pub(crate) firsts: Vec<u64>,
    pub(crate) hierarchy: Hierarchy,
    pub(crate) nearest: f64,
    /// Maximum distance between hits that count as equally near.
    pub(crate) tolerance: f64,
    /// By mesh handle.
    pub(crate) meshes: Vec<MeshGeometry>,
    /// By octree handle.
    pub(crate) octrees: Vec<Arc<Geometry>>,
    /// By cone handle.
    pub(crate) cones: Vec<ConeAxis>,
    /// The grids of polygons with many vertices.
    outlines: Vec<PendingOutline>,
    /// By member: one more than the index of its grid, or 0. Empty without grids.
    outline_places: Vec<u32>,
    /// Material classes, for the choice among coincident surfaces.
    pub(crate) substance_of: SubstanceOf,
}

impl Geometry {
    /// Builds the hierarchies. `wanted` selects the surfaces.
    ///
    /// # Errors
    /// If instances have more copies of surfaces than can be numbered.
    pub fn build(
        scene: &Scene,
        substance_of: SubstanceOf,
        wanted: impl Fn(SurfaceHandle) -> bool,
        builder: Builder,
    ) -> Result<Geometry, Diagnostic> {
        Geometry::build_sharing(scene, (substance_of, builder), &wanted, &mut HashMap::new())
    }

    /// Scenes with several instances share one geometry.
    fn build_sharing(
        scene: &Scene,
        (substance_of, builder): (SubstanceOf, Builder),
        wanted: &dyn Fn(SurfaceHandle) -> bool,
        known: &mut HashMap<*const Scene, Arc<Geometry>>,
    ) -> Result<Geometry, Diagnostic> {
        let meshes: Vec<MeshGeometry> =
            scene.meshes.items().iter().map(|mesh| MeshGeometry::build(mesh, builder)).collect();
        let mut octrees = Vec::with_capacity(scene.octrees.len());
        for octree in scene.octrees.items() {
            let key = Arc::as_ptr(&octree.scene);
            let geometry = match known.get(&key) {
                Some(geometry) => geometry.clone(),
                None => Arc::new(Geometry::build_sharing(&octree.scene, (substance_of, builder), &|_| true, known)?),
            };
            known.insert(key, geometry.clone());
            octrees.push(geometry);
        }
        let mut geometry = Geometry::holding(meshes, octrees, substance_of);
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
        let triangle = |index: usize| triangle_of(scene, scene.surfaces[handles[index]].shape);
        let (hierarchy, order, quick_order) = Hierarchy::build(handles.len(), bounds_of, triangle, builder);
        if let Some(quick_order) = quick_order {
            let mut member_of = vec![MemberId(0); order.len()];
            for (member, item) in order.iter().enumerate() {
                member_of[*item as usize] = MemberId(member as u32);
            }
            geometry.listing = quick_order.into_iter().map(|item| member_of[item as usize]).collect();
        }
        geometry.nearest = SELF_HIT * hierarchy.bounds().reach();
        geometry.tolerance = coincident::tolerance(hierarchy.bounds().reach());
        geometry.hierarchy = hierarchy;
        geometry.members = order.into_iter().map(|index| handles[index as usize]).collect();
        geometry.shapes = geometry.members.iter().map(|handle| scene.surfaces[*handle].shape).collect();
        geometry.cones = scene.cones.items().iter().map(ConeAxis::of).collect();
        (geometry.outlines, geometry.outline_places) = outlines(&geometry.shapes);
        geometry.number_primitives(scene)?;
        Ok(geometry)
    }

    /// Without members yet.
    fn holding(meshes: Vec<MeshGeometry>, octrees: Vec<Arc<Geometry>>, substance_of: SubstanceOf) -> Geometry {
        Geometry {
            members: Vec::new(),
            listing: Vec::new(),
            shapes: Vec::new(),
            holders: Vec::new(),
            firsts: Vec::new(),
            hierarchy: Hierarchy::default(),
            nearest: 0.0,
            tolerance: 0.0,
            meshes,
            octrees,
            cones: Vec::new(),
            outlines: Vec::new(),
            outline_places: Vec::new(),
            substance_of,
        }
    }

    /// The grid of a polygon with many vertices; `None` if it has none.
    #[inline]
    pub(crate) fn outline(&self, member: MemberId, vertices: &[DVec3]) -> Option<&Outline> {
        let place = *self.outline_places.get(member.0 as usize)?;
        self.outlines.get((place as usize).checked_sub(1)?)?.get(vertices)
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

    /// Number of primitives in a mesh or an instance.
    fn primitives_in(&self, scene: &Scene, shape: Shape) -> u64 {
        match shape {
            Shape::Mesh(handle) => scene.meshes[scene.mesh_instances[handle].mesh].triangles.len() as u64,
            Shape::Instance(handle) => self.octrees[scene.instances[handle].octree.index()].primitive_count(),
            _ => 1,
        }
    }

    /// Number of primitives, including all copies.
    #[must_use]
    pub fn primitive_count(&self) -> u64 {
        self.firsts[self.firsts.len() - 1]
    }

    /// Whether surfaces without a material are in the hierarchies, because an instance could give
    /// them one.
    #[must_use]
    pub fn holds_void(&self, scene: &Scene, shaders: &ShaderTable, is_void: impl Fn(ShaderId) -> bool) -> bool {
        let mut seen = HashSet::new();
        let mut pending = vec![(self, scene, shaders)];
        while let Some((geometry, scene, shaders)) = pending.pop() {
            if geometry.members_hold_void(scene, shaders, &is_void) {
                return true;
            }
            let octrees = geometry.octrees.iter().zip(scene.octrees.items()).zip(shaders.octrees());
            let unseen = octrees.filter(|((geometry, _), _)| seen.insert(Arc::as_ptr(geometry)));
            pending.extend(unseen.map(|((geometry, octree), shaders)| (&**geometry, &*octree.scene, &**shaders)));
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

    /// Centre and radius of a bounding sphere of all surfaces.
    #[must_use]
    pub fn bounding_sphere(&self) -> (DVec3, f64) {
        self.hierarchy.bounding_sphere()
    }

    /// Memory of the hierarchies here and in meshes and octrees, including data in slot order,
    /// bytes.
    #[must_use]
    pub fn hierarchy_bytes(&self) -> usize {
        let members = size_of::<SurfaceHandle>() + size_of::<Shape>();
        let meshes: usize = self.meshes.iter().map(MeshGeometry::bytes).sum();
        let octrees: usize = self.octrees.iter().map(|octree| octree.hierarchy_bytes()).sum();
        self.hierarchy.bytes() + self.members.len() * members + size_of_val(&*self.listing) + meshes + octrees
    }

    /// Number of members.
    #[must_use]
    pub fn len(&self) -> usize {
        self.members.len()
    }

    /// Whether there are no members.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.members.is_empty()
    }

    /// The surfaces, by member.
    pub fn members(&self) -> impl Iterator<Item = (MemberId, SurfaceHandle)> {
        self.members.iter().enumerate().map(|(index, handle)| (MemberId(index as u32), *handle))
    }

    /// The surfaces in an order independent of the builder.
    pub fn listed_members(&self) -> impl Iterator<Item = (MemberId, SurfaceHandle)> {
        let listed = |index: usize| self.listing.get(index).copied().unwrap_or(MemberId(index as u32));
        (0..self.members.len()).map(move |index| (listed(index), self.surface_of(listed(index))))
    }

    /// Whether a member contains no other surfaces, so that it is a primitive.
    #[inline]
    #[must_use]
    pub fn is_plain(&self, member: MemberId) -> bool {
        !matches!(self.shapes[member.0 as usize], Shape::Mesh(_) | Shape::Instance(_))
    }

    /// The member of a primitive, and the index of the primitive in it.
    #[inline]
    pub(crate) fn member_of(&self, primitive: PrimitiveId) -> (MemberId, PrimitiveId) {
        if primitive.0 < self.members.len() as u64 {
            return (MemberId(primitive.0 as u32), PrimitiveId(0));
        }
        let holder = self.firsts.partition_point(|first| *first <= primitive.0) - 1;
        (self.holders[holder], PrimitiveId(primitive.0 - self.firsts[holder]))
    }

    /// The primitives of a member that contains others.
    #[inline]
    pub(crate) fn primitives_of(&self, member: MemberId) -> Range<u64> {
        let holder = self.holders.partition_point(|holder| holder.0 < member.0);
        self.firsts[holder]..self.firsts[holder + 1]
    }

    /// The index of the primitive in a member, if it belongs to it.
    #[inline]
    pub(crate) fn within(range: &Range<u64>, primitive: Option<PrimitiveId>) -> Option<PrimitiveId> {
        primitive
            .filter(|primitive| range.contains(&primitive.0))
            .map(|primitive| PrimitiveId(primitive.0 - range.start))
    }

    /// The surface of a member.
    #[inline]
    #[must_use]
    pub fn surface_of(&self, member: MemberId) -> SurfaceHandle {
        self.members[member.0 as usize]
    }

    /// The bounding box of a surface; `None` for one at infinity.
    #[must_use]
    pub fn bounds(&self, scene: &Scene, shape: Shape) -> Option<Bounds> {
        match shape {
            Shape::Mesh(handle) => {
                let MeshInstance { mesh, to_scene } = &scene.mesh_instances[handle];
                Some(self.meshes[mesh.index()].bounds().transformed(to_scene))
            }
            Shape::Instance(handle) => {
                let Instance { octree, to_scene } = &scene.instances[handle];
                Some(self.octrees[octree.index()].hierarchy.bounds().transformed(to_scene))
            }
            shape => bounds_of_plain(scene, shape),
        }
    }
}

fn too_many() -> Diagnostic {
    Diagnostic::error("the instances of the scene make more than 2^64 surfaces")
}

/// Room for the grids of the polygons with many vertices, and by shape one more than the index of its
/// grid, or 0.
fn outlines(shapes: &[Shape]) -> (Vec<PendingOutline>, Vec<u32>) {
    let has_grid = |shape: &Shape| matches!(shape, Shape::Polygon { count: MANY_VERTICES.., .. });
    if !shapes.iter().any(has_grid) {
        return (Vec::new(), Vec::new());
    }
    let mut outlines = Vec::new();
    let places = shapes.iter().map(|shape| {
        if !has_grid(shape) {
            return 0;
        }
        outlines.push(PendingOutline::default());
        outlines.len() as u32
    });
    let places = places.collect();
    (outlines, places)
}
