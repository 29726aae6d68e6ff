//! Builds the octree of a file, as Radiance's `oconv` does.
//!
//! A cube is subdivided until it has few surfaces or is small. Every surface that touches a cube is
//! listed in it: where a test cannot decide, it assumes so, so that no ray of real Radiance misses
//! a surface. radsight itself traces rays with another acceleration structure; the octree is for
//! files that other programs read.
//!
//! The crate knows the shapes of the scene, but neither its text nor how rays are traced. The
//! result does not depend on the number of threads.
//!
//! ```
//! use radsight_formats::Tree;
//! use radsight_ir::{Cube, Scene, Shape, Sphere, Surface};
//! let mut scene = Scene::default();
//! let sphere = scene.spheres.add(Sphere { center: glam::DVec3::splat(0.9), radius: 0.1, facing: Default::default() });
//! let name = scene.names.add("ball");
//! scene.surfaces.add(Surface { name, span: None, modifier: None, shape: Shape::Sphere(sphere) });
//! let cube = Cube { origin: glam::DVec3::ZERO, size: 1.0 };
//! let built = radsight_octree::build(&scene, &[7], cube, &Default::default());
//! assert_eq!(built.tree, Tree::Full(vec![7]));
//! ```
#![forbid(unsafe_code)]

mod touch;

use glam::DVec3;
use radsight_formats::{MOST_IN_A_CUBE, Tree};
use radsight_ir::{Cube, Scene, Shape};
use rayon::prelude::*;
use touch::{Form, Touch};

/// Radiance treats smaller lengths as zero, scene units.
const TINY: f64 = 1e-6;

/// Number of surfaces above which the halves of a cube are built in parallel.
const MANY: usize = 2000;

/// Depth at which subdivision ends, even if a cube has more surfaces than a file can store.
const DEEPEST: u32 = 26;

/// Resolution of the octree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuildOptions {
    /// Number of surfaces above which a cube is subdivided (`oconv -n`), at least 1. Default: 6.
    pub object_limit: usize,
    /// Edge of the whole cube relative to that of the smallest one (`oconv -r`). Default: 16384.
    pub resolution: u32,
}

impl Default for BuildOptions {
    fn default() -> Self {
        BuildOptions { object_limit: 6, resolution: 16384 }
    }
}

/// A finished octree.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Built {
    /// The octree, with surface numbers in its leaves.
    pub tree: Tree,
    /// Number of surfaces left out of cubes that have more than a file can store.
    pub left_out: usize,
}

/// Builds the octree of all surfaces at a finite distance. `numbers` are the surfaces' numbers in
/// the file, ascending.
#[must_use]
pub fn build(scene: &Scene, numbers: &[u32], cube: Cube, options: &BuildOptions) -> Built {
    let numbered = scene.surfaces.items().iter().zip(numbers);
    let members: Vec<Member<'_>> = numbered
        .filter(|(surface, _)| !matches!(surface.shape, Shape::Source(_)))
        .map(|(surface, number)| {
            let form = Form::of(scene, surface.shape);
            Member { number: *number, bounds: form.bounds(), form }
        })
        .collect();
    let builder = Builder {
        // A cube of a single surface is never divided, as in Radiance: parts of it would have the
        // same number of surfaces down to the resolution.
        object_limit: options.object_limit.max(1),
        smallest: cube.size / f64::from(options.resolution.max(1)) - TINY,
    };
    let all: Vec<&Member<'_>> = members.iter().collect();
    let (tree, left_out) = builder.node(cube, &all, 0);
    Built { tree, left_out }
}

/// A surface with its number and its bounding box.
struct Member<'a> {
    number: u32,
    bounds: [DVec3; 2],
    form: Form<'a>,
}

struct Builder {
    object_limit: usize,
    /// Smallest edge of a subdivided cube.
    smallest: f64,
}

impl Builder {
    /// Octree of a cube for the surfaces that may touch it, and the number of surfaces left out.
    fn node(&self, cube: Cube, candidates: &[&Member<'_>], depth: u32) -> (Tree, usize) {
        let (low, high) = (cube.origin - TINY, cube.origin + cube.size + TINY);
        let mut members = Vec::with_capacity(candidates.len());
        // A volume that fills the whole cube fills all its parts too, so subdivision does not help.
        let mut crossing = 0;
        for member in candidates {
            if member.bounds[0].cmpgt(high).any() || member.bounds[1].cmplt(low).any() {
                continue;
            }
            match member.form.touch(&cube) {
                Touch::Outside => {}
                Touch::Crosses => {
                    crossing += 1;
                    members.push(*member);
                }
                Touch::Fills => members.push(*member),
            }
        }
        let half = 0.5 * cube.size;
        let is_small = half < self.smallest && (members.len() <= MOST_IN_A_CUBE || depth >= DEEPEST);
        if members.is_empty() {
            (Tree::Empty, 0)
        } else if crossing <= self.object_limit && members.len() <= MOST_IN_A_CUBE || is_small || depth >= DEEPEST {
            let left_out = members.len().saturating_sub(MOST_IN_A_CUBE);
            (Tree::Full(members.iter().take(MOST_IN_A_CUBE).map(|member| member.number).collect()), left_out)
        } else {
            self.split(cube, &members, depth)
        }
    }

    fn split(&self, cube: Cube, members: &[&Member<'_>], depth: u32) -> (Tree, usize) {
        let size = 0.5 * cube.size;
        let part = |index: usize| {
            let offset = [1, 2, 4].map(|bit| if index & bit == 0 { 0.0 } else { size });
            let origin = cube.origin + DVec3::from_array(offset);
            self.node(Cube { origin, size }, members, depth + 1)
        };
        let parts: Vec<(Tree, usize)> =
            if members.len() > MANY { (0..8).into_par_iter().map(part).collect() } else { (0..8).map(part).collect() };
        let left_out = parts.iter().map(|(_, left_out)| left_out).sum();
        let mut trees = parts.into_iter().map(|(tree, _)| tree);
        let trees: [Tree; 8] = std::array::from_fn(|_| trees.next().unwrap_or(Tree::Empty));
        // Eight equal leaves are merged.
        let is_leaf = !matches!(trees[0], Tree::Split(_));
        if is_leaf && trees.iter().all(|tree| *tree == trees[0]) {
            let [first, ..] = trees;
            return (first, left_out);
        }
        (Tree::Split(Box::new(trees)), left_out)
    }
}
