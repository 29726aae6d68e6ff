//! Materials.

use super::functions::{CallForm, RootWord};
use super::modifiers::{Raw, RawHandle, Reference};
use super::reader::Reader;
use crate::Kind;
use glam::DVec3;
use radsight_diag::Diagnostic;
use radsight_ir::{
    Anisotropic, BsdfForm, Dielectric, FunctionMaterial, Glossy, Interface, Material, Mist, ModifierHandle,
    ModifierKind, Prism, PrismFace, Rgb, ScatteringFunction, ScatteringRole, Substitute, Translucent,
};

/// Maps a modifier as written to its handle in the scene.
pub(super) type Lowered<'a> = dyn Fn(RawHandle) -> Option<ModifierHandle> + 'a;

/// Radiance's default index of refraction of `glass`.
const GLASS_INDEX: f64 = 1.52;

/// Radiance treats angles and lengths below this as zero.
const TINY: f64 = 1e-6;

impl Reader<'_> {
    /// Lowers a modifier whose argument counts were checked. `None` after a mistake, which was
    /// reported.
    pub(super) fn lower_kind(&mut self, raw: &Raw, at: &Lowered<'_>) -> Option<ModifierKind> {
        match raw.kind.role() {
            crate::Role::Material => self.material(raw, at).map(ModifierKind::Material),
            crate::Role::Texture => self.texture(raw).map(ModifierKind::Texture),
            crate::Role::Pattern => self.pattern(raw).map(ModifierKind::Pattern),
            crate::Role::Mixture => self.mixture(raw, at).map(ModifierKind::Mixture),
            _ => self.not_yet(raw),
        }
    }

    /// Reports a type that radsight does not support yet.
    pub(super) fn not_yet<T>(&mut self, raw: &Raw) -> Option<T> {
        let message = format!("{} \"{}\" is not supported yet", raw.kind, self.scene.names.get(raw.name));
        self.log.push(Diagnostic::error(message).at(raw.kind_span));
        self.is_inexcusable = true;
        None
    }

    fn material(&mut self, raw: &Raw, at: &Lowered<'_>) -> Option<Material> {
        let reals = &*raw.reals;
        Some(match raw.kind {
            Kind::Light => Material::Light { radiance: rgb(reals, 0) },
            Kind::Illum => Material::Illum { radiance: rgb(reals, 0), substitute: substitute(raw, at) },
            Kind::Glow => Material::Glow { radiance: rgb(reals, 0), max_radius: reals[3] },
            Kind::Spotlight => self.spotlight(raw)?,
            Kind::Mirror => Material::Mirror { reflectance: rgb(reals, 0), substitute: substitute(raw, at) },
            Kind::Prism1 => Material::Prism(Prism { call: self.expressions(raw, 4)?, faces: PrismFace::One }),
            Kind::Prism2 => Material::Prism(Prism { call: self.expressions(raw, 8)?, faces: PrismFace::Two }),
            Kind::Mist => Material::Mist(mist(raw)),
            Kind::Plastic => Material::Plastic(glossy(reals)),
            Kind::Metal => Material::Metal(glossy(reals)),
            Kind::Trans => Material::Trans(translucent(reals, 5)),
            Kind::Plastic2 => Material::AnisotropicPlastic(self.anisotropic(raw, glossy(reals))?),
            Kind::Metal2 => Material::AnisotropicMetal(self.anisotropic(raw, glossy(reals))?),
            Kind::Trans2 => Material::AnisotropicTrans(self.anisotropic(raw, translucent(reals, 6))?),
            Kind::Ashik2 => Material::Ashikhmin {
                orientation: self.expressions(raw, 3)?,
                diffuse: rgb(reals, 0),
                specular: rgb(reals, 3),
                exponents: [reals[6], reals[7]],
            },
            Kind::WgmdFunc => self.ward_function(raw, at)?,
            Kind::Dielectric => Material::Dielectric(dielectric(reals)),
            Kind::Interface => {
                Material::Interface(Interface { inside: dielectric(&reals[..4]), outside: dielectric(&reals[4..]) })
            }
            Kind::Glass => Material::Glass {
                transmissivity: rgb(reals, 0),
                refractive_index: reals.get(3).copied().unwrap_or(GLASS_INDEX),
            },
            Kind::PlasFunc | Kind::PlasData => self.scattering(raw, ScatteringRole::Plastic)?,
            Kind::MetFunc | Kind::MetData => self.scattering(raw, ScatteringRole::Metal)?,
            Kind::TransFunc | Kind::TransData => self.scattering(raw, ScatteringRole::Trans)?,
            Kind::BrtdFunc => self.brtd_function(raw)?,
            Kind::Bsdf | Kind::ApertureBsdf => self.bsdf(raw)?,
            Kind::Antimatter => Material::Antimatter { cuts: cuts(raw, at) },
            Kind::BrdfPlugin => self.plugin(raw),
            _ => return self.not_yet(raw),
        })
    }

    fn plugin(&self, raw: &Raw) -> Material {
        let mut words = raw.strings.iter().map(|word| word.text.clone());
        let numbers = (0..raw.reals.len()).map(|index| self.real_span(raw, index));
        Material::Plugin {
            library: words.next().unwrap_or_default(),
            model: words.next().unwrap_or_default(),
            words: words.collect(),
            numbers: raw.reals.clone(),
            tokens: raw.strings.iter().map(|word| word.span).chain(numbers).collect(),
        }
    }

    fn spotlight(&mut self, raw: &Raw) -> Option<Material> {
        let name = self.scene.names.get(raw.name);
        let (degrees, aim) = (raw.reals[3], DVec3::from_slice(&raw.reals[4..]));
        let wrong = if degrees <= TINY {
            Some((3, format!("spotlight \"{name}\" has the angle {degrees}, expected degrees above zero")))
        } else if aim.length() == 0.0 {
            Some((4, format!("spotlight \"{name}\" has no direction")))
        } else {
            None
        };
        if let Some((index, message)) = wrong {
            let span = self.real_span(raw, index);
            self.log.push(Diagnostic::error(message).at(span));
            return None;
        }
        Some(Material::Spotlight {
            radiance: rgb(&raw.reals, 0),
            cone_angle: degrees.to_radians(),
            direction: aim.normalize(),
            focal_distance: aim.length(),
        })
    }

    /// A function call: the first `count` strings are expressions, followed by the function file.
    pub(super) fn expressions(&mut self, raw: &Raw, count: usize) -> Option<radsight_ir::FunctionCall> {
        let roots: Vec<RootWord> = (0..count).map(RootWord::Expression).collect();
        self.call(raw, &CallForm { file: count, roots: &roots })
    }

    fn anisotropic<S>(&mut self, raw: &Raw, surface: S) -> Option<Anisotropic<S>> {
        let orientation = self.expressions(raw, 3)?;
        Some(Anisotropic { orientation, surface, roughness_v: raw.reals[5] })
    }

    fn ward_function(&mut self, raw: &Raw, at: &Lowered<'_>) -> Option<Material> {
        let roots = [1, 2, 3, 5, 6, 7, 9, 10, 11].map(RootWord::Expression);
        let call = self.call(raw, &CallForm { file: 12, roots: &roots })?;
        let modifiers = raw.references.iter().map(|reference| match reference {
            Reference::To(handle) => at(*handle),
            Reference::Inherit => raw.parent.and_then(at),
            Reference::Void | Reference::Undefined => None,
        });
        let modifiers = modifiers.collect();
        let diffuse = [0, 3, 6].map(|first| rgb(&raw.reals, first));
        Some(Material::WardFunction(FunctionMaterial { call, diffuse, modifiers }))
    }

    fn brtd_function(&mut self, raw: &Raw) -> Option<Material> {
        let mut roots: Vec<RootWord> = (0..6).map(RootWord::Expression).collect();
        roots.extend((6..9).map(|index| RootWord::FunctionOrZero(index, 4)));
        let call = self.call(raw, &CallForm { file: 9, roots: &roots })?;
        let diffuse = [0, 3, 6].map(|first| rgb(&raw.reals, first));
        Some(Material::BrtdFunction(FunctionMaterial { call, diffuse, modifiers: Vec::new() }))
    }

    fn bsdf(&mut self, raw: &Raw) -> Option<Material> {
        let (form, first) = match raw.kind {
            Kind::Bsdf => (BsdfForm::Proxy, 1),
            _ => (BsdfForm::Aperture, 0),
        };
        let roots: Vec<RootWord> = (0..first).chain(first + 1..first + 4).map(RootWord::Expression).collect();
        let call = self.call(raw, &CallForm { file: first + 4, roots: &roots })?;
        let data = self.bsdf_data(&raw.strings[first])?;
        let diffuse = |at: usize| if raw.reals.len() >= at + 3 { rgb(&raw.reals, at) } else { Rgb::BLACK };
        Some(Material::Bsdf { data, call, form, added_diffuse: [0, 3, 6].map(diffuse) })
    }

    fn scattering(&mut self, raw: &Raw, role: ScatteringRole) -> Option<Material> {
        let is_data = matches!(raw.kind, Kind::PlasData | Kind::MetData | Kind::TransData);
        let (call, grid) = if is_data {
            let grid = self.grid(&raw.strings[1])?;
            let dimensions = self.scene.grids[grid].axes.len();
            let mut roots = vec![RootWord::Function(0, 5)];
            roots.extend((0..dimensions).map(|axis| RootWord::Function(3 + axis, 4)));
            (self.call(raw, &CallForm { file: 2, roots: &roots })?, Some(grid))
        } else {
            (self.call(raw, &CallForm { file: 1, roots: &[RootWord::Function(0, 4)] })?, None)
        };
        let reals = &raw.reals;
        let is_trans = role == ScatteringRole::Trans;
        Some(Material::Scattering(ScatteringFunction {
            role,
            call,
            grid,
            surface: Glossy { color: rgb(reals, 0), specularity: reals[3], roughness: 0.0 },
            transmissivity: if is_trans { reals[4] } else { 0.0 },
            transmitted_specularity: if is_trans { reals[5] } else { 0.0 },
        }))
    }
}

/// Three bands, starting at an index.
pub(super) fn rgb(reals: &[f64], first: usize) -> Rgb {
    Rgb([reals[first], reals[first + 1], reals[first + 2]])
}

fn glossy(reals: &[f64]) -> Glossy {
    Glossy { color: rgb(reals, 0), specularity: reals[3], roughness: reals[4] }
}

fn translucent(reals: &[f64], transmissivity: usize) -> Translucent {
    Translucent {
        surface: glossy(reals),
        transmissivity: reals[transmissivity],
        transmitted_specularity: reals[transmissivity + 1],
    }
}

fn dielectric(reals: &[f64]) -> Dielectric {
    let hartmann = reals.get(4).copied().unwrap_or(0.0);
    Dielectric { transmissivity: rgb(reals, 0), refractive_index: reals[3], hartmann }
}

fn mist(raw: &Raw) -> Mist {
    let reals = &raw.reals;
    Mist {
        extinction: if reals.len() >= 3 { rgb(reals, 0) } else { Rgb::BLACK },
        albedo: (reals.len() >= 6).then(|| rgb(reals, 3)),
        eccentricity: reals.get(6).copied(),
        sources: raw.strings.iter().map(|word| word.text.clone()).collect(),
    }
}

/// The material that replaces an `illum` or `mirror` seen directly. An undefined name makes the
/// surface invisible, as in Radiance.
fn substitute(raw: &Raw, at: &Lowered<'_>) -> Substitute {
    match raw.references.first() {
        None => Substitute::Own,
        Some(Reference::To(handle)) => at(*handle).map_or(Substitute::Void, Substitute::Modifier),
        Some(_) => Substitute::Void,
    }
}

fn cuts(raw: &Raw, at: &Lowered<'_>) -> Vec<Option<ModifierHandle>> {
    let known = raw.references.iter().filter(|reference| **reference != Reference::Undefined);
    known
        .map(|reference| match reference {
            Reference::To(handle) => at(*handle),
            _ => None,
        })
        .collect()
}
