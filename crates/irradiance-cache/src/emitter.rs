//! A model of the emitters around a record, as a few points.
//!
//! Irradiance varies nonlinearly near its source: below a bright patch it has a maximum, which a
//! plane through neighbouring records misses. The hit points of the rays predict this. A few hits
//! represent all of a record ([`Emitters`]), and those of all neighbours together are a model of
//! the irradiance around a record ([`EmitterModel`]), in which each point emitter of radiance L and
//! area A contributes
//!
//! `E(x) = L A cos θ cos θ' / r²`
//!
//! with θ and θ' the angles between the connecting line and the surface normals at x and at the
//! emitter, and r its length. The model ignores occlusion. It is a control variate: only its
//! changes are used, and the records are fitted to the remainder.

use crate::record::{Record, mean};
use crate::stored::store_fields;
use glam::DVec3;

/// The hit of one gather ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GatherHit<const BANDS: usize> {
    /// Unit, from the record's position to the hit.
    pub direction: DVec3,
    /// Distance to the hit; infinite for the sky.
    pub distance: f64,
    /// Unit geometric normal of the hit, on the side of the record; `None` if unknown.
    pub normal: Option<DVec3>,
    /// The ray's contribution to the irradiance.
    pub irradiance: [f64; BANDS],
}

/// If the sky gets a smaller fraction of the rays than this, it is seen through portals.
const MAX_SKY_FRACTION: f64 = 0.3;

/// A portal lies in the plane of the adjacent surface, unless that plane is this many times as far
/// away as the surface.
const MAX_PORTAL_RATIO: f64 = 3.0;

impl<const BANDS: usize> GatherHit<BANDS> {
    /// The light of the sky through a portal varies with position as if the portal emitted it. The
    /// portal lies approximately in the plane of the nearest adjacent hit. `None` if the ray does
    /// not hit the sky or there is no such plane.
    fn through_portal(&self, hits: &[GatherHit<BANDS>]) -> Option<GatherHit<BANDS>> {
        if self.distance.is_finite() {
            return None;
        }
        let walls = hits.iter().filter(|hit| hit.distance.is_finite() && hit.normal.is_some());
        let nearness = |hit: &&GatherHit<BANDS>| hit.direction.dot(self.direction);
        let with_ungathered = walls.max_by(|one, two| nearness(one).total_cmp(&nearness(two)))?;
        let normal = with_ungathered.normal?;
        let distance = with_ungathered.distance * with_ungathered.direction.dot(normal) / self.direction.dot(normal);
        let is_before = self.direction.dot(normal) < 0.0 && distance < MAX_PORTAL_RATIO * with_ungathered.distance;
        is_before.then_some(GatherHit { distance, normal: Some(normal), ..*self })
    }
}

/// Points that represent all hits of a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Emitters<const BANDS: usize> {
    points: [Emitter<BANDS>; COUNT],
    /// Whether the points are known; either none or all of them are.
    is_known: bool,
}

/// A point emitter around a record.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Emitter<const BANDS: usize> {
    /// The emitter's position, or the unit direction towards an emitter at infinity.
    position: DVec3,
    is_distant: bool,
    /// Zero if the emitter radiates equally in all directions.
    normal: DVec3,
    /// Its contribution to the irradiance of its record.
    irradiance: [f32; BANDS],
}

store_fields!(Emitters: points, is_known);
store_fields!(Emitter: position, is_distant, normal, irradiance);

/// Number of points per record.
const COUNT: usize = 8;

/// Maximum number of points of a model.
const CAPACITY: usize = 64;

/// Minimum cosine: the contribution of a hit at a grazing angle would change without bounds.
const MIN_COSINE: f32 = 0.05;

/// Fraction of the squared radius of the neighbourhood that is added to squared distances: closer
/// emitters vary faster than neighbouring records can resolve.
const SOFTENING: f32 = 0.09;

/// Number of partial sums, for vector instructions.
const LANES: usize = 8;

impl<const BANDS: usize> Emitters<BANDS> {
    /// No points.
    pub(crate) const UNKNOWN: Self = Emitters {
        points: [Emitter { position: DVec3::ZERO, is_distant: false, normal: DVec3::ZERO, irradiance: [0.0; BANDS] };
            COUNT],
        is_known: false,
    };

    /// Selects points that represent these hits by systematic resampling: in equal steps of their
    /// contributions, starting at an `offset` of 0…1.
    pub(crate) fn new(position: DVec3, hits: &[GatherHit<BANDS>], offset: f64) -> Self {
        let total: f64 = hits.iter().map(|hit| mean(&hit.irradiance)).sum();
        let step = total / COUNT as f64;
        if !(step > 0.0 && step.is_finite()) {
            return Self::UNKNOWN;
        }
        let mut emitters = Emitters { is_known: true, ..Self::UNKNOWN };
        let distant = hits.iter().filter(|hit| !hit.distance.is_finite()).count();
        let is_enclosed = (distant as f64) < MAX_SKY_FRACTION * hits.len() as f64;
        let (mut chosen, mut sum) = (0, 0.0);
        for hit in hits {
            let contribution = mean(&hit.irradiance);
            sum += contribution;
            while chosen < COUNT && (chosen as f64 + offset) * step < sum {
                let through = if is_enclosed { hit.through_portal(hits) } else { None };
                emitters.points[chosen] = Emitter::new(position, &through.unwrap_or(*hit), step / contribution);
                chosen += 1;
            }
        }
        // Rounding may place the last step just beyond the sum.
        emitters.is_known = chosen == COUNT;
        emitters
    }

    /// Whether all numbers are finite.
    pub(crate) fn is_finite(&self) -> bool {
        let is_finite = |point: &Emitter<BANDS>| {
            point.position.is_finite()
                && point.normal.is_finite()
                && point.irradiance.iter().all(|band| band.is_finite())
        };
        self.points.iter().all(is_finite)
    }

    /// Merges the points of further rays from the same position, which contribute this fraction of
    /// all light so far.
    pub(crate) fn add(&mut self, other: &Self, share: f64, seed: f64) {
        if !other.is_known || !self.is_known {
            if other.is_known {
                *self = *other;
            }
            return;
        }
        for (slot, (point, other)) in self.points.iter_mut().zip(&other.points).enumerate() {
            if (GOLDEN_RATIO * (slot as f64 + 1.0) + seed).fract() < share {
                *point = *other;
            }
        }
    }
}

/// Multiples of the golden ratio are distributed evenly modulo 1.
const GOLDEN_RATIO: f64 = 0.618_033_988_749_895;

impl<const BANDS: usize> Emitter<BANDS> {
    fn new(position: DVec3, hit: &GatherHit<BANDS>, share: f64) -> Self {
        let is_distant = !hit.distance.is_finite();
        Emitter {
            position: if is_distant { hit.direction } else { position + hit.direction * hit.distance },
            is_distant,
            normal: hit.normal.unwrap_or(DVec3::ZERO),
            irradiance: hit.irradiance.map(|band| (band * share) as f32),
        }
    }
}

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
    use crate::{GatheredRadiance, Hemisphere, Limits};

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

    #[test]
    fn selected_hits_keep_the_irradiance_of_all() {
        let hit = |index: i32| {
            let direction = DVec3::new(f64::from(index) - 50.0, 10.0, 40.0).normalize();
            GatherHit { direction, distance: 3.0, normal: None, irradiance: [f64::from(index % 7), 1.0, 0.0] }
        };
        let hits: Vec<GatherHit<3>> = (0..100).map(hit).collect();
        for step in 0..10 {
            let emitters = Emitters::new(DVec3::ZERO, &hits, f64::from(step) / 10.0);
            let total = |hits: &[GatherHit<3>]| hits.iter().map(|hit| mean(&hit.irradiance)).sum::<f64>();
            let kept: f64 = emitters.points.iter().map(|point| mean(&point.irradiance.map(f64::from))).sum();
            assert!(emitters.is_known && (kept / total(&hits) - 1.0).abs() < 1e-5, "{kept}");
        }
        assert_eq!(Emitters::new(DVec3::ZERO, &[], 0.5), Emitters::<3>::UNKNOWN);
        let dark = GatherHit { irradiance: [0.0; 3], ..hits[0] };
        assert_eq!(Emitters::new(DVec3::ZERO, &[dark], 0.5), Emitters::UNKNOWN);
    }

    #[test]
    fn a_portal_lies_in_the_plane_of_the_wall() {
        let toward = |x: f64, z: f64| DVec3::new(x, 2.0, z).normalize();
        let wall = |x: f64, z: f64| {
            let direction = toward(x, z);
            GatherHit { direction, distance: 2.0 / direction.y, normal: Some(-DVec3::Y), irradiance: [0.0] }
        };
        let sky = |x: f64, z: f64| GatherHit {
            direction: toward(x, z),
            distance: f64::INFINITY,
            normal: None,
            irradiance: [1.0],
        };
        let mut hits: Vec<GatherHit<1>> = (-4..=4).map(|x| wall(0.5 * f64::from(x), 0.2)).collect();
        hits.push(sky(0.1, 0.5));
        let through = hits[9].through_portal(&hits).expect("a wall is beside the hole");
        assert!((through.distance * through.direction.y - 2.0).abs() < 1e-9 && through.normal == Some(-DVec3::Y));
        assert!(hits[0].through_portal(&hits).is_none(), "a wall is not a portal");
        // Mostly sky: it is at infinity.
        let open: Vec<_> = hits[..2].iter().copied().chain((0..9).map(|x| sky(0.1 * f64::from(x), 1.0))).collect();
        assert!(Emitters::new(DVec3::ZERO, &open, 0.5).points.iter().all(|point| point.is_distant));
        assert!(Emitters::new(DVec3::ZERO, &hits, 0.5).points.iter().all(|point| !point.is_distant));
    }
}
