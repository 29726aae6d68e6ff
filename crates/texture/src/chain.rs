//! The patterns and textures of a chain of modifiers.

use crate::appearance::Appearance;
use crate::interaction::SurfaceInteraction;
use crate::step::Step;
use radsight_cal::Scratch;
use radsight_ir::Scene;
use std::sync::Arc;

/// The scene that a shader's modifiers come from; `None` for the whole one.
#[derive(Clone, Debug, Default)]
pub struct Home(pub Option<Arc<Scene>>);

impl Home {
    /// The scene.
    #[inline]
    pub fn scene<'s>(&'s self, whole: &'s Scene) -> &'s Scene {
        self.0.as_deref().unwrap_or(whole)
    }
}

/// Patterns and textures that are applied one after the other.
#[derive(Clone, Debug, Default)]
pub struct TextureChain {
    /// In the order in which Radiance applies them.
    pub steps: Vec<Step>,
    /// Where the chain of modifiers stands, with all that the handles in here name.
    pub home: Home,
}

impl TextureChain {
    /// Runs all patterns and textures.
    #[inline]
    pub fn appearance<const BANDS: usize>(
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

    /// Whether any pattern may multiply bands by different values.
    #[must_use]
    pub fn is_colored(&self) -> bool {
        self.steps.iter().any(Step::is_colored)
    }
}
