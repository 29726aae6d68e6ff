//! Writes meshes: distributes triangles over patches and stores the octree by which real Radiance
//! finds them.

use crate::FormatError;
use crate::direction;
use crate::mesh::{HAS_COORDINATES, HAS_NORMALS, HAS_POSITIONS, MAGIC, MOST_IN_PATCH};
use crate::object::{Object, write_objects};
use crate::portable::{push_float, push_integer, push_string};
use crate::tree::{self, Tree};
use radsight_picture::Header;
use std::collections::HashMap;

/// Size of a triangle index in bytes, as Radiance writes it.
const INDEX_SIZE: usize = 4;

/// Largest number of triangles inside a patch, and of each kind of shared triangles.
const MOST_OWN: usize = 512;
const MOST_JOINED: usize = 256;

/// Flags in a triangle's index: it shares vertices with one or two other patches.
const JOINS_ONE: u32 = 0x200;
const JOINS_TWO: u32 = 0x300;

/// Triangle indices have 22 bits for the patch.
const MOST_PATCHES: usize = 1 << 22;

/// Margin between local coordinates and their limits: relative to their range, and at least.
const COORDINATE_MARGIN: [f64; 2] = [2.0 / 65536.0, 1e-6];

/// Scale of 32-bit coordinates.
const FULL: f64 = 4_294_967_296.0;

/// A corner of a triangle to write.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Position inside the cube.
    pub position: [f64; 3],
    /// Unit vector.
    pub normal: Option<[f64; 3]>,
    /// Local coordinates.
    pub coordinates: Option<[f64; 2]>,
}

/// A triangle to write.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    /// Counter-clockwise seen from the front.
    pub corners: [Corner; 3],
    /// Index of its material among the objects.
    pub material: Option<u32>,
}

/// A mesh to write.
#[derive(Clone, Debug)]
pub struct MeshParts<'a> {
    /// The information header.
    pub header: Header,
    /// The corner of the cube with the smallest coordinates.
    pub origin: [f64; 3],
    /// Length of an edge of the cube.
    pub size: f64,
    /// Modifiers.
    pub objects: Vec<Object<'a>>,
    /// All triangles.
    pub facets: Vec<Facet>,
}

impl MeshParts<'_> {
    /// The bytes of a mesh file. `tree` lists the indices of the triangles that touch each cube.
    ///
    /// # Errors
    /// When there are more patches or materials than the format can hold.
    pub fn write(&self, tree: &Tree) -> Result<Vec<u8>, FormatError> {
        let mut patches = Patches::new(self);
        let mut names = vec![None; self.facets.len()];
        // The order of the octree keeps neighbours together, so few triangles share vertices across
        // patches.
        patches.add_tree(tree, &mut names)?;
        let mut out = self.header.to_bytes();
        push_integer(&mut out, MAGIC + INDEX_SIZE as i64, 2);
        for number in self.origin.into_iter().chain([self.size]) {
            push_string(&mut out, format!("{number:?}").as_bytes());
        }
        patches.limits.iter().flatten().for_each(|limit| push_float(&mut out, *limit));
        tree::write(&mut out, &renamed(tree, &names), INDEX_SIZE);
        write_objects(&mut out, &self.objects, INDEX_SIZE)?;
        push_integer(&mut out, patches.all.len() as i64, 4);
        patches.all.iter().for_each(|patch| patch.write(&mut out));
        Ok(out)
    }
}

/// The tree with triangle indices replaced by those of the file.
fn renamed(tree: &Tree, names: &[Option<u32>]) -> Tree {
    match tree {
        Tree::Empty => Tree::Empty,
        Tree::Full(facets) => {
            let mut found: Vec<u32> = facets.iter().filter_map(|facet| names[*facet as usize]).collect();
            found.sort_unstable();
            Tree::Full(found)
        }
        Tree::Split(children) => Tree::Split(Box::new(std::array::from_fn(|child| renamed(&children[child], names)))),
    }
}

/// A corner as stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Vertex {
    position: [u32; 3],
    normal: Option<u32>,
    coordinates: Option<[u32; 2]>,
}

/// A triangle that shares vertices with other patches: references to those vertices, the indices of
/// its own, its material.
struct Joined {
    others: Vec<u32>,
    own: Vec<u8>,
    material: i64,
}

#[derive(Default)]
struct Patch {
    vertices: Vec<Vertex>,
    own: Vec<([u8; 3], i64)>,
    joins_one: Vec<Joined>,
    joins_two: Vec<Joined>,
}

/// The patches written so far.
struct Patches<'m> {
    parts: &'m MeshParts<'m>,
    /// Smallest and largest value of each local coordinate.
    limits: [[f64; 2]; 2],
    all: Vec<Patch>,
    /// Vertices already stored, and their references.
    known: HashMap<Vertex, u32>,
}

impl<'m> Patches<'m> {
    fn new(parts: &'m MeshParts<'m>) -> Self {
        Patches { parts, limits: limits(&parts.facets), all: Vec::new(), known: HashMap::new() }
    }

    fn add_tree(&mut self, tree: &Tree, names: &mut [Option<u32>]) -> Result<(), FormatError> {
        match tree {
            Tree::Empty => {}
            Tree::Full(facets) => {
                for index in facets {
                    let name = &mut names[*index as usize];
                    if name.is_none() {
                        *name = Some(self.add(&self.parts.facets[*index as usize])?);
                    }
                }
            }
            Tree::Split(children) => children.iter().try_for_each(|child| self.add_tree(child, names))?,
        }
        Ok(())
    }

    /// Adds a triangle and returns its index.
    fn add(&mut self, facet: &Facet) -> Result<u32, FormatError> {
        let material = match facet.material {
            None => -1,
            Some(index) if index <= 0x7fff => i64::from(index),
            Some(index) => {
                let what = "the index of a material".to_owned();
                return Err(FormatError::TooMany { what, found: index as usize, most: 0x7fff });
            }
        };
        let vertices = facet.corners.map(|corner| self.stored(&corner));
        let mut corners = [0; 3];
        for (name, vertex) in corners.iter_mut().zip(vertices) {
            *name = self.vertex(vertex)?;
        }
        let patch_of = |corner: usize| corners[corner] >> 8;
        let place = |corner: usize| corners[corner] as u8;
        let shares = |a: usize, b: usize| patch_of(a) == patch_of(b);
        if shares(0, 1) && shares(1, 2) {
            let patch = &mut self.all[patch_of(0) as usize];
            if patch.own.len() < MOST_OWN {
                patch.own.push(([place(0), place(1), place(2)], material));
                return Ok(patch_of(0) << 10 | (patch.own.len() - 1) as u32);
            }
        }
        // Put the corner in another patch first and keep the orientation.
        for [other, a, b] in [[0, 1, 2], [1, 2, 0], [2, 0, 1]] {
            let patch = &mut self.all[patch_of(a) as usize];
            if shares(a, b) && patch.joins_one.len() < MOST_JOINED {
                patch.joins_one.push(Joined { others: vec![corners[other]], own: vec![place(a), place(b)], material });
                return Ok(patch_of(a) << 10 | JOINS_ONE | (patch.joins_one.len() - 1) as u32);
            }
        }
        let emptiest = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];
        let emptiest = emptiest.into_iter().min_by_key(|turn| self.all[patch_of(turn[2]) as usize].joins_two.len());
        if let Some([a, b, own]) = emptiest {
            let patch = &mut self.all[patch_of(own) as usize];
            if patch.joins_two.len() < MOST_JOINED {
                let others = vec![corners[a], corners[b]];
                patch.joins_two.push(Joined { others, own: vec![place(own)], material });
                return Ok(patch_of(own) << 10 | JOINS_TWO | (patch.joins_two.len() - 1) as u32);
            }
        }
        self.add_apart(vertices, material)
    }

    /// Adds a triangle with new vertices, where a patch has no room for a shared one.
    fn add_apart(&mut self, vertices: [Vertex; 3], material: i64) -> Result<u32, FormatError> {
        if self.all.last().is_none_or(|last| last.vertices.len() + 3 > MOST_IN_PATCH || last.own.len() >= MOST_OWN) {
            self.add_patch()?;
        }
        let number = self.all.len() - 1;
        let patch = &mut self.all[number];
        let first = patch.vertices.len() as u8;
        patch.vertices.extend(vertices);
        patch.own.push(([first, first + 1, first + 2], material));
        Ok((number as u32) << 10 | (patch.own.len() - 1) as u32)
    }

    fn add_patch(&mut self) -> Result<(), FormatError> {
        if self.all.len() >= MOST_PATCHES {
            let what = "the number of patches".to_owned();
            return Err(FormatError::TooMany { what, found: MOST_PATCHES + 1, most: MOST_PATCHES });
        }
        self.all.push(Patch::default());
        Ok(())
    }

    /// The reference of a vertex: patch and index in it.
    fn vertex(&mut self, vertex: Vertex) -> Result<u32, FormatError> {
        if let Some(known) = self.known.get(&vertex) {
            return Ok(*known);
        }
        if self.all.last().is_none_or(|last| last.vertices.len() >= MOST_IN_PATCH) {
            self.add_patch()?;
        }
        let number = self.all.len() - 1;
        let vertices = &mut self.all[number].vertices;
        vertices.push(vertex);
        let name = (number as u32) << 8 | (vertices.len() - 1) as u32;
        self.known.insert(vertex, name);
        Ok(name)
    }

    fn stored(&self, corner: &Corner) -> Vertex {
        let MeshParts { origin, size, .. } = self.parts;
        let within = |value: f64, low: f64, range: f64| (FULL * (value - low) / range) as u32;
        Vertex {
            position: std::array::from_fn(|axis| within(corner.position[axis], origin[axis], *size)),
            normal: corner.normal.map(direction::encode),
            coordinates: corner.coordinates.map(|pair| {
                std::array::from_fn(|axis| {
                    let [low, high] = self.limits[axis];
                    within(pair[axis], low, high - low).max(1)
                })
            }),
        }
    }
}

/// The range of local coordinates with a margin, so that no coordinate is zero.
fn limits(facets: &[Facet]) -> [[f64; 2]; 2] {
    let mut limits = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for pair in facets.iter().flat_map(|facet| facet.corners).filter_map(|corner| corner.coordinates) {
        for (limit, value) in limits.iter_mut().zip(pair) {
            *limit = [limit[0].min(value), limit[1].max(value)];
        }
    }
    limits.map(|[low, high]| {
        let margin = COORDINATE_MARGIN[0] * (high - low) + COORDINATE_MARGIN[1];
        if low <= high { [low - margin, high + margin] } else { [0.0; 2] }
    })
}

impl Patch {
    fn write(&self, out: &mut Vec<u8>) {
        let has_normals = self.vertices.iter().any(|vertex| vertex.normal.is_some());
        let has_coordinates = self.vertices.iter().any(|vertex| vertex.coordinates.is_some());
        let flags = HAS_POSITIONS
            | if has_normals { HAS_NORMALS } else { 0 }
            | if has_coordinates { HAS_COORDINATES } else { 0 };
        push_integer(out, flags as i64, 1);
        push_integer(out, self.vertices.len() as i64, 2);
        let mut push = |word: u32| out.extend_from_slice(&word.to_be_bytes());
        self.vertices.iter().flat_map(|vertex| vertex.position).for_each(&mut push);
        if has_normals {
            self.vertices.iter().for_each(|vertex| push(vertex.normal.unwrap_or(0)));
        }
        if has_coordinates {
            self.vertices.iter().flat_map(|vertex| vertex.coordinates.unwrap_or_default()).for_each(&mut push);
        }
        push_integer(out, self.own.len() as i64, 2);
        self.own.iter().for_each(|(corners, _)| out.extend_from_slice(corners));
        let first = self.own.first().map_or(-1, |(_, material)| *material);
        if self.own.iter().all(|(_, material)| *material == first) {
            push_integer(out, 1, 2);
            push_integer(out, first, 2);
        } else {
            push_integer(out, self.own.len() as i64, 2);
            self.own.iter().for_each(|(_, material)| push_integer(out, *material, 2));
        }
        for joined in [&self.joins_one, &self.joins_two] {
            push_integer(out, joined.len() as i64, 2);
            for triangle in joined {
                triangle.others.iter().for_each(|name| push_integer(out, i64::from(*name), 4));
                out.extend_from_slice(&triangle.own);
                push_integer(out, triangle.material, 2);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mesh;

    /// A wavy grid, with enough vertices for several patches.
    fn grid(steps: usize) -> MeshParts<'static> {
        let corner = |x: usize, y: usize| {
            let [u, v] = [x as f64 / steps as f64, y as f64 / steps as f64];
            let normal = Some([0.0, 0.6, 0.8]).filter(|_| !x.is_multiple_of(7));
            Corner { position: [u, v, 0.1 * (9.0 * u).sin()], normal, coordinates: Some([u, 2.0 * v]) }
        };
        let mut facets = Vec::new();
        for (x, y) in (0..steps * steps).map(|at| (at % steps, at / steps)) {
            let material = [None, Some(0), Some(1)][(x + y) % 3];
            facets.push(Facet { corners: [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1)], material });
            facets.push(Facet { corners: [corner(x, y), corner(x + 1, y + 1), corner(x, y + 1)], material });
        }
        let paint = |name: &'static str| Object {
            kind: b"plastic"[..].into(),
            modifier: None,
            name: name.as_bytes().into(),
            strings: Vec::new(),
            reals: vec![0.5; 5],
        };
        let mut header = Header::new("RADIANCE");
        header.push_variable("FORMAT", crate::MESH_FORMAT);
        MeshParts { header, origin: [-0.5; 3], size: 2.0, objects: vec![paint("a"), paint("b")], facets }
    }

    /// Positions, normals and materials of all triangles, sorted so that patches do not matter.
    fn sorted(mut triangles: Vec<String>) -> Vec<String> {
        triangles.sort();
        triangles
    }

    #[test]
    fn what_is_written_is_read() {
        let parts = grid(30);
        let all = (0..parts.facets.len() as u32).collect::<Vec<_>>();
        let leaves: Vec<Tree> = all.chunks(225).map(|part| Tree::Full(part.to_vec())).collect();
        let tree = Tree::Split(Box::new(leaves.try_into().expect("eight leaves")));
        let bytes = parts.write(&tree).unwrap();
        let mesh = Mesh::read(&bytes).unwrap();
        assert_eq!(mesh.objects, parts.objects);
        let text = |position: [f64; 3], normal: Option<[f64; 3]>, pair: Option<[f64; 2]>| {
            let normal = normal.map(|normal| normal.map(|value| (value * 1e3).round() + 0.0));
            let pair = pair.map(|pair| pair.map(|value| (value * 1e5).round() + 0.0));
            format!("{:?}{normal:?}{pair:?}", position.map(|value| (value * 1e7).round() + 0.0))
        };
        let read = mesh.triangles.iter().map(|triangle| {
            let corners = triangle.vertices.map(|vertex| {
                let vertex = vertex as usize;
                text(mesh.vertices[vertex], mesh.normals[vertex], mesh.coordinates[vertex])
            });
            least_turn(corners) + &format!("{:?}", triangle.material)
        });
        let written = parts.facets.iter().map(|facet| {
            let corners = facet.corners.map(|corner| text(corner.position, corner.normal, corner.coordinates));
            least_turn(corners) + &format!("{:?}", facet.material)
        });
        assert_eq!(sorted(read.collect()), sorted(written.collect()));
    }

    /// The corners rotated so that the least comes first; the orientation is kept.
    fn least_turn([a, b, c]: [String; 3]) -> String {
        let turns = [[&a, &b, &c], [&b, &c, &a], [&c, &a, &b]];
        turns.map(|turn| turn.map(String::as_str).concat()).into_iter().min().unwrap_or_default()
    }
}
