//! Sheeting: a retroreflecting lobe on a diffuse base, under a clear top film.
//!
//! `f = T(θ_o) T(θ_i) (f_retro + ρ_d/π) + F · D G/(4 cos θ_i cos θ_o)`
//!
//! | parameter | meaning | unit | range |
//! |---|---|---|---|
//! | ρ_d | diffuse reflectance of the base at normal incidence | 1 | 0…1, default 0 |
//! | index | refractive index of the film; 1 means no film | 1 | 1…2.5, default 1 |
//! | roughness | α of the film's facets (GGX), for its sheen | 1 | 0.0005…1, default 0.1 |
//!
//! T is Fresnel's transmittance relative to normal incidence. It is not applied to lobes that were
//! measured, or traced, with their front: `glass_bead`, `table` and `cube_corner`. Patterns and
//! textures of the scene apply as usual: a pattern multiplies the whole value, a texture perturbs
//! the normal.

use crate::fresnel::fresnel_dielectric;
use crate::gaussian::{Paper1991, ReciprocalGaussian, observation_angle, sample_lobe};
use crate::ggx::Ggx;
use crate::glass_bead::GlassBead;
use crate::mrm::Mrm;
use crate::prism::{CubeCornerSheeting, Spots};
use crate::sharp::SharpLobe;
use crate::table::RetroTable;
use glam::DVec3;
use radsight_brdf::{Brdf, BrdfSample, Density, Lobes};
use std::cell::OnceCell;
use std::f64::consts::{FRAC_1_PI, TAU};

/// The retroreflecting lobe.
#[derive(Clone, Debug)]
pub(crate) enum Core {
    Paper(Paper1991<1>),
    Gaussian(ReciprocalGaussian<1>),
    Sharp { reflectance: f64, lobe: SharpLobe },
    Bead(GlassBead),
    Mrm(Mrm),
    CubeCorner(CubeCornerSheeting),
    Table(RetroTable),
}

/// Base and film around the lobe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surroundings {
    /// Diffuse reflectance ρ_d of the base.
    pub matte: f64,
    /// Refractive index of the film; 1 means no film.
    pub index: f64,
    /// Roughness of the film's facets.
    pub roughness: f64,
}

impl Default for Surroundings {
    fn default() -> Self {
        Surroundings { matte: 0.0, index: 1.0, roughness: 0.1 }
    }
}

/// Retroreflecting sheeting, with the same value in every band.
#[derive(Clone, Debug)]
pub struct Sheeting {
    core: Core,
    matte: f64,
    /// Refractive index and facets of the film.
    film: Option<(f64, Ggx)>,
    /// Probabilities of sampling the lobe and the film; otherwise the diffuse base is sampled.
    choice: [f64; 2],
}

/// The lobe seen from one unit direction. Terms of that direction alone are computed once, if they
/// are needed.
struct CoreFrom<'a> {
    core: &'a Core,
    outgoing: DVec3,
    spots: OnceCell<Spots>,
}

impl Core {
    fn seen_from(&self, outgoing: DVec3) -> CoreFrom<'_> {
        CoreFrom { core: self, outgoing, spots: OnceCell::new() }
    }

    /// Estimated albedo, for choosing a lobe.
    fn strength(&self) -> f64 {
        match self {
            Core::Paper(lobe) => lobe.reflectance[0],
            Core::Gaussian(lobe) => lobe.reflectance[0],
            Core::Sharp { reflectance, .. } => *reflectance,
            Core::Bead(lobe) => lobe.albedo().min(1.0),
            Core::Mrm(lobe) => lobe.normal_reflectance.max(0.05),
            Core::CubeCorner(_) => 0.6,
            Core::Table(table) => table.albedo(0.0).min(1.0),
        }
    }

    /// Whether the film attenuates the lobe.
    fn is_below_film(&self) -> bool {
        matches!(self, Core::Paper(_) | Core::Gaussian(_) | Core::Sharp { .. } | Core::Mrm(_))
    }
}

impl CoreFrom<'_> {
    fn spots(&self, sheet: &CubeCornerSheeting) -> &Spots {
        self.spots.get_or_init(|| sheet.targets(self.outgoing))
    }

    /// f and density in 1/sr, for directions above the surface.
    fn value_and_pdf(&self, incident: DVec3) -> (f64, f64) {
        let outgoing = self.outgoing;
        let angle = || observation_angle(outgoing, incident);
        let chord_squared = || outgoing.distance_squared(incident);
        match self.core {
            Core::Paper(lobe) => {
                let angle = angle();
                (lobe.reflectance[0] * lobe.reflected_density(angle) / incident.z, lobe.sampling_density(angle))
            }
            Core::Gaussian(ReciprocalGaussian { reflectance, spread }) => {
                let (lobe, angle) = (Paper1991 { reflectance: *reflectance, spread: *spread }, angle());
                let value = reflectance[0] * lobe.reflected_density(angle) / outgoing.z.max(incident.z);
                (value, lobe.sampling_density(angle))
            }
            Core::Sharp { reflectance, lobe } => {
                let value = reflectance * lobe.value(angle()) / outgoing.z.max(incident.z);
                (value, lobe.density().at_chord(chord_squared()))
            }
            Core::Bead(lobe) => (lobe.value(angle(), incident.z), lobe.density().at_chord(chord_squared())),
            Core::Mrm(lobe) => lobe.value_and_pdf(outgoing, incident),
            Core::CubeCorner(sheet) => {
                let pdf = sheet.pdf_among(outgoing, incident, || self.spots(sheet));
                (sheet.value(outgoing, incident), pdf)
            }
            Core::Table(table) => (table.value(outgoing, incident), table.pdf(outgoing, incident)),
        }
    }

    fn sample(&self, u: [f64; 3]) -> Option<DVec3> {
        let outgoing = self.outgoing;
        let place = [u[0], u[1]];
        match self.core {
            Core::Paper(Paper1991 { spread, .. }) | Core::Gaussian(ReciprocalGaussian { spread, .. }) => {
                sample_lobe(*spread, outgoing, u[0], u[1]).map(|(direction, _)| direction)
            }
            Core::Sharp { lobe, .. } => Some(lobe.density().sample(outgoing, place)),
            Core::Bead(lobe) => Some(lobe.density().sample(outgoing, place)),
            Core::Mrm(lobe) => Some(lobe.sample(outgoing, place, u[2])),
            Core::CubeCorner(sheet) => sheet.sample_among(outgoing, self.spots(sheet), u),
            Core::Table(table) => Some(table.sample(outgoing, place)),
        }
    }
}

impl Sheeting {
    pub(crate) fn new(core: Core, around: Surroundings) -> Sheeting {
        let film = (around.index > 1.0).then_some((around.index, Ggx { roughness: around.roughness }));
        let sheen = film.map_or(0.0, |(index, _)| fresnel_dielectric(1.0, index));
        let strength = core.strength();
        // Every existing lobe keeps a minimum probability, since the film's reflectance grows
        // towards grazing incidence.
        let total = (strength + sheen + around.matte).max(1e-9);
        let share = |part: f64| if part > 0.0 { 0.1 + 0.7 * part / total } else { 0.0 };
        let shares = [share(strength.max(1e-6)), share(sheen), share(around.matte)];
        let sum: f64 = shares.iter().sum();
        let choice = if sheen + around.matte > 0.0 { [shares[0] / sum, shares[1] / sum] } else { [1.0, 0.0] };
        Sheeting { core, matte: around.matte, film, choice }
    }

    /// f and density in 1/sr; both are zero if a direction is below the surface.
    #[must_use]
    pub fn value_and_pdf(&self, outgoing: DVec3, incident: DVec3) -> (f64, f64) {
        self.value_and_pdf_of(&self.core.seen_from(outgoing), incident)
    }

    fn value_and_pdf_of(&self, core: &CoreFrom<'_>, incident: DVec3) -> (f64, f64) {
        let outgoing = core.outgoing;
        if outgoing.z <= 0.0 || incident.z <= 0.0 {
            return (0.0, 0.0);
        }
        let (retro, retro_pdf) = core.value_and_pdf(incident);
        let Some((index, facets)) = &self.film else {
            let matte_choice = 1.0 - self.choice[0];
            let pdf = self.choice[0] * retro_pdf + matte_choice * incident.z * FRAC_1_PI;
            return (retro + self.matte * FRAC_1_PI, pdf);
        };
        let sheen = facets.reflect(outgoing, incident);
        let at_normal_incidence = 1.0 - fresnel_dielectric(1.0, *index);
        let passage = |cosine: f64| (1.0 - fresnel_dielectric(cosine, *index)) / at_normal_incidence;
        let both = passage(outgoing.z) * passage(incident.z);
        let retro = if self.core.is_below_film() { retro * both } else { retro };
        let value = retro + self.matte * FRAC_1_PI * both + sheen.value * fresnel_dielectric(sheen.cosine, *index);
        let [core_choice, film_choice] = self.choice;
        let matte_pdf = (1.0 - core_choice - film_choice) * incident.z * FRAC_1_PI;
        (value, core_choice * retro_pdf + film_choice * sheen.pdf + matte_pdf)
    }

    fn sample_direction(&self, core: &CoreFrom<'_>, u: [f64; 3]) -> Option<DVec3> {
        let [core_choice, film_choice] = self.choice;
        if u[2] < core_choice {
            return core.sample([u[0], u[1], u[2] / core_choice]);
        }
        match &self.film {
            Some((_, facets)) if u[2] < core_choice + film_choice => Some(facets.sample(core.outgoing, [u[0], u[1]])),
            _ => {
                let (radius, (sin, cos)) = (u[0].sqrt(), (TAU * u[1]).sin_cos());
                Some(DVec3::new(radius * cos, radius * sin, (1.0 - u[0]).max(0.0).sqrt()))
            }
        }
    }
}

impl Brdf for Sheeting {
    fn lobes(&self) -> Lobes {
        Lobes { glossy: true, diffuse: self.matte > 0.0, ..Lobes::default() }
    }

    fn eval_pdf(&self, outgoing: DVec3, incident: &[DVec3], values: &mut [f64], pdfs: &mut [f64]) {
        if incident.is_empty() {
            return;
        }
        let bands = values.len() / incident.len();
        let core = self.core.seen_from(outgoing);
        for ((direction, values), pdf) in incident.iter().zip(values.chunks_exact_mut(bands)).zip(pdfs) {
            let (value, density) = self.value_and_pdf_of(&core, *direction);
            values.fill(value);
            *pdf = density;
        }
    }

    fn sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> Option<BrdfSample> {
        if outgoing.z <= 0.0 {
            return None;
        }
        let core = self.core.seen_from(outgoing);
        let incident = self.sample_direction(&core, u)?;
        let (value, pdf) = self.value_and_pdf_of(&core, incident);
        if pdf <= 0.0 {
            return None;
        }
        weights.fill(value * incident.z / pdf);
        Some(BrdfSample { incident, density: Density::Continuous(pdf) })
    }
}
