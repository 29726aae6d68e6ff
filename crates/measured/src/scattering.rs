//! A scattering function of a BSDF: the reflection of one side, or the transmission.

use crate::Side;
use crate::matrix::{Matrix, Patches};
use crate::resolution::{Resolution, Way};
use crate::tensor::Tensor;
use glam::DVec3;
use std::f64::consts::FRAC_1_PI;

/// Scattering without the Lambertian part.
///
/// Reflection is of one side. Transmission covers light incident on one side and, by reciprocity,
/// on the other side.
#[derive(Debug)]
pub struct Scattering {
    data: Data,
    incident: Side,
    exit: Side,
    /// Lambertian part that was split off, 1/sr.
    lambertian: [f64; 3],
    least_projected_solid_angle: f64,
    largest_total: f64,
}

#[derive(Debug)]
pub(crate) enum Data {
    Matrix(Matrix),
    Tensor(Box<Tensor>),
}

/// A sampled direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Unit vector away from the surface.
    pub direction: DVec3,
    /// Value times |cos θ| over the density: red, green, blue.
    pub weight: [f64; 3],
    /// Density by solid angle, 1/sr.
    pub density: f64,
}

/// A pair of directions in the data's convention, projected onto the surface: the incident one
/// points along the light.
struct Pair {
    incident: [f64; 2],
    exit: [f64; 2],
    way: Way,
}

impl Pair {
    fn given(&self) -> [f64; 2] {
        match self.way {
            Way::Forward => self.incident,
            Way::Backward => self.exit,
        }
    }
}

impl Scattering {
    /// `diffuse` is the Lambertian part that was split off, as a reflectance.
    pub(crate) fn new(data: Data, diffuse: [f64; 3], incident: Side, exit: Side) -> Scattering {
        let lambertian = diffuse.map(|band| band * FRAC_1_PI);
        let (least_projected_solid_angle, largest_total) = match &data {
            Data::Matrix(matrix) => (matrix.least_projected_solid_angle(), matrix.largest_total()),
            Data::Tensor(tensor) => (tensor.least_projected_solid_angle(), tensor.largest_total()),
        };
        Scattering { data, incident, exit, lambertian, least_projected_solid_angle, largest_total }
    }

    /// Whether red, green and blue are equal for all directions.
    #[must_use]
    pub fn is_grey(&self) -> bool {
        match &self.data {
            Data::Matrix(matrix) => matrix.is_grey(),
            Data::Tensor(tensor) => tensor.is_grey(),
        }
    }

    /// Projected solid angle of the smallest cell, sr.
    #[must_use]
    pub fn least_projected_solid_angle(&self) -> f64 {
        self.least_projected_solid_angle
    }

    /// Largest scattered fraction of light over all directions, without the Lambertian part.
    #[must_use]
    pub fn largest_total(&self) -> f64 {
        self.largest_total
    }

    /// Values between all patches for light incident on a side, with the Lambertian part; `None`
    /// for tensor trees.
    #[must_use]
    pub fn patches(&self, arriving: Side) -> Option<Patches> {
        let way = if arriving == self.incident { Way::Forward } else { Way::Backward };
        match &self.data {
            Data::Matrix(matrix) => Some(matrix.patches(way, self.lambertian)),
            Data::Tensor(_) => None,
        }
    }

    /// Value for two directions in red, green and blue, 1/sr; zero for sides that the function does
    /// not cover.
    #[must_use]
    pub fn value(&self, given: DVec3, other: DVec3) -> [f64; 3] {
        let Some(pair) = self.pair(given, other) else { return [0.0; 3] };
        match self.whole_color(&pair) {
            None => [self.pair_luminance(&pair); 3],
            Some(whole) => std::array::from_fn(|band| (whole[band] - self.lambertian[band]).max(0.0)),
        }
    }

    /// Value with the Lambertian part, 1/sr.
    pub(crate) fn whole(&self, given: DVec3, other: DVec3) -> [f64; 3] {
        let Some(pair) = self.pair(given, other) else { return self.lambertian };
        let grey = || self.lambertian.map(|band| band + self.pair_luminance(&pair));
        self.whole_color(&pair).unwrap_or_else(grey)
    }

    fn whole_color(&self, pair: &Pair) -> Option<[f64; 3]> {
        match &self.data {
            Data::Matrix(matrix) => matrix.whole_color(pair.incident, pair.exit),
            Data::Tensor(tensor) => tensor.whole_color(pair.incident, pair.exit),
        }
    }

    /// Luminance of [`Scattering::value`], 1/sr.
    #[must_use]
    pub fn luminance(&self, given: DVec3, other: DVec3) -> f64 {
        self.pair(given, other).map_or(0.0, |pair| self.pair_luminance(&pair))
    }

    /// Index of the cell of a pair of directions; the value is constant in a cell.
    #[must_use]
    pub fn cell(&self, given: DVec3, other: DVec3) -> Option<usize> {
        let pair = self.pair(given, other)?;
        match &self.data {
            Data::Matrix(matrix) => matrix.cell(pair.incident, pair.exit),
            Data::Tensor(tensor) => tensor.cell(pair.incident, pair.exit),
        }
    }

    /// Projected solid angle of the cell of a pair of directions, sr.
    #[must_use]
    pub fn projected_solid_angle(&self, given: DVec3, other: DVec3) -> Option<f64> {
        let pair = self.pair(given, other)?;
        match &self.data {
            Data::Matrix(matrix) => matrix.projected_solid_angle(pair.incident, pair.exit),
            Data::Tensor(tensor) => tensor.projected_solid_angle(pair.incident, pair.exit),
        }
    }

    /// Angular resolution near a direction.
    #[must_use]
    pub fn resolution(&self, given: DVec3) -> Option<Resolution> {
        let (way, point) = self.given(given)?;
        match &self.data {
            // The mirror direction is resolved by the other basis.
            Data::Matrix(matrix) if self.incident == self.exit => {
                let other = matrix.resolution(Way::Backward, [-point[0], -point[1]]);
                let own = matrix.resolution(way, point);
                own.zip(other).map(|(a, b)| a.with(b)).or(own)
            }
            Data::Matrix(matrix) => matrix.resolution(way, point),
            Data::Tensor(tensor) => tensor.resolution(way, point),
        }
    }

    /// Scattered fraction of light from a direction (luminance), without the Lambertian part.
    #[must_use]
    pub fn total(&self, given: DVec3) -> f64 {
        let Some((way, point)) = self.given(given) else { return 0.0 };
        match &self.data {
            Data::Matrix(matrix) => matrix.total(way, point),
            Data::Tensor(tensor) => tensor.total(way, point),
        }
    }

    /// Samples the other direction in proportion to luminance times |cos θ|, from two numbers in
    /// [0,1). None if nothing is scattered.
    #[must_use]
    pub fn sample(&self, given: DVec3, u: [f64; 2]) -> Option<Sample> {
        let (way, point) = self.given(given)?;
        let sampled = match &self.data {
            Data::Matrix(matrix) => matrix.sample(way, point, u),
            Data::Tensor(tensor) => tensor.sample(way, point, u),
        }?;
        let direction = self.direction(way, sampled);
        let density = self.density(given, direction);
        if density <= 0.0 {
            return None;
        }
        let scale = direction.z.abs() / density;
        let weight = self.value(given, direction).map(|band| band * scale);
        Some(Sample { direction, weight, density })
    }

    /// Density of [`Scattering::sample`], 1/sr.
    #[must_use]
    pub fn density(&self, given: DVec3, other: DVec3) -> f64 {
        let Some(pair) = self.pair(given, other) else { return 0.0 };
        let value = self.pair_luminance(&pair);
        let projected = match &self.data {
            Data::Matrix(matrix) => {
                let total = matrix.total(pair.way, pair.given());
                if total > 0.0 { value / total } else { 0.0 }
            }
            Data::Tensor(tensor) => tensor.density(pair.way, pair.given(), value),
        };
        projected * other.z.abs()
    }

    fn pair_luminance(&self, pair: &Pair) -> f64 {
        match &self.data {
            Data::Matrix(matrix) => matrix.value(pair.incident, pair.exit),
            Data::Tensor(tensor) => tensor.value(pair.incident, pair.exit),
        }
    }

    fn given(&self, given: DVec3) -> Option<(Way, [f64; 2])> {
        let side = Side::of(given);
        if side == self.incident {
            Some((Way::Forward, [-given.x, -given.y]))
        } else if side == self.exit {
            Some((Way::Backward, [given.x, given.y]))
        } else {
            None
        }
    }

    fn pair(&self, given: DVec3, other: DVec3) -> Option<Pair> {
        let (way, point) = self.given(given)?;
        match way {
            Way::Forward if Side::of(other) == self.exit => {
                Some(Pair { incident: point, exit: [other.x, other.y], way })
            }
            Way::Backward if Side::of(other) == self.incident => {
                Some(Pair { incident: [-other.x, -other.y], exit: point, way })
            }
            _ => None,
        }
    }

    /// Direction of a sampled point of the disk.
    fn direction(&self, way: Way, [x, y]: [f64; 2]) -> DVec3 {
        let (sign, side) = match way {
            Way::Forward => (1.0, self.exit),
            Way::Backward => (-1.0, self.incident),
        };
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        // At the horizon the sign of z must still determine the side.
        let z = z.max(1e-9);
        DVec3::new(sign * x, sign * y, if side == Side::Front { z } else { -z }).normalize()
    }
}
