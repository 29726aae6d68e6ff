//! Wavefront text as triangles, for `obj2mesh`.

use crate::ear_clipping::clip_ears;
use crate::facets::{cross, dot, subtract};
use crate::obj2rad::wavefront::{Corner, Statements, Vertices};
use crate::obj2rad::{CornerNormals, classify_normals};
use radsight_triangulation::{OutlineError, doubled_area, triangulate};
use std::collections::HashMap;

/// Squared lengths below the square of this count as zero, in scene units.
const TINY: f64 = 1e-6;

/// Largest number of corners of a face that is cut exactly as in Radiance, which has no more. The time for that grows
/// with the third power of the number.
const MOST_CLIPPED: usize = 511;

/// The triangles of a Wavefront file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WavefrontMesh {
    /// In text order; larger faces are triangulated.
    pub triangles: Vec<WavefrontTriangle>,
    /// Names of materials: those of `usemtl`, else of groups.
    pub materials: Vec<String>,
    /// Number of unknown statements.
    pub unknown_statements: usize,
    /// Number of degenerate triangles, which are omitted.
    pub degenerate: usize,
}

/// A triangle, counter-clockwise seen from the side of its normals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WavefrontTriangle {
    /// Its corners.
    pub points: [[f64; 3]; 3],
    /// Unit normals at the corners, if they differ from the geometric normal.
    pub normals: Option<[[f64; 3]; 3]>,
    /// Texture coordinates at the corners.
    pub textures: Option<[[f64; 2]; 3]>,
    /// Index of its material.
    pub material: Option<usize>,
}

impl WavefrontMesh {
    /// Parses a text.
    ///
    /// # Errors
    /// The first mistake, with its line.
    pub fn read(text: &str) -> Result<WavefrontMesh, String> {
        let mut reader = Reader::default();
        let mut statements = Statements::new(text);
        while let Some(words) = statements.next_statement() {
            let taken = reader.statement(&words);
            taken.map_err(|mistake| format!("line {}: {mistake}", statements.line()))?;
        }
        Ok(reader.mesh)
    }
}

#[derive(Default)]
struct Reader {
    mesh: WavefrontMesh,
    vertices: Vertices,
    material: String,
    group: String,
    numbers: HashMap<String, usize>,
}

impl Reader {
    fn statement(&mut self, words: &[String]) -> Result<(), String> {
        let name = || words.get(1).cloned().unwrap_or_default();
        match words[0].as_str() {
            "v" | "vn" | "vt" => {
                let is_known = self.vertices.add(words)?;
                self.mesh.unknown_statements += usize::from(!is_known);
            }
            "f" => self.face(&words[1..])?,
            "usemtl" => self.material = name(),
            "g" => self.group = name(),
            "usemap" | "o" => {}
            first if first.starts_with('#') => {}
            _ => self.mesh.unknown_statements += 1,
        }
        Ok(())
    }

    fn face(&mut self, words: &[String]) -> Result<(), String> {
        let corners: Vec<Corner> = words.iter().map(|word| self.vertices.corner(word)).collect::<Result<_, _>>()?;
        match corners[..] {
            [] | [_] | [_, _] => return Err(format!("a face of {} corners", corners.len())),
            [a, b, c] => self.triangle([a, b, c]),
            _ => {
                let triangles = self.cut(&corners);
                for corners in triangles.map_err(|error| format!("a face of {} corners {error}", corners.len()))? {
                    self.triangle(corners);
                }
            }
        }
        Ok(())
    }

    /// Triangulates a face in a projection along an axis: as in Radiance that of the last corner, or that of the whole
    /// face if the outline intersects itself there.
    fn cut(&self, corners: &[Corner]) -> Result<Vec<[Corner; 3]>, OutlineError> {
        let points: Vec<[f64; 3]> = corners.iter().map(|corner| self.vertices.point(corner)).collect();
        let normals = points.windows(3).map(|p| cross(subtract(p[1], p[0]), subtract(p[2], p[1])));
        let Some(last) = normals.into_iter().rfind(|normal| dot(*normal, *normal) > TINY.powi(4)) else {
            return Ok(Vec::new());
        };
        let outlines = [last, area_normal(&points)].map(|normal| projected(&points, normal));
        let clipped =
            if corners.len() <= MOST_CLIPPED { outlines.iter().find_map(|flat| clip_ears(flat)) } else { None };
        let triangles = clipped.map_or_else(|| oriented_triangles(&outlines[1]), Ok)?;
        Ok(triangles.into_iter().map(|triangle| triangle.map(|index| corners[index])).collect())
    }

    fn triangle(&mut self, corners: [Corner; 3]) {
        let mut points = corners.map(|corner| self.vertices.point(&corner));
        let mut textures = all(corners.map(|corner| corner.texture.map(|texture| self.vertices.texture(texture))));
        let mut normals = all(corners.map(|corner| corner.normal.map(|normal| self.vertices.normal(normal))));
        let flat = cross(subtract(points[1], points[0]), subtract(points[2], points[1]));
        let kind = match normals {
            None if dot(flat, flat) > 0.0 => Some(CornerNormals::Flat),
            None => None,
            Some(normals) => classify_normals(points, normals),
        };
        let Some(kind) = kind else {
            self.mesh.degenerate += 1;
            return;
        };
        if matches!(kind, CornerNormals::FlatReversed | CornerNormals::SmoothReversed) {
            points.reverse();
            textures.iter_mut().for_each(|textures| textures.reverse());
            normals.iter_mut().for_each(|normals| normals.reverse());
        }
        let normals = normals.filter(|_| matches!(kind, CornerNormals::Smooth | CornerNormals::SmoothReversed));
        let material = self.material();
        self.mesh.triangles.push(WavefrontTriangle { points, normals, textures, material });
    }

    /// The index of the current material.
    fn material(&mut self) -> Option<usize> {
        let name = if self.material.is_empty() { &self.group } else { &self.material };
        if name.is_empty() || name == "void" {
            return None;
        }
        if let Some(known) = self.numbers.get(name) {
            return Some(*known);
        }
        self.mesh.materials.push(name.clone());
        self.numbers.insert(name.clone(), self.mesh.materials.len() - 1);
        Some(self.mesh.materials.len() - 1)
    }
}

/// Triangulates also outlines that intersect themselves, unless they are large, with the orientation of the outline.
fn oriented_triangles(flat: &[[f64; 2]]) -> Result<Vec<[usize; 3]>, OutlineError> {
    let area = doubled_area(flat);
    let oriented = |triangle: [u32; 3]| {
        let [a, b, c] = triangle.map(|index| index as usize);
        if doubled_area(&[a, b, c].map(|index| flat[index])) * area < 0.0 { [c, b, a] } else { [a, b, c] }
    };
    Ok(triangulate(flat)?.into_iter().map(oriented).collect())
}

/// Twice the vector area of a face.
fn area_normal(points: &[[f64; 3]]) -> [f64; 3] {
    let origin = points[0];
    points.windows(2).fold([0.0; 3], |sum, pair| {
        let part = cross(subtract(pair[0], origin), subtract(pair[1], origin));
        std::array::from_fn(|axis| sum[axis] + part[axis])
    })
}

/// Points along the largest component of a normal.
fn projected(points: &[[f64; 3]], normal: [f64; 3]) -> Vec<[f64; 2]> {
    let largest = (0..3).max_by(|a, b| normal[*a].abs().total_cmp(&normal[*b].abs())).unwrap_or(2);
    let [x, y] = [(largest + 1) % 3, (largest + 2) % 3];
    points.iter().map(|point| [point[x], point[y]]).collect()
}

fn all<T: Copy>([a, b, c]: [Option<T>; 3]) -> Option<[T; 3]> {
    Some([a?, b?, c?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_face_that_is_not_convex_is_cut_within_its_border() {
        // An L with its corner cut out.
        let text = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5 6\n";
        let mesh = WavefrontMesh::read(text).unwrap();
        let area = |triangle: &WavefrontTriangle| {
            let [a, b, c] = triangle.points;
            0.5 * cross(subtract(b, a), subtract(c, b))[2]
        };
        assert!(mesh.triangles.iter().all(|triangle| area(triangle) > 0.0));
        assert!((mesh.triangles.iter().map(area).sum::<f64>() - 3.0).abs() < 1e-12);
    }

    #[test]
    fn a_face_whose_last_corner_stands_upright_is_whole() {
        // Seen along x, as the normal of the last corner is, the outline intersects itself.
        let text = "v 0 0 0\nv 1 0 .2\nv 1 1 -.1\nv 0 1 .1\nv -.02 .3 -.5\nf 1 2 3 4 5\n";
        let mesh = WavefrontMesh::read(text).unwrap();
        let area = |triangle: &WavefrontTriangle| {
            let [a, b, c] = triangle.points;
            0.5 * cross(subtract(b, a), subtract(c, b))[2]
        };
        assert!((mesh.triangles.iter().map(area).sum::<f64>() - 1.01).abs() < 1e-12);
    }

    #[test]
    fn faces_of_many_corners_keep_their_area() {
        let corners = 600;
        let mut text = String::new();
        for corner in 0..corners {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(corner) / f64::from(corners)).sin_cos();
            text += &format!("v {cos} {sin} 0\n");
        }
        let words: Vec<String> = (1..=corners).map(|corner| corner.to_string()).collect();
        let mesh = WavefrontMesh::read(&format!("{text}f {}\n", words.join(" "))).unwrap();
        let area = |triangle: &WavefrontTriangle| {
            let [a, b, c] = triangle.points;
            0.5 * cross(subtract(b, a), subtract(c, b))[2]
        };
        let expected = 0.5 * f64::from(corners) * (std::f64::consts::TAU / f64::from(corners)).sin();
        assert!((mesh.triangles.iter().map(area).sum::<f64>() - expected).abs() < 1e-9);
    }

    #[test]
    fn backward_normals_reverse_a_triangle() {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 -1\nvn .6 0 -.8\nvt .25 .5\nf 1/1/1 2/1/1 3/1/2\n";
        let mesh = WavefrontMesh::read(text).unwrap();
        let [triangle] = mesh.triangles[..] else { panic!("one triangle") };
        assert_eq!(triangle.points[0], [0.0, 1.0, 0.0]);
        assert_eq!(triangle.normals.unwrap()[0], [0.6, 0.0, -0.8]);
        assert_eq!(triangle.textures, Some([[0.25, 0.5]; 3]));
    }

    #[test]
    fn mistakes_have_their_line() {
        assert!(WavefrontMesh::read("v 0 0\n").unwrap_err().starts_with("line 1: "));
        assert!(WavefrontMesh::read("v 0 0 0\n\nf 1 2 3\n").unwrap_err().starts_with("line 3: "));
        assert!(WavefrontMesh::read("v 0 0 0\nf 1 1\n").unwrap_err().contains("2 corners"));
    }
}
