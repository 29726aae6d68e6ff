//! The intermediate representation of a scene.
//!
//! A [`Scene`] guarantees by construction that names are resolved to [`Handle`]s, defaults filled
//! in, aliases followed, transforms applied, generator commands run and function files compiled. A
//! modifier's parent precedes it in the arena, so chains cannot be cyclic. A [`ValidScene`]
//! guarantees in addition that every number is finite and in range, every handle is valid and every
//! polygon has an area. After [`Scene::validate`] no later stage panics on user data.
//!
//! The crate knows neither text syntax nor files nor how rays are traced. Lengths are in scene
//! units, angles in radians, radiance in W/(sr·m²) in each of the bands red, green, blue.
//!
//! ```
//! use radsight_ir::{Glossy, Material, Modifier, ModifierKind, Rgb, Scene, Shape, Sphere, Surface};
//! let mut scene = Scene::default();
//! let grey = Glossy { color: Rgb([0.5; 3]), specularity: 0.0, roughness: 0.0 };
//! let name = scene.names.add("paint");
//! let paint = scene.modifiers.add(Modifier {
//!     name,
//!     span: None,
//!     modifier: None,
//!     kind: ModifierKind::Material(Material::Plastic(grey)),
//! });
//! let sphere = scene.spheres.add(Sphere { center: glam::DVec3::ZERO, radius: 1.0, facing: Default::default() });
//! let name = scene.names.add("ball");
//! scene.surfaces.add(Surface { name, span: None, modifier: Some(paint), shape: Shape::Sphere(sphere) });
//! assert!(scene.validate().is_ok());
//! ```
#![forbid(unsafe_code)]

mod arena;
mod data;
mod fingerprint;
mod function;
mod material;
mod names;
mod pattern;
mod planarity;
mod scene;
mod surface;
mod transform;
mod validate;

pub use arena::{Arena, Handle};
pub use data::{Axis, BsdfData, DataGrid, Font, Glyph, Mesh, MeshTriangle, PictureData};
pub use function::{FunctionCall, GridCall, PictureCall};
pub use material::{
    Anisotropic, BsdfForm, Dielectric, FunctionMaterial, Glossy, Interface, Material, Mist, MixtureArms, Prism,
    PrismFace, Rgb, ScatteringFunction, ScatteringRole, Substitute, Translucent,
};
pub use names::{NameId, Names};
pub use pattern::{Mixture, MixtureAmount, Pattern, Spectrum, TextPattern, Texture};
pub use scene::{
    Cube, Instance, Modifier, ModifierHandle, ModifierKind, OctreeScene, Scene, SurfaceHandle, ValidScene,
};
pub use surface::{Cone, Facing, MeshInstance, Ring, Shape, SolidAngle, Source, Sphere, Surface};
pub use transform::Transform;
pub use validate::Validated;
