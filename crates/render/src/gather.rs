//! Gathers irradiance at a point, and uses cached irradiance.

use crate::cache_occluders::OpaqueSurfaces;
use crate::cache_query::{CachePoint, GatherDirection, HemisphereGather};
use crate::caching::max_interpolation_error;
use crate::direct::DirectSampler;
use crate::hemisphere_sampling::HemisphereSamples;
use crate::mis::{Lobe, MisState};
use crate::ray_tree::NodeId;
use crate::specular_chain::SpecularChain;
use crate::trace::PathIntegrator;
use crate::trace::path_state::PathState;
use glam::DVec3;
use radsight_accel::{Intersection, PrimitiveId, Ray};
use radsight_bsdf::Bsdf;
use radsight_irradiance_cache::{GatheredRadiance, Limits, Record};
use radsight_light::Reception;
use radsight_sampling::{DimensionSet, RaySampler};
use std::f64::consts::{FRAC_1_PI, PI};

/// Minimum distance between records, in widths of the rays that see them; smaller, down to half of
/// it, if less noise than this is allowed.
const MIN_WIDTHS: f64 = 1.5;
const FINE_NOISE: f64 = 0.0225;

/// The same with caustics, which are as fine as visible.
const MIN_WIDTHS_IN_CAUSTICS: f64 = 0.3;

/// After a bounce, irradiance comes from records with at most this reach relative to the distance:
/// near surfaces fill so much of the view that they need more accuracy.
const REACH_SEEN: f64 = 2.0;

/// Multiples of the golden ratio are distributed evenly modulo 1.
const GOLDEN_RATIO: f64 = 0.618_033_988_749_895;

/// Seed of hemisphere samples, different from those of the picture.
const GATHERING_SEED: u64 = 0x6761_7468_6572;
const DIRECT_SEED: u64 = 0x6469_7265_6374;

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// The reflected radiance due to cached or gathered irradiance; `None` if a ray is to be
    /// sampled instead, and in a search for cache points.
    pub(crate) fn gathered(
        &mut self,
        path: &PathState<BANDS>,
        at: DVec3,
        primitive: Option<PrimitiveId>,
        point: &Bsdf<'_, BANDS>,
        travelled: f64,
    ) -> Option<[f64; BANDS]> {
        let options = &self.plan.options;
        let bounces_behind = options.ambient_bounces - path.ambient_bounces;
        let cache = self.caches.get(bounces_behind as usize).copied().flatten();
        if cache.is_none() || point.is_retroreflector() {
            return None;
        }
        let mut radiance = [0.0; BANDS];
        let mut complete = true;
        for (normal, facet, reflectance) in point.ambient_sides() {
            if reflectance.iter().all(|band| *band <= 0.0) {
                continue;
            }
            let cache_point = CachePoint {
                point: at,
                normal,
                primitive,
                medium: self.medium(path.medium),
                cut: self.cut(if normal.dot(point.normal) < 0.0 { path.subtraction_beyond } else { path.cut }).clone(),
                bounces: path.ambient_bounces - 1,
                width: 0.0,
            };
            if let Some(search) = &mut self.point_search {
                search.note(cache_point, travelled);
                complete = false;
                continue;
            }
            let occluders = OpaqueSurfaces(self.plan);
            let shared = cache.and_then(|cache| match bounces_behind {
                0 => cache.trusted_irradiance(at, normal, facet, &occluders, max_interpolation_error(self.plan)),
                _ => cache.fine_irradiance(at, normal, facet, &occluders, REACH_SEEN * travelled),
            });
            let irradiance = match shared {
                Some(irradiance) => irradiance,
                None => {
                    complete = false;
                    continue;
                }
            };
            for (sum, (share, irradiance)) in radiance.iter_mut().zip(reflectance.iter().zip(irradiance)) {
                *sum += share * irradiance * FRAC_1_PI;
            }
        }
        complete.then_some(radiance)
    }

    /// The irradiance of a cache point, and its hemisphere samples.
    pub(crate) fn gather_at(
        &mut self,
        cache_point: &CachePoint<BANDS>,
        gather: &HemisphereGather<'_>,
        limits: &Limits,
    ) -> (Record<BANDS>, HemisphereSamples<BANDS>) {
        let fineness = (self.plan.options.gathering.noise / FINE_NOISE).clamp(0.5, 1.0);
        let widths = if self.plan.has_caustics { MIN_WIDTHS_IN_CAUSTICS } else { MIN_WIDTHS * fineness };
        let limits = Limits { min_reach: limits.min_reach.max(widths * cache_point.width), ..*limits };
        let around = self.sample_hemisphere(cache_point, gather);
        let record = Record::new(cache_point.point, cache_point.normal, gather.hemisphere, &around.cells, &limits);
        let offset = (gather.number as f64 * GOLDEN_RATIO).fract();
        (record.with_rays(around.rays).with_hits(&around.hits, offset), around)
    }

    /// The irradiance of a cache point from the lights that light sampling finds, averaged over the
    /// bands, by one sample.
    pub(crate) fn direct_irradiance(&mut self, cache_point: &CachePoint<BANDS>, number: u64) -> f64 {
        let sampler = RaySampler::new(self.plan.options.seed ^ DIRECT_SEED, number);
        let medium = self.begin(sampler, cache_point.medium);
        let cut = self.add_subtraction(cache_point.cut.clone());
        let white = Bsdf::white(cache_point.normal, cache_point.normal);
        let reception = white.reception(self.plan.light_draws[1]);
        let direct = DirectSampler {
            point: cache_point.point,
            primitive: cache_point.primitive,
            highlight_draws: 0,
            shares_diffuse: false,
            visible_portals: None,
            specular_return: None,
            reception,
            travelled: 0.0,
            medium,
            cuts: [cut; 2],
            normal: cache_point.normal,
            drawn: true,
            facing: Some(cache_point.normal),
        };
        PI * direct.sample(self, &white).iter().sum::<f64>() / BANDS as f64
    }

    /// The direction of a gather ray through a cell of the hemisphere.
    pub(crate) fn gather_direction(
        &self,
        cache_point: &CachePoint<BANDS>,
        gather: &HemisphereGather<'_>,
        cell: usize,
    ) -> GatherDirection {
        let first = gather.number.wrapping_mul(gather.hemisphere.len() as u64);
        let seed = self.plan.options.seed ^ GATHERING_SEED;
        let sampler = RaySampler::new(seed, first.wrapping_add(cell as u64));
        let within = match gather.sample {
            None => sampler.take(DimensionSet::CAMERA),
            // The points of one sequence in this cell: each STRATA consecutive ones visit all its
            // strata, and no two are the same.
            Some(sample) => {
                let of_cell = seed ^ ((cell as u64 + 1) << 32);
                RaySampler::new(of_cell, sample as u64).take(DimensionSet::CAMERA)
            }
        };
        let [x, y, z] = Record::<BANDS>::frame(cache_point.normal);
        let local = gather.hemisphere.direction(cell, [within[0], within[1]]);
        GatherDirection { local, direction: (x * local.x + y * local.y + z * local.z).normalize(), sampler }
    }

    /// What a gather ray hits first.
    pub(crate) fn gather_hit(&self, cache_point: &CachePoint<BANDS>, direction: DVec3) -> Option<Intersection> {
        self.plan.first_hit(&Ray { origin: cache_point.point, direction }, cache_point.primitive)
    }

    /// The radiance from one direction. Light of sampled sources is excluded: an MIS state with pdf
    /// 0 leaves all of it to light sampling.
    pub(crate) fn gather_radiance(
        &mut self,
        cache_point: &CachePoint<BANDS>,
        direction: DVec3,
        sampler: RaySampler,
    ) -> GatheredRadiance<BANDS> {
        let mut path = self.begin_gather_ray(cache_point, direction, sampler);
        self.finish(&mut path);
        GatheredRadiance { radiance: self.radiance, distance: self.first_distance() }
    }

    /// The same for a ray whose first hit is known.
    pub(crate) fn gather_radiance_from(
        &mut self,
        cache_point: &CachePoint<BANDS>,
        sample: &GatherDirection,
        hit: Option<Intersection>,
    ) -> GatheredRadiance<BANDS> {
        let mut path = self.begin_gather_ray(cache_point, sample.direction, sample.sampler);
        self.finish_from(&mut path, hit);
        GatheredRadiance { radiance: self.radiance, distance: self.first_distance() }
    }

    fn begin_gather_ray(
        &mut self,
        cache_point: &CachePoint<BANDS>,
        direction: DVec3,
        sampler: RaySampler,
    ) -> PathState<BANDS> {
        let medium = self.begin(sampler, cache_point.medium);
        let cut = self.add_subtraction(cache_point.cut.clone());
        let mis =
            MisState::new(0.0, (cache_point.point, direction), Reception::NONE, cache_point.primitive, Lobe::Diffuse);
        PathState {
            ray: Ray { origin: cache_point.point, direction },
            from: cache_point.primitive,
            throughput: [1.0; BANDS],
            split: 1.0,
            travelled: 0.0,
            mis: Some(mis),
            chain: SpecularChain::default(),
            depth: 0,
            is_limited: false,
            reflections: 1,
            ambient_bounces: cache_point.bounces,
            medium,
            cut,
            subtraction_beyond: cut,
            follows_no_diffuse: false,
            direct_view: true,
            node: NodeId::NONE,
        }
    }
}
