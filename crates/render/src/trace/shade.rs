//! Shading of a hit.

use super::PathIntegrator;
use super::emission::instance_emission_share;
use super::passage::Passage;
use super::path_state::PathState;
use crate::ray_tree::Image;
use glam::DVec3;
use radsight_accel::{Intersection, is_flat};
use radsight_bsdf::{Bsdf, HighlightShape, Scatterer, colored, pane, through_pane};
use radsight_compile::{FirstHit, Kind, Quantity, Shader, Substitution};
use radsight_texture::{Appearance, SurfaceInteraction, bands, mirrored, product, reflect, shading_normal};
use std::f64::consts::PI;

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// Shades a hit with this shader.
    pub(crate) fn shade(&mut self, path: &PathState<BANDS>, hit: &Intersection, shader: &Shader) {
        let behind = path.ray.direction.dot(hit.front) > 0.0;
        let travelled = path.travelled + hit.distance;
        let interaction = SurfaceInteraction::at(&path.ray, hit, travelled);
        let normal = if turns_its_normal(&shader.kind) { interaction.normal } else { hit.front };
        self.note_hit(path, hit, &interaction, normal);
        let unseen = path;
        let arrived;
        let path = if self.plan.has_media {
            arrived = self.crossed(path, hit, shader);
            &arrived
        } else {
            path
        };
        if self.plan.options.quantity == Quantity::SurfaceIrradiance && path.reflections == 0 && path.mis.is_none() {
            match &shader.kind {
                Kind::Mixture(_) => {}
                kind if kind.emitter().is_some() => {}
                // The bodies that it passes absorb nothing.
                _ if shader.passes_irradiance() => return self.push(self.passed_through(*unseen, hit)),
                _ => return self.shade_white(path, hit, &interaction),
            }
        }
        if path.mis.is_some_and(|mis| mis.behind_illum) && !shader.matters_to_shadow_rays() {
            return;
        }
        match &shader.kind {
            Kind::Emitter(emitter) if !behind => {
                let share = if hit.instance.is_some() && path.mis.is_some() {
                    if path.seeks_caustics() { 0.0 } else { instance_emission_share(emitter, hit.distance) }
                } else {
                    self.emission_share(path, hit.surface, emitter, hit.distance, interaction.cosine)
                };
                self.emit(path, shader, emitter, &interaction, share);
            }
            Kind::Illum { emitter, substitute } => {
                self.shade_illum([path, unseen], hit, shader, (emitter, *substitute), &interaction);
            }
            Kind::Mirror { substitute: Some(substitute), .. } if behind || self.is_replaced(path, *substitute) => {
                self.shade_substitute([path, unseen], hit, *substitute);
            }
            Kind::Mirror { reflectance, .. } if !behind => {
                self.shade_mirror(path, hit, shader, bands(*reflectance), &interaction);
            }
            // From behind, lights and mirrors are black; surfaces without a material and pure
            // antimatter were passed.
            Kind::Emitter(_) => self.note_dark_emitter(path, shader, &interaction),
            Kind::Mirror { .. } | Kind::Transparent | Kind::Antimatter(_) => {}
            Kind::Mixture(mixture) => self.shade_mixture([path, unseen], hit, (shader, mixture), &interaction),
            Kind::Unusable(_) => self.plan.note_unusable(hit.surface, shader),
            Kind::Glass { transmissivity, refractive_index } => {
                self.shade_glass(path, hit, shader, (bands(*transmissivity), *refractive_index), &interaction);
            }
            Kind::Dielectric(boundary) => self.shade_dielectric(path, hit, shader, boundary),
            Kind::Mist(mist) => self.shade_mist(path, hit, shader, mist),
            Kind::Prism(prism) => self.shade_prism(path, hit, prism, &interaction),
            Kind::Glossy(glossy) | Kind::Retro(glossy) => {
                let (appearance, normal) = self.appearance(path, shader, &interaction);
                let shape = match shader.kind {
                    Kind::Retro(_) => HighlightShape::Retro,
                    _ => HighlightShape::Mirror,
                };
                let color = colored(glossy, appearance.color);
                let mut point = Bsdf::glossy(glossy, shape, color, -interaction.direction, interaction.normal, normal);
                point.set_threshold(glossy, self.plan.options.highlight_threshold);
                if point.mirror.iter().any(|band| *band > 0.0) {
                    let direction = point.mirror_direction();
                    self.specular(path, hit, direction, point.mirror, Passage::Other);
                }
                self.light_and_scatter(path, hit.point, Some(hit.primitive), &point, travelled);
            }
            Kind::Scatterer(scatterer) => self.shade_scatterer(path, hit, shader, scatterer, &interaction),
            Kind::Plugin(model) => {
                let (appearance, normal) = self.appearance(path, shader, &interaction);
                let point = Bsdf::model(model.as_ref(), -interaction.direction, interaction.normal, normal);
                let patterned = PathState { throughput: product(path.throughput, appearance.color), ..*path };
                self.light_and_scatter(&patterned, hit.point, Some(hit.primitive), &point, travelled);
            }
        }
    }

    fn note_hit(
        &mut self,
        path: &PathState<BANDS>,
        hit: &Intersection,
        interaction: &SurfaceInteraction,
        normal: DVec3,
    ) {
        if path.depth == 0 && self.first_hit.is_none() {
            let hit = FirstHit::at(hit, interaction.total_distance);
            self.first_hit = Some(FirstHit { perturbed_normal: normal, ..hit });
        }
        self.note_surface(path, hit.shader.0);
        if let Some(tree) = &mut self.tree {
            let hit = FirstHit::at(hit, hit.distance);
            tree.end(path.node, FirstHit { perturbed_normal: normal, ..hit });
        }
        if path.direct_view {
            self.effective_distance = self.effective_distance.min(interaction.total_distance);
        }
    }

    /// Irradiance at a surface, whatever its material.
    fn shade_white(&mut self, path: &PathState<BANDS>, hit: &Intersection, interaction: &SurfaceInteraction) {
        let point = Bsdf::white(-interaction.direction, interaction.normal);
        let path = PathState { throughput: path.throughput.map(|band| band * PI), ..*path };
        self.light_and_scatter(&path, hit.point, Some(hit.primitive), &point, interaction.total_distance);
    }

    /// Patterns and textures, and the perturbed normal.
    pub(crate) fn appearance(
        &mut self,
        path: &PathState<BANDS>,
        shader: &Shader,
        interaction: &SurfaceInteraction,
    ) -> (Appearance<BANDS>, DVec3) {
        let appearance = shader.appearance(&self.plan.scene, interaction, &mut self.workspace.scratch);
        let normal = match &shader.kind {
            Kind::Retro(_) => interaction.normal,
            _ => shading_normal(interaction, appearance.perturbation),
        };
        let seen_normal = match &shader.kind {
            Kind::Retro(_) => -interaction.direction,
            kind if interaction.behind && !turns_its_normal(kind) => -normal,
            _ => normal,
        };
        self.note_normal(path, seen_normal);
        (appearance, normal)
    }

    fn shade_mirror(
        &mut self,
        path: &PathState<BANDS>,
        hit: &Intersection,
        shader: &Shader,
        reflectance: [f64; BANDS],
        interaction: &SurfaceInteraction,
    ) {
        let (appearance, normal) = self.appearance(path, shader, interaction);
        let direction = mirrored(interaction, normal);
        let straight = appearance.perturbation == DVec3::ZERO;
        let weight = product(reflectance, appearance.color);
        self.specular(path, hit, direction, weight, Passage::Mirror { straight });
    }

    fn shade_glass(
        &mut self,
        path: &PathState<BANDS>,
        hit: &Intersection,
        shader: &Shader,
        (transmissivity, refractive_index): ([f64; BANDS], f64),
        interaction: &SurfaceInteraction,
    ) {
        let (appearance, normal) = self.appearance(path, shader, interaction);
        let cosine = -interaction.direction.dot(normal);
        let [reflected, transmitted] = pane(transmissivity, refractive_index, cosine.max(1e-9));
        let direction = through_pane(interaction.direction, appearance.turn(), refractive_index);
        let undisturbed = direction == interaction.direction;
        let through = product(transmitted, appearance.color);
        let image = if appearance.perturbation == DVec3::ZERO { Image::InPlace } else { Image::AtSurface };
        self.specular(path, hit, direction, through, Passage::Pane { undisturbed, image });
        let image = self.image_behind(hit, appearance.perturbation);
        self.specular(path, hit, reflect(interaction.direction, normal), reflected, Passage::Reflection { image });
    }

    /// The apparent position of a mirror image in a surface.
    pub(crate) fn image_behind(&self, hit: &Intersection, perturbation: DVec3) -> Image {
        let is_exact = is_flat(self.plan.scene.surfaces[hit.surface].shape) && perturbation == DVec3::ZERO;
        if is_exact { Image::InPlace } else { Image::AtSurface }
    }

    pub(crate) fn note_normal(&mut self, path: &PathState<BANDS>, normal: DVec3) {
        // A ray that passed the first hit, or its void part, is not deeper.
        if path.depth == 0
            && let Some(first) = &mut self.first_hit
            && path.travelled < first.distance
        {
            first.perturbed_normal = normal;
        }
        if let Some(tree) = &mut self.tree {
            tree.note_normal(path.node, normal);
        }
    }
}

/// Whether the normal that `rtrace -on` prints is that of the side that the ray sees. As in
/// Radiance, emitters, mirrors, prisms, mist, `BRTDfunc` and `WGMDfunc` keep that of their front.
fn turns_its_normal(kind: &Kind) -> bool {
    match kind {
        Kind::Emitter(_) | Kind::Mist(_) | Kind::Prism(_) | Kind::Mirror { substitute: None, .. } => false,
        Kind::Scatterer(scatterer) => !matches!(**scatterer, Scatterer::Brtd(_) | Scatterer::WardFunction(_)),
        Kind::Illum { substitute, .. } => *substitute != Substitution::Void,
        _ => true,
    }
}
