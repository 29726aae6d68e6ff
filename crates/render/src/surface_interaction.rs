//! What a function sees of a ray.

use glam::DVec3;
use radsight_accel::{Intersection, Placed, Ray};
use radsight_cal::Host;
use radsight_ir::Transform;

/// A ray at the surface that it meets, in scene coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfaceInteraction {
    /// Unit, along the ray.
    pub(crate) direction: DVec3,
    /// Unit normal, turned towards the side from which the ray comes.
    pub(crate) normal: DVec3,
    pub(crate) point: DVec3,
    /// From the eye, over all reflections.
    pub(crate) total_distance: f64,
    /// Of this ray alone.
    pub(crate) distance: f64,
    /// −direction·normal, not negative.
    pub(crate) cosine: f64,
    /// Whether the ray comes from the back. Functions see the normal as the surface faces.
    pub(crate) behind: bool,
    /// What only meshes and instances have.
    pub(crate) placed: Option<Placed>,
}

impl SurfaceInteraction {
    /// With a surface that is neither a mesh nor within an instance.
    pub(crate) fn new(ray: &Ray, point: DVec3, front: DVec3, distance: f64, total_distance: f64) -> SurfaceInteraction {
        let cosine = -ray.direction.dot(front);
        let behind = cosine < 0.0;
        let normal = if behind { -front } else { front };
        let cosine = cosine.abs();
        SurfaceInteraction {
            direction: ray.direction,
            normal,
            point,
            total_distance,
            distance,
            cosine,
            behind,
            placed: None,
        }
    }

    /// Where a ray hits.
    pub(crate) fn at(ray: &Ray, hit: &Intersection, total_distance: f64) -> SurfaceInteraction {
        let placed = hit.placed;
        SurfaceInteraction {
            placed,
            ..SurfaceInteraction::new(ray, hit.point, hit.front, hit.distance, total_distance)
        }
    }

    /// With a distant source.
    pub(crate) fn distant(direction: DVec3) -> SurfaceInteraction {
        SurfaceInteraction {
            direction,
            normal: -direction,
            point: direction,
            total_distance: f64::MAX,
            distance: f64::MAX,
            cosine: 1.0,
            behind: false,
            placed: None,
        }
    }

    /// The perturbation with which textures start.
    pub(crate) fn perturbation(&self) -> DVec3 {
        self.placed.map_or(DVec3::ZERO, |placed| placed.perturbation)
    }

    /// The point in the coordinates in which the modifiers stand.
    pub(crate) fn object_point(&self) -> DVec3 {
        let to_object = self.placed.as_ref().and_then(|placed| placed.to_object.as_ref());
        to_object.map_or(self.point, |transform| transform.point(self.point))
    }

    /// A direction in the coordinates in which the modifiers stand, in the scene's.
    pub(crate) fn direction_to_scene(&self, direction: DVec3) -> DVec3 {
        let to_object = self.placed.as_ref().and_then(|placed| placed.to_object.as_ref());
        to_object.map_or(direction, |transform| transform.rotation.transpose() * direction)
    }

    /// The same, as if the surface faced the viewer.
    pub(crate) fn turned(&self) -> SurfaceInteraction {
        SurfaceInteraction { behind: false, ..*self }
    }

    /// Whether its normal is interpolated.
    pub(crate) fn is_smoothed(&self) -> bool {
        self.perturbation() != DVec3::ZERO
    }

    /// The unit normal as the surface faces.
    fn front(&self) -> DVec3 {
        if self.behind { -self.normal } else { self.normal }
    }
}

/// An interaction in the coordinates of one modifier: the channels `$n` of Radiance's function language.
pub(crate) struct View<'a> {
    interaction: &'a SurfaceInteraction,
    to_function: ToFunction<'a>,
}

/// From scene coordinates to a function's.
enum ToFunction<'a> {
    Same,
    Own(&'a Transform),
    /// By way of the coordinates of an instance.
    Placed(Transform),
}

impl<'a> View<'a> {
    /// `to_function` leads on from the coordinates in which the modifiers stand; `None` where the function uses the same.
    pub(crate) fn new(interaction: &'a SurfaceInteraction, to_function: Option<&'a Transform>) -> View<'a> {
        let to_object = interaction.placed.as_ref().and_then(|placed| placed.to_object.as_ref());
        let to_function = match (to_object, to_function) {
            (None, None) => ToFunction::Same,
            (None, Some(own)) => ToFunction::Own(own),
            (Some(to_object), None) => ToFunction::Own(to_object),
            (Some(to_object), Some(own)) => ToFunction::Placed(to_object.then(own)),
        };
        View { interaction, to_function }
    }

    #[inline]
    fn transform(&self) -> Option<&Transform> {
        match &self.to_function {
            ToFunction::Same => None,
            ToFunction::Own(transform) => Some(transform),
            ToFunction::Placed(transform) => Some(transform),
        }
    }

    /// A direction of the scene as the function sees it.
    pub(crate) fn in_function(&self, vector: DVec3) -> DVec3 {
        self.transform().map_or(vector, |transform| transform.direction(vector))
    }

    fn direction(&self, vector: DVec3, component: usize) -> f64 {
        self.transform().map_or(vector, |transform| transform.direction(vector))[component]
    }

    fn frame(&self) -> Transform {
        self.transform().copied().unwrap_or_default()
    }
}

impl Host for View<'_> {
    /// Channels as Radiance numbers them: 1–3 ray direction, 4–6 normal, 7–9 point, 10 total distance, 11 cosine, 12 scale,
    /// 13–15 origin, 16–24 axes, 25 distance of this ray, 26–27 local coordinates.
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
            26..=27 => interaction.placed.map_or(0.0, |placed| placed.uv[index - 25]),
            _ => 0.0,
        }
    }
}
