//! The bounding volume hierarchy: eight boxes per node, and four triangles per leaf if it contains
//! triangles.
//!
//! It uses single precision relative to the centre of its content, with boxes padded by more than
//! the rounding error; candidates are tested in double precision. A ray from far outside is first
//! advanced to the bounding sphere.

use crate::bounds::Bounds;
use crate::builder::Builder;
use crate::hierarchy_block::{Block, Probe};
use crate::hierarchy_build::cut;
use crate::hierarchy_child::{Child, MAX_LEAF_ITEMS, PendingChild};
use crate::hierarchy_cluster::cluster;
use crate::hierarchy_collapse::{collapse, cost};
use crate::hierarchy_node::{Node, Slabs, WIDTH};
use crate::hierarchy_part::Leaves;
use crate::hierarchy_vectors::{Processor, Vectors};
use crate::ray::Ray;
use crate::shaft::Shaft;
use glam::DVec3;

/// Padding of boxes relative to the total size: well above the single-precision rounding error of
/// slab tests.
const BOX_PADDING: f64 = 2e-6;

/// In larger scenes the areas of boxes could overflow in single precision, which clustering does
/// not tolerate.
const MAX_CLUSTERED_SIZE: f64 = 1e16;

/// A tree of boxes around items. Items have slots; the slots of a box are contiguous.
#[derive(Debug, Default)]
pub(crate) struct Hierarchy {
    nodes: Vec<Node>,
    /// The leaves, if they contain triangles; otherwise the slots of a leaf are in its [`Child`].
    blocks: Vec<Block>,
    root: Child,
    bounds: Bounds,
    center: DVec3,
    radius: f64,
    processor: Processor,
}

/// The parameters of a query.
#[derive(Clone, Copy)]
pub(crate) struct Search<'a> {
    pub(crate) ray: &'a Ray,
    /// Maximum distance, scene units.
    pub(crate) limit: f64,
    /// The vertices of the triangles by slot, for prefetching; may be empty.
    pub(crate) corners: &'a [[DVec3; 3]],
}

/// Children to visit, the next one last.
struct Stack {
    places: [PendingChild; STACK],
    count: usize,
    overflow: Vec<PendingChild>,
}

/// Capacity without allocation. Only hierarchies deeper than a third of this can need more.
const STACK: usize = 48;

impl Default for Stack {
    #[inline(always)]
    fn default() -> Stack {
        Stack { places: [PendingChild::default(); STACK], count: 0, overflow: Vec::new() }
    }
}

impl Stack {
    #[inline(always)]
    fn push(&mut self, pending: PendingChild) {
        match self.places.get_mut(self.count) {
            Some(place) => *place = pending,
            None => self.overflow.push(pending),
        }
        self.count += 1;
    }

    /// The next child that is entered before `farthest`.
    #[inline(always)]
    fn pop(&mut self, farthest: f32) -> Option<Child> {
        while self.count > 0 {
            self.count -= 1;
            let next = match self.places.get(self.count) {
                Some(place) => *place,
                None => self.overflow.pop().unwrap_or_default(),
            };
            if next.entry() <= farthest {
                return Some(next.child());
            }
        }
        None
    }
}

impl Hierarchy {
    /// Builds the hierarchy of items numbered from 0, some of which may be triangles. Also returns
    /// the item of each slot, and the quick builder's order of items if it differs.
    pub(crate) fn build(
        count: usize,
        bounds_of: impl Fn(usize) -> Bounds + Sync,
        triangle_of: impl Fn(usize) -> Option<[DVec3; 3]>,
        builder: Builder,
    ) -> (Hierarchy, Vec<u32>, Option<Vec<u32>>) {
        let all = (0..count).map(&bounds_of);
        let bounds = all.reduce(Bounds::union).unwrap_or(Bounds::point(DVec3::ZERO));
        let center = (bounds.min + bounds.max) * 0.5;
        let radius = 0.5 * (bounds.max - bounds.min).length();
        let padding = DVec3::splat(BOX_PADDING * radius);
        let triangles = (0..count).filter(|item| triangle_of(*item).is_some()).count();
        let leaves = Leaves::of(triangles, count);
        let box_of = |item: usize| {
            let Bounds { min, max } = bounds_of(item);
            [(min - center - padding).as_vec3(), (max - center + padding).as_vec3()]
        };
        let (mut parts, mut order) = cut(count, leaves, box_of);
        let mut quick_order = None;
        if builder == Builder::Thorough && radius < MAX_CLUSTERED_SIZE {
            let clustered = cluster(count, leaves, box_of);
            if cost(&clustered.0, leaves) < cost(&parts, leaves) {
                quick_order = Some(order);
                (parts, order) = clustered;
            }
        }
        let (nodes, root) = collapse(&parts, leaves);
        drop(parts);
        let mut hierarchy =
            Hierarchy { nodes, blocks: Vec::new(), root, bounds, center, radius, processor: Processor::default() };
        if leaves != Leaves::Slots {
            hierarchy.pack(|slot| {
                let triangle = triangle_of(order[slot as usize] as usize)?;
                Some(triangle.map(|corner| corner - center))
            });
        }
        (hierarchy, order, quick_order)
    }

    /// Packs the content of each leaf into a block.
    fn pack(&mut self, triangle_of: impl Fn(u32) -> Option<[DVec3; 3]>) {
        let leaves = self.nodes.iter().flat_map(|node| &node.children).filter(|child| child.is_leaf()).count() + 1;
        self.blocks.reserve_exact(leaves);
        let children = self.nodes.iter_mut().flat_map(|node| &mut node.children).chain([&mut self.root]);
        for child in children.filter(|child| child.is_leaf()) {
            let slots = child.slots();
            *child = Child::block(self.blocks.len());
            self.blocks.push(Block::new(slots.start, slots.len() as u32, &triangle_of));
        }
    }

    /// Memory of nodes and leaves.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.nodes) + size_of_val(&*self.blocks)
    }

    /// The bounding box of all items.
    pub(crate) fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Centre and radius of a bounding sphere of all items.
    pub(crate) fn bounding_sphere(&self) -> (DVec3, f64) {
        (self.center, self.radius)
    }

    /// Visits the slots of items that a ray may hit before its limit, the nearest boxes first.
    /// `visit` returns the limit from then on; a negative one ends the query.
    #[inline]
    pub(crate) fn visit(&self, search: Search<'_>, visit: impl FnMut(u32) -> f64) {
        match self.processor {
            Processor::Baseline(baseline) => self.visit_by(baseline, search, visit),
            #[cfg(target_arch = "x86_64")]
            Processor::Avx2(avx2) => avx2.run(Visit { hierarchy: self, vectors: avx2, search, visit }),
        }
    }

    #[inline(always)]
    fn visit_by(&self, vectors: impl Vectors, search: Search<'_>, mut visit: impl FnMut(u32) -> f64) {
        let Search { ray, limit, corners } = search;
        let (start, skip) = self.start(ray);
        let to_single = |distance: f64| ((distance - skip).max(0.0) as f32).next_up();
        let (start, direction) = (start.as_vec3(), ray.direction.as_vec3());
        let slabs = Slabs::new(start, direction);
        let probe = Probe::new(start, direction, self.radius as f32);
        let mut stack = Stack::default();
        let mut farthest = to_single(limit);
        let mut current = self.root;
        loop {
            if !current.is_leaf() {
                if let Some(nearest) = self.enter(vectors, current, &slabs, farthest, &mut stack) {
                    current = nearest;
                    continue;
                }
            } else if let Some(block) = self.blocks.get(current.block_index()) {
                if let Some(four) =
                    corners.get(block.first_slot() as usize..).and_then(|rest| rest.first_chunk::<MAX_LEAF_ITEMS>())
                {
                    vectors.prefetch(four);
                }
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
            let Some(next) = stack.pop(farthest) else { return };
            current = next;
        }
    }

    /// Visits the slots of items whose boxes overlap a shaft, until `visit` returns true; returns
    /// whether it did.
    pub(crate) fn any_in(&self, shaft: &Shaft, mut visit: impl FnMut(u32) -> bool) -> bool {
        let sides = shaft.about(self.center);
        let mut stack = Stack::default();
        let mut current = self.root;
        loop {
            if current.is_leaf() {
                let slots = match self.blocks.get(current.block_index()) {
                    Some(block) => block.slots(),
                    None => current.slots(),
                };
                if slots.into_iter().any(&mut visit) {
                    return true;
                }
            } else if let Some(node) = self.nodes.get(current.0 as usize) {
                for child in node.reaching_into(&sides) {
                    stack.push(PendingChild::new(child, 0.0));
                }
            }
            let Some(next) = stack.pop(0.0) else { return false };
            current = next;
        }
    }

    /// The nearest child of a node that a ray enters; the others are pushed on the stack.
    #[inline(always)]
    fn enter(
        &self,
        vectors: impl Vectors,
        node: Child,
        slabs: &Slabs,
        farthest: f32,
        stack: &mut Stack,
    ) -> Option<Child> {
        let node = self.nodes.get(node.0 as usize)?;
        let mut entered = vectors.enter(slabs, node, farthest);
        let first = entered.next(node)?;
        let Some(second) = entered.next(node) else { return Some(first.child()) };
        let (near, far) = if second < first { (second, first) } else { (first, second) };
        if entered.is_empty() {
            self.prefetch(vectors, far.child());
            stack.push(far);
            return Some(near.child());
        }
        let mut places = [PendingChild::default(); WIDTH];
        let (nearest, others) = entered.sorted(node, [far, near], &mut places).split_last()?;
        for other in others {
            self.prefetch(vectors, other.child());
            stack.push(*other);
        }
        Some(nearest.child())
    }

    /// Prefetches pending children.
    #[inline(always)]
    fn prefetch(&self, vectors: impl Vectors, child: Child) {
        if !child.is_leaf() {
            if let Some(node) = self.nodes.get(child.0 as usize) {
                vectors.prefetch(node);
            }
        } else if let Some(block) = self.blocks.get(child.block_index()) {
            vectors.prefetch(block);
        }
    }

    /// The ray's origin relative to the centre, and the distance by which it was advanced. Single
    /// precision is for nearby points, so an origin outside twice the bounding sphere is advanced
    /// to it.
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

/// A query compiled for its own vector instructions.
#[cfg(target_arch = "x86_64")]
struct Visit<'a, V, F> {
    hierarchy: &'a Hierarchy,
    vectors: V,
    search: Search<'a>,
    visit: F,
}

#[cfg(target_arch = "x86_64")]
impl<V: Vectors, F: FnMut(u32) -> f64> pulp::NullaryFnOnce for Visit<'_, V, F> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.hierarchy.visit_by(self.vectors, self.search, self.visit);
    }
}
