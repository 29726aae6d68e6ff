//! Light sources of finite extent, and points sampled on them.

use crate::bilinear::{Bilinear, by_received_light};
use crate::cubature::{DiskRule, IntegrandShape};
use crate::disk_nodes::{DiskFrame, DiskNodes};
use crate::disk_overlap::{DiskOverlap, Overlap};
use crate::emission_profile::EmissionProfile;
use crate::form::{LightForm, LightSample, coordinates, seen};
use crate::lobe_weighting::{LobePeak, ReceiverCosine};
use crate::spherical_rectangle::{SphericalRectangle, perpendicular};
use crate::virtual_source::VirtualSource;
use glam::DVec3;
use radsight_accel::{PrimitiveId, Ray};
use radsight_ir::SurfaceHandle;
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

/// Index of a light in the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightId(pub u32);

/// A source of direct light: an emitting surface, or its image in plane mirrors and prisms.
#[derive(Clone, Debug)]
pub struct Light {
    /// The emitting surface.
    pub surface: SurfaceHandle,
    /// Its primitive in the acceleration structure; none for a distant light.
    pub primitive: Option<PrimitiveId>,
    /// The shape to be sampled.
    pub form: LightForm,
    /// Centre of the bounding sphere; a distant light's direction.
    pub center: DVec3,
    /// Radius of the bounding sphere, scene units; infinite for a distant light.
    pub radius: f64,
    /// Cone outside of which the light is dark.
    pub cone: Option<LightCone>,
    /// Cone outside of which a measured distribution is zero; it says nothing about the inside.
    pub dark_beyond: Option<LightCone>,
    /// Emission profile of a narrow distribution; virtual images have none.
    pub profile: Option<Arc<EmissionProfile>>,
    /// Distance beyond which the light gives nothing (a glow's radius), scene units.
    pub max_distance: f64,
    /// Focal distance F of a spotlight: radiance is scaled by (r/(r+F))².
    pub focal_distance: f64,
    /// Mirrors and prisms of a virtual image, the one next to the receiver first; empty for a real
    /// light.
    pub virtual_sources: Vec<VirtualSource>,
}

/// A sharp cone of emission.
#[derive(Clone, Copy, Debug)]
pub struct LightCone {
    /// Unit axis of the cone, in the direction of emission.
    pub axis: DVec3,
    /// Half angle, radians.
    pub half_angle: f64,
    sine: f64,
    cosine: f64,
    tangent: f64,
}

impl LightCone {
    /// A cone about a unit axis.
    #[must_use]
    pub fn new(axis: DVec3, half_angle: f64) -> LightCone {
        LightCone { axis, half_angle, sine: half_angle.sin(), cosine: half_angle.cos(), tangent: half_angle.tan() }
    }

    /// Sine and cosine of the half angle.
    #[must_use]
    pub fn sin_cos(&self) -> (f64, f64) {
        (self.sine, self.cosine)
    }

    /// Whether a point at `offset` from the centre of a sphere of this radius, and outside it, lies
    /// in no cone from a point of the sphere.
    #[inline]
    #[must_use]
    pub fn misses(&self, offset: DVec3, radius: f64) -> bool {
        // The sine and cosine, times the distance, of the half angle plus that of the sphere.
        let to_rim = to_rim(offset, radius);
        let sine = self.sine * to_rim + self.cosine * radius;
        sine > 0.0 && offset.dot(self.axis) < self.cosine * to_rim - self.sine * radius
    }

    /// Whether such a point lies in the cones from all points of the sphere.
    #[inline]
    #[must_use]
    pub fn contains(&self, offset: DVec3, radius: f64) -> bool {
        // The same of the half angle minus that of the sphere.
        let to_rim = to_rim(offset, radius);
        let sine = self.sine * to_rim - self.cosine * radius;
        sine > 0.0 && offset.dot(self.axis) > self.cosine * to_rim + self.sine * radius
    }
}

/// Distance from a point to the rim of a sphere that it sees; the sphere's centre is at `-offset`.
#[inline]
fn to_rim(offset: DVec3, radius: f64) -> f64 {
    (offset.length_squared() - radius * radius).max(0.0).sqrt()
}

/// Samples points of a light, as seen from a receiver.
#[derive(Clone, Copy, Debug)]
pub struct LightSampler<'l> {
    light: &'l Light,
    receiver: DVec3,
    /// Of the density; zero where a polygon is sampled without it.
    gradient: DVec3,
    sampled: SampledPart<'l>,
}

/// The part of a light that is sampled, and how.
#[derive(Clone, Copy, Debug)]
enum SampledPart<'l> {
    Nothing,
    Profile(Mixture<'l>),
    Polygon(SeenPolygon),
    /// The part of a disk whose cones contain the receiver.
    Overlap {
        overlap: DiskOverlap,
        center: DVec3,
        normal: DVec3,
        away: DVec3,
    },
    /// The whole shape.
    Form,
}

/// A parallelogram as seen from a diffuse receiver, at the origin.
#[derive(Clone, Copy, Debug)]
struct SeenPolygon {
    map: PolygonMap,
    /// Unit, on the emitting side.
    normal: DVec3,
}

/// A map from the unit square to a parallelogram.
#[derive(Clone, Copy, Debug)]
enum PolygonMap {
    BySolidAngle(SphericalRectangle),
    ByArea { corner: DVec3, sides: [DVec3; 2], area: f64, density: Bilinear },
}

impl SeenPolygon {
    #[inline]
    fn sample(&self, receiver: DVec3, u: [f64; 2]) -> Option<LightSample> {
        match &self.map {
            PolygonMap::BySolidAngle(rectangle) => {
                let (offset, pdf) = rectangle.sample(u);
                let distance = offset.length();
                Some(LightSample { direction: offset / distance, distance, pdf, normal: self.normal })
            }
            PolygonMap::ByArea { corner, sides: [x, y], area, density } => {
                let [a, b] = density.sample(u);
                let point = receiver + *corner + *x * a + *y * b;
                seen(receiver, point, self.normal, density.at([a, b]) / area)
            }
        }
    }

    /// The density of a point, 1/sr, for the cosine at the light.
    fn pdf(&self, point: DVec3, cosine: f64) -> f64 {
        match &self.map {
            PolygonMap::BySolidAngle(rectangle) => rectangle.pdf(point),
            PolygonMap::ByArea { corner, sides: [x, y], area, density } => {
                let at = coordinates(*x, *y, point - *corner).map(|share| share.clamp(0.0, 1.0));
                density.at(at) / area * point.length_squared() / cosine
            }
        }
    }
}

impl<'l> LightSampler<'l> {
    /// The sampled light.
    #[inline]
    #[must_use]
    pub fn light(&self) -> &'l Light {
        self.light
    }

    /// Maps a point of the unit square to a point of the light; `None` if it emits nothing towards
    /// the receiver.
    #[inline]
    #[must_use]
    pub fn sample(&self, u: [f64; 2]) -> Option<LightSample> {
        let LightSampler { light, receiver, gradient, sampled } = self;
        match sampled {
            SampledPart::Nothing => None,
            SampledPart::Profile(_) => self.sample_by_profile(u).map(|(sample, _)| sample),
            SampledPart::Polygon(polygon) => polygon.sample(*receiver, u),
            SampledPart::Overlap { overlap, center, normal, away } => {
                let across = normal.cross(*away);
                let (x, y, pdf) = overlap.point(u, [gradient.dot(*away), gradient.dot(across)]);
                seen(*receiver, *center + *away * x + across * y, *normal, pdf)
            }
            SampledPart::Form => light.form.sample(*receiver, u, *gradient),
        }
    }

    /// [`LightSampler::sample`] where an emission profile is sampled, with the radiance that the receiver
    /// sees there, relative to the mean over all directions out of the light, as the profile tabulates it.
    /// `None` without a profile, too.
    #[inline]
    #[must_use]
    pub fn sample_by_profile(&self, [u, v]: [f64; 2]) -> Option<(LightSample, f64)> {
        let LightSampler { light: Light { form, .. }, receiver, gradient, sampled } = self;
        let SampledPart::Profile(mixture @ Mixture { profile, chance }) = sampled else { return None };
        let (sample, by_direction) = if u < *chance {
            let outward = profile.sample([u / chance, v])?;
            let (direction, (normal, _)) = (-outward.direction, form.plane()?);
            let (distance, cosine) = form.intersect(*receiver, direction)?;
            let pdf = form.pdf(*receiver, direction, distance, cosine, *gradient);
            (LightSample { direction, distance, pdf, normal }, outward.pdf)
        } else {
            let sample = form.sample(*receiver, [(u - chance) / (1.0 - chance), v], *gradient)?;
            (sample, profile.pdf(-sample.direction))
        };
        Some((LightSample { pdf: mixture.pdf(by_direction, sample.pdf), ..sample }, 2.0 * PI * by_direction))
    }

    /// Whether an emission profile is sampled.
    #[inline]
    #[must_use]
    pub fn follows_profile(&self) -> bool {
        matches!(self.sampled, SampledPart::Profile(_))
    }

    /// Density with which a point at `distance` along `direction` is found, for the cosine at the light,
    /// 1/sr.
    #[inline]
    #[must_use]
    pub fn pdf(&self, direction: DVec3, distance: f64, cosine: f64) -> f64 {
        let LightSampler { light, receiver, gradient, sampled } = self;
        let of_form = || light.form.pdf(*receiver, direction, distance, cosine, *gradient);
        match sampled {
            SampledPart::Profile(mixture) => mixture.pdf(mixture.profile.pdf(-direction), of_form()),
            SampledPart::Polygon(polygon) => polygon.pdf(direction * distance, cosine),
            SampledPart::Overlap { overlap, center, normal, away } => {
                let across = normal.cross(*away);
                let from_center = *receiver + direction * distance - *center;
                let at = [from_center.dot(*away), from_center.dot(across)];
                let by_area = overlap.pdf(at, [gradient.dot(*away), gradient.dot(across)]);
                distance * distance * by_area / cosine
            }
            SampledPart::Nothing | SampledPart::Form => of_form(),
        }
    }
}

/// The nodes of a cubature rule on a light, as seen from a receiver.
#[derive(Clone, Copy, Debug)]
pub struct LightCubature {
    rule: DiskRule,
    receiver: DVec3,
    center: DVec3,
    normal: DVec3,
    /// Unit vectors in the light's plane.
    x: DVec3,
    y: DVec3,
    /// Of the disk, scene units.
    radius: f64,
}

/// Axes with a cosine above this count as parallel.
const PARALLEL: f64 = 1.0 - 1e-12;

/// Largest radius of a disk relative to its distance for cubature. Nearer, the solid angle of its
/// parts differs too much for the limits of the rules, which are those of lobes.
const MAX_CUBATURE_RADIUS: f64 = 0.1;

impl Light {
    /// Samples points that emit towards `receiver`, with a density that follows the receiver's lobe
    /// and cosine.
    #[inline]
    pub fn sampler(&self, receiver: DVec3, peak: &LobePeak) -> LightSampler<'_> {
        let sampled = if let Some(mixture) = self.profile_near(receiver) {
            SampledPart::Profile(mixture)
        } else if let Some(polygon) = self.diffusely_seen(receiver, peak) {
            SampledPart::Polygon(polygon)
        } else if let Some((center, normal, radius)) = self.clipped_disk() {
            match self.lit_part(center, normal, radius, receiver) {
                (Overlap::None, _) => SampledPart::Nothing,
                (Overlap::Whole, _) => SampledPart::Form,
                (Overlap::Part(overlap), away) => SampledPart::Overlap { overlap, center, normal, away },
            }
        } else {
            SampledPart::Form
        };
        let gradient = match sampled {
            SampledPart::Polygon(_) => DVec3::ZERO,
            _ => self.gradient(receiver, peak),
        };
        LightSampler { light: self, receiver, gradient, sampled }
    }

    /// A single sample of [`Light::sampler`].
    #[inline]
    pub fn sample(&self, receiver: DVec3, u: [f64; 2], peak: &LobePeak) -> Option<LightSample> {
        self.sampler(receiver, peak).sample(u)
    }

    /// A rule for the part of the light that emits towards `receiver`, whose error relative to the
    /// contribution of the whole light is at most `tolerance`, if its radiance is uniform within its
    /// cone. `None` if there is none: for other shapes than disks, images, lobes that are too narrow,
    /// and disks that are large for their distance.
    #[must_use]
    pub fn cubature(&self, receiver: DVec3, peak: &LobePeak, tolerance: f64) -> Option<LightCubature> {
        let LightForm::Disk { center, normal, outer_squared, .. } = self.form else { return None };
        if !self.is_plain_disk() {
            return None;
        }
        let radius = outer_squared.sqrt();
        if radius > MAX_CUBATURE_RADIUS * receiver.distance(center) {
            return None;
        }
        let (overlap, x) = match &self.cone {
            Some(_) => {
                let (center, normal, radius) = self.clipped_disk()?;
                self.lit_part(center, normal, radius, receiver)
            }
            None if normal.dot(receiver - center) > 0.0 => (Overlap::Whole, normal.any_orthonormal_vector()),
            None => (Overlap::None, DVec3::X),
        };
        let shape = self.integrand_shape(receiver, peak, radius);
        let rule = DiskRule::new(&overlap, radius, shape, tolerance)?;
        Some(LightCubature { rule, receiver, center, normal, x, y: normal.cross(x), radius })
    }

    /// Whether it is a disk without hole, seen directly, that gives light at all distances.
    #[must_use]
    pub fn is_plain_disk(&self) -> bool {
        let is_disk = matches!(self.form, LightForm::Disk { inner_squared, .. } if inner_squared == 0.0);
        is_disk && self.virtual_sources.is_empty() && self.max_distance.is_infinite()
    }

    /// Shape of lobe times solid angle over the disk of this radius.
    fn integrand_shape(&self, receiver: DVec3, peak: &LobePeak, radius: f64) -> IntegrandShape {
        let relative = radius / receiver.distance(self.center);
        // The solid angle of a patch falls with up to the fourth power of the distance.
        let lobe = LobePeak { floor: 0.0, cosine: ReceiverCosine::Unknown, ..*peak };
        let gradient = self.gradient(receiver, &lobe).length() * radius + 4.0 * relative;
        IntegrandShape::new(gradient, peak.width * relative * relative)
    }

    /// Density with which [`Light::sample`] finds the point at `distance` along `direction`, for
    /// the cosine at the light, 1/sr.
    #[inline]
    pub fn pdf(&self, receiver: DVec3, direction: DVec3, distance: f64, cosine: f64, peak: &LobePeak) -> f64 {
        self.sampler(receiver, peak).pdf(direction, distance, cosine)
    }

    /// Emission profile, and the probability of sampling it for a receiver.
    #[inline]
    fn profile_near(&self, receiver: DVec3) -> Option<Mixture<'_>> {
        let profile = self.profile.as_deref()?;
        let chance = EmissionProfile::chance(receiver.distance(self.center), self.radius);
        (chance > 0.0).then_some(Mixture { profile, chance })
    }

    /// Factor of a spotlight's radiance at a distance, which may be infinite.
    #[inline]
    pub fn focal_factor(&self, distance: f64) -> f64 {
        if self.focal_distance > 0.0 { (1.0 + self.focal_distance / distance).powi(-2) } else { 1.0 }
    }

    /// Gradient of the logarithm of the density at the light's centre that the receiver's lobe and
    /// cosine suggest: by position for a flat light, by direction for a round or distant one.
    #[inline]
    fn gradient(&self, receiver: DVec3, peak: &LobePeak) -> DVec3 {
        match self.form {
            LightForm::Distant { direction, half_angle_sin_squared_half: cap, .. } => {
                lobe_gradient(direction, 2.0 * cap.sqrt(), peak, DVec3::ZERO)
            }
            LightForm::DistantImage { direction, .. } => peak.gradient(direction),
            LightForm::Sphere { center, radius, .. } => {
                let offset = center - receiver;
                let distance = offset.length();
                lobe_gradient(offset / distance, radius / distance, peak, DVec3::ZERO)
            }
            _ => {
                let offset = self.center - receiver;
                let distance = offset.length();
                let towards = offset / distance;
                // The solid angle of a patch falls with the third power of its distance. So does
                // that of the cosine, whose denominator is the distance, with the first.
                let fall_off = if peak.cosine == ReceiverCosine::Unknown { DVec3::ZERO } else { towards * -3.0 };
                lobe_gradient(towards, self.radius / distance, peak, fall_off) / distance
            }
        }
    }

    /// How a parallelogram is sampled for a diffuse receiver.
    #[inline]
    fn diffusely_seen(&self, receiver: DVec3, peak: &LobePeak) -> Option<SeenPolygon> {
        let LightForm::Parallelogram { corner, x, y, normal, area } = self.form else { return None };
        if peak.cosine == ReceiverCosine::Unknown {
            return None;
        }
        let (offset, corner) = (self.center - receiver, corner - receiver);
        let squared = offset.length_squared();
        if normal.dot(corner) >= 0.0 || peak.share(offset / squared.sqrt()) > MOST_HIGHLIGHT {
            return None;
        }
        let is_wide = self.radius * self.radius > WIDE * WIDE * squared && perpendicular(x, y);
        let rectangle = if is_wide { SphericalRectangle::new(corner, [x, y], &peak.cosine) } else { None };
        let map = match rectangle {
            Some(rectangle) => PolygonMap::BySolidAngle(rectangle),
            None => PolygonMap::ByArea {
                corner,
                sides: [x, y],
                area,
                density: by_received_light(corner, [x, y], &peak.cosine),
            },
        };
        Some(SeenPolygon { map, normal })
    }

    /// Centre, normal and radius of a disk with an emission cone about its normal.
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

    /// Part of such a disk whose emission cones contain the receiver, and the unit vector in the
    /// disk's plane away from the receiver.
    fn lit_part(&self, center: DVec3, normal: DVec3, radius: f64, receiver: DVec3) -> (Overlap, DVec3) {
        let from_center = receiver - center;
        let height = from_center.dot(normal);
        let beside = from_center - normal * height;
        let offset = beside.length();
        let reach = height * self.cone.map_or(0.0, |cone| cone.tangent);
        let away = if offset > 0.0 { -beside / offset } else { normal.any_orthonormal_vector() };
        let overlap = if height > 0.0 { Overlap::new(radius, reach, offset) } else { Overlap::None };
        (overlap, away)
    }

    /// Distance of a point from the centre of the light, scene units; infinite for a distant light.
    #[must_use]
    pub fn center_distance(&self, from: DVec3) -> f64 {
        if self.radius.is_infinite() { f64::INFINITY } else { self.center.distance(from) }
    }

    /// Unit vector from a point to the centre of the light, and the angular radius of the light about it, radians;
    /// `None` within its bounding sphere.
    #[must_use]
    pub fn angular_extent(&self, from: DVec3) -> Option<(DVec3, f64)> {
        if let Some(half_angle) = self.form.half_angle() {
            return Some((self.center, half_angle));
        }
        if let LightForm::DistantImage { x, y, .. } = &self.form {
            return Some((self.center, x.length().max(y.length()).atan()));
        }
        let offset = self.center - from;
        let distance = offset.length();
        (distance > self.radius).then(|| (offset / distance, (self.radius / distance).asin()))
    }

    /// Whether no light reaches the point: it is behind the light or its mirror, or outside the
    /// cone.
    #[inline]
    pub fn misses(&self, receiver: DVec3) -> bool {
        let is_behind = |virtual_source: &VirtualSource| {
            virtual_source.redirection.is_none() && virtual_source.normal.dot(receiver - virtual_source.point) <= 0.0
        };
        if self.virtual_sources.first().is_some_and(is_behind) {
            return true;
        }
        match &self.cone {
            Some(cone) => self.is_beyond(cone, receiver),
            None => {
                self.shows_its_back(receiver)
                    || self.dark_beyond.as_ref().is_some_and(|cone| self.is_beyond(cone, receiver))
            }
        }
    }

    /// Whether a receiver is outside the cones from all points of the light.
    #[inline]
    fn is_beyond(&self, cone: &LightCone, receiver: DVec3) -> bool {
        if self.radius.is_infinite() {
            return false;
        }
        let offset = receiver - self.center;
        offset.length_squared() > self.radius * self.radius && cone.misses(offset, self.radius)
    }

    #[inline]
    fn shows_its_back(&self, receiver: DVec3) -> bool {
        self.form.plane().is_some_and(|(normal, point)| normal.dot(receiver - point) <= 0.0)
    }

    /// Whether a prism redirects the light, so that its radiance is known only after tracing the
    /// ray.
    #[inline]
    pub fn is_redirected(&self) -> bool {
        self.virtual_sources.iter().any(|virtual_source| virtual_source.redirection.is_some())
    }

    /// The ray from a receiver towards the light, reflected by all mirrors to the real light.
    pub fn real_ray(&self, receiver: DVec3, direction: DVec3) -> Ray {
        let (mut origin, mut direction) = (receiver, direction);
        for virtual_source in &self.virtual_sources {
            origin = virtual_source.image_of_point(origin);
            direction = virtual_source.image_of_direction(direction);
        }
        Ray { origin, direction }
    }
}

impl LightCubature {
    /// Replaces `nodes` by those of the rule.
    #[inline]
    pub fn nodes(&self, nodes: &mut DiskNodes) {
        nodes.clear();
        self.rule.for_each_node(|x, y, area| nodes.push(x, y, area));
    }

    /// Where the disk is, as seen from the receiver.
    #[inline]
    #[must_use]
    pub fn frame(&self) -> DiskFrame {
        let center = self.center - self.receiver;
        DiskFrame { center, axes: [self.x, self.y], normal: self.normal, radius: self.radius }
    }

    /// The point of the disk at coordinates relative to its radius, as a sample uniform by area.
    #[must_use]
    pub fn sample_at(&self, [x, y]: [f64; 2]) -> Option<LightSample> {
        let point = self.center + (self.x * x + self.y * y) * self.radius;
        seen(self.receiver, point, self.normal, (PI * self.radius * self.radius).recip())
    }

    /// The coordinates of a sample in the light's plane, relative to its radius.
    #[must_use]
    pub fn coordinates(&self, sample: &LightSample) -> [f64; 2] {
        let from_center = self.receiver + sample.direction * sample.distance - self.center;
        [self.x, self.y].map(|axis| axis.dot(from_center) / self.radius)
    }
}

/// Gradient of the logarithm of the receiver's lobe and cosine by the unit direction, at the centre of
/// a light of this angular radius; `fall_off` is added to that of the cosine. The cosine is left out
/// where it hardly varies over the light.
#[inline]
fn lobe_gradient(towards: DVec3, radius: f64, peak: &LobePeak, fall_off: DVec3) -> DVec3 {
    let of_lobe = peak.gradient(towards);
    let of_cosine = peak.cosine.gradient(towards, radius.clamp(f64::MIN_POSITIVE, 1.0)) + fall_off;
    if of_cosine.length_squared() * radius * radius < LEAST_VARIATION * LEAST_VARIATION {
        return of_lobe;
    }
    of_lobe + of_cosine * (1.0 - peak.share(towards))
}

/// Variation over the radius of a light, relative to the mean, below which its density is uniform.
const LEAST_VARIATION: f64 = 0.03;

/// Radius of a rectangle relative to its distance from which it is sampled by solid angle. Below it, the
/// light that it gives is nearly bilinear over its area.
const WIDE: f64 = 0.2;

/// Largest share of the highlight at the centre of such a light.
const MOST_HIGHLIGHT: f64 = 0.5;

/// Mixture of sampling the emission profile with this probability, and the shape otherwise.
#[derive(Clone, Copy, Debug)]
struct Mixture<'l> {
    profile: &'l EmissionProfile,
    chance: f64,
}

impl Mixture<'_> {
    /// Density of the mixture, given those of sampling the profile and the shape, 1/sr.
    fn pdf(self, by_direction: f64, by_area: f64) -> f64 {
        self.chance * by_direction + (1.0 - self.chance) * by_area
    }
}
