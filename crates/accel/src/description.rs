//! Surface data at a crossing.

use crate::geometry::Geometry;
use crate::ids::{MemberId, PrimitiveId, ShaderId, ShaderTable};
use crate::intersection::{Crossing, InstanceData, Intersection};
use crate::mesh;
use crate::outline::MANY_VERTICES;
use crate::ray::Ray;
use crate::shape::surface_point;
use glam::DVec3;
use radsight_ir::{
    Instance, Mesh, MeshInstance, MeshTriangle, ModifierHandle, Scene, Shape, Surface, Transform, ValidScene,
};

/// Radiance's name for a mesh triangle with its own modifier.
const TRIANGLE_NAME: &str = "M-Tri";

/// The surface of a primitive.
#[derive(Clone, Copy, Debug)]
pub struct Identity<'s> {
    /// The scene that contains it: the outermost one or an instanced one.
    pub scene: &'s Scene,
    /// The name of the surface.
    pub name: &'s str,
    /// Its modifier in that scene.
    pub modifier: Option<ModifierHandle>,
}

/// Data of a point of a surface before an instance transform.
struct HitData {
    shader: ShaderId,
    point: DVec3,
    front: DVec3,
    instance: Option<InstanceData>,
}

impl Geometry {
    /// All geometric data for the shading of a crossing.
    #[inline]
    #[must_use]
    pub fn hit(&self, scene: &ValidScene, shaders: &ShaderTable, ray: &Ray, crossing: Crossing) -> Intersection {
        let Crossing { distance, primitive } = crossing;
        if primitive.0 < self.members.len() as u64 {
            let surface = self.members[primitive.0 as usize];
            let modifier = scene.surfaces[surface].modifier;
            let (point, front) = self.surface_point(scene, MemberId(primitive.0 as u32), ray.at(distance));
            return Intersection {
                distance,
                primitive,
                surface,
                shader: shaders.of(modifier),
                point,
                front,
                instance: None,
            };
        }
        self.hit_within(scene, shaders, ray, crossing)
    }

    /// As [`surface_point`], without the sum over many vertices.
    #[inline]
    fn surface_point(&self, scene: &Scene, member: MemberId, point: DVec3) -> (DVec3, DVec3) {
        let shape = self.shapes[member.0 as usize];
        let outline = match shape {
            Shape::Polygon { start, count } if count >= MANY_VERTICES => {
                self.outline(member, scene.polygon_vertices(start, count))
            }
            _ => None,
        };
        outline.map_or_else(|| surface_point(scene, shape, point), |outline| (point, outline.normal))
    }

    #[cold]
    fn hit_within(&self, scene: &Scene, shaders: &ShaderTable, ray: &Ray, crossing: Crossing) -> Intersection {
        let Crossing { distance, primitive } = crossing;
        let surface = self.members[self.member_of(primitive).0.0 as usize];
        let HitData { shader, point, front, instance } = self.describe(scene, shaders, primitive, ray.at(distance));
        Intersection { distance, primitive, surface, shader, point, front, instance }
    }

    fn describe(&self, scene: &Scene, shaders: &ShaderTable, primitive: PrimitiveId, point: DVec3) -> HitData {
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
                let found = geometry.describe(scene, &shaders.octrees()[octree.index()], inner, to_local.point(point));
                let own = surface.modifier.is_some();
                place(found, to_scene, &to_local, own.then_some(shader))
            }
            _ => {
                let (point, front) = self.surface_point(scene, member, point);
                HitData { shader, point, front, instance: None }
            }
        }
    }

    /// The surface of a primitive, in the scene that contains it. If the mesh or the instance has a
    /// modifier, it overrides those inside.
    #[must_use]
    pub fn identify<'s>(&self, scene: &'s Scene, primitive: PrimitiveId) -> Identity<'s> {
        let (member, inner) = self.member_of(primitive);
        let handle = self.members[member.0 as usize];
        let surface = &scene.surfaces[handle];
        match surface.shape {
            Shape::Mesh(placed) if surface.modifier.is_none() => {
                let mesh = scene.mesh_instances[placed].mesh;
                let modifier = self.meshes[mesh.index()].triangle(&scene.meshes[mesh], inner).modifier;
                let name = if modifier.is_some() { TRIANGLE_NAME } else { scene.surface_name(handle) };
                Identity { scene, name, modifier }
            }
            Shape::Instance(placed) if surface.modifier.is_none() => {
                let octree = scene.instances[placed].octree;
                self.octrees[octree.index()].identify(&scene.octrees[octree].scene, inner)
            }
            _ => Identity { scene, name: scene.surface_name(handle), modifier: surface.modifier },
        }
    }
}

/// A triangle has its own modifier, in the coordinates of the mesh, unless the surface's modifier
/// overrides it.
fn describe_triangle(
    (mesh, triangle): (&Mesh, &MeshTriangle),
    to_scene: &Transform,
    surface: &Surface,
    shaders: &ShaderTable,
    point: DVec3,
) -> HitData {
    let to_local = to_scene.inverse();
    let found = mesh::mesh_point(mesh, triangle, to_local.point(point));
    let front = to_scene.direction(found.front);
    let perturbation = found.smooth.map_or(DVec3::ZERO, |smooth| to_scene.direction(smooth) - front);
    let own = surface.modifier.is_none();
    let shader = shaders.of(if own { triangle.modifier } else { surface.modifier });
    let instance = InstanceData { to_object: own.then_some(to_local), uv: found.uv, perturbation };
    HitData { shader, point, front, instance: Some(instance) }
}

/// Transforms a hit inside an instance to the enclosing coordinates. A modifier of the instance
/// overrides those inside, and uses the coordinates of the enclosing scene.
fn place(found: HitData, to_scene: &Transform, to_local: &Transform, overriding: Option<ShaderId>) -> HitData {
    let inner = found.instance.unwrap_or(InstanceData { to_object: None, uv: [0.0; 2], perturbation: DVec3::ZERO });
    let to_object = match overriding {
        Some(_) => None,
        None => Some(inner.to_object.map_or(*to_local, |placed| to_local.then(&placed))),
    };
    HitData {
        shader: overriding.unwrap_or(found.shader),
        point: to_scene.point(found.point),
        front: to_scene.direction(found.front),
        instance: Some(InstanceData { to_object, uv: inner.uv, perturbation: to_scene.direction(inner.perturbation) }),
    }
}
