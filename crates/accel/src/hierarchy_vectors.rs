//! Vector instructions for the steps of a ray, selected for the processor when a hierarchy is
//! built.
//!
//! `glam` uses the baseline of each architecture (SSE2, NEON). AVX2 with fused multiply-add tests
//! the eight boxes of a node at once. Either way only certain misses are rejected, so results do
//! not depend on the selection.

use crate::hierarchy_block::Block;
use crate::hierarchy_child::MAX_LEAF_ITEMS;
use crate::hierarchy_node::{Entered, Node, Slabs};
use glam::DVec3;

/// The implementation of a ray's steps.
pub(crate) trait Vectors: Copy {
    /// The boxes of a node that a ray enters before `farthest`.
    fn enter(self, slabs: &Slabs, node: &Node, farthest: f32) -> Entered;

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

impl Fetched for [[DVec3; 3]; MAX_LEAF_ITEMS] {
    #[inline(always)]
    fn word(&self) -> u32 {
        self[0][0].x as u32
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

    #[inline(always)]
    fn prefetch<T: Fetched>(self, place: &T) {
        std::hint::black_box(place.word());
    }
}

/// The instructions of the processor.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Processor {
    Baseline(Baseline),
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2),
}

impl Default for Processor {
    fn default() -> Processor {
        #[cfg(target_arch = "x86_64")]
        if let Some(simd) = pulp::x86::V3::try_new() {
            return Processor::Avx2(Avx2(simd));
        }
        Processor::Baseline(Baseline)
    }
}

#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::Avx2;

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::{Fetched, Vectors};
    use crate::hierarchy_node::{Entered, Node, Slabs};
    use pulp::NullaryFnOnce;
    use pulp::x86::V3;
    use std::arch::x86_64::{__m256, _CMP_LE_OQ, _MM_HINT_T0};

    /// AVX2 with FMA.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct Avx2(pub(super) V3);

    impl Avx2 {
        /// Calls a function that is inlined and compiled with these instructions.
        #[inline(always)]
        pub(crate) fn run<F: NullaryFnOnce>(self, steps: F) -> F::Output {
            self.0.vectorize(steps)
        }

        /// Eight grid coordinates as floats.
        #[inline(always)]
        fn lanes(self, places: &[[u8; 4]; 2]) -> __m256 {
            let Avx2(simd) = self;
            let places: i64 = pulp::cast(*places);
            let places = simd.avx2._mm256_cvtepu8_epi32(simd.sse2._mm_set_epi64x(0, places));
            simd.avx._mm256_cvtepi32_ps(places)
        }
    }

    impl Vectors for Avx2 {
        #[inline(always)]
        fn enter(self, slabs: &Slabs, node: &Node, farthest: f32) -> Entered {
            let Avx2(simd) = self;
            let mut near = simd.avx._mm256_set1_ps(0.0);
            let mut far = simd.avx._mm256_set1_ps(farthest);
            for axis in 0..3 {
                let (start, step, [first, last]) = slabs.along(axis, node);
                let (start, step) = (simd.avx._mm256_set1_ps(start), simd.avx._mm256_set1_ps(step));
                // No closure: it would not be compiled with these instructions, and each would be a
                // call.
                near = simd.avx._mm256_max_ps(simd.fma._mm256_fmadd_ps(self.lanes(first), step, start), near);
                far = simd.avx._mm256_min_ps(simd.fma._mm256_fmadd_ps(self.lanes(last), step, start), far);
            }
            let lanes = simd.avx._mm256_movemask_ps(simd.avx._mm256_cmp_ps::<_CMP_LE_OQ>(near, far));
            Entered::new(lanes as u32, pulp::cast(near))
        }

        #[inline(always)]
        fn prefetch<T: Fetched>(self, place: &T) {
            let start = std::ptr::from_ref(place).cast::<i8>();
            for line in (0..size_of::<T>()).step_by(64) {
                self.0.sse._mm_prefetch::<_MM_HINT_T0>(start.wrapping_add(line));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hierarchy_child::Child;
    use crate::hierarchy_node::WIDTH;
    use glam::Vec3;

    /// A point of the cube from −1 to 1 (Roberts' R₃ sequence).
    fn point(index: u32) -> Vec3 {
        let number = |step: f64| (2.0 * (f64::from(index) * step).fract() - 1.0) as f32;
        Vec3::new(number(0.819_172_513_396), number(0.671_043_606_704), number(0.549_700_477_902))
    }

    /// Whether a ray passes through a box, in double precision.
    fn passes([low, high]: [Vec3; 2], origin: Vec3, direction: Vec3) -> bool {
        let [low, high] = [low, high].map(|corner| (corner - origin).as_dvec3() / direction.as_dvec3());
        let (near, far) = (low.min(high).max_element().max(0.0), low.max(high).min_element());
        near <= far
    }

    fn entered(vectors: impl Vectors, slabs: &Slabs, node: &Node) -> Vec<(Child, f32)> {
        let mut entered = vectors.enter(slabs, node, f32::INFINITY);
        std::iter::from_fn(|| entered.next(node)).map(|next| (next.child(), next.entry())).collect()
    }

    #[test]
    fn every_box_that_a_ray_passes_through_is_entered_whatever_the_processor() {
        let mut passed = 0;
        for round in 0..2000 {
            let boxes: [[Vec3; 2]; WIDTH] = std::array::from_fn(|lane| {
                let (center, half) = (point(round * 8 + lane as u32), 0.3 * point(round + lane as u32).abs());
                [center - half - 2e-6, center + half + 2e-6]
            });
            let node = Node::around(&boxes, std::array::from_fn(Child::node));
            let [low, high] = boxes[round as usize % WIDTH];
            let (origin, target) =
                (1.5 * point(3 * round + 1), low + (high - low) * (0.5 * point(5 * round + 2) + 0.5));
            let direction = (target - origin).normalize();
            let slabs = Slabs::new(origin, direction);
            let baseline = entered(Baseline, &slabs, &node);
            let through: Vec<usize> = (0..WIDTH).filter(|lane| passes(boxes[*lane], origin, direction)).collect();
            passed += through.len();
            let has =
                |entered: &[(Child, f32)], lane: usize| entered.iter().any(|(child, _)| *child == Child::node(lane));
            assert!(through.iter().all(|lane| has(&baseline, *lane)), "round {round}");
            #[cfg(target_arch = "x86_64")]
            if let Processor::Avx2(avx2) = Processor::default() {
                let wide = entered(avx2, &slabs, &node);
                assert!(through.iter().all(|lane| has(&wide, *lane)), "round {round}");
                for (child, entry) in wide {
                    let other = baseline.iter().find(|(other, _)| *other == child);
                    assert!(other.is_none_or(|(_, other)| (other - entry).abs() < 1e-5), "round {round}: {entry}");
                }
            }
        }
        assert!(passed > 2000, "{passed}");
    }
}
