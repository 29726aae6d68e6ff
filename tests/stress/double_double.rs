//! Numbers of twice the precision, each a sum of two (Dekker, "A floating-point technique for
//! extending the available precision", Numerische Mathematik 18, 1971), and reference intersections
//! computed with them.

use glam::DVec3;
use std::ops::{Add, Mul, Neg, Sub};

/// About 32 digits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Double {
    high: f64,
    low: f64,
}

impl Double {
    pub(crate) const ZERO: Double = Double { high: 0.0, low: 0.0 };

    pub(crate) fn value(self) -> f64 {
        self.high + self.low
    }

    pub(crate) fn sqrt(self) -> Double {
        if self.high <= 0.0 {
            return Double::ZERO;
        }
        // One step of Newton's method from the root of the leading part.
        let root = Double::from(self.high.sqrt());
        let rest = (self - root * root).value();
        root + Double::from(rest / (2.0 * root.high))
    }

    pub(crate) fn over(self, by: Double) -> Double {
        let first = Double::from(self.high / by.high);
        let rest = self - first * by;
        let second = Double::from(rest.high / by.high);
        let rest = rest - second * by;
        first + second + Double::from(rest.high / by.high)
    }

    fn sum(a: f64, b: f64) -> Double {
        let high = a + b;
        let of_b = high - a;
        Double { high, low: (a - (high - of_b)) + (b - of_b) }
    }
}

impl From<f64> for Double {
    fn from(high: f64) -> Double {
        Double { high, low: 0.0 }
    }
}

impl Add for Double {
    type Output = Double;

    fn add(self, other: Double) -> Double {
        let sum = Double::sum(self.high, other.high);
        let low = Double::sum(self.low, other.low);
        let sum = Double::sum(sum.high, sum.low + low.high);
        Double::sum(sum.high, sum.low + low.low)
    }
}

impl Neg for Double {
    type Output = Double;

    fn neg(self) -> Double {
        Double { high: -self.high, low: -self.low }
    }
}

impl Sub for Double {
    type Output = Double;

    fn sub(self, other: Double) -> Double {
        self + -other
    }
}

impl Mul for Double {
    type Output = Double;

    fn mul(self, other: Double) -> Double {
        let high = self.high * other.high;
        let low = self.high.mul_add(other.high, -high);
        Double::sum(high, low + (self.high * other.low + self.low * other.high))
    }
}

pub(crate) type Vector = [Double; 3];

pub(crate) fn vector(from: DVec3) -> Vector {
    from.to_array().map(Double::from)
}

pub(crate) fn minus(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

pub(crate) fn dot(a: Vector, b: Vector) -> Double {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Distance to a triangle, including its edges, along a direction of approximately unit length.
pub(crate) fn to_triangle(corners: [DVec3; 3], origin: DVec3, direction: DVec3) -> Option<f64> {
    let (origin, direction) = (vector(origin), vector(direction));
    let [a, b, c] = corners.map(|corner| minus(vector(corner), origin));
    let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| dot(direction, cross(from, to)).value());
    let is_inside = sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0);
    let normal = cross(minus(b, a), minus(c, a));
    let slope = dot(normal, direction);
    let distance = dot(normal, a).over(slope).value();
    (is_inside && slope.value() != 0.0 && distance > 0.0).then_some(distance)
}

/// Distances to a sphere, the nearer one first, along a direction of any length.
pub(crate) fn to_sphere(center: DVec3, radius: f64, origin: DVec3, direction: DVec3) -> Option<[f64; 2]> {
    let (direction, offset) = (vector(direction), minus(vector(origin), vector(center)));
    let [a, b, c] = [dot(direction, direction), dot(direction, offset), dot(offset, offset)];
    let radius = Double::from(radius);
    let discriminant = b * b - a * (c - radius * radius);
    let root = discriminant.sqrt();
    (discriminant.value() >= 0.0).then(|| [(-b - root).over(a).value(), (-b + root).over(a).value()])
}

#[test]
fn thirty_digits_are_kept() {
    let third = Double::from(1.0).over(Double::from(3.0));
    assert!((third * Double::from(3.0) - Double::from(1.0)).value().abs() < 1e-31);
    let root = Double::from(2.0).sqrt();
    assert!((root * root - Double::from(2.0)).value().abs() < 1e-30);
    assert_eq!((Double::from(1e16) + Double::from(1.0) - Double::from(1e16)).value(), 1.0);
}
