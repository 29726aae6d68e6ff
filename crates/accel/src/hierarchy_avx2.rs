//! The steps of a ray with AVX2 and fused multiply-add: the eight boxes of a node or two vertices of
//! four triangles at once.
//!
//! There are no closures: they would not be compiled with these instructions, and each would be a
//! call.

use crate::hierarchy_block::{Block, Probe, Projection};
use crate::hierarchy_node::{Entered, Node, Slabs};
use crate::hierarchy_vectors::{Fetched, Vectors};
use pulp::NullaryFnOnce;
use pulp::x86::V3;
use std::arch::x86_64::{__m128, __m256, _CMP_LE_OQ, _MM_HINT_T0};

/// AVX2 with FMA.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx2(V3);

impl Avx2 {
    pub(crate) fn new(simd: V3) -> Avx2 {
        Avx2(simd)
    }

    /// Calls a function that is inlined and compiled with these instructions.
    #[inline(always)]
    pub(crate) fn run<F: NullaryFnOnce>(self, steps: F) -> F::Output {
        self.0.vectorize(steps)
    }

    /// Eight grid coordinates as floats.
    #[inline(always)]
    fn lanes(self, places: &[u8; 8]) -> __m256 {
        let Avx2(simd) = self;
        let places = simd.sse2._mm_set_epi64x(0, i64::from_le_bytes(*places));
        simd.avx._mm256_cvtepi32_ps(simd.avx2._mm256_cvtepu8_epi32(places))
    }

    /// The third and first vertices of four triangles, and their first and second, along an axis.
    #[inline(always)]
    fn vertices(self, places: &[u8; 12]) -> [__m256; 2] {
        let (first, last): (&[u8; 8], &[u8; 8]) = match (places.first_chunk(), places.last_chunk()) {
            (Some(first), Some(last)) => (first, last),
            _ => (&[0; 8], &[0; 8]),
        };
        [self.lanes(first), self.lanes(last)]
    }

    /// `x·step + (start − along·shear)`.
    #[inline(always)]
    fn sheared(self, x: __m256, step: f32, along: __m256, shear: f32, start: f32) -> __m256 {
        let Avx2(simd) = self;
        let [step, shear, start] =
            [simd.avx._mm256_set1_ps(step), simd.avx._mm256_set1_ps(shear), simd.avx._mm256_set1_ps(start)];
        simd.fma._mm256_fmadd_ps(x, step, simd.fma._mm256_fnmadd_ps(along, shear, start))
    }

    #[inline(always)]
    fn low(self, pair: __m256) -> __m128 {
        self.0.avx._mm256_castps256_ps128(pair)
    }

    #[inline(always)]
    fn high(self, pair: __m256) -> __m128 {
        self.0.avx._mm256_extractf128_ps::<1>(pair)
    }

    #[inline(always)]
    fn abs(self, x: __m256) -> __m256 {
        self.0.avx._mm256_andnot_ps(self.0.avx._mm256_set1_ps(-0.0), x)
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
            let (first, last): ([u8; 8], [u8; 8]) = (pulp::cast(*first), pulp::cast(*last));
            near = simd.avx._mm256_max_ps(simd.fma._mm256_fmadd_ps(self.lanes(&first), step, start), near);
            far = simd.avx._mm256_min_ps(simd.fma._mm256_fmadd_ps(self.lanes(&last), step, start), far);
        }
        let lanes = simd.avx._mm256_movemask_ps(simd.avx._mm256_cmp_ps::<_CMP_LE_OQ>(near, far));
        Entered::new(lanes as u32, pulp::cast(near))
    }

    #[inline(always)]
    fn candidates(self, probe: &Probe, block: &Block, farthest: f32) -> u32 {
        if block.holds_others() {
            return block.all();
        }
        let Avx2(simd) = self;
        let Projection { start, step, shear, error, distance, distance_step, distance_error } = probe.project(block);
        let [along_ca, along_ab] = self.vertices(block.places(probe.axes[2]));
        let [u_ca, u_ab] = self.vertices(block.places(probe.axes[0]));
        let [v_ca, v_ab] = self.vertices(block.places(probe.axes[1]));
        let u_ca = self.sheared(u_ca, step[0], along_ca, shear[0], start[0]);
        let u_ab = self.sheared(u_ab, step[0], along_ab, shear[0], start[0]);
        let v_ca = self.sheared(v_ca, step[1], along_ca, shear[1], start[1]);
        let v_ab = self.sheared(v_ab, step[1], along_ab, shear[1], start[1]);
        let two_sides = simd.fma._mm256_fmsub_ps(u_ab, v_ca, simd.avx._mm256_mul_ps(v_ab, u_ca));
        let [u_c, v_c, u_b, v_b] = [self.low(u_ca), self.low(v_ca), self.high(u_ab), self.high(v_ab)];
        let side = simd.fma._mm_fmsub_ps(u_c, v_b, simd.sse._mm_mul_ps(v_c, u_b));
        let [first, second] = [self.low(two_sides), self.high(two_sides)];
        let least = simd.sse._mm_min_ps(simd.sse._mm_min_ps(first, second), side);
        let most = simd.sse._mm_max_ps(simd.sse._mm_max_ps(first, second), side);
        // As in `Probe::candidates`.
        let size_ca = simd.avx._mm256_add_ps(self.abs(u_ca), self.abs(v_ca));
        let size_ab = simd.avx._mm256_add_ps(self.abs(u_ab), self.abs(v_ab));
        let size = simd.sse._mm_add_ps(
            simd.sse._mm_add_ps(self.low(size_ca), self.high(size_ca)),
            simd.sse._mm_add_ps(self.high(size_ab), simd.sse._mm_set1_ps(error)),
        );
        let slack = simd.sse._mm_mul_ps(size, simd.sse._mm_set1_ps(error));
        let negative = simd.sse._mm_mul_ps(size, simd.sse._mm_set1_ps(-error));
        let outside = simd.sse._mm_and_ps(simd.sse._mm_cmplt_ps(least, negative), simd.sse._mm_cmpgt_ps(most, slack));
        let [distance, distance_step] = [simd.avx._mm256_set1_ps(distance), simd.avx._mm256_set1_ps(distance_step)];
        let to_ca = simd.fma._mm256_fmadd_ps(along_ca, distance_step, distance);
        let to_ab = simd.fma._mm256_fmadd_ps(along_ab, distance_step, distance);
        let (nearest, last) = (simd.avx._mm256_min_ps(to_ca, to_ab), simd.avx._mm256_max_ps(to_ca, to_ab));
        let nearest = simd.sse._mm_min_ps(self.low(nearest), self.high(nearest));
        let last = simd.sse._mm_max_ps(self.low(last), self.high(last));
        let beyond = simd.sse._mm_cmpgt_ps(nearest, simd.sse._mm_set1_ps(farthest + distance_error));
        let behind = simd.sse._mm_cmplt_ps(last, simd.sse._mm_set1_ps(-distance_error));
        let missed = simd.sse._mm_or_ps(outside, simd.sse._mm_or_ps(beyond, behind));
        !simd.sse._mm_movemask_ps(missed) as u32 & block.all()
    }

    #[inline(always)]
    fn prefetch<T: Fetched>(self, place: &T) {
        let start = std::ptr::from_ref(place).cast::<i8>();
        for line in (0..size_of::<T>()).step_by(64) {
            self.0.sse._mm_prefetch::<_MM_HINT_T0>(start.wrapping_add(line));
        }
    }
}
