//! Polygons with four vertices, which most polygons have. On x86-64 two vertices are tested at once
//! (SSE2): the operations of `polygon.rs`, and so its results.

use crate::polygon::{RayFrame, distance, passes_through};
use crate::ray::Ray;
use glam::DVec3;
#[cfg(target_arch = "x86_64")]
use pulp::core_arch::x86::Sse2;
#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::__m128d;
use std::ops::Range;

/// Distance along the ray to the polygon's plane, if the ray passes through the polygon.
#[inline(always)]
pub(crate) fn intersect(vertices: &[DVec3; 4], ray: &Ray, frame: &RayFrame, range: Range<f64>) -> Option<f64> {
    if passes_through_four(vertices, frame) { distance(vertices, ray, range) } else { None }
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn passes_through_four(vertices: &[DVec3; 4], frame: &RayFrame) -> bool {
    match Pairs::new() {
        Some(pairs) => pairs.passes_through(vertices, frame),
        None => passes_through_scalars(vertices, frame),
    }
}

#[cfg(target_arch = "x86_64")]
#[cold]
fn passes_through_scalars(vertices: &[DVec3; 4], frame: &RayFrame) -> bool {
    passes_through(vertices, frame)
}

#[cfg(not(target_arch = "x86_64"))]
#[inline(always)]
fn passes_through_four(vertices: &[DVec3; 4], frame: &RayFrame) -> bool {
    passes_through(vertices, frame)
}

/// Vectors of two numbers.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy, Debug)]
struct Pairs(Sse2);

/// The coordinates u and v of two points.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
struct Projected {
    u: __m128d,
    v: __m128d,
}

#[cfg(target_arch = "x86_64")]
impl Pairs {
    /// `None` if the processor lacks them, which no x86-64 processor does.
    #[inline(always)]
    fn new() -> Option<Pairs> {
        Sse2::try_new().map(Pairs)
    }

    /// Whether the line of a ray crosses the polygon: the parity of edges that cross the positive
    /// half axis.
    #[inline(always)]
    fn passes_through(self, vertices: &[DVec3; 4], frame: &RayFrame) -> bool {
        let first = self.project([&vertices[0], &vertices[1]], frame);
        let last = self.project([&vertices[2], &vertices[3]], frame);
        let crossed = self.crosses(self.before(first, last), first) ^ self.crosses(self.before(last, first), last);
        crossed.count_ones() & 1 == 1
    }

    #[inline(always)]
    fn project(self, points: [&DVec3; 2], frame: &RayFrame) -> Projected {
        let Pairs(sse2) = self;
        let along = self.relative(points, frame, 2);
        let moved = |slope: f64| sse2._mm_mul_pd(sse2._mm_set1_pd(slope), along);
        let [u, v] = [self.relative(points, frame, 0), self.relative(points, frame, 1)];
        Projected { u: sse2._mm_add_pd(u, moved(frame.slopes[0])), v: sse2._mm_add_pd(v, moved(frame.slopes[1])) }
    }

    /// The coordinates of two points along one of the axes, relative to the ray's origin.
    #[inline(always)]
    fn relative(self, [first, second]: [&DVec3; 2], frame: &RayFrame, index: usize) -> __m128d {
        let Pairs(sse2) = self;
        let (first, second): (&[f64; 3], &[f64; 3]) = (first.as_ref(), second.as_ref());
        let axis = frame.axes[index];
        sse2._mm_sub_pd(sse2._mm_set_pd(second[axis], first[axis]), sse2._mm_set1_pd(frame.origin[index]))
    }

    /// The point before each of two; `other` ends with that before the first.
    #[inline(always)]
    fn before(self, two: Projected, other: Projected) -> Projected {
        let Pairs(sse2) = self;
        Projected { u: sse2._mm_shuffle_pd::<0b01>(other.u, two.u), v: sse2._mm_shuffle_pd::<0b01>(other.v, two.v) }
    }

    /// Which of two edges cross the positive half of the u axis, a bit for each.
    #[inline(always)]
    fn crosses(self, from: Projected, to: Projected) -> i32 {
        let Pairs(sse2) = self;
        let zero = sse2._mm_setzero_pd();
        let determinant = sse2._mm_sub_pd(sse2._mm_mul_pd(from.u, to.v), sse2._mm_mul_pd(to.u, from.v));
        let rises = sse2._mm_cmpgt_pd(to.v, from.v);
        let is_apart = sse2._mm_xor_pd(sse2._mm_cmpge_pd(from.v, zero), sse2._mm_cmpge_pd(to.v, zero));
        let rising = sse2._mm_and_pd(rises, sse2._mm_cmpgt_pd(determinant, zero));
        let falling = sse2._mm_andnot_pd(rises, sse2._mm_cmplt_pd(determinant, zero));
        sse2._mm_movemask_pd(sse2._mm_and_pd(is_apart, sse2._mm_or_pd(rising, falling)))
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;

    #[test]
    fn vectors_agree_with_scalars() {
        let number = |index: u32, step: f64| (f64::from(index) * step).fract();
        let pairs = Pairs::new().unwrap();
        let (mut passing, count) = (0, 20_000);
        for index in 0..count {
            // Few different coordinates, so that edges often pass through the ray.
            let at = |step: f64| (8.0 * number(index, step)).round() - 4.0;
            let vertex = |steps: [f64; 3]| DVec3::from(steps.map(at));
            let quadrilateral = [
                vertex([0.754_877, 0.569_840, 0.618_034]),
                vertex([0.819_172, 0.671_043, 0.549_700]),
                vertex([0.856_674, 0.733_891, 0.628_706]),
                vertex([0.414_213, 0.732_050, 0.236_067]),
            ];
            let origin = vertex([0.324_717, 0.220_744, 0.465_571]);
            let Some(ray) = Ray::new(origin, vertex([0.645_751, 0.162_277, 0.316_624]) - origin) else { continue };
            let frame = RayFrame::new(&ray);
            let expected = passes_through(&quadrilateral, &frame);
            assert_eq!(pairs.passes_through(&quadrilateral, &frame), expected, "ray {index}");
            passing += u32::from(expected);
        }
        assert!(passing > count / 20, "{passing} pass");
    }
}
