//! Light sources with their true extent, and the places on them from which light comes.

use crate::disk_overlap::Overlap;
use crate::emission_profile::EmissionProfile;
use crate::form::{LightForm, LightSample, seen};
use crate::lobe_weighting::LobePeak;
use crate::virtual_source::VirtualSource;
use glam::DVec3;
use radsight_accel::{PrimitiveId, Ray};
use radsight_ir::SurfaceHandle;
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

/// Index of a light in the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightId(pub u32);

/// A source of direct light: an emitting surface, or its image in plane mirrors.
#[derive(Clone, Debug)]
pub struct Light {
    /// The surface that emits.
    pub surface: SurfaceHandle,
    /// Its name to the search for surfaces; none for a distant one.
    pub primitive: Option<PrimitiveId>,
    /// What is drawn from.
    pub form: LightForm,
    /// Sphere around it; infinite radius for a distant one.
    pub center: DVec3,
    /// Radius of that sphere, scene units.
    pub radius: f64,
    /// A cone outside of which it is dark.
    pub cone: Option<LightCone>,
    /// Where it shines brightest, if that is narrow; images have none.
    pub profile: Option<Arc<EmissionProfile>>,
    /// Farther points get nothing from it (a glow's radius).
    pub max_distance: f64,
    /// F of a spotlight: the brightness is scaled by (r/(r+F))².
    pub focal_distance: f64,
    /// The mirrors and prisms through which it is seen, the one next to the receiver first; empty for a real light.
    pub virtual_sources: Vec<VirtualSource>,
}

/// A sharp cone of emission.
#[derive(Clone, Copy, Debug)]
pub struct LightCone {
    /// Unit, along which it shines.
    pub axis: DVec3,
    /// Radians.
    pub half_angle: f64,
}

/// A cosine of two axes above this is one axis.
const PARALLEL: f64 = 1.0 - 1e-12;

impl Light {
    /// A place of the light that is lit towards `receiver`, from a point of the unit square, where the highlight is bright.
    #[inline]
    pub fn sample(&self, receiver: DVec3, [u, v]: [f64; 2], peak: &LobePeak) -> Option<LightSample> {
        let gradient = self.gradient(receiver, peak);
        if let Some(mixture) = self.profile_near(receiver) {
            return self.sample_profile(mixture, receiver, [u, v], gradient);
        }
        let Some((center, normal, radius)) = self.clipped_disk() else {
            return self.form.sample(receiver, [u, v], gradient);
        };
        let (overlap, away) = self.lit_part(center, normal, radius, receiver);
        match overlap {
            Overlap::None => None,
            Overlap::Whole => self.form.sample(receiver, [u, v], gradient),
            Overlap::Part(lens) => {
                let across = normal.cross(away);
                let (x, y, pdf) = lens.point([u, v], [gradient.dot(away), gradient.dot(across)]);
                seen(receiver, center + away * x + across * y, normal, pdf)
            }
        }
    }

    /// The density with which [`Light::sample`] would find the place at `distance` along `direction`, seen under `cosine`, 1/sr.
    #[inline]
    pub fn pdf(&self, receiver: DVec3, direction: DVec3, distance: f64, cosine: f64, peak: &LobePeak) -> f64 {
        let gradient = self.gradient(receiver, peak);
        if let Some(mixture) = self.profile_near(receiver) {
            return mixture.pdf(direction, self.form.pdf(receiver, direction, distance, cosine, gradient));
        }
        if let Some((center, normal, radius)) = self.clipped_disk()
            && let (Overlap::Part(lens), away) = self.lit_part(center, normal, radius, receiver)
        {
            let across = normal.cross(away);
            let from_center = receiver + direction * distance - center;
            let at = [from_center.dot(away), from_center.dot(across)];
            let by_area = lens.pdf(at, [gradient.dot(away), gradient.dot(across)]);
            return distance * distance * by_area / cosine;
        }
        self.form.pdf(receiver, direction, distance, cosine, gradient)
    }

    /// Its beam, and how often a place is drawn by that for a receiver.
    #[inline]
    fn profile_near(&self, receiver: DVec3) -> Option<Mixture<'_>> {
        let profile = self.profile.as_deref()?;
        let chance = EmissionProfile::chance(receiver.distance(self.center), self.radius);
        (chance > 0.0).then_some(Mixture { profile, chance })
    }

    /// A place where the beam comes towards the receiver, or one anywhere.
    fn sample_profile(
        &self,
        mixture: Mixture<'_>,
        receiver: DVec3,
        [u, v]: [f64; 2],
        gradient: DVec3,
    ) -> Option<LightSample> {
        let Mixture { profile, chance } = mixture;
        let sample = if u < chance {
            let direction = -profile.draw([u / chance, v])?;
            let (normal, _) = self.form.plane()?;
            let (distance, cosine) = self.form.met(receiver, direction)?;
            let pdf = self.form.pdf(receiver, direction, distance, cosine, gradient);
            LightSample { direction, distance, pdf, normal }
        } else {
            self.form.sample(receiver, [(u - chance) / (1.0 - chance), v], gradient)?
        };
        Some(LightSample { pdf: mixture.pdf(sample.direction, sample.pdf), ..sample })
    }

    /// The factor of a spotlight's radiance at a distance.
    #[inline]
    pub fn focal_factor(&self, distance: f64) -> f64 {
        if self.focal_distance > 0.0 { (distance / (distance + self.focal_distance)).powi(2) } else { 1.0 }
    }

    /// Gradient of the logarithm of the highlight at the light's centre, by place (for a distant one, by direction).
    #[inline]
    fn gradient(&self, receiver: DVec3, peak: &LobePeak) -> DVec3 {
        match self.form {
            LightForm::Distant { direction, .. } | LightForm::DistantImage { direction, .. } => {
                peak.gradient(direction)
            }
            LightForm::Sphere { center, .. } => peak.gradient((center - receiver).normalize_or_zero()),
            _ => {
                let offset = self.center - receiver;
                let distance = offset.length();
                peak.gradient(offset / distance) / distance
            }
        }
    }

    /// Centre, normal and radius of a disk that shines in a cone about its normal.
    #[inline]
    fn clipped_disk(&self) -> Option<(DVec3, DVec3, f64)> {
        match (&self.cone, &self.form) {
            (Some(cone), LightForm::Disk { center, normal, inner_squared, outer_squared, .. })
                if *inner_squared == 0.0 && cone.half_angle < FRAC_PI_2 && cone.axis.dot(*normal) > PARALLEL =>
            {
                Some((*center, *normal, outer_squared.sqrt()))
            }
            _ => None,
        }
    }

    /// The part of such a disk whose cones reach the receiver, and the unit direction in its plane that leads away from the receiver.
    fn lit_part(&self, center: DVec3, normal: DVec3, radius: f64, receiver: DVec3) -> (Overlap, DVec3) {
        let from_center = receiver - center;
        let height = from_center.dot(normal);
        let beside = from_center - normal * height;
        let offset = beside.length();
        let reach = height * self.cone.map_or(0.0, |cone| cone.half_angle.tan());
        let away = if offset > 0.0 { -beside / offset } else { normal.any_orthonormal_vector() };
        let overlap = if height > 0.0 { Overlap::new(radius, reach, offset) } else { Overlap::None };
        (overlap, away)
    }

    /// Whether nothing of it can reach a point: behind its mirror or its plane, or outside its cone.
    #[inline]
    pub fn misses(&self, receiver: DVec3) -> bool {
        let is_behind = |virtual_source: &VirtualSource| {
            virtual_source.redirection.is_none() && virtual_source.normal.dot(receiver - virtual_source.point) <= 0.0
        };
        if self.virtual_sources.first().is_some_and(is_behind) {
            return true;
        }
        let Some(cone) = &self.cone else { return self.shows_its_back(receiver) };
        if self.radius.is_infinite() {
            return false;
        }
        let offset = receiver - self.center;
        let distance = offset.length();
        if distance <= self.radius {
            return false;
        }
        let widest = cone.half_angle + (self.radius / distance).asin();
        offset.dot(cone.axis) < distance * widest.min(PI).cos()
    }

    #[inline]
    fn shows_its_back(&self, receiver: DVec3) -> bool {
        self.form.plane().is_some_and(|(normal, point)| normal.dot(receiver - point) <= 0.0)
    }

    /// Whether a prism relays it, so that only following a ray tells what it brings.
    #[inline]
    pub fn is_redirected(&self) -> bool {
        self.virtual_sources.iter().any(|virtual_source| virtual_source.redirection.is_some())
    }

    /// The ray from a receiver towards the light as the light itself sees it: reflected in all mirrors.
    pub fn real_ray(&self, receiver: DVec3, direction: DVec3) -> Ray {
        let (mut origin, mut direction) = (receiver, direction);
        for virtual_source in &self.virtual_sources {
            origin = virtual_source.image_of_point(origin);
            direction = virtual_source.image_of_direction(direction);
        }
        Ray { origin, direction }
    }
}

/// A place is drawn by the beam with this chance, else anywhere.
#[derive(Clone, Copy, Debug)]
struct Mixture<'l> {
    profile: &'l EmissionProfile,
    chance: f64,
}

impl Mixture<'_> {
    /// The density in a direction to the light, where that of places anywhere is `by_area`, 1/sr.
    fn pdf(self, direction: DVec3, by_area: f64) -> f64 {
        self.chance * self.profile.pdf(-direction) + (1.0 - self.chance) * by_area
    }
}
