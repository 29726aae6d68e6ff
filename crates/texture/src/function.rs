//! Compiled functions of the scene, with their coordinate systems.

use crate::function_view::FunctionView;
use crate::interaction::SurfaceInteraction;
use glam::DVec3;
use radsight_cal::Program;
use radsight_ir::{FunctionCall, Transform};
use std::sync::Arc;

/// Largest dimension of a data file; coordinates are kept on the stack.
pub(crate) const MAX_COORDINATES: usize = 16;

/// A compiled program and its coordinate system.
#[derive(Clone, Debug)]
pub struct Function {
    /// The compiled expressions.
    pub program: Arc<Program>,
    /// Transform from the scene's coordinates to the function's; `None` is the identity.
    to_function: Option<Transform>,
    to_scene: Transform,
}

impl Function {
    /// The function of a call in the scene.
    #[must_use]
    pub fn new(call: &FunctionCall) -> Function {
        let to_function = (call.to_scene != Transform::IDENTITY).then(|| call.to_scene.inverse());
        Function { program: call.program.clone(), to_function, to_scene: call.to_scene }
    }

    /// Transforms a vector from the function's coordinates to the scene's, where its modifier is
    /// used; preserves the length.
    pub fn in_scene(&self, interaction: &SurfaceInteraction, vector: DVec3) -> DVec3 {
        interaction.direction_to_scene(self.to_scene.direction(vector))
    }

    /// Scales a length from the function's coordinates to the scene's.
    pub fn length_in_scene(&self, interaction: &SurfaceInteraction, length: f64) -> f64 {
        let to_object = interaction.instance.as_ref().and_then(|instance| instance.to_object.as_ref());
        length * self.to_scene.scale / to_object.map_or(1.0, |transform| transform.scale)
    }

    /// Variables of the function at an intersection.
    #[inline]
    #[must_use]
    pub fn view<'a>(&'a self, interaction: &'a SurfaceInteraction) -> FunctionView<'a> {
        FunctionView::new(interaction, self.to_function.as_ref())
    }
}
