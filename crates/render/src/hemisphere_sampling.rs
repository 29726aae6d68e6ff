//! Samples the hemisphere of a cache point by the cosine, towards portals and by the guiding
//! distribution.

use crate::cache_query::{CachePoint, GatherDirection, HemisphereGather};
use crate::guiding::{BRIGHT, GuidingDistribution, GuidingSample};
use crate::path_guide::PathGuide;
use crate::trace::PathIntegrator;
use glam::DVec3;
use radsight_accel::Intersection;
use radsight_brdf::Density;
use radsight_bsdf::{Bsdf, BsdfSample};
use radsight_compile::{RenderPlan, VisiblePortals};
use radsight_irradiance_cache::{GatherHit, GatheredRadiance, Record};
use radsight_sampling::{DimensionSet, RaySampler};
use radsight_texture::luminance;
use std::f64::consts::{FRAC_1_PI, PI};

/// Number of additional rays towards portals, relative to the hemisphere samples.
const OUTWARD_SHARE: f64 = 0.25;

/// Seed of rays towards portals.
const OUTWARD_SEED: u64 = 0x6f75_7477_6172;
const BRIGHT_SEED: u64 = 0x6272_6967_6874;
const SHIFT_SEED: u64 = 0x7368_6966_7400;

/// Minimum cosine for the position of a bright hit.
const GRAZING: f64 = 0.05;

/// Ray numbers reserved for the guided samples of each gather.
const MAX_BRIGHT: u64 = 1 << 12;

/// The portals that the diffuse component sees, if rays can be directed there.
pub(crate) fn visible_portals<'p, const BANDS: usize>(
    bsdf: &Bsdf<'_, BANDS>,
    (plan, guide): (&'p RenderPlan, Option<&'p PathGuide>),
    at: DVec3,
) -> Option<VisiblePortals<'p>> {
    if bsdf.transmission.is_some() || bsdf.is_retroreflector() {
        return None;
    }
    match guide {
        Some(guide) => guide.seen_from(at, bsdf.normal),
        None => plan.portals.seen_from(at, bsdf.normal),
    }
}

/// Samples the diffuse component, or a direction towards a portal.
pub(crate) fn sample_outward<const BANDS: usize>(
    bsdf: &Bsdf<'_, BANDS>,
    visible_portals: &VisiblePortals<'_>,
    u: [f64; 4],
) -> Option<BsdfSample<BANDS>> {
    let direction = if u[0] < visible_portals.chance {
        visible_portals.sample([u[0] / visible_portals.chance, u[2], u[3]])?
    } else {
        bsdf.sample_diffuse(u[2], u[3])?.direction
    };
    let sample = bsdf.diffuse_lobe().at(direction)?;
    let pdf = visible_portals.mixed_pdf(direction, sample.pdf);
    let pdf_ratio = pdf / sample.pdf;
    let weight = bsdf.reflectance_of_surroundings().map(|band| band * sample.weight / pdf_ratio);
    let pdf = Density::Continuous(if bsdf.diffuse_finds_lights() { pdf } else { 0.0 });
    Some(BsdfSample { direction, weight, pdf, pdf_ratio })
}

/// The techniques by which the hemisphere of a point is sampled, and their numbers of rays.
struct GatherTechniques<'p> {
    /// By the cosine.
    around: f64,
    /// Towards portals.
    outward: f64,
    visible_portals: Option<VisiblePortals<'p>>,
    bright: Option<GuidingDistribution<'p>>,
}

impl GatherTechniques<'_> {
    /// The balance heuristic: the pdf of cosine-distributed rays over that of all rays in this
    /// direction.
    fn balance(&self, sample: &GatherDirection) -> f64 {
        let by_cosine = self.around * FRAC_1_PI;
        let visible_portals = self
            .visible_portals
            .as_ref()
            .map_or(0.0, |visible_portals| visible_portals.pdf(sample.direction) / sample.local.z);
        let bright = self.bright.as_ref().map_or(0.0, |bright| bright.pdf(sample.local));
        by_cosine / (by_cosine + self.outward * visible_portals + bright)
    }
}

/// A traced gather ray.
#[derive(Clone, Copy, Debug)]
struct GatherRay<const BANDS: usize> {
    cell: usize,
    sample: GatherDirection,
    /// The weight of its radiance in its cell.
    weight: f64,
    found: GatheredRadiance<BANDS>,
    /// The apparent distance of its hit.
    distance: f64,
    /// The origin of its light: the distance, and the unit normal if known.
    source: (f64, Option<DVec3>),
}

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// The radiance from each cell of the hemisphere of a cache point, and the bright hits. Each
    /// cell has a ray, and further rays are guided; each counts in its own cell.
    pub(crate) fn sample_hemisphere(
        &mut self,
        cache_point: &CachePoint<BANDS>,
        gather: &HemisphereGather<'_>,
    ) -> HemisphereSamples<BANDS> {
        let around = gather.hemisphere.len();
        let visible_portals = self.plan.portals.seen_from(cache_point.point, cache_point.normal);
        let aims = GatherTechniques {
            around: around as f64,
            outward: if visible_portals.is_some() { (OUTWARD_SHARE * around as f64).ceil() } else { 0.0 },
            visible_portals,
            bright: gather
                .bright
                .and_then(|bright| bright.seen_from(cache_point.point, cache_point.normal, around as f64)),
        };
        let mut directions: Vec<(usize, GatherDirection)> =
            (0..around).map(|cell| (cell, self.gather_direction(cache_point, gather, cell))).collect();
        let further = self.further_directions(cache_point, gather, &aims);
        directions.extend(further.into_iter().map(|sample| (gather.hemisphere.cell(sample.local), sample)));
        // The code that finds surfaces and the code that shades them do not fit into the cache of a
        // processor together.
        let hits: Vec<Option<Intersection>> =
            directions.iter().map(|(_, sample)| self.gather_hit(cache_point, sample.direction)).collect();
        let gather_rays: Vec<GatherRay<BANDS>> = directions
            .iter()
            .zip(hits)
            .map(|((cell, sample), hit)| self.gather_ray(cache_point, (*cell, sample, hit), &aims))
            .collect();
        HemisphereSamples::new(cache_point, around, &gather_rays)
    }

    /// The directions of the guided rays.
    fn further_directions(
        &self,
        cache_point: &CachePoint<BANDS>,
        gather: &HemisphereGather<'_>,
        aims: &GatherTechniques<'_>,
    ) -> Vec<GatherDirection> {
        let [x, y, z] = Record::<BANDS>::frame(cache_point.normal);
        let sampler = |seed: u64, most: u64, draw: u64| {
            RaySampler::new(self.plan.options.seed ^ seed, gather.number.wrapping_mul(most).wrapping_add(draw))
        };
        let outward = aims.visible_portals.iter().flat_map(|visible_portals| {
            (0..aims.outward as u64).filter_map(|draw| {
                let sampler = sampler(OUTWARD_SEED, aims.outward as u64, draw);
                let [choice, u, v, _] = sampler.take(DimensionSet::CAMERA);
                let direction = visible_portals.sample([choice, u, v])?;
                let local = DVec3::new(x.dot(direction), y.dot(direction), z.dot(direction));
                (local.z > 0.0).then_some(GatherDirection { local, direction, sampler })
            })
        });
        let bright = aims.bright.iter().flat_map(|bright| {
            let [shift, ..] = sampler(SHIFT_SEED, 1, 0).take(DimensionSet::CAMERA);
            (0..bright.rays()).map(move |draw| {
                let sampler = sampler(BRIGHT_SEED, MAX_BRIGHT, u64::from(draw));
                let [u, v, ..] = sampler.take(DimensionSet::CAMERA);
                let local = bright.draw(draw, shift, [u, v]);
                let direction = (x * local.x + y * local.y + z * local.z).normalize();
                GatherDirection { local, direction, sampler }
            })
        });
        outward.chain(bright).collect()
    }

    fn gather_ray(
        &mut self,
        cache_point: &CachePoint<BANDS>,
        (cell, sample, hit): (usize, &GatherDirection, Option<Intersection>),
        aims: &GatherTechniques<'_>,
    ) -> GatherRay<BANDS> {
        let found = self.gather_radiance_from(cache_point, sample, hit);
        let seen = self.effective_distance();
        // The sky is visible only if the ray is unobstructed.
        let distance = if seen.is_finite() { seen } else { found.distance };
        GatherRay {
            cell,
            sample: *sample,
            weight: aims.balance(sample),
            found,
            distance,
            source: self.source(sample, distance, aims),
        }
    }

    /// The origin of the light at an apparent distance: light through a portal varies with position
    /// as if the portal emitted it.
    fn source(&self, sample: &GatherDirection, distance: f64, aims: &GatherTechniques<'_>) -> (f64, Option<DVec3>) {
        let portal =
            aims.visible_portals.as_ref().and_then(|visible_portals| visible_portals.crossed(sample.direction));
        match portal {
            Some((before, normal)) if before < distance => (before, Some(normal)),
            _ => (distance, self.first_normal(sample.direction).filter(|_| distance == self.first_distance())),
        }
    }
}

/// The gathered radiance of a cache point.
#[derive(Debug)]
pub(crate) struct HemisphereSamples<const BANDS: usize> {
    /// One per cell of the hemisphere.
    pub(crate) cells: Vec<GatheredRadiance<BANDS>>,
    pub(crate) bright: Vec<GuidingSample>,
    pub(crate) hits: Vec<GatherHit<BANDS>>,
    /// Number of rays.
    pub(crate) rays: usize,
}

impl<const BANDS: usize> HemisphereSamples<BANDS> {
    /// The first `around` gather rays are one per cell.
    fn new(cache_point: &CachePoint<BANDS>, around: usize, gather_rays: &[GatherRay<BANDS>]) -> Self {
        let mut cells: Vec<_> = gather_rays[..around].iter().map(|gather_ray| gather_ray.found).collect();
        cells.iter_mut().for_each(|cell| cell.radiance = [0.0; BANDS]);
        for gather_ray in gather_rays {
            for (sum, radiance) in cells[gather_ray.cell].radiance.iter_mut().zip(gather_ray.found.radiance) {
                *sum += gather_ray.weight * radiance;
            }
        }
        let total: f64 = cells.iter().map(|cell| luminance(&cell.radiance)).sum();
        let bright = |gather_ray: &GatherRay<BANDS>| {
            let radiance = luminance(&gather_ray.found.radiance);
            let is_bright = radiance * around as f64 > BRIGHT * total && gather_ray.distance.is_finite();
            let squared = gather_ray.distance * gather_ray.distance;
            is_bright.then(|| GuidingSample {
                position: cache_point.point + gather_ray.sample.direction * gather_ray.distance,
                power: radiance * gather_ray.weight / total * squared / gather_ray.sample.local.z.max(GRAZING),
            })
        };
        let hit = |gather_ray: &GatherRay<BANDS>| GatherHit {
            direction: gather_ray.sample.direction,
            distance: gather_ray.source.0,
            normal: gather_ray.source.1,
            irradiance: gather_ray.found.radiance.map(|band| band * gather_ray.weight * PI / around as f64),
        };
        HemisphereSamples {
            bright: gather_rays.iter().filter_map(bright).collect(),
            hits: gather_rays.iter().map(hit).collect(),
            rays: gather_rays.len(),
            cells,
        }
    }
}
