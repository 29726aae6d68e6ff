//! The vector instructions of the processor, selected when a hierarchy is built.
//!
//! The baseline of the architecture, or AVX2 with fused multiply-add. Either way only certain misses
//! are rejected, so results do not depend on the selection.

#[cfg(target_arch = "x86_64")]
use crate::hierarchy_avx2::Avx2;
use crate::hierarchy_vectors::Baseline;

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
            return Processor::Avx2(Avx2::new(simd));
        }
        Processor::Baseline(Baseline)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hierarchy_block::{Block, Probe};
    use crate::hierarchy_child::Child;
    use crate::hierarchy_node::{Node, Slabs, WIDTH};
    use crate::hierarchy_vectors::Vectors;
    use glam::{DVec3, Vec3};

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

    fn matches<const N: usize>(of: impl Fn(usize) -> bool) -> u32 {
        (0..N).map(|lane| u32::from(of(lane)) << lane).sum()
    }

    #[test]
    fn every_triangle_that_a_ray_hits_is_a_candidate_whatever_the_processor() {
        let (mut hits, mut candidates) = (0, 0);
        for round in 0..4000 {
            let triangles: [[DVec3; 3]; 4] = std::array::from_fn(|lane| {
                let center = point(round);
                std::array::from_fn(|corner| {
                    (center + 0.2 * point(16 * round + 4 * corner as u32 + lane as u32)).as_dvec3()
                })
            });
            let block = Block::new(0, &triangles.map(Some));
            let (origin, through) = (1.2 * point(7 * round + 3), triangles[round as usize % 4]);
            let [u, v] = [round, round + 1].map(|index| 0.5 * f64::from(point(9 * index).x) + 0.5);
            // Every fourth ray passes through an edge.
            let v = if round % 4 == 0 { 0.0 } else { v * (1.0 - u) };
            let target = through[0] + u * (through[1] - through[0]) + v * (through[2] - through[0]);
            let direction = (target - origin.as_dvec3()).normalize();
            let ray = crate::ray::Ray { origin: origin.as_dvec3(), direction };
            let frame = crate::polygon::RayFrame::new(&ray);
            let farthest = if round % 3 == 0 { 0.7 } else { 10.0 };
            let hit = matches::<4>(|lane| {
                crate::polygon::intersect_triangle(&triangles[lane], &ray, &frame, 0.0..farthest).is_some()
            });
            let probe = Probe::new(origin, direction.as_vec3(), 2.0);
            let baseline = Baseline.candidates(&probe, &block, farthest as f32);
            assert_eq!(baseline & hit, hit, "round {round}");
            #[cfg(target_arch = "x86_64")]
            if let Processor::Avx2(avx2) = Processor::default() {
                let wide = avx2.candidates(&probe, &block, farthest as f32);
                assert_eq!(wide & hit, hit, "round {round}");
            }
            hits += hit.count_ones();
            candidates += baseline.count_ones();
        }
        assert!(hits > 2000 && candidates < hits + hits / 4, "{hits} of {candidates}");
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
