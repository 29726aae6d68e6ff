//! The children of nodes, and the entries of the traversal stack.

/// A node, or up to four items: by their slots, or by the index of their block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Child(pub(crate) u32);

/// Maximum number of items of a leaf.
pub(crate) const MAX_LEAF_ITEMS: usize = 4;

const LEAF: u32 = 1 << 31;
const COUNT_SHIFT: u32 = 29;

impl Child {
    /// An empty child.
    pub(crate) const NONE: Child = Child(!LEAF);

    /// Maximum number of items of a hierarchy.
    const MAX_ITEMS: u32 = 1 << COUNT_SHIFT;

    pub(crate) fn node(index: usize) -> Child {
        Child(index as u32)
    }

    /// Items in `count` slots from `first` on: 1 to [`MAX_LEAF_ITEMS`].
    pub(crate) fn leaf(first: usize, count: usize) -> Child {
        Child(LEAF | (count as u32 - 1) << COUNT_SHIFT | first as u32)
    }

    #[inline]
    pub(crate) fn is_leaf(self) -> bool {
        self.0 & LEAF != 0
    }

    #[inline]
    pub(crate) fn slots(self) -> std::ops::Range<u32> {
        let first = self.0 & (Child::MAX_ITEMS - 1);
        first..first + (self.0 >> COUNT_SHIFT & 3) + 1
    }

    pub(crate) fn block(index: usize) -> Child {
        Child(LEAF | index as u32)
    }

    #[inline]
    pub(crate) fn block_index(self) -> usize {
        (self.0 & !LEAF) as usize
    }
}

/// A child on the stack, in the bits below its entry distance: integers of this form are ordered
/// like the distances, which are not negative.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct PendingChild(u64);

impl PendingChild {
    #[inline]
    pub(crate) fn new(child: Child, entry: f32) -> PendingChild {
        PendingChild(u64::from(entry.to_bits()) << 32 | u64::from(child.0))
    }

    #[inline]
    pub(crate) fn child(self) -> Child {
        Child(self.0 as u32)
    }

    #[cfg(test)]
    pub(crate) fn entry(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    /// Whether its box is entered at `farthest`, which is not negative, or before.
    #[inline]
    pub(crate) fn is_entered_before(self, farthest: f32) -> bool {
        (self.0 >> 32) as u32 <= farthest.to_bits()
    }
}
