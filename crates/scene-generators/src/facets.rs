//! Polygon meshes with shared vertices and normals, written as Wavefront text or as Radiance
//! polygons.
//!
//! Smoothed triangles become polygons with a `texfunc` of `tmesh.cal`, which interpolates the
//! corner normals by barycentric coordinates.

use std::collections::HashMap;
use std::fmt::Write;

use crate::Error;
use crate::text::{Text, general, wide};

/// Areas and squared lengths below the square of this count as zero, in scene units.
const TINY: f64 = 1e-6;
/// Normals whose cosine exceeds this are equal.
const SAME_DIRECTION: f64 = 0.999_995;
/// Largest number of normals that the faces of a joined vertex may share.
const MOST_NORMALS: usize = 9;

/// A reference from a face to a vertex and its normal.
#[derive(Clone, Copy)]
pub(crate) struct Use {
    pub(crate) vertex: usize,
    pub(crate) normal: Option<usize>,
}

struct Face {
    /// The first `count` are valid.
    uses: [Use; 4],
    count: usize,
    degenerate: bool,
}

impl Face {
    fn uses(&self) -> &[Use] {
        &self.uses[..self.count]
    }
}

/// A mesh of triangles and quadrilaterals with one name and one material.
#[derive(Default)]
pub(crate) struct Mesh {
    vertices: Vec<[f64; 3]>,
    normals: Vec<[f32; 3]>,
    faces: Vec<Face>,
}

impl Mesh {
    pub(crate) fn vertex(&mut self, position: [f64; 3]) -> usize {
        self.vertices.push(position);
        self.vertices.len() - 1
    }

    pub(crate) fn position(&self, vertex: usize) -> [f64; 3] {
        self.vertices[vertex]
    }

    /// Adds a normal of any length but zero.
    pub(crate) fn normal(&mut self, direction: [f64; 3]) -> Option<usize> {
        let unit = normalize(direction)?;
        self.normals.push(unit.map(|value| value as f32));
        Some(self.normals.len() - 1)
    }

    /// Adds a face of three or four corners.
    pub(crate) fn face(&mut self, corners: &[Use]) {
        let count = corners.len().min(4);
        let mut uses = [corners[0]; 4];
        uses[..count].copy_from_slice(&corners[..count]);
        let mut face = Face { uses, count, degenerate: false };
        let repeats = (1..count).any(|index| uses[..index].iter().any(|earlier| earlier.vertex == uses[index].vertex));
        face.degenerate = (count == 3 && repeats) || 0.5 * length(self.area_vector(&face)) <= TINY * TINY;
        self.faces.push(face);
    }

    /// Removes the normals of all faces.
    pub(crate) fn flatten(&mut self) {
        self.faces.iter_mut().flat_map(|face| &mut face.uses).for_each(|corner| corner.normal = None);
    }

    /// The face normal with twice the face's area as length.
    fn area_vector(&self, face: &Face) -> [f64; 3] {
        let origin = self.vertices[face.uses[0].vertex];
        let spoke = |index: usize| subtract(self.vertices[face.uses[index].vertex], origin);
        (2..face.count).fold([0.0; 3], |sum, index| {
            let part = cross(spoke(index - 1), spoke(index));
            std::array::from_fn(|axis| sum[axis] + part[axis])
        })
    }

    /// The mesh as Radiance primitives, last face first; smoothed faces come before flat ones.
    pub(crate) fn write_scene(&mut self, text: &mut Text, material: &str, name: &str) -> Result<(), Error> {
        let mut number = 0;
        let smooth: Vec<bool> = (0..self.faces.len()).map(|index| self.needs_smoothing(index)).collect();
        for triangle in self.smooth_triangles(&smooth) {
            number += 1;
            self.write_smooth(text, material, format_args!("{name}.{number}"), &triangle)?;
        }
        for (index, face) in self.faces.iter().enumerate().rev() {
            if face.degenerate || smooth[index] {
                continue;
            }
            number += 1;
            text.primitive(material, "polygon", format_args!("{name}.{number}"), 3 * face.count)?;
            for corner in face.uses() {
                self.write_corner(text, corner)?;
            }
        }
        Ok(())
    }

    /// Whether the corner normals of a face differ. A face whose normals all point backwards is
    /// reversed.
    fn needs_smoothing(&mut self, index: usize) -> bool {
        let face = &self.faces[index];
        let area_vector = self.area_vector(face);
        let (false, Some(face_normal)) = (face.degenerate, normalize(area_vector)) else { return false };
        let mut backward = 0;
        // Start at the last corner, as in real files.
        for corner in face.uses().iter().rev() {
            let Some(normal) = corner.normal else { return false };
            let cosine: f64 = (0..3).map(|axis| f64::from(self.normals[normal][axis]) * face_normal[axis]).sum();
            if cosine < SAME_DIRECTION {
                if cosine > -SAME_DIRECTION {
                    return true;
                }
                backward += 1;
            }
        }
        if backward > 0 && backward < face.count {
            return true;
        }
        if backward == face.count {
            let count = face.count;
            self.faces[index].uses[..count].reverse();
        }
        false
    }

    /// The triangles to smooth: those of quadrilaterals, last first, then the faces that are
    /// triangles.
    fn smooth_triangles(&self, smooth: &[bool]) -> Vec<[Use; 3]> {
        let chosen = || self.faces.iter().zip(smooth).filter(|(_, smooth)| **smooth).map(|(face, _)| face);
        let mut triangles: Vec<[Use; 3]> =
            chosen().filter(|face| face.count == 4).flat_map(|face| self.split(face)).collect();
        triangles.reverse();
        triangles
            .extend(chosen().filter(|face| face.count == 3).map(|face| [face.uses[0], face.uses[1], face.uses[2]]));
        triangles
    }

    /// The two triangles of a convex quadrilateral, in the order of Radiance's triangulation.
    fn split(&self, face: &Face) -> [[Use; 3]; 2] {
        let normal = self.area_vector(face);
        let [a, b, c, d] = face.uses;
        // If the outline is clockwise along its main axis, the triangulation starts at the other
        // end.
        if normal[main_axis(normal)] < 0.0 { [[c, d, a], [a, b, c]] } else { [[d, a, b], [b, c, d]] }
    }

    fn write_corner(&self, text: &mut Text, corner: &Use) -> Result<(), Error> {
        let [x, y, z] = self.vertices[corner.vertex];
        Ok(writeln!(text, "\t{} {} {}", wide(x), wide(y), wide(z))?)
    }

    fn write_smooth(
        &self,
        text: &mut Text,
        material: &str,
        name: std::fmt::Arguments<'_>,
        triangle: &[Use; 3],
    ) -> Result<(), Error> {
        let corners = triangle.map(|corner| self.vertices[corner.vertex]);
        let normals = triangle.map(|corner| {
            let normal = corner.normal.map_or([0.0; 3], |normal| self.normals[normal]);
            normal.map(f64::from)
        });
        let modifier = match Barycentric::new(&corners) {
            Some(barycentric) => {
                write!(text, "\n{material} texfunc Phong\n4 dx dy dz tmesh.cal\n0\n")?;
                barycentric.write_interpolation(text, &normals)?;
                "Phong"
            }
            None => material,
        };
        text.primitive(modifier, "polygon", name, 9)?;
        triangle.iter().try_for_each(|corner| self.write_corner(text, corner))
    }

    /// Merges vertices that are equal within a relative `tolerance`, and their normals likewise.
    pub(crate) fn join_vertices(&mut self, tolerance: f64) {
        let digits = (-(2.0 * tolerance).log10()).ceil().max(0.0) as usize;
        let mut faces_of = vec![Vec::new(); self.vertices.len()];
        for (index, face) in self.faces.iter().enumerate() {
            let mut seen: Vec<usize> = Vec::with_capacity(4);
            for corner in face.uses() {
                if !seen.contains(&corner.vertex) {
                    faces_of[corner.vertex].push(index);
                    seen.push(corner.vertex);
                }
            }
        }
        let mut first: HashMap<String, usize> = HashMap::new();
        for vertex in 0..self.vertices.len() {
            let [x, y, z] = self.vertices[vertex];
            let key = format!("{x:.digits$e} {y:.digits$e} {z:.digits$e}");
            match first.get(&key) {
                Some(kept) => self.join(vertex, *kept, tolerance, &mut faces_of),
                None => {
                    first.insert(key, vertex);
                }
            }
        }
    }

    fn join(&mut self, gone: usize, kept: usize, tolerance: f64, faces_of: &mut [Vec<usize>]) {
        let touches = |face: &Face| face.uses().iter().any(|corner| corner.vertex == gone);
        if faces_of[gone].is_empty() || faces_of[kept].iter().any(|face| touches(&self.faces[*face])) {
            return;
        }
        let mut normals: Vec<usize> = Vec::new();
        for &face in faces_of[kept].iter().rev() {
            let own = self.share_normal(face, kept, &normals, tolerance);
            normals.extend(own.filter(|_| normals.len() < MOST_NORMALS));
        }
        for &face in faces_of[gone].iter().rev() {
            self.share_normal(face, gone, &normals, tolerance);
            let uses = &mut self.faces[face].uses;
            uses.iter_mut().filter(|corner| corner.vertex == gone).for_each(|corner| corner.vertex = kept);
            let area = 0.5 * length(self.area_vector(&self.faces[face]));
            self.faces[face].degenerate |= area <= TINY * TINY;
        }
        let moved = std::mem::take(&mut faces_of[gone]);
        faces_of[kept].extend(moved);
    }

    /// Makes a face use one of the listed normals if its own is close to it. Otherwise returns its
    /// own.
    fn share_normal(&mut self, face: usize, vertex: usize, listed: &[usize], tolerance: f64) -> Option<usize> {
        let corner = self.faces[face].uses().iter().rposition(|corner| corner.vertex == vertex)?;
        let own = self.faces[face].uses[corner].normal?;
        let close = |other: usize| {
            (0..3).all(|axis| f64::from((self.normals[own][axis] - self.normals[other][axis]).abs()) <= tolerance)
        };
        let Some(other) = listed.iter().find(|other| **other == own || close(**other)) else { return Some(own) };
        self.faces[face].uses[corner].normal = Some(*other);
        None
    }

    /// The mesh as Wavefront text, last face first, with indices counted from the end.
    pub(crate) fn write_wavefront(&self, text: &mut Text, material: &str, name: &str) -> Result<(), Error> {
        let (vertices, vertex_index) =
            used(&self.vertices, |face| face.uses().iter().map(|corner| Some(corner.vertex)).collect(), &self.faces);
        let (normals, normal_index) =
            used(&self.normals, |face| face.uses().iter().map(|corner| corner.normal).collect(), &self.faces);
        write!(text, "#\n# {} final faces\n", self.faces.len())?;
        let (vertex_count, normal_count) = (vertices.len(), normals.len());
        writeln!(text, "#\t{vertex_count} vertices, 0 texture coordinates, {normal_count} surface normals\n#\n")?;
        writeln!(text, "# Vertex positions")?;
        for [x, y, z] in &vertices {
            writeln!(text, "v {} {} {}", general(*x, 12), general(*y, 12), general(*z, 12))?;
        }
        writeln!(text, "\n# Vertex texture coordinates\n\n# Vertex normals")?;
        for [x, y, z] in &normals {
            writeln!(text, "vn {x:.6} {y:.6} {z:.6}")?;
        }
        writeln!(text, "\n# Face group\ng DEFAULT_GROUP\n# End of face group DEFAULT_GROUP\n")?;
        write!(text, "# Face group\ng {name}\nusemtl {material}\n")?;
        for face in self.faces.iter().rev() {
            text.write_str("f")?;
            for corner in face.uses() {
                let from_end = |index: usize, count: usize| index as i64 - count as i64;
                write!(text, " {}//", from_end(vertex_index[corner.vertex], vertex_count))?;
                if let Some(normal) = corner.normal {
                    write!(text, "{}", from_end(normal_index[normal], normal_count))?;
                }
            }
            text.write_str("\n")?;
        }
        Ok(writeln!(text, "# End of face group {name}\n")?)
    }
}

/// The items that faces use, and the new index of each.
fn used<T: Copy>(all: &[T], uses: impl Fn(&Face) -> Vec<Option<usize>>, faces: &[Face]) -> (Vec<T>, Vec<usize>) {
    let mut wanted = vec![false; all.len()];
    for index in faces.iter().flat_map(uses).flatten() {
        wanted[index] = true;
    }
    let mut kept = Vec::new();
    let new_index = all
        .iter()
        .zip(&wanted)
        .map(|(item, wanted)| {
            if *wanted {
                kept.push(*item);
            }
            kept.len().saturating_sub(1)
        })
        .collect();
    (kept, new_index)
}

/// Barycentric coordinates of a triangle projected along its main axis, as linear functions of the
/// two other coordinates.
pub(crate) struct Barycentric {
    /// 0, 1, 2 for x, y, z: the projection axis.
    axis: usize,
    /// The coefficients of the first two barycentric coordinates: of the axis after `axis`, of the
    /// next one, and the constant.
    functions: [[f64; 3]; 2],
}

impl Barycentric {
    /// `None` if the triangle is too thin.
    pub(crate) fn new(corners: &[[f64; 3]; 3]) -> Option<Barycentric> {
        let normal = cross(subtract(corners[0], corners[1]), subtract(corners[2], corners[1]));
        let axis = main_axis(normal);
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut functions = [[0.0; 3]; 2];
        for (first, function) in functions.iter_mut().enumerate() {
            // The function is 1 at `apex` and 0 on the line from `base` to `end`.
            let [apex, base, end] = [0, 1, 2].map(|step| corners[(first + step) % 3]);
            let (to_apex, along) = ([apex[u] - base[u], apex[v] - base[v]], [end[u] - base[u], end[v] - base[v]]);
            let along_squared = along[0] * along[0] + along[1] * along[1];
            if along_squared <= TINY * TINY || along_squared.is_nan() {
                return None;
            }
            let foot = (along[0] * to_apex[0] + along[1] * to_apex[1]) / along_squared;
            let height = [to_apex[0] - along[0] * foot, to_apex[1] - along[1] * foot];
            let height_squared = height[0] * height[0] + height[1] * height[1];
            if height_squared <= TINY * TINY || height_squared.is_nan() {
                return None;
            }
            let inverse = 1.0 / height_squared;
            let (gu, gv) = (height[0] * inverse, height[1] * inverse);
            *function = [gu, gv, -(base[u] * gu + base[v] * gv)];
        }
        Some(Barycentric { axis, functions })
    }

    /// The real arguments of a `texfunc` of `tmesh.cal` that interpolates a vector given at the
    /// three corners.
    pub(crate) fn write_interpolation(&self, text: &mut Text, at_corners: &[[f64; 3]; 3]) -> Result<(), Error> {
        writeln!(text, "10\t{}", self.axis)?;
        let [at_first, at_second, at_third] = at_corners;
        for ((first, second), third) in at_first.iter().zip(at_second).zip(at_third) {
            let (a, b) = (first - third, second - third);
            let [x, y, one]: [f64; 3] =
                std::array::from_fn(|term| self.functions[0][term] * a + self.functions[1][term] * b);
            writeln!(text, "{x:14.8} {y:14.8} {:14.8}", one + third)?;
        }
        Ok(())
    }
}

/// The axis of the largest component.
fn main_axis(vector: [f64; 3]) -> usize {
    let square = vector.map(|value| value * value);
    let axis = usize::from(square[1] > square[0]);
    if square[2] > square[axis] { 2 } else { axis }
}

pub(crate) fn subtract(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn length(vector: [f64; 3]) -> f64 {
    dot(vector, vector).sqrt()
}

/// The unit vector, unless the length is zero or not finite.
///
/// A vector of nearly unit length gets one step of Newton's method for the inverse square root
/// instead of a division, as in Radiance. Where a later choice depends on the last bit (which axis
/// is the longest?), the result is the same.
pub(crate) fn normalize(vector: [f64; 3]) -> Option<[f64; 3]> {
    let squared = dot(vector, vector);
    if squared == 0.0 || !squared.is_finite() {
        return None;
    }
    let scale = if (squared - 1.0).abs() <= TINY { 2.0 - (0.5 + 0.5 * squared) } else { 1.0 / squared.sqrt() };
    Some(vector.map(|value| value * scale))
}
