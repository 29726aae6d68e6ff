//! The exact vertices of the triangles in blocks. They lie apart from the blocks but have their
//! indices, so that both are fetched from memory at once.

use crate::builder::Builder;
use crate::hierarchy_child::MAX_LEAF_ITEMS;
use crate::hierarchy_part::Leaves;
use crate::hierarchy_vectors::{Fetched, Vectors};
use glam::DVec3;

/// The vertices of a block's triangles.
pub(crate) type Corners = [[DVec3; 3]; MAX_LEAF_ITEMS];

impl Fetched for Corners {
    #[inline(always)]
    fn word(&self) -> u32 {
        self[0][0].x as u32
    }
}

/// The index of the first vertex of each of a block's triangles; [`NO_TRIANGLE`] for other items.
type Starts = [u32; MAX_LEAF_ITEMS];

const NO_TRIANGLE: u32 = u32::MAX;

/// A triangle among the items of a hierarchy.
#[derive(Clone, Copy)]
pub(crate) struct Triangle {
    pub(crate) corners: [DVec3; 3],
    /// Its first vertex, if all are contiguous in the array that each query gets.
    pub(crate) start: Option<u32>,
}

/// The exact vertices by block.
#[derive(Debug, Default)]
pub(crate) enum Triangles {
    /// Only the owner of the hierarchy knows them.
    #[default]
    Elsewhere,
    /// In the array that each query gets.
    Shared(Vec<Starts>),
    /// A copy, which many rays justify.
    Copied(Vec<Corners>),
}

/// The triangles of one block.
#[derive(Clone, Copy)]
pub(crate) enum BlockTriangles<'h> {
    Elsewhere,
    Shared(&'h Starts),
    Copied(&'h Corners),
}

impl Triangles {
    /// For this number of blocks.
    pub(crate) fn with_capacity(blocks: usize, leaves: Leaves, builder: Builder) -> Triangles {
        match builder {
            Builder::Thorough if leaves == Leaves::Blocks => Triangles::Copied(Vec::with_capacity(blocks)),
            _ => Triangles::Shared(Vec::with_capacity(blocks)),
        }
    }

    /// Adds those of the next block.
    pub(crate) fn push(&mut self, block: &[Option<Triangle>; MAX_LEAF_ITEMS]) {
        match self {
            Triangles::Elsewhere => {}
            Triangles::Shared(starts) => {
                let start = |triangle: Option<Triangle>| triangle.and_then(|triangle| triangle.start);
                if block.iter().any(|triangle| triangle.is_some_and(|triangle| triangle.start.is_none())) {
                    *self = Triangles::Elsewhere;
                } else {
                    starts.push(block.map(|triangle| start(triangle).unwrap_or(NO_TRIANGLE)));
                }
            }
            Triangles::Copied(corners) => {
                corners.push(block.map(|triangle| triangle.map(|triangle| triangle.corners).unwrap_or_default()));
            }
        }
    }

    pub(crate) fn bytes(&self) -> usize {
        match self {
            Triangles::Elsewhere => 0,
            Triangles::Shared(starts) => size_of_val(&**starts),
            Triangles::Copied(corners) => size_of_val(&**corners),
        }
    }

    /// Those of a block, whose vertices are prefetched.
    #[inline(always)]
    pub(crate) fn fetch(&self, block: usize, vertices: &[DVec3], vectors: impl Vectors) -> BlockTriangles<'_> {
        match self {
            Triangles::Elsewhere => BlockTriangles::Elsewhere,
            Triangles::Shared(starts) => {
                let Some(starts) = starts.get(block) else { return BlockTriangles::Elsewhere };
                for start in starts {
                    if let Some(corners) = corners_at(vertices, *start) {
                        vectors.prefetch(corners);
                    }
                }
                BlockTriangles::Shared(starts)
            }
            Triangles::Copied(corners) => {
                let Some(corners) = corners.get(block) else { return BlockTriangles::Elsewhere };
                vectors.prefetch(corners);
                BlockTriangles::Copied(corners)
            }
        }
    }
}

impl<'h> BlockTriangles<'h> {
    /// The vertices of an item of the block, if it is a triangle and they are known.
    #[inline(always)]
    pub(crate) fn corners(self, lane: u32, vertices: &'h [DVec3]) -> Option<&'h [DVec3; 3]> {
        match self {
            BlockTriangles::Elsewhere => None,
            BlockTriangles::Shared(starts) => corners_at(vertices, starts[lane as usize % MAX_LEAF_ITEMS]),
            BlockTriangles::Copied(corners) => Some(&corners[lane as usize % MAX_LEAF_ITEMS]),
        }
    }
}

#[inline(always)]
fn corners_at(vertices: &[DVec3], start: u32) -> Option<&[DVec3; 3]> {
    vertices.get(start as usize..).and_then(|rest| rest.first_chunk())
}
