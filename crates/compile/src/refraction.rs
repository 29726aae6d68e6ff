//! Dielectric interfaces: `dielectric` and `interface`.
//!
//! A ray splits into a reflected and a refracted ray by Fresnel's equations for unpolarised light.
//! Radiance scales the refracted ray by the squared ratio of the indices, because refraction
//! changes the solid angle. Dispersion uses the index at 500 nm, by Hartmann's equation with λ₀ =
//! 0: `n = n₀ + h/λ`.

use glam::DVec3;
use radsight_ir::{Dielectric, Interface, Rgb};

/// Wavelength at which the index of refraction is evaluated, nm.
const MEAN_WAVELENGTH: f64 = 500.0;

/// Total reflection below this squared cosine.
const GRAZING: f64 = 1e-6;

/// An interface between two media.
#[derive(Clone, Copy, Debug)]
pub struct DielectricInterface {
    /// Transmissivity per scene unit on the back of the surface.
    pub inside: Rgb,
    /// Transmissivity per scene unit on its front; `None` is the surrounding medium.
    pub outside: Option<Rgb>,
    /// Index on the back over index on the front.
    ratio: f64,
}

/// The side of a surface from which a ray comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RaySide {
    /// The side of the geometric normal.
    Front,
    /// The other side.
    Back,
}

impl RaySide {
    /// The side for a ray's direction and the unit geometric normal.
    #[must_use]
    pub fn of(direction: DVec3, front: DVec3) -> RaySide {
        if direction.dot(front) > 0.0 { RaySide::Back } else { RaySide::Front }
    }
}

/// Reflection and refraction of a ray at an interface.
#[derive(Clone, Copy, Debug)]
pub struct Refracted {
    /// Reflectance, 0…1.
    pub reflectance: f64,
    /// Unit direction of the refracted ray, and the factor of its radiance; none for total
    /// reflection.
    pub transmitted: Option<(DVec3, f64)>,
    /// Unit shading normal on the side from which the ray comes.
    pub normal: DVec3,
    /// Cosine between that normal and the reversed ray.
    pub cosine: f64,
}

impl DielectricInterface {
    /// Interface of a `dielectric`, with the surrounding medium outside.
    pub fn of_body(body: &Dielectric) -> DielectricInterface {
        let ratio = body.refractive_index + body.hartmann / MEAN_WAVELENGTH;
        DielectricInterface { inside: body.transmissivity, outside: None, ratio }
    }

    /// Interface between two media.
    pub fn between(interface: &Interface) -> DielectricInterface {
        let Interface { inside, outside } = interface;
        DielectricInterface {
            inside: inside.transmissivity,
            outside: Some(outside.transmissivity),
            ratio: inside.refractive_index / outside.refractive_index,
        }
    }

    /// Whether every band has the same parameters.
    pub fn is_grey(&self) -> bool {
        self.inside.is_grey() && self.outside.is_none_or(Rgb::is_grey)
    }

    /// Transmissivity on the side from which a ray comes (`None` is the surrounding medium), and on
    /// the other side.
    pub fn sides(&self, side: RaySide) -> [Option<Rgb>; 2] {
        match side {
            RaySide::Front => [self.outside, Some(self.inside)],
            RaySide::Back => [Some(self.inside), self.outside],
        }
    }

    /// Reflects and refracts a ray along `direction`; `front` is the unit geometric normal,
    /// `perturbation` that of the textures.
    pub fn refract(&self, direction: DVec3, front: DVec3, perturbation: DVec3) -> Refracted {
        let side = RaySide::of(direction, front);
        let normal = perturbed(direction, front, perturbation, side);
        let (normal, front) = match side {
            RaySide::Front => (normal, front),
            RaySide::Back => (-normal, -front),
        };
        let cosine = -direction.dot(normal);
        // Index on the ray's side over index on the other side.
        let ratio = self.index_ratio(side);
        let squared = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
        if squared < GRAZING {
            return Refracted { reflectance: 1.0, transmitted: None, normal, cosine };
        }
        let inner = squared.sqrt();
        let perpendicular = ((cosine - ratio * inner) / (cosine + ratio * inner)).powi(2);
        let parallel = ((1.0 / cosine - ratio / inner) / (1.0 / cosine + ratio / inner)).powi(2);
        let reflectance = 0.5 * (perpendicular + parallel);
        let along_normal = ratio * cosine - inner;
        let mut transmitted = direction * ratio + normal * along_normal;
        if perturbation != DVec3::ZERO && transmitted.dot(front) >= -GRAZING {
            transmitted = direction * ratio + front * along_normal;
        }
        let transmitted = transmitted.normalize_or(direction);
        Refracted { reflectance, transmitted: Some((transmitted, (1.0 - reflectance) * ratio * ratio)), normal, cosine }
    }

    /// Index on a ray's side over index on the other side.
    pub fn index_ratio(&self, side: RaySide) -> f64 {
        match side {
            RaySide::Front => self.ratio.recip(),
            RaySide::Back => self.ratio,
        }
    }
}

impl Refracted {
    /// Reflected direction. A perturbed normal that would turn it through the surface is replaced
    /// by the geometric one.
    pub fn reflected(&self, direction: DVec3, front: DVec3) -> DVec3 {
        let reflected = direction + self.normal * (2.0 * self.cosine);
        let side = if direction.dot(front) > 0.0 { -front } else { front };
        if reflected.dot(side) > GRAZING { reflected } else { direction - side * (2.0 * side.dot(direction)) }
    }
}

/// Perturbed normal on the front side. One that would face the other side of the ray is reflected
/// back (Radiance's `raynormal`).
fn perturbed(direction: DVec3, front: DVec3, perturbation: DVec3, side: RaySide) -> DVec3 {
    if perturbation == DVec3::ZERO {
        return front;
    }
    let Some(normal) = (front + perturbation).try_normalize() else { return front };
    let along = normal.dot(direction);
    if (along > 0.0) == (side == RaySide::Back) { normal } else { normal - direction * (2.0 * along) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn water() -> DielectricInterface {
        let body = Dielectric { transmissivity: Rgb::WHITE, refractive_index: 1.5, hartmann: 0.0 };
        DielectricInterface::of_body(&body)
    }

    #[test]
    fn reflectance_at_normal_incidence_depends_on_the_indices_alone() {
        let refracted = water().refract(-DVec3::Z, DVec3::Z, DVec3::ZERO);
        assert!((refracted.reflectance - 0.04).abs() < 1e-12);
        let (direction, factor) = refracted.transmitted.expect("the ray is refracted");
        assert!(direction.distance(-DVec3::Z) < 1e-12);
        assert!((factor - 0.96 / 2.25).abs() < 1e-12);
    }

    #[test]
    fn the_refracted_ray_obeys_snell_from_both_sides() {
        for (direction, ratio) in [(DVec3::new(0.6, 0.0, -0.8), 1.5), (DVec3::new(0.4, 0.0, 0.84f64.sqrt()), 1.0 / 1.5)]
        {
            let refracted = water().refract(direction, DVec3::Z, DVec3::ZERO);
            let (transmitted, _) = refracted.transmitted.expect("the ray is refracted");
            assert!((transmitted.x * ratio - direction.x).abs() < 1e-12);
            assert_eq!(transmitted.z > 0.0, direction.z > 0.0);
        }
    }

    #[test]
    fn above_the_critical_angle_reflection_is_total() {
        let refracted = water().refract(DVec3::new(0.8, 0.0, 0.6), DVec3::Z, DVec3::ZERO);
        assert!(refracted.transmitted.is_none());
        assert_eq!(refracted.reflectance, 1.0);
        let reflected = refracted.reflected(DVec3::new(0.8, 0.0, 0.6), DVec3::Z);
        assert!(reflected.distance(DVec3::new(0.8, 0.0, -0.6)) < 1e-12);
    }
}
