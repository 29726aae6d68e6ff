//! Subdivision of the cube of a scene.

use crate::touch::{Form, Touch};
use crate::{BuildOptions, Built, TINY};
use glam::DVec3;
use radsight_formats::{MOST_IN_A_CUBE, Tree};
use radsight_ir::Cube;
use rayon::prelude::*;

/// Work of a level above which its cubes are divided in parallel, tests of a surface and a cube.
const MANY: usize = 16_000;

/// Depth at which subdivision ends, even if a cube has more surfaces than a file can store.
const DEEPEST: usize = 26;

/// Work of an octree above which it is not divided everywhere, tests.
const LEAST_BUDGET: usize = 10_000_000;

/// The same for each surface of a large scene, tests. Offices and city models take 10 to 900.
const BUDGET_PER_SURFACE: usize = 1000;

/// A surface with its number and its bounding box.
pub(crate) struct Member<'a> {
    pub(crate) number: u32,
    pub(crate) bounds: [DVec3; 2],
    pub(crate) form: Form<'a>,
}

/// A cube and the indices of the members that touch it.
struct Node {
    cube: Cube,
    members: Box<[u32]>,
    /// Number of the members whose surface crosses the cube.
    crossing: usize,
    /// Tests that the members take for one cube.
    cost: usize,
    /// Whether all members of the cube around it touch this one too.
    keeps_all: bool,
}

impl Node {
    /// Whether a file can store the members.
    fn has_room(&self) -> bool {
        self.members.len() <= MOST_IN_A_CUBE
    }
}

/// A node whose subdivision is decided.
enum Settled {
    Leaf(Box<[u32]>),
    /// Its parts are the next eight nodes of the level below.
    Split,
}

/// Divides the cubes of one level after the other.
///
/// Few surfaces that overlap on an area touch so many small cubes that no machine has room for
/// them. The work is therefore limited. Over the budget, a cube stays whole if it keeps all
/// surfaces of the cube around it; over twice the budget, if a file can store its surfaces; over
/// three times the budget, always.
pub(crate) struct Builder<'a> {
    members: &'a [Member<'a>],
    object_limit: usize,
    /// Smallest edge of a subdivided cube.
    smallest: f64,
    /// Tests of a surface and a cube.
    budget: usize,
}

impl<'a> Builder<'a> {
    pub(crate) fn new(members: &'a [Member<'a>], cube: Cube, options: &BuildOptions) -> Self {
        Builder {
            members,
            // A cube of a single surface is never divided, as in Radiance: parts of it would have
            // the same number of surfaces down to the resolution.
            object_limit: options.object_limit.max(1),
            smallest: cube.size / f64::from(options.resolution.max(1)) - TINY,
            budget: LEAST_BUDGET.max(BUDGET_PER_SURFACE.saturating_mul(members.len())),
        }
    }

    pub(crate) fn build(&self, cube: Cube) -> Built {
        let all: Vec<u32> = (0..self.members.len() as u32).collect();
        let mut levels: Vec<Vec<Settled>> = Vec::new();
        let mut nodes = vec![self.node(cube, &all, &mut Vec::new())];
        let mut spent = 0;
        while !nodes.is_empty() {
            let (is_divided, work) = self.choose(&nodes, levels.len(), spent);
            spent += work;
            let chosen = nodes.iter().zip(&is_divided).filter(|(_, is_divided)| **is_divided);
            let chosen: Vec<&Node> = chosen.map(|(node, _)| node).collect();
            let parts: Vec<[Node; 8]> = if work > MANY {
                chosen.par_iter().map(|node| self.parts(node)).collect()
            } else {
                chosen.iter().map(|node| self.parts(node)).collect()
            };
            let settle = |(node, is_divided): (Node, bool)| {
                if is_divided { Settled::Split } else { Settled::Leaf(node.members) }
            };
            levels.push(nodes.into_iter().zip(is_divided).map(settle).collect());
            nodes = parts.into_iter().flatten().collect();
        }
        self.join(levels)
    }

    /// Whether the nodes of a level are divided, and the tests that this takes.
    fn choose(&self, nodes: &[Node], depth: usize, spent: usize) -> (Vec<bool>, usize) {
        let mut is_divided: Vec<bool> = nodes.iter().map(|node| self.needs_division(node, depth)).collect();
        let stays_whole: [fn(&Node) -> bool; 3] = [|node| node.has_room() && node.keeps_all, Node::has_room, |_| true];
        let mut work = work_of(nodes, &is_divided);
        for (budgets, stays_whole) in (1..).zip(stays_whole) {
            if spent + work <= budgets * self.budget {
                break;
            }
            for (is_divided, node) in is_divided.iter_mut().zip(nodes) {
                *is_divided &= !stays_whole(node);
            }
            work = work_of(nodes, &is_divided);
        }
        (is_divided, work)
    }

    /// The part of the members of a larger cube that touches this one.
    fn node(&self, cube: Cube, candidates: &[u32], members: &mut Vec<u32>) -> Node {
        let (low, high) = (cube.origin - TINY, cube.origin + cube.size + TINY);
        members.clear();
        // A volume that fills the whole cube fills all its parts too, so subdivision does not help.
        let mut crossing = 0;
        let mut cost = 0;
        for index in candidates {
            let member = &self.members[*index as usize];
            if member.bounds[0].cmpgt(high).any() || member.bounds[1].cmplt(low).any() {
                continue;
            }
            let touch = member.form.touch(&cube);
            if touch == Touch::Crosses {
                crossing += 1;
            }
            if touch != Touch::Outside {
                members.push(*index);
                cost += member.form.cost();
            }
        }
        let keeps_all = members.len() == candidates.len();
        Node { cube, members: members.as_slice().into(), crossing, cost, keeps_all }
    }

    fn parts(&self, node: &Node) -> [Node; 8] {
        let size = 0.5 * node.cube.size;
        let mut members = Vec::with_capacity(node.members.len());
        std::array::from_fn(|index| {
            let offset = [1, 2, 4].map(|bit| if index & bit == 0 { 0.0 } else { size });
            self.node(Cube { origin: node.cube.origin + DVec3::from_array(offset), size }, &node.members, &mut members)
        })
    }

    fn needs_division(&self, node: &Node, depth: usize) -> bool {
        let half = 0.5 * node.cube.size;
        // Parts of the size of the tolerance hold whatever is near them.
        let can_divide = depth < DEEPEST && half > TINY;
        let is_done = node.has_room() && (node.crossing <= self.object_limit || half < self.smallest);
        can_divide && !is_done
    }

    /// The tree of all levels. Eight equal leaves are merged.
    fn join(&self, levels: Vec<Vec<Settled>>) -> Built {
        let mut is_left_out = vec![false; self.members.len()];
        let mut trees = Vec::new();
        for level in levels.into_iter().rev() {
            let mut below = std::mem::take(&mut trees).into_iter();
            for node in level {
                trees.push(match node {
                    Settled::Leaf(members) if members.is_empty() => Tree::Empty,
                    Settled::Leaf(members) => {
                        let left_out = members.iter().skip(MOST_IN_A_CUBE);
                        left_out.for_each(|index| is_left_out[*index as usize] = true);
                        let kept = members.iter().take(MOST_IN_A_CUBE);
                        Tree::Full(kept.map(|index| self.members[*index as usize].number).collect())
                    }
                    Settled::Split => merge(std::array::from_fn(|_| below.next().unwrap_or(Tree::Empty))),
                });
            }
        }
        Built {
            tree: trees.pop().unwrap_or(Tree::Empty),
            left_out: is_left_out.iter().filter(|is_left_out| **is_left_out).count(),
        }
    }
}

/// Tests that the subdivision of some nodes takes.
fn work_of(nodes: &[Node], is_divided: &[bool]) -> usize {
    let divided = nodes.iter().zip(is_divided).filter(|(_, is_divided)| **is_divided);
    divided.map(|(node, _)| 8 * node.cost).sum()
}

fn merge(parts: [Tree; 8]) -> Tree {
    let is_leaf = !matches!(parts[0], Tree::Split(_));
    if is_leaf && parts.iter().all(|tree| *tree == parts[0]) {
        let [first, ..] = parts;
        return first;
    }
    Tree::Split(Box::new(parts))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CUBE: Cube = Cube { origin: DVec3::ZERO, size: 1.0 };

    fn polygons(vertices: &[Vec<DVec3>]) -> Vec<Member<'_>> {
        let member = |number, vertices| {
            let form = Form::Polygon(vertices);
            Member { number, bounds: form.bounds(), form }
        };
        vertices.iter().zip(0..).map(|(vertices, number)| member(number, vertices)).collect()
    }

    /// Numbers in the leaf that holds a point.
    fn at(tree: &Tree, point: DVec3) -> &[u32] {
        match tree {
            Tree::Empty => &[],
            Tree::Full(numbers) => numbers,
            Tree::Split(parts) => {
                let is_upper = point.cmpge(DVec3::splat(0.5));
                let part = [0, 1, 2].map(|axis| usize::from(is_upper.test(axis)) << axis).iter().sum::<usize>();
                at(&parts[part], 2.0 * point - DVec3::select(is_upper, DVec3::ONE, DVec3::ZERO))
            }
        }
    }

    fn leaves(tree: &Tree) -> usize {
        match tree {
            Tree::Split(parts) => parts.iter().map(leaves).sum(),
            _ => 1,
        }
    }

    fn triangle(corners: [[f64; 3]; 3]) -> Vec<DVec3> {
        corners.map(DVec3::from_array).to_vec()
    }

    #[test]
    fn coincident_surfaces_end_within_the_budget_and_none_is_missing() {
        let sheet = vec![triangle([[0.1, 0.1, 0.3], [0.9, 0.1, 0.35], [0.2, 0.8, 0.4]]); 9];
        let members = polygons(&sheet);
        let builder = Builder { budget: 100_000, ..Builder::new(&members, CUBE, &BuildOptions::default()) };
        let built = builder.build(CUBE);
        assert_eq!(built.left_out, 0);
        let leaves = leaves(&built.tree);
        assert!((100..30_000).contains(&leaves), "{leaves} leaves");
        let inside = (sheet[0][0] + sheet[0][1] + sheet[0][2]) / 3.0;
        assert_eq!(at(&built.tree, inside), [0, 1, 2, 3, 4, 5, 6, 7, 8]);
    }

    #[test]
    fn over_the_budget_surfaces_apart_from_coincident_ones_are_still_separated() {
        let mut surfaces = vec![triangle([[0.55, 0.55, 0.6], [0.95, 0.55, 0.6], [0.55, 0.95, 0.6]]); 40];
        let small = |index: u32| {
            let corner = DVec3::new(f64::from(index % 8), f64::from(index / 8 % 8), f64::from(index / 64));
            [DVec3::ZERO, DVec3::X, DVec3::Y].map(|offset| 0.01 + 0.06 * corner + 0.02 * offset).to_vec()
        };
        surfaces.extend((0..512).map(small));
        let members = polygons(&surfaces);
        let builder = Builder { budget: 60_000, ..Builder::new(&members, CUBE, &BuildOptions::default()) };
        let built = builder.build(CUBE);
        for index in 0..512 {
            let [a, b, c] = small(index)[..] else { unreachable!("a triangle") };
            let found = at(&built.tree, (a + b + c) / 3.0);
            assert!(found.contains(&(40 + index)) && found.len() <= 6, "{index}: {found:?}");
        }
    }

    #[test]
    fn more_surfaces_than_a_file_can_store_are_counted_once() {
        let stack = vec![triangle([[0.1, 0.1, 0.3], [0.9, 0.1, 0.35], [0.2, 0.8, 0.4]]); MOST_IN_A_CUBE + 5];
        let members = polygons(&stack);
        let builder = Builder { budget: 50_000, ..Builder::new(&members, CUBE, &BuildOptions::default()) };
        let built = builder.build(CUBE);
        assert_eq!(built.left_out, 5);
        assert_eq!(at(&built.tree, DVec3::new(0.3, 0.3, 0.325)).len(), MOST_IN_A_CUBE);
    }

    #[test]
    fn around_a_point_where_many_surfaces_meet_cubes_hold_few() {
        let count = 2 * MOST_IN_A_CUBE;
        let rim = |index: usize| {
            let (sin, cos) = (std::f64::consts::TAU * index as f64 / count as f64).sin_cos();
            DVec3::new(0.5 + 0.4 * cos, 0.5 + 0.4 * sin, 0.2)
        };
        let apex = DVec3::new(0.51, 0.52, 0.83);
        let fan: Vec<Vec<DVec3>> = (0..count).map(|index| vec![apex, rim(index), rim(index + 1)]).collect();
        let members = polygons(&fan);
        let built = Builder::new(&members, CUBE, &BuildOptions::default()).build(CUBE);
        assert!(built.left_out >= MOST_IN_A_CUBE, "all but so many are missing at the apex");
        for (number, vertices) in (0..).zip(&fan) {
            for share in [0.01, 0.1, 0.7] {
                let point = apex.lerp(0.5 * (vertices[1] + vertices[2]), share);
                let found = at(&built.tree, point);
                assert!(found.contains(&number), "{number} at {point}");
            }
        }
    }
}
