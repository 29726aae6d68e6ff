//! Compiled files of Radiance: octrees (`.oct`), meshes (`.rtm`), polygonal fonts (`.fnt`).
//!
//! The crate converts bytes to structs and structs to bytes. Reading takes time and memory
//! proportional to the length of any input. An error gives the offset and what was expected there.
//! Real Radiance reads what is written.
//!
//! Knows neither scenes nor rays: primitives are lists of words and numbers here, and `parse` makes
//! a scene of them. Octree cells are checked and dropped, since radsight traces rays with its own
//! bounding volume hierarchy.
//!
//! ```
//! use radsight_formats::{Octree, OctreeContent, Tree};
//! use radsight_picture::Header;
//! let mut header = Header::new("RADIANCE");
//! header.push_command(["oconv", "room.rad"]);
//! header.push_variable("FORMAT", radsight_formats::OCTREE_FORMAT);
//! let content = OctreeContent::Files(vec![b"room.rad"]);
//! let octree = Octree { header, origin: [0.0; 3], size: 2.0, object_count: 1, content };
//! let bytes = octree.write(&Tree::Full(vec![0])).unwrap();
//! assert_eq!(Octree::read(&bytes).unwrap(), octree);
//! ```
#![forbid(unsafe_code)]

mod direction;
mod error;
mod font;
pub mod library;
mod mesh;
mod mesh_write;
mod object;
mod octree;
mod portable;
mod tree;

pub use error::FormatError;
pub use font::{Font, Glyph};
pub use mesh::{MESH_FORMAT, Mesh, Triangle};
pub use mesh_write::{Corner, Facet, MeshParts};
pub use object::{Object, PackedObjects};
pub use octree::{OCTREE_FORMAT, Octree, OctreeContent};
pub use tree::{MOST_IN_A_CUBE, Tree};
