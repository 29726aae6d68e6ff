//! Meshes, as `obj2mesh` writes them.
//!
//! A mesh file (`.rtm`) holds an octree over triangles, the materials, and *patches* of up to 256
//! vertices: positions with 32 bits per coordinate in the bounding cube, normals in 32 bits, local
//! coordinates with 32 bits each between limits. A triangle belongs to the patch of its last
//! vertex. It refers to vertices of that patch by one byte, and to those of other patches by a
//! number (Radiance's `mesh.h` and `readmesh.c`).

use crate::FormatError;
use crate::direction;
use crate::object::{Object, read_objects};
use crate::octree::{index_size, read_cube};
use crate::portable::Reader;
use crate::tree;
use radsight_picture::Header;

/// The format name in the header.
pub const MESH_FORMAT: &str = "Radiance_tmesh";

/// The magic number, without the size of an object index.
pub(crate) const MAGIC: i64 = 319;

pub(crate) const HAS_POSITIONS: usize = 1;
pub(crate) const HAS_NORMALS: usize = 2;
pub(crate) const HAS_COORDINATES: usize = 4;

/// Largest number of vertices of a patch.
pub(crate) const MOST_IN_PATCH: usize = 256;

/// Scale of 32-bit coordinates.
const FULL: f64 = 4_294_967_296.0;

/// A mesh file without its octree.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh<'a> {
    /// The information header.
    pub header: Header,
    /// The corner of the cube with the smallest coordinates.
    pub origin: [f64; 3],
    /// Length of an edge of the cube.
    pub size: f64,
    /// Modifiers, some of which are the materials of triangles.
    pub objects: Vec<Object<'a>>,
    /// Positions.
    pub vertices: Vec<[f64; 3]>,
    /// Unit normals, one per vertex; empty if no vertex has one.
    pub normals: Vec<Option<[f64; 3]>>,
    /// Local coordinates, one pair per vertex; empty if no vertex has any.
    pub coordinates: Vec<Option<[f64; 2]>>,
    /// Triangles in the order of the patches.
    pub triangles: Vec<Triangle>,
}

/// A triangle of a [`Mesh`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Triangle {
    /// Indices of its vertices, counter-clockwise seen from the front.
    pub vertices: [u32; 3],
    /// Index of its material among the objects.
    pub material: Option<u32>,
}

impl<'a> Mesh<'a> {
    /// Reads a mesh. Its octree is checked, but not kept.
    ///
    /// # Errors
    /// When the bytes are not a whole mesh.
    pub fn read(bytes: &'a [u8]) -> Result<Self, FormatError> {
        let (header, mut reader) = Reader::new(bytes, MESH_FORMAT)?;
        let index_size = index_size(&mut reader, MAGIC)?;
        let (origin, size) = read_cube(&mut reader)?;
        let mut limits = [[0.0; 2]; 2];
        for axis in &mut limits {
            *axis = [reader.float("a limit of local coordinates")?, reader.float("a limit of local coordinates")?];
        }
        tree::skip(&mut reader, index_size)?;
        let objects = read_objects(&mut reader, index_size)?;
        let mesh = Mesh {
            header,
            origin,
            size,
            objects,
            vertices: Vec::new(),
            normals: Vec::new(),
            coordinates: Vec::new(),
            triangles: Vec::new(),
        };
        let mut patches = Patches { mesh, limits, starts: vec![0], triangles: Vec::new() };
        let count = reader.integer_in(4, 0..=1 << 22, "the number of patches")?;
        for _ in 0..count {
            patches.read_patch(&mut reader)?;
        }
        patches.finish(&reader)
    }
}

/// A reference from a triangle to a vertex, with its offset in the file.
#[derive(Clone, Copy)]
struct VertexName {
    /// Patch, and index in it.
    id: u32,
    offset: usize,
}

/// The state of reading patches.
struct Patches<'a> {
    mesh: Mesh<'a>,
    /// Smallest and largest value of each local coordinate.
    limits: [[f64; 2]; 2],
    /// Index of the first vertex of each patch; the last entry is the total.
    starts: Vec<u32>,
    /// Triangles whose vertices may lie in patches not read yet.
    triangles: Vec<([VertexName; 3], Option<u32>)>,
}

impl<'a> Patches<'a> {
    fn read_patch(&mut self, reader: &mut Reader<'a>) -> Result<(), FormatError> {
        let offset = reader.offset();
        let flags = reader.integer(1, "the flags of a patch")? as usize;
        if flags & HAS_POSITIONS == 0 || flags & !(HAS_POSITIONS | HAS_NORMALS | HAS_COORDINATES) != 0 {
            return Err(reader.unexpected(offset, "the flags of a patch", flags));
        }
        let count = reader.integer_in(2, 1..=256, "a number of vertices")?;
        self.read_positions(reader, count)?;
        if flags & HAS_NORMALS != 0 {
            self.read_normals(reader, count)?;
        }
        if flags & HAS_COORDINATES != 0 {
            self.read_coordinates(reader, count)?;
        }
        let patch = self.starts.len() as u32 - 1;
        self.starts.push(self.mesh.vertices.len() as u32);
        self.read_triangles(reader, patch)
    }

    fn read_positions(&mut self, reader: &mut Reader<'a>, count: usize) -> Result<(), FormatError> {
        let (bytes, _) = reader.take(12 * count, "the positions of vertices")?.as_chunks::<12>();
        let step = self.mesh.size / FULL;
        let origin = self.mesh.origin;
        self.mesh.vertices.extend(
            bytes
                .iter()
                .map(|vertex| std::array::from_fn(|axis| origin[axis] + (f64::from(word(vertex, axis)) + 0.5) * step)),
        );
        Ok(())
    }

    fn read_normals(&mut self, reader: &mut Reader<'a>, count: usize) -> Result<(), FormatError> {
        let (bytes, _) = reader.take(4 * count, "the normals of vertices")?.as_chunks::<4>();
        self.mesh.normals.resize(self.mesh.vertices.len() - count, None);
        self.mesh.normals.extend(bytes.iter().map(|code| direction::decode(word(code, 0))));
        Ok(())
    }

    fn read_coordinates(&mut self, reader: &mut Reader<'a>, count: usize) -> Result<(), FormatError> {
        let (bytes, _) = reader.take(8 * count, "the local coordinates of vertices")?.as_chunks::<8>();
        let limits = self.limits;
        self.mesh.coordinates.resize(self.mesh.vertices.len() - count, None);
        self.mesh.coordinates.extend(bytes.iter().map(|pair| {
            let place = |axis: usize| {
                let [low, high] = limits[axis];
                low + (high - low) * (f64::from(word(pair, axis)) + 0.5) / FULL
            };
            (word(pair, 0) != 0).then(|| [place(0), place(1)])
        }));
        Ok(())
    }

    fn read_triangles(&mut self, reader: &mut Reader<'a>, patch: u32) -> Result<(), FormatError> {
        let local = reader.integer_in(2, 0..=512, "a number of triangles")?;
        let first = self.triangles.len();
        for _ in 0..local {
            let vertices = [local_vertex(reader, patch)?, local_vertex(reader, patch)?, local_vertex(reader, patch)?];
            self.triangles.push((vertices, None));
        }
        if reader.integer(2, "a number of materials")? > 1 {
            for at in first..self.triangles.len() {
                self.triangles[at].1 = self.material(reader)?;
            }
        } else {
            let material = reader.clone();
            let index = reader.integer(2, "a material")?;
            if local > 0 || index != -1 {
                let material = self.material(&mut material.clone())?;
                self.triangles[first..].iter_mut().for_each(|triangle| triangle.1 = material);
            }
        }
        for _ in 0..reader.integer_in(2, 0..=256, "a number of triangles across two patches")? {
            let vertices = [far_vertex(reader)?, local_vertex(reader, patch)?, local_vertex(reader, patch)?];
            let material = self.material(reader)?;
            self.triangles.push((vertices, material));
        }
        for _ in 0..reader.integer_in(2, 0..=256, "a number of triangles across three patches")? {
            let vertices = [far_vertex(reader)?, far_vertex(reader)?, local_vertex(reader, patch)?];
            let material = self.material(reader)?;
            self.triangles.push((vertices, material));
        }
        Ok(())
    }

    /// The index of a material, or -1 for none.
    fn material(&self, reader: &mut Reader<'a>) -> Result<Option<u32>, FormatError> {
        let offset = reader.offset();
        let index = reader.integer(2, "a material")?;
        let count = self.mesh.objects.len();
        match index {
            -1 => Ok(None),
            _ if index >= 0 && (index as usize) < count => Ok(Some(index as u32)),
            _ => Err(reader.unexpected(offset, format!("one of the {count} materials"), index)),
        }
    }

    fn finish(self, reader: &Reader<'a>) -> Result<Mesh<'a>, FormatError> {
        let Patches { mut mesh, starts, triangles, .. } = self;
        let index = |name: VertexName| {
            let patch = (name.id >> 8) as usize;
            let range = starts.get(patch).zip(starts.get(patch + 1));
            let found = range.and_then(|(start, end)| Some(start + (name.id & 0xff)).filter(|found| found < end));
            found.ok_or_else(|| reader.unexpected(name.offset, "a vertex of the mesh", name.id))
        };
        mesh.triangles.reserve_exact(triangles.len());
        for ([a, b, c], material) in triangles {
            mesh.triangles.push(Triangle { vertices: [index(a)?, index(b)?, index(c)?], material });
        }
        let (count, normals, coordinates) = (mesh.vertices.len(), &mut mesh.normals, &mut mesh.coordinates);
        if !normals.is_empty() {
            normals.resize(count, None);
        }
        if !coordinates.is_empty() {
            coordinates.resize(count, None);
        }
        Ok(mesh)
    }
}

/// A vertex of the patch itself.
fn local_vertex(reader: &mut Reader<'_>, patch: u32) -> Result<VertexName, FormatError> {
    let offset = reader.offset();
    let index = reader.integer(1, "a vertex of a triangle")? & 0xff;
    Ok(VertexName { id: patch << 8 | index as u32, offset })
}

/// A vertex of any patch.
fn far_vertex(reader: &mut Reader<'_>) -> Result<VertexName, FormatError> {
    let offset = reader.offset();
    let id = reader.integer(4, "a vertex of a triangle")? as u32;
    Ok(VertexName { id, offset })
}

/// The `index`-th four-byte word, big-endian.
fn word(bytes: &[u8], index: usize) -> u32 {
    bytes[4 * index..4 * index + 4].iter().fold(0, |sum, byte| sum << 8 | u32::from(*byte))
}
