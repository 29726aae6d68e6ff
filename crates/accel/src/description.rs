//! What a surface is like where a ray crosses it.

use crate::geometry::Geometry;
use crate::ids::{PrimitiveId, ShaderId, ShaderTable};
use crate::intersection::{Crossing, Intersection, Placed};
use crate::mesh;
use crate::ray::Ray;
use crate::shape::surface_point;
use glam::DVec3;
use radsight_ir::{
    Instance, Mesh, MeshInstance, MeshTriangle, ModifierHandle, Scene, Shape, Surface, Transform, ValidScene,
};

/// What Radiance calls a triangle of a mesh that has its own modifier.
const TRIANGLE_NAME: &str = "M-Tri";

/// Which surface a primitive is.
#[derive(Clone, Copy, Debug)]
pub struct Identity<'s> {
    /// The scene that holds it: the whole one, or one that is placed in it.
    pub scene: &'s Scene,
    /// The name of the surface.
    pub name: &'s str,
    /// Its modifier, of that scene.
    pub modifier: Option<ModifierHandle>,
}

/// What is known of a point of a surface before the surface is placed.
struct Described {
    shader: ShaderId,
    point: DVec3,
    front: DVec3,
    placed: Option<Placed>,
}

impl Geometry {
    /// All that the shading of a crossing asks for.
    #[inline]
    #[must_use]
    pub fn hit(&self, scene: &ValidScene, shaders: &ShaderTable, ray: &Ray, crossing: Crossing) -> Intersection {
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
                let found = geometry.describe(scene, &shaders.octrees()[octree.index()], inner, to_local.point(point));
                let own = surface.modifier.is_some();
                place(found, to_scene, &to_local, own.then_some(shader))
            }
            shape => {
                let (point, front) = surface_point(scene, shape, point);
                Described { shader, point, front, placed: None }
            }
        }
    }

    /// The surface that a primitive is, in the scene that holds it: that within a mesh or an instance, unless a modifier of the
    /// mesh or the instance overrides what is within.
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
        None => Some(inner.to_object.map_or(*to_local, |placed| to_local.then(&placed))),
    };
    Described {
        shader: overriding.unwrap_or(found.shader),
        point: to_scene.point(found.point),
        front: to_scene.direction(found.front),
        placed: Some(Placed { to_object, uv: inner.uv, perturbation: to_scene.direction(inner.perturbation) }),
    }
}
