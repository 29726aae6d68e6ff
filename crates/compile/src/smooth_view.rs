//! Rays whose radiance is a smooth function of the ray.
//!
//! A picture may be interpolated between pixels that see the same surface, lit by the same lights,
//! if nothing on the surface itself is sharp. Two rays whose [`SmoothView`]s join see such a
//! surface. They say nothing about what lies between the two rays.

use crate::plan::RenderPlan;
use crate::shader::{Kind, Shader};
use crate::visibility_class::VisibilityClass;
use glam::DVec3;
use radsight_accel::{Intersection, PrimitiveId, Ray};
use radsight_light::Light;
use radsight_texture::Step;

/// With more lights no view counts as smooth: each light takes a shadow ray and a bit of the view.
const MOST_LIGHTS: usize = 64;

/// Shadow rays are shortened by this fraction of their length.
const SHORT_OF_LIGHT: f64 = 1e-6;

/// The visible surface of a ray and the lights that reach it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothView {
    /// The primitive, `NONE` for no surface.
    primitive: PrimitiveId,
    /// A bit for each light whose centre is occluded.
    hidden: u64,
    /// A bit for each light whose cone excludes the point, and for each whose cone contains the
    /// point from everywhere on the light. In between, the light's extent blurs the edge of the
    /// cone.
    outside: u64,
    inside: u64,
}

impl SmoothView {
    /// Whether no edge is known between the two.
    #[must_use]
    pub fn joins(&self, other: &SmoothView) -> bool {
        let is_sharp = self.outside & other.inside | self.inside & other.outside != 0;
        self.primitive == other.primitive && self.hidden == other.hidden && !is_sharp
    }
}

/// How a light reaches a point.
enum LightCoverage {
    Hidden,
    /// The point is outside the light's cone.
    Outside,
    /// The point is inside the cone from all of the light.
    Inside,
    /// The point may be inside the cone from a part of the light.
    Partial,
}

impl RenderPlan {
    /// The view of a ray, if its radiance is smooth: without pattern, texture, mirror image and
    /// mist.
    #[must_use]
    pub fn smooth_view(&self, ray: &Ray) -> Option<SmoothView> {
        if self.has_media || self.has_antimatter || self.lights.len() > MOST_LIGHTS {
            return None;
        }
        let Some(hit) = self.first_hit(ray, None) else {
            let nothing = SmoothView { primitive: PrimitiveId::NONE, hidden: 0, outside: 0, inside: 0 };
            return self.sky.is_empty().then_some(nothing);
        };
        if !is_smooth(self.shader_at(hit.shader)) {
            return None;
        }
        let mut view = SmoothView { primitive: hit.primitive, hidden: 0, outside: 0, inside: 0 };
        for (index, light) in self.lights.iter().enumerate() {
            let bit = 1 << index;
            match self.coverage_of(&hit, index, light)? {
                LightCoverage::Hidden => view.hidden |= bit,
                LightCoverage::Outside => view.outside |= bit,
                LightCoverage::Inside => view.inside |= bit,
                LightCoverage::Partial => {}
            }
        }
        Some(view)
    }

    /// How a light reaches a point; `None` where it may be reflected by a mirror, whose outline is
    /// sharp.
    fn coverage_of(&self, hit: &Intersection, index: usize, light: &Light) -> Option<LightCoverage> {
        let is_free = match self.receiver(hit.primitive).map(|receiver| &receiver.between[index]) {
            Some(VisibilityClass::Dark) => return Some(LightCoverage::Outside),
            Some(VisibilityClass::Nothing) => true,
            _ => false,
        };
        if !light.virtual_sources.is_empty() {
            return light.misses(hit.point).then_some(LightCoverage::Outside);
        }
        match in_cone(light, hit.point) {
            LightCoverage::Outside => Some(LightCoverage::Outside),
            _ if !is_free && self.hides(hit, light) => Some(LightCoverage::Hidden),
            reach => Some(reach),
        }
    }

    /// Whether the centre of a light is occluded from a point.
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
        self.geometry.any_between(&self.scene, &ray, Some(hit.primitive), distance.max(0.0), |_| true)
    }
}

/// The position of a point relative to the cone of a light.
fn in_cone(light: &Light, point: DVec3) -> LightCoverage {
    let Some(cone) = light.cone.filter(|_| light.radius.is_finite()) else { return LightCoverage::Partial };
    if light.misses(point) {
        return LightCoverage::Outside;
    }
    let offset = point - light.center;
    let distance = offset.length();
    if distance <= light.radius {
        return LightCoverage::Partial;
    }
    // cos(a ± b), with b the angular radius of the light.
    let (sin, cos) = cone.half_angle.sin_cos();
    let sine = light.radius / distance;
    let (along, across) = (cos * (1.0 - sine * sine).sqrt(), sin * sine);
    let cosine = offset.dot(cone.axis) / distance;
    if cosine > along + across && cone.half_angle.sin() > sine { LightCoverage::Inside } else { LightCoverage::Partial }
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
