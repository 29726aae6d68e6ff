//! What a surface makes of a ray that meets it.

use super::emission::placed_share;
use super::passage::Passage;
use super::segment::Segment;
use super::{Tracer, product};
use crate::cast::FirstHit;
use crate::geometry::is_flat;
use crate::options::Quantity;
use crate::ray::Hit;
use crate::shader::{Appearance, Kind, Shader, bands};
use crate::surface_light::{LitPoint, colored, pane};
use crate::tree::Image;
use crate::view::Encounter;
use glam::DVec3;
use std::f64::consts::PI;

impl<const BANDS: usize> Tracer<'_, BANDS> {
    /// What a ray finds that met a surface with this shader.
    pub(crate) fn shade(&mut self, segment: &Segment<BANDS>, hit: &Hit, shader: &Shader) {
        let behind = segment.ray.direction.dot(hit.front) > 0.0;
        let travelled = segment.travelled + hit.distance;
        let encounter = Encounter::at(&segment.ray, hit, travelled);
        self.note_hit(segment, hit, &encounter);
        let unseen = segment;
        let arrived;
        let segment = if self.plan.has_media {
            arrived = self.crossed(segment, hit, shader);
            &arrived
        } else {
            segment
        };
        if self.plan.options.quantity == Quantity::SurfaceIrradiance
            && segment.reflections == 0
            && segment.link.is_none()
        {
            match &shader.kind {
                Kind::Mixture(_) => {}
                kind if kind.emitter().is_some() => {}
                kind if kind.is_transparent() => return self.push(self.passed_through(*segment, hit)),
                _ => return self.shade_white(segment, hit, &encounter),
            }
        }
        if segment.link.is_some_and(|link| link.behind_illum) && !shader.matters_to_shadow_rays() {
            return;
        }
        match &shader.kind {
            Kind::Emitter(emitter) if !behind => {
                let share = if hit.placed.is_some() && segment.link.is_some() {
                    placed_share(emitter, hit.distance)
                } else {
                    self.emission_share(segment, hit.surface, emitter, hit.distance, encounter.cosine)
                };
                self.emit(segment, shader, emitter, &encounter, share);
            }
            Kind::Illum { emitter, substitute } => {
                self.shade_illum([segment, unseen], hit, shader, (emitter, *substitute), &encounter);
            }
            Kind::Mirror { substitute: Some(substitute), .. } if self.is_replaced(segment, *substitute, behind) => {
                self.shade_substitute([segment, unseen], hit, *substitute);
            }
            Kind::Mirror { reflectance, .. } if !behind => {
                self.shade_mirror(segment, hit, shader, bands(*reflectance), &encounter);
            }
            // From behind, lights and mirrors are black; what has no material and what only cuts was passed.
            Kind::Emitter(_) | Kind::Mirror { .. } | Kind::Transparent | Kind::Antimatter(_) => {}
            Kind::Mixture(mixture) => self.shade_mixture([segment, unseen], hit, (shader, mixture), &encounter),
            Kind::Unusable => {
                let _ = self.plan.unusable_met.set((hit.surface, hit.shader));
            }
            Kind::Glass { transmissivity, refractive_index } => {
                self.shade_glass(segment, hit, shader, (bands(*transmissivity), *refractive_index), &encounter);
            }
            Kind::Dielectric(boundary) => self.shade_dielectric(segment, hit, shader, boundary),
            Kind::Mist(mist) => self.shade_mist(segment, hit, shader, mist),
            Kind::Prism(prism) => self.shade_prism(segment, hit, prism, &encounter),
            Kind::Glossy(glossy) | Kind::Retro(glossy) => {
                let (appearance, normal) = self.appearance(segment, shader, &encounter);
                let retro = matches!(shader.kind, Kind::Retro(_));
                let color = colored(glossy, appearance.color);
                let point = LitPoint::glossy(glossy, retro, color, -encounter.direction, encounter.normal, normal)
                    .with_threshold(glossy, self.plan.options.highlight_threshold);
                if point.mirror.iter().any(|band| *band > 0.0) {
                    let direction = point.mirror_direction();
                    self.specular(segment, hit, direction, point.mirror, Passage::Other);
                }
                self.light_and_scatter(segment, hit.point, Some(hit.primitive), &point, travelled);
            }
            Kind::Scatterer(scatterer) => self.shade_scatterer(segment, hit, shader, scatterer, &encounter),
            Kind::Plugin(model) => {
                let (appearance, normal) = self.appearance(segment, shader, &encounter);
                let point = LitPoint::model(model.as_ref(), -encounter.direction, encounter.normal, normal);
                let patterned = Segment { throughput: product(segment.throughput, appearance.color), ..*segment };
                self.light_and_scatter(&patterned, hit.point, Some(hit.primitive), &point, travelled);
            }
        }
    }

    fn note_hit(&mut self, segment: &Segment<BANDS>, hit: &Hit, encounter: &Encounter) {
        if segment.depth == 0 && self.first_hit.is_none() {
            let hit = FirstHit::at(hit, encounter.total_distance);
            self.first_hit = Some(FirstHit { perturbed_normal: encounter.normal, ..hit });
        }
        if let Some(tree) = &mut self.tree {
            let hit = FirstHit::at(hit, hit.distance);
            tree.end(segment.node, FirstHit { perturbed_normal: encounter.normal, ..hit });
        }
        if segment.direct_view {
            self.effective_distance = self.effective_distance.min(encounter.total_distance);
        }
    }

    /// A measurement of irradiance where a surface is: the surface does not matter.
    fn shade_white(&mut self, segment: &Segment<BANDS>, hit: &Hit, encounter: &Encounter) {
        let point = LitPoint::white(-encounter.direction, encounter.normal);
        let segment = Segment { throughput: segment.throughput.map(|band| band * PI), ..*segment };
        self.light_and_scatter(&segment, hit.point, Some(hit.primitive), &point, encounter.total_distance);
    }

    /// Patterns and textures, and the normal that they make.
    pub(crate) fn appearance(
        &mut self,
        segment: &Segment<BANDS>,
        shader: &Shader,
        encounter: &Encounter,
    ) -> (Appearance<BANDS>, DVec3) {
        let appearance = shader.appearance(&self.plan.scene, encounter, &mut self.workspace.scratch);
        let normal = match &shader.kind {
            Kind::Retro(_) => encounter.normal,
            _ => shading_normal(encounter, appearance.perturbation),
        };
        let seen_normal = if matches!(shader.kind, Kind::Retro(_)) { -encounter.direction } else { normal };
        self.note_normal(segment, seen_normal);
        (appearance, normal)
    }

    fn shade_mirror(
        &mut self,
        segment: &Segment<BANDS>,
        hit: &Hit,
        shader: &Shader,
        reflectance: [f64; BANDS],
        encounter: &Encounter,
    ) {
        let (appearance, normal) = self.appearance(segment, shader, encounter);
        let mut direction = reflect(encounter.direction, normal);
        if direction.dot(encounter.normal) <= 0.0 {
            direction = reflect(encounter.direction, encounter.normal);
        }
        let straight = appearance.perturbation == DVec3::ZERO;
        let weight = product(reflectance, appearance.color);
        self.specular(segment, hit, direction, weight, Passage::Mirror { straight });
    }

    fn shade_glass(
        &mut self,
        segment: &Segment<BANDS>,
        hit: &Hit,
        shader: &Shader,
        (transmissivity, refractive_index): ([f64; BANDS], f64),
        encounter: &Encounter,
    ) {
        let (appearance, normal) = self.appearance(segment, shader, encounter);
        let cosine = -encounter.direction.dot(normal);
        let [reflected, transmitted] = pane(transmissivity, refractive_index, cosine.max(1e-9));
        let mut onward = encounter.direction;
        if appearance.perturbation != DVec3::ZERO {
            let bent = onward + appearance.perturbation * (2.0 * (1.0 - refractive_index));
            onward = bent.normalize_or(onward);
        }
        let undisturbed = onward == encounter.direction;
        let through = product(transmitted, appearance.color);
        self.specular(segment, hit, onward, through, Passage::Pane { undisturbed });
        let image = self.image_behind(hit, appearance.perturbation);
        self.specular(segment, hit, reflect(encounter.direction, normal), reflected, Passage::Reflection { image });
    }

    /// Where a mirror image in a surface appears.
    pub(crate) fn image_behind(&self, hit: &Hit, perturbation: DVec3) -> Image {
        Image::in_place_if(is_flat(self.plan.scene.surfaces[hit.surface].shape) && perturbation == DVec3::ZERO)
    }

    pub(crate) fn note_normal(&mut self, segment: &Segment<BANDS>, normal: DVec3) {
        if segment.depth == 0
            && !self.first_is_passed
            && let Some(first) = &mut self.first_hit
        {
            first.perturbed_normal = normal;
        }
        if let Some(tree) = &mut self.tree {
            tree.note_normal(segment.node, normal);
        }
    }
}

#[inline]
pub(crate) fn reflect(direction: DVec3, normal: DVec3) -> DVec3 {
    direction - normal * (2.0 * normal.dot(direction))
}

/// The normal with its texture; one that would turn away from the viewer is reflected back (Radiance's `raynormal`).
pub(crate) fn shading_normal(encounter: &Encounter, perturbation: DVec3) -> DVec3 {
    if perturbation == DVec3::ZERO {
        return encounter.normal;
    }
    let Some(normal) = (encounter.normal + perturbation).try_normalize() else { return encounter.normal };
    let cosine = -normal.dot(encounter.direction);
    if cosine > 0.0 { normal } else { normal + encounter.direction * (2.0 * cosine) }
}
