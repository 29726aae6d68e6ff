//! Image of a distant source in a prism: an ellipse of directions.
//!
//! A prism preserves radiance, up to its coefficient, but not solid angle: through it the sun may
//! appear larger, smaller or distorted. The image consists of all directions that the prism
//! redirects into the source's cone. It is found in reverse: directions on the source's rim are
//! redirected backwards through the prism.

use crate::prism::PrismKind;
use glam::DVec3;
use radsight_accel::Ray;
use radsight_cal::Scratch;
use radsight_light::{LightForm, Redirection, coordinates};
use radsight_texture::SurfaceInteraction;
use std::f64::consts::TAU;

/// Number of points on the rim.
const RIM: u32 = 8;

/// Margin of the ellipse beyond the farthest rim point; the deviation of the rim from an ellipse is
/// added. Samples beside the image are noise.
const MARGIN: f64 = 0.002;

/// Largest ratio of the ellipse to the mean of the rim.
const LARGEST: f64 = 4.0;

/// Largest error of the reverse redirection, relative to the source's radius. A prism of larger
/// error has no such image: it may aim at the light from any point.
const ASTRAY: f64 = 0.25;

/// A ray at the centre of a prism.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PrismInteraction<'a> {
    pub prism: &'a PrismKind,
    pub middle: DVec3,
    pub normal: DVec3,
}

impl PrismInteraction<'_> {
    fn redirect(&self, face: u32, direction: DVec3, aim: DVec3, scratch: &mut Scratch) -> Option<DVec3> {
        let ray = Ray { origin: self.middle - direction, direction };
        let interaction = SurfaceInteraction::new(&ray, self.middle, self.normal, 1.0, 1.0);
        self.prism.redirect(face, &interaction, aim, scratch).map(|(_, direction)| direction)
    }

    /// Image of a distant source; `None` if it is no ellipse.
    pub(crate) fn image(&self, form: &LightForm, redirection: &Redirection) -> Option<LightForm> {
        let (source, x, y) = tangents(form)?;
        let mut scratch = Scratch::default();
        let allowed = ASTRAY * x.length().max(y.length());
        let mut seen_towards = |towards: DVec3| {
            let from = -self.redirect(redirection.face, -towards, DVec3::ZERO, &mut scratch)?;
            let again = self.redirect(redirection.face, from, redirection.target, &mut scratch)?;
            (again.distance(towards) <= allowed).then_some(from)
        };
        let direction = seen_towards(source)?;
        let mut rim = [DVec3::ZERO; RIM as usize];
        let (mut image_x, mut image_y) = (DVec3::ZERO, DVec3::ZERO);
        for (index, offset) in rim.iter_mut().enumerate() {
            let (sin, cos) = (TAU * index as f64 / f64::from(RIM)).sin_cos();
            let seen = seen_towards((source + x * cos + y * sin).normalize())?;
            let along = seen.dot(direction);
            if along <= 0.0 {
                return None;
            }
            // Projection onto the tangent plane of the sphere of directions at the image's centre.
            *offset = seen / along - direction;
            image_x += *offset * (2.0 * cos / f64::from(RIM));
            image_y += *offset * (2.0 * sin / f64::from(RIM));
        }
        if image_x.cross(image_y).length_squared() <= 0.0 {
            return None;
        }
        let radius = |offset: &DVec3| {
            let [a, b] = coordinates(image_x, image_y, *offset);
            a.hypot(b)
        };
        let largest = rim.iter().map(radius).fold(1.0, f64::max);
        let scale = largest + (largest - 1.0) + MARGIN;
        (scale <= LARGEST).then_some(LightForm::DistantImage { direction, x: image_x * scale, y: image_y * scale })
    }
}

/// Centre of a distant source, and its half axes in the tangent plane of the sphere of directions.
fn tangents(form: &LightForm) -> Option<(DVec3, DVec3, DVec3)> {
    match form {
        LightForm::Distant { direction, x, y, half_angle_sin_squared_half } => {
            let cos = 1.0 - 2.0 * half_angle_sin_squared_half;
            let tangent = (1.0 - cos * cos).max(0.0).sqrt() / cos;
            (cos > WIDEST_COSINE).then_some((*direction, *x * tangent, *y * tangent))
        }
        LightForm::DistantImage { direction, x, y } => Some((*direction, *x, *y)),
        _ => None,
    }
}

/// Smallest cosine of a source's half angle for which the tangent plane is a good approximation.
const WIDEST_COSINE: f64 = 0.5;
