//! What stands in a node of the hierarchy, and what waits to be visited.

/// A node, or up to four items: by their slots, or the number of their block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Child(pub(crate) u32);

/// Most items of a box without boxes in it.
pub(crate) const LARGEST_LEAF: usize = 4;

const LEAF: u32 = 1 << 31;
const COUNT_SHIFT: u32 = 29;

impl Child {
    /// Nothing at all.
    pub(crate) const NONE: Child = Child(!LEAF);

    /// Most items of a hierarchy.
    const MOST_ITEMS: u32 = 1 << COUNT_SHIFT;

    pub(crate) fn node(index: usize) -> Child {
        Child(index as u32)
    }

    /// Items in `count` slots from `first` on: 1 to [`LARGEST_LEAF`].
    pub(crate) fn leaf(first: usize, count: usize) -> Child {
        Child(LEAF | (count as u32 - 1) << COUNT_SHIFT | first as u32)
    }

    #[inline]
    pub(crate) fn is_leaf(self) -> bool {
        self.0 & LEAF != 0
    }

    #[inline]
    pub(crate) fn slots(self) -> std::ops::Range<u32> {
        let first = self.0 & (Child::MOST_ITEMS - 1);
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

/// A child that waits, below the distance at which the ray enters it: numbers of this kind stand in the order of the distances, which
/// are not negative.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Waiting(u64);

impl Waiting {
    #[inline]
    pub(crate) fn new(child: Child, entry: f32) -> Waiting {
        Waiting(u64::from(entry.to_bits()) << 32 | u64::from(child.0))
    }

    #[inline]
    pub(crate) fn child(self) -> Child {
        Child(self.0 as u32)
    }

    #[inline]
    pub(crate) fn entry(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }
}
