//! oren_nayar: rough diffuse surfaces
//!
//! Plaster, concrete, sand, cloth, the moon: surfaces of Lambertian facets, which look flatter
//! towards the edge than Lambert's model, and brighter in the direction of the light.
//!
//! ```text
//! void brdfplugin plaster
//! 2 oren_nayar oren_nayar
//! 0
//! 4 .7 .7 .65 .35
//!
//! void brdfplugin chalk
//! 2 oren_nayar eon
//! 0
//! 4 1 1 1 .8
//! ```
//!
//! | model | arguments | unit | range |
//! |---|---|---|---|
//! | `oren_nayar` | reflectance ρ of the facets: red green blue | 1 | 0 … 0.98 |
//! | | roughness σ: standard deviation of the facets' slope angle | rad | 0 … π/2 |
//! | `eon` | reflectance ρ of the facets: red green blue | 1 | 0 … 1 |
//! | | roughness r | 1 | 0 … 1 |
//!
//! `oren_nayar` is the "qualitative model" of Oren and Nayar, "Generalization of Lambert's
//! Reflectance Model", SIGGRAPH 1994, eq. 30. At grazing angles it reflects up to 1.52 % more than
//! ρ, hence the limit 0.98 of ρ. Interreflection between facets is ignored.
//!
//! `eon` conserves energy at every angle and includes interreflection between facets: Portsmouth,
//! Kutz and Hill, "EON: A Practical Energy-Preserving Rough Diffuse BRDF", JCGT 14(1), 2025, after
//! Fujii's improvement of the same model. With ρ = 1 it reflects all light exactly.
//!
//! With roughness 0 both are Lambert's model.

use radsight_brdf_sdk::{CreateError, DVec3, Description, Lobes, Model, Parameter, Parameters};
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI};

struct OrenNayar {
    reflectance: Vec<f64>,
    a: f64,
    b: f64,
}

impl Model for OrenNayar {
    const DESCRIPTION: Description = Description {
        citation: "Oren and Nayar, SIGGRAPH 1994, eq. 30",
        lobes: Lobes { diffuse: true, ..Lobes::NONE },
        reciprocal: true,
        parameters: &[
            Parameter::spectrum("reflectance", "1", "reflectance of the facets").within(0.0, 0.98),
            Parameter::number("roughness", "rad", "standard deviation of the facets' slope angle")
                .within(0.0, FRAC_PI_2),
        ],
        ..Description::new("oren_nayar", "rough matte surface, one bounce")
    };

    fn create(parameters: &Parameters<'_>) -> Result<Self, CreateError> {
        let variance = parameters.number("roughness").powi(2);
        Ok(OrenNayar {
            reflectance: parameters.spectrum("reflectance").to_vec(),
            a: 1.0 - 0.5 * variance / (variance + 0.33),
            b: 0.45 * variance / (variance + 0.09),
        })
    }

    /// `ρ/π (A + B max(0, cos(φ_i − φ_o)) sin α tan β)`, with α the larger and β the smaller of the
    /// two angles from the normal.
    fn value(&self, outgoing: DVec3, incident: DVec3, values: &mut [f64]) {
        if outgoing.z <= 0.0 || incident.z <= 0.0 {
            return values.fill(0.0);
        }
        // sin θ_o sin θ_i cos(φ_i − φ_o); sin α tan β divides it by the larger cosine.
        let along = outgoing.x * incident.x + outgoing.y * incident.y;
        let shape = FRAC_1_PI * (self.a + self.b * along.max(0.0) / outgoing.z.max(incident.z));
        for (value, reflectance) in values.iter_mut().zip(&self.reflectance) {
            *value = reflectance * shape;
        }
    }
}

struct Eon {
    /// ρ and the strength of the interreflection, in each band.
    bands: Vec<(f64, f64)>,
    roughness: f64,
    /// A = 1/(1 + (1/2 − 2/(3π)) r).
    a: f64,
}

impl Eon {
    /// Single-bounce albedo for a direction with this cosine and ρ = 1.
    fn albedo(&self, cosine: f64) -> f64 {
        let sine_squared = (1.0 - cosine * cosine).max(0.0);
        let sine = sine_squared.sqrt();
        let angle = sine.atan2(cosine);
        // (2/3) (tan θ (1 − sin³ θ) − sin θ), without cancellation at the horizon: 1 − sin³ = cos²
        // (1 + s + s²)/(1 + s).
        let tangent_part = sine * cosine * (1.0 + sine + sine_squared) / (1.0 + sine);
        let g = sine * (angle - sine * cosine) + 2.0 / 3.0 * (tangent_part - sine);
        self.a * (1.0 + self.roughness * FRAC_1_PI * g)
    }

    fn mean_albedo(&self) -> f64 {
        self.a * (1.0 + self.roughness * (2.0 / 3.0 - 28.0 / (15.0 * PI)))
    }
}

impl Model for Eon {
    const DESCRIPTION: Description = Description {
        citation: "Portsmouth, Kutz and Hill, JCGT 14(1), 2025",
        lobes: Lobes { diffuse: true, ..Lobes::NONE },
        reciprocal: true,
        parameters: &[
            Parameter::spectrum("reflectance", "1", "reflectance of the facets").within(0.0, 1.0),
            Parameter::number("roughness", "1", "0 is Lambert's model").within(0.0, 1.0),
        ],
        ..Description::new("eon", "rough matte surface, all bounces")
    };

    fn create(parameters: &Parameters<'_>) -> Result<Self, CreateError> {
        let roughness = parameters.number("roughness");
        let mut model = Eon { bands: Vec::new(), roughness, a: 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * PI)) * roughness) };
        let mean = model.mean_albedo();
        // Light after several bounces: ρ² ⟨E⟩/(1 − ρ (1 − ⟨E⟩)), normalised by 1/(1 − ⟨E⟩).
        let lost = (1.0 - mean).max(1e-12);
        let between = |rho: f64| rho * rho * mean / (1.0 - rho * (1.0 - mean)) / lost;
        model.bands = parameters.spectrum("reflectance").iter().map(|&rho| (rho, between(rho))).collect();
        Ok(model)
    }

    fn value(&self, outgoing: DVec3, incident: DVec3, values: &mut [f64]) {
        if outgoing.z <= 0.0 || incident.z <= 0.0 {
            return values.fill(0.0);
        }
        let along = outgoing.x * incident.x + outgoing.y * incident.y;
        let ratio = if along > 0.0 { along / outgoing.z.max(incident.z) } else { along };
        let single = self.a * (1.0 + self.roughness * ratio);
        let lost = |cosine| (1.0 - self.albedo(cosine)).max(0.0);
        let between_shape = lost(outgoing.z) * lost(incident.z);
        for (value, (rho, between)) in values.iter_mut().zip(&self.bands) {
            *value = FRAC_1_PI * (rho * single + between * between_shape);
        }
    }
}

radsight_brdf_sdk::export!(manual = include_str!("lib.rs"); OrenNayar, Eon);

#[cfg(test)]
mod tests {
    use super::*;
    use radsight_brdf_sdk::Band;

    const BAND: [Band; 1] = [Band { centre_m: 650e-9, low_m: 640e-9, high_m: 660e-9 }];

    /// `∫ f cos θ_i dω_i` by the midpoint rule in θ and φ.
    fn albedo<M: Model>(model: &M, degrees: f64) -> f64 {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let (rows, columns) = (400, 400);
        let mut sum = 0.0;
        for row in 0..rows {
            let theta = FRAC_PI_2 * (f64::from(row) + 0.5) / f64::from(rows);
            for column in 0..columns {
                let phi = PI * (f64::from(column) + 0.5) / f64::from(columns);
                let incident = DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
                let mut value = [0.0];
                model.value(DVec3::new(sin, 0.0, cos), incident, &mut value);
                sum += value[0] * theta.sin() * theta.cos();
            }
        }
        sum * FRAC_PI_2 / f64::from(rows) * 2.0 * PI / f64::from(columns)
    }

    #[test]
    fn white_eon_reflects_everything_at_every_angle_and_roughness() {
        for roughness in [0.0, 0.3, 1.0] {
            let model = Eon::create(&Parameters::new::<Eon>(&[1.0, roughness], &[], &BAND)).unwrap();
            for degrees in [0.0, 30.0, 60.0, 85.0] {
                let found = albedo(&model, degrees);
                assert!((found - 1.0).abs() < 3e-4, "roughness {roughness}, {degrees}°: {found}");
            }
        }
    }

    #[test]
    fn without_roughness_it_is_lamberts_model() {
        let model = OrenNayar::create(&Parameters::new::<OrenNayar>(&[0.5, 0.0], &[], &BAND)).unwrap();
        let mut value = [0.0];
        model.value(DVec3::new(0.8, 0.0, 0.6), DVec3::new(0.6, 0.0, 0.8), &mut value);
        assert!((value[0] - 0.5 * FRAC_1_PI).abs() < 1e-15);
    }

    /// The case of Oren and Nayar's figure 9: σ = 30°, seen from the direction of the light at 75°.
    #[test]
    fn backscattering_is_brighter_than_forward_scattering() {
        let sigma = 30f64.to_radians();
        let model = OrenNayar::create(&Parameters::new::<OrenNayar>(&[0.9, sigma], &[], &BAND)).unwrap();
        let (sin, cos) = 75f64.to_radians().sin_cos();
        let light = DVec3::new(sin, 0.0, cos);
        let (mut back, mut forward) = ([0.0], [0.0]);
        model.value(light, light, &mut back);
        model.value(DVec3::new(-sin, 0.0, cos), light, &mut forward);
        let variance = sigma * sigma;
        let (a, b) = (1.0 - 0.5 * variance / (variance + 0.33), 0.45 * variance / (variance + 0.09));
        assert!((back[0] / (0.9 * FRAC_1_PI) - (a + b * sin * sin / cos)).abs() < 1e-12);
        assert!((forward[0] / (0.9 * FRAC_1_PI) - a).abs() < 1e-12);
    }
}
