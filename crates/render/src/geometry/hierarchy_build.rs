//! Building a hierarchy from the top down: where to cut is decided by the surface area heuristic, over bins along the axes of
//! the centres (Wald, "On fast construction of SAH-based bounding volume hierarchies", IEEE Symposium on Interactive Ray Tracing, 2007).

use super::hierarchy::{Child, LARGEST_LEAF};
use super::hierarchy_node::{Node, WIDTH};
use glam::{Vec3, Vec4, Vec4Swizzles};
use rayon::prelude::*;

/// Nodes, and the items by slot.
pub(super) struct Built {
    pub(super) nodes: Vec<Node>,
    pub(super) root: Child,
    pub(super) order: Vec<u32>,
}

/// An item's box; the fourth number of `low` holds the bits of the item's number.
#[derive(Clone, Copy)]
struct Item {
    low: Vec4,
    high: Vec4,
}

/// A box that grows. Its fourth numbers mean nothing.
#[derive(Clone, Copy)]
struct Hull {
    low: Vec4,
    high: Vec4,
}

/// What a leaf is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Leaves {
    /// Items that are tested one after the other.
    Slots,
    /// Up to four triangles that are tested at once.
    Blocks,
}

impl Leaves {
    /// What it costs to test so many items, in tests.
    #[inline]
    fn cost(self, count: u32) -> f32 {
        match self {
            Leaves::Slots => count as f32,
            Leaves::Blocks => count.div_ceil(LARGEST_LEAF as u32) as f32,
        }
    }
}

const BINS: usize = 16;

/// An axis along which the centres reach less than this share of the widest one is not tried.
const NARROW: f32 = 0.25;

/// What it costs to open a box, in tests.
const OPENING: f32 = 0.5;

/// More items than this are shared out between threads.
const PARALLEL: usize = 1 << 15;

/// From this depth on items are halved by number, so that no arrangement of items makes the hierarchy deep.
const DEEPEST_CHOICE: u32 = 40;

/// Builds over `count` items with the boxes that `box_of` tells, low and high corner.
pub(super) fn build(count: usize, leaves: Leaves, box_of: impl Fn(usize) -> [Vec3; 2]) -> Built {
    let mut items: Vec<Item> = (0..count)
        .map(|index| {
            let [low, high] = box_of(index);
            Item { low: low.extend(f32::from_bits(index as u32)), high: high.extend(0.0) }
        })
        .collect();
    let mut nodes = Vec::new();
    let root = if count == 0 { Child::node(0) } else { Range::of(&items).build(&mut items, 0, &mut nodes, leaves, 0) };
    let order = items.iter().map(|item| item.low.w.to_bits()).collect();
    nodes.shrink_to_fit();
    Built { nodes, root, order }
}

/// Items that stand together, before it is decided how they are cut.
#[derive(Clone, Copy)]
struct Range {
    start: usize,
    end: usize,
    hull: Hull,
    /// Around the sums of the corners of each item's box.
    centers: Hull,
}

impl Range {
    fn of(items: &[Item]) -> Range {
        let mut range = Range { start: 0, end: items.len(), hull: Hull::EMPTY, centers: Hull::EMPTY };
        for item in items {
            range.hull.add(item.low, item.high);
            range.centers.add(item.center(), item.center());
        }
        range
    }

    fn len(&self) -> usize {
        self.end - self.start
    }

    /// Makes the child of all items of the range, which have slots from `first_slot` on.
    fn build(self, items: &mut [Item], first_slot: usize, nodes: &mut Vec<Node>, leaves: Leaves, depth: u32) -> Child {
        let Some((left, right)) = self.cut(items, leaves, depth) else { return Child::leaf(first_slot, items.len()) };
        let mut ranges = [left; WIDTH];
        ranges[1] = right;
        let mut uncut = [true; WIDTH];
        let mut count = 2;
        while count < WIDTH {
            let weight = |index: usize| ranges[index].hull.half_area() * ranges[index].len() as f32;
            let candidates = (0..count).filter(|index| uncut[*index] && ranges[*index].len() > 1);
            let Some(widest) = candidates.max_by(|a, b| weight(*a).total_cmp(&weight(*b))) else { break };
            match ranges[widest].cut(items, leaves, depth + 1) {
                Some((left, right)) => {
                    ranges.copy_within(widest + 1..count, widest + 2);
                    uncut.copy_within(widest + 1..count, widest + 2);
                    (ranges[widest], ranges[widest + 1]) = (left, right);
                    (uncut[widest], uncut[widest + 1]) = (true, true);
                    count += 1;
                }
                None => uncut[widest] = false,
            }
        }
        let own = nodes.len();
        let boxes = ranges.map(|range| [range.hull.low.xyz(), range.hull.high.xyz()]);
        nodes.push(Node::around(&boxes[..count]));
        let children = build_children(&ranges[..count], items, first_slot, nodes, leaves, depth + 3);
        nodes[own].children[..count].copy_from_slice(&children[..count]);
        Child::node(own)
    }

    /// Where to cut the range, the items put in order; `None` where a leaf is better.
    fn cut(&self, items: &mut [Item], leaves: Leaves, depth: u32) -> Option<(Range, Range)> {
        let count = self.len();
        if count < 2 {
            return None;
        }
        let extent = (self.centers.high - self.centers.low).xyz();
        let scale = extent.map(|extent| BINS as f32 * (1.0 - 1e-6) / extent);
        if depth >= DEEPEST_CHOICE || !scale.min_element().is_finite() {
            return (count > LARGEST_LEAF).then(|| self.halve(items));
        }
        let low = self.centers.low.xyz();
        let bin_of =
            |item: &Item, axis: usize| (((item.center()[axis] - low[axis]) * scale[axis]) as usize).min(BINS - 1);
        let mut best = (0, None, f32::INFINITY);
        let widest = extent.max_element();
        for axis in (0..3).filter(|axis| extent[*axis] >= NARROW * widest) {
            let mut bins = [(Hull::EMPTY, 0_u32); BINS];
            for item in &items[self.start..self.end] {
                let bin = &mut bins[bin_of(item, axis)];
                bin.0.add(item.low, item.high);
                bin.1 += 1;
            }
            let (first_right, cost) = cheapest(&bins, leaves);
            if cost < best.2 {
                best = (axis, first_right, cost);
            }
        }
        let (axis, first_right, cost) = best;
        let area = self.hull.half_area();
        let leaf_is_best = leaves.cost(count as u32) * area <= OPENING * area + cost;
        match first_right {
            _ if count <= LARGEST_LEAF && leaf_is_best => None,
            Some(first_right) => Some(self.partition(items, |item| bin_of(item, axis) < first_right)),
            None => Some(self.halve(items)),
        }
    }

    fn halve(&self, items: &mut [Item]) -> (Range, Range) {
        let middle = self.start + self.len() / 2;
        let part = |start, end| {
            let part = Range::of(&items[start..end]);
            Range { start, end, ..part }
        };
        (part(self.start, middle), part(middle, self.end))
    }

    fn partition(&self, items: &mut [Item], is_left: impl Fn(&Item) -> bool) -> (Range, Range) {
        let empty = |at| Range { start: at, end: at, hull: Hull::EMPTY, centers: Hull::EMPTY };
        let (mut left, mut right) = (empty(self.start), empty(self.end));
        while left.end < right.start {
            let item = items[left.end];
            let side = if is_left(&item) {
                left.end += 1;
                &mut left
            } else {
                right.start -= 1;
                items.swap(left.end, right.start);
                &mut right
            };
            side.hull.add(item.low, item.high);
            side.centers.add(item.center(), item.center());
        }
        (left, right)
    }
}

/// The children of a node, each over its part of the items, which stand one after the other.
fn build_children(
    ranges: &[Range],
    mut items: &mut [Item],
    first_slot: usize,
    nodes: &mut Vec<Node>,
    leaves: Leaves,
    depth: u32,
) -> [Child; WIDTH] {
    let mut children = [Child::NONE; WIDTH];
    let total = items.len();
    let mut parts = Vec::with_capacity(WIDTH);
    for range in ranges {
        let (part, rest) = items.split_at_mut(range.len());
        items = rest;
        let slot = first_slot + range.start;
        parts.push((Range { start: 0, end: range.len(), ..*range }, part, slot));
    }
    if total < PARALLEL {
        for (child, (range, part, slot)) in children.iter_mut().zip(parts) {
            *child = range.build(part, slot, nodes, leaves, depth);
        }
        return children;
    }
    let built: Vec<(Child, Vec<Node>)> = parts
        .into_par_iter()
        .map(|(range, part, slot)| {
            let mut nodes = Vec::new();
            (range.build(part, slot, &mut nodes, leaves, depth), nodes)
        })
        .collect();
    for (child, (root, own)) in children.iter_mut().zip(built) {
        let before = nodes.len();
        *child = root.shifted(before);
        nodes.extend(own.into_iter().map(|node| node.shifted(before)));
    }
    children
}

/// The first bin on the right of the cheapest cut, none where no cut has a finite cost, and the sum of area times number on both
/// sides.
fn cheapest(bins: &[(Hull, u32); BINS], leaves: Leaves) -> (Option<usize>, f32) {
    let mut right_cost = [0.0; BINS];
    let (mut hull, mut count) = (Hull::EMPTY, 0);
    for index in (1..BINS).rev() {
        hull.add(bins[index].0.low, bins[index].0.high);
        count += bins[index].1;
        right_cost[index] = if count == 0 { f32::INFINITY } else { hull.half_area() * leaves.cost(count) };
    }
    let mut best = (None, f32::INFINITY);
    let (mut hull, mut count) = (Hull::EMPTY, 0);
    for index in 1..BINS {
        hull.add(bins[index - 1].0.low, bins[index - 1].0.high);
        count += bins[index - 1].1;
        let cost = if count == 0 { f32::INFINITY } else { hull.half_area() * leaves.cost(count) + right_cost[index] };
        if cost < best.1 {
            best = (Some(index), cost);
        }
    }
    best
}

impl Item {
    /// Twice the centre of its box; the fourth number means nothing.
    #[inline]
    fn center(&self) -> Vec4 {
        self.low + self.high
    }
}

impl Hull {
    const EMPTY: Hull = Hull { low: Vec4::INFINITY, high: Vec4::NEG_INFINITY };

    #[inline]
    fn add(&mut self, low: Vec4, high: Vec4) {
        self.low = self.low.min(low);
        self.high = self.high.max(high);
    }

    fn half_area(&self) -> f32 {
        let size = (self.high - self.low).xyz();
        size.x * size.y + size.y * size.z + size.z * size.x
    }
}
