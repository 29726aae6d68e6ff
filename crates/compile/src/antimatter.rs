//! Antimatter: volumes that are cut out of others.
//!
//! As in Radiance, a ray carries the set of modifiers whose surfaces are not there for it: entering antimatter (through its front) adds
//! those that it cuts, leaving it takes them out again, and what passes through a surface goes on with the new set, what is reflected
//! with the old one. If antimatter names a material to shade the cut with, its surface is there, turned inside out, where the
//! ray is within one of the bodies that it cuts; the ray knows that by counting the fronts less the backs of their surfaces that it passed.

use radsight_accel::ShaderId;

/// What the `antimatter` material does.
#[derive(Clone, Debug)]
pub struct Antimatter {
    /// Shaders of the surfaces that it cuts, ascending.
    pub cuts: Vec<ShaderId>,
    /// Shades the surface of the cut.
    pub shade: Option<ShaderId>,
}

impl Antimatter {
    /// What cuts these shaders away, and what shades the cut.
    pub fn new(mut cuts: Vec<ShaderId>, shade: Option<ShaderId>) -> Antimatter {
        cuts.sort_unstable();
        cuts.dedup();
        Antimatter { cuts, shade }
    }
}
