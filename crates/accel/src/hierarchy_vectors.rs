//! The steps of a ray by vector instructions. `glam` uses the baseline of each architecture (SSE2,
//! NEON).

use crate::hierarchy_block::{Block, Probe};
use crate::hierarchy_node::{Entered, Node, Slabs};
use glam::DVec3;

/// The implementation of a ray's steps.
pub(crate) trait Vectors: Copy {
    /// The boxes of a node that a ray enters before `farthest`.
    fn enter(self, slabs: &Slabs, node: &Node, farthest: f32) -> Entered;

    /// The items of a block that a ray may hit before `farthest`, one bit each.
    fn candidates(self, probe: &Probe, block: &Block, farthest: f32) -> u32;

    /// Prefetches a value.
    fn prefetch<T: Fetched>(self, place: &T);
}

/// Values that are prefetched.
pub(crate) trait Fetched {
    /// A word of it: where there is no prefetch instruction, reading the word loads its cache line.
    fn word(&self) -> u32;
}

impl Fetched for Node {
    #[inline(always)]
    fn word(&self) -> u32 {
        self.children[0].0
    }
}

impl Fetched for Block {
    #[inline(always)]
    fn word(&self) -> u32 {
        self.first_slot()
    }
}

impl Fetched for [DVec3; 3] {
    #[inline(always)]
    fn word(&self) -> u32 {
        self[0].x as u32
    }
}

/// The baseline of the architecture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Baseline;

impl Vectors for Baseline {
    #[inline(always)]
    fn enter(self, slabs: &Slabs, node: &Node, farthest: f32) -> Entered {
        slabs.enter(node, farthest)
    }

    fn candidates(self, probe: &Probe, block: &Block, farthest: f32) -> u32 {
        probe.candidates(block, farthest)
    }

    #[inline(always)]
    fn prefetch<T: Fetched>(self, place: &T) {
        std::hint::black_box(place.word());
    }
}
