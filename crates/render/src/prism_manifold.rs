//! The path from a point through a prism to a point of a near light.
//!
//! A prism refracts each ray by its position and direction, so a near light has no single virtual
//! source. Newton's method finds the point of the prism's plane through which a ray hits a given
//! point of the light, starting from Radiance's virtual source (Hanika, Droske and Fascione,
//! "Manifold Next Event Estimation", Computer Graphics Forum 34(4), 2015). The derivative of the
//! light's point by the prism's point gives the pdf of the direction.

use crate::direct::DirectSampler;
use crate::trace::PathIntegrator;
use glam::{DMat2, DVec2, DVec3};
use radsight_accel::Ray;
use radsight_cal::Scratch;
use radsight_compile::{Kind, PrismKind};
use radsight_light::{Light, LightSample, Redirection, VirtualSource};
use radsight_texture::SurfaceInteraction;

/// Maximum number of steps; a smooth prism takes three or four.
const MAX_STEPS: usize = 12;

/// Maximum number of halvings of a diverging step.
const MAX_HALVINGS: usize = 4;

/// Tolerance of the end point, relative to the path length.
const TOLERANCE: f64 = 1e-6;

/// Step of the numerical derivative, relative to the distance.
const STEP: f64 = 1e-5;

/// If the light's point changes by less than this fraction of the prism's point, the prism aims at
/// the light by itself.
const MIN_DERIVATIVE: f64 = 1e-4;

/// The paths from a receiver through a face of a prism to the plane of a light.
struct PrismManifold<'a> {
    prism: &'a PrismKind,
    redirection: Redirection,
    receiver: DVec3,
    travelled: f64,
    /// Unit normal of the prism's plane, and two tangents.
    normal: DVec3,
    across: [DVec3; 2],
    /// The point of the light, and the unit normal there.
    target: DVec3,
    light_normal: DVec3,
    light_across: [DVec3; 2],
}

/// One path.
#[derive(Clone, Copy, Debug)]
struct ManifoldPoint {
    /// From the requested point to the intersection with the light's plane, in that plane.
    miss: DVec2,
    length: f64,
}

impl PrismManifold<'_> {
    /// The path through a point of the prism's plane.
    fn through(&self, point: DVec3, scratch: &mut Scratch) -> Option<ManifoldPoint> {
        let before = point - self.receiver;
        let distance = before.length();
        let ray = Ray { origin: self.receiver, direction: before / distance };
        let interaction = SurfaceInteraction::new(&ray, point, self.normal, distance, self.travelled + distance);
        let aim = (self.redirection.target - point).normalize_or_zero();
        let (_, transmitted) = self.prism.redirect(self.redirection.face, &interaction, aim, scratch)?;
        let after = self.light_normal.dot(self.target - point) / self.light_normal.dot(transmitted);
        if !after.is_finite() || after <= 0.0 {
            return None;
        }
        let missed = point + transmitted * after - self.target;
        let [x, y] = self.light_across;
        Some(ManifoldPoint { miss: DVec2::new(missed.dot(x), missed.dot(y)), length: distance + after })
    }

    /// The derivative of the end point by the prism's point.
    fn derivative(&self, point: DVec3, path: &ManifoldPoint, scratch: &mut Scratch) -> Option<DMat2> {
        let step = STEP * point.distance(self.receiver);
        let [x, y] = self.across.map(|axis| self.through(point + axis * step, scratch));
        Some(DMat2::from_cols((x?.miss - path.miss) / step, (y?.miss - path.miss) / step))
    }

    /// The point through which the path reaches the requested end, from an initial guess; with the
    /// path, and the ratio of areas of the light's plane and the prism's.
    fn solve(&self, guess: DVec3, scratch: &mut Scratch) -> Option<(DVec3, ManifoldPoint, f64)> {
        let mut point = guess;
        let mut path = self.through(point, scratch)?;
        for _ in 0..MAX_STEPS {
            let derivative = self.derivative(point, &path, scratch)?;
            let magnification = derivative.determinant().abs();
            if magnification.is_nan() || magnification < MIN_DERIVATIVE {
                return None;
            }
            if path.miss.length() < TOLERANCE * path.length {
                return Some((point, path, magnification));
            }
            let step = derivative.inverse() * -path.miss;
            (point, path) = (0..=MAX_HALVINGS).find_map(|halvings| {
                let step = step * 0.5f64.powi(halvings as i32);
                let next = point + self.across[0] * step.x + self.across[1] * step.y;
                let nearer = self.through(next, scratch)?;
                (nearer.miss.length_squared() < path.miss.length_squared()).then_some((next, nearer))
            })?;
        }
        None
    }
}

impl DirectSampler<'_> {
    /// A point of a flat near light, seen through the one prism between; `None` if no path is
    /// found.
    pub(crate) fn connect_through_prism<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        light: &Light,
        u: [f64; 2],
    ) -> Option<LightSample> {
        let [virtual_source @ VirtualSource { redirection: Some(redirection), normal, .. }] = light.virtual_sources[..]
        else {
            return None;
        };
        let plan = tracer.plan;
        let real = &plan.lights[plan.lights_of(light.surface).next()?.0 as usize];
        let Kind::Prism(prism) = &plan.virtual_source_shader(virtual_source.surface).kind else { return None };
        let (light_normal, target) = real.form.point(u)?;
        let manifold = PrismManifold {
            prism,
            redirection,
            receiver: self.point,
            travelled: self.travelled,
            normal,
            across: normal.any_orthonormal_pair().into(),
            target,
            light_normal,
            light_across: light_normal.any_orthonormal_pair().into(),
        };
        let towards_image = virtual_source.image_of_point(target) - self.point;
        let height = normal.dot(virtual_source.point - self.point);
        let guess = self.point + towards_image * (height / normal.dot(towards_image));
        let (point, path, magnification) =
            manifold.solve(guess.is_finite().then_some(guess)?, &mut tracer.workspace.scratch)?;
        let before = point - self.point;
        let squared = before.length_squared();
        let direction = before / squared.sqrt();
        let cosine = direction.dot(normal).abs();
        let pdf = magnification * squared / (real.form.area() * cosine);
        (cosine > 0.0).then_some(LightSample { direction, distance: path.length, pdf, normal: light_normal })
    }
}
