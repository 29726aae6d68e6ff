//! Result of patterns and textures at an intersection.

use glam::DVec3;

/// Result of patterns and textures at an intersection.
#[derive(Clone, Copy, Debug)]
pub struct Appearance<const BANDS: usize> {
    /// Factor of the material's colour, by band.
    pub color: [f64; BANDS],
    /// Perturbation of the unit normal, on the side from which the ray comes.
    pub perturbation: DVec3,
}
