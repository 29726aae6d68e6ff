//! `BSDF` and `aBSDF`: measured or simulated scattering.
//!
//! A `BSDF` with a thickness stands for geometry in front of which, or behind which, it lies: views and shadow rays pass it and meet that
//! geometry, scattered rays meet the data, and what these transmit goes on beyond the thickness. Through an `aBSDF` views and shadow
//! rays go straight in as far as the data have a peak about the straight way.

use super::{Meeting, Met, Onward};
use crate::beyond::{Beyond, luminance};
use crate::frame::Frame;
use crate::measured_lobe::{BlurredView, MeasuredLobe, PeakCells, StraightPeak, straight_peak};
use crate::ray::Hit;
use crate::shader::{Function, Shader, bands};
use crate::surface_light::{Highlight, LitPoint};
use crate::trace::{Passage, Segment, Tracer};
use crate::tree::Image;
use crate::view::Encounter;
use crate::weak_highlight::Undrawn;
use glam::DVec3;
use radsight_bsdf::{Bsdf, Side};
use radsight_cal::Scratch;
use radsight_ir::{BsdfForm, Rgb};
use radsight_sampling::DimensionSet;
use std::sync::Arc;

/// The parameters.
#[derive(Clone, Debug)]
pub(crate) struct BsdfKind {
    pub(crate) bsdf: Arc<Bsdf>,
    /// The up vector; of a proxy the thickness before it.
    pub(crate) function: Function,
    pub(crate) form: BsdfForm,
    /// Front reflectance, back reflectance, transmittance.
    pub(crate) added_diffuse: [Rgb; 3],
}

/// A thickness of less than this is none (Radiance's).
const LEAST_THICKNESS: f64 = 1e-6;

/// Which of the light a point scatters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Reflected,
    Transmitted,
    Both,
}

/// A view of the surface in the frame of the data.
struct Pose {
    frame: Frame,
    /// Unit, towards the viewer.
    outgoing: DVec3,
    peak: Option<StraightPeak>,
}

impl BsdfKind {
    /// As a shadow ray meets it: a view that is not blurred by the size of the data's cells.
    pub(super) fn meet<'a, const BANDS: usize>(
        &'a self,
        meeting: &Meeting<'a, BANDS>,
        scratch: &mut Scratch,
    ) -> Met<'a, BANDS> {
        let nothing = LitPoint::new(meeting.outgoing(), meeting.encounter.normal, Frame::new(meeting.normal));
        match self.pose(meeting, scratch) {
            None => Met { point: nothing, mirror: None, straight: None },
            Some(pose) => Met {
                point: self.point(meeting, &pose, BlurredView::exact(pose.outgoing), Part::Both),
                mirror: None,
                straight: self.straight(meeting, &pose),
            },
        }
    }

    pub(super) fn lets_through(&self) -> bool {
        match self.form {
            BsdfForm::Proxy => self.function.program.constant(0) != Some(0.0),
            BsdfForm::Aperture => self.bsdf.transmission(Side::Front).is_some(),
        }
    }

    pub(super) fn is_grey(&self) -> bool {
        self.bsdf.is_grey() && self.added_diffuse.iter().all(|color| color.is_grey())
    }

    /// Whether it is not there for shadow rays.
    pub(super) fn is_passed_by_shadows(&self, encounter: &Encounter, scratch: &mut Scratch) -> bool {
        self.thickness(encounter, scratch) != 0.0
    }

    /// Scene units; zero for none.
    fn thickness(&self, encounter: &Encounter, scratch: &mut Scratch) -> f64 {
        if self.form == BsdfForm::Aperture {
            return 0.0;
        }
        let thickness = self.function.program.eval(0, &[], &self.function.view(encounter), scratch).unwrap_or(0.0);
        if thickness.abs() <= LEAST_THICKNESS { 0.0 } else { self.function.length_in_scene(encounter, thickness) }
    }

    /// None where the up vector is along the normal, or fails.
    fn pose<const BANDS: usize>(&self, meeting: &Meeting<'_, BANDS>, scratch: &mut Scratch) -> Option<Pose> {
        let encounter = meeting.encounter;
        let (first, view) = (usize::from(self.form == BsdfForm::Proxy), self.function.view(encounter));
        let mut up = [0.0; 3];
        for (component, value) in up.iter_mut().enumerate() {
            *value = self.function.program.eval(first + component, &[], &view, scratch).ok()?;
        }
        let up = self.function.in_scene(encounter, DVec3::from_array(up));
        let front = if encounter.behind { -meeting.normal } else { meeting.normal };
        let frame = Frame::along(front, up.cross(front))?;
        let outgoing = frame.to_local(meeting.outgoing());
        let is_lit = self.form == BsdfForm::Aperture && luminance(&meeting.appearance.color) > 0.0;
        let peak = if is_lit { straight_peak(&self.bsdf, outgoing) } else { None };
        Some(Pose { frame, outgoing, peak })
    }

    fn straight<const BANDS: usize>(&self, meeting: &Meeting<'_, BANDS>, pose: &Pose) -> Option<Onward<BANDS>> {
        let weight = meeting.colored(bands(Rgb(pose.peak?.transmittance)));
        Onward::new(meeting.encounter.direction, weight)
    }

    fn point<'a, const BANDS: usize>(
        &'a self,
        meeting: &Meeting<'a, BANDS>,
        pose: &Pose,
        view: BlurredView,
        part: Part,
    ) -> LitPoint<'a, BANDS> {
        let side = if meeting.encounter.behind { Side::Back } else { Side::Front };
        let [front, back, transmitted] = self.added_diffuse;
        let added = if side == Side::Front { front } else { back };
        let diffuse = |own: [f64; 3], added: Rgb, is_wanted: bool| {
            let sum: [f64; BANDS] = bands(Rgb(std::array::from_fn(|band| own[band] + added.0[band])));
            if is_wanted { meeting.colored(sum) } else { [0.0; BANDS] }
        };
        let reflected = diffuse(self.bsdf.diffuse_reflectance(side), added, part != Part::Transmitted);
        let transmitted = diffuse(self.bsdf.diffuse_transmittance(side), transmitted, part != Part::Reflected);
        let scattering = [
            self.bsdf.reflection(side).filter(|_| part != Part::Transmitted),
            self.bsdf.transmission(side).filter(|_| part != Part::Reflected),
        ];
        let peak = match &pose.peak {
            Some(peak) => (peak.cells, luminance(&peak.transmittance)),
            None => (PeakCells::NONE, 0.0),
        };
        let color = meeting.appearance.color;
        let measured = MeasuredLobe::new(scattering, (pose.frame, view), color, peak, meeting.threshold);
        let (highlight, undrawn) = match measured {
            Some((lobe, undrawn)) => (Highlight::Measured(lobe), undrawn),
            None => (Highlight::None, Undrawn::NOTHING),
        };
        let point = LitPoint {
            diffuse: reflected,
            undrawn,
            highlight,
            ..LitPoint::new(meeting.outgoing(), meeting.encounter.normal, Frame::new(meeting.normal))
        };
        point.with_beyond(Beyond::new(meeting.normal, transmitted, None))
    }

    /// Where a peak goes straight through, the view is not blurred: the peak would be found twice.
    fn view(&self, pose: &Pose, offset: [f64; 2]) -> BlurredView {
        match pose.peak {
            Some(_) => BlurredView::exact(pose.outgoing),
            None => BlurredView::new(&self.bsdf, pose.outgoing, offset),
        }
    }
}

impl<const BANDS: usize> Tracer<'_, BANDS> {
    /// A ray meets measured data, or passes the proxy that they are.
    pub(super) fn shade_bsdf(
        &mut self,
        segment: &Segment<BANDS>,
        hit: &Hit,
        shader: &Shader,
        kind: &BsdfKind,
        encounter: &Encounter,
    ) {
        let thickness = kind.thickness(encounter, &mut self.workspace.scratch);
        if thickness != 0.0 && (!segment.is_scattered() || (thickness > 0.0) == encounter.behind) {
            return self.pass_through(segment, hit);
        }
        let (appearance, normal) = self.appearance(segment, shader, encounter);
        let turned = encounter.turned();
        let scene = shader.home.scene(&self.plan.scene);
        let threshold = self.plan.options.highlight_threshold;
        let meeting = Meeting { scene, encounter, turned: &turned, appearance, normal, threshold };
        let Some(pose) = kind.pose(&meeting, &mut self.workspace.scratch) else { return };
        if let Some(straight) = kind.straight(&meeting, &pose) {
            let passage = Passage::Sheet { undisturbed: true, image: Image::InPlace };
            self.specular(segment, hit, straight.direction, straight.weight, passage);
        }
        let u = self.sampler.take(DimensionSet::render(self.next_set));
        self.next_set += 1;
        let view = kind.view(&pose, [u[0], u[1]]);
        let travelled = encounter.total_distance;
        if thickness == 0.0 {
            let point = kind.point(&meeting, &pose, view, Part::Both);
            return self.light_and_scatter(segment, hit.point, Some(hit.primitive), &point, travelled);
        }
        let reflected = kind.point(&meeting, &pose, view, Part::Reflected);
        self.light_and_scatter(segment, hit.point, Some(hit.primitive), &reflected, travelled);
        let transmitted = kind.point(&meeting, &pose, view, Part::Transmitted);
        let beyond = hit.point - hit.front * thickness;
        self.light_and_scatter(segment, beyond, None, &transmitted, travelled);
    }
}
