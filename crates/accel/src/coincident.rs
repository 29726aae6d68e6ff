//! Surfaces that lie on each other: which of them a ray meets.
//!
//! Radiance takes what a ray hits within 1e-6 scene units of the nearest hit for equally near and decides by rule (`rayreject` in
//! `rt/raytrace.c`): what has a material before what has none, opaque before transparent, the side that faces the ray before the
//! other, then the modifier that is defined last. Of two with one modifier the one that stands last in the scene stays. A mesh or
//! an instance has already chosen among its own surfaces. It takes the place of what stands after it in the scene only where it is
//! really nearer; what stands before it has to win by the rule.
//!
//! The rays' search only notes which hits are equally near; the choice is made here, once per such ray.

use crate::intersection::Crossing;
use crate::ray::Ray;
use radsight_ir::{ModifierHandle, Scene};

/// Hits no farther apart than this are equally near, scene units: Radiance's `FTINY`.
const TOLERANCE: f64 = 1e-6;

/// The tolerance is never more than this share of the scene's largest coordinate, or a tiny scene would be all one surface.
const LARGEST_SHARE: f64 = 1e-4;

/// Rounding of distances, as a share of the largest numbers that they are computed from.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// The tolerance of a scene whose largest coordinate is `reach`.
pub(crate) fn tolerance(reach: f64) -> f64 {
    TOLERANCE.min(LARGEST_SHARE * reach)
}

/// How far rounding takes apart the distances of what is equally near, for a ray that was followed so far.
pub(crate) fn rounding(ray: &Ray, distance: f64) -> f64 {
    ROUNDING * (ray.origin.abs().max_element() + distance.abs())
}

/// What a material is to the rule, the weakest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Substance {
    /// There is no material.
    Nothing,
    /// Radiance calls the material transparent.
    Transparent,
    /// All that Radiance does not call transparent, whether light passes or not.
    Opaque,
}

/// What the material at the end of a chain of modifiers is to the rule. Materials are the caller's: this crate only asks.
pub type SubstanceOf = fn(&Scene, Option<ModifierHandle>) -> Substance;

/// By what a surface wins over another that is as near; the greater one does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Standing {
    pub(crate) substance: Substance,
    pub(crate) faces_the_ray: bool,
    /// How late the modifier is defined. Those within meshes and instances are read after all others.
    pub(crate) modifier: (u32, usize),
}

/// Notes a hit that is about as near as the best one.
#[cold]
pub(crate) fn note(ties: &mut Vec<Crossing>, best: Option<Crossing>, hit: Crossing) {
    if ties.is_empty() {
        ties.extend(best);
    }
    ties.push(hit);
}
