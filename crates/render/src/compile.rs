//! From chains of modifiers to shaders.

use crate::plan::{ModelSource, has_place};
use crate::recognise::turns_the_normal_to_the_viewer;
use crate::shader::{Emitter, Function, GlossyKind, Kind, Shader, Step};
use radsight_diag::{Diagnostic, Span};
use radsight_ir::{
    Glossy, Material, Modifier, ModifierHandle, ModifierKind, Pattern, Scene, Shape, Substitute, Surface, Texture,
    ValidScene,
};
use std::collections::HashMap;

/// One shader for each modifier that surfaces name, and its index for each surface.
pub(crate) fn compile_shaders(
    scene: &ValidScene,
    models: &dyn ModelSource,
) -> Result<(Vec<Shader>, Vec<u32>), Vec<Diagnostic>> {
    let mut shaders = Vec::new();
    let mut by_modifier: HashMap<Option<ModifierHandle>, u32> = HashMap::new();
    let mut errors = Vec::new();
    let mut shader_of = Vec::with_capacity(scene.surfaces.len());
    for surface in scene.surfaces.items() {
        if let Some(error) = unsupported_shape(scene, surface) {
            errors.push(error);
        }
        let index = *by_modifier.entry(surface.modifier).or_insert_with(|| {
            let shader = compile(scene, surface.modifier, models).unwrap_or_else(|error| {
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

fn unsupported_shape(scene: &ValidScene, surface: &Surface) -> Option<Diagnostic> {
    let kind = match surface.shape {
        Shape::Mesh(_) => "mesh",
        Shape::Instance(_) => "instance",
        _ => {
            debug_assert!(matches!(surface.shape, Shape::Source(_)) || has_place(scene, surface));
            return None;
        }
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

fn compile(scene: &Scene, first: Option<ModifierHandle>, models: &dyn ModelSource) -> Result<Shader, Diagnostic> {
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
    let kind = compile_material(&scene.modifiers[handle], material, models)?;
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

fn compile_material(modifier: &Modifier, material: &Material, models: &dyn ModelSource) -> Result<Kind, Diagnostic> {
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
        Material::Plugin { library, model, words, numbers } => {
            models.model(library, model, words, numbers).map(Kind::Plugin).map_err(|error| match modifier.span {
                Some(span) if error.span.is_none() => error.at(span),
                _ => error,
            })
        }
        _ => Err(not_yet("this type of material", modifier.span)),
    }
}
