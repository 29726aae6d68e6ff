//! From chains of modifiers to shaders.

use crate::compile_scatter::compile_scatterer;
use crate::medium::MistKind;
use crate::plan::{ModelRequest, ModelSource};
use crate::ray::ShaderId;
use crate::recognise::turns_the_normal_to_the_viewer;
use crate::refraction::Boundary;
use crate::scatter::Look;
use crate::shader::{Emitter, EmitterClass, Function, GlossyKind, Home, Kind, Shader, Step, Substitution};
use radsight_diag::{Diagnostic, Span};
use radsight_ir::{
    Glossy, Material, Modifier, ModifierHandle, ModifierKind, Pattern, Rgb, Scene, Shape, Substitute, Texture,
    ValidScene,
};
use std::collections::HashMap;
use std::sync::Arc;

/// The shader of each modifier that surfaces of a scene name, and those of the scenes that it places.
#[derive(Debug)]
pub(crate) struct ShaderTable {
    /// By modifier, `void` first.
    of_modifier: Vec<ShaderId>,
    /// By octree handle.
    pub(crate) octrees: Vec<Arc<ShaderTable>>,
}

impl ShaderTable {
    /// The shader of a modifier that a surface or a triangle of the scene has.
    #[inline]
    pub(crate) fn of(&self, modifier: Option<ModifierHandle>) -> ShaderId {
        self.of_modifier[modifier.map_or(0, |handle| handle.index() + 1)]
    }
}

/// One shader for each modifier that surfaces name, in this scene and in those that it places, and the number of bands to trace.
///
/// `surroundings` are colours that come from elsewhere. Models from elsewhere are first made for three bands. If the whole scene then proves to be grey, they are made again for one.
pub(crate) fn compile_shaders(
    scene: &ValidScene,
    models: &dyn ModelSource,
    surroundings: &[Rgb],
) -> Result<(Vec<Shader>, ShaderTable, usize), Vec<Diagnostic>> {
    let (shaders, table) = compile_for(scene, models, 3)?;
    if !shaders.iter().all(Shader::is_grey) || !surroundings.iter().all(|color| color.is_grey()) {
        return Ok((shaders, table, 3));
    }
    if !shaders.iter().any(|shader| matches!(shader.kind, Kind::Plugin(_))) {
        return Ok((shaders, table, 1));
    }
    compile_for(scene, models, 1).map(|(shaders, table)| (shaders, table, 1))
}

fn compile_for(
    scene: &Scene,
    models: &dyn ModelSource,
    bands: usize,
) -> Result<(Vec<Shader>, ShaderTable), Vec<Diagnostic>> {
    let mut compiler = Compiler { models, bands, shaders: Vec::new(), errors: Vec::new(), octrees: HashMap::new() };
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
}

/// Whether modifiers of a scene are used, or those of its instances override them all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Use {
    Shown,
    Overridden,
}

/// What stands in the table for a modifier that nothing uses.
const NO_SHADER: ShaderId = ShaderId(u32::MAX);

impl Compiler<'_> {
    fn compile_scene(&mut self, scene: &Scene, home: &Home, used: Use) -> ShaderTable {
        let mut of_modifier = vec![NO_SHADER; scene.modifiers.len() + 1];
        let of_surfaces = scene.surfaces.items().iter().map(|surface| surface.modifier);
        let of_triangles =
            scene.meshes.items().iter().flat_map(|mesh| &mesh.triangles).map(|triangle| triangle.modifier);
        let modifiers = of_surfaces.chain(of_triangles).filter(|_| used == Use::Shown);
        for modifier in modifiers {
            self.compile_chain(&mut Chains { scene, home, of_modifier: &mut of_modifier, nesting: 0 }, modifier);
        }
        let mut uses = vec![Use::Overridden; scene.octrees.len()];
        for surface in scene.surfaces.items() {
            if let (Shape::Instance(handle), None) = (surface.shape, surface.modifier) {
                uses[scene.instances[handle].octree.index()] = used;
            }
        }
        let octrees =
            scene.octrees.items().iter().zip(uses).map(|(octree, used)| self.compile_octree(&octree.scene, used));
        ShaderTable { octrees: octrees.collect(), of_modifier }
    }

    /// A scene that several others place is compiled once.
    fn compile_octree(&mut self, scene: &Arc<Scene>, used: Use) -> Arc<ShaderTable> {
        let key = (Arc::as_ptr(scene), used);
        if let Some(known) = self.octrees.get(&key) {
            return known.clone();
        }
        let table = Arc::new(self.compile_scene(scene, &Home(Some(scene.clone())), used));
        self.octrees.insert(key, table.clone());
        table
    }

    /// The shader of a modifier, which is made once.
    fn compile_chain(&mut self, chains: &mut Chains<'_>, modifier: Option<ModifierHandle>) -> ShaderId {
        let place = modifier.map_or(0, |handle| handle.index() + 1);
        if chains.of_modifier[place] != NO_SHADER {
            return chains.of_modifier[place];
        }
        let (steps, kind) = self.compile(chains, modifier).unwrap_or_else(|error| {
            self.errors.push(error);
            (Vec::new(), Kind::Transparent)
        });
        self.shaders.push(recognised(Shader { steps, kind, home: chains.home.clone(), modifier }));
        let id = ShaderId((self.shaders.len() - 1) as u32);
        chains.of_modifier[place] = id;
        id
    }

    /// What stands in for a material when it is seen; `None` for nothing of its own.
    fn substitute(
        &mut self,
        chains: &mut Chains<'_>,
        of: ModifierHandle,
        substitute: Substitute,
    ) -> Result<Option<Substitution>, Diagnostic> {
        let modifier = match substitute {
            Substitute::Own => return Ok(None),
            Substitute::Void => return Ok(Some(Substitution::Void)),
            Substitute::Modifier(modifier) => modifier,
        };
        // A substitute is defined before what it stands in for, so that there is no circle.
        if modifier.index() >= of.index() || chains.nesting >= MAX_NESTING {
            let name = chains.scene.modifier_name(Some(of));
            let error = Diagnostic::error(format!("the materials that stand in for \"{name}\" are nested too deeply"));
            return Err(match chains.scene.modifiers[of].span {
                Some(span) => error.at(span),
                None => error,
            });
        }
        chains.nesting += 1;
        let id = self.compile_chain(chains, Some(modifier));
        chains.nesting -= 1;
        Ok(Some(Substitution::Shader(id)))
    }
}

/// The chains of modifiers of one scene.
struct Chains<'s> {
    scene: &'s Scene,
    home: &'s Home,
    /// By modifier, `void` first.
    of_modifier: &'s mut Vec<ShaderId>,
    /// How many materials stand in for one another at this point.
    nesting: u32,
}

/// More materials than this do not stand in for one another.
const MAX_NESTING: u32 = 64;

fn not_yet(what: &str, span: Option<Span>) -> Diagnostic {
    let error = Diagnostic::error(format!("{what} is read but not rendered yet"));
    match span {
        Some(span) => error.at(span),
        None => error,
    }
}

impl Compiler<'_> {
    fn compile(
        &mut self,
        chains: &mut Chains<'_>,
        first: Option<ModifierHandle>,
    ) -> Result<(Vec<Step>, Kind), Diagnostic> {
        let scene = chains.scene;
        let mut steps = Vec::new();
        let mut material = None;
        for (handle, modifier) in scene.chain(first) {
            match &modifier.kind {
                ModifierKind::Texture(texture) => steps.push(texture_step(texture, modifier)?),
                ModifierKind::Pattern(pattern) => steps.push(pattern_step(pattern, modifier)?),
                ModifierKind::Mixture(_) => return Err(not_yet("a mixture", modifier.span)),
                ModifierKind::Material(found) if material.is_none() => material = Some((handle, found)),
                ModifierKind::Material(_) => {
                    let name = scene.modifier_name(Some(handle));
                    let error = Diagnostic::error(format!("material \"{name}\" modifies another material"));
                    return Err(match modifier.span {
                        Some(span) => error.at(span),
                        None => error,
                    });
                }
            }
        }
        let Some((handle, material)) = material else { return Ok((Vec::new(), Kind::Transparent)) };
        let kind = self.compile_material(chains, handle, material)?;
        Ok((steps, kind))
    }

    fn compile_material(
        &mut self,
        chains: &mut Chains<'_>,
        handle: ModifierHandle,
        material: &Material,
    ) -> Result<Kind, Diagnostic> {
        let Compiler { models, bands, .. } = *self;
        let scene = chains.scene;
        let modifier = &scene.modifiers[handle];
        let glossy = |surface: &Glossy, metallic| GlossyKind {
            color: surface.color,
            specularity: surface.specularity,
            roughness: surface.roughness,
            metallic,
        };
        match material {
            Material::Light { radiance } => Ok(Kind::Emitter(Emitter::light(*radiance))),
            Material::Glow { radiance, max_radius } => {
                Ok(Kind::Emitter(Emitter { class: EmitterClass::Glow(*max_radius), ..Emitter::light(*radiance) }))
            }
            Material::Spotlight { radiance, cone_angle, direction, .. } => {
                let cone = Some(((0.5 * cone_angle).cos(), *direction));
                Ok(Kind::Emitter(Emitter { cone, ..Emitter::light(*radiance) }))
            }
            Material::Illum { radiance, substitute } => {
                let substitute = self.substitute(chains, handle, *substitute)?.unwrap_or(Substitution::Void);
                let emitter = Emitter { class: EmitterClass::Illum, ..Emitter::light(*radiance) };
                Ok(Kind::Illum { emitter, substitute })
            }
            Material::Plastic(surface) => Ok(Kind::Glossy(glossy(surface, false))),
            Material::Metal(surface) => Ok(Kind::Glossy(glossy(surface, true))),
            Material::Mirror { reflectance, substitute } => {
                let substitute = self.substitute(chains, handle, *substitute)?;
                Ok(Kind::Mirror { reflectance: *reflectance, substitute })
            }
            Material::Dielectric(body) => Ok(Kind::Dielectric(Boundary::of_body(body))),
            Material::Interface(interface) => Ok(Kind::Dielectric(Boundary::between(interface))),
            Material::Mist(mist) => Ok(Kind::Mist(MistKind::new(mist))),
            Material::Glass { transmissivity, refractive_index } => {
                Ok(Kind::Glass { transmissivity: *transmissivity, refractive_index: *refractive_index })
            }
            Material::Plugin { library, model, words, numbers, tokens } => {
                let material = scene.modifier_name(Some(handle));
                let request =
                    ModelRequest { material, span: modifier.span, library, model, words, numbers, tokens, bands };
                models.model(&request).map(Kind::Plugin)
            }
            Material::Unusable { .. } => Ok(Kind::Unusable),
            other => {
                let look = |modifier| compile_look(scene, modifier);
                match compile_scatterer(other, modifier.modifier, look) {
                    Some(scatterer) => scatterer.map(|scatterer| Kind::Scatterer(Box::new(scatterer))),
                    None => Err(not_yet("this type of material", modifier.span)),
                }
            }
        }
    }
}

/// The patterns and textures of a modifier that a material names beside its own.
fn compile_look(scene: &Scene, first: ModifierHandle) -> Result<Look, Diagnostic> {
    let mut steps = Vec::new();
    for (_, modifier) in scene.chain(Some(first)) {
        match &modifier.kind {
            ModifierKind::Texture(texture) => steps.push(texture_step(texture, modifier)?),
            ModifierKind::Pattern(pattern) => steps.push(pattern_step(pattern, modifier)?),
            ModifierKind::Mixture(_) => return Err(not_yet("a mixture", modifier.span)),
            ModifierKind::Material(_) => {
                let error = Diagnostic::error("a material stands where a pattern or a texture is expected".to_owned());
                return Err(match modifier.span {
                    Some(span) => error.at(span),
                    None => error,
                });
            }
        }
    }
    let shader = Shader { steps, kind: Kind::Transparent, home: Home::default(), modifier: Some(first) };
    Ok(Look::Own(Box::new(shader)))
}

/// The paper's construction becomes its lobe, which is sampled exactly.
fn recognised(mut shader: Shader) -> Shader {
    let textures = shader.steps.iter().filter(|step| matches!(step, Step::Texture(_))).count();
    if let Kind::Glossy(glossy) = shader.kind
        && textures == 1
        && glossy.specularity > 0.0
        && !glossy.is_smooth()
        && turns_the_normal_to_the_viewer(&shader)
    {
        shader.steps.retain(|step| !matches!(step, Step::Texture(_)));
        shader.kind = Kind::Retro(glossy);
    }
    shader
}

fn texture_step(texture: &Texture, modifier: &Modifier) -> Result<Step, Diagnostic> {
    match texture {
        Texture::Function(call) => Ok(Step::Texture(Function::new(call))),
        Texture::Data(_) => Err(not_yet("a texture of type \"texdata\"", modifier.span)),
    }
}

fn pattern_step(pattern: &Pattern, modifier: &Modifier) -> Result<Step, Diagnostic> {
    match pattern {
        Pattern::BrightFunction(call) => Ok(Step::Brightness(Function::new(call))),
        Pattern::ColorFunction(call) => Ok(Step::Color(Function::new(call))),
        Pattern::BrightData(grid) => Ok(Step::BrightnessData(Function::new(&grid.call), grid.grids[0])),
        Pattern::ColorData(grid) => {
            Ok(Step::ColorData(Function::new(&grid.call), [grid.grids[0], grid.grids[1], grid.grids[2]]))
        }
        _ => Err(not_yet("this type of pattern", modifier.span)),
    }
}
