//! Rays at scattering materials.

use super::PathIntegrator;
use super::passage::Passage;
use super::path_state::PathState;
use crate::ray_tree::Image;
use radsight_accel::Intersection;
use radsight_bsdf::{BsdfContext, MeasuredKind, MeasuredPart, Scatterer, SpecularBounce, SurfaceScattering};
use radsight_compile::Shader;
use radsight_sampling::DimensionSet;
use radsight_texture::{SurfaceInteraction, luminance};

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// A ray hits a scattering material.
    pub(crate) fn shade_scatterer(
        &mut self,
        path: &PathState<BANDS>,
        hit: &Intersection,
        shader: &Shader,
        scatterer: &Scatterer,
        interaction: &SurfaceInteraction,
    ) {
        if let Scatterer::Measured(kind) = scatterer {
            return self.shade_measured(path, hit, shader, kind, interaction);
        }
        let (appearance, normal) = self.appearance(path, shader, interaction);
        let turned = interaction.turned();
        let scene = shader.textures.home.scene(&self.plan.scene);
        let threshold = self.plan.options.highlight_threshold;
        let context = BsdfContext { scene, interaction, turned: &turned, appearance, normal, threshold };
        let scattering = scatterer.bsdf_at(&context, &mut self.workspace.scratch);
        if let Some(straight) = &scattering.straight {
            let undisturbed = straight.direction == interaction.direction;
            let passage = Passage::Sheet { undisturbed, image: image_beyond(&scattering, straight) };
            self.specular(path, hit, straight.direction, straight.weight, passage);
        }
        if let Some(mirror) = &scattering.mirror {
            self.specular(path, hit, mirror.direction, mirror.weight, Passage::Other);
        }
        self.light_and_scatter(path, hit.point, Some(hit.primitive), &scattering.point, interaction.total_distance);
    }

    /// A ray hits measured data, or passes their proxy geometry.
    fn shade_measured(
        &mut self,
        path: &PathState<BANDS>,
        hit: &Intersection,
        shader: &Shader,
        kind: &MeasuredKind,
        interaction: &SurfaceInteraction,
    ) {
        let thickness = kind.thickness(interaction, &mut self.workspace.scratch);
        if thickness != 0.0 && (!path.is_scattered() || (thickness > 0.0) == interaction.behind) {
            return self.pass_through(path, hit);
        }
        let (appearance, normal) = self.appearance(path, shader, interaction);
        let turned = interaction.turned();
        let scene = shader.textures.home.scene(&self.plan.scene);
        let threshold = self.plan.options.highlight_threshold;
        let context = BsdfContext { scene, interaction, turned: &turned, appearance, normal, threshold };
        let Some(pose) = kind.pose(&context, &mut self.workspace.scratch) else { return };
        if let Some(straight) = kind.straight(&context, &pose) {
            let passage = Passage::Sheet { undisturbed: true, image: Image::InPlace };
            self.specular(path, hit, straight.direction, straight.weight, passage);
        }
        let u = self.sampler.take(DimensionSet::render(self.next_set));
        self.next_set += 1;
        let view = kind.view(&pose, [u[0], u[1]]);
        let travelled = interaction.total_distance;
        if thickness == 0.0 {
            let point = kind.point(&context, &pose, view, MeasuredPart::Both);
            return self.light_and_scatter(path, hit.point, Some(hit.primitive), &point, travelled);
        }
        let reflected = kind.point(&context, &pose, view, MeasuredPart::Reflected);
        self.light_and_scatter(path, hit.point, Some(hit.primitive), &reflected, travelled);
        let transmitted = kind.point(&context, &pose, view, MeasuredPart::Transmitted);
        let far_side = hit.point - hit.front * thickness;
        self.light_and_scatter(path, far_side, None, &transmitted, travelled);
    }
}

/// Straight transmission keeps its apparent position if it exceeds scattered transmission.
fn image_beyond<const BANDS: usize>(
    scattering: &SurfaceScattering<'_, BANDS>,
    straight: &SpecularBounce<BANDS>,
) -> Image {
    let transmission =
        scattering.point.transmission.as_ref().map_or(0.0, |transmission| luminance(&transmission.diffuse));
    let is_stronger = luminance(&straight.weight) > transmission + luminance(&scattering.point.diffuse);
    if is_stronger { Image::InPlace } else { Image::AtSurface }
}
