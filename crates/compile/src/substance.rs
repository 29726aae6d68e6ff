//! Class of a material for Radiance's rule about coincident surfaces (`rayreject` in
//! `rt/raytrace.c`).

use radsight_accel::Substance;
use radsight_ir::{BsdfForm, Material, ModifierHandle, ModifierKind, Scene};

/// Class of the material at the end of a modifier chain.
pub(crate) fn substance(scene: &Scene, first: Option<ModifierHandle>) -> Substance {
    let mut last = None;
    for (_, modifier) in scene.chain(first) {
        if let ModifierKind::Material(material) = &modifier.kind {
            return if is_transparent(material) { Substance::Transparent } else { Substance::Opaque };
        }
        last = Some(&modifier.kind);
    }
    // A mixture counts as a material, whatever it mixes.
    if matches!(last, Some(ModifierKind::Mixture(_))) { Substance::Opaque } else { Substance::Nothing }
}

/// Whether Radiance counts it as transparent (`istransp` in `rt/otspecial.h`).
fn is_transparent(material: &Material) -> bool {
    match material {
        Material::Trans(_)
        | Material::AnisotropicTrans(_)
        | Material::Dielectric(_)
        | Material::Interface(_)
        | Material::Mist(_)
        | Material::Glass { .. }
        | Material::Bsdf { form: BsdfForm::Aperture, .. } => true,
        // Decided by the string arguments alone: the functions of straight-through transmission.
        Material::BrtdFunction(function) => function.call.words.iter().skip(3).take(3).any(|word| word != "0"),
        Material::WardFunction(function) => function.call.words.get(5).is_some_and(|word| word != "0"),
        _ => false,
    }
}
