//! Queries of cached irradiance, and cache points.

use crate::guiding::GuidingRecords;
use crate::ray_spacing::RaySpacing;
use crate::subtraction::Subtraction;
use glam::DVec3;
use radsight_accel::PrimitiveId;
use radsight_compile::Medium;
use radsight_irradiance_cache::{Cache, Hemisphere};
use radsight_sampling::RaySampler;

/// The caches for points before and after the first diffuse bounce.
pub(crate) type Caches<'c, const BANDS: usize> = [Option<&'c Cache<BANDS>>; 2];

/// A point whose irradiance is requested.
#[derive(Clone, Debug)]
pub(crate) struct CachePoint<const BANDS: usize> {
    pub(crate) point: DVec3,
    /// Unit geometric normal on the side of the request.
    pub(crate) normal: DVec3,
    pub(crate) primitive: Option<PrimitiveId>,
    pub(crate) medium: Medium<BANDS>,
    /// The antimatter subtraction for rays from here.
    pub(crate) cut: Subtraction,
    /// Remaining number of interreflections for rays from here.
    pub(crate) bounces: u32,
    /// Width of the ray that found it, scene units: smaller details are invisible.
    pub(crate) width: f64,
}

impl<const BANDS: usize> CachePoint<BANDS> {
    /// Whether the irradiance can be interpolated here.
    pub(crate) fn is_covered(&self, cache: &Cache<BANDS>) -> bool {
        cache.reaches(self.point, self.normal)
    }

    /// The number of the next gather from here.
    pub(crate) fn next_gather(&self, cache: &Cache<BANDS>) -> usize {
        cache.next_gather(self.point, self.normal)
    }
}

/// A ray's query of the irradiance cache.
#[derive(Clone, Debug)]
pub(crate) enum CacheQuery<const BANDS: usize> {
    /// Cache points without irradiance, and the spacing of the rays that found them.
    Missing(Vec<CachePoint<BANDS>>, RaySpacing),
    /// The records with the irradiance of the other points, and their weights.
    Served(Vec<(u32, f64)>),
}

impl<const BANDS: usize> CacheQuery<BANDS> {
    pub(crate) fn missing(self) -> Vec<CachePoint<BANDS>> {
        if let CacheQuery::Missing(cache_points, _) = self { cache_points } else { Vec::new() }
    }

    pub(crate) fn served(self) -> Vec<(u32, f64)> {
        if let CacheQuery::Served(served) = self { served } else { Vec::new() }
    }

    pub(crate) fn note(&mut self, cache_point: CachePoint<BANDS>, cache: &Cache<BANDS>, travelled: f64) {
        match self {
            CacheQuery::Missing(cache_points, spread) => {
                if !cache_point.is_covered(cache) {
                    cache_points.push(CachePoint { width: spread.at(travelled), ..cache_point });
                }
            }
            CacheQuery::Served(served) => cache.shares(cache_point.point, cache_point.normal, served),
        }
    }
}

/// How to sample the hemisphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HemisphereGather<'h> {
    pub(crate) hemisphere: &'h Hemisphere,
    /// The sample of each cell, by the number of the gather ([`Cache::next_gather`]); a random
    /// point of the cell if `None`.
    pub(crate) sample: Option<usize>,
    /// Distinguishes the rays of gathers.
    pub(crate) number: u64,
    /// Known bright directions.
    pub(crate) bright: Option<&'h GuidingRecords>,
}

/// The direction of a gather ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GatherDirection {
    /// Unit, in the local frame of the cache point, and in the scene.
    pub(crate) local: DVec3,
    pub(crate) direction: DVec3,
    pub(crate) sampler: RaySampler,
}
