//! Where a ray meets a surface, with what functions, textures and materials ask of it.

use glam::DVec3;
use radsight_accel::{Intersection, Placed, Ray};

/// A ray at the surface that it meets, in scene coordinates.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceInteraction {
    /// Unit, along the ray.
    pub direction: DVec3,
    /// Unit normal, turned towards the side from which the ray comes.
    pub normal: DVec3,
    /// Scene coordinates.
    pub point: DVec3,
    /// From the eye, over all reflections.
    pub total_distance: f64,
    /// Of this ray alone.
    pub distance: f64,
    /// −direction·normal, not negative.
    pub cosine: f64,
    /// Whether the ray comes from the back. Functions see the normal as the surface faces.
    pub behind: bool,
    /// What only meshes and instances have.
    pub placed: Option<Placed>,
}

impl SurfaceInteraction {
    /// With a surface that is neither a mesh nor within an instance.
    #[inline]
    pub fn new(ray: &Ray, point: DVec3, front: DVec3, distance: f64, total_distance: f64) -> SurfaceInteraction {
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
    #[inline]
    pub fn at(ray: &Ray, hit: &Intersection, total_distance: f64) -> SurfaceInteraction {
        let placed = hit.placed;
        SurfaceInteraction {
            placed,
            ..SurfaceInteraction::new(ray, hit.point, hit.front, hit.distance, total_distance)
        }
    }

    /// With a distant source.
    pub fn distant(direction: DVec3) -> SurfaceInteraction {
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
    #[inline]
    pub fn perturbation(&self) -> DVec3 {
        self.placed.map_or(DVec3::ZERO, |placed| placed.perturbation)
    }

    /// The point in the coordinates in which the modifiers stand.
    #[inline]
    pub fn object_point(&self) -> DVec3 {
        let to_object = self.placed.as_ref().and_then(|placed| placed.to_object.as_ref());
        to_object.map_or(self.point, |transform| transform.point(self.point))
    }

    /// A direction in the coordinates in which the modifiers stand, in the scene's.
    #[inline]
    pub fn direction_to_scene(&self, direction: DVec3) -> DVec3 {
        let to_object = self.placed.as_ref().and_then(|placed| placed.to_object.as_ref());
        to_object.map_or(direction, |transform| transform.rotation.transpose() * direction)
    }

    /// The same, as if the surface faced the viewer.
    #[inline]
    pub fn turned(&self) -> SurfaceInteraction {
        SurfaceInteraction { behind: false, ..*self }
    }

    /// Whether its normal is interpolated.
    #[inline]
    pub fn is_smoothed(&self) -> bool {
        self.perturbation() != DVec3::ZERO
    }

    /// The unit normal as the surface faces.
    pub(crate) fn front(&self) -> DVec3 {
        if self.behind { -self.normal } else { self.normal }
    }
}

/// The mirror direction of a unit direction at a unit normal.
#[inline]
#[must_use]
pub fn reflect(direction: DVec3, normal: DVec3) -> DVec3 {
    direction - normal * (2.0 * normal.dot(direction))
}

/// The mirror direction of what meets a surface; a textured normal that would send it through the surface is not used.
#[inline]
#[must_use]
pub fn mirrored(interaction: &SurfaceInteraction, normal: DVec3) -> DVec3 {
    let direction = reflect(interaction.direction, normal);
    if direction.dot(interaction.normal) > 0.0 { direction } else { reflect(interaction.direction, interaction.normal) }
}

/// The normal with its texture; one that would turn away from the viewer is reflected back (Radiance's `raynormal`).
pub fn shading_normal(interaction: &SurfaceInteraction, perturbation: DVec3) -> DVec3 {
    if perturbation == DVec3::ZERO {
        return interaction.normal;
    }
    let Some(normal) = (interaction.normal + perturbation).try_normalize() else { return interaction.normal };
    let cosine = -normal.dot(interaction.direction);
    if cosine > 0.0 { normal } else { normal + interaction.direction * (2.0 * cosine) }
}
