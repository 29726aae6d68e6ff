//! What a scene needs, decided once before the first ray.

use crate::antimatter::all_cut;
use crate::bands::BandLayout;
use crate::cast::FirstHit;
use crate::cast::material_name;
use crate::compile::compile_shaders;
use crate::contribution::mark_tracked;
use crate::direct::{ALWAYS_ALL, light_draws};
use crate::indirect::excluded;
use crate::light::{Light, LightId};
use crate::light_tree::LightTree;
use crate::lighting::collect_lights;
use crate::medium::{Medium, MistLights};
use crate::options::{BareSurfaces, GlobalMedium, RenderOptions, Skip};
use crate::portals::{Portals, makes_caustics};
use crate::shader::{Emitter, EmitterClass, Kind, Shader, Substitution, bands};
use crate::substance::substance;
use crate::veils::find_veils;
use crate::visibility_class::{Receiver, Visibility};
use radsight_accel::{Geometry, Identity, Intersection, MemberId, PrimitiveId, Ray, ShaderId, ShaderTable};
use radsight_brdf::Brdf;
use radsight_diag::{Diagnostic, Span};
use radsight_ir::{Material, ModifierKind, Shape, SurfaceHandle, ValidScene};
use std::sync::{Arc, OnceLock};

/// A scene made ready for rays.
#[derive(Debug)]
pub struct RenderPlan {
    pub(crate) scene: ValidScene,
    pub(crate) options: RenderOptions,
    pub(crate) geometry: Geometry,
    pub(crate) shaders: Vec<Shader>,
    /// Which of them each modifier is.
    pub(crate) shader_table: ShaderTable,
    pub(crate) lights: Vec<Light>,
    /// The lights, real and mirrored, of each surface that has any, sorted by surface.
    lights_of: Vec<(SurfaceHandle, LightId)>,
    /// From which some of them are drawn where they are many.
    pub(crate) light_tree: Option<LightTree>,
    /// How many: at points that are seen from the eye, and on paths that were scattered before; 0 where each light is sampled.
    pub(crate) light_draws: [u32; 2],
    /// Where light that is no light's comes in; none where no interreflection is followed.
    pub(crate) portals: Portals,
    /// Whether irradiance has details as fine as can be seen.
    pub(crate) has_caustics: bool,
    /// Distant sources in the order in which a ray that leaves the scene tries them.
    pub(crate) sky: Vec<Sky>,
    /// Which lights reach which primitive, and what stands between.
    pub(crate) reach: Visibility,
    /// Whether anything lets light through, or is taken to, so that a shadow ray goes on after a hit.
    pub(crate) see_through: bool,
    /// What lets light through in front of what it lies on, though it counts as opaque.
    pub(crate) veils: Vec<MemberId>,
    /// Whether anything bends or dims shadow rays, or stands in for something else, so that they are followed from surface to surface.
    pub(crate) shadows_bend: bool,
    /// Whether anything fills the space that rays cross.
    pub(crate) has_media: bool,
    /// Whether light sampling finds all the light of lights, so that drawn rays find none: light comes through mist as it would not to them.
    pub(crate) lights_are_covered: bool,
    /// Whether surfaces can be cut away.
    pub(crate) has_antimatter: bool,
    /// What can be cut away, ascending.
    pub(crate) cut_shaders: Vec<ShaderId>,
    /// The lights that mist scatters.
    pub(crate) mist_lights: MistLights,
    /// Whether interreflection is left out on the surfaces of a shader; empty for none.
    excluded: Vec<bool>,
    /// How many places the tracer has.
    pub(crate) bands: usize,
    pub(crate) layout: Arc<BandLayout>,
    /// The first surface with an unusable material that a ray met.
    pub(crate) unusable_met: OnceLock<(SurfaceHandle, ShaderId)>,
    decisions: Vec<PlanDecision>,
}

/// A distant source.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sky {
    pub(crate) surface: SurfaceHandle,
    pub(crate) direction: glam::DVec3,
    /// `sin²` of a quarter of the full angle: half of one minus the cosine of the half angle.
    pub(crate) cap: f64,
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
    /// Plans the rendering of a scene.
    ///
    /// # Errors
    /// What the scene uses and this renderer cannot do yet, each with its place in the scene text.
    pub fn new(
        scene: ValidScene,
        options: RenderOptions,
        models: &dyn ModelSource,
    ) -> Result<RenderPlan, Vec<Diagnostic>> {
        let layout = Arc::new(BandLayout::new(options.sampling));
        let colors = [options.ambient_value, options.medium.extinction, options.medium.albedo];
        let (mut shaders, shader_table, bands) = compile_shaders(&scene, models, &colors, &layout, options.skipping)?;
        mark_tracked(&mut shaders, &scene, &options.tracked_modifiers);
        let shader = |handle: SurfaceHandle| &shaders[shader_table.of(scene.surfaces[handle].modifier).0 as usize];
        let is_bare = |shader: &Shader| matches!(shader.kind, Kind::Transparent);
        let meets_bare = options.bare_surfaces == BareSurfaces::Met;
        let geometry = Geometry::build(&scene, substance, |handle| meets_bare || !is_bare(shader(handle)))
            .map_err(|error| vec![error])?;
        let virtual_source = |handle: SurfaceHandle| virtual_source_shader(&shaders, shader(handle));
        let lights = collect_lights(&scene, &geometry, shader, virtual_source, options.mirror_sources);
        let mut lights_of: Vec<_> =
            lights.iter().enumerate().map(|(id, light)| (light.surface, LightId(id as u32))).collect();
        lights_of.sort_by_key(|(surface, id)| (*surface, id.0));
        let sky = collect_sky(&scene, shader);
        let skipping = options.skipping;
        let may_skip = |skip| skipping.allows(skip);
        let any = |is: fn(&Kind) -> bool| shaders.iter().any(|shader| is(&shader.kind));
        let see_through = shaders.iter().any(|shader| shader.lets_light_through() || meets_bare && is_bare(shader))
            || geometry.holds_void(&scene, &shader_table, |id| shaders.get(id.0 as usize).is_some_and(is_bare));
        let veils = find_veils(&scene, &geometry, shader);
        let in_medium = !options.medium.extinction.is_black();
        let has_media = in_medium || any(|kind| matches!(kind, Kind::Dielectric(_) | Kind::Mist(_)));
        let stands_in = any(|kind| matches!(kind, Kind::Illum { .. } | Kind::Mirror { substitute: Some(_), .. }));
        let cut_shaders = all_cut(&shaders);
        let has_antimatter = any(|kind| matches!(kind, Kind::Antimatter(_)));
        let shadows_bend = has_media || stands_in || has_antimatter;
        let lights_are_covered = has_media
            && (!options.medium.albedo.is_black() || any(|kind| matches!(kind, Kind::Mist(mist) if mist.scatters())));
        let unsampled_sky = sky.iter().any(|sky| !lights.iter().any(|light| light.surface == sky.surface));
        let reach = if may_skip(Skip::Unreached) && !has_antimatter {
            Visibility::new(&scene, &geometry, shader, &lights, unsampled_sky || lights_are_covered)
        } else {
            Visibility::everything()
        };
        let mist_lights = MistLights::new(&scene, &lights, &mut shaders).map_err(|error| vec![error])?;
        let excluded = excluded(&scene, &shaders, &options.ambient_surfaces);
        let mut plan = RenderPlan {
            scene,
            options,
            geometry,
            shaders,
            shader_table,
            lights,
            lights_of,
            light_tree: None,
            light_draws: [0; 2],
            portals: Portals::default(),
            has_caustics: false,
            sky,
            reach,
            veils,
            see_through: see_through || !may_skip(Skip::BehindShadows),
            shadows_bend: shadows_bend || !may_skip(Skip::BentShadows),
            has_media: has_media || !may_skip(Skip::Media),
            has_antimatter: has_antimatter || !may_skip(Skip::Antimatter),
            cut_shaders,
            lights_are_covered,
            mist_lights,
            excluded,
            bands,
            layout,
            unusable_met: OnceLock::new(),
            decisions: Vec::new(),
        };
        plan.find_profiles();
        if plan.lights.len() > ALWAYS_ALL {
            plan.light_tree = Some(LightTree::new(&plan.lights, |light| plan.typical_radiance(light)));
        }
        plan.light_draws = light_draws(&plan);
        if plan.options.ambient_bounces > 0 {
            plan.portals = Portals::new(&plan);
            plan.has_caustics = makes_caustics(&plan);
        }
        plan.decisions = plan.decide();
        Ok(plan)
    }

    /// The error of a ray that met a surface whose material cannot be used; what was traced is then worthless.
    #[must_use]
    pub fn unusable_met(&self) -> Option<Diagnostic> {
        let (surface, shader) = *self.unusable_met.get()?;
        let name = self.scene.surface_name(surface);
        let shader = &self.shaders[shader.0 as usize];
        let (_, modifier) = shader
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

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &ValidScene {
        &self.scene
    }

    pub(crate) fn shader(&self, surface: SurfaceHandle) -> &Shader {
        self.shader_at(self.shader_table.of(self.scene.surfaces[surface].modifier))
    }

    /// The first surface along a ray, `from` excluded where it is flat.
    #[inline]
    pub(crate) fn first_hit(&self, ray: &Ray, from: Option<PrimitiveId>) -> Option<Intersection> {
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

    pub(crate) fn shader_at(&self, id: ShaderId) -> &Shader {
        &self.shaders[id.0 as usize]
    }

    /// The shader by which a surface relays lights: an illum's is that of its stand-in.
    pub(crate) fn virtual_source_shader(&self, surface: SurfaceHandle) -> &Shader {
        virtual_source_shader(&self.shaders, self.shader(surface))
    }

    /// What fills the scene outside of all bodies.
    pub(crate) fn global_medium<const BANDS: usize>(&self) -> Medium<BANDS> {
        let GlobalMedium { extinction, albedo, eccentricity } = self.options.medium;
        Medium { extinction: bands(extinction), albedo: bands(albedo), eccentricity, lights: 0 }
    }

    /// Whether diffuse interreflection is left out on the surfaces of a shader.
    pub(crate) fn excludes_indirect(&self, shader: ShaderId) -> bool {
        self.excluded.get(shader.0 as usize).copied().unwrap_or(false)
    }

    /// The distant source that a ray along `direction` falls into, and what it shows; `drawn` rays see the light of an illum.
    pub(crate) fn sky_at(&self, direction: glam::DVec3, drawn: bool) -> Option<(SurfaceHandle, &Shader)> {
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
    pub(crate) fn lights_of(&self, surface: SurfaceHandle) -> impl Iterator<Item = LightId> {
        let first = self.lights_of.partition_point(|(handle, _)| *handle < surface);
        self.lights_of[first..].iter().take_while(move |(handle, _)| *handle == surface).map(|(_, id)| *id)
    }

    pub(crate) fn receiver(&self, primitive: PrimitiveId) -> Option<&Receiver> {
        self.reach.receiver(primitive)
    }

    fn decide(&self) -> Vec<PlanDecision> {
        let mut decisions = Decisions::default();
        if !self.layout.sampling().is_rgb() {
            decisions.say(format!("{} bands are traced", self.bands()), "-cs");
        } else if self.bands == 1 {
            decisions.skip(Skip::EqualBands, "one band is traced".into(), "every colour that a surface uses is grey");
        } else {
            decisions.say("three bands are traced".into(), "some surface uses a colour or a colour pattern");
        }
        let primitives = self.geometry.len();
        let unseen = self.scene.surfaces.len() - primitives - self.scene.sources.len().min(self.scene.surfaces.len());
        decisions.say(format!("{primitives} surfaces are in the hierarchy"), "they have a place and a material");
        if unseen > 0 {
            decisions.say(format!("{unseen} surfaces are left out"), "rays pass through what has no material");
        }
        let images = self.lights.iter().filter(|light| !light.virtual_sources.is_empty()).count();
        decisions.say(
            format!("{} lights are sampled", self.lights.len() - images),
            "they are lights, spotlights or near glows",
        );
        if images > 0 {
            decisions.say(
                format!("{images} images of lights in plane mirrors are sampled"),
                "mirrors virtual_source lights (-dr)",
            );
        }
        let [drawn, again] = self.light_draws;
        if drawn > 0 {
            let what = format!("{drawn} of the lights are drawn at a point, {again} where light was scattered before");
            decisions.say(what, "they are many; a hierarchy of lights tells what they importance");
        }
        for (count, what, why) in self.reach.summary() {
            if count > 0 {
                decisions.skip(Skip::Unreached, format!("{count} {what}"), why);
            }
        }
        if self.options.ambient_bounces == 0 {
            decisions.say("diffuse interreflection is not followed".into(), "-ab 0");
        }
        if self.portals.len() > 0 {
            let what = format!("rays are sent towards {} portals", self.portals.len());
            decisions.say(what, "light of glows or of the sky comes in there");
        }
        if self.has_caustics {
            decisions
                .say("irradiance is looked for at every pixel where it bends".into(), "bodies of glass make caustics");
        }
        if !self.see_through {
            decisions.skip(
                Skip::BehindShadows,
                "a shadow ray ends at its first hit".into(),
                "nothing lets light through",
            );
        }
        if !self.shadows_bend {
            decisions.skip(Skip::BentShadows, "shadow rays are straight".into(), "nothing bends or dims them");
        }
        if !self.has_media {
            decisions.skip(Skip::Media, "rays cross empty space".into(), "no body and no mist fills it");
        }
        if !self.has_antimatter {
            decisions.skip(Skip::Antimatter, "no surface is cut away".into(), "there is no antimatter");
        }
        let functions = self.shaders.iter().flat_map(|shader| &shader.steps).count();
        let textures = self.shaders.iter().flat_map(|s| &s.steps).filter(|step| step.is_texture()).count();
        decisions
            .say(format!("{functions} patterns and textures are evaluated ({textures} textures)"), "surfaces use them");
        let mixtures = self.shaders.iter().filter(|shader| matches!(shader.kind, Kind::Mixture(_))).count();
        if mixtures > 0 {
            decisions.say(format!("{mixtures} mixtures of materials are evaluated"), "surfaces use them");
        }
        let retro = self.shaders.iter().filter(|shader| matches!(shader.kind, Kind::Retro(_))).count();
        if retro > 0 {
            decisions.say(
                format!("{retro} materials are sampled as a retroreflecting lobe"),
                "their texture turns the normal to the viewer under a rough highlight",
            );
        }
        decisions.0
    }
}

/// Decisions as they are made.
#[derive(Default)]
struct Decisions(Vec<PlanDecision>);

impl Decisions {
    fn say(&mut self, what: String, why: &str) {
        self.0.push(PlanDecision { what, why: why.to_owned(), skip: None });
    }

    /// One that leaves work out.
    fn skip(&mut self, skip: Skip, what: String, why: &str) {
        self.0.push(PlanDecision { what, why: why.to_owned(), skip: Some(skip) });
    }
}

/// A reflectance model that a scene asks for.
#[derive(Clone, Copy, Debug)]
pub struct ModelRequest<'a> {
    /// Name of the material.
    pub material: &'a str,
    /// Where the material stands.
    pub span: Option<Span>,
    /// File name of the library, without directory and suffix.
    pub library: &'a str,
    /// Model in the library.
    pub model: &'a str,
    /// Further words.
    pub words: &'a [String],
    /// Parameters.
    pub numbers: &'a [f64],
    /// Where library, model, words and numbers stand, one after the other; empty where they stand nowhere.
    pub tokens: &'a [Span],
    /// One, or red, green and blue.
    pub bands: usize,
}

/// Where the reflectance models that a scene names come from.
pub trait ModelSource {
    /// The model of a `brdfplugin` primitive.
    ///
    /// # Errors
    /// What is wrong, at its token.
    fn model(&self, request: &ModelRequest<'_>) -> Result<Arc<dyn Brdf>, Diagnostic>;
}

/// Knows no model.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoModels;

impl ModelSource for NoModels {
    fn model(&self, request: &ModelRequest<'_>) -> Result<Arc<dyn Brdf>, Diagnostic> {
        let ModelRequest { library, model, .. } = request;
        let error = Diagnostic::error(format!("no plugin \"{library}\" with a model \"{model}\" is at hand"));
        Err(match request.span {
            Some(span) => error.at(span),
            None => error,
        })
    }
}

/// An illum's stand-in, or else the shader itself.
fn virtual_source_shader<'a>(shaders: &'a [Shader], shader: &'a Shader) -> &'a Shader {
    match shader.kind {
        Kind::Illum { substitute: Substitution::Shader(id), .. } => &shaders[id.0 as usize],
        _ => shader,
    }
}

/// A ray takes the first light that it falls into, else the first illum that looks like nothing, else the first glow.
fn collect_sky<'a>(scene: &ValidScene, shader: impl Fn(SurfaceHandle) -> &'a Shader) -> Vec<Sky> {
    let rank = |kind: &Kind| match kind {
        Kind::Illum { substitute: Substitution::Void, .. } => 1,
        Kind::Emitter(Emitter { class: EmitterClass::Glow(_), .. }) => 2,
        _ => 0,
    };
    let mut sky: Vec<Sky> = scene
        .surfaces
        .iter()
        .filter(|(handle, _)| shader(*handle).kind.emitter().is_some_and(|emitter| !emitter.radiance.is_black()))
        .filter_map(|(handle, surface)| match surface.shape {
            Shape::Source(source) => {
                let source = scene.sources[source];
                let sin = (0.25 * source.extent.full_angle).sin();
                Some(Sky { surface: handle, direction: source.direction, cap: sin * sin })
            }
            _ => None,
        })
        .collect();
    sky.sort_by_key(|sky| rank(&shader(sky.surface).kind));
    sky
}
