//! Builds a hierarchy top down by the surface area heuristic, over bins along the axes of the
//! centres (Wald, "On fast construction of SAH-based bounding volume hierarchies", IEEE Symposium
//! on Interactive Ray Tracing, 2007). The splits make a binary tree.

use crate::hierarchy_child::{Child, MAX_LEAF_ITEMS};
use crate::hierarchy_part::{Leaves, Part};
use glam::{Vec3, Vec4, Vec4Swizzles};

/// The bounding box of an item; the fourth component of `low` holds the bits of the item's number.
#[derive(Clone, Copy)]
struct Item {
    low: Vec4,
    high: Vec4,
}

/// A growing bounding box. Its fourth components are meaningless.
#[derive(Clone, Copy)]
struct GrowingBox {
    low: Vec4,
    high: Vec4,
}

/// Number of bins along an axis; fewer for few items.
const BINS: usize = 16;

/// For more items than this only a sample of `SAMPLE` is used to choose a split.
const MAX_BINNED: usize = 4096;

const SAMPLE: usize = 1024;

/// Minimum extent of the centres along an axis, relative to the longest axis, for it to be tried.
const MIN_RELATIVE_EXTENT: f32 = 0.25;

/// More items than this are built in parallel.
const PARALLEL: usize = 1 << 15;

/// From this depth on items are split in half by number, which bounds the depth of the hierarchy.
const MAX_SAH_DEPTH: u32 = 40;

/// The binary tree over `count` items with the bounding boxes `box_of` (low and high corner), and
/// the items by slot.
pub(crate) fn cut(count: usize, leaves: Leaves, box_of: impl Fn(usize) -> [Vec3; 2]) -> (Vec<Part>, Vec<u32>) {
    let mut items: Vec<Item> = (0..count)
        .map(|index| {
            let [low, high] = box_of(index);
            Item { low: low.extend(f32::from_bits(index as u32)), high: high.extend(0.0) }
        })
        .collect();
    let mut parts = Vec::new();
    if count > 0 {
        Range::of(&items).build(&mut items, 0, &mut parts, leaves, 0);
    }
    (parts, items.iter().map(|item| item.low.w.to_bits()).collect())
}

/// The bounds of contiguous items, before their split is chosen.
#[derive(Clone, Copy)]
struct Range {
    count: usize,
    hull: GrowingBox,
    /// Around the sums of the corners of each item's box.
    centers: GrowingBox,
}

impl Range {
    const EMPTY: Range = Range { count: 0, hull: GrowingBox::EMPTY, centers: GrowingBox::EMPTY };

    fn of(items: &[Item]) -> Range {
        let mut range = Range::EMPTY;
        items.iter().for_each(|item| range.add(item));
        range
    }

    #[inline]
    fn add(&mut self, item: &Item) {
        self.count += 1;
        self.hull.add(item.low, item.high);
        self.centers.add(item.center(), item.center());
    }

    /// Appends the tree over the items, which are all of the range and have slots from `first_slot`
    /// on.
    fn build(self, items: &mut [Item], first_slot: usize, parts: &mut Vec<Part>, leaves: Leaves, depth: u32) {
        let (low, high) = (self.hull.low.xyz(), self.hull.high.xyz());
        let Some([left, right]) = self.cut(items, leaves, depth) else {
            parts.push(Part::leaf(low, high, Child::leaf(first_slot, self.count)));
            return;
        };
        let own = parts.len();
        parts.push(Part::branch(low, high));
        let (left_items, right_items) = items.split_at_mut(left.count);
        let middle = first_slot + left.count;
        if self.count < PARALLEL {
            left.build(left_items, first_slot, parts, leaves, depth + 1);
            let right_at = parts.len() - own;
            parts[own].set_right(right_at);
            right.build(right_items, middle, parts, leaves, depth + 1);
            return;
        }
        let mut others = Vec::new();
        rayon::join(
            || left.build(left_items, first_slot, parts, leaves, depth + 1),
            || right.build(right_items, middle, &mut others, leaves, depth + 1),
        );
        let right_at = parts.len() - own;
        parts[own].set_right(right_at);
        parts.append(&mut others);
    }

    /// Orders and splits the items; `None` if a leaf is cheaper.
    fn cut(&self, items: &mut [Item], leaves: Leaves, depth: u32) -> Option<[Range; 2]> {
        let count = self.count;
        if count < 2 {
            return None;
        }
        let widest = (self.centers.high - self.centers.low).xyz().max_element();
        if depth >= MAX_SAH_DEPTH || !(BINS as f32 / widest).is_finite() {
            return (count > MAX_LEAF_ITEMS).then(|| halves(items, count / 2));
        }
        if count == 2 {
            return self.pair(items, leaves);
        }
        let choice = match count {
            ..=4 => self.cheapest::<4>(items, leaves),
            5..=16 => self.cheapest::<8>(items, leaves),
            _ => self.cheapest::<BINS>(items, leaves),
        };
        let area = self.hull.half_area();
        if count <= MAX_LEAF_ITEMS && leaves.cost(count as u32) * area <= leaves.box_cost() * area + choice.cost {
            return None;
        }
        let is_left = |item: &Item| choice.grid.bin_of(item, choice.axis) < choice.first_right;
        let left = if choice.cost.is_finite() { partition(items, is_left) } else { count / 2 };
        Some(halves(items, left))
    }

    /// Splits two items; `None` if a leaf is cheaper.
    fn pair(&self, items: &[Item], leaves: Leaves) -> Option<[Range; 2]> {
        let area = self.hull.half_area();
        let [left, right] = halves(items, 1);
        let split = leaves.cost(1) * (left.hull.half_area() + right.hull.half_area());
        (leaves.cost(2) * area > leaves.box_cost() * area + split).then_some([left, right])
    }

    /// The cheapest split between bins.
    fn cheapest<const N: usize>(&self, items: &[Item], leaves: Leaves) -> Choice {
        let grid = Grid::over(&self.centers, N);
        let mut best = Choice { grid, axis: 0, first_right: 0, cost: f32::INFINITY };
        for axis in grid.tried_axes() {
            let (first_right, cost) = cheapest(&grid.bins::<N>(items, axis), leaves);
            if cost < best.cost {
                best = Choice { axis, first_right, cost, ..best };
            }
        }
        best
    }
}

/// Ranges of the first `left` items and of the others.
fn halves(items: &[Item], left: usize) -> [Range; 2] {
    let (left, right) = items.split_at(left);
    [Range::of(left), Range::of(right)]
}

/// Moves the items of the left side to the front and returns their number. Branch-free, since the
/// predicate is unpredictable.
fn partition(items: &mut [Item], is_left: impl Fn(&Item) -> bool) -> usize {
    let mut left = 0;
    for index in 0..items.len() {
        let goes_left = is_left(&items[index]);
        items.swap(index, left);
        left += usize::from(goes_left);
    }
    left
}

/// A split: items in bins of `axis` before `first_right` are on the left.
#[derive(Clone, Copy)]
struct Choice {
    grid: Grid,
    axis: usize,
    first_right: usize,
    /// Sum of area times cost over both sides; infinite without a split.
    cost: f32,
}

/// Bins between the outermost centres.
#[derive(Clone, Copy)]
struct Grid {
    low: Vec4,
    /// Bins per length; zero along axes that are not tried.
    scale: Vec4,
}

impl Grid {
    fn over(centers: &GrowingBox, bins: usize) -> Grid {
        let extent = (centers.high - centers.low).xyz();
        let narrow = MIN_RELATIVE_EXTENT * extent.max_element();
        let scale = extent.map(|extent| if extent >= narrow { bins as f32 * (1.0 - 1e-5) / extent } else { 0.0 });
        Grid { low: centers.low, scale: scale.extend(0.0) }
    }

    /// The axes along which centres differ enough.
    fn tried_axes(&self) -> impl Iterator<Item = usize> + use<> {
        let scale = self.scale;
        (0..3).filter(move |axis| scale[*axis] > 0.0)
    }

    /// The content of the bins along an axis; of a sample, if there are many items.
    #[inline]
    fn bins<const N: usize>(&self, items: &[Item], axis: usize) -> [Bin; N] {
        let mut bins = [Bin::EMPTY; N];
        let mut count = |item: &Item| bins[self.bin_of(item, axis) % N].add(item.low, item.high, 1);
        if items.len() > MAX_BINNED {
            // Steps of the golden ratio avoid resonance with regular arrangements of items.
            let places = (0..SAMPLE).map(|k| (k as u32).wrapping_mul(0x9e37_79b9));
            places.for_each(|place| count(&items[((u64::from(place) * items.len() as u64) >> 32) as usize]));
        } else {
            items.iter().for_each(count);
        }
        bins
    }

    /// The bin of an item along an axis.
    #[inline]
    fn bin_of(&self, item: &Item, axis: usize) -> usize {
        // From 128 to twice that, the last sixteen bits of a float are its fractional part.
        let place = (item.low[axis] + item.high[axis] - self.low[axis]) * self.scale[axis] + 128.0;
        (place.to_bits() >> 16) as usize % BINS
    }
}

/// The first bin on the right of the cheapest split between bins, and its cost.
fn cheapest<const N: usize>(bins: &[Bin; N], leaves: Leaves) -> (usize, f32) {
    let mut right_cost = [f32::INFINITY; N];
    let mut right = Bin::EMPTY;
    for index in (1..N).rev() {
        right.join(&bins[index]);
        right_cost[index] = right.cost(leaves);
    }
    let mut best = (0, f32::INFINITY);
    let mut left = Bin::EMPTY;
    for index in 1..N {
        left.join(&bins[index - 1]);
        let cost = left.cost(leaves) + right_cost[index];
        if cost < best.1 {
            best = (index, cost);
        }
    }
    best
}

/// The content of a bin.
#[derive(Clone, Copy)]
struct Bin {
    hull: GrowingBox,
    count: u32,
}

impl Bin {
    const EMPTY: Bin = Bin { hull: GrowingBox::EMPTY, count: 0 };

    #[inline]
    fn add(&mut self, low: Vec4, high: Vec4, count: u32) {
        self.hull.add(low, high);
        self.count += count;
    }

    #[inline]
    fn join(&mut self, other: &Bin) {
        self.add(other.hull.low, other.hull.high, other.count);
    }

    #[inline]
    fn cost(&self, leaves: Leaves) -> f32 {
        if self.count == 0 { f32::INFINITY } else { self.hull.half_area() * leaves.cost(self.count) }
    }
}

impl Item {
    /// Twice the centre of its box; the fourth component is meaningless.
    #[inline]
    fn center(&self) -> Vec4 {
        self.low + self.high
    }
}

impl GrowingBox {
    const EMPTY: GrowingBox = GrowingBox { low: Vec4::INFINITY, high: Vec4::NEG_INFINITY };

    #[inline]
    fn add(&mut self, low: Vec4, high: Vec4) {
        self.low = self.low.min(low);
        self.high = self.high.max(high);
    }

    #[inline]
    fn half_area(&self) -> f32 {
        let size = self.high - self.low;
        let products = size * size.yzxw();
        products.x + products.y + products.z
    }
}
