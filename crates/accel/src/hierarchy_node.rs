//! Nodes of a hierarchy: eight boxes on a grid in two cache lines, tested four at once (after
//! Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide
//! BVHs", High-Performance Graphics 2017, section 3.1).

use crate::hierarchy_child::{Child, PendingChild};
use crate::shaft::SIDES;
use glam::{Vec3, Vec4};

/// A grid of 256 steps along each axis.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Grid {
    pub(crate) origin: [f32; 3],
    /// Size of a step.
    pub(crate) step: [f32; 3],
}

impl Grid {
    /// Covers the box; the last grid point is never below the high corner.
    pub(crate) fn over(low: Vec3, high: Vec3) -> Grid {
        let step = (high - low) * ((1.0 + 4.0 * f32::EPSILON) / 255.0);
        Grid { origin: low.to_array(), step: step.to_array() }
    }

    /// The coordinate in steps from the origin, 0 to 255.
    pub(crate) fn steps(&self, axis: usize, coordinate: f32) -> f32 {
        let steps = (coordinate - self.origin[axis]) / self.step[axis];
        // A grid without extent has one point.
        if steps.is_finite() { steps.clamp(0.0, 255.0) } else { 0.0 }
    }
}

/// Four grid coordinates as floats.
#[inline(always)]
pub(crate) fn lanes(places: [u8; 4]) -> Vec4 {
    Vec4::from_array(places.map(f32::from))
}

/// Number of boxes of a node.
pub(crate) const WIDTH: usize = 8;

/// One side of all boxes of a node on its grid, in halves.
pub(crate) type Planes = [[u8; 4]; WIDTH / 4];

/// Eight boxes, and their content.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Node {
    /// The low sides by axis, then the high sides, in halves.
    planes: [Planes; 6],
    grid: Grid,
    pub(crate) children: [Child; WIDTH],
}

impl Node {
    /// Without boxes.
    pub(crate) const EMPTY: Node = Node {
        planes: [[[0; 4]; WIDTH / 4]; 6],
        grid: Grid { origin: [0.0; 3], step: [0.0; 3] },
        children: [Child::NONE; WIDTH],
    };

    /// Around up to eight boxes, low and high corner; the others are never entered.
    pub(crate) fn around(boxes: &[[Vec3; 2]], children: [Child; WIDTH]) -> Node {
        let (low, high) = boxes
            .iter()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), of| (low.min(of[0]), high.max(of[1])));
        let grid = Grid::over(low, high);
        let mut planes = [255, 255, 255, 0, 0, 0].map(|place| [[place; 4]; WIDTH / 4]);
        for (lane, [low, high]) in boxes.iter().enumerate() {
            for axis in 0..3 {
                planes[axis][lane / 4][lane % 4] = grid.steps(axis, low[axis]).floor() as u8;
                planes[axis + 3][lane / 4][lane % 4] = grid.steps(axis, high[axis]).ceil() as u8;
            }
        }
        Node { planes, grid, children }
    }

    /// The children whose boxes are not entirely outside one side of a convex region (see
    /// [`crate::Shaft`]).
    #[inline]
    pub(crate) fn reaching_into(&self, sides: &[(Vec3, f32); SIDES]) -> impl Iterator<Item = Child> {
        let mut lanes_in = u32::MAX;
        for (normal, offset) in sides {
            let mut inward = [Vec4::splat(*offset); WIDTH / 4];
            for axis in 0..3 {
                // The corner farthest inside.
                let planes = &self.planes[if normal[axis] < 0.0 { axis } else { axis + 3 }];
                let start = Vec4::splat(self.grid.origin[axis] * normal[axis]);
                let step = Vec4::splat(self.grid.step[axis] * normal[axis]);
                for half in 0..WIDTH / 4 {
                    inward[half] += lanes(planes[half]) * step + start;
                }
            }
            let zero = Vec4::ZERO;
            lanes_in &= inward[0].cmpge(zero).bitmask() | inward[1].cmpge(zero).bitmask() << 4;
        }
        (0..WIDTH)
            .filter(move |lane| lanes_in >> lane & 1 != 0)
            .map(|lane| self.children[lane])
            .filter(|child| *child != Child::NONE)
    }
}

/// A ray prepared for box tests.
pub(crate) struct Slabs {
    origin: [f32; 3],
    /// Reciprocal of the direction.
    inverse: [f32; 3],
    /// The planes of a node that the ray crosses first and last.
    first: [usize; 3],
    last: [usize; 3],
}

/// The children whose boxes a ray enters.
pub(crate) struct Entered {
    /// One bit per child.
    lanes: u32,
    entries: [f32; WIDTH],
}

impl Slabs {
    #[inline]
    pub(crate) fn new(origin: Vec3, direction: Vec3) -> Slabs {
        // A ray parallel to a plane of a box must not compute zero times infinity.
        let inverse = direction
            .map(|component| if component.abs() < 1e-30 { 1e30_f32.copysign(component) } else { component.recip() });
        let down = direction.to_array().map(f32::is_sign_negative);
        let plane = |axis: usize, high: bool| axis + 3 * usize::from(high);
        Slabs {
            origin: origin.to_array(),
            inverse: inverse.to_array(),
            first: [0, 1, 2].map(|axis| plane(axis, down[axis])),
            last: [0, 1, 2].map(|axis| plane(axis, !down[axis])),
        }
    }

    #[inline(always)]
    pub(crate) fn enter(&self, node: &Node, farthest: f32) -> Entered {
        let mut near = [Vec4::ZERO; WIDTH / 4];
        let mut far = [Vec4::splat(farthest); WIDTH / 4];
        for axis in 0..3 {
            let (start, step, [first, last]) = self.along(axis, node);
            let (start, step) = (Vec4::splat(start), Vec4::splat(step));
            for half in 0..WIDTH / 4 {
                near[half] = (lanes(first[half]) * step + start).max(near[half]);
                far[half] = (lanes(last[half]) * step + start).min(far[half]);
            }
        }
        let lanes = near[0].cmple(far[0]).bitmask() | near[1].cmple(far[1]).bitmask() << 4;
        let [low, high] = near.map(|half| half.to_array());
        Entered::new(lanes, std::array::from_fn(|lane| if lane < 4 { low[lane] } else { high[lane - 4] }))
    }

    /// For one axis: the distances along the ray to the first grid point of a node and per grid
    /// step, and the planes that it crosses first and last.
    #[inline(always)]
    pub(crate) fn along<'n>(&self, axis: usize, node: &'n Node) -> (f32, f32, [&'n Planes; 2]) {
        let start = (node.grid.origin[axis] - self.origin[axis]) * self.inverse[axis];
        let step = node.grid.step[axis] * self.inverse[axis];
        (start, step, [&node.planes[self.first[axis]], &node.planes[self.last[axis]]])
    }
}

impl Entered {
    /// With a bit per child, and their entry distances.
    #[inline(always)]
    pub(crate) fn new(lanes: u32, entries: [f32; WIDTH]) -> Entered {
        Entered { lanes, entries }
    }

    /// Any child that was not returned yet.
    #[inline(always)]
    pub(crate) fn next(&mut self, node: &Node) -> Option<PendingChild> {
        if self.lanes == 0 {
            return None;
        }
        let lane = self.lanes.trailing_zeros() as usize % WIDTH;
        self.lanes &= self.lanes - 1;
        Some(PendingChild::new(node.children[lane], self.entries[lane]))
    }

    /// Whether all were returned.
    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        self.lanes == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_node_fills_two_cache_lines() {
        assert_eq!(size_of::<Node>(), 128);
    }

    #[test]
    fn quantised_boxes_contain_the_given_boxes() {
        let of =
            |x: f32, y: f32, z: f32, size: f32| [Vec3::new(x, y, z), Vec3::new(x + size, y + 2.0 * size, z + 1e-6)];
        let boxes = [of(0.0, -1.0, 0.3, 0.37), of(0.11, 0.7, 0.3, 1e-4), of(-2.3, 0.2, 0.3, 3.1)];
        let node = Node::around(&boxes, [Child::NONE; WIDTH]);
        for (lane, [low, high]) in boxes.iter().enumerate() {
            for axis in 0..3 {
                let place = |plane: usize| {
                    node.grid.origin[axis] + f32::from(node.planes[plane][lane / 4][lane % 4]) * node.grid.step[axis]
                };
                assert!(place(axis) <= low[axis] + 1e-6 && place(axis + 3) >= high[axis] - 1e-6, "{lane} {axis}");
            }
        }
    }
}
