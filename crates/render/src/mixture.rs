//! Mixtures of two materials.

use crate::trace::PathIntegrator;
use crate::trace::path_state::PathState;
use radsight_accel::Intersection;
use radsight_compile::{Kind, MixtureKind, Shader};
use radsight_texture::SurfaceInteraction;

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// Traces both parts, each with its weight, as in Radiance; if one has no material, the ray
    /// continues. The path is given with and without the medium in front of the surface.
    pub(crate) fn shade_mixture(
        &mut self,
        [path, unseen]: [&PathState<BANDS>; 2],
        hit: &Intersection,
        (shader, mixture): (&Shader, &MixtureKind),
        interaction: &SurfaceInteraction,
    ) {
        let plan = self.plan;
        let scene = shader.textures.home.scene(&plan.scene);
        let share = mixture.share.at(scene, interaction, &mut self.workspace.scratch);
        // After an error of the function the surface has no material.
        let mut passing = if share.is_some() { 0.0 } else { 1.0 };
        let weights = share.map_or([0.0; 2], |share| [share, 1.0 - share]);
        for (weight, id) in weights.into_iter().zip(mixture.arms) {
            let arm = plan.shader_at(id);
            let is_hidden = interaction.behind && plan.hides_its_back(arm);
            if matches!(arm.kind, Kind::Transparent) || is_hidden {
                passing += weight;
            } else if weight > 0.0 {
                let part = PathState {
                    throughput: unseen.throughput.map(|band| band * weight),
                    follows_no_diffuse: plan.excludes_indirect(id),
                    ..*unseen
                };
                self.shade(&part, &Intersection { shader: id, ..*hit }, arm);
            }
        }
        if passing > 0.0
            && let Some(throughput) = self.roulette(
                (path.throughput.map(|band| band * passing), path.pdf_ratio()),
                path,
                path.reflections,
                None,
            )
        {
            let next = self.passed_through(PathState { throughput, ..*path }, hit);
            self.push(next);
        }
    }
}
