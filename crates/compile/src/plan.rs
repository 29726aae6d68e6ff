//! The render plan: what a scene needs, decided once before the first ray.

use crate::first_hit::{FirstHit, material_name};
use crate::hierarchy_choice::HierarchyChoice;
use crate::medium::Medium;
use crate::mist_lights::MistLights;
use crate::options::{BackFaces, Caustics, GlobalMedium, Lights, RenderOptions, Skip};
use crate::portals::Portals;
use crate::reflectors::{FlatReflectors, Reflector};
use crate::shader::{Kind, Shader, Substitution};
use crate::unbounded::Unbounded;
use crate::visibility_class::{Receiver, Visibility};
use radsight_accel::{Geometry, Identity, Intersection, MemberId, PrimitiveId, Ray, ShaderId, ShaderTable};
use radsight_diag::Diagnostic;
use radsight_ir::{Material, ModifierKind, SurfaceHandle, ValidScene};
use radsight_light::{Light, LightId, LightTree};
use radsight_texture::{BandLayout, bands};
use std::sync::{Arc, OnceLock};

/// A scene compiled for rendering.
#[derive(Debug)]
pub struct RenderPlan {
    /// The scene.
    pub scene: ValidScene,
    /// Rendering options.
    pub options: RenderOptions,
    /// Acceleration structure of its surfaces.
    pub geometry: Geometry,
    /// Builder of the hierarchies, and the number of rays it was chosen for.
    pub(crate) hierarchy: HierarchyChoice,
    /// Shaders by [`ShaderId`].
    pub shaders: Vec<Shader>,
    /// Shader of each modifier.
    pub shader_table: ShaderTable,
    /// Lights: first the real ones, then their images in mirrors and prisms.
    pub lights: Vec<Light>,
    /// Lights, real and virtual, of each emitting surface, sorted by surface.
    pub lights_of: Vec<(SurfaceHandle, LightId)>,
    /// Light tree for selection, if there are many lights.
    pub light_tree: Option<LightTree>,
    /// Number of lights selected at points seen from the eye, and on paths that were scattered
    /// before; 0 if every light is sampled.
    pub light_draws: [u32; 2],
    /// Portals of indirect light; empty if no interreflection is computed.
    pub portals: Portals,
    /// Curved mirrors that may reflect lights.
    pub reflectors: Vec<Reflector>,
    /// Flat specular surfaces that make no virtual sources.
    pub flat_reflectors: FlatReflectors,
    /// Whether indirect irradiance has caustics, with details as fine as pixels.
    pub has_caustics: bool,
    /// Distant sources, in the order in which a ray that leaves the scene tests them.
    pub sky: Vec<Sky>,
    /// Visibility between primitives and lights.
    pub visibility: Visibility,
    /// Whether anything transmits light (or must be assumed to), so that a shadow ray continues
    /// after a hit.
    pub see_through: bool,
    /// Transmitting surfaces that count as opaque and lie on other surfaces.
    pub veils: Vec<MemberId>,
    /// Whether anything refracts or attenuates shadow rays, or has an alternate material, so that
    /// they are traced from surface to surface.
    pub shadow_rays_interact: bool,
    /// Whether there are participating media.
    pub has_media: bool,
    /// Whether there are media other than the inside of dielectrics.
    pub has_mist: bool,
    /// Whether there are panes.
    pub has_panes: bool,
    /// Whether dielectrics or panes divide rays: lights are seen by way of both parts.
    pub divides_rays: bool,
    /// Whether light sampling accounts for all light of lights, so that BSDF samples ignore it:
    /// mist attenuates the two differently.
    pub lights_are_covered: bool,
    /// Whether surfaces can be subtracted by antimatter.
    pub has_antimatter: bool,
    /// Shaders that antimatter cuts, ascending.
    pub cut_shaders: Vec<ShaderId>,
    /// Lights that mist scatters.
    pub mist_lights: MistLights,
    /// Whether each shader's surfaces are without interreflection; empty if none are.
    pub excluded: Vec<bool>,
    /// Number of elements of a ray's band array.
    pub bands: usize,
    /// Layout of the bands in that array.
    pub layout: Arc<BandLayout>,
    /// The error of the first surface with an unusable modifier that a ray hit.
    pub(crate) unusable_hit: OnceLock<Diagnostic>,
    /// Counter of rays whose radiance exceeds the range of pictures.
    pub unbounded: Unbounded,
    /// Made for the first who asks.
    pub(crate) decisions: OnceLock<Vec<PlanDecision>>,
}

/// What a ray sees of an `illum`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IllumView {
    /// Its light: the ray searches for lights.
    Light,
    /// The alternate material.
    Substitute,
}

/// A distant source.
#[derive(Clone, Copy, Debug)]
pub struct Sky {
    /// Its surface.
    pub surface: SurfaceHandle,
    /// Unit vector towards its centre.
    pub direction: glam::DVec3,
    /// `sin²` of a quarter of the full angle, that is (1 − cos)/2 of the half angle.
    pub cap: f64,
}

/// A decision of the plan, for `explain`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlanDecision {
    /// What is done or skipped.
    pub what: String,
    /// Why.
    pub why: String,
    /// The work that is skipped, if any.
    pub skip: Option<Skip>,
}

impl RenderPlan {
    /// Whether specular paths to lamps are solved for.
    #[must_use]
    pub fn samples_caustics(&self) -> bool {
        let are_followed = !self.has_antimatter && !self.lights_are_covered;
        self.options.caustics == Caustics::Sampled && are_followed && !self.reflectors.is_empty()
    }

    /// Error that makes the picture invalid: a ray hit a surface whose material cannot be used, a
    /// reflectance model made a mistake, or functions took too many steps too often.
    #[must_use]
    pub fn fatal_fault(&self) -> Option<Diagnostic> {
        self.unusable_hit.get().cloned().or_else(|| self.faulty_model()).or_else(|| self.exhausted_function())
    }

    fn faulty_model(&self) -> Option<Diagnostic> {
        self.shaders.iter().find_map(|shader| {
            let Kind::Plugin(model) = &shader.kind else { return None };
            let error = Diagnostic::error(model.fault()?);
            let mut chain = shader.textures.home.scene(&self.scene).chain(shader.modifier);
            let material = chain.find(|(_, modifier)| matches!(modifier.kind, ModifierKind::Material(_)));
            Some(material.and_then(|(_, modifier)| modifier.span).into_iter().fold(error, Diagnostic::at))
        })
    }

    /// Records that a ray met a surface with an unusable modifier, of which the first is reported.
    pub fn note_unusable(&self, surface: SurfaceHandle, shader: &Shader) {
        self.unusable_hit.get_or_init(|| self.unusable(surface, shader));
    }

    /// The error of a distant source with an unusable modifier, which rays in its directions meet.
    #[must_use]
    pub fn unusable_sky(&self) -> Option<Diagnostic> {
        let mut of_sky = self.sky.iter().map(|sky| (sky.surface, self.shader(sky.surface)));
        let (surface, shader) = of_sky.find(|(_, shader)| matches!(shader.kind, Kind::Unusable(_)))?;
        Some(self.unusable(surface, shader))
    }

    fn unusable(&self, surface: SurfaceHandle, shader: &Shader) -> Diagnostic {
        let name = self.scene.surface_name(surface);
        let scene = shader.textures.home.scene(&self.scene);
        let modifier = match &shader.kind {
            Kind::Unusable(unusable) => Some(&scene.modifiers[unusable.modifier]),
            _ => None,
        };
        let reason = match modifier.map(|modifier| &modifier.kind) {
            Some(ModifierKind::Material(Material::Unusable { reason })) => reason,
            _ => "it has an error",
        };
        let error = Diagnostic::error(format!("a ray hit \"{name}\", whose material cannot be used: {reason}"));
        match modifier.and_then(|modifier| modifier.span) {
            Some(span) => error.at(span),
            None => error,
        }
    }

    /// Seed of the sample sequences.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.options.seed
    }

    /// Whether lights are visible.
    #[must_use]
    pub fn lights_seen(&self) -> Lights {
        self.options.lights
    }

    /// Number of traced bands: one for a grey scene, three for colour, or those of a spectrum.
    #[must_use]
    pub fn bands(&self) -> usize {
        if self.layout.sampling().is_rgb() { self.bands } else { self.layout.sampling().bands() }
    }

    /// The plan's decisions, as text.
    #[must_use]
    pub fn decisions(&self) -> &[PlanDecision] {
        self.decisions.get_or_init(|| self.decide())
    }

    /// Number of surfaces in the acceleration structure.
    #[must_use]
    pub fn surface_count(&self) -> usize {
        self.geometry.len() + self.sky.len()
    }

    /// Whether any surface emits.
    #[must_use]
    pub fn has_emitters(&self) -> bool {
        self.shaders.iter().any(|shader| shader.kind.emitter().is_some())
    }

    /// Centre and radius of the bounding sphere of all surfaces at a finite distance, scene units.
    #[must_use]
    pub fn bounding_sphere(&self) -> (glam::DVec3, f64) {
        self.geometry.bounding_sphere()
    }

    /// Whether a surface could light another one diffusely, but interreflection is off.
    #[must_use]
    pub fn leaves_out_interreflection(&self) -> bool {
        self.options.ambient_bounces == 0
            && self.geometry.members().any(|(member, handle)| {
                let reflects = match &self.shader(handle).kind {
                    Kind::Glossy(glossy) => glossy.specularity < 1.0 && !glossy.color.is_black(),
                    Kind::Scatterer(_) => true,
                    _ => false,
                };
                reflects
                    && !self.visibility.receiver(member.primitive()).is_some_and(|receiver| receiver.sees_only_lights)
            })
    }

    /// Names of a hit's surface, modifier and material, as Radiance reports them: those within an
    /// instance or mesh, unless the instance's own modifier overrides them.
    #[must_use]
    pub fn names_at(&self, hit: &FirstHit) -> [&str; 3] {
        if hit.primitive == PrimitiveId::NONE {
            let modifier = self.scene.surfaces[hit.surface].modifier;
            let material = material_name(&self.scene, modifier);
            return [self.scene.surface_name(hit.surface), self.scene.modifier_name(modifier), material];
        }
        let Identity { scene, name, modifier } = self.geometry.identify(&self.scene, hit.primitive);
        [name, scene.modifier_name(modifier), material_name(scene, modifier)]
    }

    /// First hit of a ray: a surface or a distant source. Nothing is shaded, so the perturbed
    /// normal is the geometric one.
    #[must_use]
    pub fn cast(&self, ray: &Ray) -> Option<FirstHit> {
        match self.first_hit(ray, None) {
            Some(hit) => Some(FirstHit::at(&hit, hit.distance)),
            None => self
                .sky_at(ray.direction, IllumView::Substitute)
                .map(|(surface, _)| FirstHit::distant(surface, ray.direction)),
        }
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &ValidScene {
        &self.scene
    }

    /// The shader of a surface.
    #[inline]
    pub fn shader(&self, surface: SurfaceHandle) -> &Shader {
        self.shader_at(self.shader_table.of(self.scene.surfaces[surface].modifier))
    }

    /// First surface along a ray; `from` is excluded if it is flat.
    #[inline]
    pub fn first_hit(&self, ray: &Ray, from: Option<PrimitiveId>) -> Option<Intersection> {
        self.geometry.first_hit(&self.scene, &self.shader_table, ray, from)
    }

    /// The same for a ray that probably hits a member which contains no others.
    #[inline]
    pub fn first_hit_near(
        &self,
        ray: &Ray,
        from: Option<PrimitiveId>,
        probable: Option<MemberId>,
    ) -> Option<Intersection> {
        self.geometry.first_hit_near(&self.scene, &self.shader_table, ray, from, probable)
    }

    /// Distance to the first surface along a ray, scene units; `None` if there is none at a finite
    /// distance.
    #[must_use]
    pub fn distance(&self, ray: &Ray) -> Option<f64> {
        self.geometry.distance(&self.scene, ray)
    }

    /// Memory of the acceleration structures, with the primitive tables, bytes.
    #[must_use]
    pub fn hierarchy_bytes(&self) -> usize {
        self.geometry.hierarchy_bytes()
    }

    /// Whether any surface crosses a ray before a distance in scene units, whatever it transmits.
    #[must_use]
    pub fn is_blocked(&self, ray: &Ray, distance: f64) -> bool {
        self.geometry.any_between(&self.scene, ray, (None, PrimitiveId::NONE), distance, |_| true)
    }

    /// Shader by id.
    #[inline]
    pub fn shader_at(&self, id: ShaderId) -> &Shader {
        &self.shaders[id.0 as usize]
    }

    /// Roughness (rms slope) of the mirror reflection or highlight of a compiled material; `None` if it has none that is
    /// known.
    #[must_use]
    pub fn mirror_roughness(&self, material: u32) -> Option<f64> {
        self.shaders.get(material as usize)?.mirror_roughness()
    }

    /// Whether any material has a mirror reflection or highlight of a known roughness.
    #[must_use]
    pub fn reflects_like_a_mirror(&self) -> bool {
        self.shaders.iter().any(|shader| shader.mirror_roughness().is_some())
    }

    /// Shader by which a surface makes virtual sources: for an illum that of its alternate
    /// material.
    #[inline]
    pub fn virtual_source_shader(&self, surface: SurfaceHandle) -> &Shader {
        virtual_source_shader(&self.shaders, self.shader(surface))
    }

    /// Medium around the scene.
    pub fn global_medium<const BANDS: usize>(&self) -> Medium<BANDS> {
        let GlobalMedium { extinction, albedo, eccentricity } = self.options.medium;
        Medium { extinction: bands(extinction), albedo: bands(albedo), eccentricity, lights: 0 }
    }

    /// Whether rays pass through a surface's back face.
    #[inline]
    pub fn hides_its_back(&self, shader: &Shader) -> bool {
        self.options.back_faces == BackFaces::Invisible && shader.can_hide_its_back()
    }

    /// Whether a shader's surfaces are without diffuse interreflection.
    #[inline]
    pub fn excludes_indirect(&self, shader: ShaderId) -> bool {
        self.excluded.get(shader.0 as usize).copied().unwrap_or(false)
    }

    /// Distant source that contains the direction, and its shader. `view` says what the ray
    /// sees of an illum.
    pub fn sky_at(&self, direction: glam::DVec3, view: IllumView) -> Option<(SurfaceHandle, &Shader)> {
        // (1 − cos)/2 of the angle between the directions, from the chord: exact even for the sun's
        // quarter degree. The horizon belongs to the sky.
        let half_versed = |sky: &Sky| 0.25 * sky.direction.distance_squared(direction);
        let inside = self.sky.iter().filter(|sky| half_versed(sky) <= sky.cap * (1.0 + 1e-12));
        for sky in inside {
            let shader = self.shader(sky.surface);
            match &shader.kind {
                Kind::Illum { substitute: Substitution::Void, .. } if view == IllumView::Substitute => {}
                Kind::Illum { .. } if view == IllumView::Substitute => {
                    return Some((sky.surface, virtual_source_shader(&self.shaders, shader)));
                }
                _ => return Some((sky.surface, shader)),
            }
        }
        None
    }

    /// Lights, real and virtual, of a surface.
    pub fn lights_of(&self, surface: SurfaceHandle) -> impl Iterator<Item = LightId> {
        let first = self.lights_of.partition_point(|(handle, _)| *handle < surface);
        self.lights_of[first..].iter().take_while(move |(handle, _)| *handle == surface).map(|(_, id)| *id)
    }

    /// Visibility of lights at a primitive; `None` if it was not computed.
    #[inline]
    pub fn receiver(&self, primitive: PrimitiveId) -> Option<&Receiver> {
        self.visibility.receiver(primitive)
    }
}

/// The alternate material of an illum, otherwise the shader itself.
pub(crate) fn virtual_source_shader<'a>(shaders: &'a [Shader], shader: &'a Shader) -> &'a Shader {
    match shader.kind {
        Kind::Illum { substitute: Substitution::Shader(id), .. } => &shaders[id.0 as usize],
        _ => shader,
    }
}
