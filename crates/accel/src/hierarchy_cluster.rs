//! Builds a hierarchy bottom up: nearby boxes are merged by parallel locally-ordered clustering
//! (Meister, Bittner, "Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy
//! Construction", IEEE TVCG 24(3), 2018), then nodes are reinserted where the tree gets cheaper
//! (Meister, Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization", Computer
//! Graphics Forum 37(2), 2018). The library `obvhs` does both; this file adds leaves and orders the
//! tree.

use crate::hierarchy_child::{Child, MAX_LEAF_ITEMS};
use crate::hierarchy_part::{Leaves, Part};
use glam::Vec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

/// Search distance for a cluster's best partner along the Morton curve.
const SEARCH: PlocSearchDistance = PlocSearchDistance::Medium;

/// Number of first rounds in which clusters consider adjacent clusters only.
const QUICK_ROUNDS: usize = 2;

/// Fraction of the nodes that the first round of reinsertion moves; later rounds move fewer.
const REINSERTED: f32 = 0.1;

/// The binary tree over items with the bounding boxes `box_of`, and the items by slot.
pub(crate) fn cluster(count: usize, leaves: Leaves, box_of: impl Fn(usize) -> [Vec3; 2]) -> (Vec<Part>, Vec<u32>) {
    let boxes: Vec<Aabb> = (0..count)
        .map(|index| {
            let [low, high] = box_of(index);
            Aabb::new(low.into(), high.into())
        })
        .collect();
    let items = (0..count as u32).collect();
    let mut tree = PlocBuilder::new().build(SEARCH, &boxes, items, SortPrecision::U64, QUICK_ROUNDS);
    drop(boxes);
    ReinsertionOptimizer::default().run(&mut tree, REINSERTED, None);
    let is_leaf = leaf_choices(&tree, leaves);
    parts(&tree, &is_leaf)
}

/// Selects the nodes that become leaves: where testing all items costs no more than opening the
/// node.
fn leaf_choices(tree: &Bvh2, leaves: Leaves) -> Vec<bool> {
    let nodes = &tree.nodes;
    let mut is_leaf = vec![true; nodes.len()];
    let mut counts = vec![1_u8; nodes.len()];
    let mut costs = vec![0.0; nodes.len()];
    for index in parents_first(nodes).into_iter().rev() {
        let node = &nodes[index as usize];
        let (index, area) = (index as usize, node.aabb().half_area());
        if node.is_leaf() {
            costs[index] = leaves.cost(1) * area;
            continue;
        }
        let children = [node.first_index as usize, node.first_index as usize + 1];
        let count = counts[children[0]].saturating_add(counts[children[1]]);
        let opened = leaves.box_cost() * area + costs[children[0]] + costs[children[1]];
        let closed = if usize::from(count) > MAX_LEAF_ITEMS { f32::INFINITY } else { leaves.cost(count.into()) * area };
        is_leaf[index] = closed <= opened;
        counts[index] = count;
        costs[index] = closed.min(opened);
    }
    is_leaf
}

/// All nodes below the root, parents before children.
fn parents_first(nodes: &[Bvh2Node]) -> Vec<u32> {
    let mut order = Vec::with_capacity(nodes.len());
    if !nodes.is_empty() {
        order.push(0);
    }
    let mut next = 0;
    while let Some(index) = order.get(next) {
        let node = &nodes[*index as usize];
        if !node.is_leaf() {
            order.extend([node.first_index, node.first_index + 1]);
        }
        next += 1;
    }
    order
}

/// The tree as parts, parents before children, and the items in the order of its leaves.
fn parts(tree: &Bvh2, is_leaf: &[bool]) -> (Vec<Part>, Vec<u32>) {
    let mut parts: Vec<Part> = Vec::new();
    let mut items = Vec::with_capacity(tree.primitive_indices.len());
    // A node, and the part whose second box it is.
    let mut pending: Vec<(u32, Option<usize>)> = tree.nodes.first().map(|_| (0, None)).into_iter().collect();
    while let Some((index, second_of)) = pending.pop() {
        let node = &tree.nodes[index as usize];
        if let Some(outer) = second_of {
            let parts_on = parts.len() - outer;
            parts[outer].set_right(parts_on);
        }
        let (low, high) = (node.aabb().min.into(), node.aabb().max.into());
        if is_leaf[index as usize] {
            let first = items.len();
            append_items(tree, index, &mut items);
            parts.push(Part::leaf(low, high, Child::leaf(first, items.len() - first)));
        } else {
            pending.push((node.first_index + 1, Some(parts.len())));
            pending.push((node.first_index, None));
            parts.push(Part::branch(low, high));
        }
    }
    (parts, items)
}

/// Appends the items of a small node.
fn append_items(tree: &Bvh2, index: u32, items: &mut Vec<u32>) {
    let node = &tree.nodes[index as usize];
    if node.is_leaf() {
        let first = node.first_index as usize;
        items.extend(&tree.primitive_indices[first..first + node.prim_count as usize]);
    } else {
        append_items(tree, node.first_index, items);
        append_items(tree, node.first_index + 1, items);
    }
}
