//! The irradiance of one point, and how far it may be trusted.

use crate::gradient::Gradients;
use crate::hemisphere::{Gathered, Hemisphere};
use glam::DVec3;
use std::f64::consts::PI;

/// What bounds the use of records.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Error that interpolation aims at, as a share (Radiance's `-aa`).
    pub accuracy: f64,
    /// A record is trusted at least this far, a length.
    pub least: f64,
    /// And at most this far.
    pub most: f64,
}

/// The irradiance of one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record<const BANDS: usize> {
    pub(crate) position: DVec3,
    /// Unit.
    pub(crate) normal: DVec3,
    pub(crate) irradiance: [f64; BANDS],
    rotation: [DVec3; BANDS],
    translation: [DVec3; BANDS],
    /// The distance at which the irradiance may have changed by as much as itself.
    pub(crate) scale: f64,
}

impl<const BANDS: usize> Record<BANDS> {
    /// Makes a record from what is seen in each cell of the hemisphere over a unit `normal`, whose local frame is that of
    /// [`Record::frame`].
    ///
    /// # Panics
    /// If there is not one observation a cell.
    #[must_use]
    pub fn new(
        position: DVec3,
        normal: DVec3,
        hemisphere: &Hemisphere,
        seen: &[Gathered<BANDS>],
        limits: &Limits,
    ) -> Self {
        assert_eq!(seen.len(), hemisphere.len(), "one observation a cell");
        let count = seen.len() as f64;
        let mut irradiance = [0.0; BANDS];
        let mut nearness = 0.0;
        for cell in seen {
            for (sum, radiance) in irradiance.iter_mut().zip(cell.radiance) {
                *sum += radiance * PI / count;
            }
            nearness += 1.0 / cell.distance.max(f64::MIN_POSITIVE) / count;
        }
        let frame = Record::<BANDS>::frame(normal);
        let gradients = Gradients::new(hemisphere, seen);
        let to_world = |local: DVec3| frame[0] * local.x + frame[1] * local.y;
        let mut record = Record {
            position,
            normal,
            irradiance,
            rotation: gradients.rotation.map(to_world),
            translation: gradients.translation.map(to_world),
            scale: 1.0 / nearness.max(f64::MIN_POSITIVE),
        };
        record.bound(limits);
        record
    }

    /// The frame in which a record looks around: two unit tangents, and the unit normal.
    #[must_use]
    pub fn frame(normal: DVec3) -> [DVec3; 3] {
        let (x, y) = normal.any_orthonormal_pair();
        [x, y, normal]
    }

    /// A gradient may not change the irradiance by more than itself within the scale, and the scale stays within its limits;
    /// where it is raised to the least one, the gradient, which says too much, is lowered as much.
    fn bound(&mut self, limits: &Limits) {
        let strength = self.strength();
        let slope = self.translation.iter().map(|gradient| gradient.length()).sum::<f64>() / BANDS as f64;
        if slope * self.scale > strength {
            self.scale = strength / slope;
        }
        let least = limits.least / limits.accuracy;
        if self.scale < least {
            let share = self.scale / least;
            self.translation = self.translation.map(|gradient| gradient * share);
            self.scale = least;
        }
        self.scale = self.scale.min(limits.most / limits.accuracy);
    }

    /// Irradiance averaged over the bands.
    fn strength(&self) -> f64 {
        self.irradiance.iter().sum::<f64>() / BANDS as f64
    }

    /// How far the record reaches.
    pub(crate) fn reach(&self, limits: &Limits) -> f64 {
        limits.accuracy * self.scale
    }

    /// The estimated error at a point, as a share of what the limits allow: one and more is too much.
    pub(crate) fn error(&self, position: DVec3, normal: DVec3, limits: &Limits) -> f64 {
        let offset = position - self.position;
        let distance = offset.length() / self.reach(limits);
        if distance >= 1.0 {
            return distance;
        }
        // Half of the squared chord is one minus the cosine.
        let turn = (0.5 * normal.distance_squared(self.normal)).sqrt() / (TURN * limits.accuracy).min(1.0);
        // A point behind the record may see what the record cannot.
        let behind = -0.5 * offset.dot(normal + self.normal) / (BEHIND * self.reach(limits));
        distance.max(turn).max(behind)
    }

    /// The irradiance moved and turned to a point.
    pub(crate) fn at(&self, position: DVec3, normal: DVec3) -> [f64; BANDS] {
        let offset = position - self.position;
        let turn = self.normal.cross(normal);
        std::array::from_fn(|band| {
            let change = turn.dot(self.rotation[band]) + offset.dot(self.translation[band]);
            (self.irradiance[band] + change).max(0.0)
        })
    }

    /// The irradiance of the place itself, on a facet that is turned to this unit normal.
    #[must_use]
    pub fn irradiance_on(&self, facet: DVec3) -> [f64; BANDS] {
        self.at(self.position, facet)
    }

    /// No record may be trusted further than a neighbour's trust and the way to it: something near that one of them saw the
    /// other may have missed.
    pub(crate) fn restrain(&mut self, other: &Record<BANDS>) {
        let bound = other.scale + self.position.distance(other.position);
        self.scale = self.scale.min(bound);
    }
}

/// A turn counts as much as a move by this share of the reach.
const TURN: f64 = 2.5;

/// How far behind a record a point may be, as a share of its reach.
const BEHIND: f64 = 0.2;
