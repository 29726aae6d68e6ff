//! Sets of shaders, selected by options and materials.

use crate::options::AmbientSurfaces;
use crate::shader::{Kind, Shader};
use radsight_accel::ShaderId;
use radsight_ir::Scene;
use std::collections::HashMap;

/// Shaders that any antimatter cuts, ascending.
pub(crate) fn all_cut(shaders: &[Shader]) -> Vec<ShaderId> {
    let of_shader = |shader: &Shader| match &shader.kind {
        Kind::Antimatter(antimatter) => antimatter.cuts.clone(),
        _ => Vec::new(),
    };
    let mut all: Vec<ShaderId> = shaders.iter().flat_map(of_shader).collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// Marks the shaders of tracked modifiers.
pub(crate) fn mark_tracked(shaders: &mut [Shader], scene: &Scene, names: &[String]) {
    if names.is_empty() {
        return;
    }
    let numbered: HashMap<&str, u32> = names.iter().map(String::as_str).zip(0..).collect();
    for shader in shaders {
        let name = shader.textures.home.scene(scene).modifier_name(shader.modifier);
        shader.tracked = numbered.get(name).copied();
    }
}

/// Whether each shader's surfaces are without interreflection; empty if none are.
pub(crate) fn excluded(scene: &Scene, shaders: &[Shader], surfaces: &AmbientSurfaces) -> Vec<bool> {
    let named = |names: &[String], shader: &Shader| {
        let modifier = shader.textures.home.scene(scene).modifier_name(shader.modifier);
        names.iter().any(|name| name == modifier)
    };
    match surfaces {
        AmbientSurfaces::All => Vec::new(),
        AmbientSurfaces::Except(names) => shaders.iter().map(|shader| named(names, shader)).collect(),
        AmbientSurfaces::Only(names) => shaders.iter().map(|shader| !named(names, shader)).collect(),
    }
}
