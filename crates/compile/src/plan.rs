//! What a scene needs, decided once before the first ray.

use crate::first_hit::{FirstHit, material_name};
use crate::hierarchy_choice::HierarchyChoice;
use crate::medium::Medium;
use crate::mist_lights::MistLights;
use crate::options::{BackFaces, Caustics, GlobalMedium, RenderOptions, Skip};
use crate::portals::Portals;
use crate::reflectors::Reflector;
use crate::shader::{Kind, Shader, Substitution};
use crate::unbounded::Unbounded;
use crate::visibility_class::{Receiver, Visibility};
use radsight_accel::{Geometry, Identity, Intersection, MemberId, PrimitiveId, Ray, ShaderId, ShaderTable};
use radsight_diag::Diagnostic;
use radsight_ir::{Material, ModifierKind, SurfaceHandle, ValidScene};
use radsight_light::{Light, LightId, LightTree};
use radsight_texture::{BandLayout, bands};
use std::sync::{Arc, OnceLock};

/// A scene made ready for rays.
#[derive(Debug)]
pub struct RenderPlan {
    /// What is rendered.
    pub scene: ValidScene,
    /// How.
    pub options: RenderOptions,
    /// Where rays meet its surfaces.
    pub geometry: Geometry,
    /// How its hierarchies were built, and for how many rays.
    pub(crate) hierarchy: HierarchyChoice,
    /// By [`ShaderId`].
    pub shaders: Vec<Shader>,
    /// Which of them each modifier is.
    pub shader_table: ShaderTable,
    /// Real ones first, then their images in mirrors and prisms.
    pub lights: Vec<Light>,
    /// The lights, real and mirrored, of each surface that has any, sorted by surface.
    pub lights_of: Vec<(SurfaceHandle, LightId)>,
    /// From which some of them are drawn where they are many.
    pub light_tree: Option<LightTree>,
    /// How many: at points that are seen from the eye, and on paths that were scattered before; 0 where each light is sampled.
    pub light_draws: [u32; 2],
    /// Where light that is no light's comes in; none where no interreflection is followed.
    pub portals: Portals,
    /// Curved mirrors that may show lights.
    pub reflectors: Vec<Reflector>,
    /// Whether irradiance has details as fine as can be seen.
    pub has_caustics: bool,
    /// Distant sources in the order in which a ray that leaves the scene tries them.
    pub sky: Vec<Sky>,
    /// Which lights reach which primitive, and what stands between.
    pub reach: Visibility,
    /// Whether anything lets light through, or is taken to, so that a shadow ray goes on after a hit.
    pub see_through: bool,
    /// What lets light through in front of what it lies on, though it counts as opaque.
    pub veils: Vec<MemberId>,
    /// Whether anything bends or dims shadow rays, or stands in for something else, so that they are followed from surface to surface.
    pub shadows_bend: bool,
    /// Whether anything fills the space that rays cross.
    pub has_media: bool,
    /// Whether light sampling finds all the light of lights, so that drawn rays find none: light comes through mist as it would not to them.
    pub lights_are_covered: bool,
    /// Whether surfaces can be cut away.
    pub has_antimatter: bool,
    /// What can be cut away, ascending.
    pub cut_shaders: Vec<ShaderId>,
    /// The lights that mist scatters.
    pub mist_lights: MistLights,
    /// Whether interreflection is left out on the surfaces of a shader; empty for none.
    pub excluded: Vec<bool>,
    /// How many places the tracer has.
    pub bands: usize,
    /// Where each band stands in the arrays.
    pub layout: Arc<BandLayout>,
    /// The first surface with an unusable material that a ray met.
    pub unusable_met: OnceLock<(SurfaceHandle, ShaderId)>,
    /// Rays whose radiance no picture can hold.
    pub unbounded: Unbounded,
    pub(crate) decisions: Vec<PlanDecision>,
}

/// A distant source.
#[derive(Clone, Copy, Debug)]
pub struct Sky {
    /// The surface.
    pub surface: SurfaceHandle,
    /// Unit, towards its middle.
    pub direction: glam::DVec3,
    /// `sin²` of a quarter of the full angle: half of one minus the cosine of the half angle.
    pub cap: f64,
}

/// One decision of the plan, for `explain`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlanDecision {
    /// What is done or left out.
    pub what: String,
    /// Why.
    pub why: String,
    /// The work that is left out by it, if it leaves any out.
    pub skip: Option<Skip>,
}

impl RenderPlan {
    /// Whether paths by way of specular surfaces to lamps are solved for.
    #[must_use]
    pub fn samples_caustics(&self) -> bool {
        let are_followed = !self.has_antimatter && !self.lights_are_covered;
        self.options.caustics == Caustics::Sampled && are_followed && !self.reflectors.is_empty()
    }

    /// The error of a ray that met a surface whose material cannot be used; what was traced is then worthless.
    #[must_use]
    pub fn unusable_met(&self) -> Option<Diagnostic> {
        let (surface, shader) = *self.unusable_met.get()?;
        let name = self.scene.surface_name(surface);
        let shader = &self.shaders[shader.0 as usize];
        let (_, modifier) = shader
            .textures
            .home
            .scene(&self.scene)
            .chain(shader.modifier)
            .find(|(_, modifier)| matches!(modifier.kind, ModifierKind::Material(Material::Unusable { .. })))?;
        let ModifierKind::Material(Material::Unusable { reason }) = &modifier.kind else { return None };
        let error = Diagnostic::error(format!("a ray met \"{name}\", whose material cannot be used: {reason}"));
        Some(match modifier.span {
            Some(span) => error.at(span),
            None => error,
        })
    }

    /// What chooses the sample sequence.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.options.seed
    }

    /// How many bands are traced: one for a grey scene, else red, green and blue, or those of a spectrum.
    #[must_use]
    pub fn bands(&self) -> usize {
        if self.layout.sampling().is_rgb() { self.bands } else { self.layout.sampling().bands() }
    }

    /// The decisions, in words.
    #[must_use]
    pub fn decisions(&self) -> &[PlanDecision] {
        &self.decisions
    }

    /// How many surfaces a ray can meet.
    #[must_use]
    pub fn surface_count(&self) -> usize {
        self.geometry.len() + self.sky.len()
    }

    /// Whether any surface emits.
    #[must_use]
    pub fn has_emitters(&self) -> bool {
        self.shaders.iter().any(|shader| matches!(shader.kind, Kind::Emitter(_)))
    }

    /// Centre and radius of a sphere around all surfaces that have a place, scene units.
    #[must_use]
    pub fn bounding_sphere(&self) -> (glam::DVec3, f64) {
        self.geometry.bounding_sphere()
    }

    /// Whether some surface reflects diffusely and could light another one, but no interreflection is followed.
    #[must_use]
    pub fn leaves_out_interreflection(&self) -> bool {
        self.options.ambient_bounces == 0
            && self.geometry.members().any(|(member, handle)| {
                let reflects = match &self.shader(handle).kind {
                    Kind::Glossy(glossy) => glossy.specularity < 1.0 && !glossy.color.is_black(),
                    Kind::Scatterer(_) => true,
                    _ => false,
                };
                reflects && !self.reach.receiver(member.primitive()).is_some_and(|receiver| receiver.sees_only_lights)
            })
    }

    /// The names of the surface at which a ray ended, of its modifier and of its material, as Radiance tells them: those within an
    /// instance or a mesh, unless a modifier of their own overrides what is within.
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

    /// Where a ray ends: at the first surface, or at a distant source. Nothing is shaded, so the perturbed normal is the geometric one.
    #[must_use]
    pub fn cast(&self, ray: &Ray) -> Option<FirstHit> {
        match self.first_hit(ray, None) {
            Some(hit) => Some(FirstHit::at(&hit, hit.distance)),
            None => self.sky_at(ray.direction, false).map(|(surface, _)| FirstHit::distant(surface, ray.direction)),
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

    /// The first surface along a ray, `from` excluded where it is flat.
    #[inline]
    pub fn first_hit(&self, ray: &Ray, from: Option<PrimitiveId>) -> Option<Intersection> {
        self.geometry.first_hit(&self.scene, &self.shader_table, ray, from)
    }

    /// How far away the first surface along a ray is, scene units; `None` where there is none with a place.
    #[must_use]
    pub fn distance(&self, ray: &Ray) -> Option<f64> {
        self.geometry.distance(&self.scene, ray)
    }

    /// Memory of all hierarchies of boxes, with what the rays look up beside them, bytes.
    #[must_use]
    pub fn hierarchy_bytes(&self) -> usize {
        self.geometry.hierarchy_bytes()
    }

    /// Whether any surface that has a place crosses a ray before a distance in scene units, whatever it lets through.
    #[must_use]
    pub fn is_blocked(&self, ray: &Ray, distance: f64) -> bool {
        self.geometry.any_between(&self.scene, ray, None, distance, |_| true)
    }

    /// The shader of this number.
    #[inline]
    pub fn shader_at(&self, id: ShaderId) -> &Shader {
        &self.shaders[id.0 as usize]
    }

    /// The shader by which a surface relays lights: an illum's is that of its stand-in.
    #[inline]
    pub fn virtual_source_shader(&self, surface: SurfaceHandle) -> &Shader {
        virtual_source_shader(&self.shaders, self.shader(surface))
    }

    /// What fills the scene outside of all bodies.
    pub fn global_medium<const BANDS: usize>(&self) -> Medium<BANDS> {
        let GlobalMedium { extinction, albedo, eccentricity } = self.options.medium;
        Medium { extinction: bands(extinction), albedo: bands(albedo), eccentricity, lights: 0 }
    }

    /// Whether rays that meet a surface from behind pass it as if it were not there.
    #[inline]
    pub fn hides_its_back(&self, shader: &Shader) -> bool {
        self.options.back_faces == BackFaces::Invisible && shader.can_hide_its_back()
    }

    /// Whether diffuse interreflection is left out on the surfaces of a shader.
    #[inline]
    pub fn excludes_indirect(&self, shader: ShaderId) -> bool {
        self.excluded.get(shader.0 as usize).copied().unwrap_or(false)
    }

    /// The distant source that a ray along `direction` falls into, and what it shows; `drawn` rays see the light of an illum.
    pub fn sky_at(&self, direction: glam::DVec3, drawn: bool) -> Option<(SurfaceHandle, &Shader)> {
        // 1 − cos between the directions, from the chord: exact for the sun's quarter degree. The horizon belongs to the sky.
        let half_versed = |sky: &Sky| 0.25 * sky.direction.distance_squared(direction);
        let inside = self.sky.iter().filter(|sky| half_versed(sky) <= sky.cap * (1.0 + 1e-12));
        for sky in inside {
            let shader = self.shader(sky.surface);
            match &shader.kind {
                Kind::Illum { substitute: Substitution::Void, .. } if !drawn => {}
                Kind::Illum { .. } if !drawn => {
                    return Some((sky.surface, virtual_source_shader(&self.shaders, shader)));
                }
                _ => return Some((sky.surface, shader)),
            }
        }
        None
    }

    /// The lights, real and mirrored, of a surface.
    pub fn lights_of(&self, surface: SurfaceHandle) -> impl Iterator<Item = LightId> {
        let first = self.lights_of.partition_point(|(handle, _)| *handle < surface);
        self.lights_of[first..].iter().take_while(move |(handle, _)| *handle == surface).map(|(_, id)| *id)
    }

    /// What is known of the light at a primitive; `None` where it was not looked for.
    #[inline]
    pub fn receiver(&self, primitive: PrimitiveId) -> Option<&Receiver> {
        self.reach.receiver(primitive)
    }
}

/// An illum's stand-in, or else the shader itself.
pub(crate) fn virtual_source_shader<'a>(shaders: &'a [Shader], shader: &'a Shader) -> &'a Shader {
    match shader.kind {
        Kind::Illum { substitute: Substitution::Shader(id), .. } => &shaders[id.0 as usize],
        _ => shader,
    }
}
