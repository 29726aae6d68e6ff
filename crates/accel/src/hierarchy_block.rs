//! The triangles of a leaf, four at once, in one cache line. Nearly all misses are rejected here;
//! the remaining candidates are tested in double precision.

use crate::hierarchy_node::{Grid, lanes};
use glam::{DVec3, Vec3, Vec4};

/// Error of a projected coordinate relative to the bounding radius, due to the rounding of origin,
/// direction, shear and differences: 35 units in the last place of numbers of the size of the
/// radius are 2.1e-6.
const RELATIVE_ERROR: f32 = 4e-6;

/// Up to four triangles, with vertices quantised to a grid.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Block {
    /// By vertex, by axis, by triangle.
    corners: [[[u8; 4]; 3]; 3],
    grid: Grid,
    slots: u32,
}

/// The number of items is stored in the bits of `slots` above these.
const COUNT_SHIFT: u32 = 29;

/// Set if an item of the block is not a triangle, so that nothing may be rejected.
const HOLDS_OTHERS: u32 = 1 << 31;

impl Block {
    /// Packs `count` slots from `first_slot` on; triangles have vertices relative to the centre of
    /// the hierarchy.
    pub(crate) fn new(first_slot: u32, count: u32, triangle_of: impl Fn(u32) -> Option<[DVec3; 3]>) -> Block {
        let slots = (count - 1) << COUNT_SHIFT | first_slot;
        let mut triangles = [[Vec3::ZERO; 3]; 4];
        for lane in 0..count {
            match triangle_of(first_slot + lane) {
                Some(triangle) => triangles[lane as usize] = triangle.map(|corner| corner.as_vec3()),
                None => return Block { corners: [[[0; 4]; 3]; 3], grid: Grid::default(), slots: slots | HOLDS_OTHERS },
            }
        }
        let corners = triangles[..count as usize].iter().flatten();
        let (low, high) = corners
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), corner| (low.min(*corner), high.max(*corner)));
        let grid = Grid::over(low, high);
        let mut corners = [[[0; 4]; 3]; 3];
        for (lane, triangle) in triangles[..count as usize].iter().enumerate() {
            for (corner, point) in corners.iter_mut().zip(triangle) {
                for (axis, place) in corner.iter_mut().enumerate() {
                    place[lane] = grid.steps(axis, point[axis]).round() as u8;
                }
            }
        }
        Block { corners, grid, slots }
    }

    /// The first slot.
    #[inline]
    pub(crate) fn first_slot(&self) -> u32 {
        self.slots & ((1 << COUNT_SHIFT) - 1)
    }

    /// All slots.
    pub(crate) fn slots(&self) -> std::ops::Range<u32> {
        let first = self.first_slot();
        first..first + (self.slots >> COUNT_SHIFT & 3) + 1
    }

    /// One bit per item.
    #[inline(always)]
    fn all(&self) -> u32 {
        (2 << (self.slots >> COUNT_SHIFT & 3)) - 1
    }
}

/// A ray sheared to run along one axis (Woop, Benthin, Wald, "Watertight Ray/Triangle
/// Intersection", JCGT 2(1), 2013), with the single-precision error bound.
pub(crate) struct Probe {
    axes: [usize; 3],
    origin: [f32; 3],
    shear: [f32; 2],
    /// Reciprocal of the direction along the longest axis.
    inverse: f32,
    error: f32,
}

impl Probe {
    /// For a ray from `origin`, relative to the centre of a hierarchy with this radius.
    #[inline]
    pub(crate) fn new(origin: Vec3, direction: Vec3, radius: f32) -> Probe {
        let z = direction.abs().max_position();
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        let inverse = direction[z].recip();
        Probe {
            axes,
            origin: axes.map(|axis| origin[axis]),
            shear: [axes[0], axes[1]].map(|axis| direction[axis] * inverse),
            inverse,
            error: RELATIVE_ERROR * radius,
        }
    }

    /// One bit per item that the ray may hit before `farthest`.
    #[inline(always)]
    pub(crate) fn candidates(&self, block: &Block, farthest: f32) -> u32 {
        if block.slots & HOLDS_OTHERS != 0 {
            return block.all();
        }
        let [x, y, z] = self.axes;
        let step = self.axes.map(|axis| block.grid.step[axis]);
        let from = [0, 1, 2].map(|at| block.grid.origin[self.axes[at]] - self.origin[at]);
        let start = [0, 1].map(|at| Vec4::splat(from[at] - self.shear[at] * from[2]));
        let shear = [0, 1].map(|at| Vec4::splat(self.shear[at] * step[2]));
        let [step_x, step_y, step_z] = step.map(Vec4::splat);
        let [a, b, c] = block.corners.map(|corner| {
            let along = lanes(corner[z]);
            [
                lanes(corner[x]) * step_x - along * shear[0] + start[0],
                lanes(corner[y]) * step_y - along * shear[1] + start[1],
                along * step_z,
            ]
        });
        let sides = [c[0] * b[1] - c[1] * b[0], a[0] * c[1] - a[1] * c[0], b[0] * a[1] - b[1] * a[0]];
        let low = sides[0].min(sides[1]).min(sides[2]);
        let high = sides[0].max(sides[1]).max(sides[2]);
        // A vertex is within half a grid step of its exact position, and the shear adds at most as
        // much along the ray.
        let error = self.error + 0.5 * (step[0].max(step[1]) + step[2]);
        // The error of an edge's determinant is at most the error of each coordinate times the sum
        // of the others.
        let size = a[0].abs() + a[1].abs() + b[0].abs() + b[1].abs() + c[0].abs() + c[1].abs();
        let slack = (size + Vec4::splat(error)) * Vec4::splat(error);
        let outside = low.cmplt(-slack) & high.cmpgt(slack);
        // The longest component of a unit vector is at least 1/√3.
        let error = 1.74 * (self.error + 0.5 * step[2]);
        let distances = [a[2], b[2], c[2]].map(|along| (along + Vec4::splat(from[2])) * Vec4::splat(self.inverse));
        let beyond = distances[0].min(distances[1]).min(distances[2]).cmpgt(Vec4::splat(farthest + error));
        let behind = distances[0].max(distances[1]).max(distances[2]).cmplt(Vec4::splat(-error));
        !(outside | beyond | behind).bitmask() & block.all()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_candidate(triangle: [DVec3; 3], origin: Vec3, direction: Vec3, farthest: f32) -> bool {
        let block = Block::new(7, 1, |_| Some(triangle));
        Probe::new(origin, direction.normalize(), 2.0).candidates(&block, farthest) == 1
    }

    const TRIANGLE: [DVec3; 3] = [DVec3::new(0.0, 0.0, 1.0), DVec3::new(1.0, 0.0, 1.0), DVec3::new(0.0, 1.0, 1.2)];

    #[test]
    fn a_block_fills_a_cache_line() {
        assert_eq!(size_of::<Block>(), 64);
    }

    #[test]
    fn only_hits_before_the_limit_are_candidates() {
        assert!(is_candidate(TRIANGLE, Vec3::new(0.2, 0.2, -0.5), Vec3::Z, 10.0));
        assert!(!is_candidate(TRIANGLE, Vec3::new(0.7, 0.7, -0.5), Vec3::Z, 10.0));
        assert!(!is_candidate(TRIANGLE, Vec3::new(0.2, 0.2, -0.5), Vec3::Z, 1.0));
        assert!(!is_candidate(TRIANGLE, Vec3::new(0.2, 0.2, -0.5), -Vec3::Z, 10.0));
    }

    #[test]
    fn an_edge_and_a_vertex_are_never_rejected() {
        for (x, y) in [(0.0, 0.0), (0.5, 0.5), (1.0, 0.0), (0.0, 0.3), (0.25, 0.75)] {
            let target = Vec3::new(x, y, 1.0 + 0.2 * y);
            for origin in [Vec3::new(-1.3, 0.4, -0.7), Vec3::new(0.1, 0.2, 1.9), Vec3::new(1.1, -1.2, 0.3)] {
                assert!(is_candidate(TRIANGLE, origin, target - origin, 10.0), "{origin} to {target}");
            }
        }
    }

    #[test]
    fn blocks_with_other_items_reject_nothing() {
        let block = Block::new(3, 2, |slot| (slot == 4).then_some(TRIANGLE));
        let probe = Probe::new(Vec3::new(0.9, 0.9, 0.0), Vec3::Z, 2.0);
        assert_eq!((block.first_slot(), probe.candidates(&block, 10.0)), (3, 0b11));
    }
}
