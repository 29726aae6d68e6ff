//! Models of one lobe: a scale in each band times a shape.

use crate::{BrdfSample, Density};
use glam::DVec3;

/// A lobe about a direction. Its value is `scale` times the value of its shape.
pub(crate) trait Lobe<const BANDS: usize> {
    /// Reflectance or transmittance, in each band.
    fn scale(&self) -> &[f64; BANDS];

    /// `f/scale` in 1/sr, and the density of sampling in 1/sr. Both are zero for an outgoing or
    /// incident direction on the wrong side.
    fn shape(&self, outgoing: DVec3, incident: DVec3) -> (f64, f64);

    /// [`crate::Brdf::eval_pdf`].
    fn eval_lobe(&self, outgoing: DVec3, incident: &[DVec3], values: &mut [f64], pdfs: &mut [f64]) {
        for ((direction, value), pdf) in incident.iter().zip(values.chunks_exact_mut(BANDS)).zip(pdfs) {
            let (shape, density) = self.shape(outgoing, *direction);
            *pdf = density;
            for (value, scale) in value.iter_mut().zip(self.scale()) {
                *value = scale * shape;
            }
        }
    }

    /// The weight of a sampled direction, `f·|cos θ_i|` over its density; `None` on the wrong side.
    fn weigh(&self, outgoing: DVec3, incident: DVec3, weights: &mut [f64]) -> Option<BrdfSample> {
        let (shape, density) = self.shape(outgoing, incident);
        if density <= 0.0 {
            return None;
        }
        for (weight, scale) in weights.iter_mut().zip(self.scale()) {
            *weight = scale * shape * incident.z.abs() / density;
        }
        Some(BrdfSample { incident, density: Density::Continuous(density) })
    }
}
