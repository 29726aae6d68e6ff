//! The velocity with which the samples of a pixel follow an outline.

use super::ParameterStep;
use crate::domain::Domain;
use glam::{DMat2, DVec2, DVec3};
use radsight_pinhole::{CameraRay, Rays};

/// Velocity of points of the domain, per unit of the parameter: linear in the point and in the
/// fixed point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Flow {
    /// At the middle of the domain, for the middle of the fixed points.
    middle: DVec2,
    /// Derivative by the point of the domain.
    by_point: DMat2,
    /// Derivative by the fixed point.
    by_fixed: DMat2,
    center: DVec2,
    fixed_center: DVec2,
}

/// Step of numerical derivatives within the domain, radii of the pinhole or pixels.
const DOMAIN_STEP: f64 = 1e-3;

/// Distance of the points between which the velocity is interpolated.
const REACH: f64 = 0.5;

impl Flow {
    /// The velocity that keeps a point of the scene, and those around it, on the rays that hit
    /// them. `None` where rays do not determine it.
    pub(super) fn following(step: &ParameterStep<'_>, domain: Domain, pixel: u64, outline: DVec3) -> Option<Flow> {
        let view = View { step, domain, pixel, outline, normal: step.center.rays.camera().direction() };
        let center = domain.middle();
        let fixed_center = if domain == Domain::Disk { Domain::MIDDLE_OF_PIXEL } else { DVec2::ZERO };
        let middle = view.velocity(fixed_center, center)?;
        let slope = |velocity: Option<DVec2>| velocity.map(|velocity| (velocity - middle) / REACH);
        let by_point = DMat2::from_cols(
            slope(view.velocity(fixed_center, center + DVec2::X * REACH))?,
            slope(view.velocity(fixed_center, center + DVec2::Y * REACH))?,
        );
        // A point pinhole has one fixed point only.
        let by_fixed = match domain {
            Domain::Square => DMat2::ZERO,
            Domain::Disk => DMat2::from_cols(
                slope(view.velocity(fixed_center + DVec2::X * REACH, center))?,
                slope(view.velocity(fixed_center + DVec2::Y * REACH, center))?,
            ),
        };
        let flow = Flow { middle, by_point, by_fixed, center, fixed_center };
        (flow.middle.is_finite() && by_point.is_finite() && by_fixed.is_finite()).then_some(flow)
    }

    pub(super) fn velocity(&self, fixed: DVec2, at: DVec2) -> DVec2 {
        self.middle + self.by_point * (at - self.center) + self.by_fixed * (fixed - self.fixed_center)
    }

    pub(super) fn divergence(&self) -> f64 {
        self.by_point.x_axis.x + self.by_point.y_axis.y
    }
}

/// A pixel's view of an outline.
struct View<'a> {
    step: &'a ParameterStep<'a>,
    domain: Domain,
    pixel: u64,
    outline: DVec3,
    /// Of the plane through the outline that stands for what moves.
    normal: DVec3,
}

impl View<'_> {
    fn ray(&self, rays: &Rays, fixed: DVec2, at: DVec2) -> Option<CameraRay> {
        self.domain.ray(rays, self.pixel, fixed, at)
    }

    /// The velocity of the domain's point whose ray keeps hitting the same moving point.
    fn velocity(&self, fixed: DVec2, at: DVec2) -> Option<DVec2> {
        let ParameterStep { center, below, above, step, motion, .. } = *self.step;
        let ray = self.ray(center.rays, fixed, at)?;
        let distance = (self.outline - ray.origin).dot(self.normal) / ray.direction.dot(self.normal);
        let point = ray.origin + ray.direction * distance;
        let basis = ray.direction.any_orthonormal_pair();
        let moved = motion.velocity(point) * step;
        let side = |axis: DVec2| {
            let [a, b] = [-1.0, 1.0].map(|sign| self.ray(center.rays, fixed, at + axis * (sign * DOMAIN_STEP)));
            Some((miss(&b?, point, basis) - miss(&a?, point, basis)) / (2.0 * DOMAIN_STEP))
        };
        let by_point = DMat2::from_cols(side(DVec2::X)?, side(DVec2::Y)?);
        let after = miss(&self.ray(above.rays, fixed, at)?, point + moved, basis);
        let before = miss(&self.ray(below.rays, fixed, at)?, point - moved, basis);
        let velocity = by_point.inverse() * (before - after) / (2.0 * step);
        velocity.is_finite().then_some(velocity)
    }
}

/// Where a ray passes a point, along two axes across it.
fn miss(ray: &CameraRay, point: DVec3, (x, y): (DVec3, DVec3)) -> DVec2 {
    let from = ray.origin - point;
    let closest = from - ray.direction * from.dot(ray.direction);
    DVec2::new(closest.dot(x), closest.dot(y))
}
