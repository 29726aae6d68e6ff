//! Surfaces.

use crate::{Handle, Instance, Mesh, ModifierHandle, NameId, Transform};
use glam::DVec3;
use radsight_diag::Span;

/// A surface primitive.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Identifier in the scene text.
    pub name: NameId,
    /// Position in the scene text.
    pub span: Option<Span>,
    /// Modifier; `None` is `void`, through which rays pass.
    pub modifier: Option<ModifierHandle>,
    /// Geometry of the surface.
    pub shape: Shape,
}

/// Geometry of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// `count` consecutive vertices from `start` in [`crate::Scene::vertices`], counter-clockwise
    /// seen from the front. Holes are joined by seams.
    Polygon {
        /// Index of the first vertex.
        start: u32,
        /// Number of vertices, at least three.
        count: u32,
    },
    /// `sphere` and `bubble`.
    Sphere(Handle<Sphere>),
    /// `cone`, `cup`, `cylinder` and `tube`.
    Cone(Handle<Cone>),
    /// `ring`: a flat ring or disk.
    Ring(Handle<Ring>),
    /// `source`: a distant source.
    Source(Handle<Source>),
    /// `mesh`.
    Mesh(Handle<MeshInstance>),
    /// `instance`: a placed scene.
    Instance(Handle<Instance>),
}

/// Orientation of a closed shape's front.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Facing {
    /// `sphere`, `cone`, `cylinder`.
    #[default]
    Outward,
    /// `bubble`, `cup`, `tube`.
    Inward,
}

impl Facing {
    /// The opposite orientation.
    #[must_use]
    pub fn flipped(self) -> Facing {
        match self {
            Facing::Outward => Facing::Inward,
            Facing::Inward => Facing::Outward,
        }
    }
}

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre, scene units.
    pub center: DVec3,
    /// Radius, scene units, above zero.
    pub radius: f64,
    /// Orientation of the front.
    pub facing: Facing,
}

/// A truncated cone without caps, from `base` to `apex`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Centre of the circle of radius `base_radius`, scene units.
    pub base: DVec3,
    /// Centre of the circle of radius `apex_radius`, scene units.
    pub apex: DVec3,
    /// Radius at the base, not negative.
    pub base_radius: f64,
    /// Radius at the apex, not negative; at least one of both is positive. Equal radii form a
    /// cylinder.
    pub apex_radius: f64,
    /// Orientation of the front.
    pub facing: Facing,
}

/// A flat ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// Centre, scene units.
    pub center: DVec3,
    /// Unit normal on the front side.
    pub normal: DVec3,
    /// Inner radius, not negative; zero for a disk.
    pub inner_radius: f64,
    /// Outer radius, above the inner one.
    pub outer_radius: f64,
}

/// A distant disk of directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Source {
    /// Unit direction from the scene towards its centre.
    pub direction: DVec3,
    /// Extent of the source.
    pub extent: SolidAngle,
}

/// Extent of a distant source by its full angle in radians, above zero and at most 2π.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidAngle {
    /// Full angle, radians.
    pub full_angle: f64,
}

impl SolidAngle {
    /// Cosine of the half angle.
    #[must_use]
    pub fn cos_half_angle(self) -> f64 {
        (0.5 * self.full_angle).cos()
    }

    /// Solid angle in sr: `4π sin²(full/4)`, accurate for small angles too.
    #[must_use]
    pub fn steradians(self) -> f64 {
        let s = (0.25 * self.full_angle).sin();
        4.0 * std::f64::consts::PI * s * s
    }
}

/// A placed mesh.
#[derive(Clone, Debug)]
pub struct MeshInstance {
    /// The shared mesh.
    pub mesh: Handle<Mesh>,
    /// Transform from mesh coordinates to the scene's.
    pub to_scene: Transform,
}
