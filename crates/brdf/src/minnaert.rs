//! Matte surfaces darker towards the edge than Lambert's: velvet, dark planets.
//!
//! M. Minnaert, "The reciprocity principle in lunar photometry", The Astrophysical Journal 93,
//! 1941: `f = ρ (k+1)/(2π) (cos θ_i cos θ_o)^(k−1)`, with k = 1 for Lambert's surface. The albedo
//! is `ρ cos^(k−1) θ_o`, at most ρ.

use crate::native_model::{NativeModel, Parameter, REFLECTANCE};
use crate::{Brdf, BrdfSample, Density, Lobes};
use glam::DVec3;
use std::f64::consts::TAU;
use std::sync::Arc;

/// The entry in the list of built-in models.
pub(crate) const MODEL: NativeModel = NativeModel {
    name: "minnaert",
    summary: "matte, darker towards the edge than Lambert's model (Minnaert 1941)",
    parameters: &[
        REFLECTANCE[0],
        REFLECTANCE[1],
        REFLECTANCE[2],
        Parameter::required("k", "1", [1.0, 8.0], "limb darkening: 1 is Lambert's model"),
    ],
    make: |numbers, bands| Arc::new(Minnaert { reflectance: numbers[..bands].to_vec(), k: numbers[3] }),
};

#[derive(Clone, Debug)]
struct Minnaert {
    /// ρ, in each band.
    reflectance: Vec<f64>,
    k: f64,
}

impl Brdf for Minnaert {
    fn lobes(&self) -> Lobes {
        Lobes { diffuse: true, ..Lobes::default() }
    }

    fn eval_pdf(&self, outgoing: DVec3, incident: &[DVec3], values: &mut [f64], pdfs: &mut [f64]) {
        let bands = self.reflectance.len();
        for ((direction, values), pdf) in incident.iter().zip(values.chunks_exact_mut(bands)).zip(pdfs) {
            let is_reflected = outgoing.z > 0.0 && direction.z > 0.0;
            let norm = if is_reflected { (self.k + 1.0) / TAU } else { 0.0 };
            *pdf = norm * direction.z.max(0.0).powf(self.k);
            let shape = norm * (direction.z * outgoing.z).max(0.0).powf(self.k - 1.0);
            values.iter_mut().zip(&self.reflectance).for_each(|(value, reflectance)| *value = reflectance * shape);
        }
    }

    /// Directions with the density `(k+1)/(2π) cos^k θ_i`.
    fn sample(&self, outgoing: DVec3, [u, v, _]: [f64; 3], weights: &mut [f64]) -> Option<BrdfSample> {
        let cosine = (1.0 - u).powf(1.0 / (self.k + 1.0));
        let (sine, (sin, cos)) = ((1.0 - cosine * cosine).max(0.0).sqrt(), (TAU * v).sin_cos());
        if outgoing.z <= 0.0 || cosine <= 0.0 {
            return None;
        }
        let albedo = outgoing.z.powf(self.k - 1.0);
        weights.iter_mut().zip(&self.reflectance).for_each(|(weight, reflectance)| *weight = reflectance * albedo);
        let density = Density::Continuous((self.k + 1.0) / TAU * cosine.powf(self.k));
        Some(BrdfSample { incident: DVec3::new(sine * cos, sine * sin, cosine), density })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_integral_of_the_value_is_the_analytic_albedo() {
        let model = Minnaert { reflectance: vec![0.7], k: 2.5 };
        let outgoing = DVec3::new(0.8, 0.0, 0.6);
        let count = 4000;
        // Rings of equal cosine; the value does not depend on the azimuth.
        let integral: f64 = (0..count)
            .map(|ring| {
                let cosine = (f64::from(ring) + 0.5) / f64::from(count);
                let incident = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
                let mut value = [0.0];
                model.eval_pdf(outgoing, &[incident], &mut value, &mut [0.0]);
                value[0] * cosine * TAU / f64::from(count)
            })
            .sum();
        assert!((integral - 0.7 * 0.6f64.powf(1.5)).abs() < 1e-6, "{integral}");
    }
}
