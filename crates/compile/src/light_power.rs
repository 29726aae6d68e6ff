//! Estimates the radiance of lights, for light selection. A pattern, such as a luminaire's measured
//! distribution, is averaged over all directions.

use crate::emission::emission;
use crate::plan::RenderPlan;
use crate::shader::Shader;
use glam::DVec3;
use radsight_accel::Ray;
use radsight_cal::Scratch;
use radsight_ir::Rgb;
use radsight_light::{EmissionProfile, Light};
use radsight_texture::SurfaceInteraction;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

/// Number of directions in which a light's pattern is evaluated.
const DIRECTIONS: u32 = 16;

/// Maximum number of lights that get an emission profile: each takes milliseconds, and large lights
/// are few.
const MOST_PROFILES: usize = 16;

impl RenderPlan {
    /// Radiance of the strongest band, averaged over the light's emission directions, W/(sr·m²).
    pub fn typical_radiance(&self, light: &Light) -> f64 {
        let shader = self.shader(light.surface);
        let Some(emitter) = shader.kind.emitter() else { return 0.0 };
        if shader.textures.steps.is_empty() {
            let Rgb(radiance) = emitter.radiance;
            return radiance.into_iter().fold(0.0, f64::max);
        }
        // A virtual image has the radiance of its light.
        let light = self.lights_of(light.surface).next().map_or(light, |id| &self.lights[id.0 as usize]);
        let mut scratch = Scratch::default();
        let radiance_from = |index: u32| {
            let interaction =
                self.facing(light, [(f64::from(index) + 0.5) / f64::from(DIRECTIONS), f64::from(index) * GOLDEN]);
            self.strongest_emission(shader, &interaction, &mut scratch)
        };
        (0..DIRECTIONS).map(radiance_from).sum::<f64>() / f64::from(DIRECTIONS)
    }

    /// Radiance of an emitter's strongest band, W/(sr·m²); zero if the shader does not emit.
    pub fn strongest_emission(&self, shader: &Shader, interaction: &SurfaceInteraction, scratch: &mut Scratch) -> f64 {
        match self.bands {
            1 => self.strongest_of::<1>(shader, interaction, scratch),
            3 => self.strongest_of::<3>(shader, interaction, scratch),
            27 => self.strongest_of::<27>(shader, interaction, scratch),
            36 => self.strongest_of::<36>(shader, interaction, scratch),
            _ => self.strongest_of::<72>(shader, interaction, scratch),
        }
    }

    fn strongest_of<const BANDS: usize>(
        &self,
        shader: &Shader,
        interaction: &SurfaceInteraction,
        scratch: &mut Scratch,
    ) -> f64 {
        let Some(emitter) = shader.kind.emitter() else { return 0.0 };
        let radiance: [f64; BANDS] = emission(&self.scene, shader, emitter, interaction, scratch);
        radiance.into_iter().filter(|band| band.is_finite()).fold(0.0, f64::max)
    }

    /// Computes emission profiles of lights with a narrow distribution.
    pub fn find_profiles(&mut self) {
        let mut found: Vec<(EmissionSignature, Option<Arc<EmissionProfile>>)> = Vec::new();
        let lights = self.lights.iter().enumerate();
        let profiles: Vec<(usize, Option<Arc<EmissionProfile>>)> = lights
            .filter(|(_, light)| light.virtual_sources.is_empty() && light.cone.is_none())
            .filter(|(_, light)| !self.shader(light.surface).textures.steps.is_empty())
            .take(MOST_PROFILES)
            .map(|(index, light)| {
                let signature = self.emission_signature(light);
                let known = found.iter().find(|(other, _)| *other == signature).map(|(_, profile)| profile.clone());
                let profile = known.unwrap_or_else(|| {
                    let profile = self.profile(light).map(Arc::new);
                    found.push((signature, profile.clone()));
                    profile
                });
                (index, profile)
            })
            .collect();
        for (index, profile) in profiles {
            self.lights[index].profile = profile;
        }
    }

    /// The lamps of a ring have the same emission, so its profile is computed once. A profile that
    /// differs between these directions costs noise alone.
    fn emission_signature(&self, light: &Light) -> EmissionSignature {
        let (shader, mut scratch) = (self.shader(light.surface), Scratch::default());
        let radiance = |index: u32| {
            let unit = [(f64::from(index) + 0.5) / f64::from(DIRECTIONS), (f64::from(index) * GOLDEN).fract()];
            self.strongest_emission(shader, &self.facing(light, unit), &mut scratch)
        };
        let normal = light.form.plane().map(|(normal, _)| normal);
        EmissionSignature { normal, radiance: (0..DIRECTIONS).map(radiance).collect() }
    }

    fn profile(&self, light: &Light) -> Option<EmissionProfile> {
        let shader = self.shader(light.surface);
        let mut scratch = Scratch::default();
        EmissionProfile::new(&light.form, |out| {
            self.strongest_emission(shader, &self.seen_against(light, out), &mut scratch)
        })
    }

    /// Interaction at the light's centre, for a direction uniform over the light's emission by
    /// height (0…1) and azimuth.
    fn facing(&self, light: &Light, [height, turn]: [f64; 2]) -> SurfaceInteraction {
        let (axis, widest) = match (light.form.half_angle(), &light.cone, light.form.plane()) {
            (Some(half_angle), ..) => (light.center, half_angle),
            (_, Some(cone), _) => (cone.axis, cone.half_angle),
            (_, None, Some((normal, _))) => (normal, FRAC_PI_2),
            (_, None, None) => (DVec3::Z, PI),
        };
        let cos = 1.0 - height * (1.0 - widest.cos());
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let (x, y) = axis.any_orthonormal_pair();
        let (sin_turn, cos_turn) = (TAU * turn).sin_cos();
        let out = (axis * cos + (x * cos_turn + y * sin_turn) * sin).normalize();
        if light.radius.is_infinite() {
            return SurfaceInteraction::distant(&Ray { origin: self.bounding_sphere().0, direction: out });
        }
        self.seen_against(light, out)
    }

    /// Interaction at the centre of a light at a finite distance, seen against the unit emission
    /// direction `out`.
    fn seen_against(&self, light: &Light, out: DVec3) -> SurfaceInteraction {
        let normal = light.form.plane().map_or(out, |(normal, _)| normal);
        let distance = self.bounding_sphere().1;
        let ray = Ray { origin: light.center + out * distance, direction: -out };
        SurfaceInteraction::new(&ray, light.center, normal, distance, distance)
    }
}

/// The emission of a light in a few directions, and the unit normal of a flat one.
#[derive(PartialEq)]
struct EmissionSignature {
    normal: Option<DVec3>,
    radiance: Vec<f64>,
}

/// Fraction of a circle whose multiples never repeat (the golden section).
const GOLDEN: f64 = 0.618_033_988_749_895;
