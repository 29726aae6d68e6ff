//! Result of patterns and textures at an intersection.

use glam::DVec3;

/// Result of patterns and textures at an intersection.
#[derive(Clone, Copy, Debug)]
pub struct Appearance<const BANDS: usize> {
    /// Factor of the material's colour, by band.
    pub color: [f64; BANDS],
    /// Perturbation of the unit normal, on the side from which the ray comes.
    pub perturbation: DVec3,
    /// Whether the perturbation turns transmitted rays too.
    pub transmitted: TransmittedRays,
}

/// What a perturbed normal does to rays that a thin sheet transmits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TransmittedRays {
    /// Turns them: the sheet has a relief.
    #[default]
    Turned,
    /// Nothing: the normal only smooths the facets of a curved surface.
    Straight,
}

impl<const BANDS: usize> Appearance<BANDS> {
    /// The perturbation as far as it turns rays that a thin sheet transmits.
    pub fn turn(&self) -> DVec3 {
        match self.transmitted {
            TransmittedRays::Turned => self.perturbation,
            TransmittedRays::Straight => DVec3::ZERO,
        }
    }
}
