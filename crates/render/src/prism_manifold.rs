//! The way from a point through a prism to a place on a near light.
//!
//! A prism bends each ray by where and how it is met, so a near light has no image in one place. The point of the prism's plane is looked for through
//! which the ray meets a given place on the light, by Newton's iteration from where Radiance's virtual source would have it (Hanika, Droske and
//! Fascione, "Manifold Next Event Estimation", Computer Graphics Forum 34(4), 2015). How the place moves with that point gives the density of
//! the direction.

use crate::direct::DirectSampler;
use crate::trace::PathIntegrator;
use glam::{DMat2, DVec2, DVec3};
use radsight_accel::Ray;
use radsight_cal::Scratch;
use radsight_compile::{Kind, PrismKind};
use radsight_light::{Light, LightSample, Redirection, VirtualSource};
use radsight_texture::SurfaceInteraction;

/// Steps; a smooth prism takes three or four.
const MOST_STEPS: usize = 12;

/// A step that leads away is halved so often.
const MOST_HALVINGS: usize = 4;

/// How near to its place the ray must come, as a share of its length.
const TOLERANCE: f64 = 1e-6;

/// By what share of its distance the point is moved to see how the place follows.
const STEP: f64 = 1e-5;

/// A prism of which the place on the light hardly follows the point, by less than this share, aims at the light by itself.
const AIMED: f64 = 1e-4;

/// The ways from a receiver through a face of a prism to the plane of a light.
struct PrismManifold<'a> {
    prism: &'a PrismKind,
    redirection: Redirection,
    receiver: DVec3,
    travelled: f64,
    /// Unit, of the prism's plane, and two in it.
    normal: DVec3,
    across: [DVec3; 2],
    /// The place on the light, and the unit normal there.
    place: DVec3,
    light_normal: DVec3,
    light_across: [DVec3; 2],
}

/// One of them.
#[derive(Clone, Copy, Debug)]
struct ManifoldPoint {
    /// From the place to where the light's plane is met, in that plane.
    miss: DVec2,
    length: f64,
}

impl PrismManifold<'_> {
    /// The way through a point of the prism's plane.
    fn through(&self, point: DVec3, scratch: &mut Scratch) -> Option<ManifoldPoint> {
        let before = point - self.receiver;
        let distance = before.length();
        let ray = Ray { origin: self.receiver, direction: before / distance };
        let interaction = SurfaceInteraction::new(&ray, point, self.normal, distance, self.travelled + distance);
        let aim = (self.redirection.target - point).normalize_or_zero();
        let (_, transmitted) = self.prism.redirect(self.redirection.face, &interaction, aim, scratch)?;
        let after = self.light_normal.dot(self.place - point) / self.light_normal.dot(transmitted);
        if !after.is_finite() || after <= 0.0 {
            return None;
        }
        let missed = point + transmitted * after - self.place;
        let [x, y] = self.light_across;
        Some(ManifoldPoint { miss: DVec2::new(missed.dot(x), missed.dot(y)), length: distance + after })
    }

    /// How the place that is met moves with the point.
    fn derivative(&self, point: DVec3, way: &ManifoldPoint, scratch: &mut Scratch) -> Option<DMat2> {
        let step = STEP * point.distance(self.receiver);
        let [x, y] = self.across.map(|axis| self.through(point + axis * step, scratch));
        Some(DMat2::from_cols((x?.miss - way.miss) / step, (y?.miss - way.miss) / step))
    }

    /// The point through which the way meets the place, from a first guess; with the way, and how many times as large a piece of the light's plane is as the
    /// piece of the prism's through which it is met.
    fn solve(&self, guess: DVec3, scratch: &mut Scratch) -> Option<(DVec3, ManifoldPoint, f64)> {
        let mut point = guess;
        let mut way = self.through(point, scratch)?;
        for _ in 0..MOST_STEPS {
            let derivative = self.derivative(point, &way, scratch)?;
            let magnification = derivative.determinant().abs();
            if magnification.is_nan() || magnification < AIMED {
                return None;
            }
            if way.miss.length() < TOLERANCE * way.length {
                return Some((point, way, magnification));
            }
            let step = derivative.inverse() * -way.miss;
            (point, way) = (0..=MOST_HALVINGS).find_map(|halvings| {
                let step = step * 0.5f64.powi(halvings as i32);
                let next = point + self.across[0] * step.x + self.across[1] * step.y;
                let nearer = self.through(next, scratch)?;
                (nearer.miss.length_squared() < way.miss.length_squared()).then_some((next, nearer))
            })?;
        }
        None
    }
}

impl DirectSampler<'_> {
    /// A place on a flat near light, seen through the one prism that is between; `None` where no way is found.
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
        let (light_normal, place) = real.form.point(u)?;
        let ways = PrismManifold {
            prism,
            redirection,
            receiver: self.point,
            travelled: self.travelled,
            normal,
            across: normal.any_orthonormal_pair().into(),
            place,
            light_normal,
            light_across: light_normal.any_orthonormal_pair().into(),
        };
        let towards_image = virtual_source.image_of_point(place) - self.point;
        let height = normal.dot(virtual_source.point - self.point);
        let guess = self.point + towards_image * (height / normal.dot(towards_image));
        let (point, way, magnification) =
            ways.solve(guess.is_finite().then_some(guess)?, &mut tracer.workspace.scratch)?;
        let before = point - self.point;
        let squared = before.length_squared();
        let direction = before / squared.sqrt();
        let cosine = direction.dot(normal).abs();
        let pdf = magnification * squared / (real.form.area() * cosine);
        (cosine > 0.0).then_some(LightSample { direction, distance: way.length, pdf, normal: light_normal })
    }
}
