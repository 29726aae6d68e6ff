//! Builds the octree of a file, as Radiance's `oconv` does.
//!
//! A cube is subdivided until it has few surfaces or is small, or the work for the whole octree
//! exceeds a limit, as for surfaces that coincide. Every surface that touches a cube is
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

mod builder;
mod touch;

use builder::{Builder, Member};
use radsight_formats::{MOST_IN_A_CUBE, Tree};
use radsight_ir::{Cube, Scene, Shape};
use touch::Form;

/// Radiance treats smaller lengths as zero, scene units.
const TINY: f64 = 1e-6;

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
    /// Number of surfaces that are missing from a cube, since more touch it than a file can store.
    pub left_out: usize,
}

impl Built {
    /// The warning that surfaces are missing, if any are; `surfaces` is what they are called.
    #[must_use]
    pub fn warning(&self, surfaces: &str) -> Option<String> {
        let left_out = self.left_out;
        (left_out > 0)
            .then(|| format!("{left_out} {surfaces} are missing from cubes that more than {MOST_IN_A_CUBE} touch"))
    }
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
    Builder::new(&members, cube, options).build(cube)
}
