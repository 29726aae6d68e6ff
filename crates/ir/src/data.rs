//! Tables, pictures, fonts and meshes that primitives refer to.

use crate::{ModifierHandle, Rgb};
use glam::DVec3;

/// One axis of a [`DataGrid`].
#[derive(Clone, Debug, PartialEq)]
pub enum Axis {
    /// `count` points from `first` to `last` in equal steps; `last` may lie below `first`.
    Regular {
        /// Coordinate of the first point.
        first: f64,
        /// Coordinate of the last point.
        last: f64,
        /// At least one.
        count: usize,
    },
    /// Strictly monotonic coordinates.
    Irregular(Vec<f64>),
}

impl Axis {
    /// How many points it has.
    #[must_use]
    pub fn count(&self) -> usize {
        match self {
            Axis::Regular { count, .. } => *count,
            Axis::Irregular(points) => points.len(),
        }
    }
}

/// Values on a grid of any dimension, from a `.dat` file.
#[derive(Clone, Debug, PartialEq)]
pub struct DataGrid {
    /// For messages and for writing back.
    pub file: String,
    /// The first axis varies slowest.
    pub axes: Vec<Axis>,
    /// Product of the axes' counts.
    pub values: Vec<f32>,
}

/// A picture as a pattern: radiance values, row 0 at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureData {
    /// For messages and for writing back.
    pub file: String,
    /// Pixels.
    pub width: usize,
    /// Pixels.
    pub height: usize,
    /// `width·height` of them.
    pub pixels: Vec<[f32; 3]>,
}

/// A polygonal font: outlines in a unit cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Font {
    /// For messages and for writing back.
    pub file: String,
    /// By character code; `None` where the font has no such character.
    pub glyphs: Vec<Option<Glyph>>,
}

/// One character: vertices in 0…255 by 0…255 of its cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Glyph {
    /// Outline; holes are joined by seams.
    pub vertices: Vec<(u8, u8)>,
}

/// A triangle mesh with its own modifiers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// For messages and for writing back.
    pub file: String,
    /// Positions, mesh coordinates.
    pub vertices: Vec<DVec3>,
    /// Unit vertex normals, or none.
    pub normals: Vec<DVec3>,
    /// Local coordinates, or none.
    pub uvs: Vec<[f64; 2]>,
    /// Triangles.
    pub triangles: Vec<MeshTriangle>,
}

/// A triangle of a [`Mesh`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshTriangle {
    /// Indices into `vertices`, and into `normals` and `uvs` where the flags below say so.
    pub vertices: [u32; 3],
    /// Whether all three vertices have normals.
    pub smooth: bool,
    /// Whether all three vertices have local coordinates.
    pub textured: bool,
    /// The mesh's own modifier, if the surface's does not override it.
    pub modifier: Option<ModifierHandle>,
}

/// A measured or simulated BSDF from an XML file.
#[derive(Clone, Debug, PartialEq)]
pub struct BsdfData {
    /// For messages and for writing back.
    pub file: String,
    /// Reflectance for light from the front, each band a lambertian part.
    pub diffuse_front: Rgb,
    /// Reflectance for light from the back.
    pub diffuse_back: Rgb,
    /// Transmittance, lambertian part.
    pub diffuse_transmitted: Rgb,
}
