//! Compiles chains of modifiers to shaders.

use crate::antimatter::Antimatter;
use crate::compile_scatter::compile_scatterer;
use crate::compile_steps::{ends_in_material, fold_constants, pattern_step, share, texture_step, transmitted};
use crate::medium::MistKind;
use crate::model_source::{ModelRequest, ModelSource};
use crate::native_model::native_or;
use crate::options::{Skip, Skipping};
use crate::prism::PrismKind;
use crate::refraction::DielectricInterface;
use crate::shader::{Emitter, EmitterType, Kind, MixtureKind, Shader, Substitution, Unusable};
use crate::specialise::turns_the_normal_to_the_viewer;
use crate::substance::substance;
use radsight_accel::{ShaderId, ShaderTable};
use radsight_bsdf::{Appearances, GlossyKind, MeasuredKind, Scatterer};
use radsight_diag::{Diagnostic, Span};
use radsight_ir::{
    Glossy, Material, Mixture, MixtureArms, Modifier, ModifierHandle, ModifierKind, Rgb, Scene, Shape, Substitute,
    ValidScene,
};
use radsight_texture::{BandLayout, Function, Home, MixedSteps, Step, TextureChain};
use std::collections::HashMap;
use std::sync::Arc;

/// Compiles one shader for each modifier that surfaces of this scene and of its instances use, and
/// decides the number of bands.
///
/// `surroundings` are colours from outside the scene. Models of plugins are first made for three
/// bands; if the scene turns out to be grey, they are made again for one. Spectra take as many
/// bands as their layout has.
pub(crate) fn compile_shaders(
    scene: &ValidScene,
    models: &dyn ModelSource,
    surroundings: &[Rgb],
    layout: &Arc<BandLayout>,
    skipping: Skipping,
) -> Result<(Vec<Shader>, ShaderTable, usize), Vec<Diagnostic>> {
    let (shaders, table) = compile_for(scene, models, 3, layout)?;
    if !layout.sampling().is_rgb() {
        return Ok((shaders, table, layout.elements()));
    }
    let may_be_grey = skipping.allows(Skip::EqualBands) && shaders.iter().all(Shader::is_grey);
    if !may_be_grey || !surroundings.iter().all(|color| color.is_grey()) {
        return Ok((shaders, table, 3));
    }
    if !shaders.iter().any(|shader| matches!(shader.kind, Kind::Plugin(_))) {
        return Ok((shaders, table, 1));
    }
    compile_for(scene, models, 1, layout).map(|(shaders, table)| (shaders, table, 1))
}

fn compile_for(
    scene: &Scene,
    models: &dyn ModelSource,
    bands: usize,
    layout: &Arc<BandLayout>,
) -> Result<(Vec<Shader>, ShaderTable), Vec<Diagnostic>> {
    let mut compiler = Compiler {
        models,
        bands,
        shaders: Vec::new(),
        errors: Vec::new(),
        octrees: HashMap::new(),
        layout: layout.clone(),
        mixtures: 0,
    };
    let table = compiler.compile_scene(scene, &Home::default(), Use::Shown);
    let Compiler { shaders, errors, .. } = compiler;
    if errors.is_empty() { Ok((shaders, table)) } else { Err(errors) }
}

struct Compiler<'a> {
    models: &'a dyn ModelSource,
    bands: usize,
    shaders: Vec<Shader>,
    errors: Vec<Diagnostic>,
    octrees: HashMap<(*const Scene, Use), Arc<ShaderTable>>,
    /// Spectral bands in which radiance is traced.
    layout: Arc<BandLayout>,
    /// Number of compiled mixtures, each counted wherever it is used.
    mixtures: usize,
}

/// Which modifiers of a scene are used: its own, or those of its instances, which override them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Use {
    Shown,
    Overridden,
}

/// Entry of a modifier that nothing uses.
const NO_SHADER: ShaderId = ShaderId(u32::MAX);

impl Compiler<'_> {
    fn compile_scene(&mut self, scene: &Scene, home: &Home, used: Use) -> ShaderTable {
        let mut of_modifier = vec![NO_SHADER; scene.modifiers.len() + 1];
        let of_surfaces = scene.surfaces.items().iter().map(|surface| surface.modifier);
        let of_triangles =
            scene.meshes.items().iter().flat_map(|mesh| &mesh.triangles).map(|triangle| triangle.modifier);
        let has_mixtures = scene.modifiers.items().iter().any(|m| matches!(m.kind, ModifierKind::Mixture(_)));
        let ends_in_material = if has_mixtures { ends_in_material(scene) } else { Vec::new() };
        let mut chains = Chains { scene, home, of_modifier: &mut of_modifier, ends_in_material, nesting: 0 };
        for modifier in of_surfaces.chain(of_triangles).filter(|_| used == Use::Shown) {
            self.compile_chain(&mut chains, modifier);
        }
        let mut uses = vec![Use::Overridden; scene.octrees.len()];
        for surface in scene.surfaces.items() {
            if let (Shape::Instance(handle), None) = (surface.shape, surface.modifier) {
                uses[scene.instances[handle].octree.index()] = used;
            }
        }
        let octrees =
            scene.octrees.items().iter().zip(uses).map(|(octree, used)| self.compile_octree(&octree.scene, used));
        let octrees = octrees.collect();
        ShaderTable::new(of_modifier, octrees)
    }

    /// Compiles a scene once, even if several instances place it.
    fn compile_octree(&mut self, scene: &Arc<Scene>, used: Use) -> Arc<ShaderTable> {
        let key = (Arc::as_ptr(scene), used);
        if let Some(known) = self.octrees.get(&key) {
            return known.clone();
        }
        let table = Arc::new(self.compile_scene(scene, &Home(Some(scene.clone())), used));
        self.octrees.insert(key, table.clone());
        table
    }

    /// Shader of a modifier, compiled once.
    fn compile_chain(&mut self, chains: &mut Chains<'_>, modifier: Option<ModifierHandle>) -> ShaderId {
        let index = modifier.map_or(0, |handle| handle.index() + 1);
        if chains.of_modifier[index] != NO_SHADER {
            return chains.of_modifier[index];
        }
        let above = TextureChain { transmitted: transmitted(chains.scene, modifier), ..chains.bare() };
        let id = self.compile_after(chains, modifier, &above);
        chains.of_modifier[index] = id;
        id
    }

    /// Shader of a chain that another modifier names, below the given textures of the surface.
    fn compile_below(
        &mut self,
        chains: &mut Chains<'_>,
        modifier: Option<ModifierHandle>,
        above: &TextureChain,
    ) -> ShaderId {
        // Nothing is above it, and as the modifier of a surface it would be the same.
        if above.steps.is_empty() && above.transmitted == transmitted(chains.scene, modifier) {
            return self.compile_chain(chains, modifier);
        }
        self.compile_after(chains, modifier, above)
    }

    /// Shader of a chain that continues the given one.
    fn compile_after(
        &mut self,
        chains: &mut Chains<'_>,
        modifier: Option<ModifierHandle>,
        above: &TextureChain,
    ) -> ShaderId {
        let nesting = chains.nesting;
        let (textures, kind) = self.compile(chains, modifier, above).unwrap_or_else(|unfit| match unfit {
            Unfit::Error(error) => {
                self.errors.push(error);
                (chains.bare(), Kind::Transparent)
            }
            Unfit::Unusable(unusable) => (chains.bare(), Kind::Unusable(unusable)),
        });
        chains.nesting = nesting;
        self.shaders.push(specialised(Shader {
            textures,
            kind,
            modifier,
            tracked: None,
            substance: substance(chains.scene, modifier),
        }));
        ShaderId((self.shaders.len() - 1) as u32)
    }

    /// The modifiers that antimatter cuts are defined before it, so there is no cycle.
    fn antimatter(
        &mut self,
        chains: &mut Chains<'_>,
        of: ModifierHandle,
        cuts: &[Option<ModifierHandle>],
        above: &TextureChain,
    ) -> Antimatter {
        let earlier = |modifier: &Option<ModifierHandle>| modifier.filter(|modifier| modifier.index() < of.index());
        let shade = cuts.first().and_then(earlier).map(|modifier| self.shade_of_cut(chains, modifier, above));
        let cuts = cuts.iter().filter_map(earlier).map(|modifier| self.compile_chain(chains, Some(modifier)));
        Antimatter::new(cuts.collect(), shade)
    }

    /// Shader of a cut's surface, which has the appearance from above the antimatter.
    fn shade_of_cut(&mut self, chains: &mut Chains<'_>, modifier: ModifierHandle, above: &TextureChain) -> ShaderId {
        if chains.nesting >= MAX_NESTING {
            return self.compile_chain(chains, Some(modifier));
        }
        let steps = if above.steps.is_empty() { Vec::new() } else { vec![Step::InsideOut(above.steps.clone())] };
        chains.nesting += 1;
        let id = self.compile_below(chains, Some(modifier), &TextureChain { steps, ..above.clone() });
        chains.nesting -= 1;
        id
    }

    /// Alternate material of a mirror or illum, with the appearance from above them; `None` if it
    /// has its own appearance.
    fn substitute(
        &mut self,
        chains: &mut Chains<'_>,
        of: ModifierHandle,
        substitute: Substitute,
        above: &TextureChain,
    ) -> Result<Option<Substitution>, Diagnostic> {
        let modifier = match substitute {
            Substitute::Own => return Ok(None),
            Substitute::Void => return Ok(Some(Substitution::Void)),
            Substitute::Modifier(modifier) => modifier,
        };
        // An alternate material is defined before its user, so there is no cycle.
        if modifier.index() >= of.index() || chains.nesting >= MAX_NESTING {
            let name = chains.scene.modifier_name(Some(of));
            let message = format!("the alternate materials of \"{name}\" are nested more than {MAX_NESTING} deep");
            return Err(at(chains.scene.modifiers[of].span, message));
        }
        chains.nesting += 1;
        let id = self.compile_below(chains, Some(modifier), above);
        chains.nesting -= 1;
        Ok(Some(Substitution::Shader(id)))
    }
}

/// Why a chain has no shader of its material.
enum Unfit {
    /// The picture cannot be made.
    Error(Diagnostic),
    /// The picture can be made as long as no ray meets the surface.
    Unusable(Unusable),
}

impl From<Diagnostic> for Unfit {
    fn from(error: Diagnostic) -> Unfit {
        Unfit::Error(error)
    }
}

impl Unfit {
    /// An unusable modifier that no shadow ray passes.
    fn opaque(modifier: ModifierHandle) -> Unfit {
        Unfit::Unusable(Unusable { modifier, lets_light_through: false })
    }

    /// An unusable modifier of what was found before it in the chain.
    fn below(scene: &Scene, found: Option<&Kind>, modifier: ModifierHandle) -> Unfit {
        let Some(kind) = found else { return Unfit::opaque(modifier) };
        match &scene.modifiers[modifier] {
            Modifier { kind: ModifierKind::Material(Material::Unusable { reason }), span, .. }
                if is_sought_by_light_samples(kind) =>
            {
                let name = scene.modifier_name(Some(modifier));
                at(*span, format!("modifier \"{name}\" cannot be used: {reason}")).into()
            }
            _ => Unfit::Unusable(Unusable { modifier, lets_light_through: passes_light(kind) }),
        }
    }

    fn second_material(scene: &Scene, modifier: ModifierHandle) -> Unfit {
        let name = scene.modifier_name(Some(modifier));
        at(scene.modifiers[modifier].span, format!("material \"{name}\" modifies another material")).into()
    }
}

/// Whether rays that look for light evaluate the appearance of the surface wherever they are lit
/// by it, without any ray that hits it by chance.
fn is_sought_by_light_samples(kind: &Kind) -> bool {
    match kind {
        Kind::Emitter(emitter) => !matches!(emitter.class, EmitterType::Glow(radius) if radius <= 0.0),
        Kind::Illum { .. } | Kind::Mirror { .. } | Kind::Prism(_) => true,
        _ => false,
    }
}

/// Whether shadow rays could pass a surface of this kind.
fn passes_light(kind: &Kind) -> bool {
    kind.is_transparent() || matches!(kind, Kind::Scatterer(scatterer) if scatterer.lets_through())
}

/// The modifier chains of one scene.
struct Chains<'s> {
    scene: &'s Scene,
    home: &'s Home,
    /// Shader by modifier; `void` is first.
    of_modifier: &'s mut Vec<ShaderId>,
    /// Whether each modifier ends in a material; empty without mixtures.
    ends_in_material: Vec<bool>,
    /// Current depth of nested alternate materials and mixtures.
    nesting: u32,
}

impl Chains<'_> {
    /// Textures of a chain without any modifier.
    fn bare(&self) -> TextureChain {
        TextureChain { home: self.home.clone(), ..TextureChain::default() }
    }

    fn is_material(&self, handle: ModifierHandle) -> bool {
        self.ends_in_material.get(handle.index()) == Some(&true)
    }
}

/// Maximum depth of nested alternate materials and mixtures.
const MAX_NESTING: u32 = 64;

/// Maximum number of mixtures, each counted wherever it is used.
const MAX_MIXTURES: usize = 1 << 17;

/// Maximum number of mixtures evaluated at one hit, which bounds the time of a ray.
const MAX_MIXTURES_OF_A_HIT: usize = 1 << 12;

fn not_yet(what: &str, span: Option<Span>) -> Diagnostic {
    at(span, format!("{what} cannot be rendered yet"))
}

fn at(span: Option<Span>, message: String) -> Diagnostic {
    let error = Diagnostic::error(message);
    match span {
        Some(span) => error.at(span),
        None => error,
    }
}

impl Compiler<'_> {
    /// Textures and material of a chain that continues the given one.
    fn compile(
        &mut self,
        chains: &mut Chains<'_>,
        first: Option<ModifierHandle>,
        above: &TextureChain,
    ) -> Result<(TextureChain, Kind), Unfit> {
        let scene = chains.scene;
        let mut textures = above.clone();
        let mut found = None;
        for (handle, modifier) in scene.chain(first) {
            match &modifier.kind {
                ModifierKind::Texture(texture) => textures.steps.extend(texture_step(texture)),
                ModifierKind::Pattern(pattern) => {
                    textures.steps.extend(pattern_step(scene, modifier, pattern, &self.layout)?);
                }
                ModifierKind::Mixture(mixture) if !chains.is_material(handle) => {
                    textures.steps.push(self.mixed_steps(chains, modifier, mixture)?);
                }
                // An unusable modifier can be of any kind.
                ModifierKind::Material(Material::Unusable { .. }) => {
                    return Err(Unfit::below(scene, found.as_ref(), handle));
                }
                ModifierKind::Mixture(mixture) if found.is_some() => {
                    return Err(match self.mixed_steps(chains, modifier, mixture) {
                        Err(Unfit::Unusable(part)) => Unfit::below(scene, found.as_ref(), part.modifier),
                        _ => Unfit::second_material(scene, handle),
                    });
                }
                _ if found.is_some() => return Err(Unfit::second_material(scene, handle)),
                ModifierKind::Mixture(mixture) => {
                    found = Some(self.mixed_materials(chains, modifier, mixture, &textures)?);
                    // The mixture's parts include these steps.
                    textures.steps.clear();
                }
                ModifierKind::Material(material) => {
                    found = Some(self.compile_material(chains, handle, material, &textures)?);
                }
            }
        }
        let Some(mut kind) = found else { return Ok((chains.bare(), Kind::Transparent)) };
        fold_constants(&mut textures.steps, &mut kind);
        Ok((textures, kind))
    }

    fn mixed_steps(&mut self, chains: &mut Chains<'_>, modifier: &Modifier, mixture: &Mixture) -> Result<Step, Unfit> {
        self.enter(chains, modifier)?;
        let share = share(chains.scene, modifier, &mixture.amount)?;
        let mut steps = |arm| self.steps_alone(chains, arm);
        let (foreground, background) = (steps(mixture.arms.foreground)?, steps(mixture.arms.background)?);
        chains.nesting -= 1;
        Ok(Step::Mixture(Box::new(MixedSteps { share, foreground, background })))
    }

    /// Steps of a chain without a material.
    fn steps_alone(&mut self, chains: &mut Chains<'_>, first: Option<ModifierHandle>) -> Result<Vec<Step>, Unfit> {
        let scene = chains.scene;
        let mut steps = Vec::new();
        for (handle, modifier) in scene.chain(first) {
            match &modifier.kind {
                ModifierKind::Texture(texture) => steps.extend(texture_step(texture)),
                ModifierKind::Pattern(pattern) => steps.extend(pattern_step(scene, modifier, pattern, &self.layout)?),
                ModifierKind::Mixture(mixture) => steps.push(self.mixed_steps(chains, modifier, mixture)?),
                ModifierKind::Material(Material::Unusable { .. }) => {
                    return Err(Unfit::Unusable(Unusable { modifier: handle, lets_light_through: true }));
                }
                ModifierKind::Material(_) => {
                    let message = "expected a pattern or a texture, found a material".to_owned();
                    return Err(at(modifier.span, message).into());
                }
            }
        }
        Ok(steps)
    }

    /// Patterns and textures of a modifier that a material names in addition to its own, after
    /// those above the material.
    fn compile_appearances(
        &mut self,
        chains: &mut Chains<'_>,
        first: Option<ModifierHandle>,
        above: &TextureChain,
    ) -> Result<Appearances, Unfit> {
        let mut textures = above.clone();
        textures.steps.extend(self.steps_alone(chains, first)?);
        Ok(Appearances::Own(Box::new(textures)))
    }

    fn mixed_materials(
        &mut self,
        chains: &mut Chains<'_>,
        modifier: &Modifier,
        mixture: &Mixture,
        above: &TextureChain,
    ) -> Result<Kind, Unfit> {
        if let Some(parent) = modifier.modifier {
            let name = chains.scene.names.get(modifier.name);
            let parent = chains.scene.modifier_name(Some(parent));
            return Err(at(
                modifier.span,
                format!("\"{parent}\" modifies \"{name}\", but a mixture of materials cannot have a modifier"),
            )
            .into());
        }
        self.enter(chains, modifier)?;
        let share = share(chains.scene, modifier, &mixture.amount)?;
        let MixtureArms { foreground, background } = mixture.arms;
        let arms = [foreground, background].map(|arm| self.compile_below(chains, arm, above));
        chains.nesting -= 1;
        let lets_light_through = arms.iter().any(|arm| self.shaders[arm.0 as usize].passes_shadow_rays());
        let (mixtures, depth) = self.size_of_mixture(chains, modifier, arms)?;
        Ok(Kind::Mixture(Box::new(MixtureKind { share, arms, lets_light_through, mixtures, depth })))
    }

    /// Number of mixtures that one hit on a mixture of these parts evaluates, and their depth.
    ///
    /// A part is compiled once, but each ray evaluates it wherever it is used. If each mixture
    /// mixes the one before it twice, every line of the scene doubles the work.
    fn size_of_mixture(
        &self,
        chains: &Chains<'_>,
        modifier: &Modifier,
        arms: [ShaderId; 2],
    ) -> Result<(usize, u32), Diagnostic> {
        let [foreground, background] = arms.map(|arm| match &self.shaders[arm.0 as usize].kind {
            Kind::Mixture(mixture) => (mixture.mixtures, mixture.depth),
            _ => (0, 0),
        });
        let (mixtures, depth) = (1 + foreground.0 + background.0, 1 + foreground.1.max(background.1));
        let name = chains.scene.names.get(modifier.name);
        if depth > MAX_NESTING {
            return Err(at(modifier.span, format!("mixture \"{name}\" is nested more than {MAX_NESTING} deep")));
        }
        if mixtures > MAX_MIXTURES_OF_A_HIT {
            let message = format!(
                "mixture \"{name}\" holds {mixtures} mixtures, each counted wherever it is used; at most \
                 {MAX_MIXTURES_OF_A_HIT} are evaluated"
            );
            return Err(at(modifier.span, message));
        }
        Ok((mixtures, depth))
    }

    /// Counts a mixture when its compilation begins: the mixtures within it are compiled for each
    /// of its uses.
    fn enter(&mut self, chains: &mut Chains<'_>, modifier: &Modifier) -> Result<(), Diagnostic> {
        chains.nesting += 1;
        self.mixtures += 1;
        let name = chains.scene.names.get(modifier.name);
        if chains.nesting > MAX_NESTING {
            return Err(at(modifier.span, format!("mixture \"{name}\" is nested more than {MAX_NESTING} deep")));
        }
        if self.mixtures > MAX_MIXTURES {
            return Err(at(
                modifier.span,
                format!(
                    "mixture \"{name}\" exceeds the limit of {MAX_MIXTURES} mixtures, each counted wherever it is used"
                ),
            ));
        }
        Ok(())
    }

    fn compile_material(
        &mut self,
        chains: &mut Chains<'_>,
        handle: ModifierHandle,
        material: &Material,
        above: &TextureChain,
    ) -> Result<Kind, Unfit> {
        let Compiler { models, bands, .. } = *self;
        let scene = chains.scene;
        let modifier = &scene.modifiers[handle];
        if let Some(request) = ModelRequest::of(scene, modifier, bands) {
            return Ok(Kind::Plugin(native_or(models, &request)?));
        }
        let glossy = |surface: &Glossy, metallic| GlossyKind {
            color: surface.color,
            specularity: surface.specularity,
            roughness: surface.roughness,
            metallic,
        };
        match material {
            Material::Light { radiance } => Ok(Kind::Emitter(Emitter::light(*radiance))),
            Material::Glow { radiance, max_radius } => {
                Ok(Kind::Emitter(Emitter { class: EmitterType::Glow(*max_radius), ..Emitter::light(*radiance) }))
            }
            Material::Spotlight { radiance, cone_angle, direction, .. } => {
                let cone = Some(((0.5 * cone_angle).cos(), *direction));
                Ok(Kind::Emitter(Emitter { cone, ..Emitter::light(*radiance) }))
            }
            Material::Illum { radiance, substitute } => {
                let substitute = self.substitute(chains, handle, *substitute, above)?.unwrap_or(Substitution::Void);
                let emitter = Emitter { class: EmitterType::Illum, ..Emitter::light(*radiance) };
                Ok(Kind::Illum { emitter, substitute })
            }
            Material::Plastic(surface) => Ok(Kind::Glossy(glossy(surface, false))),
            Material::Metal(surface) => Ok(Kind::Glossy(glossy(surface, true))),
            Material::Mirror { reflectance, substitute } => {
                let substitute = self.substitute(chains, handle, *substitute, above)?;
                Ok(Kind::Mirror { reflectance: *reflectance, substitute })
            }
            Material::Dielectric(body) => Ok(Kind::Dielectric(DielectricInterface::of_body(body))),
            Material::Interface(interface) => Ok(Kind::Dielectric(DielectricInterface::between(interface))),
            Material::Mist(mist) => Ok(Kind::Mist(MistKind::new(mist))),
            Material::Prism(prism) => Ok(Kind::Prism(PrismKind::new(prism))),
            Material::Glass { transmissivity, refractive_index } => {
                Ok(Kind::Glass { transmissivity: *transmissivity, refractive_index: *refractive_index })
            }
            Material::Antimatter { cuts } => Ok(Kind::Antimatter(self.antimatter(chains, handle, cuts, above))),
            Material::Unusable { .. } => Err(Unfit::opaque(handle)),
            Material::Bsdf { data, call, form, added_diffuse } => {
                let bsdf = scene.bsdfs[*data].bsdf.clone();
                let kind =
                    MeasuredKind { bsdf, function: Function::new(call), form: *form, added_diffuse: *added_diffuse };
                Ok(Kind::Scatterer(Box::new(Scatterer::Measured(kind))))
            }
            other => {
                let appearances = |modifier| self.compile_appearances(chains, modifier, above);
                match compile_scatterer(other, modifier.modifier, appearances) {
                    Some(scatterer) => scatterer.map(|scatterer| Kind::Scatterer(Box::new(scatterer))),
                    None => Err(not_yet("this type of material", modifier.span).into()),
                }
            }
        }
    }
}

/// Replaces the paper's texture construction by its retroreflecting lobe, which is sampled exactly.
fn specialised(mut shader: Shader) -> Shader {
    let textures = shader.textures.steps.iter().filter(|step| step.is_texture()).count();
    if let Kind::Glossy(glossy) = shader.kind
        && textures == 1
        && glossy.specularity > 0.0
        && !glossy.is_smooth()
        && turns_the_normal_to_the_viewer(&shader.textures)
    {
        shader.textures.steps.retain(|step| !matches!(step, Step::Texture(_)));
        shader.kind = Kind::Retro(glossy);
    }
    shader
}
