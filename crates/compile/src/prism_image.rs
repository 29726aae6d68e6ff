//! The image of a distant source in a prism: an ellipse of directions.
//!
//! A prism keeps radiance, up to its coefficient, and not solid angle: the sun may look larger or smaller through it, and squeezed. Light of the whole
//! source arrives from all directions that the prism sends into the source's cone. They are found from the other end: rays from the source's rim
//! are sent back through the prism.

use crate::prism::PrismKind;
use glam::DVec3;
use radsight_accel::Ray;
use radsight_cal::Scratch;
use radsight_light::{LightForm, Redirection, coordinates};
use radsight_texture::SurfaceInteraction;
use std::f64::consts::TAU;

/// Places on the rim that are sent back.
const RIM: u32 = 8;

/// By how much the ellipse is larger than the largest radius of the rim, beside as much as this is off an ellipse: what is drawn beside the image is
/// noise.
const MARGIN: f64 = 0.002;

/// An ellipse is not larger than this many times what the rim's mean asks for.
const LARGEST: f64 = 4.0;

/// A prism whose way back does not lead to where the light came from, up to this share of the source's radius, has no such image: it may
/// aim at the light from wherever it is met.
const ASTRAY: f64 = 0.25;

/// A prism as it is met in its middle.
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

    /// The image of a distant source; `None` where the prism makes no ellipse of it.
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
        for (index, place) in rim.iter_mut().enumerate() {
            let (sin, cos) = (TAU * index as f64 / f64::from(RIM)).sin_cos();
            let seen = seen_towards((source + x * cos + y * sin).normalize())?;
            let along = seen.dot(direction);
            if along <= 0.0 {
                return None;
            }
            // On the plane that touches the sphere of directions in the image's middle.
            *place = seen / along - direction;
            image_x += *place * (2.0 * cos / f64::from(RIM));
            image_y += *place * (2.0 * sin / f64::from(RIM));
        }
        if image_x.cross(image_y).length_squared() <= 0.0 {
            return None;
        }
        let radius = |place: &DVec3| {
            let [a, b] = coordinates(image_x, image_y, *place);
            a.hypot(b)
        };
        let largest = rim.iter().map(radius).fold(1.0, f64::max);
        let scale = largest + (largest - 1.0) + MARGIN;
        (scale <= LARGEST).then_some(LightForm::DistantImage { direction, x: image_x * scale, y: image_y * scale })
    }
}

/// The middle of a distant source, and from there to its rim on the plane that touches the sphere of directions.
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

/// A source within a cone of a smaller cosine is no spot in the sky.
const WIDEST_COSINE: f64 = 0.5;
