//! Sending rays that look for diffuse surroundings towards openings.

use crate::gather::{Look, Place, Way};
use crate::openings::Outlook;
use crate::plan::RenderPlan;
use crate::surface_light::{Drawn, LitPoint};
use crate::trace::Tracer;
use glam::DVec3;
use radsight_brdf::Density;
use radsight_irradiance::{Gathered, Record};
use radsight_sampling::{DimensionSet, RaySampler};
use std::f64::consts::{FRAC_1_PI, PI};

/// Of rays that are drawn one by one.
const OUTWARD_CHANCE: f64 = 0.5;

/// Of rays that look around together: so many more.
const OUTWARD_SHARE: f64 = 0.25;

/// Rays towards openings are numbered apart from the others.
const OUTWARD_SEED: u64 = 0x6f75_7477_6172;

impl Outlook<'_> {
    /// The density of a single ray that is drawn by the cosine, with `diffuse_density`, or towards an opening, 1/sr.
    pub(crate) fn mixed_density(&self, direction: DVec3, diffuse_density: f64) -> f64 {
        OUTWARD_CHANCE * self.density(direction) + (1.0 - OUTWARD_CHANCE) * diffuse_density
    }
}

impl<const BANDS: usize> LitPoint<'_, BANDS> {
    /// What the diffuse component sees of openings, where it can be sent there.
    pub(crate) fn outlook<'p>(&self, plan: &'p RenderPlan, at: DVec3) -> Option<Outlook<'p>> {
        let is_simple = self.beyond.is_none() && !self.is_retroreflector();
        if is_simple { plan.openings.seen_from(at, self.diffuse_normal) } else { None }
    }

    /// Draws from the diffuse component or towards an opening.
    pub(crate) fn draw_outward(&self, outlook: &Outlook<'_>, u: [f64; 4]) -> Option<Drawn<BANDS>> {
        let direction = if u[0] < OUTWARD_CHANCE {
            outlook.draw([u[0] / OUTWARD_CHANCE, u[2], u[3]])?
        } else {
            self.draw_diffuse(u[2], u[3])?.direction
        };
        let by_cosine = self.diffuse_normal.dot(direction) * FRAC_1_PI;
        if by_cosine <= 0.0 || !self.is_drawn(direction, self.diffuse_normal) {
            return None;
        }
        let density = outlook.mixed_density(direction, by_cosine);
        let favour = density / by_cosine;
        let weight = self.reflectance_of_surroundings().map(|band| band / favour);
        let density = Density::Continuous(if self.diffuse_finds_lights() { density } else { 0.0 });
        Some(Drawn { direction, weight, density, favour })
    }
}

impl<const BANDS: usize> Tracer<'_, BANDS> {
    /// Adds rays towards openings to those that have looked around from a place by these ways, each in the cell of the hemisphere into which it goes.
    pub(crate) fn look_out(
        &mut self,
        place: &Place<BANDS>,
        look: &Look<'_>,
        ways: &[Way],
        mut seen: Vec<Gathered<BANDS>>,
    ) -> Vec<Gathered<BANDS>> {
        let Some(outlook) = self.plan.openings.seen_from(place.point, place.normal) else { return seen };
        let [x, y, z] = Record::<BANDS>::frame(place.normal);
        let around = look.hemisphere.len() as f64;
        let outward = (OUTWARD_SHARE * around).ceil();
        let density =
            |local: DVec3, direction: DVec3| around * local.z * FRAC_1_PI + outward * outlook.density(direction);
        for (way, gathered) in ways.iter().zip(&mut seen) {
            let share = around * way.local.z * FRAC_1_PI / density(way.local, way.direction);
            gathered.radiance = gathered.radiance.map(|band| band * share);
        }
        let seed = self.plan.options.seed ^ OUTWARD_SEED;
        for draw in 0..outward as u64 {
            let sampler = RaySampler::new(seed, look.number.wrapping_mul(outward as u64).wrapping_add(draw));
            let [choice, u, v, _] = sampler.take(DimensionSet::CAMERA);
            let Some(direction) = outlook.draw([choice, u, v]) else { continue };
            let local = DVec3::new(x.dot(direction), y.dot(direction), z.dot(direction));
            if local.z <= 0.0 {
                continue;
            }
            let found = self.look(place, direction, sampler);
            // A cell counts with its share of the projected solid angle π.
            let weight = local.z / density(local, direction) * around / PI;
            let cell = &mut seen[look.hemisphere.cell(local)];
            cell.radiance = std::array::from_fn(|band| cell.radiance[band] + weight * found.radiance[band]);
        }
        seen
    }
}
