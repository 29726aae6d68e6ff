//! Materials that scatter in other ways than `plastic` and `metal`: what they are, and what they make of a ray that meets them.
//!
//! Each becomes a [`Bsdf`] for all that is spread over directions, and at most two rays that are not: a mirror image and a
//! straight way through.

mod ashikhmin;
mod functions;
mod measured;
mod sheet;
mod ward_function;

pub(crate) use ashikhmin::AshikhminKind;
pub(crate) use functions::{BrtdKind, ScatteringKind};
pub(crate) use measured::MeasuredKind;
pub(crate) use sheet::Sheet;
pub(crate) use ward_function::{Appearances, Component, WardFunctionKind};

use crate::bands::gathered;
use crate::bsdf::Bsdf;
use crate::frame::Frame;
use crate::function_lobe::Surroundings;
use crate::ray_tree::Image;
use crate::shader::{Appearance, Function, Shader};
use crate::surface_interaction::SurfaceInteraction;
use crate::trace::{Passage, PathIntegrator, PathState, shading_normal};
use crate::transmission_lobe::luminance;
use glam::DVec3;
use radsight_accel::Intersection;
use radsight_cal::Scratch;
use radsight_ir::Scene;

#[cfg(test)]
mod tests;

/// A scattering material.
#[derive(Clone, Debug)]
pub(crate) enum Scatterer {
    /// `trans`, `plastic2`, `metal2`, `trans2`.
    Sheet(Sheet),
    /// `ashik2`.
    Ashikhmin(AshikhminKind),
    /// `WGMDfunc`.
    WardFunction(WardFunctionKind),
    /// `plasfunc`, `metfunc`, `transfunc`, `plasdata`, `metdata`, `transdata`.
    Function(ScatteringKind),
    /// `BRTDfunc`.
    Brtd(BrtdKind),
    /// `BSDF` and `aBSDF`.
    Measured(MeasuredKind),
}

/// A ray at a scattering material.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BsdfContext<'a, const BANDS: usize> {
    pub(crate) scene: &'a Scene,
    /// As the surface faces.
    pub(crate) interaction: &'a SurfaceInteraction,
    /// As if the surface faced the viewer.
    pub(crate) turned: &'a SurfaceInteraction,
    pub(crate) appearance: Appearance<BANDS>,
    /// Unit, with textures, on the viewer's side.
    pub(crate) normal: DVec3,
    /// Highlights of no more than this share are not drawn from.
    pub(crate) threshold: f64,
}

/// What a material makes of a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfaceScattering<'a, const BANDS: usize> {
    pub(crate) point: Bsdf<'a, BANDS>,
    pub(crate) mirror: Option<SpecularBounce<BANDS>>,
    pub(crate) straight: Option<SpecularBounce<BANDS>>,
}

/// A ray that goes on from a perfectly specular event.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpecularBounce<const BANDS: usize> {
    /// Unit.
    pub(crate) direction: DVec3,
    pub(crate) weight: [f64; BANDS],
}

/// Directions nearer to the surface than this cosine do not count as leaving it (Radiance's).
const GRAZING: f64 = 1e-6;

impl Scatterer {
    pub(crate) fn bsdf_at<'a, const BANDS: usize>(
        &'a self,
        context: &BsdfContext<'a, BANDS>,
        scratch: &mut Scratch,
    ) -> SurfaceScattering<'a, BANDS> {
        match self {
            Scatterer::Sheet(sheet) => sheet.bsdf_at(context, scratch),
            Scatterer::Ashikhmin(kind) => kind.bsdf_at(context, scratch),
            Scatterer::WardFunction(kind) => kind.bsdf_at(context, scratch),
            Scatterer::Function(kind) => kind.bsdf_at(context),
            Scatterer::Brtd(kind) => kind.bsdf_at(context, scratch),
            Scatterer::Measured(kind) => kind.bsdf_at(context, scratch),
        }
    }

    /// Whether a shadow ray can go straight through.
    pub(crate) fn lets_through(&self) -> bool {
        match self {
            Scatterer::Sheet(sheet) => sheet.lets_through(),
            Scatterer::WardFunction(kind) => kind.lets_through(),
            Scatterer::Brtd(kind) => kind.lets_through(),
            Scatterer::Measured(kind) => kind.lets_through(),
            Scatterer::Ashikhmin(_) | Scatterer::Function(_) => false,
        }
    }

    /// What of a shadow ray goes straight through.
    pub(crate) fn passage<const BANDS: usize>(
        &self,
        scene: &Scene,
        interaction: &SurfaceInteraction,
        appearance: Appearance<BANDS>,
        scratch: &mut Scratch,
    ) -> Option<[f64; BANDS]> {
        if let Scatterer::Measured(kind) = self
            && kind.is_passed_by_shadows(interaction, scratch)
        {
            return Some([1.0; BANDS]);
        }
        let normal = shading_normal(interaction, appearance.perturbation);
        let turned = interaction.turned();
        let context = BsdfContext { scene, interaction, turned: &turned, appearance, normal, threshold: 0.0 };
        self.bsdf_at(&context, scratch).straight.map(|straight| straight.weight)
    }

    /// Whether it is there from behind even where back faces are invisible.
    pub(crate) fn has_a_back(&self) -> bool {
        matches!(self, Scatterer::Brtd(_))
    }

    /// Whether every band is the same, as far as the material itself goes.
    pub(crate) fn is_grey(&self) -> bool {
        match self {
            Scatterer::Sheet(sheet) => sheet.is_grey(),
            Scatterer::Ashikhmin(kind) => kind.is_grey(),
            Scatterer::WardFunction(kind) => kind.is_grey(),
            Scatterer::Function(kind) => kind.is_grey(),
            Scatterer::Brtd(kind) => kind.is_grey(),
            Scatterer::Measured(kind) => kind.is_grey(),
        }
    }
}

impl<'a, const BANDS: usize> BsdfContext<'a, BANDS> {
    /// What a function of the material sees, with this colour in its variables.
    pub(crate) fn surroundings(&self, color: [f64; BANDS]) -> Surroundings<'a> {
        Surroundings {
            interaction: self.interaction,
            normal: self.normal,
            cosine: self.outgoing().dot(self.normal),
            color: gathered(&color),
        }
    }

    pub(crate) fn outgoing(&self) -> DVec3 {
        -self.interaction.direction
    }

    /// The material's colour under its patterns.
    pub(crate) fn colored(&self, own: [f64; BANDS]) -> [f64; BANDS] {
        std::array::from_fn(|band| own[band] * self.appearance.color[band])
    }

    /// Where light goes straight through; a texture bends it, unless it would come back.
    pub(crate) fn straight(&self) -> DVec3 {
        let direction = self.interaction.direction;
        if self.appearance.perturbation == DVec3::ZERO || self.interaction.is_smoothed() {
            return direction;
        }
        let bent = direction - self.appearance.perturbation;
        if bent.dot(self.interaction.normal) < -GRAZING { bent.normalize() } else { direction }
    }

    /// The frame on the shading normal that an orientation function gives; none where that is parallel to the normal, or fails.
    pub(crate) fn oriented(&self, orientation: &Function, scratch: &mut Scratch) -> Option<Frame> {
        let mut vector = [0.0; 3];
        orientation.program.eval_all(&[], &orientation.view(self.turned), scratch, &mut vector).ok()?;
        Frame::along(self.normal, orientation.in_scene(self.turned, DVec3::from_array(vector)))
    }
}

impl<const BANDS: usize> SurfaceScattering<'_, BANDS> {
    /// What is seen straight on appears in its place where more goes that way than is scattered.
    fn image_beyond(&self, straight: &SpecularBounce<BANDS>) -> Image {
        let transmission =
            self.point.transmission.as_ref().map_or(0.0, |transmission| luminance(&transmission.diffuse));
        Image::in_place_if(luminance(&straight.weight) > transmission + luminance(&self.point.diffuse))
    }
}

impl<const BANDS: usize> SpecularBounce<BANDS> {
    /// None where it carries nothing.
    pub(crate) fn new(direction: DVec3, weight: [f64; BANDS]) -> Option<SpecularBounce<BANDS>> {
        let weight = weight.map(|band| if band.is_finite() { band.max(0.0) } else { 0.0 });
        weight.iter().any(|band| *band > 0.0).then_some(SpecularBounce { direction, weight })
    }
}

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// A ray meets a scattering material.
    pub(crate) fn shade_scatterer(
        &mut self,
        path: &PathState<BANDS>,
        hit: &Intersection,
        shader: &Shader,
        scatterer: &Scatterer,
        interaction: &SurfaceInteraction,
    ) {
        if let Scatterer::Measured(kind) = scatterer {
            return self.shade_measured(path, hit, shader, kind, interaction);
        }
        let (appearance, normal) = self.appearance(path, shader, interaction);
        let turned = interaction.turned();
        let scene = shader.home.scene(&self.plan.scene);
        let threshold = self.plan.options.highlight_threshold;
        let context = BsdfContext { scene, interaction, turned: &turned, appearance, normal, threshold };
        let met = scatterer.bsdf_at(&context, &mut self.workspace.scratch);
        if let Some(straight) = &met.straight {
            let undisturbed = straight.direction == interaction.direction;
            let passage = Passage::Sheet { undisturbed, image: met.image_beyond(straight) };
            self.specular(path, hit, straight.direction, straight.weight, passage);
        }
        if let Some(mirror) = &met.mirror {
            self.specular(path, hit, mirror.direction, mirror.weight, Passage::Other);
        }
        self.light_and_scatter(path, hit.point, Some(hit.primitive), &met.point, interaction.total_distance);
    }
}
