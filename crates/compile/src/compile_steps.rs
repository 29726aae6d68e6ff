//! Compiles patterns, textures and mixtures to steps.

use crate::shader::Kind;
use radsight_diag::Diagnostic;
use radsight_ir::{
    DataGrid, FunctionCall, GridCall, Handle, MixtureAmount, Modifier, ModifierHandle, ModifierKind, Pattern, Rgb,
    Scene, Spectrum, TextPattern, Texture,
};
use radsight_spectrum::Conversion;
use radsight_texture::{
    BandLayout, Bands, Function, Lettering, Share, SpectralData, SpectralFunction, Step, TransmittedRays,
};
use std::sync::Arc;

/// Step of a texture; none if it never perturbs the normal.
pub(crate) fn texture_step(texture: &Texture) -> Option<Step> {
    match texture {
        Texture::Function(call) => (constants(call) != Some([0.0; 3])).then(|| Step::Texture(Function::new(call))),
        Texture::Data(call) => Some(Step::TextureData(Function::new(&call.call), three_grids(call))),
    }
}

/// Step of a pattern; none if it changes nothing.
///
/// # Errors
/// The error of a text pattern.
pub(crate) fn pattern_step(
    scene: &Scene,
    modifier: &Modifier,
    pattern: &Pattern,
    layout: &Arc<BandLayout>,
) -> Result<Option<Step>, Diagnostic> {
    Ok(Some(match pattern {
        Pattern::BrightFunction(call) => match constants(call) {
            Some([value]) => Step::Constant(Bands::Color(Rgb([value; 3]))),
            None => Step::Brightness(Function::new(call)),
        },
        Pattern::ColorFunction(call) => match constants(call) {
            Some(values) => Step::Constant(Bands::Color(Rgb(values))),
            None => Step::Color(Function::new(call)),
        },
        Pattern::BrightData(grid) => Step::BrightnessData(Function::new(&grid.call), grid.grids[0]),
        Pattern::ColorData(grid) => Step::ColorData(Function::new(&grid.call), three_grids(grid)),
        Pattern::ColorPicture(picture) => Step::Picture(Function::new(&picture.call), picture.picture),
        Pattern::Text(text) => Step::Text {
            lettering: lettering(scene, modifier, text)?,
            foreground: text.foreground,
            background: text.background,
        },
        Pattern::Spectrum(spectrum) => Step::Constant(received(spectrum, layout)),
        Pattern::SpectrumFunction { call, range_nm } => {
            return Ok(SpectralFunction::new(Function::new(call), *range_nm, layout).map(Step::SpectralFunction));
        }
        Pattern::SpectrumData(grid) | Pattern::SpectrumPicture(grid) => {
            let pattern = SpectralData::new(Function::new(&grid.call), scene, grid.grids[0], layout);
            return Ok(pattern.map(Step::SpectralData));
        }
    }))
}

/// Name of the textures that smooth facets, in the output of Radiance's generators and converters.
const SMOOTHING: &str = "Phong";

/// Whether the textures of surfaces with this modifier turn transmitted rays. As in Radiance, the
/// name of the modifier decides, whatever its kind.
pub(crate) fn transmitted(scene: &Scene, modifier: Option<ModifierHandle>) -> TransmittedRays {
    if scene.modifier_name(modifier) == SMOOTHING { TransmittedRays::Straight } else { TransmittedRays::Turned }
}

/// Weight of a mixture's foreground.
///
/// # Errors
/// The error of a text pattern.
pub(crate) fn share(scene: &Scene, modifier: &Modifier, amount: &MixtureAmount) -> Result<Share, Diagnostic> {
    Ok(match amount {
        MixtureAmount::Function(call) => Share::Function(Function::new(call)),
        MixtureAmount::Data(grid) => Share::Data(Function::new(&grid.call), grid.grids[0]),
        MixtureAmount::Picture(picture) => Share::Picture(Function::new(&picture.call), picture.picture),
        MixtureAmount::Text(text) => Share::Text(lettering(scene, modifier, text)?),
    })
}

/// Folds constant patterns into the material's own colour.
pub(crate) fn fold_constants(steps: &mut Vec<Step>, kind: &mut Kind) {
    let own = match kind {
        Kind::Emitter(emitter) => &mut emitter.radiance,
        Kind::Glossy(glossy) => &mut glossy.color,
        Kind::Mirror { reflectance, .. } => reflectance,
        _ => return,
    };
    steps.retain(|step| match step {
        Step::Constant(Bands::Color(color)) => {
            *own = Rgb([0, 1, 2].map(|band| own.0[band] * color.0[band]));
            false
        }
        _ => true,
    });
}

/// Whether each modifier of a scene ends in a material, directly or through mixtures.
pub(crate) fn ends_in_material(scene: &Scene) -> Vec<bool> {
    let mut ends: Vec<bool> = Vec::with_capacity(scene.modifiers.len());
    for modifier in scene.modifiers.items() {
        let of = |handle: Option<ModifierHandle>| handle.is_some_and(|handle| ends.get(handle.index()) == Some(&true));
        let own = match &modifier.kind {
            ModifierKind::Material(_) => true,
            ModifierKind::Mixture(mixture) => of(mixture.arms.foreground) || of(mixture.arms.background),
            ModifierKind::Texture(_) | ModifierKind::Pattern(_) => false,
        };
        let ends_here = own || of(modifier.modifier);
        ends.push(ends_here);
    }
    ends
}

/// Values of all roots of a call, if they are the same for every ray.
fn constants<const ROOTS: usize>(call: &FunctionCall) -> Option<[f64; ROOTS]> {
    let mut values = [0.0; ROOTS];
    for (root, value) in values.iter_mut().enumerate() {
        *value = call.program.constant(root)?;
    }
    Some(values)
}

fn three_grids(call: &GridCall) -> [Handle<DataGrid>; 3] {
    [0, 1, 2].map(|band| call.grids[band])
}

fn received(spectrum: &Spectrum, layout: &BandLayout) -> Bands {
    let mut bands = vec![0.0; layout.sampling().bands()];
    let conversion = Conversion::new(layout.sampling(), spectrum.values.len(), spectrum.range_nm);
    conversion.apply(spectrum.values.iter().copied(), &mut bands);
    layout.arrange(&bands)
}

fn lettering(scene: &Scene, modifier: &Modifier, text: &TextPattern) -> Result<Lettering, Diagnostic> {
    Lettering::new(text, &scene.fonts[text.font]).ok_or_else(|| {
        let name = scene.names.get(modifier.name);
        let error =
            Diagnostic::error(format!("the directions of the lines and of the letters of \"{name}\" are parallel"));
        match modifier.span {
            Some(span) => error.at(span),
            None => error,
        }
    })
}
