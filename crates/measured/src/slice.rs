//! Sampling of a tensor tree: the cells of the other direction, for one given direction.
//!
//! The domain of the given direction is divided into the largest cells on which the slice does not
//! depend. The cumulative sums of each slice are computed at its first use, and kept while memory
//! allows.

use crate::square::disk_of_square;
use crate::tree::{Node, Rank, Tree};
use std::f64::consts::PI;
use std::ops::Deref;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Maximum number of slice cells in memory, each of 32 bytes; further slices are recomputed at each
/// use.
const MOST_KEPT: usize = 1 << 26;

/// Given and sampled dimensions of a tree.
#[derive(Clone, Copy, Debug)]
struct Axes {
    /// First given dimension, and their number.
    given: usize,
    given_count: usize,
    /// First of the two sampled dimensions.
    sampled: usize,
}

impl Axes {
    fn given_bits(self, child: u32) -> u32 {
        child >> self.given & ((1 << self.given_count) - 1)
    }
}

/// Whether the incident or the exit direction of a tree is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Given {
    Incident,
    /// Exit direction; only for trees of four dimensions.
    Exit,
}

/// All slices of a tree.
#[derive(Debug)]
pub(crate) struct Slices {
    axes: Axes,
    /// Division of the given directions; the first cell is the root.
    cells: Vec<GivenCell>,
    slices: Vec<OnceLock<Slice>>,
    kept: AtomicUsize,
}

#[derive(Clone, Copy, Debug)]
enum GivenCell {
    /// Index of the first of 2^dimensions halves.
    Divided(u32),
    /// Index of the slice, and number of halvings.
    Whole { slice: u32, halvings: u32 },
}

/// Cells of the sampled direction.
#[derive(Debug, Default)]
pub(crate) struct Slice {
    /// Cumulative integral of the values over the projected hemisphere at the end of each cell,
    /// without the factor π.
    sums: Vec<f64>,
    /// Smallest coordinates and side of each cell.
    squares: Vec<[f64; 3]>,
}

impl Slice {
    /// Scattered fraction of light.
    pub(crate) fn total(&self) -> f64 {
        PI * self.sums.last().copied().unwrap_or(0.0)
    }

    /// Samples a point of the disk in proportion to the values.
    pub(crate) fn sample(&self, [u, v]: [f64; 2]) -> Option<[f64; 2]> {
        let target = u * self.sums.last()?;
        let at = self.sums.partition_point(|sum| *sum <= target).min(self.sums.len() - 1);
        let before = if at == 0 { 0.0 } else { self.sums[at - 1] };
        let inside = ((target - before) / (self.sums[at] - before).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let [x, y, side] = self.squares[at];
        Some(disk_of_square([x + inside * side, y + v * side]))
    }

    /// Projected solid angle of the largest cell, sr.
    pub(crate) fn largest_cell(&self) -> f64 {
        self.squares.iter().map(|[_, _, side]| PI * side * side).fold(0.0, f64::max)
    }
}

/// A cached slice, or a temporary one.
pub(crate) enum Held<'s> {
    Kept(&'s Slice),
    Own(Slice),
}

impl Deref for Held<'_> {
    type Target = Slice;

    fn deref(&self) -> &Slice {
        match self {
            Held::Kept(slice) => slice,
            Held::Own(slice) => slice,
        }
    }
}

impl Slices {
    pub(crate) fn new(tree: &Tree, given: Given) -> Slices {
        let axes = match (tree.rank, given) {
            (Rank::Isotropic, _) => Axes { given: 0, given_count: 1, sampled: 1 },
            (Rank::Anisotropic, Given::Incident) => Axes { given: 0, given_count: 2, sampled: 2 },
            (Rank::Anisotropic, Given::Exit) => Axes { given: 2, given_count: 2, sampled: 0 },
        };
        let mut slices = Slices { axes, cells: Vec::new(), slices: Vec::new(), kept: AtomicUsize::new(0) };
        slices.cells.push(GivenCell::Whole { slice: 0, halvings: 0 });
        match tree.nodes[0] {
            Node::Grid { halvings, .. } => slices.divide(tree, 0, 0, &[], halvings),
            Node::Branch(_) => slices.divide(tree, 0, 0, &[0], 0),
        }
        slices
    }

    /// Divides a cell that these branches, and grids of this many halvings, share.
    fn divide(&mut self, tree: &Tree, place: usize, depth: u32, branches: &[u32], grid_halvings: u32) {
        if branches.is_empty() && grid_halvings == 0 {
            self.cells[place] = GivenCell::Whole { slice: self.slices.len() as u32, halvings: depth };
            self.slices.push(OnceLock::new());
            return;
        }
        let first = self.cells.len();
        let count = 1 << self.axes.given_count;
        self.cells[place] = GivenCell::Divided(first as u32);
        self.cells.resize(first + count, GivenCell::Whole { slice: 0, halvings: 0 });
        for half in 0..count {
            let (mut inner, mut most) = (Vec::new(), grid_halvings.saturating_sub(1));
            for branch in branches {
                let Node::Branch(children) = tree.nodes[*branch as usize] else { continue };
                for child in
                    (0..1 << tree.rank.dimensions()).filter(|child| self.axes.given_bits(*child) == half as u32)
                {
                    match tree.nodes[(children + child) as usize] {
                        Node::Branch(_) => inner.push(children + child),
                        Node::Grid { halvings, .. } => most = most.max(halvings),
                    }
                }
            }
            self.divide(tree, first + half, depth + 1, &inner, most);
        }
    }

    /// Slice for a given point (the second coordinate only if there is one), and the number of
    /// halvings of its cell.
    pub(crate) fn at(&self, tree: &Tree, given: [f64; 2]) -> (Held<'_>, u32) {
        let mut rest = given;
        let mut at = 0;
        let (slice, halvings) = loop {
            match self.cells[at] {
                GivenCell::Whole { slice, halvings } => break (slice as usize, halvings),
                GivenCell::Divided(first) => at = first as usize + half_of(&mut rest[..self.axes.given_count]),
            }
        };
        (self.held(tree, given, slice), halvings)
    }

    fn held(&self, tree: &Tree, given: [f64; 2], slice: usize) -> Held<'_> {
        if let Some(kept) = self.slices[slice].get() {
            return Held::Kept(kept);
        }
        let mut made = Slice::default();
        self.collect(tree, 0, given, [0.0, 0.0, 1.0], &mut made);
        if self.kept.fetch_add(made.sums.len(), Ordering::Relaxed) > MOST_KEPT {
            return Held::Own(made);
        }
        Held::Kept(self.slices[slice].get_or_init(|| made))
    }

    fn collect(&self, tree: &Tree, node: u32, mut given: [f64; 2], [x, y, side]: [f64; 3], slice: &mut Slice) {
        let axes = self.axes;
        match tree.nodes[node as usize] {
            Node::Branch(first) => {
                let half = half_of(&mut given[..axes.given_count]) as u32;
                for sampled in 0..4 {
                    let child = half << axes.given | sampled << axes.sampled;
                    let corner = [x + 0.5 * side * f64::from(sampled & 1), y + 0.5 * side * f64::from(sampled >> 1)];
                    self.collect(tree, first + child, given, [corner[0], corner[1], 0.5 * side], slice);
                }
            }
            Node::Grid { halvings, first } => {
                let size = 1_u32 << halvings;
                let step = side / f64::from(size);
                let stride = |dimension: usize| 1_u32 << (halvings * (tree.rank.dimensions() - 1 - dimension as u32));
                let start = given[..axes.given_count].iter().enumerate().fold(first, |start, (i, coordinate)| {
                    start + stride(axes.given + i) * ((coordinate * f64::from(size)) as u32).min(size - 1)
                });
                for (i, j) in (0..size).flat_map(|i| (0..size).map(move |j| (i, j))) {
                    let index = start + i * stride(axes.sampled) + j * stride(axes.sampled + 1);
                    let before = slice.sums.last().copied().unwrap_or(0.0);
                    slice.sums.push(before + f64::from(tree.values[index as usize]) * step * step);
                    slice.squares.push([x + f64::from(i) * step, y + f64::from(j) * step, step]);
                }
            }
        }
    }
}

/// Doubles coordinates in [0,1), and returns a bit for each that was in the upper half.
fn half_of(coordinates: &mut [f64]) -> usize {
    let mut half = 0;
    for (bit, coordinate) in coordinates.iter_mut().enumerate() {
        *coordinate *= 2.0;
        if *coordinate >= 1.0 {
            *coordinate -= 1.0;
            half |= 1 << bit;
        }
    }
    half
}
