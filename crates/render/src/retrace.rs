//! Rays that take a known way by way of mirrors and refracting bodies.

use crate::specular_chain::SpecularEvent;
use crate::trace::PathIntegrator;
use glam::DVec3;
use radsight_accel::{Intersection, PrimitiveId, Ray};
use radsight_bsdf::{Bsdf, BsdfContext, Scatterer, through_pane};
use radsight_compile::{BackFaces, Kind, Shader};
use radsight_texture::{SurfaceInteraction, mirrored, reflect, shading_normal};

/// A ray passes no more surfaces that do nothing to it.
const MAX_PASSED: u32 = 64;

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// The ray that a ray has become after these interactions; `None` where it has no such way.
    pub(crate) fn retrace(
        &mut self,
        mut ray: Ray,
        mut from: Option<PrimitiveId>,
        events: impl Iterator<Item = SpecularEvent>,
    ) -> Option<Ray> {
        for event in events {
            let hit = self.next_visible(ray, from)?;
            let direction = self.specular_direction(&ray, &hit, self.plan.shader_at(hit.shader), event)?;
            ray = Ray { origin: hit.point, direction };
            from = Some(hit.primitive);
        }
        Some(ray)
    }

    /// The first surface that does anything to a ray.
    pub(crate) fn next_visible(&self, mut ray: Ray, mut from: Option<PrimitiveId>) -> Option<Intersection> {
        for _ in 0..MAX_PASSED {
            let hit = self.plan.first_hit(&ray, from)?;
            let shader = self.plan.shader_at(hit.shader);
            let behind = ray.direction.dot(hit.front) > 0.0;
            let is_hidden =
                behind && self.plan.options.back_faces == BackFaces::Invisible && shader.can_hide_its_back();
            if !is_hidden && !matches!(shader.kind, Kind::Transparent) {
                return Some(hit);
            }
            ray.origin = hit.point;
            from = Some(hit.primitive);
        }
        None
    }

    /// Where a ray goes on from a surface; `None` where it does not in this way.
    pub(crate) fn specular_direction(
        &mut self,
        ray: &Ray,
        hit: &Intersection,
        shader: &Shader,
        event: SpecularEvent,
    ) -> Option<DVec3> {
        let interaction = SurfaceInteraction::at(ray, hit, hit.distance);
        let scene = &self.plan.scene;
        let scratch = &mut self.workspace.scratch;
        let is_reflected = event == SpecularEvent::Reflected;
        if let Kind::Dielectric(boundary) = &shader.kind {
            let (_, perturbation) = shader.body_appearance::<BANDS>(scene, &interaction, scratch);
            let met = boundary.refract(ray.direction, hit.front, perturbation);
            return if is_reflected {
                Some(met.reflected(ray.direction, hit.front))
            } else {
                met.transmitted.map(|(direction, _)| direction)
            };
        }
        if !matches!(shader.kind, Kind::Mirror { .. } | Kind::Glass { .. } | Kind::Glossy(_) | Kind::Scatterer(_)) {
            return None;
        }
        let appearance = shader.appearance::<BANDS>(scene, &interaction, scratch);
        let normal = shading_normal(&interaction, appearance.perturbation);
        match &shader.kind {
            Kind::Mirror { substitute: None, .. } if is_reflected && !interaction.behind => {
                Some(mirrored(&interaction, normal))
            }
            Kind::Glass { .. } if is_reflected => Some(reflect(interaction.direction, normal)),
            Kind::Glass { refractive_index, .. } => {
                Some(through_pane(interaction.direction, appearance.perturbation, *refractive_index))
            }
            Kind::Glossy(glossy) if is_reflected => {
                let color = appearance.color;
                let point = Bsdf::glossy(glossy, false, color, -interaction.direction, interaction.normal, normal);
                point.mirror.iter().any(|band| *band > 0.0).then(|| point.mirror_direction())
            }
            Kind::Scatterer(scatterer) if !matches!(**scatterer, Scatterer::Measured(_)) => {
                let turned = interaction.turned();
                let scene = shader.textures.home.scene(scene);
                let threshold = self.plan.options.highlight_threshold;
                let interaction = &interaction;
                let context = BsdfContext { scene, interaction, turned: &turned, appearance, normal, threshold };
                let met = scatterer.bsdf_at(&context, scratch);
                let bounce = if is_reflected { met.mirror } else { met.straight };
                bounce.map(|bounce| bounce.direction)
            }
            _ => None,
        }
    }
}
