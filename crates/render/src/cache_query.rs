//! What rays ask of cached irradiance, and the points from which it is gathered.

use crate::guiding::GuidingRecords;
use crate::ray_spacing::RaySpacing;
use crate::subtraction::Subtraction;
use glam::DVec3;
use radsight_accel::PrimitiveId;
use radsight_compile::Medium;
use radsight_irradiance_cache::{Cache, Hemisphere};
use radsight_sampling::RaySampler;

/// Irradiance that is shared where no diffuse bounce lies behind, and where one does.
pub(crate) type Caches<'c, const BANDS: usize> = [Option<&'c Cache<BANDS>>; 2];

/// A point whose irradiance is wanted.
#[derive(Clone, Debug)]
pub(crate) struct CachePoint<const BANDS: usize> {
    pub(crate) point: DVec3,
    /// Unit geometric normal on the side in question.
    pub(crate) normal: DVec3,
    pub(crate) primitive: Option<PrimitiveId>,
    pub(crate) medium: Medium<BANDS>,
    /// What is cut away for the rays from here.
    pub(crate) cut: Subtraction,
    /// Interreflections that the rays from here may follow.
    pub(crate) bounces: u32,
    /// How wide the ray is that found it, scene units: details below that are not seen.
    pub(crate) width: f64,
}

impl<const BANDS: usize> CachePoint<BANDS> {
    /// Whether the irradiance here can be interpolated by now.
    pub(crate) fn is_covered(&self, cache: &Cache<BANDS>) -> bool {
        cache.reaches(self.point, self.normal)
    }

    /// Which look is the next one from here.
    pub(crate) fn next_gather(&self, cache: &Cache<BANDS>) -> usize {
        cache.next_gather(self.point, self.normal)
    }
}

/// What a ray asks of the irradiance cache.
#[derive(Clone, Debug)]
pub(crate) enum CacheQuery<const BANDS: usize> {
    /// Places whose irradiance is missing, and how wide the ray is that finds them.
    Missing(Vec<CachePoint<BANDS>>, RaySpacing),
    /// The records that give it where it is not, with their shares in it.
    Served(Vec<(u32, f64)>),
}

impl<const BANDS: usize> CacheQuery<BANDS> {
    pub(crate) fn missing(self) -> Vec<CachePoint<BANDS>> {
        if let CacheQuery::Missing(places, _) = self { places } else { Vec::new() }
    }

    pub(crate) fn served(self) -> Vec<(u32, f64)> {
        if let CacheQuery::Served(served) = self { served } else { Vec::new() }
    }

    pub(crate) fn note(&mut self, place: CachePoint<BANDS>, cache: &Cache<BANDS>, travelled: f64) {
        match self {
            CacheQuery::Missing(places, spread) => {
                if !place.is_covered(cache) {
                    places.push(CachePoint { width: spread.at(travelled), ..place });
                }
            }
            CacheQuery::Served(served) => cache.shares(place.point, place.normal, served),
        }
    }
}

/// How to sample the hemisphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HemisphereGather<'h> {
    pub(crate) hemisphere: &'h Hemisphere,
    /// The sample of each cell to look through, by the number of the look ([`Cache::next_gather`]); any place of it without one.
    pub(crate) sample: Option<usize>,
    /// Tells the rays from those of other looks.
    pub(crate) number: u64,
    /// Where light is expected, if that is known.
    pub(crate) bright: Option<&'h GuidingRecords>,
}

/// A ray that looks through a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GatherDirection {
    /// Unit, in the frame of the place, and in the scene.
    pub(crate) local: DVec3,
    pub(crate) direction: DVec3,
    pub(crate) sampler: RaySampler,
}
