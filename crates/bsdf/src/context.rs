//! What a scattering material is asked with, and what it answers.

use crate::bsdf::Bsdf;
use crate::frame::Frame;
use crate::function_lobe::Surroundings;
use glam::DVec3;
use radsight_cal::Scratch;
use radsight_ir::Scene;
use radsight_texture::{Appearance, Function, SurfaceInteraction, gathered};

/// A ray at a scattering material.
#[derive(Clone, Copy, Debug)]
pub struct BsdfContext<'a, const BANDS: usize> {
    /// With the tables and pictures that the material's handles name.
    pub scene: &'a Scene,
    /// As the surface faces.
    pub interaction: &'a SurfaceInteraction,
    /// As if the surface faced the viewer.
    pub turned: &'a SurfaceInteraction,
    /// What patterns and textures make of the surface there.
    pub appearance: Appearance<BANDS>,
    /// Unit, with textures, on the viewer's side.
    pub normal: DVec3,
    /// Highlights of no more than this share are not drawn from.
    pub threshold: f64,
}

/// What a material makes of a ray.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceScattering<'a, const BANDS: usize> {
    /// All that is spread over directions.
    pub point: Bsdf<'a, BANDS>,
    /// The mirror image.
    pub mirror: Option<SpecularBounce<BANDS>>,
    /// The way straight through.
    pub straight: Option<SpecularBounce<BANDS>>,
}

/// A ray that goes on from a perfectly specular event.
#[derive(Clone, Copy, Debug)]
pub struct SpecularBounce<const BANDS: usize> {
    /// Unit.
    pub direction: DVec3,
    /// The share of radiance that comes back along the ray, by band.
    pub weight: [f64; BANDS],
}

/// Directions nearer to the surface than this cosine do not count as leaving it (Radiance's).
const GRAZING: f64 = 1e-6;

impl<'a, const BANDS: usize> BsdfContext<'a, BANDS> {
    /// What a function of the material sees, with this colour in its variables.
    pub fn surroundings(&self, color: [f64; BANDS]) -> Surroundings<'a> {
        Surroundings {
            interaction: self.interaction,
            normal: self.normal,
            cosine: self.outgoing().dot(self.normal),
            color: gathered(&color),
        }
    }

    /// Unit, towards the viewer.
    pub fn outgoing(&self) -> DVec3 {
        -self.interaction.direction
    }

    /// The material's colour under its patterns.
    pub fn colored(&self, own: [f64; BANDS]) -> [f64; BANDS] {
        std::array::from_fn(|band| own[band] * self.appearance.color[band])
    }

    /// Where light goes straight through; a texture bends it, unless it would come back.
    pub fn straight(&self) -> DVec3 {
        let direction = self.interaction.direction;
        if self.appearance.perturbation == DVec3::ZERO || self.interaction.is_smoothed() {
            return direction;
        }
        let bent = direction - self.appearance.perturbation;
        if bent.dot(self.interaction.normal) < -GRAZING { bent.normalize() } else { direction }
    }

    /// The frame on the shading normal that an orientation function gives; none where that is parallel to the normal, or fails.
    pub fn oriented(&self, orientation: &Function, scratch: &mut Scratch) -> Option<Frame> {
        let mut vector = [0.0; 3];
        orientation.program.eval_all(&[], &orientation.view(self.turned), scratch, &mut vector).ok()?;
        Frame::along(self.normal, orientation.in_scene(self.turned, DVec3::from_array(vector)))
    }
}

impl<const BANDS: usize> SpecularBounce<BANDS> {
    /// None where it carries nothing.
    pub fn new(direction: DVec3, weight: [f64; BANDS]) -> Option<SpecularBounce<BANDS>> {
        let weight = weight.map(|band| if band.is_finite() { band.max(0.0) } else { 0.0 });
        weight.iter().any(|band| *band > 0.0).then_some(SpecularBounce { direction, weight })
    }
}
