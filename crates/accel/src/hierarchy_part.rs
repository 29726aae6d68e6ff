//! Boxes of the binary tree that building makes, and what its leaves are.

use crate::hierarchy_child::{Child, LARGEST_LEAF};
use glam::Vec3;

/// What it costs to open a box, in tests.
pub(crate) const OPENING: f32 = 0.5;

/// What a leaf is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Leaves {
    /// Items that are tested one after the other.
    Slots,
    /// Up to four triangles that are tested at once.
    Blocks,
}

impl Leaves {
    /// What it costs to test so many items, in tests.
    #[inline]
    pub(crate) fn cost(self, count: u32) -> f32 {
        match self {
            Leaves::Slots => count as f32,
            Leaves::Blocks => count.div_ceil(LARGEST_LEAF as u32) as f32,
        }
    }
}

/// A box of the binary tree. The first of the two in it is the next part.
#[derive(Clone, Copy)]
pub(crate) struct Part {
    pub(crate) low: Vec3,
    /// What a leaf holds.
    pub(crate) leaf: Child,
    pub(crate) high: Vec3,
    /// How many parts on from here the second box in it is; zero in leaves.
    pub(crate) right: u32,
}

impl Part {
    pub(crate) fn leaf(low: Vec3, high: Vec3, leaf: Child) -> Part {
        Part { low, leaf, high, right: 0 }
    }

    /// Of two boxes; where the second one is, is told later.
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
