//! Collapses a binary tree to nodes of eight boxes with minimum total cost (Ylitie, Karras, Laine,
//! "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", High-Performance
//! Graphics 2017, section 3.4).

use crate::hierarchy_child::Child;
use crate::hierarchy_node::{Node, WIDTH};
use crate::hierarchy_part::{Leaves, Part};
use glam::Vec3;

/// Cost of entering a node, in leaf tests.
const NODE_COST: f32 = 1.2;

/// Minimum cost of the content of a part within at most 1, 2, … boxes of a node.
type Costs = [f32; WIDTH - 1];

/// Makes the nodes; the children of a node are contiguous.
pub(crate) fn collapse(parts: &[Part], leaves: Leaves) -> (Vec<Node>, Child) {
    let Some(first) = parts.first() else { return (Vec::new(), Child::node(0)) };
    if first.right == 0 {
        return (Vec::new(), first.leaf);
    }
    let tree = Tree { parts, costs: costs(parts, leaves) };
    let mut nodes = vec![Node::EMPTY];
    let mut pending = vec![(0, 0)];
    while let Some((part, node)) = pending.pop() {
        let mut inner = Vec::with_capacity(WIDTH);
        tree.spread(part, WIDTH, &mut inner);
        let mut boxes = [[Vec3::ZERO; 2]; WIDTH];
        let mut children = [Child::NONE; WIDTH];
        let first_pending = pending.len();
        for ((index, place), child) in inner.iter().zip(&mut boxes).zip(&mut children) {
            let part = &parts[*index];
            *place = [part.low, part.high];
            *child = part.leaf;
            if part.right != 0 {
                *child = Child::node(nodes.len());
                pending.push((*index, nodes.len()));
                nodes.push(Node::EMPTY);
            }
        }
        pending[first_pending..].reverse();
        nodes[node] = Node::around(&boxes[..inner.len()], children);
    }
    // A new allocation of the right size: one that grew may have lost its huge pages when it was
    // moved.
    (nodes.as_slice().to_vec(), Child::node(0))
}

/// Expected cost of a binary tree after [`collapse`], in leaf tests times area.
pub(crate) fn cost(parts: &[Part], leaves: Leaves) -> f32 {
    costs(parts, leaves).first().map_or(0.0, |within| within[0])
}

struct Tree<'p> {
    parts: &'p [Part],
    costs: Vec<Costs>,
}

impl Tree<'_> {
    /// Appends the boxes of a node: the content of a part, in at most `most` boxes.
    fn spread(&self, part: usize, most: usize, boxes: &mut Vec<usize>) {
        let right = part + self.parts[part].right as usize;
        let (_, in_left) = least(&self.costs[part + 1], &self.costs[right], most);
        for (part, most) in [(part + 1, in_left), (right, most - in_left)] {
            let costs = &self.costs[part];
            let used = costs[..most].iter().position(|cost| *cost <= costs[most - 1]).unwrap_or(0) + 1;
            if used == 1 { boxes.push(part) } else { self.spread(part, used, boxes) }
        }
    }
}

/// The minimum cost of two parts within at most `most` boxes, and how many of these belong to the
/// first.
#[inline]
fn least(left: &Costs, right: &Costs, most: usize) -> (f32, usize) {
    let cost = |in_left: usize| left[in_left - 1] + right[most - in_left - 1];
    let choices = (1..most).map(|in_left| (cost(in_left), in_left));
    choices.fold((f32::INFINITY, 1), |best, choice| if choice.0 < best.0 { choice } else { best })
}

fn costs(parts: &[Part], leaves: Leaves) -> Vec<Costs> {
    let mut costs = vec![[0.0; WIDTH - 1]; parts.len()];
    for (index, part) in parts.iter().enumerate().rev() {
        let area = part.half_area();
        if part.right == 0 {
            costs[index] = [leaves.cost(part.leaf.slots().len() as u32) * area; WIDTH - 1];
            continue;
        }
        let (left, right) = (costs[index + 1], costs[index + part.right as usize]);
        let mut own = [least(&left, &right, WIDTH).0 + NODE_COST * area; WIDTH - 1];
        for most in 2..WIDTH {
            own[most - 1] = own[most - 2].min(least(&left, &right, most).0);
        }
        costs[index] = own;
    }
    costs
}
