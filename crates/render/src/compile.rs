//! From chains of modifiers to shaders.

use crate::plan::{ModelRequest, ModelSource};
use crate::recognise::turns_the_normal_to_the_viewer;
use crate::shader::{Emitter, Function, GlossyKind, Kind, Shader, Step};
use radsight_diag::{Diagnostic, Span};
use radsight_ir::{
    Glossy, Material, Modifier, ModifierHandle, ModifierKind, Pattern, Scene, Shape, Substitute, Surface, Texture,
    ValidScene,
};
use std::collections::HashMap;

/// One shader for each modifier that surfaces name, its index for each surface, and the number of bands to trace.
///
/// Models from elsewhere are first made for three bands. If the whole scene then proves to be grey, they are made again for one.
pub(crate) fn compile_shaders(
    scene: &ValidScene,
    models: &dyn ModelSource,
) -> Result<(Vec<Shader>, Vec<u32>, usize), Vec<Diagnostic>> {
    let (shaders, shader_of) = compile_for(scene, models, 3)?;
    if !shaders.iter().all(Shader::is_grey) {
        return Ok((shaders, shader_of, 3));
    }
    if !shaders.iter().any(|shader| matches!(shader.kind, Kind::Plugin(_))) {
        return Ok((shaders, shader_of, 1));
    }
    compile_for(scene, models, 1).map(|(shaders, shader_of)| (shaders, shader_of, 1))
}

fn compile_for(
    scene: &ValidScene,
    models: &dyn ModelSource,
    bands: usize,
) -> Result<(Vec<Shader>, Vec<u32>), Vec<Diagnostic>> {
    let mut shaders = Vec::new();
    let mut by_modifier: HashMap<Option<ModifierHandle>, u32> = HashMap::new();
    let mut errors = Vec::new();
    let mut shader_of = Vec::with_capacity(scene.surfaces.len());
    for surface in scene.surfaces.items() {
        if let Some(error) = unsupported_shape(surface) {
            errors.push(error);
        }
        let index = *by_modifier.entry(surface.modifier).or_insert_with(|| {
            let shader = compile(scene, surface.modifier, models, bands).unwrap_or_else(|error| {
                errors.push(error);
                Shader { steps: Vec::new(), kind: Kind::Transparent }
            });
            shaders.push(shader);
            (shaders.len() - 1) as u32
        });
        shader_of.push(index);
    }
    if errors.is_empty() { Ok((shaders, shader_of)) } else { Err(errors) }
}

fn unsupported_shape(surface: &Surface) -> Option<Diagnostic> {
    let kind = match surface.shape {
        Shape::Mesh(_) => "mesh",
        Shape::Instance(_) => "instance",
        _ => return None,
    };
    Some(not_yet(&format!("a surface of type \"{kind}\""), surface.span))
}

fn not_yet(what: &str, span: Option<Span>) -> Diagnostic {
    let error = Diagnostic::error(format!("{what} is read but not rendered yet"));
    match span {
        Some(span) => error.at(span),
        None => error,
    }
}

fn compile(
    scene: &Scene,
    first: Option<ModifierHandle>,
    models: &dyn ModelSource,
    bands: usize,
) -> Result<Shader, Diagnostic> {
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
    let Some((handle, material)) = material else { return Ok(Shader { steps: Vec::new(), kind: Kind::Transparent }) };
    let kind = compile_material(scene, handle, material, models, bands)?;
    Ok(recognised(Shader { steps, kind }))
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

fn compile_material(
    scene: &Scene,
    handle: ModifierHandle,
    material: &Material,
    models: &dyn ModelSource,
    bands: usize,
) -> Result<Kind, Diagnostic> {
    let modifier = &scene.modifiers[handle];
    let glossy = |surface: &Glossy, metallic| GlossyKind {
        color: surface.color,
        specularity: surface.specularity,
        roughness: surface.roughness,
        metallic,
    };
    match material {
        Material::Light { radiance } | Material::Glow { radiance, .. } => {
            Ok(Kind::Emitter(Emitter { radiance: *radiance, cone: None }))
        }
        Material::Spotlight { radiance, cone_angle, direction, .. } => {
            Ok(Kind::Emitter(Emitter { radiance: *radiance, cone: Some(((0.5 * cone_angle).cos(), *direction)) }))
        }
        Material::Plastic(surface) => Ok(Kind::Glossy(glossy(surface, false))),
        Material::Metal(surface) => Ok(Kind::Glossy(glossy(surface, true))),
        Material::Mirror { reflectance, substitute: Substitute::Own } => Ok(Kind::Mirror { reflectance: *reflectance }),
        Material::Glass { transmissivity, refractive_index } => {
            Ok(Kind::Glass { transmissivity: *transmissivity, refractive_index: *refractive_index })
        }
        Material::Plugin { library, model, words, numbers, tokens } => {
            let material = scene.modifier_name(Some(handle));
            let request = ModelRequest { material, span: modifier.span, library, model, words, numbers, tokens, bands };
            models.model(&request).map(Kind::Plugin)
        }
        Material::Unusable { .. } => Ok(Kind::Unusable),
        _ => Err(not_yet("this type of material", modifier.span)),
    }
}
