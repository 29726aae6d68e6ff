//! Variables of a function at an intersection: the channels of Radiance's function language.

use crate::interaction::SurfaceInteraction;
use glam::DVec3;
use radsight_cal::Host;
use radsight_ir::Transform;

/// An intersection in the coordinates of one modifier: the channels `$n` of Radiance's function
/// language.
pub struct FunctionView<'a> {
    interaction: &'a SurfaceInteraction,
    to_function: ToFunction<'a>,
}

/// Transform from the scene's coordinates to the function's.
enum ToFunction<'a> {
    Same,
    Own(&'a Transform),
    /// Through the coordinates of an instance.
    Placed(Transform),
}

impl<'a> FunctionView<'a> {
    /// `to_function` transforms from the coordinates of the modifiers to the function's; `None` if
    /// they are the same.
    pub fn new(interaction: &'a SurfaceInteraction, to_function: Option<&'a Transform>) -> FunctionView<'a> {
        let to_object = interaction.instance.as_ref().and_then(|instance| instance.to_object.as_ref());
        let to_function = match (to_object, to_function) {
            (None, None) => ToFunction::Same,
            (None, Some(own)) => ToFunction::Own(own),
            (Some(to_object), None) => ToFunction::Own(to_object),
            (Some(to_object), Some(own)) => ToFunction::Placed(to_object.then(own)),
        };
        FunctionView { interaction, to_function }
    }

    #[inline]
    fn transform(&self) -> Option<&Transform> {
        match &self.to_function {
            ToFunction::Same => None,
            ToFunction::Own(transform) => Some(transform),
            ToFunction::Placed(transform) => Some(transform),
        }
    }

    /// Transforms a direction from the scene's coordinates to the function's.
    pub fn in_function(&self, vector: DVec3) -> DVec3 {
        self.transform().map_or(vector, |transform| transform.direction(vector))
    }

    fn direction(&self, vector: DVec3, component: usize) -> f64 {
        self.transform().map_or(vector, |transform| transform.direction(vector))[component]
    }

    fn frame(&self) -> Transform {
        self.transform().copied().unwrap_or_default()
    }
}

impl Host for FunctionView<'_> {
    /// Channels in Radiance's numbering: 1–3 ray direction, 4–6 normal, 7–9 point, 10 total
    /// distance, 11 cosine, 12 scale, 13–15 origin, 16–24 axes, 25 distance of this ray, 26–27
    /// local coordinates.
    #[inline]
    fn channel(&self, n: u32) -> f64 {
        let interaction = self.interaction;
        let index = n.wrapping_sub(1) as usize;
        match n {
            1..=3 => self.direction(interaction.direction, index),
            4..=6 => self.direction(interaction.front(), index - 3),
            7..=9 => {
                self.transform().map_or(interaction.point, |transform| transform.point(interaction.point))[index - 6]
            }
            10 => interaction.total_distance * self.frame().scale,
            11 => if interaction.behind { -interaction.cosine } else { interaction.cosine }.clamp(-1.0, 1.0),
            12 => self.frame().scale,
            13..=15 => self.frame().translation[index - 12],
            16..=18 => self.frame().rotation.col(0)[index - 15],
            19..=21 => self.frame().rotation.col(1)[index - 18],
            22..=24 => self.frame().rotation.col(2)[index - 21],
            25 => interaction.distance * self.frame().scale,
            26..=27 => interaction.instance.map_or(0.0, |instance| instance.uv[index - 25]),
            _ => 0.0,
        }
    }
}
