//! `plastic` and `metal`.

use radsight_ir::Rgb;

/// A root mean square slope below this is perfectly smooth in Radiance (its α² ≤ 1e-6).
pub(crate) const SMOOTH_ROUGHNESS: f64 = 1e-3;

/// A plastic or a metal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlossyKind {
    /// Colour of the material, before patterns.
    pub color: Rgb,
    /// Fraction of the reflected light that is specular, 0…1.
    pub specularity: f64,
    /// Root mean square slope of the surface.
    pub roughness: f64,
    /// Whether the highlight takes the material's colour.
    pub metallic: bool,
}

impl GlossyKind {
    /// Whether the highlight is a perfect mirror reflection.
    pub fn is_smooth(&self) -> bool {
        self.roughness <= SMOOTH_ROUGHNESS
    }
}
