//! Guided sampling of diffuse surroundings: where rays find much light, more of them are sent.
//!
//! Rays that are drawn by the cosine find a patch of sun on a floor, or the spot under a lamp, by chance only. What they miss is noise that
//! does not even show in its own estimate. Before a picture some random paths look for such patches ([`patches`]), and then for how much each region
//! of the scene gets from each of them and from each portal ([`regions`]). Single rays are drawn from the mixture that was learned: some by the
//! cosine, the others towards patches and portals. The density of the whole mixture counts, so the mean is the same whatever was learned.
//!
//! Vorba, Karlík, Šik, Ritschel and Křivánek, SIGGRAPH 2014; Müller, Gross and Novák, EGSR 2017. Here the directions' components are given by what
//! shines, not by the sphere of directions: their sharpness costs nothing, and does not have to be learned for each place.
//!
//! Guarantees: a function of the plan and the rays that are asked for, whatever the threads. Nothing is learned where rays find
//! hardly more than the mean.

pub(crate) mod patches;
pub(crate) mod regions;

use glam::DVec3;
use radsight_compile::{Portals, VisiblePortals};
use regions::Regions;

/// Where to send rays from a point.
#[derive(Debug)]
pub(crate) struct PathGuide {
    pub(crate) portals: Portals,
    pub(crate) regions: Regions,
}

impl PathGuide {
    /// What a point with this unit normal sees of patches and portals.
    pub(crate) fn seen_from(&self, point: DVec3, normal: DVec3) -> Option<VisiblePortals<'_>> {
        let region = self.regions.region(self.regions.find(point, normal));
        self.portals.seen_by(point, normal, &region.factors, region.chance)
    }

    /// Patches and portals.
    pub(crate) fn len(&self) -> usize {
        self.portals.len()
    }
}
