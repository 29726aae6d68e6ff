//! The hierarchy of boxes: four boxes a node, tested at once.
//!
//! It is in single precision about the centre of what it holds, with boxes padded by more than its rounding; what it proposes is
//! decided in double precision. A ray that starts far outside is first moved to the bounding sphere.

use super::bounds::Bounds;
use super::hierarchy_build::{Built, build};
use crate::ray::Ray;
use glam::{DVec3, Vec3, Vec4};

/// Padding of boxes as a share of the size of the whole: well above the rounding of single precision in the slab tests.
const BOX_PADDING: f64 = 2e-6;

/// Boxes in boxes around items. Items have slots, so that those of a box have slots one after the other.
#[derive(Debug, Default)]
pub(super) struct Hierarchy {
    nodes: Vec<Node>,
    root: Child,
    bounds: Bounds,
    center: DVec3,
    radius: f64,
}

/// Four boxes, by axis and by low and high side, and what is in them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) low: [Vec4; 3],
    pub(super) high: [Vec4; 3],
    pub(super) children: [Child; 4],
}

/// A node, or up to four items.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Child(u32);

/// Most items of a box without boxes in it.
pub(super) const LARGEST_LEAF: usize = 4;

const LEAF: u32 = 1 << 31;
const COUNT_SHIFT: u32 = 29;

impl Child {
    /// Most items of a hierarchy.
    const MOST_ITEMS: u32 = 1 << COUNT_SHIFT;

    pub(super) fn node(index: usize) -> Child {
        Child(index as u32)
    }

    /// Items in `count` slots from `first` on: 1 to [`LARGEST_LEAF`].
    pub(super) fn leaf(first: usize, count: usize) -> Child {
        Child(LEAF | (count as u32 - 1) << COUNT_SHIFT | first as u32)
    }

    /// The same child where `nodes` nodes stand before its own.
    pub(super) fn shifted(self, nodes: usize) -> Child {
        if self.0 & LEAF == 0 { Child(self.0 + nodes as u32) } else { self }
    }

    #[inline]
    fn slots(self) -> Option<std::ops::Range<u32>> {
        let first = self.0 & (Child::MOST_ITEMS - 1);
        (self.0 & LEAF != 0).then(|| first..first + (self.0 >> COUNT_SHIFT & 3) + 1)
    }
}

/// A child that waits, and where the ray enters it.
type Waiting = (Child, f32);

/// Children that wait before memory is asked for. More are rare: nodes below nodes to this depth and a third.
const STACK: usize = 48;

impl Hierarchy {
    /// Around items that are numbered from 0; tells also which item is in which slot.
    pub(super) fn build(count: usize, bounds_of: impl Fn(usize) -> Bounds + Sync) -> (Hierarchy, Vec<u32>) {
        let all = (0..count).map(&bounds_of);
        let bounds = all.reduce(Bounds::union).unwrap_or(Bounds::point(DVec3::ZERO));
        let center = (bounds.min + bounds.max) * 0.5;
        let radius = 0.5 * (bounds.max - bounds.min).length();
        let padding = DVec3::splat(BOX_PADDING * radius);
        let Built { nodes, root, order } = build(count, |item| {
            let Bounds { min, max } = bounds_of(item);
            [(min - center - padding).as_vec3(), (max - center + padding).as_vec3()]
        });
        (Hierarchy { nodes, root, bounds, center, radius }, order)
    }

    /// The box around all items.
    pub(super) fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Centre and radius of a sphere around all items.
    pub(super) fn bounding_sphere(&self) -> (DVec3, f64) {
        (self.center, self.radius)
    }

    /// Visits the slots of items that a ray may meet before `limit`, the nearest boxes first. `visit` tells the limit from
    /// then on; below zero ends it.
    #[inline]
    pub(super) fn visit(&self, ray: &Ray, limit: f64, mut visit: impl FnMut(u32) -> f64) {
        let (start, skip) = self.start(ray);
        let to_single = |distance: f64| ((distance - skip).max(0.0) as f32).next_up();
        let slabs = Slabs::new(start.as_vec3(), ray.direction.as_vec3());
        let mut stack = [(Child(0), 0.0); STACK];
        let mut waiting = 0;
        let mut overflow: Vec<Waiting> = Vec::new();
        let mut farthest = to_single(limit);
        let mut current = self.root;
        loop {
            if let Some(slots) = current.slots() {
                for slot in slots {
                    let limit = visit(slot);
                    if limit < 0.0 {
                        return;
                    }
                    farthest = to_single(limit);
                }
            } else if let Some(node) = self.nodes.get(current.0 as usize) {
                let mut entered = slabs.enter(node, farthest);
                if let Some((nearest, others)) = entered.sorted() {
                    for other in others {
                        match stack.get_mut(waiting) {
                            Some(place) => *place = *other,
                            None => overflow.push(*other),
                        }
                        waiting += 1;
                    }
                    current = nearest;
                    continue;
                }
            }
            current = loop {
                if waiting == 0 {
                    return;
                }
                waiting -= 1;
                let (child, entry) =
                    if waiting < STACK { stack[waiting] } else { overflow.pop().unwrap_or((self.root, 0.0)) };
                if entry <= farthest {
                    break child;
                }
            };
        }
    }

    /// Where the ray starts about the centre, and how far it was moved: single precision is for what is near, so a start outside
    /// twice the bounding sphere moves up to it.
    fn start(&self, ray: &Ray) -> (DVec3, f64) {
        let from_center = ray.origin - self.center;
        let skip = if from_center.length_squared() > 4.0 * self.radius * self.radius {
            (-from_center.dot(ray.direction) - 1.5 * self.radius).max(0.0)
        } else {
            0.0
        };
        (from_center + ray.direction * skip, skip)
    }
}

/// A ray as the boxes see it.
struct Slabs {
    /// Minus the origin over the direction, and one over the direction, by axis.
    offset: [Vec4; 3],
    inverse: [Vec4; 3],
    /// Whether the ray runs down the axis.
    down: [bool; 3],
}

/// The children whose boxes a ray enters.
struct Entered {
    children: [Waiting; 4],
    count: usize,
}

impl Slabs {
    #[inline]
    fn new(origin: Vec3, direction: Vec3) -> Slabs {
        // A ray along a plane of a box must not ask for zero times infinity.
        let inverse = direction
            .map(|component| if component.abs() < 1e-30 { 1e30_f32.copysign(component) } else { component.recip() });
        let offset = -origin * inverse;
        Slabs {
            offset: offset.to_array().map(Vec4::splat),
            inverse: inverse.to_array().map(Vec4::splat),
            down: direction.to_array().map(|component| component.is_sign_negative()),
        }
    }

    #[inline]
    fn enter(&self, node: &Node, farthest: f32) -> Entered {
        let mut near = Vec4::ZERO;
        let mut far = Vec4::splat(farthest);
        for axis in 0..3 {
            let (first, last) =
                if self.down[axis] { (node.high[axis], node.low[axis]) } else { (node.low[axis], node.high[axis]) };
            near = (first * self.inverse[axis] + self.offset[axis]).max(near);
            far = (last * self.inverse[axis] + self.offset[axis]).min(far);
        }
        let near_of = near.to_array();
        let mut entered = Entered { children: [(Child(0), 0.0); 4], count: 0 };
        let mut mask = near.cmple(far).bitmask();
        while mask != 0 {
            let index = mask.trailing_zeros() as usize & 3;
            mask &= mask - 1;
            entered.children[entered.count & 3] = (node.children[index], near_of[index]);
            entered.count += 1;
        }
        entered
    }
}

impl Entered {
    /// The nearest one, and the others from the farthest on.
    #[inline]
    fn sorted(&mut self) -> Option<(Child, &[Waiting])> {
        let children = self.children.get_mut(..self.count)?;
        for end in 1..children.len() {
            let mut place = end;
            while place > 0 && children[place - 1].1 < children[place].1 {
                children.swap(place - 1, place);
                place -= 1;
            }
        }
        children.split_last().map(|(nearest, others)| (nearest.0, others))
    }
}
