//! Surface interactions: the intersection of a ray with a surface, for functions, textures and
//! materials.

use glam::DVec3;
use radsight_accel::{InstanceData, Intersection, Ray};

/// A ray's intersection with a surface, in scene coordinates.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceInteraction {
    /// Unit vector along the ray.
    pub direction: DVec3,
    /// Unit normal, turned towards the side from which the ray comes.
    pub normal: DVec3,
    /// Scene coordinates.
    pub point: DVec3,
    /// Distance from the eye over all reflections, scene units.
    pub total_distance: f64,
    /// Distance along this ray alone, scene units.
    pub distance: f64,
    /// −direction·normal, 0…1.
    pub cosine: f64,
    /// Whether the ray comes from the back. Functions get the normal of the surface's own
    /// orientation.
    pub behind: bool,
    /// Interpolated normal, local coordinates and transform of meshes and instances; none for other
    /// surfaces.
    pub instance: Option<InstanceData>,
}

impl SurfaceInteraction {
    /// Interaction with a surface that is neither a mesh nor part of an instance.
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
            instance: None,
        }
    }

    /// Interaction at an intersection.
    #[inline]
    pub fn at(ray: &Ray, hit: &Intersection, total_distance: f64) -> SurfaceInteraction {
        let instance = hit.instance;
        SurfaceInteraction {
            instance,
            ..SurfaceInteraction::new(ray, hit.point, hit.front, hit.distance, total_distance)
        }
    }

    /// Interaction of a ray with a distant source. Patterns see the origin of the ray as its point, as
    /// in Radiance.
    pub fn distant(ray: &Ray) -> SurfaceInteraction {
        SurfaceInteraction {
            direction: ray.direction,
            normal: -ray.direction,
            point: ray.origin,
            total_distance: f64::MAX,
            distance: f64::MAX,
            cosine: 1.0,
            behind: false,
            instance: None,
        }
    }

    /// Perturbation of the normal before any texture: that of the interpolated normal.
    #[inline]
    pub fn perturbation(&self) -> DVec3 {
        self.instance.map_or(DVec3::ZERO, |instance| instance.perturbation)
    }

    /// The point in the coordinates of the modifiers.
    #[inline]
    pub fn object_point(&self) -> DVec3 {
        let to_object = self.instance.as_ref().and_then(|instance| instance.to_object.as_ref());
        to_object.map_or(self.point, |transform| transform.point(self.point))
    }

    /// Transforms a direction from the coordinates of the modifiers to the scene's.
    #[inline]
    pub fn direction_to_scene(&self, direction: DVec3) -> DVec3 {
        let to_object = self.instance.as_ref().and_then(|instance| instance.to_object.as_ref());
        to_object.map_or(direction, |transform| transform.rotation.transpose() * direction)
    }

    /// The same interaction, turned so that the surface faces the viewer.
    #[inline]
    pub fn turned(&self) -> SurfaceInteraction {
        SurfaceInteraction { behind: false, ..*self }
    }

    /// Unit normal of the surface's own orientation.
    pub(crate) fn front(&self) -> DVec3 {
        if self.behind { -self.normal } else { self.normal }
    }
}

/// Mirror direction of a unit direction at a unit normal.
#[inline]
#[must_use]
pub fn reflect(direction: DVec3, normal: DVec3) -> DVec3 {
    direction - normal * (2.0 * normal.dot(direction))
}

/// Mirror direction of a ray at a surface. A perturbed normal that would turn it below the surface
/// is ignored.
#[inline]
#[must_use]
pub fn mirrored(interaction: &SurfaceInteraction, normal: DVec3) -> DVec3 {
    let direction = reflect(interaction.direction, normal);
    if direction.dot(interaction.normal) > 0.0 { direction } else { reflect(interaction.direction, interaction.normal) }
}

/// Perturbed normal. One that would face away from the viewer is reflected back (Radiance's
/// `raynormal`).
pub fn shading_normal(interaction: &SurfaceInteraction, perturbation: DVec3) -> DVec3 {
    if perturbation == DVec3::ZERO {
        return interaction.normal;
    }
    let Some(normal) = (interaction.normal + perturbation).try_normalize() else { return interaction.normal };
    let cosine = -normal.dot(interaction.direction);
    if cosine > 0.0 { normal } else { normal + interaction.direction * (2.0 * cosine) }
}
