//! Path guiding for diffuse interreflection: more rays are directed to where much light is found.
//!
//! Cosine-distributed rays hit a patch of sun on a floor, or the spot under a lamp, by chance only;
//! the noise of missed light does not even show in its own estimate. Before a picture some random
//! paths find such patches ([`patches`]), and then the contribution of each patch and each portal
//! to each region of the scene ([`regions`]). Paths sample the learned mixture: some directions by
//! the cosine, the others towards patches and portals. The pdf is that of the whole mixture, so the
//! estimate is unbiased whatever was learned.
//!
//! Vorba, Karlík, Šik, Ritschel and Křivánek, SIGGRAPH 2014; Müller, Gross and Novák, EGSR 2017.
//! Here the components of the mixture are emitters, not cells of the sphere of directions: their
//! resolution costs nothing, and need not be learned for each region.
//!
//! Guarantees: a function of the plan and the requested rays, whatever the threads. Nothing is
//! learned where rays find hardly more than the mean.

pub(crate) mod patches;
pub(crate) mod regions;

use glam::DVec3;
use radsight_compile::{Portals, VisiblePortals};
use regions::Regions;

/// The guide of a scene.
#[derive(Debug)]
pub(crate) struct PathGuide {
    pub(crate) portals: Portals,
    pub(crate) regions: Regions,
}

impl PathGuide {
    /// The patches and portals that a point with this unit normal sees.
    pub(crate) fn seen_from(&self, point: DVec3, normal: DVec3) -> Option<VisiblePortals<'_>> {
        let region = self.regions.region(self.regions.find(point, normal));
        self.portals.seen_by(point, normal, &region.factors, region.chance)
    }

    /// Number of patches and portals.
    pub(crate) fn len(&self) -> usize {
        self.portals.len()
    }
}
