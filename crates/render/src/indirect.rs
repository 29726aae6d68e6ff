//! Light from diffuse surroundings: the one place that decides how it is found.

use crate::trace::PathIntegrator;
use radsight_texture::bands;

/// How diffuse surroundings are found at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Indirect {
    /// Rays are drawn from the diffuse component and followed.
    Followed,
    /// They are taken to have the constant ambient value, as where the last bounce is used up.
    Constant,
}

impl Indirect {
    /// At a point from which this many bounces may still be followed.
    pub(crate) fn after(bounces: u32) -> Indirect {
        if bounces == 0 { Indirect::Constant } else { Indirect::Followed }
    }
}

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// Adds what a diffuse reflectance makes of the ambient value.
    pub(crate) fn add_constant(&self, radiance: &mut [f64; BANDS], diffuse: &[f64; BANDS]) {
        let ambient: [f64; BANDS] = bands(self.plan.options.ambient_value);
        for (sum, (diffuse, ambient)) in radiance.iter_mut().zip(diffuse.iter().zip(ambient)) {
            *sum += diffuse * ambient;
        }
    }
}
