//! Rays that end at an emitter, or leave the scene.

use super::CountedLight;
use super::PathIntegrator;
use super::path_state::PathState;
use crate::mis::Lobe;
use radsight_compile::{DISTANT, Emitter, EmitterType, FirstHit, IllumView, Kind, Lights, Shader, emission, given};
use radsight_ir::SurfaceHandle;
use radsight_texture::{SurfaceInteraction, product};

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// The ray leaves the scene: adds the first distant source in its direction.
    pub(super) fn leave(&mut self, path: &PathState<BANDS>) {
        let path = &self.dimmed(path, self.medium(path.medium), f64::INFINITY);
        let direction = path.ray.direction;
        let plan = self.plan;
        let view = if path.mis.is_some() { IllumView::Light } else { IllumView::Substitute };
        let Some((surface, shader)) = plan.sky_at(direction, view) else { return };
        if let Kind::Unusable(_) = &shader.kind {
            return plan.note_unusable(surface, shader);
        }
        let Some(emitter) = shader.kind.emitter() else { return };
        let interaction = SurfaceInteraction::distant(&path.ray);
        self.note_surface(path, DISTANT);
        if path.depth == 0 && self.first_hit.is_none() {
            self.first_hit = Some(FirstHit::distant(surface, direction));
        }
        if let Some(tree) = &mut self.tree {
            tree.end(path.node, FirstHit::distant(surface, direction));
        }
        let share = self.emission_share(path, surface, emitter, f64::INFINITY, 1.0);
        self.emit(path, shader, emitter, &interaction, share);
    }

    pub(crate) fn emit(
        &mut self,
        path: &PathState<BANDS>,
        shader: &Shader,
        emitter: &Emitter,
        interaction: &SurfaceInteraction,
        share: f64,
    ) {
        if share <= 0.0 {
            return;
        }
        let mut radiance: [f64; BANDS] =
            emission(&self.plan.scene, shader, emitter, interaction, &mut self.workspace.scratch);
        if share < 1.0 {
            radiance = given(radiance);
        }
        self.add(path, product(path.throughput, radiance).map(|band| band * share));
        if let Some(contributions) = &mut self.contributions {
            contributions.add(shader, interaction, product(path.throughput, radiance).map(|band| band * share));
        }
    }

    /// The weight of emission at a hit: 1, unless light sampling could have found it as well, or it
    /// does not count.
    pub(crate) fn emission_share(
        &mut self,
        path: &PathState<BANDS>,
        surface: SurfaceHandle,
        emitter: &Emitter,
        distance: f64,
        cosine: f64,
    ) -> f64 {
        let Some(mis) = &path.mis else {
            // A glow beyond its radius is not a light source, but an ordinary surface.
            let total = path.travelled + distance;
            let far = matches!(emitter.class, EmitterType::Glow(radius) if radius >= 0.0 && total > radius);
            let is_image = !far && path.depth > 0 && self.plan.lights_of(surface).next().is_some();
            let is_counted = match self.counted {
                CountedLight::All => true,
                CountedLight::WithoutImages => !is_image,
                CountedLight::Images => is_image,
            };
            let is_visible = far || self.plan.options.lights == Lights::Visible;
            return if is_counted && is_visible { 1.0 } else { 0.0 };
        };
        let is_sought = match mis.lobe {
            Lobe::Diffuse | Lobe::Highlight => true,
            Lobe::Caustic(caustic) => caustic.light == surface && caustic.chain == path.chain,
            Lobe::LargeImage(pdf) => self.is_large_image(mis, (path.chain, pdf), surface),
        };
        if !is_sought {
            return 0.0;
        }
        let overcounted = match emitter.class {
            EmitterType::Glow(radius) => mis.behind_illum || radius < 0.0,
            EmitterType::Illum => mis.behind_illum,
            EmitterType::Light => false,
        };
        if overcounted { 0.0 } else { mis.share(self.plan, surface, distance, cosine) }
    }
}

/// The weight of emission inside a mesh or an instance, where no light is sampled, for a sampled
/// ray: as in Radiance only glows beyond their radius take part in interreflection.
pub(super) fn instance_emission_share(emitter: &Emitter, distance: f64) -> f64 {
    match emitter.class {
        EmitterType::Glow(radius) if radius >= 0.0 && distance > radius => 1.0,
        _ => 0.0,
    }
}
