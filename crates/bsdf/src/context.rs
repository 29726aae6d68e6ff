//! Input and result of evaluating a scattering material.

use crate::bsdf::Bsdf;
use crate::frame::Frame;
use crate::function_lobe::Surroundings;
use glam::DVec3;
use radsight_cal::Scratch;
use radsight_ir::Scene;
use radsight_texture::{Appearance, Function, SurfaceInteraction, gathered, not_negative};

/// A ray at a surface of a scattering material.
#[derive(Clone, Copy, Debug)]
pub struct BsdfContext<'a, const BANDS: usize> {
    /// The scene, whose tables and pictures the material's handles refer to.
    pub scene: &'a Scene,
    /// The intersection, with the surface's own orientation.
    pub interaction: &'a SurfaceInteraction,
    /// The same intersection, turned so that the surface faces the viewer.
    pub turned: &'a SurfaceInteraction,
    /// Patterns and textures, evaluated at the intersection.
    pub appearance: Appearance<BANDS>,
    /// Unit shading normal on the viewer's side, textures included.
    pub normal: DVec3,
    /// Specular threshold (`-st`): highlights up to this albedo are not sampled.
    pub threshold: f64,
}

/// How a material scatters at an intersection.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceScattering<'a, const BANDS: usize> {
    /// The BSDF without its perfectly specular parts.
    pub point: Bsdf<'a, BANDS>,
    /// The mirror reflection.
    pub mirror: Option<SpecularBounce<BANDS>>,
    /// The straight-through transmission.
    pub straight: Option<SpecularBounce<BANDS>>,
}

/// A perfectly specular bounce.
#[derive(Clone, Copy, Debug)]
pub struct SpecularBounce<const BANDS: usize> {
    /// Unit vector along which the path continues.
    pub direction: DVec3,
    /// Factor of the radiance that comes back along the ray, by band.
    pub weight: [f64; BANDS],
}

/// A direction whose cosine to the surface is smaller does not leave it (Radiance's).
const GRAZING: f64 = 1e-6;

impl<'a, const BANDS: usize> BsdfContext<'a, BANDS> {
    /// Variables of the material's functions, with this colour.
    pub fn surroundings(&self, color: [f64; BANDS]) -> Surroundings<'a> {
        Surroundings {
            interaction: self.interaction,
            normal: self.normal,
            cosine: self.outgoing().dot(self.normal),
            color: gathered(&color),
        }
    }

    /// Unit vector towards the viewer.
    pub fn outgoing(&self) -> DVec3 {
        -self.interaction.direction
    }

    /// Product of the material's own colour and its patterns, at least 0.
    pub fn colored(&self, own: [f64; BANDS]) -> [f64; BANDS] {
        not_negative(std::array::from_fn(|band| own[band] * self.appearance.color[band]))
    }

    /// Direction of straight-through transmission. A texture turns it, unless it would come back.
    pub fn straight(&self) -> DVec3 {
        let direction = self.interaction.direction;
        let turn = self.appearance.turn();
        if turn == DVec3::ZERO {
            return direction;
        }
        let turned = direction - turn;
        if turned.dot(self.interaction.normal) < -GRAZING { turned.normalize() } else { direction }
    }

    /// The same for materials that let a texture turn rays back, as `BRTDfunc` does in Radiance.
    pub fn straight_or_back(&self) -> DVec3 {
        let (direction, turn) = (self.interaction.direction, self.appearance.turn());
        if turn == DVec3::ZERO { direction } else { (direction - turn).normalize_or(direction) }
    }

    /// Frame on the shading normal with x along an orientation function's vector; none if the
    /// function fails or the vector is parallel to the normal.
    pub fn oriented(&self, orientation: &Function, scratch: &mut Scratch) -> Option<Frame> {
        let mut vector = [0.0; 3];
        orientation.program.eval_all(&[], &orientation.view(self.turned), scratch, &mut vector).ok()?;
        Frame::along(self.normal, orientation.in_scene(self.turned, DVec3::from_array(vector)))
    }
}

impl<const BANDS: usize> SpecularBounce<BANDS> {
    /// A bounce; none if its weight is zero.
    pub fn new(direction: DVec3, weight: [f64; BANDS]) -> Option<SpecularBounce<BANDS>> {
        let weight = weight.map(|band| if band.is_finite() { band.max(0.0) } else { 0.0 });
        weight.iter().any(|band| *band > 0.0).then_some(SpecularBounce { direction, weight })
    }
}
