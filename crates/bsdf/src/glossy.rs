//! `plastic` and `metal`.

use radsight_ir::Rgb;

/// Slopes below this are perfectly smooth to Radiance (its α² ≤ 1e-6).
pub(crate) const SMOOTH_ROUGHNESS: f64 = 1e-3;

/// A plastic or a metal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlossyKind {
    /// Of the material, before patterns.
    pub color: Rgb,
    /// Share of what is reflected that is specular, 0…1.
    pub specularity: f64,
    /// Root mean square slope of the surface.
    pub roughness: f64,
    /// Highlights take the material's colour.
    pub metallic: bool,
}

impl GlossyKind {
    /// Whether its highlight is a mirror image.
    pub fn is_smooth(&self) -> bool {
        self.roughness <= SMOOTH_ROUGHNESS
    }
}
