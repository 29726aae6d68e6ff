//! Indirect diffuse light: the one decision about how it is computed.

use crate::trace::PathIntegrator;
use radsight_texture::bands;

/// How indirect diffuse light is computed at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Indirect {
    /// Rays are sampled from the diffuse component.
    Followed,
    /// The constant ambient value replaces it, as after the last bounce.
    Constant,
}

impl Indirect {
    /// At a point with this number of remaining bounces.
    pub(crate) fn after(bounces: u32) -> Indirect {
        if bounces == 0 { Indirect::Constant } else { Indirect::Followed }
    }
}

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// Adds the ambient value times a diffuse reflectance.
    pub(crate) fn add_constant(&self, radiance: &mut [f64; BANDS], diffuse: &[f64; BANDS]) {
        let ambient: [f64; BANDS] = bands(self.plan.options.ambient_value);
        for (sum, (diffuse, ambient)) in radiance.iter_mut().zip(diffuse.iter().zip(ambient)) {
            *sum += diffuse * ambient;
        }
    }
}
