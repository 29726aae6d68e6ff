//! What a surface does to light, compiled from its chain of modifiers once a scene.

use crate::antimatter::Antimatter;
use crate::bands::spread;
use crate::medium::MistKind;
use crate::prism::PrismKind;
use crate::refraction::DielectricInterface;
use crate::scatter::Scatterer;
use crate::step::{Share, Step};
use crate::surface_interaction::{SurfaceInteraction, View};
use glam::DVec3;
use radsight_accel::ShaderId;
use radsight_brdf::Brdf;
use radsight_cal::{Program, Scratch};
use radsight_ir::{FunctionCall, ModifierHandle, Rgb, Scene, Transform};
use std::sync::Arc;

/// Slopes below this are perfectly smooth to Radiance (its α² ≤ 1e-6).
pub(crate) const SMOOTH_ROUGHNESS: f64 = 1e-3;

/// Patterns, textures and the material of a surface.
#[derive(Clone, Debug)]
pub(crate) struct Shader {
    /// In the order in which Radiance applies them.
    pub(crate) steps: Vec<Step>,
    pub(crate) kind: Kind,
    /// Where its chain of modifiers stands, with all that the handles in here name.
    pub(crate) home: Home,
    /// The first modifier of its chain; `None` for `void`.
    pub(crate) modifier: Option<ModifierHandle>,
    /// Which of the modifiers it is whose contributions are wanted.
    pub(crate) tracked: Option<u32>,
}

/// The scene that a shader's modifiers come from; `None` for the whole one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Home(pub(crate) Option<Arc<Scene>>);

impl Home {
    /// The scene.
    #[inline]
    pub(crate) fn scene<'s>(&'s self, whole: &'s Scene) -> &'s Scene {
        self.0.as_deref().unwrap_or(whole)
    }
}

/// The material.
#[derive(Clone, Debug)]
pub(crate) enum Kind {
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
pub(crate) struct MixtureKind {
    /// How much of the first.
    pub(crate) share: Share,
    /// Foreground and background; each has the steps that stand before the mixture.
    pub(crate) arms: [ShaderId; 2],
    /// Whether one of them does.
    pub(crate) lets_light_through: bool,
}

/// A plastic or a metal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GlossyKind {
    pub(crate) color: Rgb,
    pub(crate) specularity: f64,
    pub(crate) roughness: f64,
    /// Highlights take the material's colour.
    pub(crate) metallic: bool,
}

impl GlossyKind {
    /// Whether its highlight is a mirror image.
    pub(crate) fn is_smooth(&self) -> bool {
        self.roughness <= SMOOTH_ROUGHNESS
    }
}

/// The material that is seen in place of another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Substitution {
    /// Rays go on.
    Void,
    /// A shader.
    Shader(ShaderId),
}

/// Which rays find an emitter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum EmitterClass {
    /// `light` and `spotlight`.
    Light,
    /// `glow`, with its radius in scene units: a sampled light up to there; below zero not even found by interreflection.
    Glow(f64),
    /// `illum`.
    Illum,
}

/// A light, glow, spotlight or illum.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Emitter {
    pub(crate) class: EmitterClass,
    pub(crate) radiance: Rgb,
    /// Cosine of the half angle of a spotlight's cone, and its unit axis.
    pub(crate) cone: Option<(f64, DVec3)>,
}

impl Emitter {
    /// A `light`.
    pub(crate) fn light(radiance: Rgb) -> Emitter {
        Emitter { class: EmitterClass::Light, radiance, cone: None }
    }

    /// Whether a shadow ray to it ends at an illum: both may stand for the same light.
    pub(crate) fn is_weak(&self) -> bool {
        self.class != EmitterClass::Light
    }
}

impl Kind {
    /// What it emits.
    pub(crate) fn emitter(&self) -> Option<&Emitter> {
        match self {
            Kind::Emitter(emitter) | Kind::Illum { emitter, .. } => Some(emitter),
            _ => None,
        }
    }

    /// Whether Radiance calls it transparent: a measurement of irradiance (`-i`) looks through it.
    pub(crate) fn is_transparent(&self) -> bool {
        matches!(self, Kind::Transparent | Kind::Glass { .. } | Kind::Dielectric(_) | Kind::Mist(_))
    }
}

/// A program and its frame.
#[derive(Clone, Debug)]
pub(crate) struct Function {
    pub(crate) program: Arc<Program>,
    /// From the scene to the function; `None` is the identity.
    to_function: Option<Transform>,
    to_scene: Transform,
}

impl Function {
    pub(crate) fn new(call: &FunctionCall) -> Function {
        let to_function = (call.to_scene != Transform::IDENTITY).then(|| call.to_scene.inverse());
        Function { program: call.program.clone(), to_function, to_scene: call.to_scene }
    }

    /// A vector of the function in the scene, where the function's modifier stands; its length stays.
    pub(crate) fn in_scene(&self, interaction: &SurfaceInteraction, vector: DVec3) -> DVec3 {
        interaction.direction_to_scene(self.to_scene.direction(vector))
    }

    /// A length of the function in the scene.
    pub(crate) fn length_in_scene(&self, interaction: &SurfaceInteraction, length: f64) -> f64 {
        let to_object = interaction.placed.as_ref().and_then(|placed| placed.to_object.as_ref());
        length * self.to_scene.scale / to_object.map_or(1.0, |transform| transform.scale)
    }

    pub(crate) fn view<'a>(&'a self, interaction: &'a SurfaceInteraction) -> View<'a> {
        View::new(interaction, self.to_function.as_ref())
    }
}

/// What patterns and textures make of an interaction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Appearance<const BANDS: usize> {
    /// Multiplies the material's colour.
    pub(crate) color: [f64; BANDS],
    /// Added to the unit normal on the side from which the ray comes.
    pub(crate) perturbation: DVec3,
}

impl Shader {
    /// Runs all patterns and textures.
    #[inline]
    pub(crate) fn appearance<const BANDS: usize>(
        &self,
        scene: &Scene,
        interaction: &SurfaceInteraction,
        scratch: &mut Scratch,
    ) -> Appearance<BANDS> {
        let mut appearance = Appearance { color: [1.0; BANDS], perturbation: interaction.perturbation() };
        if !self.steps.is_empty() {
            let scene = self.home.scene(scene);
            for step in &self.steps {
                step.apply(scene, interaction, scratch, &mut appearance);
            }
        }
        if interaction.behind {
            appearance.perturbation = -appearance.perturbation;
        }
        appearance
    }

    /// The same at the surface of a body: the colour, and what is added to the front normal.
    pub(crate) fn body_appearance<const BANDS: usize>(
        &self,
        scene: &Scene,
        interaction: &SurfaceInteraction,
        scratch: &mut Scratch,
    ) -> ([f64; BANDS], DVec3) {
        let Appearance { color, perturbation } = self.appearance(scene, interaction, scratch);
        (color, if interaction.behind { -perturbation } else { perturbation })
    }

    /// Whether every band is the same, whatever the interaction.
    pub(crate) fn is_grey(&self) -> bool {
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
    pub(crate) fn can_hide_its_back(&self) -> bool {
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
    pub(crate) fn lets_light_through(&self) -> bool {
        match &self.kind {
            Kind::Glass { .. } => true,
            Kind::Scatterer(scatterer) => scatterer.lets_through(),
            Kind::Mixture(mixture) => mixture.lets_light_through,
            _ => false,
        }
    }

    /// Whether a shadow ray may end there or go on.
    pub(crate) fn matters_to_shadow_rays(&self) -> bool {
        let kind = &self.kind;
        self.lets_light_through()
            || kind.is_transparent()
            || matches!(kind, Kind::Emitter(_) | Kind::Illum { .. } | Kind::Mirror { .. })
    }

    fn has_color_steps(&self) -> bool {
        self.steps.iter().any(Step::is_colored)
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

/// A colour in the places of a tracer.
#[inline]
pub(crate) fn bands<const BANDS: usize>(color: Rgb) -> [f64; BANDS] {
    spread(color.0)
}
