//! The nodes of the hierarchy of lights: where their lights are, where they shine to, how strongly.

use crate::form::LightForm;
use crate::light::{Light, LightId};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// Lights that are near each other, or one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    /// A sphere around them; around their unit directions if they are distant.
    pub(crate) center: DVec3,
    pub(crate) radius: f64,
    pub(crate) is_distant: bool,
    pub(crate) emission: Emission,
    /// Sum over the lights of radiance times the area that they show where they show most; times solid angle for distant ones.
    pub(crate) strength: f64,
    /// Farther points get nothing.
    pub(crate) range: f64,
    pub(crate) content: Content,
}

/// What a node holds.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Content {
    /// Two nodes; the second one has this number.
    Two(u32),
    One(LightId),
}

/// Where lights shine to: from normals within `spread` of `axis` as far as `reach` from the normal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EmissionCone {
    /// Unit.
    pub(crate) axis: DVec3,
    /// Angles.
    pub(crate) spread: f64,
    pub(crate) reach: f64,
}

/// The same, ready to be asked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Emission {
    axis: DVec3,
    spread: Angle,
    reach_cosine: f64,
}

/// An angle from zero to π.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Angle {
    pub(crate) cos: f64,
    pub(crate) sin: f64,
}

impl EmissionCone {
    /// All around.
    pub(crate) const EVERYWHERE: EmissionCone = EmissionCone { axis: DVec3::Z, spread: PI, reach: FRAC_PI_2 };

    /// Where a light shines to, without regard to mirrors.
    pub(crate) fn of(light: &Light) -> EmissionCone {
        let is_moved = light.is_redirected();
        match (&light.cone, light.form.plane()) {
            _ if is_moved => EmissionCone::EVERYWHERE,
            (Some(cone), _) => EmissionCone { axis: cone.axis, spread: 0.0, reach: cone.half_angle.min(PI) },
            (None, Some((axis, _))) => EmissionCone { axis, spread: 0.0, reach: FRAC_PI_2 },
            (None, None) => EmissionCone::EVERYWHERE,
        }
    }
}

impl Angle {
    pub(crate) const NONE: Angle = Angle { cos: 1.0, sin: 0.0 };

    pub(crate) fn of_cosine(cos: f64) -> Angle {
        Angle { cos, sin: (1.0 - cos * cos).max(0.0).sqrt() }
    }

    pub(crate) fn of_sine_squared(sin_squared: f64) -> Angle {
        Angle { cos: (1.0 - sin_squared).max(0.0).sqrt(), sin: sin_squared.sqrt() }
    }

    /// What is left of it without another; nothing if that is larger.
    pub(crate) fn without(self, other: Angle) -> Angle {
        if self.cos >= other.cos {
            return Angle::NONE;
        }
        Angle { cos: self.cos * other.cos + self.sin * other.sin, sin: self.sin * other.cos - self.cos * other.sin }
    }
}

impl Emission {
    pub(crate) fn new(cone: &EmissionCone) -> Emission {
        let EmissionCone { axis, spread, reach } = *cone;
        Emission { axis, spread: Angle { cos: spread.cos(), sin: spread.sin() }, reach_cosine: reach.cos() - ROUNDING }
    }

    /// A bound on the cosine of emission towards a point, with `towards` the unit direction to the middle of the lights, of which
    /// all are within `half_width` of it; zero where nothing is sent.
    pub(crate) fn cosine(&self, towards: DVec3, half_width: Angle) -> f64 {
        let angle = Angle::of_cosine(-self.axis.dot(towards));
        let least = angle.without(self.spread).without(half_width);
        if least.cos < self.reach_cosine { 0.0 } else { least.cos.max(LEAST_COSINE) }
    }
}

/// Cosines that differ by less may be the same.
const ROUNDING: f64 = 1e-9;

/// Of a light at the edge of what it can reach, so that it keeps a chance.
const LEAST_COSINE: f64 = 1e-3;

/// What a light shows of itself where it shows most: an area, or a solid angle if it is distant.
pub(crate) fn shown(form: &LightForm) -> f64 {
    match form {
        LightForm::Sphere { radius, .. } => PI * radius * radius,
        LightForm::Cone { .. } => form.area() / PI,
        LightForm::Distant { .. } | LightForm::DistantImage { .. } => form.solid_angle(1.0),
        _ => form.area(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_distant_lights_show_is_their_solid_angle() {
        let [direction, x, y] = [DVec3::Z, DVec3::X * 0.01, DVec3::Y * 0.02];
        let found = shown(&LightForm::DistantImage { direction, x, y });
        assert!((found / (PI * 0.01 * 0.02) - 1.0).abs() < 1e-12, "{found} sr");
    }
}
