//! Scattering as a tensor tree: adaptive cells of a hypercube, halved in all dimensions where the
//! data require it.
//!
//! The first dimensions are those of the incident direction, the last two those of the exit
//! direction. Directions are mapped from the disk to the square by [`crate::square`]. An isotropic
//! tree has one incident dimension, (1 − sin θ)/2, of which only the first half is used; the exit
//! direction is rotated by the azimuth of the incident one.

use crate::square::square_of_disk;
use std::f64::consts::PI;

/// Maximum number of halvings.
pub(crate) const MOST_HALVINGS: u32 = 15;

/// Number of halvings of the cells that are used to find the largest scattered fraction.
const TOTAL_HALVINGS: u32 = 5;

/// Number of dimensions of a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rank {
    /// Three dimensions.
    Isotropic,
    /// Four.
    Anisotropic,
}

impl Rank {
    pub(crate) fn dimensions(self) -> u32 {
        match self {
            Rank::Isotropic => 3,
            Rank::Anisotropic => 4,
        }
    }

    /// Number of dimensions of the incident direction.
    pub(crate) fn incident(self) -> u32 {
        self.dimensions() - 2
    }
}

/// A point of the hypercube; the last coordinate of an isotropic tree is unused.
pub(crate) type Point = [f64; 4];

/// One node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Node {
    /// Index of the first of 2^dimensions nodes; bit `i` of the offset selects the half of
    /// dimension `i`.
    Branch(u32),
    /// 2^(dimensions·halvings) values starting at `first`; the last dimension varies fastest.
    Grid {
        /// Number of halvings of each dimension.
        halvings: u32,
        /// Index of the first value.
        first: u32,
    },
}

/// A tree of numbers.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub(crate) rank: Rank,
    /// Nodes; the first is the root.
    pub(crate) nodes: Vec<Node>,
    pub(crate) values: Vec<f32>,
}

/// A cell of the hypercube.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell {
    /// Smallest coordinates of the cell.
    pub(crate) corner: Point,
    pub(crate) value: f32,
    /// Number of halvings: the side is 2^-halvings.
    pub(crate) halvings: u32,
}

/// Value of a tree at a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leaf {
    pub(crate) value: f32,
    /// Index of the value.
    pub(crate) index: u32,
    /// Number of halvings of the cell.
    pub(crate) halvings: u32,
}

impl Tree {
    /// Point of the hypercube for a pair of directions that are projected onto the surface.
    pub(crate) fn point(&self, incident: [f64; 2], exit: [f64; 2]) -> Point {
        match self.rank {
            Rank::Isotropic => {
                let [x, y] = incident;
                let sine = x.hypot(y);
                let (cosine_turn, sine_turn) = if sine > 0.0 { (x / sine, y / sine) } else { (1.0, 0.0) };
                let turned = [cosine_turn * exit[0] + sine_turn * exit[1], cosine_turn * exit[1] - sine_turn * exit[0]];
                let [a, b] = square_of_disk(turned);
                [isotropic_coordinate(sine), a, b, 0.0]
            }
            Rank::Anisotropic => {
                let ([a, b], [c, d]) = (square_of_disk(incident), square_of_disk(exit));
                [a, b, c, d]
            }
        }
    }

    /// Cell that contains a point.
    pub(crate) fn leaf(&self, point: &Point) -> Leaf {
        let dimensions = self.rank.dimensions() as usize;
        let mut rest = *point;
        let (mut node, mut depth) = (self.nodes[0], 0);
        loop {
            match node {
                Node::Branch(first) => {
                    let mut child = 0;
                    for (dimension, coordinate) in rest[..dimensions].iter_mut().enumerate() {
                        *coordinate *= 2.0;
                        if *coordinate >= 1.0 {
                            *coordinate -= 1.0;
                            child |= 1 << dimension;
                        }
                    }
                    node = self.nodes[(first + child) as usize];
                    depth += 1;
                }
                Node::Grid { halvings, first } => {
                    let size = 1_u32 << halvings;
                    let index = rest[..dimensions].iter().fold(0, |index, coordinate| {
                        (index << halvings) + ((coordinate * f64::from(size)) as u32).min(size - 1)
                    });
                    let index = first + index;
                    return Leaf { value: self.values[index as usize], index, halvings: depth + halvings };
                }
            }
        }
    }

    /// Number of halvings of the smallest cell.
    pub(crate) fn most_halvings(&self) -> u32 {
        let mut most = 0;
        self.for_each_cell(&mut |cell| most = most.max(cell.halvings));
        most
    }

    /// Smallest value in the used part.
    pub(crate) fn least_value(&self) -> f32 {
        let mut least = f32::INFINITY;
        self.for_each_cell(&mut |cell| {
            if self.is_used(&cell) {
                least = least.min(cell.value);
            }
        });
        least
    }

    /// Subtracts an amount from all values, clamped at zero.
    pub(crate) fn subtract(&mut self, amount: f32) {
        self.values.iter_mut().for_each(|value| *value = (*value - amount).max(0.0));
    }

    /// Largest integral over the exit hemisphere for one incident direction, averaged over 32 cells
    /// per dimension.
    pub(crate) fn largest_total(&self) -> f64 {
        let width = 1_usize << TOTAL_HALVINGS;
        let rows = if self.rank == Rank::Anisotropic { width } else { 1 };
        let mut totals = vec![0.0; rows * width];
        self.for_each_cell(&mut |cell| {
            let side = 0.5_f64.powi(cell.halvings as i32);
            // A smaller cell covers part of one of the 32 cells, a larger one covers several.
            let covered = (side * width as f64).min(1.0).powi(self.rank.incident() as i32);
            let first = |dimension: usize| (cell.corner[dimension] * width as f64) as usize;
            let count = (width >> cell.halvings).max(1);
            let (second, second_count) = if rows == 1 { (0, 1) } else { (first(1), count) };
            for row in second..second + second_count {
                for column in first(0)..first(0) + count {
                    totals[row * width + column] += f64::from(cell.value) * side * side * covered;
                }
            }
        });
        let is_used = |column: usize| self.rank == Rank::Anisotropic || column < width / 2;
        let used = totals.iter().enumerate().filter(|(at, _)| is_used(at % width));
        PI * used.map(|(_, total)| *total).fold(0.0, f64::max)
    }

    /// Whether the cell is in the used part; half of an isotropic tree is unused.
    pub(crate) fn is_used(&self, cell: &Cell) -> bool {
        self.rank == Rank::Anisotropic || cell.corner[0] < 0.5
    }

    /// All cells, depth first.
    pub(crate) fn for_each_cell(&self, see: &mut impl FnMut(Cell)) {
        self.visit(0, &[0.0; 4], 0, see);
    }

    fn visit(&self, at: u32, corner: &Point, depth: u32, see: &mut impl FnMut(Cell)) {
        let dimensions = self.rank.dimensions();
        match self.nodes[at as usize] {
            Node::Branch(first) => {
                let half = 0.5_f64.powi(depth as i32 + 1);
                for child in 0..1 << dimensions {
                    let corner = std::array::from_fn(|i| corner[i] + f64::from(child >> i & 1) * half);
                    self.visit(first + child, &corner, depth + 1, see);
                }
            }
            Node::Grid { halvings, first } => {
                let side = 0.5_f64.powi((depth + halvings) as i32);
                let mask = (1 << halvings) - 1;
                for index in 0..1_u32 << (halvings * dimensions) {
                    let mut within = *corner;
                    for (dimension, coordinate) in within.iter_mut().take(dimensions as usize).enumerate() {
                        let steps = index >> (halvings * (dimensions - 1 - dimension as u32)) & mask;
                        *coordinate += f64::from(steps) * side;
                    }
                    let index = first + index;
                    let value = self.values[index as usize];
                    see(Cell { corner: within, value, halvings: depth + halvings });
                }
            }
        }
    }
}

/// Incident coordinate of an isotropic tree; just below one half at normal incidence.
pub(crate) fn isotropic_coordinate(sine: f64) -> f64 {
    const TINY: f64 = 1e-6;
    (0.5 - TINY - 0.5 * sine).max(0.0)
}
