//! Functions of the scene, compiled, with the coordinates in which they stand.

use crate::function_view::FunctionView;
use crate::interaction::SurfaceInteraction;
use glam::DVec3;
use radsight_cal::Program;
use radsight_ir::{FunctionCall, Transform};
use std::sync::Arc;

/// The largest dimension of a data file that fits the evaluation's stack.
pub(crate) const MAX_COORDINATES: usize = 16;

/// A program and its frame.
#[derive(Clone, Debug)]
pub struct Function {
    /// The compiled expressions.
    pub program: Arc<Program>,
    /// From the scene to the function; `None` is the identity.
    to_function: Option<Transform>,
    to_scene: Transform,
}

impl Function {
    /// A function of the scene.
    #[must_use]
    pub fn new(call: &FunctionCall) -> Function {
        let to_function = (call.to_scene != Transform::IDENTITY).then(|| call.to_scene.inverse());
        Function { program: call.program.clone(), to_function, to_scene: call.to_scene }
    }

    /// A vector of the function in the scene, where the function's modifier stands; its length stays.
    pub fn in_scene(&self, interaction: &SurfaceInteraction, vector: DVec3) -> DVec3 {
        interaction.direction_to_scene(self.to_scene.direction(vector))
    }

    /// A length of the function in the scene.
    pub fn length_in_scene(&self, interaction: &SurfaceInteraction, length: f64) -> f64 {
        let to_object = interaction.placed.as_ref().and_then(|placed| placed.to_object.as_ref());
        length * self.to_scene.scale / to_object.map_or(1.0, |transform| transform.scale)
    }

    /// What the function sees of a ray.
    #[inline]
    #[must_use]
    pub fn view<'a>(&'a self, interaction: &'a SurfaceInteraction) -> FunctionView<'a> {
        FunctionView::new(interaction, self.to_function.as_ref())
    }
}
