//! `BSDF` and `aBSDF`: measured or simulated scattering.
//!
//! A `BSDF` with a thickness is a proxy: it lies in front of or behind the geometry that it stands
//! for. View rays and shadow rays pass it and hit that geometry; scattered rays use the data, and
//! transmitted ones start beyond the thickness. An `aBSDF` transmits view rays and shadow rays
//! straight through, as far as the data have a peak there.

use crate::bsdf::{Bsdf, Highlight};
use crate::context::{BsdfContext, SpecularBounce, SurfaceScattering};
use crate::frame::Frame;
use crate::measured_lobe::{JitteredView, MeasuredLobe, PeakCells, StraightTransmission, straight_peak};
use crate::specular_threshold::BelowThreshold;
use crate::transmission_lobe::Transmission;
use glam::DVec3;
use radsight_cal::Scratch;
use radsight_ir::{BsdfForm, Rgb};
use radsight_measured::{MeasuredBsdf, Side};
use radsight_texture::{Function, SurfaceInteraction, bands, luminance};
use std::sync::Arc;

/// Parameters of `BSDF` and `aBSDF`.
#[derive(Clone, Debug)]
pub struct MeasuredKind {
    /// The BSDF data.
    pub bsdf: Arc<MeasuredBsdf>,
    /// Function that gives the up vector; for a proxy its first root is the thickness.
    pub function: Function,
    /// Proxy for geometry, or aperture.
    pub form: BsdfForm,
    /// Diffuse reflectance of the front, of the back, and diffuse transmittance, added to the data.
    pub added_diffuse: [Rgb; 3],
}

/// A smaller thickness counts as zero (Radiance's).
const LEAST_THICKNESS: f64 = 1e-6;

/// Part of the scattering to evaluate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeasuredPart {
    /// Reflection.
    Reflected,
    /// Transmission.
    Transmitted,
    /// Reflection and transmission.
    Both,
}

/// Frame of the data, and the outgoing direction in it.
pub struct Pose {
    frame: Frame,
    /// Unit vector towards the viewer.
    outgoing: DVec3,
    peak: Option<StraightTransmission>,
}

impl MeasuredKind {
    /// BSDF for a shadow ray: the outgoing direction is not jittered within the cells of the data.
    pub fn bsdf_at<'a, const BANDS: usize>(
        &'a self,
        context: &BsdfContext<'a, BANDS>,
        scratch: &mut Scratch,
    ) -> SurfaceScattering<'a, BANDS> {
        let nothing = Bsdf::new(context.outgoing(), context.interaction.normal, Frame::new(context.normal));
        match self.pose(context, scratch) {
            None => SurfaceScattering { point: nothing, mirror: None, straight: None },
            Some(pose) => SurfaceScattering {
                point: self.point(context, &pose, JitteredView::exact(pose.outgoing), MeasuredPart::Both),
                mirror: None,
                straight: self.straight(context, &pose),
            },
        }
    }

    /// Whether shadow rays can pass straight through.
    pub fn lets_through(&self) -> bool {
        match self.form {
            BsdfForm::Proxy => self.function.program.constant(0) != Some(0.0),
            BsdfForm::Aperture => self.bsdf.transmission(Side::Front).is_some(),
        }
    }

    /// Whether the material's own parameters are the same in every band.
    pub fn is_grey(&self) -> bool {
        self.bsdf.is_grey() && self.added_diffuse.iter().all(|color| color.is_grey())
    }

    /// Whether shadow rays ignore the surface.
    pub fn is_passed_by_shadows(&self, interaction: &SurfaceInteraction, scratch: &mut Scratch) -> bool {
        self.thickness(interaction, scratch) != 0.0
    }

    /// Thickness of a proxy, scene units; zero for none.
    pub fn thickness(&self, interaction: &SurfaceInteraction, scratch: &mut Scratch) -> f64 {
        if self.form == BsdfForm::Aperture {
            return 0.0;
        }
        let thickness = self.function.program.eval(0, &[], &self.function.view(interaction), scratch).unwrap_or(0.0);
        if thickness.abs() <= LEAST_THICKNESS { 0.0 } else { self.function.length_in_scene(interaction, thickness) }
    }

    /// Frame of the data; none if the up vector is parallel to the normal, or its function fails.
    pub fn pose<const BANDS: usize>(&self, context: &BsdfContext<'_, BANDS>, scratch: &mut Scratch) -> Option<Pose> {
        let interaction = context.interaction;
        let (first, view) = (usize::from(self.form == BsdfForm::Proxy), self.function.view(interaction));
        let mut up = [0.0; 3];
        for (component, value) in up.iter_mut().enumerate() {
            *value = self.function.program.eval(first + component, &[], &view, scratch).ok()?;
        }
        let up = self.function.in_scene(interaction, DVec3::from_array(up));
        let front = if interaction.behind { -context.normal } else { context.normal };
        let frame = Frame::along(front, up.cross(front))?;
        let outgoing = frame.to_local(context.outgoing());
        let is_lit = self.form == BsdfForm::Aperture && luminance(&context.appearance.color) > 0.0;
        let peak = if is_lit { straight_peak(&self.bsdf, outgoing) } else { None };
        Some(Pose { frame, outgoing, peak })
    }

    /// Straight-through transmission by the peak of the data.
    pub fn straight<const BANDS: usize>(
        &self,
        context: &BsdfContext<'_, BANDS>,
        pose: &Pose,
    ) -> Option<SpecularBounce<BANDS>> {
        let weight = context.colored(bands(Rgb(pose.peak?.transmittance)));
        SpecularBounce::new(context.interaction.direction, weight)
    }

    /// The BSDF of the wanted part.
    pub fn point<'a, const BANDS: usize>(
        &'a self,
        context: &BsdfContext<'a, BANDS>,
        pose: &Pose,
        view: JitteredView,
        part: MeasuredPart,
    ) -> Bsdf<'a, BANDS> {
        let side = if context.interaction.behind { Side::Back } else { Side::Front };
        let [front, back, transmitted] = self.added_diffuse;
        let added = if side == Side::Front { front } else { back };
        let diffuse = |own: [f64; 3], added: Rgb, is_wanted: bool| {
            let sum: [f64; BANDS] = bands(Rgb(std::array::from_fn(|band| own[band] + added.0[band])));
            if is_wanted { context.colored(sum) } else { [0.0; BANDS] }
        };
        let reflected = diffuse(self.bsdf.diffuse_reflectance(side), added, part != MeasuredPart::Transmitted);
        let transmitted = diffuse(self.bsdf.diffuse_transmittance(side), transmitted, part != MeasuredPart::Reflected);
        let scattering = [
            self.bsdf.reflection(side).filter(|_| part != MeasuredPart::Transmitted),
            self.bsdf.transmission(side).filter(|_| part != MeasuredPart::Reflected),
        ];
        let peak = match &pose.peak {
            Some(peak) => (peak.cells, luminance(&peak.transmittance)),
            None => (PeakCells::NONE, 0.0),
        };
        let color = context.appearance.color;
        let measured = MeasuredLobe::new(scattering, (pose.frame, view), color, peak, context.threshold);
        let (highlight, below_threshold) = match measured {
            Some((lobe, below_threshold)) => (Highlight::Measured(lobe), below_threshold),
            None => (Highlight::None, BelowThreshold::NOTHING),
        };
        let point = Bsdf {
            diffuse: reflected,
            below_threshold,
            highlight,
            ..Bsdf::new(context.outgoing(), context.interaction.normal, Frame::new(context.normal))
        };
        point.with_transmission(Transmission::new(context.normal, transmitted, None))
    }

    /// Jitters the outgoing direction, except where a peak is transmitted straight through: the
    /// jittered direction would find that peak a second time.
    pub fn view(&self, pose: &Pose, offset: [f64; 2]) -> JitteredView {
        match pose.peak {
            Some(_) => JitteredView::exact(pose.outgoing),
            None => JitteredView::new(&self.bsdf, pose.outgoing, offset),
        }
    }
}
