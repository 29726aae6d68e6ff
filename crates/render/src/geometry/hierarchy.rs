//! The hierarchy of boxes: eight boxes a node, and where it holds triangles, four of them a leaf.
//!
//! It is in single precision about the centre of what it holds, with boxes padded by more than its rounding; what it proposes is
//! decided in double precision. A ray that starts far outside is first moved to the bounding sphere.

use super::bounds::Bounds;
use super::hierarchy_block::{Block, Probe};
use super::hierarchy_build::{Built, Leaves, build};
use super::hierarchy_node::{Node, Slabs};
use crate::ray::Ray;
use glam::DVec3;

/// Padding of boxes as a share of the size of the whole: well above the rounding of single precision in the slab tests.
const BOX_PADDING: f64 = 2e-6;

/// Boxes in boxes around items. Items have slots, so that those of a box have slots one after the other.
#[derive(Debug, Default)]
pub(super) struct Hierarchy {
    nodes: Vec<Node>,
    /// The leaves, where they hold triangles; else the slots of a leaf stand in its [`Child`].
    blocks: Vec<Block>,
    root: Child,
    bounds: Bounds,
    center: DVec3,
    radius: f64,
}

/// A node, or up to four items: by their slots, or the number of their block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Child(u32);

/// Most items of a box without boxes in it.
pub(super) const LARGEST_LEAF: usize = 4;

const LEAF: u32 = 1 << 31;
const COUNT_SHIFT: u32 = 29;

impl Child {
    /// Nothing at all.
    pub(super) const NONE: Child = Child(!LEAF);

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
        if self.is_leaf() || self == Child::NONE { self } else { Child(self.0 + nodes as u32) }
    }

    #[inline]
    fn is_leaf(self) -> bool {
        self.0 & LEAF != 0
    }

    #[inline]
    fn slots(self) -> std::ops::Range<u32> {
        let first = self.0 & (Child::MOST_ITEMS - 1);
        first..first + (self.0 >> COUNT_SHIFT & 3) + 1
    }

    fn block(index: usize) -> Child {
        Child(LEAF | index as u32)
    }

    #[inline]
    fn block_index(self) -> usize {
        (self.0 & !LEAF) as usize
    }
}

/// A child that waits, below the distance at which the ray enters it: numbers of this kind stand in the order of the distances, which
/// are not negative.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Waiting(u64);

impl Waiting {
    #[inline]
    pub(super) fn new(child: Child, entry: f32) -> Waiting {
        Waiting(u64::from(entry.to_bits()) << 32 | u64::from(child.0))
    }

    #[inline]
    pub(super) fn child(self) -> Child {
        Child(self.0 as u32)
    }

    #[inline]
    fn entry(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }
}

/// Children that wait before memory is asked for. More are rare: nodes below nodes to this depth and a third.
const STACK: usize = 48;

impl Hierarchy {
    /// Around items that are numbered from 0, of which some may be triangles; tells also which item is in which slot.
    pub(super) fn build(
        count: usize,
        bounds_of: impl Fn(usize) -> Bounds + Sync,
        triangle_of: impl Fn(usize) -> Option<[DVec3; 3]>,
    ) -> (Hierarchy, Vec<u32>) {
        let all = (0..count).map(&bounds_of);
        let bounds = all.reduce(Bounds::union).unwrap_or(Bounds::point(DVec3::ZERO));
        let center = (bounds.min + bounds.max) * 0.5;
        let radius = 0.5 * (bounds.max - bounds.min).length();
        let padding = DVec3::splat(BOX_PADDING * radius);
        let triangles = (0..count).filter(|item| triangle_of(*item).is_some()).count();
        // With few triangles among other things a block would only stand in the way.
        let leaves = if 2 * triangles > count { Leaves::Blocks } else { Leaves::Slots };
        let Built { nodes, root, order } = build(count, leaves, |item| {
            let Bounds { min, max } = bounds_of(item);
            [(min - center - padding).as_vec3(), (max - center + padding).as_vec3()]
        });
        let mut hierarchy = Hierarchy { nodes, blocks: Vec::new(), root, bounds, center, radius };
        if leaves == Leaves::Blocks {
            hierarchy.pack(|slot| {
                let triangle = triangle_of(order[slot as usize] as usize)?;
                Some(triangle.map(|corner| corner - center))
            });
        }
        (hierarchy, order)
    }

    /// Puts what is in each leaf into a block.
    fn pack(&mut self, triangle_of: impl Fn(u32) -> Option<[DVec3; 3]>) {
        let children = self.nodes.iter_mut().flat_map(|node| &mut node.children).chain([&mut self.root]);
        for child in children.filter(|child| child.is_leaf()) {
            let slots = child.slots();
            *child = Child::block(self.blocks.len());
            self.blocks.push(Block::new(slots.start, slots.len() as u32, &triangle_of));
        }
        self.blocks.shrink_to_fit();
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
        let (start, direction) = (start.as_vec3(), ray.direction.as_vec3());
        let slabs = Slabs::new(start, direction);
        let probe = Probe::new(start, direction, self.radius as f32);
        let mut stack = [Waiting::default(); STACK];
        let mut waiting = 0;
        let mut overflow: Vec<Waiting> = Vec::new();
        let mut farthest = to_single(limit);
        let mut current = self.root;
        loop {
            if !current.is_leaf() {
                if let Some(node) = self.nodes.get(current.0 as usize)
                    && let Some((nearest, others)) = slabs.enter(node, farthest).sorted()
                {
                    for other in others {
                        self.touch(other.child());
                        match stack.get_mut(waiting) {
                            Some(place) => *place = *other,
                            None => overflow.push(*other),
                        }
                        waiting += 1;
                    }
                    current = nearest.child();
                    continue;
                }
            } else if let Some(block) = self.blocks.get(current.block_index()) {
                let mut candidates = probe.candidates(block, farthest);
                while candidates != 0 {
                    let limit = visit(block.first_slot() + candidates.trailing_zeros());
                    candidates &= candidates - 1;
                    if limit < 0.0 {
                        return;
                    }
                    farthest = to_single(limit);
                }
            } else {
                for slot in current.slots() {
                    let limit = visit(slot);
                    if limit < 0.0 {
                        return;
                    }
                    farthest = to_single(limit);
                }
            }
            current = loop {
                if waiting == 0 {
                    return;
                }
                waiting -= 1;
                let next = if waiting < STACK { stack[waiting] } else { overflow.pop().unwrap_or_default() };
                if next.entry() <= farthest {
                    break next.child();
                }
            };
        }
    }

    /// Reads a word of what waits, so that it comes from memory while other things are looked at.
    #[inline]
    fn touch(&self, child: Child) {
        if child.is_leaf() {
            std::hint::black_box(self.blocks.get(child.block_index()).map(Block::first_slot));
        } else {
            std::hint::black_box(self.nodes.get(child.0 as usize).map(|node| node.children[0]));
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
