//! The rule for coincident surfaces.
//!
//! Radiance treats all hits within 1e-6 scene units of the nearest one as equally near and selects
//! by rule (`rayreject` in `rt/raytrace.c`): a surface with a material before one without, opaque
//! before transparent, the side facing the ray before the other, then the modifier that is defined
//! last. Of two surfaces with the same modifier the last one in the scene wins. A mesh or an
//! instance has already selected among its own surfaces. It replaces a surface after it in the
//! scene only if it is strictly nearer; against a surface before it the rule decides.
//!
//! Traversal only records which hits are equally near; the selection is made here, once per such
//! ray.

use crate::intersection::Crossing;
use crate::ray::Ray;
use radsight_ir::{ModifierHandle, Scene};

/// Maximum distance between hits that count as equally near, scene units: Radiance's `FTINY`.
const TOLERANCE: f64 = 1e-6;

/// Maximum tolerance relative to the scene's largest coordinate, for tiny scenes.
const MAX_RELATIVE_TOLERANCE: f64 = 1e-4;

/// Relative rounding error of distances, with respect to the largest numbers in their computation.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// The tolerance of a scene with the largest absolute coordinate `reach`.
pub(crate) fn tolerance(reach: f64) -> f64 {
    TOLERANCE.min(MAX_RELATIVE_TOLERANCE * reach)
}

/// Rounding error of the difference between equal distances along a ray.
pub(crate) fn rounding(ray: &Ray, distance: f64) -> f64 {
    ROUNDING * (ray.origin.abs().max_element() + distance.abs())
}

/// The class of a material in the rule, the weakest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Substance {
    /// No material.
    Nothing,
    /// Radiance treats the material as transparent.
    Transparent,
    /// All other materials, whether they transmit light or not.
    Opaque,
}

/// The class of the material at the end of a chain of modifiers. Materials belong to the caller:
/// this crate only asks.
pub type SubstanceOf = fn(&Scene, Option<ModifierHandle>) -> Substance;

/// The rank of a surface among equally near ones; the greater one wins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Rank {
    pub(crate) substance: Substance,
    pub(crate) faces_the_ray: bool,
    /// Order of definition of the modifier. Those inside meshes and instances are read after all
    /// others.
    pub(crate) modifier: (u32, usize),
}

/// Records a hit that is nearly as near as the best one.
#[cold]
pub(crate) fn note(ties: &mut Vec<Crossing>, best: Option<Crossing>, hit: Crossing) {
    if ties.is_empty() {
        ties.extend(best);
    }
    ties.push(hit);
}
