//! The velocity with which the samples of a pixel follow an outline.

use super::ParameterStep;
use super::place::{MIDDLE, Place, ray};
use glam::{DMat2, DMat4, DVec2, DVec3};
use radsight_pinhole::CameraRay;

/// Velocity of places, per unit of the parameter: linear in the place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Flow {
    /// At the middle of pixel and pinhole.
    middle: Place,
    /// Derivative by the place.
    by_place: DMat4,
    /// From a place to some whose rays pass beside its ray.
    beside: [Place; 4],
}

/// Step of numerical derivatives, radii of the pinhole or pixels.
const PLACE_STEP: f64 = 1e-3;

/// Distance of the places between which the velocity is interpolated.
const REACH: f64 = 0.5;

/// Squares of half the width of a pixel and of the radius of the pinhole: in these units a change of a
/// place is the shortest.
const SQUARED_EXTENT: Place = Place::new(0.25, 0.25, 1.0, 1.0);

/// Distance of the places beside a place.
const BESIDE: f64 = 0.06;

impl Flow {
    /// The velocity that keeps a point of the scene, and those around it, on the rays that hit
    /// them. `None` where rays do not determine it.
    pub(super) fn following(step: &ParameterStep<'_>, pixel: u64, outline: DVec3) -> Option<Flow> {
        let view = View { step, pixel, outline, normal: step.center.rays.camera().direction() };
        let middle = view.velocity(MIDDLE)?;
        let slope = |axis: Place| Some((view.velocity(MIDDLE + axis * REACH)? - middle) / REACH);
        let by_place = DMat4::from_cols(slope(Place::X)?, slope(Place::Y)?, slope(Place::Z)?, slope(Place::W)?);
        let beside = view.beside(MIDDLE)?;
        let is_finite = middle.is_finite() && by_place.is_finite() && beside.iter().all(|place| place.is_finite());
        is_finite.then_some(Flow { middle, by_place, beside })
    }

    pub(super) fn velocity(&self, at: Place) -> Place {
        self.middle + self.by_place * (at - MIDDLE)
    }

    pub(super) fn divergence(&self) -> f64 {
        let [x, y, z, w] = self.by_place.to_cols_array_2d();
        x[0] + y[1] + z[2] + w[3]
    }

    pub(super) fn beside(&self, at: Place) -> [Place; 4] {
        self.beside.map(|offset| at + offset)
    }
}

/// A pixel's view of an outline.
struct View<'a> {
    step: &'a ParameterStep<'a>,
    pixel: u64,
    outline: DVec3,
    /// Of the plane through the outline that stands for what moves.
    normal: DVec3,
}

impl View<'_> {
    /// The least velocity of the place whose ray keeps hitting the same moving point.
    fn velocity(&self, at: Place) -> Option<Place> {
        let ParameterStep { below, above, step, motion, .. } = *self.step;
        let aim = self.aim(at)?;
        let moved = motion.velocity(aim.point) * step;
        let after = aim.miss(&ray(above.rays, self.pixel, at)?, moved);
        let before = aim.miss(&ray(below.rays, self.pixel, at)?, -moved);
        Some(aim.least((before - after) / (2.0 * step)))
    }

    /// Places whose rays pass the point that a ray hits, on all four sides.
    fn beside(&self, at: Place) -> Option<[Place; 4]> {
        let aim = self.aim(at)?;
        let [x, y] = [DVec2::X, DVec2::Y].map(|axis| aim.least(axis).normalize() * BESIDE);
        Some([x, -x, y, -y])
    }

    fn aim(&self, at: Place) -> Option<Aim> {
        let rays = self.step.center.rays;
        let center = ray(rays, self.pixel, at)?;
        let distance = (self.outline - center.origin).dot(self.normal) / center.direction.dot(self.normal);
        let point = center.origin + center.direction * distance;
        let mut aim = Aim { point, across: center.direction.any_orthonormal_pair().into(), by_place: [Place::ZERO; 2] };
        for (index, axis) in Place::AXES.into_iter().enumerate() {
            let [above, below] = [axis, -axis].map(|axis| ray(rays, self.pixel, at + axis * PLACE_STEP));
            let slope = (aim.miss(&above?, DVec3::ZERO) - aim.miss(&below?, DVec3::ZERO)) / (2.0 * PLACE_STEP);
            (aim.by_place[0][index], aim.by_place[1][index]) = (slope.x, slope.y);
        }
        Some(aim)
    }
}

/// The point that a ray hits, and how rays of other places miss it.
struct Aim {
    point: DVec3,
    /// Two axes across the ray.
    across: [DVec3; 2],
    /// Derivatives by the place of where the ray passes, along these axes.
    by_place: [Place; 2],
}

impl Aim {
    /// Where a ray passes the point moved by `moved`, along the axes.
    fn miss(&self, ray: &CameraRay, moved: DVec3) -> DVec2 {
        let from = ray.origin - self.point - moved;
        let closest = from - ray.direction * from.dot(ray.direction);
        self.across.map(|axis| closest.dot(axis)).into()
    }

    /// The shortest change of a place that shifts where its ray passes. Two equations leave two of four
    /// unknowns open. Points on a sharp pixel move, and points on a pinhole whose blur is wider
    /// than a pixel.
    fn least(&self, shift: DVec2) -> Place {
        let [x, y] = self.by_place;
        let [to_x, to_y] = [x * SQUARED_EXTENT, y * SQUARED_EXTENT];
        let squares = DMat2::from_cols(DVec2::new(x.dot(to_x), y.dot(to_x)), DVec2::new(x.dot(to_y), y.dot(to_y)));
        let DVec2 { x: along_x, y: along_y } = squares.inverse() * shift;
        to_x * along_x + to_y * along_y
    }
}
