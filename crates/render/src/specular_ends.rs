//! The ends of a ray behind mirrors and dielectrics.

use crate::retrace::{MAX_EVENTS, MirroredRay};
use crate::specular_chain::SpecularEvent;
use crate::trace::PathIntegrator;
use glam::DVec3;
use radsight_accel::{Intersection, PrimitiveId, Ray, is_flat};
use radsight_bsdf::pane;
use radsight_compile::{Kind, Shader};

/// Ends with less than this fraction of a ray's weight are not followed: a lamp is about ten thousand
/// times as bright as what it lights, and five reflections within glass leave less than a millionth.
const MIN_WEIGHT: f64 = 1e-4;

/// The same for images that are searched one by one: three reflections within glass leave less.
const MIN_IMAGE_WEIGHT: f64 = 0.01;

/// Maximum number of ends of a ray.
const MAX_ENDS: usize = 16;

/// The end of a ray behind mirrors and dielectrics. A dielectric divides a ray, so a ray has several.
#[derive(Clone, Copy, Debug)]
pub struct SpecularEnd {
    /// A bit for each reflection and refraction on its way, 1 for a reflection, after a leading 1.
    pub chain: u32,
    /// Number of mirrors on its way. Dielectrics and panes count twice: they show further images. Flat
    /// panes do not, if there are few.
    pub mirrors: usize,
    /// Fraction of the radiance that is left, by Fresnel's equations. Mirrors count as perfect.
    pub weight: f64,
    /// Whether a dielectric has refracted the ray.
    pub is_refracted: bool,
    /// From the last of them.
    pub ray: Ray,
}

impl SpecularEnd {
    /// The events on its way.
    fn events(&self) -> Vec<SpecularEvent> {
        let event = |bit: u32| match self.chain >> bit & 1 {
            0 => SpecularEvent::Transmitted,
            _ => SpecularEvent::Reflected,
        };
        (0..self.chain.ilog2()).rev().map(event).collect()
    }
}

/// A ray on its way.
struct Branch {
    from: Option<PrimitiveId>,
    end: SpecularEnd,
}

/// A part into which a surface divides a ray.
struct Part {
    event: SpecularEvent,
    direction: DVec3,
    /// Fraction of the radiance.
    weight: f64,
    /// How many mirrors the surface counts as.
    mirrors: usize,
    is_refracted: bool,
}

impl Branch {
    /// The branch that a part is; `None` if it is too weak to be followed.
    fn after(&self, hit: &Intersection, part: &Part) -> Option<Branch> {
        let end = SpecularEnd {
            chain: part.event.appended_to(self.end.chain),
            mirrors: self.end.mirrors + part.mirrors,
            weight: self.end.weight * part.weight,
            is_refracted: self.end.is_refracted || part.is_refracted,
            ray: Ray { origin: hit.point, direction: part.direction },
        };
        (end.weight >= MIN_WEIGHT).then_some(Branch { from: Some(hit.primitive), end })
    }
}

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// Adds the ends of a ray behind the mirrors and dielectrics to which it leads. Straight on through
    /// panes it has none.
    pub(crate) fn specular_ends(&mut self, ray: &Ray, ends: &mut Vec<SpecularEnd>) {
        let start = SpecularEnd { chain: 1, mirrors: 0, weight: 1.0, is_refracted: false, ray: *ray };
        let mut waiting = vec![Branch { from: None, end: start }];
        let most = ends.len() + MAX_ENDS;
        while let Some(branch) = waiting.pop() {
            let is_last = branch.end.chain >> MAX_EVENTS > 0;
            let hit = if is_last { None } else { self.next_visible(branch.end.ray, branch.from) };
            let goes_on = hit.is_some_and(|hit| self.divide(&branch, &hit, &mut waiting));
            if !goes_on && branch.end.mirrors > 0 && ends.len() < most {
                ends.push(branch.end);
            }
        }
    }

    /// The rays in which a light may be seen in mirrors: behind the first mirror, the second, and so on, and
    /// by way of dielectrics.
    pub(crate) fn image_rays(&mut self, start: (DVec3, Option<PrimitiveId>), direction: DVec3) -> Vec<MirroredRay> {
        let mut rays = self.mirrored_rays(start, direction);
        if self.plan.divides_rays {
            let mut ends = Vec::new();
            self.specular_ends(&Ray { origin: start.0, direction }, &mut ends);
            for end in ends.into_iter().filter(|end| end.weight >= MIN_IMAGE_WEIGHT) {
                let events = end.events();
                if !rays.iter().any(|known| known.events == events) {
                    rays.push(MirroredRay { ray: end.ray, events, chain: end.chain });
                }
            }
        }
        rays
    }

    /// Whether the images of lights that a pane reflects are known one by one.
    fn shows_one_image(&self, hit: &Intersection, shader: &Shader) -> bool {
        let plan = self.plan;
        let is_flat = hit.instance.is_none() && is_flat(plan.scene.surfaces[hit.surface].shape);
        is_flat && shader.textures.steps.is_empty() && !plan.flat_reflectors.surfaces.is_empty()
    }

    /// Adds the branches of a ray after a surface; whether it is a mirror, a pane or a dielectric.
    fn divide(&mut self, branch: &Branch, hit: &Intersection, waiting: &mut Vec<Branch>) -> bool {
        let shader = self.plan.shader_at(hit.shader);
        let ray = &branch.end.ray;
        let reflected = |direction: DVec3, weight: f64, mirrors: usize| {
            Some(Part { event: SpecularEvent::Reflected, direction, weight, mirrors, is_refracted: false })
        };
        let parts = if let Some(refraction) = self.refraction(ray, hit, shader) {
            let refracted = |(direction, _)| Part {
                event: SpecularEvent::Transmitted,
                direction,
                weight: 1.0 - refraction.reflectance,
                mirrors: 2,
                is_refracted: true,
            };
            let direction = refraction.reflected(ray.direction, hit.front);
            [reflected(direction, refraction.reflectance, 2), refraction.transmitted.map(refracted)]
        } else {
            let mut towards = |event| self.specular_direction(ray, hit, shader, event);
            let mirrored = towards(SpecularEvent::Reflected);
            if let Kind::Glass { refractive_index, .. } = &shader.kind {
                let transmitted = towards(SpecularEvent::Transmitted);
                let [[reflectance], _] = pane([1.0], *refractive_index, ray.direction.dot(hit.front).abs());
                let mirrors = if self.shows_one_image(hit, shader) { 1 } else { 2 };
                let passed = |direction| Part {
                    event: SpecularEvent::Transmitted,
                    direction,
                    weight: 1.0 - reflectance,
                    mirrors: 0,
                    is_refracted: false,
                };
                [mirrored.and_then(|direction| reflected(direction, reflectance, mirrors)), transmitted.map(passed)]
            } else if let Some(direction) = mirrored {
                [reflected(direction, 1.0, 1), None]
            } else {
                return false;
            }
        };
        waiting.extend(parts.iter().flatten().filter_map(|part| branch.after(hit, part)));
        true
    }
}
