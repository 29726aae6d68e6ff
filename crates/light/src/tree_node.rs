//! Nodes of the light tree: bounds of position, emission direction and power.

use crate::form::LightForm;
use crate::light::{Light, LightId};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// One light, or a group of neighbouring lights.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    /// Centre of the bounding sphere; for distant lights, of the sphere around their unit
    /// directions.
    pub(crate) center: DVec3,
    pub(crate) radius: f64,
    pub(crate) is_distant: bool,
    pub(crate) emission: Emission,
    /// Sum over the lights of radiance times largest projected area; for distant lights times solid
    /// angle.
    pub(crate) strength: f64,
    /// Distance beyond which the lights give nothing, scene units.
    pub(crate) range: f64,
    pub(crate) content: Content,
}

/// Content of a node.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Content {
    /// Two children; the second has this number.
    Two(u32),
    One(LightId),
}

/// Bounds of the emission directions: up to `reach` from normals within `spread` of `axis`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EmissionCone {
    /// Unit.
    pub(crate) axis: DVec3,
    /// Angle of the normals from the axis, radians.
    pub(crate) spread: f64,
    pub(crate) reach: f64,
}

/// The same bounds, prepared for evaluation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Emission {
    axis: DVec3,
    spread: Angle,
    reach_cosine: f64,
}

/// An angle from zero to π, by its cosine and sine.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Angle {
    pub(crate) cos: f64,
    pub(crate) sin: f64,
}

impl EmissionCone {
    /// All directions.
    pub(crate) const EVERYWHERE: EmissionCone = EmissionCone { axis: DVec3::Z, spread: PI, reach: FRAC_PI_2 };

    /// Emission directions of a light, ignoring mirrors.
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

    /// Difference of two angles; zero if the other is larger.
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

    /// Upper bound on the cosine of emission towards a point: `towards` is the unit direction from
    /// the point to the lights' centre, and all lights are within `half_width` of it. Zero if
    /// nothing is emitted there.
    pub(crate) fn cosine(&self, towards: DVec3, half_width: Angle) -> f64 {
        let angle = Angle::of_cosine(-self.axis.dot(towards));
        let least = angle.without(self.spread).without(half_width);
        if least.cos < self.reach_cosine { 0.0 } else { least.cos.max(LEAST_COSINE) }
    }
}

/// Cosines that differ by less count as equal.
const ROUNDING: f64 = 1e-9;

/// Cosine of a light at the limit of its emission, which keeps its probability positive.
const LEAST_COSINE: f64 = 1e-3;

/// Largest projected area of a light, or solid angle if it is distant.
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
    fn distant_lights_have_their_solid_angle_as_extent() {
        let [direction, x, y] = [DVec3::Z, DVec3::X * 0.01, DVec3::Y * 0.02];
        let found = shown(&LightForm::DistantImage { direction, x, y });
        assert!((found / (PI * 0.01 * 0.02) - 1.0).abs() < 1e-12, "{found} sr");
    }
}
