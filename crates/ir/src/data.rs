//! Tables, pictures, fonts and meshes of primitives.

use crate::{Cube, ModifierHandle};
use glam::DVec3;
use radsight_measured::MeasuredBsdf;
use std::sync::Arc;

/// One axis of a [`DataGrid`].
#[derive(Clone, Debug, PartialEq)]
pub enum Axis {
    /// `count` points in equal steps from `first` to `last`; `last` may be below `first`.
    Regular {
        /// Coordinate of the first point.
        first: f64,
        /// Coordinate of the last point.
        last: f64,
        /// Number of points, at least one.
        count: usize,
    },
    /// Strictly monotonic coordinates.
    Irregular(Vec<f64>),
}

impl Axis {
    /// Number of points.
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
    /// File name, for messages and for output.
    pub file: String,
    /// Axes; the first varies slowest.
    pub axes: Vec<Axis>,
    /// Values; their number is the product of the axes' counts.
    pub values: Vec<f32>,
}

/// A picture of a pattern: values as stored, without exposure; row 0 is at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureData {
    /// File name, for messages and for output.
    pub file: String,
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Coordinates u of the last column and v of the top row. The first column and the bottom row
    /// are at 0, and the smaller extent is 1. Pixels are grid points, as in a [`DataGrid`].
    pub extent: [f64; 2],
    /// Pixels, `width·height` of them.
    pub pixels: Vec<[f32; 3]>,
}

/// A polygonal font: outlines in a unit cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Font {
    /// File name, for messages and for output.
    pub file: String,
    /// Glyphs by character code; `None` if the font lacks the character.
    pub glyphs: Vec<Option<Glyph>>,
}

/// A glyph, with vertices in 0…255 by 0…255 of its cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Glyph {
    /// Outline; holes are joined by seams.
    pub vertices: Vec<(u8, u8)>,
}

/// A triangle mesh with its own modifiers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// File name, for messages and for output.
    pub file: String,
    /// Bounding cube given by the file, mesh coordinates.
    pub cube: Cube,
    /// Positions, mesh coordinates.
    pub vertices: Vec<DVec3>,
    /// Unit vertex normals, as many as vertices or none; zero at vertices without a normal.
    pub normals: Vec<DVec3>,
    /// Local coordinates, as many as vertices or none.
    pub uvs: Vec<[f64; 2]>,
    /// Triangles.
    pub triangles: Vec<MeshTriangle>,
}

/// A triangle of a [`Mesh`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshTriangle {
    /// Indices into `vertices`, and into `normals` and `uvs` if the flags below are set.
    /// Counter-clockwise seen from the front.
    pub vertices: [u32; 3],
    /// Whether all three vertices have normals.
    pub smooth: bool,
    /// Whether all three vertices have local coordinates.
    pub textured: bool,
    /// Modifier of the mesh, unless that of the surface overrides it.
    pub modifier: Option<ModifierHandle>,
}

/// A measured or simulated BSDF from an XML file.
#[derive(Clone, Debug)]
pub struct BsdfData {
    /// File name, for messages and for output.
    pub file: String,
    /// The data.
    pub bsdf: Arc<MeasuredBsdf>,
}

impl Axis {
    /// Cell that contains `at`, and the weights of its two ends.
    fn cell(&self, at: f64) -> (usize, f64, f64) {
        let last_cell = self.count().saturating_sub(2);
        match self {
            Axis::Regular { first, last, count } => {
                regular_cell((at - first) / (last - first) * (*count as f64 - 1.0), *count)
            }
            Axis::Irregular(points) => {
                let rising = points[points.len() - 1] > points[0];
                let after = points.partition_point(|point| if rising { *point <= at } else { *point >= at });
                let cell = after.saturating_sub(1).min(last_cell);
                let x = cell as f64 + (at - points[cell]) / (points[cell + 1] - points[cell]);
                let (low, high) = end_weights(x, cell);
                (cell, low, high)
            }
        }
    }
}

/// Cell that contains `x`, in units of points from the first of `count`, and the weights of its two
/// ends.
fn regular_cell(x: f64, count: usize) -> (usize, f64, f64) {
    let cell = (x.max(0.0) as usize).min(count.saturating_sub(2));
    let (low, high) = end_weights(x, cell);
    (cell, low, high)
}

/// Weights of a cell's two ends: linear within the grid and one cell beyond it, then inversely
/// proportional to the distance, as in Radiance.
fn end_weights(x: f64, cell: usize) -> (f64, f64) {
    let position = cell as f64;
    if x > position + 2.0 {
        let near = 1.0 / (position - 1.0 - x);
        (near, -2.0 * near)
    } else if x < position - 1.0 {
        let far = 1.0 / (x - position);
        (-2.0 * far, far)
    } else {
        (position + 1.0 - x, x - position)
    }
}

impl PictureData {
    /// Colour at (u, v), by linear interpolation between pixels.
    #[must_use]
    pub fn value(&self, u: f64, v: f64) -> [f64; 3] {
        let position = |at: f64, extent: f64, count: usize| at / extent * (count as f64 - 1.0);
        let (column, left, right) = regular_cell(position(u, self.extent[0], self.width), self.width);
        let (row, low, high) = regular_cell(position(v, self.extent[1], self.height), self.height);
        let mut sum = [0.0; 3];
        for (column, across) in [(column, left), (column + 1, right)] {
            for (row, along) in [(row, low), (row + 1, high)] {
                // A picture with a single row or column is constant in that direction.
                let from_top = self.height - 1 - row.min(self.height - 1);
                let pixel = self.pixels[from_top * self.width + column.min(self.width - 1)];
                for (sum, value) in sum.iter_mut().zip(pixel) {
                    *sum += across * along * f64::from(value);
                }
            }
        }
        sum
    }
}

impl DataGrid {
    /// Value at a point with one coordinate per axis, by multilinear interpolation.
    #[must_use]
    pub fn value(&self, point: &[f64]) -> f64 {
        self.value_from(0, 0, point)
    }

    fn value_from(&self, axis: usize, offset: usize, point: &[f64]) -> f64 {
        let Some(coordinate) = point.get(axis) else { return f64::from(self.values[offset]) };
        let stride: usize = self.axes[axis + 1..].iter().map(Axis::count).product();
        if self.axes[axis].count() < 2 {
            return self.value_from(axis + 1, offset, point);
        }
        let (cell, low, high) = self.axes[axis].cell(*coordinate);
        let at = offset + cell * stride;
        low * self.value_from(axis + 1, at, point) + high * self.value_from(axis + 1, at + stride, point)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> DataGrid {
        let axes = vec![Axis::Regular { first: 0.0, last: 2.0, count: 3 }, Axis::Irregular(vec![0.0, 1.0, 10.0])];
        DataGrid { file: String::new(), axes, values: vec![0.0, 1.0, 10.0, 100.0, 101.0, 110.0, 200.0, 201.0, 210.0] }
    }

    #[test]
    fn a_bilinear_function_is_reproduced() {
        let grid = table();
        for (x, y) in [(0.0, 0.0), (0.25, 0.5), (1.5, 4.0), (2.0, 10.0), (2.5, 0.5)] {
            assert!((grid.value(&[x, y]) - (100.0 * x + y)).abs() < 1e-9, "at {x} {y}");
        }
    }

    #[test]
    fn far_outside_the_value_falls_to_zero() {
        let axes = vec![Axis::Regular { first: 0.0, last: 1.0, count: 2 }];
        let grid = DataGrid { file: String::new(), axes, values: vec![1.0, 1.0] };
        assert!((grid.value(&[3.0]) - 0.25).abs() < 0.5 && grid.value(&[1000.0]).abs() < 2e-3);
    }

    #[test]
    fn a_picture_is_upright_and_as_wide_as_it_says() {
        let pixels = [[0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 5.0], [1.0, 0.0, 5.0]].to_vec();
        let picture = PictureData { file: String::new(), width: 2, height: 2, extent: [1.0, 2.0], pixels };
        assert_eq!(picture.value(0.0, 0.0), [0.0, 0.0, 5.0]);
        assert_eq!(picture.value(0.25, 1.5), [0.25, 0.75, 1.25]);
        let dot = PictureData { width: 1, height: 1, pixels: vec![[3.0; 3]], ..picture };
        assert_eq!(dot.value(0.3, 7.0), [3.0; 3]);
    }

    #[test]
    fn a_falling_axis_is_read_backwards() {
        let axes = vec![Axis::Irregular(vec![3.0, 1.0, 0.0])];
        let grid = DataGrid { file: String::new(), axes, values: vec![30.0, 10.0, 0.0] };
        assert!((grid.value(&[2.0]) - 20.0).abs() < 1e-12);
    }
}
