//! What materials are to the rule by which one of surfaces that lie on each other is met (`rayreject` in `rt/raytrace.c`).

use radsight_accel::Substance;
use radsight_ir::{BsdfForm, Material, ModifierHandle, ModifierKind, Scene};

/// What the material at the end of a chain of modifiers is to the rule.
pub(crate) fn substance(scene: &Scene, first: Option<ModifierHandle>) -> Substance {
    let mut last = None;
    for (_, modifier) in scene.chain(first) {
        if let ModifierKind::Material(material) = &modifier.kind {
            return if is_transparent(material) { Substance::Transparent } else { Substance::Opaque };
        }
        last = Some(&modifier.kind);
    }
    // A mixture counts for a material, whatever it mixes.
    if matches!(last, Some(ModifierKind::Mixture(_))) { Substance::Opaque } else { Substance::Nothing }
}

/// What Radiance calls transparent (`istransp` in `rt/otspecial.h`).
fn is_transparent(material: &Material) -> bool {
    match material {
        Material::Trans(_)
        | Material::AnisotropicTrans(_)
        | Material::Dielectric(_)
        | Material::Interface(_)
        | Material::Mist(_)
        | Material::Glass { .. }
        | Material::Bsdf { form: BsdfForm::Aperture, .. } => true,
        // By the words alone: the colours that these let straight through.
        Material::BrtdFunction(function) => function.call.words.iter().skip(3).take(3).any(|word| word != "0"),
        Material::WardFunction(function) => function.call.words.get(5).is_some_and(|word| word != "0"),
        _ => false,
    }
}
