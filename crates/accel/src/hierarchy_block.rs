//! The triangles of a leaf, four at once, in one cache line. Nearly all misses are rejected here;
//! the remaining candidates are tested in double precision.

use crate::hierarchy_node::{Grid, lanes};
use crate::ray::sheared_axes;
use glam::{DVec3, Vec3, Vec4};

/// Error of a projected coordinate relative to the bounding radius, due to the rounding of origin,
/// direction, shear and differences: 35 units in the last place of numbers of the size of the
/// radius are 2.1e-6.
const RELATIVE_ERROR: f32 = 4e-6;

/// Up to four triangles, with vertices quantised to a grid.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Block {
    /// By axis, by vertex (the third one first), by triangle.
    corners: [[u8; 12]; 3],
    grid: Grid,
    slots: u32,
}

/// The number of items is stored in the bits of `slots` above these.
const COUNT_SHIFT: u32 = 29;

/// Set if an item of the block is not a triangle, so that nothing may be rejected.
const HOLDS_OTHERS: u32 = 1 << 31;

impl Block {
    /// Packs the items in the slots from `first_slot` on; triangles have vertices relative to the
    /// centre of the hierarchy.
    pub(crate) fn new(first_slot: u32, items: &[Option<[DVec3; 3]>]) -> Block {
        let count = items.len();
        let slots = (count as u32 - 1) << COUNT_SHIFT | first_slot;
        let mut triangles = [[Vec3::ZERO; 3]; 4];
        for (triangle, item) in triangles.iter_mut().zip(items) {
            match item {
                Some(corners) => *triangle = corners.map(|corner| corner.as_vec3()),
                None => return Block { corners: [[0; 12]; 3], grid: Grid::default(), slots: slots | HOLDS_OTHERS },
            }
        }
        let corners = triangles[..count].iter().flatten();
        let (low, high) = corners
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), corner| (low.min(*corner), high.max(*corner)));
        let grid = Grid::over(low, high);
        let mut corners = [[0; 12]; 3];
        for (lane, triangle) in triangles[..count].iter().enumerate() {
            for (vertex, point) in triangle.iter().enumerate() {
                for (axis, places) in corners.iter_mut().enumerate() {
                    places[4 * ((vertex + 1) % 3) + lane] = grid.steps(axis, point[axis]).round() as u8;
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
    pub(crate) fn all(&self) -> u32 {
        (2 << (self.slots >> COUNT_SHIFT & 3)) - 1
    }

    /// Whether an item is not a triangle.
    #[inline(always)]
    pub(crate) fn holds_others(&self) -> bool {
        self.slots & HOLDS_OTHERS != 0
    }

    /// The grid coordinates of all vertices along an axis: the third ones, the first, the second.
    #[inline(always)]
    pub(crate) fn places(&self, axis: usize) -> &[u8; 12] {
        &self.corners[axis]
    }
}

/// A ray sheared to run along one axis (Woop, Benthin, Wald, "Watertight Ray/Triangle
/// Intersection", JCGT 2(1), 2013), with the single-precision error bound.
pub(crate) struct Probe {
    /// The axes of u and v, and the longest one.
    pub(crate) axes: [usize; 3],
    /// The ray's origin along these axes.
    origin: [f32; 3],
    shear: [f32; 2],
    /// Reciprocal of the direction along the longest axis.
    inverse: f32,
    error: f32,
}

/// The grid of a block as a ray sees it: its coordinates are `start + places·step`.
pub(crate) struct Projection {
    /// Of u and v, from the ray.
    pub(crate) start: [f32; 2],
    pub(crate) step: [f32; 2],
    /// By how much u and v change per step along the ray's longest axis.
    pub(crate) shear: [f32; 2],
    /// Maximum error of a coordinate.
    pub(crate) error: f32,
    /// Of the distance along the ray, per step along its longest axis.
    pub(crate) distance: f32,
    pub(crate) distance_step: f32,
    pub(crate) distance_error: f32,
}

impl Probe {
    /// For a ray from `origin`, relative to the centre of a hierarchy with this radius.
    #[inline(always)]
    pub(crate) fn new(origin: Vec3, direction: Vec3, radius: f32) -> Probe {
        let axes = sheared_axes(direction.abs().to_array());
        let (origin, direction) = (origin.to_array(), direction.to_array());
        let inverse = direction[axes[2]].recip();
        Probe {
            axes,
            origin: [origin[axes[0]], origin[axes[1]], origin[axes[2]]],
            shear: [direction[axes[0]] * inverse, direction[axes[1]] * inverse],
            inverse,
            error: RELATIVE_ERROR * radius,
        }
    }

    #[inline(always)]
    pub(crate) fn project(&self, block: &Block) -> Projection {
        let [x, y, z] = self.axes;
        let grid = &block.grid;
        let along = grid.origin[z] - self.origin[2];
        let [step_x, step_y, step_z] = [grid.step[x], grid.step[y], grid.step[z]];
        let shear = [self.shear[0] * step_z, self.shear[1] * step_z];
        // A vertex is within half a grid step of its exact position.
        let [steps_x, steps_y] = [step_x + shear[0].abs(), step_y + shear[1].abs()];
        let steps = if steps_x > steps_y { steps_x } else { steps_y };
        Projection {
            start: [
                grid.origin[x] - self.origin[0] - self.shear[0] * along,
                grid.origin[y] - self.origin[1] - self.shear[1] * along,
            ],
            step: [step_x, step_y],
            shear,
            error: self.error + 0.5 * steps,
            distance: along * self.inverse,
            distance_step: step_z * self.inverse,
            // The longest component of a unit vector is at least 1/√3.
            distance_error: 1.74 * (self.error + 0.5 * step_z),
        }
    }

    /// One bit per item that the ray may hit before `farthest`.
    #[inline]
    pub(crate) fn candidates(&self, block: &Block, farthest: f32) -> u32 {
        if block.holds_others() {
            return block.all();
        }
        let Projection { start, step, shear, error, distance, distance_step, distance_error } = self.project(block);
        let [c, a, b] = [0, 1, 2].map(|vertex| {
            let [x, y, z] = self.axes.map(|axis| lanes(block.places(axis).as_chunks().0[vertex]));
            [
                x * step[0] - z * shear[0] + Vec4::splat(start[0]),
                y * step[1] - z * shear[1] + Vec4::splat(start[1]),
                z * distance_step + Vec4::splat(distance),
            ]
        });
        let sides = [c[0] * b[1] - c[1] * b[0], a[0] * c[1] - a[1] * c[0], b[0] * a[1] - b[1] * a[0]];
        let low = sides[0].min(sides[1]).min(sides[2]);
        let high = sides[0].max(sides[1]).max(sides[2]);
        // The error of an edge's determinant is at most the error of each coordinate times the sum
        // of the others.
        let size = a[0].abs() + a[1].abs() + b[0].abs() + b[1].abs() + c[0].abs() + c[1].abs();
        let slack = (size + Vec4::splat(error)) * Vec4::splat(error);
        let outside = low.cmplt(-slack) & high.cmpgt(slack);
        let beyond = a[2].min(b[2]).min(c[2]).cmpgt(Vec4::splat(farthest + distance_error));
        let behind = a[2].max(b[2]).max(c[2]).cmplt(Vec4::splat(-distance_error));
        !(outside | beyond | behind).bitmask() & block.all()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_candidate(triangle: [DVec3; 3], origin: Vec3, direction: Vec3, farthest: f32) -> bool {
        let block = Block::new(7, &[Some(triangle)]);
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
        let block = Block::new(3, &[None, Some(TRIANGLE)]);
        let probe = Probe::new(Vec3::new(0.9, 0.9, 0.0), Vec3::Z, 2.0);
        assert_eq!((block.first_slot(), probe.candidates(&block, 10.0)), (3, 0b11));
    }
}
