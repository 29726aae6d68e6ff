//! The emitters around a record, as a few points: those that represent the hits of all its rays.

use crate::bands::mean;
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
    pub(crate) points: [Emitter<BANDS>; COUNT],
    /// Whether the points are known; either none or all of them are.
    pub(crate) is_known: bool,
}

/// A point emitter around a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Emitter<const BANDS: usize> {
    /// The emitter's position, or the unit direction towards an emitter at infinity.
    pub(crate) position: DVec3,
    pub(crate) is_distant: bool,
    /// Zero if the emitter radiates equally in all directions.
    pub(crate) normal: DVec3,
    /// Its contribution to the irradiance of its record.
    pub(crate) irradiance: [f32; BANDS],
}

store_fields!(Emitters: points, is_known);
store_fields!(Emitter: position, is_distant, normal, irradiance);

/// Number of points per record.
pub(crate) const COUNT: usize = 8;

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

#[cfg(test)]
mod tests {
    use super::*;

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
