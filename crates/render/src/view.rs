//! What a function sees of a ray.

use crate::ray::Ray;
use glam::DVec3;
use radsight_cal::Host;
use radsight_ir::Transform;

/// A ray at the surface that it meets, in scene coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Encounter {
    /// Unit, along the ray.
    pub(crate) direction: DVec3,
    /// Unit normal, turned towards the side from which the ray comes.
    pub(crate) normal: DVec3,
    pub(crate) point: DVec3,
    /// From the eye, over all reflections.
    pub(crate) total_distance: f64,
    /// Of this ray alone.
    pub(crate) distance: f64,
    /// −direction·normal as the surface faces: negative from behind.
    pub(crate) cosine: f64,
}

impl Encounter {
    pub(crate) fn new(ray: &Ray, point: DVec3, front: DVec3, distance: f64, total_distance: f64) -> Encounter {
        let cosine = -ray.direction.dot(front);
        let normal = if cosine < 0.0 { -front } else { front };
        Encounter { direction: ray.direction, normal, point, total_distance, distance, cosine: cosine.abs() }
    }
}

/// An encounter in the coordinates of one modifier: the channels `$n` of Radiance's function language.
pub(crate) struct View<'a> {
    pub(crate) encounter: &'a Encounter,
    /// From scene coordinates to the function's; `None` where they are the same.
    pub(crate) to_function: Option<&'a Transform>,
}

impl View<'_> {
    fn direction(&self, vector: DVec3, component: usize) -> f64 {
        self.to_function.map_or(vector, |transform| transform.direction(vector))[component]
    }

    fn frame(&self) -> Transform {
        self.to_function.copied().unwrap_or_default()
    }
}

impl Host for View<'_> {
    /// Channels as Radiance numbers them: 1–3 ray direction, 4–6 normal, 7–9 point, 10 total distance, 11 cosine, 12 scale,
    /// 13–15 origin, 16–24 axes, 25 distance of this ray, 26–27 local coordinates.
    #[inline]
    fn channel(&self, n: u32) -> f64 {
        let encounter = self.encounter;
        let index = n.wrapping_sub(1) as usize;
        match n {
            1..=3 => self.direction(encounter.direction, index),
            4..=6 => self.direction(encounter.normal, index - 3),
            7..=9 => self.to_function.map_or(encounter.point, |transform| transform.point(encounter.point))[index - 6],
            10 => encounter.total_distance * self.frame().scale,
            11 => encounter.cosine.clamp(-1.0, 1.0),
            12 => self.frame().scale,
            13..=15 => self.frame().translation[index - 12],
            16..=18 => self.frame().rotation.col(0)[index - 15],
            19..=21 => self.frame().rotation.col(1)[index - 18],
            22..=24 => self.frame().rotation.col(2)[index - 21],
            25 => encounter.distance * self.frame().scale,
            _ => 0.0,
        }
    }
}
