//! `BSDF` and `aBSDF`: measured or simulated scattering.
//!
//! A `BSDF` with a thickness stands for geometry in front of which, or behind which, it lies: views and shadow rays pass it and meet that
//! geometry, scattered rays meet the data, and what these transmit goes on beyond the thickness. Through an `aBSDF` views and shadow
//! rays go straight in as far as the data have a peak about the straight way.

use crate::bsdf::{Bsdf, Highlight};
use crate::context::{BsdfContext, SpecularBounce, SurfaceScattering};
use crate::frame::Frame;
use crate::measured_lobe::{BlurredView, MeasuredLobe, PeakCells, StraightTransmission, straight_peak};
use crate::specular_threshold::BelowThreshold;
use crate::transmission_lobe::Transmission;
use glam::DVec3;
use radsight_cal::Scratch;
use radsight_ir::{BsdfForm, Rgb};
use radsight_measured::{MeasuredBsdf, Side};
use radsight_texture::{Function, SurfaceInteraction, bands, luminance};
use std::sync::Arc;

/// The parameters.
#[derive(Clone, Debug)]
pub struct MeasuredKind {
    /// The data.
    pub bsdf: Arc<MeasuredBsdf>,
    /// The up vector; of a proxy the thickness before it.
    pub function: Function,
    /// A proxy for geometry, or an aperture.
    pub form: BsdfForm,
    /// Front reflectance, back reflectance, transmittance.
    pub added_diffuse: [Rgb; 3],
}

/// A thickness of less than this is none (Radiance's).
const LEAST_THICKNESS: f64 = 1e-6;

/// Which of the light a point scatters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeasuredPart {
    /// To the viewer's side.
    Reflected,
    /// From the other side.
    Transmitted,
    /// All of it.
    Both,
}

/// A view of the surface in the frame of the data.
pub struct Pose {
    frame: Frame,
    /// Unit, towards the viewer.
    outgoing: DVec3,
    peak: Option<StraightTransmission>,
}

impl MeasuredKind {
    /// As a shadow ray meets it: a view that is not blurred by the size of the data's cells.
    pub fn bsdf_at<'a, const BANDS: usize>(
        &'a self,
        context: &BsdfContext<'a, BANDS>,
        scratch: &mut Scratch,
    ) -> SurfaceScattering<'a, BANDS> {
        let nothing = Bsdf::new(context.outgoing(), context.interaction.normal, Frame::new(context.normal));
        match self.pose(context, scratch) {
            None => SurfaceScattering { point: nothing, mirror: None, straight: None },
            Some(pose) => SurfaceScattering {
                point: self.point(context, &pose, BlurredView::exact(pose.outgoing), MeasuredPart::Both),
                mirror: None,
                straight: self.straight(context, &pose),
            },
        }
    }

    /// Whether a shadow ray can go straight through.
    pub fn lets_through(&self) -> bool {
        match self.form {
            BsdfForm::Proxy => self.function.program.constant(0) != Some(0.0),
            BsdfForm::Aperture => self.bsdf.transmission(Side::Front).is_some(),
        }
    }

    /// Whether every band is the same, as far as the material itself goes.
    pub fn is_grey(&self) -> bool {
        self.bsdf.is_grey() && self.added_diffuse.iter().all(|color| color.is_grey())
    }

    /// Whether it is not there for shadow rays.
    pub fn is_passed_by_shadows(&self, interaction: &SurfaceInteraction, scratch: &mut Scratch) -> bool {
        self.thickness(interaction, scratch) != 0.0
    }

    /// Scene units; zero for none.
    pub fn thickness(&self, interaction: &SurfaceInteraction, scratch: &mut Scratch) -> f64 {
        if self.form == BsdfForm::Aperture {
            return 0.0;
        }
        let thickness = self.function.program.eval(0, &[], &self.function.view(interaction), scratch).unwrap_or(0.0);
        if thickness.abs() <= LEAST_THICKNESS { 0.0 } else { self.function.length_in_scene(interaction, thickness) }
    }

    /// None where the up vector is along the normal, or fails.
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

    /// What goes straight through by way of the peak of the data.
    pub fn straight<const BANDS: usize>(
        &self,
        context: &BsdfContext<'_, BANDS>,
        pose: &Pose,
    ) -> Option<SpecularBounce<BANDS>> {
        let weight = context.colored(bands(Rgb(pose.peak?.transmittance)));
        SpecularBounce::new(context.interaction.direction, weight)
    }

    /// The BSDF there, of the wanted part.
    pub fn point<'a, const BANDS: usize>(
        &'a self,
        context: &BsdfContext<'a, BANDS>,
        pose: &Pose,
        view: BlurredView,
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

    /// Where a peak goes straight through, the view is not blurred: the peak would be found twice.
    pub fn view(&self, pose: &Pose, offset: [f64; 2]) -> BlurredView {
        match pose.peak {
            Some(_) => BlurredView::exact(pose.outgoing),
            None => BlurredView::new(&self.bsdf, pose.outgoing, offset),
        }
    }
}
