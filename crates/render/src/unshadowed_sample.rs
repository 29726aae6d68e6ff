//! Light samples of a point before their shadow rays.

use radsight_compile::VisibilityClass;
use radsight_light::{Light, LightSample};

/// A light sample whose shadow ray was not traced yet.
#[derive(Debug)]
pub(crate) struct UnshadowedSample<'p, const BANDS: usize> {
    pub(crate) light: &'p Light,
    pub(crate) between: &'p VisibilityClass,
    pub(crate) sample: LightSample,
    pub(crate) weight: [f64; BANDS],
    pub(crate) radiance: [f64; BANDS],
    /// Its contribution, summed over the bands.
    pub(crate) strength: f64,
}

impl<const BANDS: usize> UnshadowedSample<'_, BANDS> {
    /// Whether its shadow ray is traced in any case: it costs nothing, or what it brings is unknown.
    pub(crate) fn is_kept(&self) -> bool {
        self.light.is_redirected() || matches!(self.between, VisibilityClass::Nothing)
    }
}
