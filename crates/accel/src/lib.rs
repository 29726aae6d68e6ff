//! Intersects rays with the surfaces of a scene: exact intersection under bounding volume
//! hierarchies.
//!
//! Each mesh and each instanced scene has one hierarchy, in its own coordinates, which all its
//! copies share: a ray that enters the box of a copy continues inside. [`PrimitiveId`]s number
//! everything that a ray can hit, through all copies: first the members, then the content of each
//! mesh and instance.
//!
//! Guarantees: no panic on a [`radsight_ir::ValidScene`]; a ray that starts on a flat surface never
//! hits it; no ray passes between polygons that share an edge; of coincident surfaces Radiance's
//! rule selects one. Knows ids, not materials: a surface has a [`ShaderId`], and the caller
//! supplies the class of a material ([`Substance`]).
//!
//! ```
//! use glam::DVec3;
//! use radsight_accel::{Builder, Geometry, Ray, ShaderId, ShaderTable, Substance};
//! use radsight_ir::{Facing, Scene, Shape, Sphere, Surface};
//! let mut scene = Scene::default();
//! let name = scene.names.add("ball");
//! let ball = scene.spheres.add(Sphere { center: DVec3::ZERO, radius: 1.0, facing: Facing::Outward });
//! scene.surfaces.add(Surface { name, span: None, modifier: None, shape: Shape::Sphere(ball) });
//! let scene = scene.validate().unwrap().scene;
//! let geometry = Geometry::build(&scene, |_, _| Substance::Opaque, |_| true, Builder::Quick).unwrap();
//! let shaders = ShaderTable::new(vec![ShaderId(7)], Vec::new());
//! let ray = Ray::new(DVec3::new(0.0, 0.0, 3.0), -DVec3::Z).unwrap();
//! let hit = geometry.first_hit(&scene, &shaders, &ray, None).unwrap();
//! assert_eq!((hit.distance, hit.front, hit.shader), (2.0, DVec3::Z, ShaderId(7)));
//! ```
#![forbid(unsafe_code)]

mod beam;
mod bounds;
mod builder;
mod choice;
mod coincident;
mod cone;
mod description;
mod disk;
mod geometry;
mod hierarchy;
#[cfg(target_arch = "x86_64")]
mod hierarchy_avx2;
mod hierarchy_block;
mod hierarchy_build;
mod hierarchy_child;
mod hierarchy_cluster;
mod hierarchy_collapse;
mod hierarchy_node;
mod hierarchy_part;
mod hierarchy_processor;
mod hierarchy_triangles;
mod hierarchy_vectors;
mod ids;
mod intersection;
mod limits;
mod mesh;
mod outline;
mod polygon;
mod quadrilateral;
#[cfg(test)]
mod random;
mod ray;
mod shaft;
mod shaft_query;
mod shape;
mod sphere;
mod traversal;

pub use beam::Beam;
pub use bounds::Bounds;
pub use builder::Builder;
pub use coincident::{Substance, SubstanceOf};
pub use description::Identity;
pub use geometry::Geometry;
pub use ids::{MemberId, PrimitiveId, ShaderId, ShaderTable};
pub use intersection::{Crossing, InstanceData, Intersection};
pub use polygon::RayFrame;
pub use ray::Ray;
pub use shaft::Shaft;
pub use shape::{flat_normal, is_flat, polygon_normal};
