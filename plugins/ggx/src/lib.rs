//! ggx: rough surfaces of mirror facets, with interreflection between facets
//!
//! Metals and glossy paints, from nearly polished to blasted. Unlike single-scattering models it
//! does not darken with roughness: light that one reflection loses leaves after several.
//!
//! ```text
//! void brdfplugin blasted_gold
//! 2 ggx ggx
//! 0
//! 4 1 .78 .34 .4
//! ```
//!
//! | model | arguments | unit | range |
//! |---|---|---|---|
//! | `ggx` | reflectance at normal incidence: red green blue | 1 | 0 … 1 |
//! | | roughness α of the facets | 1 | 0.0005 … 1 |
//! | `ggx_single` | the same, without interreflection | | |
//!
//! Facets: Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007
//! (distribution of Trowbridge and Reitz), masking after Heitz, JCGT 3(2), 2014. The facets'
//! reflectance grows towards grazing incidence after Schlick, "An Inexpensive BRDF Model for
//! Physically-based Rendering", Eurographics 1994. Interreflection: Kulla and Conty, "Revisiting
//! Physically Based Shading at Imageworks", SIGGRAPH 2017 course, with the directional albedo
//! integrated when the material is created. With reflectance 1 all light is reflected, to 0.1 %.

use radsight_brdf_sdk::{
    CreateError, DVec3, Description, Ggx, Lobes, Model, Parameter, Parameters, Sample, cosine_hemisphere, cosine_pdf,
};
use std::f64::consts::FRAC_1_PI;

const PARAMETERS: &[Parameter] = &[
    Parameter::spectrum("reflectance", "1", "at normal incidence").within(0.0, 1.0),
    Parameter::number("roughness", "1", "slope of the facets").within(0.0005, 1.0),
];
const LOBES: Lobes = Lobes { glossy: true, ..Lobes::NONE };
const CITATION: &str = "Walter et al., EGSR 2007; Kulla and Conty, SIGGRAPH 2017 course";

struct SingleScattering {
    facets: Ggx,
    reflectance: Vec<f64>,
}

impl Model for SingleScattering {
    const DESCRIPTION: Description = Description {
        citation: CITATION,
        lobes: LOBES,
        reciprocal: true,
        parameters: PARAMETERS,
        ..Description::new("ggx_single", "mirror facets, one reflection")
    };

    fn create(parameters: &Parameters<'_>) -> Result<Self, CreateError> {
        Ok(SingleScattering {
            facets: Ggx { roughness: parameters.number("roughness") },
            reflectance: parameters.spectrum("reflectance").to_vec(),
        })
    }

    fn value(&self, outgoing: DVec3, incident: DVec3, values: &mut [f64]) {
        self.eval_pdf(outgoing, incident, values);
    }

    fn eval_pdf(&self, outgoing: DVec3, incident: DVec3, values: &mut [f64]) -> f64 {
        let reflection = self.facets.reflect(outgoing, incident);
        for (value, reflectance) in values.iter_mut().zip(&self.reflectance) {
            *value = reflection.value * schlick(*reflectance, reflection.cosine);
        }
        reflection.pdf
    }

    fn sample_direction(&self, outgoing: DVec3, u: [f64; 3]) -> Option<DVec3> {
        (outgoing.z > 0.0).then(|| self.facets.sample(outgoing, u[0], u[1]))
    }
}

struct MultipleScattering {
    single: SingleScattering,
    albedo: AlbedoTable,
    /// Strength of the interreflection in each band: `F_ms/(π (1 − E_avg))`.
    between: Vec<f64>,
}

impl MultipleScattering {
    /// Probability of sampling the single reflection: its albedo for perfectly reflecting facets.
    fn single_share(&self, cosine: f64) -> f64 {
        self.albedo.at(cosine).clamp(0.05, 1.0)
    }
}

impl Model for MultipleScattering {
    const DESCRIPTION: Description = Description {
        citation: CITATION,
        lobes: LOBES,
        reciprocal: true,
        parameters: PARAMETERS,
        ..Description::new("ggx", "mirror facets, all reflections")
    };

    fn create(parameters: &Parameters<'_>) -> Result<Self, CreateError> {
        let single = SingleScattering::create(parameters)?;
        let albedo = AlbedoTable::new(single.facets);
        let mean = albedo.mean();
        let strength = |reflectance: &f64| {
            // Schlick's reflectance averaged over the hemisphere, weighted by the cosine.
            let facet = reflectance + (1.0 - reflectance) / 21.0;
            facet * facet * mean / (1.0 - facet * (1.0 - mean)) * FRAC_1_PI / (1.0 - mean).max(1e-9)
        };
        let between = single.reflectance.iter().map(strength).collect();
        Ok(MultipleScattering { single, albedo, between })
    }

    fn value(&self, outgoing: DVec3, incident: DVec3, values: &mut [f64]) {
        self.eval_pdf(outgoing, incident, values);
    }

    fn eval_pdf(&self, outgoing: DVec3, incident: DVec3, values: &mut [f64]) -> f64 {
        let single_pdf = self.single.eval_pdf(outgoing, incident, values);
        if outgoing.z <= 0.0 || incident.z <= 0.0 {
            return 0.0;
        }
        let lost = (1.0 - self.albedo.at(outgoing.z)) * (1.0 - self.albedo.at(incident.z));
        for (value, between) in values.iter_mut().zip(&self.between) {
            *value += between * lost;
        }
        let share = self.single_share(outgoing.z);
        share * single_pdf + (1.0 - share) * cosine_pdf(incident)
    }

    fn sample_direction(&self, outgoing: DVec3, u: [f64; 3]) -> Option<DVec3> {
        if outgoing.z <= 0.0 {
            return None;
        }
        if u[2] < self.single_share(outgoing.z) {
            self.single.sample_direction(outgoing, u)
        } else {
            Some(cosine_hemisphere(u[0], u[1]))
        }
    }

    fn sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> Sample {
        let Some(incident) = self.sample_direction(outgoing, u) else { return Sample::Absorbed };
        let pdf = self.eval_pdf(outgoing, incident, weights);
        if pdf <= 0.0 {
            return Sample::Absorbed;
        }
        weights.iter_mut().for_each(|weight| *weight *= incident.z / pdf);
        Sample::Continuous { incident, pdf }
    }
}

/// Schlick, 1994, eq. 15.
#[inline]
fn schlick(reflectance: f64, cosine: f64) -> f64 {
    let away = (1.0 - cosine).max(0.0);
    let square = away * away;
    reflectance + (1.0 - reflectance) * square * square * away
}

/// Single-scattering albedo of perfectly reflecting facets, tabulated by the square root of the
/// cosine.
struct AlbedoTable {
    nodes: Vec<f64>,
}

impl AlbedoTable {
    const INTERVALS: usize = 48;
    const AZIMUTHS: u32 = 24;
    const HEIGHTS: u32 = 48;

    fn new(facets: Ggx) -> Self {
        AlbedoTable { nodes: (0..=Self::INTERVALS).map(|node| Self::integrate(facets, node)).collect() }
    }

    /// Mean weight `G₂/G₁` of directions sampled by visible normals, over a grid of random numbers.
    /// The grid is finer in the distribution's long tail, by `u₁ = 1 − t³`.
    fn integrate(facets: Ggx, node: usize) -> f64 {
        let root = (node as f64 / Self::INTERVALS as f64).max(1e-3);
        let cosine = root * root;
        let outgoing = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
        let mut sum = 0.0;
        for row in 0..Self::HEIGHTS {
            let t = (f64::from(row) + 0.5) / f64::from(Self::HEIGHTS);
            for column in 0..Self::AZIMUTHS {
                // Half of the azimuths suffice by symmetry.
                let u0 = 0.5 * (f64::from(column) + 0.5) / f64::from(Self::AZIMUTHS);
                let incident = facets.sample(outgoing, u0, 1.0 - t * t * t);
                let reflection = facets.reflect(outgoing, incident);
                if reflection.pdf > 0.0 {
                    sum += 3.0 * t * t * reflection.value * incident.z / reflection.pdf;
                }
            }
        }
        (sum / f64::from(Self::HEIGHTS * Self::AZIMUTHS)).min(1.0)
    }

    #[inline]
    fn at(&self, cosine: f64) -> f64 {
        let place = cosine.clamp(0.0, 1.0).sqrt() * Self::INTERVALS as f64;
        let node = (place as usize).min(Self::INTERVALS - 1);
        let share = place - node as f64;
        self.nodes[node] * (1.0 - share) + self.nodes[node + 1] * share
    }

    /// `2 ∫ E(μ) μ dμ`.
    fn mean(&self) -> f64 {
        const STEPS: u32 = 2000;
        let at = |step: u32| (f64::from(step) + 0.5) / f64::from(STEPS);
        (0..STEPS).map(|step| 2.0 * self.at(at(step)) * at(step)).sum::<f64>() / f64::from(STEPS)
    }
}

radsight_brdf_sdk::export!(manual = include_str!("lib.rs"); MultipleScattering, SingleScattering);

#[cfg(test)]
mod tests {
    use super::*;

    /// At normal incidence on the roughest surface the integral is elementary: 1 − ln 2.
    #[test]
    fn one_reflection_loses_light_with_roughness() {
        let (smooth, rough) = (AlbedoTable::new(Ggx { roughness: 0.01 }), AlbedoTable::new(Ggx { roughness: 1.0 }));
        assert!((rough.at(1.0) - (1.0 - std::f64::consts::LN_2)).abs() < 1e-4, "{}", rough.at(1.0));
        assert!(smooth.at(1.0) > 0.999, "{}", smooth.at(1.0));
    }

    #[test]
    fn schlick_reflects_grazing_light() {
        assert_eq!(schlick(0.04, 1.0), 0.04);
        assert_eq!(schlick(0.04, 0.0), 1.0);
    }
}
