//! Rays whose radiance is a smooth function of the ray.
//!
//! A picture may be interpolated between pixels that see the same surface, lit by the same lights,
//! if nothing on the surface itself is sharp. Two rays whose [`SmoothView`]s join see such a
//! surface. They say nothing about what lies between the two rays.

use crate::panes::BehindPanes;
use crate::plan::RenderPlan;
use crate::shader::{Kind, Shader};
use crate::visibility_class::VisibilityClass;
use glam::DVec3;
use radsight_accel::{Beam, Intersection, MemberId, PrimitiveId, Ray};
use radsight_light::{Light, LightCone, LightForm};
use radsight_texture::Step;

/// With more lights no view counts as smooth: each light takes a shadow ray and a bit of the view.
const MOST_LIGHTS: usize = 64;

/// Shadow rays are shortened by this fraction of their length.
const SHORT_OF_LIGHT: f64 = 1e-6;

/// Smallest cosine of incidence for the extent of a pixel on a surface.
const GRAZING: f64 = 0.02;

/// The visible surface of a ray and the lights that reach it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothView {
    /// The primitive, `NONE` for no surface.
    primitive: PrimitiveId,
    /// A hash of the panes before it.
    panes: u64,
    /// A bit for each light whose centre is occluded.
    hidden: u64,
    /// A bit for each light whose cone excludes the point, and for each whose cone contains the
    /// point from everywhere on the light. In between, the light's extent blurs the edge of the
    /// cone.
    outside: u64,
    inside: u64,
    /// [`SmoothView::edge_width`].
    edge_width: f64,
}

impl SmoothView {
    const NOTHING: SmoothView = SmoothView {
        primitive: PrimitiveId::NONE,
        panes: 0,
        hidden: 0,
        outside: 0,
        inside: 0,
        edge_width: f64::INFINITY,
    };

    /// Width of the sharpest edge of a light's cone at the point or within a pixel of it, in
    /// pixels: the extent of the light blurs it. Infinite if there is none.
    #[must_use]
    pub fn edge_width(&self) -> f64 {
        self.edge_width
    }

    /// Whether no edge is known between the two.
    #[must_use]
    pub fn joins(&self, other: &SmoothView) -> bool {
        let is_sharp = self.outside & other.inside | self.inside & other.outside != 0;
        let [own, other] = [self, other].map(|view| (view.primitive, view.panes, view.hidden));
        own == other && !is_sharp
    }
}

/// How a light reaches a point.
enum LightCoverage {
    Hidden,
    /// The point is outside the light's cone.
    Outside,
    /// The point is inside the cone from all of the light.
    Inside,
    /// The point may be inside the cone from a part of the light. Width over which the edge of the
    /// cone is blurred, scene units; infinite if there is no cone.
    Partial(f64),
}

impl RenderPlan {
    /// The view of a ray, if its radiance is smooth: without pattern, texture, mirror image and
    /// mist. Plain panes transmit it, if they reflect nothing. Neighbouring pixels are `spacing` apart,
    /// radians.
    #[must_use]
    pub fn smooth_view(&self, ray: &Ray, spacing: f64) -> Option<SmoothView> {
        if self.has_mist || self.has_antimatter || self.lights.len() > MOST_LIGHTS {
            return None;
        }
        let passes = |ray: &Ray, hit: &Intersection| self.sky.is_empty() && self.reflects_nothing(ray, hit);
        let BehindPanes { panes, hit } = self.behind_panes(ray, passes)?;
        let Some((hit, distance)) = hit else {
            return self.sky.is_empty().then_some(SmoothView { panes, ..SmoothView::NOTHING });
        };
        if !is_smooth(self.shader_at(hit.shader)) {
            return None;
        }
        let mut view = SmoothView { primitive: hit.primitive, panes, ..SmoothView::NOTHING };
        let pixel = spacing * distance / hit.front.dot(ray.direction).abs().max(GRAZING);
        let is_free = self.sees_all_centers(&hit);
        for (index, light) in self.lights.iter().enumerate() {
            let bit = 1 << index;
            match self.coverage_of(&hit, pixel, (index, is_free), light)? {
                LightCoverage::Hidden => view.hidden |= bit,
                LightCoverage::Outside => view.outside |= bit,
                LightCoverage::Inside => view.inside |= bit,
                LightCoverage::Partial(width) => view.edge_width = view.edge_width.min(width / pixel),
            }
        }
        Some(view)
    }

    /// Whether radiance changes along rays at surfaces alone, or within dielectrics, and no surface mixes
    /// materials, scatters by a measured distribution or is subtracted: what rays show of the scene
    /// hardly depends on the point from which they look at it.
    #[must_use]
    pub fn has_plain_surfaces_alone(&self) -> bool {
        let is_known = |kind: &Kind| match kind {
            Kind::Transparent
            | Kind::Emitter(_)
            | Kind::Glossy(_)
            | Kind::Retro(_)
            | Kind::Mirror { .. }
            | Kind::Dielectric(_)
            | Kind::Glass { .. }
            | Kind::Plugin(_) => true,
            Kind::Scatterer(scatterer) => !scatterer.may_be_specular(),
            _ => false,
        };
        !self.has_mist && !self.has_antimatter && self.shaders.iter().all(|shader| is_known(&shader.kind))
    }

    /// Whether some rays are much brighter than those beside them: dielectrics and panes divide rays, or
    /// surfaces other than retroreflectors and perfect mirrors scatter light about a direction, to
    /// different surfaces.
    #[must_use]
    pub fn has_rare_rays(&self) -> bool {
        let is_glossy = |kind: &Kind| match kind {
            Kind::Glossy(glossy) => glossy.specularity > 0.0 && !glossy.is_smooth(),
            Kind::Scatterer(_) | Kind::Plugin(_) => true,
            _ => false,
        };
        self.divides_rays || self.shaders.iter().any(|shader| is_glossy(&shader.kind))
    }

    /// How a light reaches a point and what is within `margin` of it, scene units; `None` where it
    /// may be reflected by a mirror, whose outline is sharp.
    /// `is_free` says that the centre is known to be visible.
    fn coverage_of(
        &self,
        hit: &Intersection,
        margin: f64,
        (index, is_free): (usize, bool),
        light: &Light,
    ) -> Option<LightCoverage> {
        let is_free = match self.receiver(hit.primitive).map(|receiver| &receiver.between[index]) {
            Some(VisibilityClass::Dark) => return Some(LightCoverage::Outside),
            Some(VisibilityClass::Nothing) => true,
            _ => is_free,
        };
        if !light.virtual_sources.is_empty() {
            return light.misses(hit.point).then_some(LightCoverage::Outside);
        }
        match in_cone(light, hit.point, margin) {
            LightCoverage::Outside => Some(LightCoverage::Outside),
            _ if !is_free && self.hides(hit, light) => Some(LightCoverage::Hidden),
            reach => Some(reach),
        }
    }

    /// Whether all possible blockers are beside the segments from a point to the lights, by a
    /// bounding sphere of the lights' centres. Saves shadow rays.
    fn sees_all_centers(&self, hit: &Intersection) -> bool {
        let Some(receiver) = self.receiver(hit.primitive) else { return false };
        // Virtual sources need no shadow rays here.
        let lights = || self.lights.iter().zip(&receiver.between).filter(|(light, _)| light.virtual_sources.is_empty());
        let centers = || lights().map(|(light, _)| light.center);
        let center = centers().sum::<DVec3>() / centers().count() as f64;
        let radius = centers().map(|other| other.distance(center)).fold(0.0, f64::max);
        let beam = Beam { from: hit.point, to: center, radius };
        let is_beside =
            |member: &MemberId| self.is_pane(*member) || !self.geometry.may_block(&self.scene, *member, &beam);
        // Lights of a group have the same blockers.
        let mut checked: &[MemberId] = &[];
        for (light, class) in lights() {
            match class {
                VisibilityClass::Dark | VisibilityClass::Nothing => {}
                VisibilityClass::Few(blockers) if light.radius.is_finite() => {
                    if checked != blockers && !blockers.iter().all(is_beside) {
                        return false;
                    }
                    checked = blockers;
                }
                VisibilityClass::Within(bounds) if beam.misses_bounds(bounds, self.geometry.tolerance()) => {}
                _ => return false,
            }
        }
        true
    }

    /// Whether the centre of a light is occluded from a point by more than plain panes.
    fn hides(&self, hit: &Intersection, light: &Light) -> bool {
        let (direction, distance) = if light.radius.is_infinite() {
            (light.center, f64::INFINITY)
        } else {
            let offset = light.center - hit.point;
            let distance = offset.length();
            // A ray hits a round light before its centre.
            let depth = if light.form.plane().is_some() { 0.0 } else { light.radius };
            (offset / distance, distance * (1.0 - SHORT_OF_LIGHT) - depth)
        };
        let ray = Ray { origin: hit.point, direction };
        self.geometry.any_between(
            &self.scene,
            &ray,
            (Some(hit.primitive), PrimitiveId::NONE),
            distance.max(0.0),
            |crossing| !self.is_pane_primitive(crossing.primitive),
        )
    }
}

/// The position of a point, and of what is within `margin` of it, relative to the cone of a light.
fn in_cone(light: &Light, point: DVec3, margin: f64) -> LightCoverage {
    let Some(cone) = light.cone.filter(|_| light.radius.is_finite()) else {
        return LightCoverage::Partial(f64::INFINITY);
    };
    let offset = point - light.center;
    let radius = light.radius + margin;
    if offset.length_squared() <= radius * radius {
        LightCoverage::Partial(0.0)
    } else if cone.misses(offset, radius) {
        LightCoverage::Outside
    } else if cone.contains(offset, radius) {
        LightCoverage::Inside
    } else {
        LightCoverage::Partial(edge_width(light, cone, offset.length()))
    }
}

/// Width over which a light blurs the edge of its cone at a distance, at the least, scene units.
fn edge_width(light: &Light, cone: LightCone, distance: f64) -> f64 {
    // Other shapes may be narrow.
    let is_round = matches!(light.form, LightForm::Disk { .. } | LightForm::Sphere { .. });
    let radius = if is_round { light.radius } else { 0.0 };
    let (sin, cos) = cone.sin_cos();
    2.0 * radius.min(distance * sin) * cos.max(0.0)
}

/// Whether the radiance from a shader has no edges of its own.
fn is_smooth(shader: &Shader) -> bool {
    let steps = &shader.textures.steps;
    match &shader.kind {
        Kind::Glossy(glossy) => steps.is_empty() && !(glossy.is_smooth() && glossy.specularity > 0.0),
        // The texture makes it a retroreflector.
        Kind::Retro(_) => steps.iter().all(|step| matches!(step, Step::Texture(_))),
        Kind::Plugin(_) => steps.is_empty(),
        Kind::Emitter(emitter) => steps.is_empty() && emitter.cone.is_none(),
        _ => false,
    }
}
