//! A model of the emitters around a record.
//!
//! Irradiance varies nonlinearly near its source: below a bright patch it has a maximum, which a
//! plane through neighbouring records misses. The hit points of the rays predict this. A few hits
//! represent all of a record ([`Emitters`](crate::emitter::Emitters)), and those of all neighbours
//! together are a model of the irradiance around a record, in which each point emitter of radiance L
//! and area A contributes
//!
//! `E(x) = L A cos θ cos θ' / r²`
//!
//! with θ and θ' the angles between the connecting line and the surface normals at x and at the
//! emitter, and r its length. The model ignores occlusion. It is a control variate: only its
//! changes are used, and the records are fitted to the remainder.

use crate::emitter::{COUNT, Emitter};
use crate::record::Record;
use glam::DVec3;

/// Maximum number of points of a model.
const CAPACITY: usize = 64;

/// Minimum cosine: the contribution of a hit at a grazing angle would change without bounds.
const MIN_COSINE: f32 = 0.05;

/// Fraction of the squared radius of the neighbourhood that is added to squared distances: closer
/// emitters vary faster than neighbouring records can resolve.
const SOFTENING: f32 = 0.09;

/// Number of partial sums, for vector instructions.
const LANES: usize = 8;

/// The variation of the irradiance around a record, due to the emitters of all its neighbours.
///
/// Single-precision arrays, in radii of the neighbourhood relative to the record: the loops over
/// the points compile to vector instructions.
#[derive(Debug)]
pub(crate) struct EmitterModel<const BANDS: usize> {
    origin: DVec3,
    radius: f64,
    count: usize,
    /// Position and normal, coordinate by coordinate.
    position: [[f32; CAPACITY]; 3],
    normal: [[f32; CAPACITY]; 3],
    /// 1 for an emitter at a position, 0 for one at infinity.
    is_near: [f32; CAPACITY],
    /// 1 for an emitter that radiates equally in all directions, 0 for others.
    faces_all: [f32; CAPACITY],
    /// Contribution to the irradiance divided by the form factor, band by band.
    strength: [[f32; CAPACITY]; BANDS],
}

/// The change of the irradiance around a point, to second order, along two tangents x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Change {
    pub(crate) slope: [f64; 2],
    /// Second derivatives: xx, yy, xy.
    pub(crate) curvature: [f64; 3],
}

impl<const BANDS: usize> EmitterModel<BANDS> {
    /// A model without emitters.
    pub(crate) fn none(origin: DVec3, radius: f64) -> Self {
        let none = [0.0; CAPACITY];
        EmitterModel {
            origin,
            radius,
            count: 0,
            position: [none; 3],
            normal: [none; 3],
            is_near: none,
            faces_all: none,
            strength: [none; BANDS],
        }
    }

    /// The model around a position, from records with weights that sum to 1; `radius` is that of
    /// the neighbourhood.
    pub(crate) fn new<'r>(
        origin: DVec3,
        records: impl ExactSizeIterator<Item = (&'r Record<BANDS>, f64)>,
        radius: f64,
    ) -> Self {
        let mut model = Self::none(origin, radius);
        // The same number of points from each record, so that all fit.
        let kept = (CAPACITY / records.len().max(1)).clamp(1, COUNT);
        for (index, (record, weight)) in records.enumerate() {
            if !record.emitters.is_known || model.count + kept > CAPACITY {
                continue;
            }
            let first = model.count;
            for slot in 0..kept {
                let point = &record.emitters.points[(index * kept + slot * COUNT / kept) % COUNT];
                model.push(point, weight * COUNT as f64 / kept as f64);
            }
            let factors = model.form_factors(record.position, record.normal);
            for band in &mut model.strength {
                let kept = first..model.count;
                band[kept.clone()].iter_mut().zip(&factors[kept]).for_each(|(band, factor)| *band /= factor);
            }
        }
        model
    }

    fn push(&mut self, point: &Emitter<BANDS>, weight: f64) {
        let position = if point.is_distant { point.position } else { (point.position - self.origin) / self.radius };
        for axis in 0..3 {
            self.position[axis][self.count] = position[axis] as f32;
            self.normal[axis][self.count] = point.normal[axis] as f32;
        }
        self.is_near[self.count] = if point.is_distant { 0.0 } else { 1.0 };
        self.faces_all[self.count] = if point.normal == DVec3::ZERO { 1.0 } else { 0.0 };
        for (strengths, band) in self.strength.iter_mut().zip(point.irradiance) {
            strengths[self.count] = band * weight as f32;
        }
        self.count += 1;
    }

    /// The relative contribution of each emitter at a point of a surface with this unit normal.
    fn form_factors(&self, position: DVec3, normal: DVec3) -> [f32; CAPACITY] {
        let position = ((position - self.origin) / self.radius).as_vec3().to_array();
        let normal = normal.as_vec3().to_array();
        let mut factors = [0.0; CAPACITY];
        for (point, factor) in factors.iter_mut().enumerate() {
            let (mut squared, mut received, mut emitted) = (SOFTENING * self.is_near[point], 0.0, 0.0);
            for axis in 0..3 {
                let offset = self.position[axis][point] - position[axis] * self.is_near[point];
                squared += offset * offset;
                received += offset * normal[axis];
                emitted -= offset * self.normal[axis][point];
            }
            let length = squared.sqrt();
            let least = MIN_COSINE * length;
            let emitted = emitted.max(least.max(self.faces_all[point] * length));
            *factor = received.max(least) * emitted / (squared * squared).max(f32::MIN_POSITIVE);
        }
        factors
    }

    /// The irradiance at a point of a surface with this unit normal.
    pub(crate) fn irradiance(&self, position: DVec3, normal: DVec3) -> [f64; BANDS] {
        if self.count == 0 {
            return [0.0; BANDS];
        }
        let factors = self.form_factors(position, normal);
        std::array::from_fn(|band| {
            let mut sums = [0.0; LANES];
            for (strengths, factors) in self.strength[band].chunks_exact(LANES).zip(factors.chunks_exact(LANES)) {
                sums.iter_mut().zip(strengths.iter().zip(factors)).for_each(|(sum, (one, two))| *sum += one * two);
            }
            f64::from(sums.iter().sum::<f32>())
        })
    }

    /// The change around a point, by finite differences with a `step` along two tangents.
    pub(crate) fn change(&self, position: DVec3, [x, y, normal]: [DVec3; 3], step: f64) -> [Change; BANDS] {
        let at = |along: f64, across: f64| self.irradiance(position + x * (along * step) + y * (across * step), normal);
        let [center, right, left, up, down, aslant] =
            [(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (1.0, 1.0)].map(|(x, y)| at(x, y));
        std::array::from_fn(|band| {
            let (here, squared) = (center[band], step * step);
            Change {
                slope: [(right[band] - left[band]) / (2.0 * step), (up[band] - down[band]) / (2.0 * step)],
                curvature: [
                    (right[band] + left[band] - 2.0 * here) / squared,
                    (up[band] + down[band] - 2.0 * here) / squared,
                    (aslant[band] - right[band] - up[band] + here) / squared,
                ],
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{GatherHit, GatheredRadiance, Hemisphere, Limits};

    const LIMITS: Limits = Limits { accuracy: 0.2, min_reach: 1e-3, max_reach: 10.0, explained: 1.0 };

    /// A record at a point of the plane z = 0 below a small lamp at height 2 that emits downwards.
    fn below_lamp(position: DVec3) -> (Record<1>, f64) {
        let lamp = DVec3::new(0.0, 0.0, 2.0);
        let offset = lamp - position;
        let distance = offset.length();
        let cosine = offset.z / distance;
        let irradiance = cosine * cosine / (distance * distance);
        let hemisphere = Hemisphere::with_divisions(12);
        let seen = vec![GatheredRadiance { radiance: [0.0], distance }; hemisphere.len()];
        let hit =
            GatherHit { direction: offset / distance, distance, normal: Some(-DVec3::Z), irradiance: [irradiance] };
        let record = Record::new(position, DVec3::Z, &hemisphere, &seen, &LIMITS).with_hits(&[hit], 0.5);
        (record, irradiance)
    }

    #[test]
    fn emitters_follow_the_inverse_square_law() {
        let (record, here) = below_lamp(DVec3::ZERO);
        let model = EmitterModel::new(DVec3::ZERO, [(&record, 1.0)].into_iter(), 0.05);
        for x in [0.0, 0.3, 0.7] {
            let [found] = model.irradiance(DVec3::new(x, 0.0, 0.0), DVec3::Z);
            let expected = below_lamp(DVec3::new(x, 0.0, 0.0)).1;
            assert!((found / expected - 1.0).abs() < 2e-3, "{found} at {x}, expected {expected}");
        }
        let [change] = model.change(DVec3::ZERO, [DVec3::X, DVec3::Y, DVec3::Z], 0.05);
        // E = h²/(h² + x²)² has the second derivative -4/h⁴ at x = 0.
        let [xx, yy, xy] = change.curvature;
        assert!((xx + 0.25).abs() < 5e-3 && (yy + 0.25).abs() < 5e-3 && xy.abs() < 5e-3, "{change:?}");
        assert!((here - 0.25).abs() < 1e-12 && change.slope.iter().all(|slope| slope.abs() < 1e-4), "{change:?}");
    }
}
