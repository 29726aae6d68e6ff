//! Materials that scatter in other ways than `plastic` and `metal`: what they are, and what they make of a ray that meets them.
//!
//! Each becomes a [`LitPoint`] for all that is spread over directions, and at most two rays that are not: a mirror image and a
//! straight way through.

mod ashikhmin;
mod bsdf;
mod functions;
mod sheet;
mod ward_function;

pub(crate) use ashikhmin::AshikhminKind;
pub(crate) use bsdf::BsdfKind;
pub(crate) use functions::{BrtdKind, ScatteringKind};
pub(crate) use sheet::Sheet;
pub(crate) use ward_function::{Component, Look, WardFunctionKind};

use crate::bands::gathered;
use crate::beyond::luminance;
use crate::frame::Frame;
use crate::function_lobe::Surroundings;
use crate::ray::Hit;
use crate::shader::{Appearance, Function, Shader};
use crate::surface_light::LitPoint;
use crate::trace::{Passage, Segment, Tracer, shading_normal};
use crate::tree::Image;
use crate::view::Encounter;
use glam::DVec3;
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
    Bsdf(BsdfKind),
}

/// A ray at a scattering material.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Meeting<'a, const BANDS: usize> {
    pub(crate) scene: &'a Scene,
    /// As the surface faces.
    pub(crate) encounter: &'a Encounter,
    /// As if the surface faced the viewer.
    pub(crate) turned: &'a Encounter,
    pub(crate) appearance: Appearance<BANDS>,
    /// Unit, with textures, on the viewer's side.
    pub(crate) normal: DVec3,
    /// Highlights of no more than this share are not drawn from.
    pub(crate) threshold: f64,
}

/// What a material makes of a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Met<'a, const BANDS: usize> {
    pub(crate) point: LitPoint<'a, BANDS>,
    pub(crate) mirror: Option<Onward<BANDS>>,
    pub(crate) straight: Option<Onward<BANDS>>,
}

/// A ray that goes on from a perfectly specular event.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Onward<const BANDS: usize> {
    /// Unit.
    pub(crate) direction: DVec3,
    pub(crate) weight: [f64; BANDS],
}

/// Directions nearer to the surface than this cosine do not count as leaving it (Radiance's).
const GRAZING: f64 = 1e-6;

impl Scatterer {
    pub(crate) fn meet<'a, const BANDS: usize>(
        &'a self,
        meeting: &Meeting<'a, BANDS>,
        scratch: &mut Scratch,
    ) -> Met<'a, BANDS> {
        match self {
            Scatterer::Sheet(sheet) => sheet.meet(meeting, scratch),
            Scatterer::Ashikhmin(kind) => kind.meet(meeting, scratch),
            Scatterer::WardFunction(kind) => kind.meet(meeting, scratch),
            Scatterer::Function(kind) => kind.meet(meeting),
            Scatterer::Brtd(kind) => kind.meet(meeting, scratch),
            Scatterer::Bsdf(kind) => kind.meet(meeting, scratch),
        }
    }

    /// Whether a shadow ray can go straight through.
    pub(crate) fn lets_through(&self) -> bool {
        match self {
            Scatterer::Sheet(sheet) => sheet.lets_through(),
            Scatterer::WardFunction(kind) => kind.lets_through(),
            Scatterer::Brtd(kind) => kind.lets_through(),
            Scatterer::Bsdf(kind) => kind.lets_through(),
            Scatterer::Ashikhmin(_) | Scatterer::Function(_) => false,
        }
    }

    /// What of a shadow ray goes straight through.
    pub(crate) fn passage<const BANDS: usize>(
        &self,
        scene: &Scene,
        encounter: &Encounter,
        appearance: Appearance<BANDS>,
        scratch: &mut Scratch,
    ) -> Option<[f64; BANDS]> {
        if let Scatterer::Bsdf(kind) = self
            && kind.is_passed_by_shadows(encounter, scratch)
        {
            return Some([1.0; BANDS]);
        }
        let normal = shading_normal(encounter, appearance.perturbation);
        let turned = encounter.turned();
        let meeting = Meeting { scene, encounter, turned: &turned, appearance, normal, threshold: 0.0 };
        self.meet(&meeting, scratch).straight.map(|straight| straight.weight)
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
            Scatterer::Bsdf(kind) => kind.is_grey(),
        }
    }
}

impl<'a, const BANDS: usize> Meeting<'a, BANDS> {
    /// What a function of the material sees, with this colour in its variables.
    pub(crate) fn surroundings(&self, color: [f64; BANDS]) -> Surroundings<'a> {
        Surroundings {
            encounter: self.encounter,
            normal: self.normal,
            cosine: self.outgoing().dot(self.normal),
            color: gathered(&color),
        }
    }

    pub(crate) fn outgoing(&self) -> DVec3 {
        -self.encounter.direction
    }

    /// The material's colour under its patterns.
    pub(crate) fn colored(&self, own: [f64; BANDS]) -> [f64; BANDS] {
        std::array::from_fn(|band| own[band] * self.appearance.color[band])
    }

    /// Where light goes straight through; a texture bends it, unless it would come back.
    pub(crate) fn straight(&self) -> DVec3 {
        let direction = self.encounter.direction;
        if self.appearance.perturbation == DVec3::ZERO || self.encounter.is_smoothed() {
            return direction;
        }
        let bent = direction - self.appearance.perturbation;
        if bent.dot(self.encounter.normal) < -GRAZING { bent.normalize() } else { direction }
    }

    /// The frame on the shading normal that an orientation function gives; none where that is parallel to the normal, or fails.
    pub(crate) fn oriented(&self, orientation: &Function, scratch: &mut Scratch) -> Option<Frame> {
        let mut vector = [0.0; 3];
        orientation.program.eval_all(&[], &orientation.view(self.turned), scratch, &mut vector).ok()?;
        Frame::along(self.normal, orientation.in_scene(self.turned, DVec3::from_array(vector)))
    }
}

impl<const BANDS: usize> Met<'_, BANDS> {
    /// What is seen straight on appears in its place where more goes that way than is scattered.
    fn image_beyond(&self, straight: &Onward<BANDS>) -> Image {
        let beyond = self.point.beyond.as_ref().map_or(0.0, |beyond| luminance(&beyond.diffuse));
        Image::in_place_if(luminance(&straight.weight) > beyond + luminance(&self.point.diffuse))
    }
}

impl<const BANDS: usize> Onward<BANDS> {
    /// None where it carries nothing.
    pub(crate) fn new(direction: DVec3, weight: [f64; BANDS]) -> Option<Onward<BANDS>> {
        let weight = weight.map(|band| if band.is_finite() { band.max(0.0) } else { 0.0 });
        weight.iter().any(|band| *band > 0.0).then_some(Onward { direction, weight })
    }
}

impl<const BANDS: usize> Tracer<'_, BANDS> {
    /// A ray meets a scattering material.
    pub(crate) fn shade_scatterer(
        &mut self,
        segment: &Segment<BANDS>,
        hit: &Hit,
        shader: &Shader,
        scatterer: &Scatterer,
        encounter: &Encounter,
    ) {
        if let Scatterer::Bsdf(kind) = scatterer {
            return self.shade_bsdf(segment, hit, shader, kind, encounter);
        }
        let (appearance, normal) = self.appearance(segment, shader, encounter);
        let turned = encounter.turned();
        let scene = shader.home.scene(&self.plan.scene);
        let threshold = self.plan.options.highlight_threshold;
        let meeting = Meeting { scene, encounter, turned: &turned, appearance, normal, threshold };
        let met = scatterer.meet(&meeting, &mut self.workspace.scratch);
        if let Some(straight) = &met.straight {
            let undisturbed = straight.direction == encounter.direction;
            let passage = Passage::Sheet { undisturbed, image: met.image_beyond(straight) };
            self.specular(segment, hit, straight.direction, straight.weight, passage);
        }
        if let Some(mirror) = &met.mirror {
            self.specular(segment, hit, mirror.direction, mirror.weight, Passage::Other);
        }
        self.light_and_scatter(segment, hit.point, Some(hit.primitive), &met.point, encounter.total_distance);
    }
}
