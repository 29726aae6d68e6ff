//! Rays along a known chain of mirrors and dielectrics.

use crate::specular_chain::SpecularEvent;
use crate::trace::PathIntegrator;
use glam::DVec3;
use radsight_accel::{Intersection, PrimitiveId, Ray};
use radsight_bsdf::{Bsdf, BsdfContext, HighlightShape, Scatterer, through_pane};
use radsight_compile::{Kind, Refracted, Shader};
use radsight_texture::{SurfaceInteraction, mirrored, reflect, shading_normal};

/// Maximum number of surfaces without effect on a ray.
const MAX_PASSED: u32 = 64;

/// With more lights than this, searching each through mirrors costs more than it saves.
pub const MAX_LIGHTS: usize = 256;

/// Maximum number of mirrors, and of mirrors and panes, of a ray that searches for lights.
pub(crate) const MAX_MIRRORS: usize = 3;
pub(crate) const MAX_EVENTS: usize = 8;

/// A ray behind mirrors, with its chain.
pub(crate) struct MirroredRay {
    pub(crate) ray: Ray,
    pub(crate) events: Vec<SpecularEvent>,
    /// Distinguishes the chains of neighbouring rays: the number of mirrors, or that of
    /// [`SpecularEnd`](crate::SpecularEnd).
    pub(crate) chain: u32,
}

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// The ray after these interactions; `None` if it does not have them.
    pub(crate) fn retrace(
        &mut self,
        ray: Ray,
        from: Option<PrimitiveId>,
        events: impl Iterator<Item = SpecularEvent>,
    ) -> Option<Ray> {
        self.retraced(ray, from, events).map(|(ray, _)| ray)
    }

    /// The same, with its last point of reflection or refraction.
    pub(crate) fn retraced(
        &mut self,
        mut ray: Ray,
        mut from: Option<PrimitiveId>,
        events: impl Iterator<Item = SpecularEvent>,
    ) -> Option<(Ray, Option<PrimitiveId>)> {
        for event in events {
            let hit = self.next_visible(ray, from)?;
            let direction = self.specular_direction(&ray, &hit, self.plan.shader_at(hit.shader), event)?;
            ray = Ray { origin: hit.point, direction };
            from = Some(hit.primitive);
        }
        Some((ray, from))
    }

    /// The ray behind its first mirror, its second, and so on, through panes.
    pub(crate) fn mirrored_rays(
        &mut self,
        (origin, mut from): (DVec3, Option<PrimitiveId>),
        direction: DVec3,
    ) -> Vec<MirroredRay> {
        let (mut rays, mut events) = (Vec::new(), Vec::new());
        let mut ray = Ray { origin, direction };
        while rays.len() < MAX_MIRRORS && events.len() < MAX_EVENTS {
            let Some(hit) = self.next_visible(ray, from) else { break };
            let Some((event, direction)) = self.mirrored_step(&ray, &hit) else { break };
            ray = Ray { origin: hit.point, direction };
            from = Some(hit.primitive);
            events.push(event);
            if event == SpecularEvent::Reflected {
                let chain = rays.len() as u32 + 1;
                rays.push(MirroredRay { ray, events: events.clone(), chain });
            }
        }
        rays
    }

    /// One step of a ray that searches for mirrors: panes transmit it, other surfaces reflect it if
    /// they are mirrors.
    fn mirrored_step(&mut self, ray: &Ray, hit: &Intersection) -> Option<(SpecularEvent, DVec3)> {
        let shader = self.plan.shader_at(hit.shader);
        let event = match shader.kind {
            Kind::Glass { .. } => SpecularEvent::Transmitted,
            _ => SpecularEvent::Reflected,
        };
        self.specular_direction(ray, hit, shader, event).map(|direction| (event, direction))
    }

    /// The first surface with an effect on a ray.
    pub(crate) fn next_visible(&self, mut ray: Ray, mut from: Option<PrimitiveId>) -> Option<Intersection> {
        for _ in 0..MAX_PASSED {
            let hit = self.plan.first_hit(&ray, from)?;
            let shader = self.plan.shader_at(hit.shader);
            let behind = ray.direction.dot(hit.front) > 0.0;
            let does_nothing = matches!(shader.kind, Kind::Transparent) || behind && self.plan.hides_its_back(shader);
            if !does_nothing {
                return Some(hit);
            }
            ray.origin = hit.point;
            from = Some(hit.primitive);
        }
        None
    }

    /// Fraction of the light that a dielectric transmits, by Fresnel; `None` for other surfaces.
    pub(crate) fn transmittance(&mut self, ray: &Ray, hit: &Intersection, shader: &Shader) -> Option<f64> {
        self.refraction(ray, hit, shader).map(|refraction| 1.0 - refraction.reflectance)
    }

    /// The refraction of a ray by a dielectric; `None` for other surfaces.
    pub(crate) fn refraction(&mut self, ray: &Ray, hit: &Intersection, shader: &Shader) -> Option<Refracted> {
        let Kind::Dielectric(boundary) = &shader.kind else { return None };
        let interaction = SurfaceInteraction::at(ray, hit, hit.distance);
        let scene = &self.plan.scene;
        let (_, perturbation) = shader.body_appearance::<BANDS>(scene, &interaction, &mut self.workspace.scratch);
        Some(boundary.refract(ray.direction, hit.front, perturbation))
    }

    /// The direction of a ray after a specular event; `None` if the surface does not have it.
    pub(crate) fn specular_direction(
        &mut self,
        ray: &Ray,
        hit: &Intersection,
        shader: &Shader,
        event: SpecularEvent,
    ) -> Option<DVec3> {
        let is_reflected = event == SpecularEvent::Reflected;
        if let Some(refraction) = self.refraction(ray, hit, shader) {
            return if is_reflected {
                Some(refraction.reflected(ray.direction, hit.front))
            } else {
                refraction.transmitted.map(|(direction, _)| direction)
            };
        }
        if !matches!(shader.kind, Kind::Mirror { .. } | Kind::Glass { .. } | Kind::Glossy(_) | Kind::Scatterer(_)) {
            return None;
        }
        let interaction = SurfaceInteraction::at(ray, hit, hit.distance);
        let scene = &self.plan.scene;
        let scratch = &mut self.workspace.scratch;
        let appearance = shader.appearance::<BANDS>(scene, &interaction, scratch);
        let normal = shading_normal(&interaction, appearance.perturbation);
        match &shader.kind {
            Kind::Mirror { substitute: None, .. } if is_reflected && !interaction.behind => {
                Some(mirrored(&interaction, normal))
            }
            Kind::Glass { .. } if is_reflected => Some(reflect(interaction.direction, normal)),
            Kind::Glass { refractive_index, .. } => {
                Some(through_pane(interaction.direction, appearance.turn(), *refractive_index))
            }
            Kind::Glossy(glossy) if is_reflected => {
                let color = appearance.color;
                let point = Bsdf::glossy(
                    glossy,
                    HighlightShape::Mirror,
                    color,
                    -interaction.direction,
                    interaction.normal,
                    normal,
                );
                point.mirror.iter().any(|band| *band > 0.0).then(|| point.mirror_direction())
            }
            Kind::Scatterer(scatterer) if !matches!(**scatterer, Scatterer::Measured(_)) => {
                let turned = interaction.turned();
                let scene = shader.textures.home.scene(scene);
                let threshold = self.plan.options.highlight_threshold;
                let interaction = &interaction;
                let context = BsdfContext { scene, interaction, turned: &turned, appearance, normal, threshold };
                let scattering = scatterer.bsdf_at(&context, scratch);
                let bounce = if is_reflected { scattering.mirror } else { scattering.straight };
                bounce.map(|bounce| bounce.direction)
            }
            _ => None,
        }
    }
}
