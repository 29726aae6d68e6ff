//! conductor: metals with measured optical constants
//!
//! Bare metal parts, from polished to ground. Colour and brightness follow from the metal and the
//! wavelengths of the rendering, not from three numbers.
//!
//! ```text
//! void brdfplugin washer
//! 3 conductor metal steel
//! 0
//! 1 .02
//!
//! void brdfplugin gold_plate
//! 2 conductor metal_nk
//! 0
//! 7 .17 .43 1.45 3.1 2.3 1.9 .05
//! ```
//!
//! | model | arguments | unit | range |
//! |---|---|---|---|
//! | `metal` | word: `steel` (stainless), `aluminium` or `copper` | | |
//! | | roughness m: root mean square slope of the facets | 1 | 0.0005 … 0.6 |
//! | `metal_nk` | n, real part of the index: red green blue | 1 | above 0 |
//! | | k, absorption: red green blue | 1 | at least 0 |
//! | | roughness m | 1 | 0.0005 … 0.6 |
//!
//! Cook and Torrance, "A Reflectance Model for Computer Graphics", ACM TOG 1(1), 1982: facets of
//! Beckmann's distribution in V-shaped grooves, `f = D G F/(4 cos θ_i cos θ_o)`. `F` is Fresnel's
//! formula for a conductor and unpolarised light; for a broad band it is averaged over the band.
//! Interreflection between facets is ignored, so rough metal is slightly too dark. The sources of n
//! and k are listed in `metals.rs`; outside the measured wavelengths (copper 0.37…1.09 µm, the
//! others 0.38…1.0 µm) the last values are used.

mod metals;

use metals::{ALUMINIUM, COPPER, STEEL, optical_constants};
use radsight_brdf_sdk::{
    CreateError, DVec3, Description, Lobes, Model, Parameter, Parameters, Sample, fresnel_conductor, sample_band,
};
use std::f64::consts::{PI, TAU};

const ROUGHNESS: Parameter = Parameter::number("roughness", "1", "rms slope of the facets").within(0.0005, 0.6);
const LOBES: Lobes = Lobes { glossy: true, ..Lobes::NONE };
const CITATION: &str = "Cook and Torrance, ACM TOG 1(1), 1982";

/// Microfacets of a metal.
struct CookTorrance {
    roughness: f64,
    /// For each band the optical constants over whose reflectances it averages.
    bands: Vec<Vec<(f64, f64)>>,
}

impl CookTorrance {
    /// Beckmann's density of facet normals, 1/sr: `exp(−tan²δ/m²)/(π m² cos⁴δ)`.
    fn density(&self, half: DVec3) -> f64 {
        let variance = self.roughness * self.roughness;
        let cosine_squared = half.z * half.z;
        let tan_squared = (half.x * half.x + half.y * half.y) / cosine_squared;
        (-tan_squared / variance).exp() / (PI * variance * cosine_squared * cosine_squared)
    }

    fn eval_pdf(&self, outgoing: DVec3, incident: DVec3, values: &mut [f64]) -> f64 {
        if outgoing.z <= 0.0 || incident.z <= 0.0 {
            values.fill(0.0);
            return 0.0;
        }
        let sum = outgoing + incident;
        let half = sum.normalize();
        // For unit vectors h·o = |o + i|/2.
        let cosine = (0.5 * sum.length()).min(1.0);
        let density = self.density(half);
        let shadow = (2.0 * half.z * outgoing.z.min(incident.z) / cosine).min(1.0);
        let shape = density * shadow / (4.0 * outgoing.z * incident.z);
        for (value, constants) in values.iter_mut().zip(&self.bands) {
            let sum: f64 = constants.iter().map(|&(n, k)| fresnel_conductor(cosine, n, k)).sum();
            *value = shape * sum / constants.len() as f64;
        }
        density * half.z / (4.0 * cosine)
    }

    /// Samples by reflection at a facet with density `D cos δ`.
    fn sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> Sample {
        let tan = self.roughness * (-(1.0 - u[0]).ln()).sqrt();
        let (sin, cos) = (TAU * u[1]).sin_cos();
        let half = DVec3::new(tan * cos, tan * sin, 1.0).normalize();
        let incident = (half * (2.0 * half.dot(outgoing)) - outgoing).normalize();
        let pdf = self.eval_pdf(outgoing, incident, weights);
        if pdf <= 0.0 {
            return Sample::Absorbed;
        }
        weights.iter_mut().for_each(|weight| *weight *= incident.z / pdf);
        Sample::Continuous { incident, pdf }
    }
}

/// Both models differ only in the source of n and k.
macro_rules! cook_torrance {
    ($name:ident, $description:expr, $create:expr) => {
        struct $name(CookTorrance);

        impl Model for $name {
            const DESCRIPTION: Description = $description;

            fn create(parameters: &Parameters<'_>) -> Result<Self, CreateError> {
                let roughness = parameters.number("roughness");
                Ok($name(CookTorrance { roughness, bands: $create(parameters) }))
            }

            fn value(&self, outgoing: DVec3, incident: DVec3, values: &mut [f64]) {
                self.0.eval_pdf(outgoing, incident, values);
            }

            fn eval_pdf(&self, outgoing: DVec3, incident: DVec3, values: &mut [f64]) -> f64 {
                self.0.eval_pdf(outgoing, incident, values)
            }

            fn sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> Sample {
                self.0.sample(outgoing, u, weights)
            }
        }
    };
}

cook_torrance!(
    Metal,
    Description {
        citation: CITATION,
        lobes: LOBES,
        reciprocal: true,
        parameters: &[Parameter::choice("metal", "steel|aluminium|copper", "whose n and k"), ROUGHNESS],
        ..Description::new("metal", "a measured metal")
    },
    measured
);

cook_torrance!(
    MetalNk,
    Description {
        citation: CITATION,
        lobes: LOBES,
        reciprocal: true,
        parameters: &[
            Parameter::spectrum("n", "1", "real part of the index of refraction").above(0.0),
            Parameter::spectrum("k", "1", "imaginary part of the index of refraction").at_least(0.0),
            ROUGHNESS,
        ],
        ..Description::new("metal_nk", "a metal with given n and k")
    },
    given
);

fn measured(parameters: &Parameters<'_>) -> Vec<Vec<(f64, f64)>> {
    let table = match parameters.word("metal") {
        "aluminium" => ALUMINIUM,
        "copper" => COPPER,
        _ => STEEL,
    };
    let of_band = |band| sample_band(band).into_iter().map(|wavelength| optical_constants(table, wavelength)).collect();
    parameters.bands().iter().map(of_band).collect()
}

fn given(parameters: &Parameters<'_>) -> Vec<Vec<(f64, f64)>> {
    let (n, k) = (parameters.spectrum("n"), parameters.spectrum("k"));
    n.iter().zip(k).map(|(&n, &k)| vec![(n, k)]).collect()
}

radsight_brdf_sdk::export!(manual = include_str!("lib.rs"); Metal, MetalNk);

#[cfg(test)]
mod tests {
    use super::*;
    use radsight_brdf_sdk::Band;

    fn reflectance(table: &[(f64, f64, f64)], wavelength_m: f64) -> f64 {
        let (n, k) = optical_constants(table, wavelength_m);
        fresnel_conductor(1.0, n, k)
    }

    /// Handbook values: copper is red, aluminium reflects nine tenths, stainless steel two thirds.
    #[test]
    fn metals_have_their_reflectance_and_colour() {
        assert!((reflectance(COPPER, 650e-9) - 0.94).abs() < 0.02, "{}", reflectance(COPPER, 650e-9));
        assert!((reflectance(COPPER, 450e-9) - 0.54).abs() < 0.03, "{}", reflectance(COPPER, 450e-9));
        assert!((reflectance(ALUMINIUM, 550e-9) - 0.92).abs() < 0.01, "{}", reflectance(ALUMINIUM, 550e-9));
        assert!((reflectance(STEEL, 650e-9) - 0.67).abs() < 0.02, "{}", reflectance(STEEL, 650e-9));
    }

    #[test]
    fn constants_are_interpolated_and_kept_beyond_the_ends() {
        let table = [(400.0, 1.0, 3.0), (500.0, 2.0, 5.0)];
        let (n, k) = optical_constants(&table, 450e-9);
        assert!((n - 1.5).abs() < 1e-9 && (k - 4.0).abs() < 1e-9);
        assert_eq!(optical_constants(&table, 100e-9), (1.0, 3.0));
        assert_eq!(optical_constants(&table, 900e-9), (2.0, 5.0));
    }

    #[test]
    fn a_narrow_band_has_the_reflectance_of_its_wavelength() {
        let band = [Band { centre_m: 650e-9, low_m: 648e-9, high_m: 652e-9 }];
        let washer = Metal::create(&Parameters::new::<Metal>(&[0.1], &["steel"], &band)).unwrap();
        let mut value = [0.0];
        washer.value(DVec3::Z, DVec3::Z, &mut value);
        let right = reflectance(STEEL, 650e-9) / (4.0 * PI * 0.01);
        assert!((value[0] / right - 1.0).abs() < 1e-12);
    }
}
