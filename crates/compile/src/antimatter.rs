//! Antimatter: volumes that are subtracted from others.
//!
//! As in Radiance, a ray carries the set of modifiers whose surfaces are subtracted. It adds
//! modifiers to the set where it enters antimatter through its front, and removes them where it
//! leaves. Transmitted rays continue with the new set, reflected rays with the old one. If
//! antimatter names a material that shades the cut, its surface is visible, turned inside out,
//! while the ray is inside a volume that it cuts. The ray decides this by counting the fronts less
//! the backs of the cut surfaces that it has crossed.

use radsight_accel::ShaderId;

/// Parameters of `antimatter`.
#[derive(Clone, Debug)]
pub struct Antimatter {
    /// Shaders of the surfaces that it subtracts from, ascending.
    pub cuts: Vec<ShaderId>,
    /// Shader of the cut's surface; none if it is invisible.
    pub shade: Option<ShaderId>,
}

impl Antimatter {
    /// Antimatter that subtracts from these shaders, and the shader of the cut.
    pub fn new(mut cuts: Vec<ShaderId>, shade: Option<ShaderId>) -> Antimatter {
        cuts.sort_unstable();
        cuts.dedup();
        Antimatter { cuts, shade }
    }
}
