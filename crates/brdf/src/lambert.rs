//! Ideal diffuse reflection. Lambert, *Photometria*, 1760: `f = ρ/π`.

use crate::native_model::{NativeModel, REFLECTANCE};
use crate::{Brdf, BrdfSample, Density, Lobes};
use glam::DVec3;
use radsight_sampling::cosine_hemisphere;
use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

/// The entry in the list of built-in models.
pub(crate) const MODEL: NativeModel = NativeModel {
    name: "lambert",
    summary: "matte: the same radiance in all directions",
    parameters: &REFLECTANCE,
    make: |numbers, bands| match bands {
        1 => Arc::new(Lambert { reflectance: [numbers[0]] }),
        _ => Arc::new(Lambert { reflectance: [numbers[0], numbers[1], numbers[2]] }),
    },
};

/// Reflects equal radiance into all directions of the front side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lambert<const BANDS: usize> {
    /// ρ, in each band.
    pub reflectance: [f64; BANDS],
}

impl<const BANDS: usize> Brdf for Lambert<BANDS> {
    fn lobes(&self) -> Lobes {
        Lobes { diffuse: true, ..Lobes::default() }
    }

    fn eval_pdf(&self, outgoing: DVec3, incident: &[DVec3], values: &mut [f64], pdfs: &mut [f64]) {
        for ((direction, value), pdf) in incident.iter().zip(values.chunks_exact_mut(BANDS)).zip(pdfs) {
            let lit = outgoing.z > 0.0 && direction.z > 0.0;
            *pdf = if lit { direction.z * FRAC_1_PI } else { 0.0 };
            for (value, reflectance) in value.iter_mut().zip(self.reflectance) {
                *value = if lit { reflectance * FRAC_1_PI } else { 0.0 };
            }
        }
    }

    fn sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> Option<BrdfSample> {
        let incident = DVec3::from_array(cosine_hemisphere(u[0], u[1]));
        if outgoing.z <= 0.0 || incident.z <= 0.0 {
            return None;
        }
        weights.copy_from_slice(&self.reflectance);
        Some(BrdfSample { incident, density: Density::Continuous(incident.z * FRAC_1_PI) })
    }
}
