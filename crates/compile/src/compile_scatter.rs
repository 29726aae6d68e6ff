//! Compiles the scattering materials of a scene.

use radsight_bsdf::{
    Appearances, AshikhminKind, BrtdKind, Component, Scatterer, ScatteringKind, Sheet, WardFunctionKind,
};
use radsight_ir::{Anisotropic, FunctionMaterial, Glossy, Material, ModifierHandle, ScatteringFunction, Translucent};
use radsight_texture::Function;

/// Compiles a scattering material; none for other materials. `appearances` compiles patterns and
/// textures of a modifier that the material names in addition to `own`, its own modifier, or of
/// `void`.
pub(crate) fn compile_scatterer<E>(
    material: &Material,
    own: Option<ModifierHandle>,
    appearances: impl FnMut(Option<ModifierHandle>) -> Result<Appearances, E>,
) -> Option<Result<Scatterer, E>> {
    let opaque = |surface: &Anisotropic<Glossy>| {
        let translucent = Translucent { surface: surface.surface, transmissivity: 0.0, transmitted_specularity: 0.0 };
        anisotropic(surface, translucent)
    };
    let sheet = match material {
        Material::Trans(surface) => sheet(*surface),
        Material::AnisotropicPlastic(surface) => opaque(surface),
        Material::AnisotropicMetal(surface) => Sheet { metallic: true, ..opaque(surface) },
        Material::AnisotropicTrans(surface) => anisotropic(surface, surface.surface),
        Material::Ashikhmin { orientation, diffuse, specular, exponents } => {
            return Some(Ok(Scatterer::Ashikhmin(AshikhminKind {
                orientation: Function::new(orientation),
                diffuse: *diffuse,
                specular: *specular,
                exponents: exponents.map(|exponent| exponent.max(0.0)),
            })));
        }
        Material::WardFunction(function) => return Some(ward_function(function, own, appearances)),
        Material::Scattering(function) => return Some(Ok(Scatterer::Function(scattering(function)))),
        Material::BrtdFunction(function) => return Some(Ok(Scatterer::Brtd(brtd(function)))),
        _ => return None,
    };
    Some(Ok(Scatterer::Sheet(sheet)))
}

fn sheet(surface: Translucent) -> Sheet {
    Sheet {
        color: surface.surface.color,
        specularity: surface.surface.specularity,
        roughness: [surface.surface.roughness; 2],
        metallic: false,
        transmissivity: surface.transmissivity,
        transmitted_specularity: surface.transmitted_specularity,
        orientation: None,
    }
}

/// An anisotropic roughness is never smooth: Radiance rejects smaller values.
const LEAST_ROUGHNESS: f64 = 1e-6;

fn anisotropic<S>(material: &Anisotropic<S>, surface: Translucent) -> Sheet {
    let roughness = [surface.surface.roughness, material.roughness_v].map(|roughness| roughness.max(LEAST_ROUGHNESS));
    Sheet { roughness, orientation: Some(Function::new(&material.orientation)), ..sheet(surface) }
}

fn scattering(material: &ScatteringFunction) -> ScatteringKind {
    ScatteringKind {
        role: material.role,
        function: Function::new(&material.call),
        grid: material.grid,
        color: material.surface.color,
        specularity: material.surface.specularity,
        transmissivity: material.transmissivity,
        transmitted_specularity: material.transmitted_specularity,
    }
}

fn brtd(material: &FunctionMaterial) -> BrtdKind {
    let words = &material.call.words;
    let is_grey = words.chunks(3).take(3).all(|bands| bands.iter().all(|word| *word == bands[0]));
    BrtdKind { function: Function::new(&material.call), diffuse: material.diffuse, has_grey_functions: is_grey }
}

fn ward_function<E>(
    material: &FunctionMaterial,
    own: Option<ModifierHandle>,
    mut appearances: impl FnMut(Option<ModifierHandle>) -> Result<Appearances, E>,
) -> Result<Scatterer, E> {
    let mut appearances_of = |part: usize| match material.modifiers.get(part).copied().flatten() {
        Some(modifier) if Some(modifier) == own => Ok(Appearances::Main),
        modifier => appearances(modifier),
    };
    Ok(Scatterer::WardFunction(WardFunctionKind {
        function: Function::new(&material.call),
        diffuse: material.diffuse,
        reflection: Component { first_root: 0, appearances: appearances_of(0)? },
        transmission: Component { first_root: 3, appearances: appearances_of(1)? },
        diffuse_transmission: appearances_of(2)?,
    }))
}
