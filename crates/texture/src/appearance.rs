//! What patterns and textures make of a surface.

use glam::DVec3;

/// What patterns and textures make of an interaction.
#[derive(Clone, Copy, Debug)]
pub struct Appearance<const BANDS: usize> {
    /// Multiplies the material's colour.
    pub color: [f64; BANDS],
    /// Added to the unit normal on the side from which the ray comes.
    pub perturbation: DVec3,
}
