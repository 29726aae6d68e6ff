//! Surfaces: what a ray can hit.

use crate::{Handle, Instance, Mesh, ModifierHandle, NameId, Transform};
use glam::DVec3;
use radsight_diag::Span;

/// A surface primitive.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Its identifier in the scene text.
    pub name: NameId,
    /// Where it stands in the scene text.
    pub span: Option<Span>,
    /// `None` is `void`: rays pass through.
    pub modifier: Option<ModifierHandle>,
    /// Its form and place.
    pub shape: Shape,
}

/// Form and place of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// `count` vertices from `start` on in [`crate::Scene::vertices`], counter-clockwise seen from the front. Holes are joined by seams.
    Polygon {
        /// The first vertex.
        start: u32,
        /// At least three.
        count: u32,
    },
    /// `sphere` and `bubble`.
    Sphere(Handle<Sphere>),
    /// `cone`, `cup`, `cylinder` and `tube`.
    Cone(Handle<Cone>),
    /// `ring`: a flat ring or disk.
    Ring(Handle<Ring>),
    /// `source`: infinitely far away.
    Source(Handle<Source>),
    /// `mesh`.
    Mesh(Handle<MeshInstance>),
    /// `instance`: a whole scene, placed.
    Instance(Handle<Instance>),
}

/// Which way the front of a closed form looks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Facing {
    /// `sphere`, `cone`, `cylinder`.
    #[default]
    Outward,
    /// `bubble`, `cup`, `tube`.
    Inward,
}

impl Facing {
    /// The other way.
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
    /// Scene units.
    pub center: DVec3,
    /// Scene units, above zero.
    pub radius: f64,
    /// Which side is the front.
    pub facing: Facing,
}

/// A truncated cone without caps, from `base` to `apex`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Centre of the circle of radius `base_radius`.
    pub base: DVec3,
    /// Centre of the circle of radius `apex_radius`.
    pub apex: DVec3,
    /// Not negative.
    pub base_radius: f64,
    /// Not negative; at least one of the two is above zero. Equal ones make a cylinder.
    pub apex_radius: f64,
    /// Which side is the front.
    pub facing: Facing,
}

/// A flat ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// Scene units.
    pub center: DVec3,
    /// Unit normal on the front side.
    pub normal: DVec3,
    /// Not negative; zero for a disk.
    pub inner_radius: f64,
    /// Above the inner one.
    pub outer_radius: f64,
}

/// A distant disk of directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Source {
    /// Unit direction from the scene towards its centre.
    pub direction: DVec3,
    /// How much of the sky it covers.
    pub extent: SolidAngle,
}

/// The full angle that a distant source subtends, in radians: above zero, at most 2π.
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

    /// In steradians: `4π sin²(full/4)`, which is exact for small angles too.
    #[must_use]
    pub fn steradians(self) -> f64 {
        let s = (0.25 * self.full_angle).sin();
        4.0 * std::f64::consts::PI * s * s
    }
}

/// A mesh, placed.
#[derive(Clone, Debug)]
pub struct MeshInstance {
    /// The shared mesh.
    pub mesh: Handle<Mesh>,
    /// From mesh coordinates to the scene's.
    pub to_scene: Transform,
}
