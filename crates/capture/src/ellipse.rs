//! Ellipses on the pinhole or the pixel, and the linear maps that give them.

use crate::domain::Domain;
use glam::{DMat2, DVec2};

/// Step of the numerical derivatives, in radii of the pinhole and in pixels.
const STEP: f64 = 1e-4;

/// An ellipse in the domain that moves with the fixed point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ellipse {
    /// For the fixed point 0.
    origin: DVec2,
    /// Derivative of the centre by the fixed point.
    slope: DMat2,
    /// From the unit disk.
    map: DMat2,
    inverse: DMat2,
}

impl Ellipse {
    /// With its centre for the fixed point 0.
    pub(crate) fn new(origin: DVec2, slope: DMat2, map: DMat2) -> Ellipse {
        Ellipse { origin, slope, map, inverse: map.inverse() }
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.inverse.is_finite() && self.origin.is_finite()
    }

    pub(crate) fn scaled(&self, by: f64) -> Ellipse {
        Ellipse::new(self.origin, self.slope, self.map * by)
    }

    /// Its area in units of that of the unit disk.
    pub(crate) fn relative_area(&self) -> f64 {
        self.map.determinant().abs()
    }

    pub(crate) fn center_at(&self, fixed: DVec2) -> DVec2 {
        self.origin + self.slope * fixed
    }

    /// The point at a place of the unit disk.
    pub(crate) fn point(&self, fixed: DVec2, on_disk: DVec2) -> DVec2 {
        self.center_at(fixed) + self.map * on_disk
    }

    /// The place of the unit disk of a point.
    pub(crate) fn offset(&self, fixed: DVec2, at: DVec2) -> DVec2 {
        self.inverse * (at - self.center_at(fixed))
    }

    pub(crate) fn contains(&self, fixed: DVec2, at: DVec2) -> bool {
        self.offset(fixed, at).length_squared() <= 1.0
    }

    /// The map to the unit disk from coordinates along an axis and across it.
    pub(crate) fn inverse_from(&self, turned: DMat2) -> DMat2 {
        self.inverse * turned
    }

    /// An upper limit of its extent on each side of the centre.
    pub(crate) fn widest(&self) -> f64 {
        self.map.x_axis.length().hypot(self.map.y_axis.length())
    }

    /// Extent along a unit axis on each side of the centre.
    pub(crate) fn extent(&self, axis: DVec2) -> f64 {
        (self.map.transpose() * axis).length()
    }
}

/// A function of points of the domain to first order, inverted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LinearMap {
    at: DVec2,
    /// The function's value there.
    pub(crate) value: DVec2,
    /// From values to points.
    inverse: DMat2,
}

impl LinearMap {
    /// Around a point; `None` where the function has no value.
    pub(crate) fn new(at: DVec2, mut function: impl FnMut(DVec2) -> Option<DVec2>) -> Option<LinearMap> {
        let value = function(at)?;
        let [x, y] = [DVec2::X, DVec2::Y].map(|side| Some((function(at + side * STEP)? - value) / STEP));
        Some(LinearMap { at, value, inverse: DMat2::from_cols(x?, y?).inverse() })
    }

    /// The point where the value is zero.
    pub(crate) fn zero(&self) -> DVec2 {
        self.at - self.inverse * self.value
    }

    /// The points where the value is at most one. `function` gives the value at the same point for
    /// another fixed point.
    pub(crate) fn ellipse(&self, domain: Domain, mut function: impl FnMut(DVec2) -> Option<DVec2>) -> Option<Ellipse> {
        // In front of a point pinhole nothing depends on the fixed point.
        let slope = if domain == Domain::Square {
            DMat2::ZERO
        } else {
            let [x, y] = [DVec2::X, DVec2::Y].map(|side| function(Domain::MIDDLE_OF_PIXEL + side * STEP));
            self.inverse * DMat2::from_cols((self.value - x?) / STEP, (self.value - y?) / STEP)
        };
        Some(Ellipse::new(self.zero() - slope * Domain::MIDDLE_OF_PIXEL, slope, self.inverse))
    }
}
