//! The binary tree made by builders, and the kinds of its leaves.

use crate::hierarchy_child::{Child, MAX_LEAF_ITEMS};
use glam::Vec3;

/// Cost of opening a box, in tests.
const BOX_COST: f32 = 0.5;

/// The kind of a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Leaves {
    /// Items that are tested one by one.
    Slots,
    /// Up to four triangles that are tested at once.
    Blocks,
    /// The same, with other items among them that are tested one by one.
    MixedBlocks,
}

impl Leaves {
    /// The leaves of a hierarchy of `count` items, so many of which are triangles.
    pub(crate) fn of(triangles: usize, count: usize) -> Leaves {
        // Blocks do not pay with few triangles among other items.
        if 2 * triangles <= count {
            return Leaves::Slots;
        }
        if triangles == count { Leaves::Blocks } else { Leaves::MixedBlocks }
    }

    /// Cost of opening a box, in tests. Small boxes pay where a test may include single items.
    #[inline]
    pub(crate) fn box_cost(self) -> f32 {
        match self {
            Leaves::Slots | Leaves::Blocks => BOX_COST,
            Leaves::MixedBlocks => 0.0,
        }
    }

    /// Cost of testing this number of items, in tests.
    #[inline]
    pub(crate) fn cost(self, count: u32) -> f32 {
        match self {
            Leaves::Slots => count as f32,
            Leaves::Blocks | Leaves::MixedBlocks => count.div_ceil(MAX_LEAF_ITEMS as u32) as f32,
        }
    }
}

/// A box of the binary tree. Its first child is the next part.
#[derive(Clone, Copy)]
pub(crate) struct Part {
    pub(crate) low: Vec3,
    /// The content of a leaf.
    pub(crate) leaf: Child,
    pub(crate) high: Vec3,
    /// Offset to the second child; zero in leaves.
    pub(crate) right: u32,
}

impl Part {
    pub(crate) fn leaf(low: Vec3, high: Vec3, leaf: Child) -> Part {
        Part { low, leaf, high, right: 0 }
    }

    /// An inner box; the offset of its second child is set later.
    pub(crate) fn branch(low: Vec3, high: Vec3) -> Part {
        Part { low, leaf: Child::NONE, high, right: 0 }
    }

    pub(crate) fn set_right(&mut self, parts_on: usize) {
        self.right = parts_on as u32;
    }

    pub(crate) fn half_area(&self) -> f32 {
        let size = self.high - self.low;
        size.x * size.y + size.y * size.z + size.z * size.x
    }
}
