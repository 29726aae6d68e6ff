//! Cache points, and the search for them.

use crate::cache_occluders::OpaqueSurfaces;
use crate::guiding::GuidingRecords;
use crate::ray_spacing::RaySpacing;
use crate::subtraction::Subtraction;
use glam::DVec3;
use radsight_accel::PrimitiveId;
use radsight_compile::{Medium, RenderPlan};
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
    /// Smaller details need not be resolved, scene units: the spacing of the rays that find the points, or less.
    pub(crate) width: f64,
}

impl<const BANDS: usize> CachePoint<BANDS> {
    /// Whether the irradiance can be interpolated here.
    pub(crate) fn is_covered(&self, plan: &RenderPlan, cache: &Cache<BANDS>) -> bool {
        cache.reaches(self.point, self.normal, &OpaqueSurfaces(plan))
    }

    /// The number of the next gather from here.
    pub(crate) fn next_gather(&self, cache: &Cache<BANDS>) -> usize {
        cache.next_gather(self.point, self.normal)
    }
}

/// The search for the cache points of a ray. They depend on the ray, never on cached irradiance.
#[derive(Clone, Debug)]
pub(crate) struct PointSearch<const BANDS: usize> {
    /// Spacing of the rays.
    spread: RaySpacing,
    /// The cache points so far, in the order of the ray's branches.
    pub(crate) found: Vec<CachePoint<BANDS>>,
}

impl<const BANDS: usize> PointSearch<BANDS> {
    /// For one of several rays with this spacing.
    pub(crate) fn new(spread: RaySpacing) -> Self {
        PointSearch { spread, found: Vec::new() }
    }

    /// Adds a cache point at this distance along the ray, scene units.
    pub(crate) fn note(&mut self, cache_point: CachePoint<BANDS>, travelled: f64) {
        self.found.push(CachePoint { width: self.spread.at(travelled), ..cache_point });
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
