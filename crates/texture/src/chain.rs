//! Patterns and textures of a chain of modifiers.

use crate::appearance::{Appearance, TransmittedRays};
use crate::interaction::SurfaceInteraction;
use crate::step::Step;
use radsight_cal::Scratch;
use radsight_ir::Scene;
use std::sync::Arc;

/// Scene in which a shader's modifiers are defined; `None` for the top-level scene.
#[derive(Clone, Debug, Default)]
pub struct Home(pub Option<Arc<Scene>>);

impl Home {
    /// The scene itself.
    #[inline]
    pub fn scene<'s>(&'s self, whole: &'s Scene) -> &'s Scene {
        self.0.as_deref().unwrap_or(whole)
    }
}

/// Patterns and textures, applied in order.
#[derive(Clone, Debug, Default)]
pub struct TextureChain {
    /// In the order in which Radiance applies them.
    pub steps: Vec<Step>,
    /// Scene of the modifiers, which the handles in the steps refer to.
    pub home: Home,
    /// Whether the textures turn transmitted rays too.
    pub transmitted: TransmittedRays,
}

impl TextureChain {
    /// Evaluates all patterns and textures.
    #[inline]
    pub fn appearance<const BANDS: usize>(
        &self,
        scene: &Scene,
        interaction: &SurfaceInteraction,
        scratch: &mut Scratch,
    ) -> Appearance<BANDS> {
        let mut appearance =
            Appearance { color: [1.0; BANDS], perturbation: interaction.perturbation(), transmitted: self.transmitted };
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

    /// Whether any pattern may have different factors in different bands.
    #[must_use]
    pub fn is_colored(&self) -> bool {
        self.steps.iter().any(Step::is_colored)
    }
}
