//! Writes modifiers.

use super::{Arguments, Writer};
use crate::Kind;
use radsight_ir::{
    Anisotropic, BsdfForm, Dielectric, FunctionCall, FunctionMaterial, Glossy, Material, Mist, Mixture, MixtureAmount,
    ModifierHandle, ModifierKind, Pattern, PrismFace, Rgb, ScatteringRole, Spectrum, Substitute, TextPattern, Texture,
    Translucent,
};
use std::fmt;

impl Writer<'_> {
    pub(super) fn modifier(&mut self, handle: ModifierHandle) -> fmt::Result {
        let modifier = &self.scene.modifiers[handle];
        let (kind, arguments) = match &modifier.kind {
            ModifierKind::Material(material) => self.material(material),
            ModifierKind::Texture(texture) => texture_arguments(texture),
            ModifierKind::Pattern(pattern) => pattern_arguments(pattern),
            ModifierKind::Mixture(mixture) => self.mixture(mixture),
        };
        if let ModifierKind::Material(Material::Unusable { reason }) = &modifier.kind {
            writeln!(self.out, "# {}", reason.replace(['\n', '\r'], " "))?;
        }
        let name = self.names[handle.index()].clone();
        self.primitive(modifier.modifier, kind.name(), &name, &arguments)
    }

    fn material(&self, material: &Material) -> (Kind, Arguments) {
        match material {
            Material::Light { radiance } => (Kind::Light, Arguments::of_reals(radiance.0)),
            Material::Illum { radiance, substitute } => (Kind::Illum, self.with_substitute(radiance, *substitute)),
            Material::Glow { radiance, max_radius } => (Kind::Glow, reals([&radiance.0, &[*max_radius]])),
            Material::Spotlight { radiance, cone_angle, direction, focal_distance } => {
                let aim = (*direction * *focal_distance).to_array();
                (Kind::Spotlight, reals([&radiance.0, &[cone_angle.to_degrees()], &aim]))
            }
            Material::Mirror { reflectance, substitute } => {
                (Kind::Mirror, self.with_substitute(reflectance, *substitute))
            }
            Material::Prism(prism) => {
                let kind = if prism.faces == PrismFace::One { Kind::Prism1 } else { Kind::Prism2 };
                (kind, call(&prism.call))
            }
            Material::Mist(mist) => (Kind::Mist, mist_arguments(mist)),
            Material::Plastic(surface) => (Kind::Plastic, Arguments::of_reals(glossy(surface))),
            Material::Metal(surface) => (Kind::Metal, Arguments::of_reals(glossy(surface))),
            Material::Trans(surface) => (Kind::Trans, Arguments::of_reals(translucent(surface))),
            Material::AnisotropicPlastic(Anisotropic { orientation, .. }) => (Kind::Plastic2, call(orientation)),
            Material::AnisotropicMetal(Anisotropic { orientation, .. }) => (Kind::Metal2, call(orientation)),
            Material::AnisotropicTrans(Anisotropic { orientation, .. }) => (Kind::Trans2, call(orientation)),
            Material::Ashikhmin { orientation, .. } => (Kind::Ashik2, call(orientation)),
            Material::WardFunction(function) => (Kind::WgmdFunc, self.ward_function(function)),
            Material::Dielectric(body) => {
                (Kind::Dielectric, reals([&body.transmissivity.0, &[body.refractive_index, body.hartmann]]))
            }
            Material::Interface(boundary) => {
                let side = |body: &Dielectric| [&body.transmissivity.0[..], &[body.refractive_index]].concat();
                (Kind::Interface, reals([&side(&boundary.inside), &side(&boundary.outside)]))
            }
            Material::Glass { transmissivity, refractive_index } => {
                (Kind::Glass, reals([&transmissivity.0, &[*refractive_index]]))
            }
            Material::Scattering(function) => {
                let kind = match (function.role, function.grid.is_some()) {
                    (ScatteringRole::Plastic, false) => Kind::PlasFunc,
                    (ScatteringRole::Plastic, true) => Kind::PlasData,
                    (ScatteringRole::Metal, false) => Kind::MetFunc,
                    (ScatteringRole::Metal, true) => Kind::MetData,
                    (ScatteringRole::Trans, false) => Kind::TransFunc,
                    (ScatteringRole::Trans, true) => Kind::TransData,
                };
                (kind, call(&function.call))
            }
            Material::BrtdFunction(function) => (Kind::BrtdFunc, call(&function.call)),
            Material::Bsdf { call: function, form: BsdfForm::Proxy, .. } => (Kind::Bsdf, call(function)),
            Material::Bsdf { call: function, form: BsdfForm::Aperture, .. } => (Kind::ApertureBsdf, call(function)),
            Material::Antimatter { cuts } => {
                let strings = cuts.iter().map(|cut| self.name_of(*cut).to_owned()).collect();
                (Kind::Antimatter, Arguments { strings, reals: Vec::new() })
            }
            Material::Plugin { library, model, words, numbers, .. } => {
                let strings = [library, model].into_iter().chain(words).cloned().collect();
                (Kind::BrdfPlugin, Arguments { strings, reals: numbers.clone() })
            }
            // Radiance, too, fails only when a ray meets a plastic without numbers.
            _ => (Kind::Plastic, Arguments::default()),
        }
    }

    fn with_substitute(&self, color: &Rgb, substitute: Substitute) -> Arguments {
        let name = match substitute {
            Substitute::Own => None,
            Substitute::Void => Some("void"),
            Substitute::Modifier(handle) => Some(self.name_of(Some(handle))),
        };
        Arguments { strings: name.map(str::to_owned).into_iter().collect(), reals: color.0.to_vec() }
    }

    fn ward_function(&self, function: &FunctionMaterial) -> Arguments {
        self.renamed(&function.call, &[0, 4, 8], &function.modifiers)
    }

    fn mixture(&self, mixture: &Mixture) -> (Kind, Arguments) {
        let arms = [mixture.arms.foreground, mixture.arms.background];
        let named = |call| self.renamed(call, &[0, 1], &arms);
        match &mixture.amount {
            MixtureAmount::Function(call) => (Kind::MixFunc, named(call)),
            MixtureAmount::Data(data) => (Kind::MixData, named(&data.call)),
            MixtureAmount::Picture(picture) => (Kind::MixPict, named(&picture.call)),
            MixtureAmount::Text(text) => {
                let mut arguments = text_arguments(text, &[]);
                for (word, arm) in arguments.strings.iter_mut().zip(arms) {
                    *word = self.name_of(arm).to_owned();
                }
                (Kind::MixText, arguments)
            }
        }
    }

    /// A function call with references to modifiers replaced by their unique names.
    fn renamed(&self, function: &FunctionCall, places: &[usize], modifiers: &[Option<ModifierHandle>]) -> Arguments {
        let mut arguments = call(function);
        for (&place, modifier) in places.iter().zip(modifiers) {
            if let Some(word) = arguments.strings.get_mut(place) {
                *word = self.name_of(*modifier).to_owned();
            }
        }
        arguments
    }
}

fn call(function: &FunctionCall) -> Arguments {
    let (strings, reals) = (function.words.clone(), function.numbers.clone());
    Arguments { strings, reals }.with_transform(&function.to_scene)
}

fn reals<const N: usize>(groups: [&[f64]; N]) -> Arguments {
    Arguments::of_reals(groups.concat())
}

fn glossy(surface: &Glossy) -> Vec<f64> {
    [&surface.color.0[..], &[surface.specularity, surface.roughness]].concat()
}

fn translucent(surface: &Translucent) -> Vec<f64> {
    let through = [surface.transmissivity, surface.transmitted_specularity];
    glossy(&surface.surface).into_iter().chain(through).collect()
}

/// The arguments of a mist, as many as needed; those between get Radiance's defaults.
fn mist_arguments(mist: &Mist) -> Arguments {
    let mut numbers = Vec::new();
    if !mist.extinction.is_black() || mist.albedo.is_some() || mist.eccentricity.is_some() {
        numbers.extend(mist.extinction.0);
    }
    if mist.albedo.is_some() || mist.eccentricity.is_some() {
        numbers.extend(mist.albedo.unwrap_or(Rgb::BLACK).0);
    }
    numbers.extend(mist.eccentricity);
    Arguments { strings: mist.sources.clone(), reals: numbers }
}

fn texture_arguments(texture: &Texture) -> (Kind, Arguments) {
    match texture {
        Texture::Function(function) => (Kind::TexFunc, call(function)),
        Texture::Data(data) => (Kind::TexData, call(&data.call)),
    }
}

fn pattern_arguments(pattern: &Pattern) -> (Kind, Arguments) {
    match pattern {
        Pattern::BrightFunction(function) => (Kind::BrightFunc, call(function)),
        Pattern::ColorFunction(function) => (Kind::ColorFunc, call(function)),
        Pattern::BrightData(data) => (Kind::BrightData, call(&data.call)),
        Pattern::ColorData(data) => (Kind::ColorData, call(&data.call)),
        Pattern::ColorPicture(picture) => (Kind::ColorPict, call(&picture.call)),
        Pattern::Text(text) if text.foreground.is_grey() && text.background.is_grey() => {
            (Kind::BrightText, text_arguments(text, &[text.foreground.0[0], text.background.0[0]]))
        }
        Pattern::Text(text) => {
            (Kind::ColorText, text_arguments(text, &[text.foreground.0, text.background.0].concat()))
        }
        Pattern::Spectrum(spectrum) => (Kind::Spectrum, Arguments::of_reals(spectrum_numbers(spectrum))),
        Pattern::SpectrumFunction { call: function, .. } => (Kind::SpecFunc, call(function)),
        Pattern::SpectrumData(data) => (Kind::SpecData, call(&data.call)),
        Pattern::SpectrumPicture(data) => (Kind::SpecPict, call(&data.call)),
    }
}

/// The first and last wavelength are those of the samples, half a step inside the edges.
fn spectrum_numbers(spectrum: &Spectrum) -> Vec<f64> {
    let [first, last] = spectrum.range_nm;
    let half_step = 0.5 * (last - first) / spectrum.values.len() as f64;
    [&[first + half_step, last - half_step], &spectrum.values[..]].concat()
}

fn text_arguments(text: &TextPattern, colors: &[f64]) -> Arguments {
    let frame = [text.origin, text.right, text.down].map(|vector| vector.to_array()).concat();
    Arguments { strings: text.words.clone(), reals: [&frame, colors, text.spacing.as_slice()].concat() }
}
