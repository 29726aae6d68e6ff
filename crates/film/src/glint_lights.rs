//! The lights whose glints are searched.

use crate::view_camera::ViewCamera;
use radsight_render::{Lights, RenderPlan};

/// Scenes with more lights are rendered without a search for their glints.
const MOST_LIGHTS: usize = 64;

/// The lights of a picture that may have glints, by their numbers in the plan.
#[derive(Clone, Debug, Default)]
pub(crate) struct GlintLights(pub(crate) Vec<usize>);

impl GlintLights {
    /// None where pixels are points or rays start at different points or times, where reflected rays see no lights, and
    /// where there are many.
    pub(crate) fn find(plan: &RenderPlan, camera: &ViewCamera) -> GlintLights {
        let are_seen = plan.lights_seen() != Lights::Invisible && plan.reflects_like_a_mirror();
        if camera.jitter <= 0.0 || camera.is_blurred() || !are_seen {
            return GlintLights::default();
        }
        let real: Vec<usize> = (plan.lights.iter().enumerate())
            .filter(|(_, light)| light.virtual_sources.is_empty())
            .map(|(number, _)| number)
            .collect();
        GlintLights(if real.len() > MOST_LIGHTS { Vec::new() } else { real })
    }
}
