//! The tree of cubes in octrees and meshes.

use crate::FormatError;
use crate::portable::{Reader, push_integer};

const EMPTY: u8 = 0;
const FULL: u8 = 1;
const TREE: u8 = 2;

/// Largest number of objects in one cube.
pub const MOST_IN_A_CUBE: usize = 511;

/// A cube and its contents. Child `i` is the half towards larger x if `i & 1`, y if `i & 2`, z if
/// `i & 4`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Tree {
    /// No object.
    Empty,
    /// The indices of objects, ascending; at most [`MOST_IN_A_CUBE`].
    Full(Vec<u32>),
    /// Eight cubes of half the size.
    Split(Box<[Tree; 8]>),
}

/// Checks the form of a tree and skips it. Takes time and memory proportional to its length, since
/// every node takes a byte.
pub(crate) fn skip(reader: &mut Reader<'_>, size: usize) -> Result<(), FormatError> {
    let mut waiting = 1_usize;
    while waiting > 0 {
        waiting -= 1;
        let offset = reader.offset();
        match reader.take(1, "a cube of the octree")? {
            [EMPTY] => {}
            [FULL] => {
                let count = reader.integer_in(size, 0..=MOST_IN_A_CUBE as i64, "a number of objects")?;
                reader.take(count * size, "the objects of a cube")?;
            }
            [TREE] => waiting += 8,
            other => return Err(reader.unexpected(offset, "the octree", format!("{other:?}"))),
        }
    }
    Ok(())
}

/// Appends a tree, parents first.
pub(crate) fn write(out: &mut Vec<u8>, tree: &Tree, size: usize) {
    let mut waiting = vec![tree];
    while let Some(tree) = waiting.pop() {
        match tree {
            Tree::Empty => out.push(EMPTY),
            Tree::Full(objects) => {
                out.push(FULL);
                push_integer(out, objects.len() as i64, size);
                objects.iter().for_each(|object| push_integer(out, i64::from(*object), size));
            }
            Tree::Split(children) => {
                out.push(TREE);
                waiting.extend(children.iter().rev());
            }
        }
    }
}
