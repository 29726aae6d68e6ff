//! Sending rays that look for diffuse surroundings to where light is expected.

use crate::beyond::luminance;
use crate::bright_places::{BRIGHT, BrightPlace, BrightView};
use crate::gather::{Look, Place, Way};
use crate::openings::Outlook;
use crate::plan::RenderPlan;
use crate::surface_light::{Drawn, LitPoint};
use crate::trace::Tracer;
use glam::DVec3;
use radsight_brdf::Density;
use radsight_irradiance::{Gathered, Hit, Record};
use radsight_sampling::{DimensionSet, RaySampler};
use std::f64::consts::{FRAC_1_PI, PI};

/// Of rays that look around together, so many more are sent towards openings.
const OUTWARD_SHARE: f64 = 0.25;

/// Rays towards openings are numbered apart from the others.
const OUTWARD_SEED: u64 = 0x6f75_7477_6172;
const BRIGHT_SEED: u64 = 0x6272_6967_6874;
const SHIFT_SEED: u64 = 0x7368_6966_7400;

/// What is seen at less than this cosine is not told from what is seen at it.
const GRAZING: f64 = 0.05;

/// So many numbers are kept for each look's rays towards bright places.
const MOST_BRIGHT: u64 = 1 << 12;

impl Outlook<'_> {
    /// The density of a single ray that is drawn by the cosine, with `diffuse_density`, or towards an opening, 1/sr.
    pub(crate) fn mixed_density(&self, direction: DVec3, diffuse_density: f64) -> f64 {
        self.chance * self.density(direction) + (1.0 - self.chance) * diffuse_density
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
        let direction = if u[0] < outlook.chance {
            outlook.draw([u[0] / outlook.chance, u[2], u[3]])?
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

/// The ways by which rays are sent from a place to look around, and how many go each.
struct Aims<'p> {
    /// By the cosine.
    around: f64,
    /// Towards openings.
    outward: f64,
    outlook: Option<Outlook<'p>>,
    bright: Option<BrightView<'p>>,
}

impl Aims<'_> {
    /// The share of a ray's own density, of rays by the cosine, in that of all rays that go its way.
    fn balance(&self, way: &Way) -> f64 {
        let by_cosine = self.around * FRAC_1_PI;
        let outlook = self.outlook.as_ref().map_or(0.0, |outlook| outlook.density(way.direction) / way.local.z);
        let bright = self.bright.as_ref().map_or(0.0, |bright| bright.density(way.local));
        by_cosine / (by_cosine + self.outward * outlook + bright)
    }
}

/// A ray that has looked.
#[derive(Clone, Copy, Debug)]
struct Glance<const BANDS: usize> {
    cell: usize,
    way: Way,
    /// With which its radiance counts in its cell.
    weight: f64,
    found: Gathered<BANDS>,
    /// How far away what it found appears.
    distance: f64,
    /// Where what it found comes from: how far away, and the unit normal there if it is known.
    source: (f64, Option<DVec3>),
}

impl<const BANDS: usize> Tracer<'_, BANDS> {
    /// What is seen from a place in each cell of the hemisphere, and what was bright. Rays go through each cell, and others where light is expected; each counts in the cell
    /// into which it goes.
    pub(crate) fn glance_around(&mut self, place: &Place<BANDS>, look: &Look<'_>) -> Surroundings<BANDS> {
        let around = look.hemisphere.len();
        let outlook = self.plan.openings.seen_from(place.point, place.normal);
        let aims = Aims {
            around: around as f64,
            outward: if outlook.is_some() { (OUTWARD_SHARE * around as f64).ceil() } else { 0.0 },
            outlook,
            bright: look.bright.and_then(|bright| bright.seen_from(place.point, place.normal, around as f64)),
        };
        let ways: Vec<Way> = (0..around).map(|cell| self.way(place, look, cell)).collect();
        let mut glances: Vec<Glance<BANDS>> =
            ways.iter().enumerate().map(|(cell, way)| self.glance(place, (cell, way), &aims)).collect();
        for way in self.further_ways(place, look, &aims) {
            let cell = look.hemisphere.cell(way.local);
            glances.push(self.glance(place, (cell, &way), &aims));
        }
        Surroundings::new(place, around, &glances)
    }

    /// The ways that lead towards where light is expected.
    fn further_ways(&self, place: &Place<BANDS>, look: &Look<'_>, aims: &Aims<'_>) -> Vec<Way> {
        let [x, y, z] = Record::<BANDS>::frame(place.normal);
        let sampler = |seed: u64, most: u64, draw: u64| {
            RaySampler::new(self.plan.options.seed ^ seed, look.number.wrapping_mul(most).wrapping_add(draw))
        };
        let outward = aims.outlook.iter().flat_map(|outlook| {
            (0..aims.outward as u64).filter_map(|draw| {
                let sampler = sampler(OUTWARD_SEED, aims.outward as u64, draw);
                let [choice, u, v, _] = sampler.take(DimensionSet::CAMERA);
                let direction = outlook.draw([choice, u, v])?;
                let local = DVec3::new(x.dot(direction), y.dot(direction), z.dot(direction));
                (local.z > 0.0).then_some(Way { local, direction, sampler })
            })
        });
        let bright = aims.bright.iter().flat_map(|bright| {
            let [shift, ..] = sampler(SHIFT_SEED, 1, 0).take(DimensionSet::CAMERA);
            (0..bright.rays()).map(move |draw| {
                let sampler = sampler(BRIGHT_SEED, MOST_BRIGHT, u64::from(draw));
                let [u, v, ..] = sampler.take(DimensionSet::CAMERA);
                let local = bright.draw(draw, shift, [u, v]);
                let direction = (x * local.x + y * local.y + z * local.z).normalize();
                Way { local, direction, sampler }
            })
        });
        outward.chain(bright).collect()
    }

    fn glance(&mut self, place: &Place<BANDS>, (cell, way): (usize, &Way), aims: &Aims<'_>) -> Glance<BANDS> {
        let found = self.look(place, way.direction, way.sampler);
        let seen = self.effective_distance();
        // The sky appears where the way to it is free.
        let distance = if seen.is_finite() { seen } else { found.distance };
        Glance { cell, way: *way, weight: aims.balance(way), found, distance, source: self.source(way, distance, aims) }
    }

    /// Where light comes from that appears at a distance: through an opening it changes from place to place as if the opening
    /// itself emitted it.
    fn source(&self, way: &Way, distance: f64, aims: &Aims<'_>) -> (f64, Option<DVec3>) {
        let opening = aims.outlook.as_ref().and_then(|outlook| outlook.crossed(way.direction));
        match opening {
            Some((before, normal)) if before < distance => (before, Some(normal)),
            _ => (distance, self.first_normal(way.direction).filter(|_| distance == self.first_distance())),
        }
    }
}

/// What is seen around a place.
#[derive(Debug)]
pub(crate) struct Surroundings<const BANDS: usize> {
    /// One a cell of the hemisphere.
    pub(crate) cells: Vec<Gathered<BANDS>>,
    pub(crate) bright: Vec<BrightPlace>,
    pub(crate) hits: Vec<Hit<BANDS>>,
    /// Rays that looked.
    pub(crate) rays: usize,
}

impl<const BANDS: usize> Surroundings<BANDS> {
    /// The first `around` glances are one a cell.
    fn new(place: &Place<BANDS>, around: usize, glances: &[Glance<BANDS>]) -> Self {
        let mut cells: Vec<_> = glances[..around].iter().map(|glance| glance.found).collect();
        cells.iter_mut().for_each(|cell| cell.radiance = [0.0; BANDS]);
        for glance in glances {
            for (sum, radiance) in cells[glance.cell].radiance.iter_mut().zip(glance.found.radiance) {
                *sum += glance.weight * radiance;
            }
        }
        let total: f64 = cells.iter().map(|cell| luminance(&cell.radiance)).sum();
        let bright = |glance: &Glance<BANDS>| {
            let radiance = luminance(&glance.found.radiance);
            let is_bright = radiance * around as f64 > BRIGHT * total && glance.distance.is_finite();
            let squared = glance.distance * glance.distance;
            is_bright.then(|| BrightPlace {
                position: place.point + glance.way.direction * glance.distance,
                power: radiance * glance.weight / total * squared / glance.way.local.z.max(GRAZING),
            })
        };
        let hit = |glance: &Glance<BANDS>| Hit {
            direction: glance.way.direction,
            distance: glance.source.0,
            normal: glance.source.1,
            irradiance: glance.found.radiance.map(|band| band * glance.weight * PI / around as f64),
        };
        Surroundings {
            bright: glances.iter().filter_map(bright).collect(),
            hits: glances.iter().map(hit).collect(),
            rays: glances.len(),
            cells,
        }
    }
}
