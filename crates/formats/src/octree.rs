//! Octrees, as `oconv` writes them.
//!
//! An octree file (`.oct`) has an information header, the bounding cube, the names of scene files,
//! and the tree of cubes with the indices of the surfaces in each. A frozen octree has the
//! primitives themselves instead of names (Radiance's `readoct.c` and `sceneio.c`). Objects are
//! numbered in the order of the scene text, including modifiers and aliases.

use crate::FormatError;
use crate::object::{Object, PackedObjects, write_objects};
use crate::portable::{Reader, push_integer, push_string};
use crate::tree::{self, Tree};
use radsight_picture::{Header, general};

/// Significant digits of the cube, as in real `oconv`.
const CUBE_DIGITS: usize = 12;

/// The format name in the header.
pub const OCTREE_FORMAT: &str = "Radiance_octree";

/// The magic number, without the size of an object index.
const MAGIC: i64 = 283;

/// Size of an object index in bytes, as Radiance writes it.
const INDEX_SIZE: usize = 4;

/// An octree file without its tree of cubes. The primitives of a frozen octree are of type `O`.
#[derive(Clone, Debug, PartialEq)]
pub struct Octree<'a, O = Vec<Object<'a>>> {
    /// The information header.
    pub header: Header,
    /// The corner of the cube with the smallest coordinates.
    pub origin: [f64; 3],
    /// Length of an edge of the cube: positive, or zero if there is no surface.
    pub size: f64,
    /// Number of primitives.
    pub object_count: usize,
    /// Where the primitives are.
    pub content: OctreeContent<'a, O>,
}

/// Where the primitives of an octree are stored.
#[derive(Clone, Debug, PartialEq)]
pub enum OctreeContent<'a, O = Vec<Object<'a>>> {
    /// In scene files, or commands after `!`.
    Files(Vec<&'a [u8]>),
    /// In the octree itself: it is frozen.
    Objects(O),
}

impl<'a> Octree<'a> {
    /// Whether the bytes begin like an octree.
    #[must_use]
    pub fn is_octree(bytes: &[u8]) -> bool {
        bytes.starts_with(b"#?") && Reader::new(bytes, OCTREE_FORMAT).is_ok()
    }

    /// Reads an octree. Its tree is checked but not kept.
    ///
    /// # Errors
    /// When the bytes are not a complete octree.
    pub fn read(bytes: &'a [u8]) -> Result<Self, FormatError> {
        let Octree { header, origin, size, object_count, content } = Octree::read_packed(bytes)?;
        let content = match content {
            OctreeContent::Files(files) => OctreeContent::Files(files),
            OctreeContent::Objects(packed) => OctreeContent::Objects(packed.to_vec()),
        };
        Ok(Octree { header, origin, size, object_count, content })
    }

    /// Writes an octree in the form that Radiance's programs read.
    ///
    /// # Errors
    /// When an object has more arguments than the format can hold.
    pub fn write(&self, tree: &Tree) -> Result<Vec<u8>, FormatError> {
        let mut out = self.header.to_bytes();
        push_integer(&mut out, MAGIC + INDEX_SIZE as i64, 2);
        for number in self.origin.into_iter().chain([self.size]) {
            push_string(&mut out, general(number, CUBE_DIGITS).as_bytes());
        }
        if let OctreeContent::Files(files) = &self.content {
            files.iter().for_each(|file| push_string(&mut out, file));
        }
        push_string(&mut out, b"");
        push_integer(&mut out, self.object_count as i64, INDEX_SIZE);
        tree::write(&mut out, tree, INDEX_SIZE);
        if let OctreeContent::Objects(objects) = &self.content {
            write_objects(&mut out, objects, INDEX_SIZE)?;
        }
        Ok(out)
    }
}

impl<'a> Octree<'a, PackedObjects<'a>> {
    /// Reads an octree whose primitives are unpacked one by one.
    ///
    /// # Errors
    /// When the bytes are not a complete octree.
    pub fn read_packed(bytes: &'a [u8]) -> Result<Self, FormatError> {
        let (header, mut reader) = Reader::new(bytes, OCTREE_FORMAT)?;
        let size = index_size(&mut reader, MAGIC)?;
        let (origin, edge) = read_cube(&mut reader)?;
        let mut files = Vec::new();
        loop {
            match reader.string("the name of a scene file")? {
                b"" => break,
                name => files.push(name),
            }
        }
        let object_count = reader.integer_in(size, 0..=i64::from(i32::MAX), "the number of objects")?;
        tree::skip(&mut reader, size)?;
        let content = if files.is_empty() {
            OctreeContent::Objects(PackedObjects::read(&mut reader, size)?)
        } else {
            OctreeContent::Files(files)
        };
        Ok(Octree { header, origin, size: edge, object_count, content })
    }
}

/// The size of an index in bytes, which is added to a magic number.
pub(crate) fn index_size(reader: &mut Reader<'_>, magic: i64) -> Result<usize, FormatError> {
    let offset = reader.offset();
    let found = reader.integer(2, "a magic number")?;
    match found - magic {
        size @ 1..=8 => Ok(size as usize),
        _ => Err(reader.unexpected(offset, format!("a magic number from {} to {}", magic + 1, magic + 8), found)),
    }
}

/// The corner and the edge of a cube.
pub(crate) fn read_cube(reader: &mut Reader<'_>) -> Result<([f64; 3], f64), FormatError> {
    let mut origin = [0.0; 3];
    for coordinate in &mut origin {
        *coordinate = reader.number_string("a coordinate of the cube")?;
    }
    let offset = reader.offset();
    let size = reader.number_string("the size of the cube")?;
    if size < 0.0 {
        return Err(reader.unexpected(offset, "a size not below zero", size));
    }
    Ok((origin, size))
}
