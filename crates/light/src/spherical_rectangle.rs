//! Points on a rectangle, sampled by the solid angle that they fill times the receiver's cosine.
//!
//! A point near a window or a large lamp sees its parts at very different distances and angles, so
//! points that are uniform by area make noise where nothing blocks the light. The map from the unit
//! square to the spherical rectangle preserves solid angle: Ureña, Fajardo and King, "An
//! Area-Preserving Parametrization for Spherical Rectangles", EGSR 2013. Before it, the unit square is
//! warped to a density that is bilinear between the cosines at the corners (as in Pharr, Jakob and
//! Humphreys, "Physically Based Rendering", 4th edition, section 12.4).

use crate::bilinear::Bilinear;
use crate::lobe_weighting::ReceiverCosine;
use glam::DVec3;
use std::f64::consts::TAU;

/// Squares of sines above this are 1.
const RIGHT_ANGLE: f64 = 1.0 - 1e-12;

/// A rectangle as seen from a receiver.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SphericalRectangle {
    /// Unit axes along both sides, and from the rectangle to the receiver.
    axes: [DVec3; 3],
    /// The lowest and the highest coordinates of the rectangle, relative to the receiver.
    low: [f64; 2],
    high: [f64; 2],
    /// Coordinate of its plane, below zero.
    height: f64,
    /// Cosines between the planes of the first and the third side and that of the receiver.
    slopes: [f64; 2],
    /// The angle from which those of points are counted.
    first_angle: f64,
    /// Solid angle, sr.
    solid_angle: f64,
    density: Bilinear,
}

impl SphericalRectangle {
    /// The rectangle from `corner`, relative to the receiver, with these perpendicular sides. `None`
    /// where its solid angle or its height is too small for rounding.
    #[inline]
    pub(crate) fn new(corner: DVec3, sides: [DVec3; 2], cosine: &ReceiverCosine) -> Option<SphericalRectangle> {
        let lengths = sides.map(DVec3::length);
        let (x, y) = (sides[0] / lengths[0], sides[1] / lengths[1]);
        let across = x.cross(y);
        let z = if across.dot(corner) > 0.0 { -across } else { across };
        let (low, height) = ([x.dot(corner), y.dot(corner)], z.dot(corner));
        let high = [low[0] + lengths[0], low[1] + lengths[1]];
        let extent = [low, high].as_flattened().iter().fold(0.0_f64, |extent, end| extent.max(end.abs()));
        if -height < LEAST_HEIGHT * extent {
            return None;
        }
        // Components along z of the unit normals of the planes through the receiver and a side.
        let slope = |coordinate: f64| slope(coordinate, height * height);
        let normals = [-slope(low[1]), slope(high[0]), slope(high[1]), -slope(low[0])];
        let angles = angles(normals);
        let solid_angle = solid_angle(angles);
        if solid_angle.is_nan() || solid_angle <= LEAST_SOLID_ANGLE {
            return None;
        }
        let corners = [[low[0], low[1]], [high[0], low[1]], [low[0], high[1]], [high[0], high[1]]];
        let value = |[along, aside]: [f64; 2]| cosine.of((x * along + y * aside + z * height).normalize());
        Some(SphericalRectangle {
            axes: [x, y, z],
            low,
            high,
            height,
            slopes: [normals[0], normals[2]],
            first_angle: TAU - angles[2] - angles[3],
            solid_angle,
            density: Bilinear::new(corners.map(value)),
        })
    }

    /// A point relative to the receiver, and its density, 1/sr.
    #[inline]
    pub(crate) fn sample(&self, u: [f64; 2]) -> (DVec3, f64) {
        let at = self.density.sample(u);
        let [x, y, z] = self.axes;
        let angle = at[0] * self.solid_angle + self.first_angle;
        let (sin, cos) = angle.sin_cos();
        let side = (cos * self.slopes[0] - self.slopes[1]) / sin;
        let sine = side.signum() / (side * side + self.slopes[0] * self.slopes[0]).sqrt();
        let along = -sine * self.height / (1.0 - sine * sine).max(f64::MIN_POSITIVE).sqrt();
        let along = along.clamp(self.low[0], self.high[0]);
        let (squared, [first, last]) = self.sines_across(along);
        let (distance, sine) = (squared.sqrt(), first + at[1] * (last - first));
        let aside = if sine * sine < RIGHT_ANGLE { sine * distance / (1.0 - sine * sine).sqrt() } else { self.high[1] };
        let aside = aside.clamp(self.low[1], self.high[1]);
        (x * along + y * aside + z * self.height, self.density.at(at) / self.solid_angle)
    }

    /// The density of a point relative to the receiver, 1/sr.
    pub(crate) fn pdf(&self, point: DVec3) -> f64 {
        let [along, aside] = [self.axes[0].dot(point), self.axes[1].dot(point)];
        let (squared, [first, last]) = self.sines_across(along);
        let v = (slope(aside, squared) - first) / (last - first);
        // The area that the points with a smaller first coordinate fill is a spherical rectangle too.
        let u = self.solid_angle_up_to(along) / self.solid_angle;
        self.density.at([u, v].map(|coordinate| coordinate.clamp(0.0, 1.0))) / self.solid_angle
    }

    /// Squared distance of a line across the rectangle from the receiver, in the plane through its
    /// middle, and the sines of the angles at which its ends are seen.
    fn sines_across(&self, along: f64) -> (f64, [f64; 2]) {
        let squared = along * along + self.height * self.height;
        (squared, [self.low[1], self.high[1]].map(|end| slope(end, squared)))
    }

    fn solid_angle_up_to(&self, along: f64) -> f64 {
        let slope = |coordinate: f64| slope(coordinate, self.height * self.height);
        solid_angle(angles([self.slopes[0], slope(along), self.slopes[1], -slope(self.low[0])]))
    }
}

/// The sine of the angle at which a coordinate is seen from this squared distance from its axis.
fn slope(coordinate: f64, squared: f64) -> f64 {
    coordinate / (coordinate * coordinate + squared).sqrt()
}

/// The inner angles of a spherical rectangle between the planes of its sides, by the components of
/// their normals along the axis.
fn angles(normals: [f64; 4]) -> [f64; 4] {
    std::array::from_fn(|side| (-normals[side] * normals[(side + 1) % 4]).acos())
}

fn solid_angle([a, b, c, d]: [f64; 4]) -> f64 {
    a + b + c + d - TAU
}

/// Height of the receiver above the plane, relative to the farthest side, below which rounding decides the
/// angles of the spherical rectangle.
const LEAST_HEIGHT: f64 = 1e-5;

/// Solid angles below this are rounding errors of the sum of four angles, sr.
const LEAST_SOLID_ANGLE: f64 = 1e-6;

/// Whether two sides are perpendicular.
pub(crate) fn perpendicular(x: DVec3, y: DVec3) -> bool {
    x.dot(y).abs() <= SKEW * (x.length_squared() * y.length_squared()).sqrt()
}

/// Largest cosine between the sides of a rectangle.
const SKEW: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    const STEPS: usize = 300;

    fn squares() -> impl Iterator<Item = [f64; 2]> {
        let at = |step: usize| (step as f64 + 0.5) / STEPS as f64;
        (0..STEPS * STEPS).map(move |index| [at(index % STEPS), at(index / STEPS)])
    }

    fn rectangles() -> impl Iterator<Item = SphericalRectangle> {
        let cosines =
            [ReceiverCosine::Unknown, ReceiverCosine::Front(DVec3::Z), ReceiverCosine::Both(dvec3(0.6, 0.0, 0.8))];
        let corners = [dvec3(-0.5, -0.5, 1.0), dvec3(0.2, -3.0, 0.3), dvec3(-0.1, 0.2, -0.05)];
        corners.into_iter().flat_map(move |corner| {
            let sides = [dvec3(1.2, 0.0, 0.0), dvec3(0.0, 2.0, 0.0)];
            cosines.map(|cosine| SphericalRectangle::new(corner, sides, &cosine).expect("it is large"))
        })
    }

    #[test]
    fn the_mean_of_reciprocal_densities_is_the_solid_angle() {
        for rectangle in rectangles() {
            let sum: f64 = squares().map(|u| 1.0 / rectangle.sample(u).1).sum();
            let found = sum / (STEPS * STEPS) as f64;
            // By area: cosine over squared distance.
            let ([x, y, z], area) = (rectangle.axes, 1.2 * 2.0 / (STEPS * STEPS) as f64);
            let patch = |[u, v]: [f64; 2]| {
                let point = x * (rectangle.low[0] + 1.2 * u) + y * (rectangle.low[1] + 2.0 * v) + z * rectangle.height;
                area * rectangle.height.abs() / point.length().powi(3)
            };
            let expected: f64 = squares().map(patch).sum();
            assert!((found / expected - 1.0).abs() < 2e-3, "{found}, not {expected}, of {rectangle:?}");
            assert!((rectangle.solid_angle / expected - 1.0).abs() < 2e-3);
        }
    }

    #[test]
    fn the_density_of_a_sample_is_that_of_its_point() {
        for rectangle in rectangles() {
            for u in squares().step_by(37) {
                let (point, pdf) = rectangle.sample(u);
                assert!((rectangle.pdf(point) / pdf - 1.0).abs() < 1e-6, "{u:?}: {pdf}, not {}", rectangle.pdf(point));
            }
        }
    }

    #[test]
    fn samples_of_extreme_shapes_lie_on_the_rectangle() {
        let cosine = ReceiverCosine::Front(DVec3::Z);
        let mut found = 0;
        for scale in [1e-9, 1.0, 1e9] {
            for height in [1e-12, 1e-6, 1e-3, 0.1, 1.0] {
                for [width, depth] in [[1e-6, 1.0], [1e-3, 1e3], [1.0, 1.0], [1e4, 1e-2], [1e6, 1e6]] {
                    for [left, front] in [[-0.5, -0.5], [0.0, 0.0], [-1.0, 0.0], [2.0, -0.3], [-0.999_999, -1.5]] {
                        let corner = dvec3(left * width, front * depth, height) * scale;
                        let sides = [dvec3(width, 0.0, 0.0), dvec3(0.0, depth, 0.0)].map(|side| side * scale);
                        let Some(rectangle) = SphericalRectangle::new(corner, sides, &cosine) else { continue };
                        found += 1;
                        for u in [0.0, 1e-12, 0.3, 0.5, 0.999_999, 1.0 - f64::EPSILON] {
                            for v in [0.0, 1e-12, 0.5, 1.0 - f64::EPSILON] {
                                let (point, pdf) = rectangle.sample([u, v]);
                                let at = (point - corner) / scale;
                                let is_inside = (-1e-9 * width..=(1.0 + 1e-9) * width).contains(&at.x)
                                    && (-1e-9 * depth..=(1.0 + 1e-9) * depth).contains(&at.y);
                                assert!(is_inside && pdf > 0.0 && pdf.is_finite(), "{point} {pdf} of {rectangle:?}");
                                let again = rectangle.pdf(point);
                                assert!(again > 0.0 && again.is_finite(), "{again} at {point} of {rectangle:?}");
                            }
                        }
                    }
                }
            }
        }
        assert!(found > 100, "{found} shapes are large enough");
    }

    #[test]
    fn a_facing_surface_receives_nearly_the_same_from_all_samples() {
        let cosine = ReceiverCosine::Front(dvec3(0.0, -0.6, 0.8));
        let sides = [dvec3(1.0, 0.0, 0.0), dvec3(0.0, 1.0, 0.0)];
        let rectangle = SphericalRectangle::new(dvec3(-0.3, -0.6, 0.8), sides, &cosine).expect("it is large");
        let spread = |sample: &dyn Fn([f64; 2]) -> (DVec3, f64)| {
            let given: Vec<f64> = squares()
                .map(|u| {
                    let (point, pdf) = sample(u);
                    cosine.of(point.normalize()) / pdf
                })
                .collect();
            let mean = given.iter().sum::<f64>() / given.len() as f64;
            let squares = given.iter().map(|value| (value / mean - 1.0).powi(2)).sum::<f64>();
            (squares / given.len() as f64).sqrt()
        };
        let by_area = |[u, v]: [f64; 2]| {
            let point = dvec3(-0.3 + u, -0.6 + v, 0.8);
            (point, point.length().powi(3) / point.z)
        };
        let [by_solid_angle, by_area] = [spread(&|u| rectangle.sample(u)), spread(&by_area)];
        assert!(by_solid_angle < 0.2 * by_area, "{by_solid_angle}, and {by_area} by area");
    }
}
