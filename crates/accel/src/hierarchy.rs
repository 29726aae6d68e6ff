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
use crate::hierarchy_processor::Processor;
use crate::hierarchy_triangles::{Triangle, Triangles};
use crate::hierarchy_vectors::Vectors;
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
    triangles: Triangles,
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
    /// The vertices of the scene, in which triangles have their [`Triangle::start`].
    pub(crate) vertices: &'a [DVec3],
}

/// The order in which the boxes of a node are visited.
pub(crate) trait Order {
    /// Adds a box to the last `among`, which belong to the same node.
    fn push(stack: &mut Stack, pending: PendingChild, among: usize);
}

/// The nearest one first, for queries whose limit shrinks with each hit.
#[derive(Clone, Copy)]
pub(crate) struct NearestFirst;

/// Any, for queries that end with a hit: three boxes and more are not sorted.
#[derive(Clone, Copy)]
pub(crate) struct AnyOrder;

impl Order for NearestFirst {
    #[inline(always)]
    fn push(stack: &mut Stack, pending: PendingChild, among: usize) {
        stack.insert(pending, among);
    }
}

impl Order for AnyOrder {
    #[inline(always)]
    fn push(stack: &mut Stack, pending: PendingChild, _among: usize) {
        stack.push(pending);
    }
}

/// An item that a ray may hit.
#[derive(Clone, Copy)]
pub(crate) struct Visited<'h> {
    pub(crate) slot: u32,
    /// The vertices of a triangle, if the hierarchy knows them.
    pub(crate) corners: Option<&'h [DVec3; 3]>,
}

/// Children to visit, the next one last.
pub(crate) struct Stack {
    places: [PendingChild; STACK],
    count: usize,
    /// Children to visit after these.
    below: Vec<PendingChild>,
}

/// Capacity without allocation: more than most hierarchies need, few enough to clear for each ray.
const STACK: usize = 32;

impl Default for Stack {
    #[inline(always)]
    fn default() -> Stack {
        Stack { places: [PendingChild::default(); STACK], count: 0, below: Vec::new() }
    }
}

impl Stack {
    /// Makes room for the children of a node.
    #[inline(always)]
    fn reserve(&mut self) {
        if self.count > STACK - WIDTH {
            self.lower();
        }
    }

    #[cold]
    fn lower(&mut self) {
        self.below.extend(&self.places[..self.count]);
        self.count = 0;
    }

    /// Needs room (see [`Self::reserve`]).
    #[inline(always)]
    fn push(&mut self, pending: PendingChild) {
        self.places[self.count % STACK] = pending;
        self.count += 1;
    }

    /// Pushes a child below those of the last `among` that are nearer.
    #[inline(always)]
    fn insert(&mut self, pending: PendingChild, among: usize) {
        let mut place = self.count;
        let first = place - among;
        while place > first && self.places[(place - 1) % STACK] < pending {
            self.places[place % STACK] = self.places[(place - 1) % STACK];
            place -= 1;
        }
        self.places[place % STACK] = pending;
        self.count += 1;
    }

    /// The last child, whatever its distance.
    #[inline(always)]
    fn last(&mut self) -> Child {
        self.count -= 1;
        self.places[self.count % STACK].child()
    }

    /// The next child that is entered before `farthest`.
    #[inline(always)]
    fn pop(&mut self, farthest: f32) -> Option<Child> {
        while self.count > 0 {
            self.count -= 1;
            let next = self.places[self.count % STACK];
            if next.is_entered_before(farthest) {
                return Some(next.child());
            }
        }
        if self.below.is_empty() { None } else { self.pop_below(farthest) }
    }

    #[cold]
    fn pop_below(&mut self, farthest: f32) -> Option<Child> {
        while let Some(next) = self.below.pop() {
            if next.is_entered_before(farthest) {
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
        triangle_of: impl Fn(usize) -> Option<Triangle>,
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
        let mut hierarchy = Hierarchy {
            nodes,
            blocks: Vec::new(),
            triangles: Triangles::Elsewhere,
            root,
            bounds,
            center,
            radius,
            processor: Processor::default(),
        };
        if leaves != Leaves::Slots {
            hierarchy.pack(leaves, builder, |slot| triangle_of(order[slot as usize] as usize));
        }
        (hierarchy, order, quick_order)
    }

    /// Packs the content of each leaf into a block.
    fn pack(&mut self, leaves: Leaves, builder: Builder, triangle_of: impl Fn(u32) -> Option<Triangle>) {
        let blocks = self.nodes.iter().flat_map(|node| &node.children).filter(|child| child.is_leaf()).count() + 1;
        self.blocks.reserve_exact(blocks);
        self.triangles = Triangles::with_capacity(blocks, leaves, builder);
        let center = self.center;
        let children = self.nodes.iter_mut().flat_map(|node| &mut node.children).chain([&mut self.root]);
        for child in children.filter(|child| child.is_leaf()) {
            let slots = child.slots();
            *child = Child::block(self.blocks.len());
            let mut triangles = [None; MAX_LEAF_ITEMS];
            for (triangle, slot) in triangles.iter_mut().zip(slots.clone()) {
                *triangle = triangle_of(slot);
            }
            self.triangles.push(&triangles);
            let relative = triangles.map(|triangle| Some(triangle?.corners.map(|corner| corner - center)));
            self.blocks.push(Block::new(slots.start, &relative[..slots.len()]));
        }
    }

    /// Memory of nodes and leaves.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.nodes) + size_of_val(&*self.blocks) + self.triangles.bytes()
    }

    /// The bounding box of all items.
    pub(crate) fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Centre and radius of a bounding sphere of all items.
    pub(crate) fn bounding_sphere(&self) -> (DVec3, f64) {
        (self.center, self.radius)
    }

    /// Visits the items that a ray may hit before its limit. `visit` returns the limit from then on;
    /// a negative one ends the query.
    #[inline]
    pub(crate) fn visit<O: Order>(&self, order: O, search: Search<'_>, visit: impl FnMut(Visited<'_>) -> f64) {
        match self.processor {
            Processor::Baseline(baseline) => self.visit_by((baseline, order), search, visit),
            #[cfg(target_arch = "x86_64")]
            Processor::Avx2(avx2) => avx2.run(Visit { hierarchy: self, vectors: avx2, order, search, visit }),
        }
    }

    #[inline(always)]
    fn visit_by<O: Order>(
        &self,
        (vectors, _): (impl Vectors, O),
        search: Search<'_>,
        mut visit: impl FnMut(Visited<'_>) -> f64,
    ) {
        let Search { ray, limit, vertices } = search;
        let (start, skip) = self.start(ray);
        let (start, direction) = (start.as_vec3(), ray.direction.as_vec3());
        let slabs = Slabs::new(start, direction);
        let probe = Probe::new(start, direction, self.radius as f32);
        let mut stack = Stack::default();
        let mut farthest = single_above(limit - skip);
        let mut current = self.root;
        loop {
            if !current.is_leaf() {
                if let Some(nearest) = self.enter::<O>(vectors, current, &slabs, farthest, &mut stack) {
                    current = nearest;
                    continue;
                }
            } else if let Some(block) = self.blocks.get(current.block_index()) {
                let triangles = self.triangles.fetch(current.block_index(), vertices, vectors);
                let mut candidates = vectors.candidates(&probe, block, farthest);
                while candidates != 0 {
                    let lane = candidates.trailing_zeros();
                    let corners = triangles.corners(lane, vertices);
                    let limit = visit(Visited { slot: block.first_slot() + lane, corners });
                    candidates &= candidates - 1;
                    if limit < 0.0 {
                        return;
                    }
                    farthest = single_above(limit - skip);
                }
            } else {
                for slot in current.slots() {
                    let limit = visit(Visited { slot, corners: None });
                    if limit < 0.0 {
                        return;
                    }
                    farthest = single_above(limit - skip);
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
                stack.reserve();
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
    fn enter<O: Order>(
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
        self.prefetch(vectors, far.child());
        stack.reserve();
        stack.push(far);
        if entered.is_empty() {
            return Some(near.child());
        }
        stack.push(near);
        let mut among = 2;
        while let Some(next) = entered.next(node) {
            self.prefetch(vectors, next.child());
            O::push(stack, next, among);
            among += 1;
        }
        Some(stack.last())
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

/// A positive number above a distance in single precision; infinity stays infinity.
#[inline(always)]
fn single_above(distance: f64) -> f32 {
    let single = distance as f32;
    if single > 0.0 { f32::from_bits(single.to_bits() + u32::from(single < f32::INFINITY)) } else { f32::from_bits(1) }
}

/// A query compiled for its own vector instructions.
#[cfg(target_arch = "x86_64")]
struct Visit<'a, V, O, F> {
    hierarchy: &'a Hierarchy,
    vectors: V,
    order: O,
    search: Search<'a>,
    visit: F,
}

#[cfg(target_arch = "x86_64")]
impl<V: Vectors, O: Order, F: FnMut(Visited<'_>) -> f64> pulp::NullaryFnOnce for Visit<'_, V, O, F> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.hierarchy.visit_by((self.vectors, self.order), self.search, self.visit);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pending(index: usize) -> PendingChild {
        PendingChild::new(Child::node(index), index as f32)
    }

    fn popped(mut stack: Stack, farthest: f32) -> Vec<Child> {
        std::iter::from_fn(|| stack.pop(farthest)).collect()
    }

    #[test]
    fn children_of_a_node_are_sorted_nearest_last() {
        let mut stack = Stack::default();
        stack.push(pending(0));
        for (among, index) in [4, 1, 5, 2, 3].into_iter().enumerate() {
            NearestFirst::push(&mut stack, pending(index), among);
        }
        assert_eq!(popped(stack, 4.0), [1, 2, 3, 4, 0].map(Child::node));
    }

    #[test]
    fn more_children_than_have_places_are_visited_in_order() {
        let mut stack = Stack::default();
        for index in (0..500).rev() {
            stack.reserve();
            stack.push(pending(index));
        }
        assert_eq!(popped(stack, 450.0), (0..=450).map(Child::node).collect::<Vec<_>>());
    }
}
