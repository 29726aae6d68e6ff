//! What a surface does to light, compiled from its chain of modifiers once a scene.

use crate::antimatter::Antimatter;
use crate::medium::MistKind;
use crate::prism::PrismKind;
use crate::refraction::DielectricInterface;
use glam::DVec3;
use radsight_accel::ShaderId;
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
    /// The first modifier of its chain; `None` for `void`.
    pub modifier: Option<ModifierHandle>,
    /// Which of the modifiers it is whose contributions are wanted.
    pub tracked: Option<u32>,
}

/// The material.
#[derive(Clone, Debug)]
pub enum Kind {
    /// No material: rays go on.
    Transparent,
    /// Emits and does not reflect.
    Emitter(Emitter),
    /// `plastic` and `metal`.
    Glossy(GlossyKind),
    /// A rough highlight whose texture turns the normal to the viewer: the retroreflector of the paper.
    Retro(GlossyKind),
    /// A plane mirror that relays lights.
    Mirror {
        /// Reflectance.
        reflectance: Rgb,
        /// What it is to all rays but those that look for a light by way of it.
        substitute: Option<Substitution>,
    },
    /// A light that looks like something else.
    Illum {
        /// What it is to rays that look for light.
        emitter: Emitter,
        /// What it is to others.
        substitute: Substitution,
    },
    /// `dielectric` and `interface`.
    Dielectric(DielectricInterface),
    /// The surface of a participating medium.
    Mist(MistKind),
    /// `prism1` and `prism2`.
    Prism(PrismKind),
    /// Cuts other surfaces away.
    Antimatter(Antimatter),
    /// A thin pane.
    Glass {
        /// For one passage at normal incidence.
        transmissivity: Rgb,
        /// Index of refraction.
        refractive_index: f64,
    },
    /// A material that scatters in some other way.
    Scatterer(Box<Scatterer>),
    /// A reflectance model from elsewhere.
    Plugin(Arc<dyn Brdf>),
    /// Part of one shader, and the rest of another.
    Mixture(Box<MixtureKind>),
    /// Something is wrong with it: the picture is worthless once a ray meets it.
    Unusable,
}

/// A mixture of materials.
#[derive(Clone, Debug)]
pub struct MixtureKind {
    /// How much of the first.
    pub share: Share,
    /// Foreground and background; each has the steps that stand before the mixture.
    pub arms: [ShaderId; 2],
    /// Whether one of them does.
    pub lets_light_through: bool,
}

/// The material that is seen in place of another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Substitution {
    /// Rays go on.
    Void,
    /// A shader.
    Shader(ShaderId),
}

/// Which rays find an emitter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EmitterClass {
    /// `light` and `spotlight`.
    Light,
    /// `glow`, with its radius in scene units: a sampled light up to there; below zero not even found by interreflection.
    Glow(f64),
    /// `illum`.
    Illum,
}

/// A light, glow, spotlight or illum.
#[derive(Clone, Copy, Debug)]
pub struct Emitter {
    /// Which rays find it.
    pub class: EmitterClass,
    /// W/(sr·m²), before patterns.
    pub radiance: Rgb,
    /// Cosine of the half angle of a spotlight's cone, and its unit axis.
    pub cone: Option<(f64, DVec3)>,
}

impl Emitter {
    /// A `light`.
    pub fn light(radiance: Rgb) -> Emitter {
        Emitter { class: EmitterClass::Light, radiance, cone: None }
    }

    /// Whether a shadow ray to it ends at an illum: both may stand for the same light.
    pub fn is_weak(&self) -> bool {
        self.class != EmitterClass::Light
    }
}

impl Kind {
    /// What it emits.
    #[inline]
    pub fn emitter(&self) -> Option<&Emitter> {
        match self {
            Kind::Emitter(emitter) | Kind::Illum { emitter, .. } => Some(emitter),
            _ => None,
        }
    }

    /// Whether Radiance calls it transparent: a measurement of irradiance (`-i`) looks through it.
    pub fn is_transparent(&self) -> bool {
        matches!(self, Kind::Transparent | Kind::Glass { .. } | Kind::Dielectric(_) | Kind::Mist(_))
    }
}

impl Shader {
    /// Runs all patterns and textures.
    #[inline]
    pub fn appearance<const BANDS: usize>(
        &self,
        scene: &Scene,
        interaction: &SurfaceInteraction,
        scratch: &mut Scratch,
    ) -> Appearance<BANDS> {
        self.textures.appearance(scene, interaction, scratch)
    }

    /// The same at the surface of a body: the colour, and what is added to the front normal.
    pub fn body_appearance<const BANDS: usize>(
        &self,
        scene: &Scene,
        interaction: &SurfaceInteraction,
        scratch: &mut Scratch,
    ) -> ([f64; BANDS], DVec3) {
        let Appearance { color, perturbation } = self.appearance(scene, interaction, scratch);
        (color, if interaction.behind { -perturbation } else { perturbation })
    }

    /// Whether every band is the same, whatever the interaction.
    pub fn is_grey(&self) -> bool {
        let color = match &self.kind {
            // The parts of a mixture are shaders of their own.
            Kind::Transparent | Kind::Mixture(_) | Kind::Prism(_) | Kind::Antimatter(_) | Kind::Unusable => Rgb::WHITE,
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

    /// Whether rays from behind pass where back faces are invisible.
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

    /// Whether shadow rays can go on through it.
    pub fn lets_light_through(&self) -> bool {
        match &self.kind {
            Kind::Glass { .. } => true,
            Kind::Scatterer(scatterer) => scatterer.lets_through(),
            Kind::Mixture(mixture) => mixture.lets_light_through,
            _ => false,
        }
    }

    /// Whether a shadow ray may end there or go on.
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

/// Whether a model gives three equal bands for pairs of directions all over; one that was made for one band does.
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
        let drawn = model.sample(outgoing, [0.3, 0.6, f64::from(trial) / f64::from(TRIALS)], &mut weights);
        let equal = |bands: &[f64]| bands[0] == bands[1] && bands[1] == bands[2];
        values.chunks(3).all(equal) && (drawn.is_none() || equal(&weights))
    })
}
