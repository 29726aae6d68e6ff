//! Shaders: the appearance and the material of a surface, compiled from its modifier chain once per
//! scene.

use crate::antimatter::Antimatter;
use crate::medium::MistKind;
use crate::prism::PrismKind;
use crate::refraction::DielectricInterface;
use glam::DVec3;
use radsight_accel::{ShaderId, Substance};
use radsight_brdf::Brdf;
use radsight_bsdf::{GlossyKind, Scatterer};
use radsight_cal::Scratch;
use radsight_ir::{ModifierHandle, Rgb, Scene};
use radsight_texture::{Appearance, Share, SurfaceInteraction, TextureChain};
use std::sync::Arc;

/// Patterns, textures and the material of a surface.
#[derive(Clone, Debug)]
pub struct Shader {
    /// Patterns and textures.
    pub textures: TextureChain,
    /// The material.
    pub kind: Kind,
    /// First modifier of the chain; `None` for `void`.
    pub modifier: Option<ModifierHandle>,
    /// Index of its tracked modifier, if its contributions are reported.
    pub tracked: Option<u32>,
    /// What Radiance counts the material as.
    pub substance: Substance,
}

/// Kind of material.
#[derive(Clone, Debug)]
pub enum Kind {
    /// No material: rays pass through.
    Transparent,
    /// Emits, but does not reflect.
    Emitter(Emitter),
    /// `plastic` and `metal`.
    Glossy(GlossyKind),
    /// A rough highlight whose texture turns the normal to the viewer: the paper's retroreflector.
    Retro(GlossyKind),
    /// A plane mirror that makes virtual sources.
    Mirror {
        /// Reflectance.
        reflectance: Rgb,
        /// Alternate material for all rays but those to its virtual sources.
        substitute: Option<Substitution>,
    },
    /// `illum`: a light with another appearance.
    Illum {
        /// Emission, for light sampling.
        emitter: Emitter,
        /// Alternate material, for other rays.
        substitute: Substitution,
    },
    /// `dielectric` and `interface`.
    Dielectric(DielectricInterface),
    /// The surface of a participating medium.
    Mist(MistKind),
    /// `prism1` and `prism2`.
    Prism(PrismKind),
    /// `antimatter`: subtracts from other surfaces.
    Antimatter(Antimatter),
    /// `glass`: a thin pane.
    Glass {
        /// Transmissivity for one passage at normal incidence.
        transmissivity: Rgb,
        /// Index of refraction.
        refractive_index: f64,
    },
    /// Another scattering material.
    Scatterer(Box<Scatterer>),
    /// A reflectance model of a plugin.
    Plugin(Arc<dyn Brdf>),
    /// A mixture of two shaders.
    Mixture(Box<MixtureKind>),
    /// A modifier of the surface has an error: the picture is invalid if a ray meets it.
    Unusable(Unusable),
}

/// A modifier with an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unusable {
    /// The material, pattern or texture, in the scene of the surface.
    pub modifier: ModifierHandle,
    /// Whether shadow rays meet it as well: without the error they could pass.
    pub lets_light_through: bool,
}

/// A mixture of materials.
#[derive(Clone, Debug)]
pub struct MixtureKind {
    /// Weight of the foreground.
    pub share: Share,
    /// Foreground and background; each includes the steps before the mixture.
    pub arms: [ShaderId; 2],
    /// Whether either of them transmits light.
    pub lets_light_through: bool,
    /// Number of mixtures that one hit evaluates: this one and those of its parts, each counted
    /// wherever it is used.
    pub mixtures: usize,
    /// Depth of nested mixtures, this one included.
    pub depth: u32,
}

/// Alternate material of a mirror or illum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Substitution {
    /// `void`: rays pass through.
    Void,
    /// Another shader.
    Shader(ShaderId),
}

/// Type of an emitter, which decides the rays that see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EmitterType {
    /// `light` and `spotlight`.
    Light,
    /// `glow`, with its radius of influence in scene units: a sampled light up to that distance. If
    /// it is negative, not even interreflection finds the glow.
    Glow(f64),
    /// `illum`.
    Illum,
}

/// Parameters of a light, glow, spotlight or illum.
#[derive(Clone, Copy, Debug)]
pub struct Emitter {
    /// Type of the emitter.
    pub class: EmitterType,
    /// Radiance before patterns, W/(sr·m²).
    pub radiance: Rgb,
    /// Cosine of the half angle of a spotlight's cone, and its unit axis.
    pub cone: Option<(f64, DVec3)>,
}

impl Emitter {
    /// Emitter of a `light`.
    pub fn light(radiance: Rgb) -> Emitter {
        Emitter { class: EmitterType::Light, radiance, cone: None }
    }

    /// Whether a shadow ray to it ends at an illum: both may stand for the same light.
    pub fn is_weak(&self) -> bool {
        self.class != EmitterType::Light
    }
}

impl Kind {
    /// Emission of the material, if it emits.
    #[inline]
    pub fn emitter(&self) -> Option<&Emitter> {
        match self {
            Kind::Emitter(emitter) | Kind::Illum { emitter, .. } => Some(emitter),
            _ => None,
        }
    }

    /// Whether it sends on all light without scattering: no material, glass, a dielectric or mist.
    pub fn is_transparent(&self) -> bool {
        matches!(self, Kind::Transparent | Kind::Glass { .. } | Kind::Dielectric(_) | Kind::Mist(_))
    }
}

impl Shader {
    /// Whether an irradiance measurement (`-i`) passes through it: Radiance counts the material as transparent, or
    /// there is none.
    pub fn passes_irradiance(&self) -> bool {
        self.substance == Substance::Transparent || matches!(self.kind, Kind::Transparent)
    }

    /// Evaluates all patterns and textures.
    #[inline]
    pub fn appearance<const BANDS: usize>(
        &self,
        scene: &Scene,
        interaction: &SurfaceInteraction,
        scratch: &mut Scratch,
    ) -> Appearance<BANDS> {
        self.textures.appearance(scene, interaction, scratch)
    }

    /// The same at an interface: the colour, and the perturbation of the front normal.
    pub fn body_appearance<const BANDS: usize>(
        &self,
        scene: &Scene,
        interaction: &SurfaceInteraction,
        scratch: &mut Scratch,
    ) -> ([f64; BANDS], DVec3) {
        let Appearance { color, perturbation, .. } = self.appearance(scene, interaction, scratch);
        (color, if interaction.behind { -perturbation } else { perturbation })
    }

    /// Whether every band is the same at every intersection.
    pub fn is_grey(&self) -> bool {
        let color = match &self.kind {
            // The parts of a mixture are shaders with a test of their own.
            Kind::Transparent | Kind::Mixture(_) | Kind::Prism(_) | Kind::Antimatter(_) | Kind::Unusable(_) => {
                Rgb::WHITE
            }
            Kind::Plugin(model) => return !self.has_color_steps() && is_grey_model(model.as_ref()),
            Kind::Scatterer(scatterer) => return !self.has_color_steps() && scatterer.is_grey(),
            Kind::Emitter(emitter) | Kind::Illum { emitter, .. } => emitter.radiance,
            Kind::Dielectric(boundary) => return boundary.is_grey() && !self.has_color_steps(),
            Kind::Mist(mist) => return mist.is_grey() && !self.has_color_steps(),
            Kind::Glossy(glossy) | Kind::Retro(glossy) => glossy.color,
            Kind::Mirror { reflectance, .. } => *reflectance,
            Kind::Glass { transmissivity, .. } => *transmissivity,
        };
        color.is_grey() && !self.has_color_steps()
    }

    /// Roughness (rms slope) of its mirror reflection or highlight; `None` if it has none that is known.
    pub fn mirror_roughness(&self) -> Option<f64> {
        match &self.kind {
            Kind::Glossy(glossy) if glossy.specularity > 0.0 => Some(glossy.roughness),
            Kind::Dielectric(_) | Kind::Mirror { .. } => Some(0.0),
            _ => None,
        }
    }

    /// Whether rays pass through its back if back faces are invisible.
    pub fn can_hide_its_back(&self) -> bool {
        match &self.kind {
            Kind::Scatterer(scatterer) => !scatterer.has_a_back(),
            // The parts of a mixture decide for themselves.
            Kind::Dielectric(_) | Kind::Mist(_) | Kind::Prism(_) | Kind::Illum { .. } | Kind::Mixture(_) => false,
            Kind::Antimatter(_) => false,
            Kind::Mirror { substitute, .. } => substitute.is_none(),
            _ => true,
        }
    }

    /// Whether it may pass shadow rays on, also as a surface without material.
    pub fn passes_shadow_rays(&self) -> bool {
        matches!(self.kind, Kind::Transparent) || self.lets_light_through()
    }

    /// Whether shadow rays can pass through.
    pub fn lets_light_through(&self) -> bool {
        match &self.kind {
            Kind::Glass { .. } => true,
            Kind::Scatterer(scatterer) => scatterer.lets_through(),
            Kind::Mixture(mixture) => mixture.lets_light_through,
            Kind::Unusable(unusable) => unusable.lets_light_through,
            _ => false,
        }
    }

    /// Whether a shadow ray may end there or continue differently.
    pub fn matters_to_shadow_rays(&self) -> bool {
        let kind = &self.kind;
        self.lets_light_through()
            || kind.is_transparent()
            || matches!(kind, Kind::Emitter(_) | Kind::Illum { .. } | Kind::Mirror { .. })
    }

    fn has_color_steps(&self) -> bool {
        self.textures.is_colored()
    }
}

/// Whether a model gives three equal bands for pairs of directions over both hemispheres. A model
/// made for one band does.
fn is_grey_model(model: &dyn Brdf) -> bool {
    const TRIALS: u32 = 64;
    let unit = |index: u32, trial: u32| {
        let u = (f64::from(trial + 1) * 0.754_877_666 + f64::from(index) * 0.37).fract();
        let v = (f64::from(trial + 1) * 0.569_840_291 + f64::from(index) * 0.61).fract();
        DVec3::from_array(radsight_sampling::cosine_hemisphere(u, v))
    };
    (0..TRIALS).all(|trial| {
        let outgoing = unit(0, trial);
        let mirror = DVec3::new(-outgoing.x, -outgoing.y, outgoing.z);
        let incident = [unit(1, trial), mirror, outgoing, -unit(2, trial)];
        let mut values = [0.0; 12];
        let mut pdfs = [0.0; 4];
        model.eval_pdf(outgoing, &incident, &mut values, &mut pdfs);
        let mut weights = [0.0; 3];
        let sample = model.sample(outgoing, [0.3, 0.6, f64::from(trial) / f64::from(TRIALS)], &mut weights);
        let equal = |bands: &[f64]| bands[0] == bands[1] && bands[1] == bands[2];
        values.chunks(3).all(equal) && (sample.is_none() || equal(&weights))
    })
}
