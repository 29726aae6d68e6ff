//! Where rays meet surfaces.

use crate::ids::{PrimitiveId, ShaderId};
use glam::DVec3;
use radsight_ir::{SurfaceHandle, Transform};

/// Where a ray crosses a primitive.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    /// Along the ray, scene units.
    pub distance: f64,
    /// What is crossed.
    pub primitive: PrimitiveId,
}

/// Where a ray meets a surface, with all that shading asks of the geometry.
#[derive(Clone, Copy, Debug)]
pub struct Intersection {
    /// Along the ray, scene units.
    pub distance: f64,
    /// What is met.
    pub primitive: PrimitiveId,
    /// The surface of the whole scene: a mesh or an instance where the ray hits something within one.
    pub surface: SurfaceHandle,
    /// What shades it.
    pub shader: ShaderId,
    /// The point, in scene coordinates.
    pub point: DVec3,
    /// Unit normal on the surface's front side, whatever side the ray comes from.
    pub front: DVec3,
    /// What only meshes and instances have.
    pub placed: Option<Placed>,
}

/// What meshes and instances add to an intersection.
#[derive(Clone, Copy, Debug)]
pub struct Placed {
    /// From the scene's coordinates to those in which the surface's modifiers stand; `None` where they are the same.
    pub to_object: Option<Transform>,
    /// Local coordinates of a mesh, the variables `Lu` and `Lv`; zero elsewhere.
    pub uv: [f64; 2],
    /// Interpolated minus geometric unit normal, scene coordinates, as the surface faces; textures add to it.
    pub perturbation: DVec3,
}
