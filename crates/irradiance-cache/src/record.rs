//! What the rays around one point tell of its irradiance.

use crate::emitter::{Emitters, GatherHit};
use crate::fit::Fit;
use crate::gradient::Gradients;
use crate::hemisphere::{GatheredRadiance, Hemisphere};
use crate::stored::store_fields;
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
    /// Neighbours disagree where they miss their plane by more than this share of the squared noise that their rays tell explains, 0…1. Rays know nothing of
    /// how evenly those of neighbours look together and so tell several times too much: less than 1 finds weaker bends, for more records.
    pub explained: f64,
}

/// The irradiance of one point, as its own rays tell it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record<const BANDS: usize> {
    pub(crate) position: DVec3,
    /// Unit.
    pub(crate) normal: DVec3,
    pub(crate) irradiance: [f64; BANDS],
    pub(crate) gradients: Gradients<BANDS>,
    /// Where it comes from.
    pub(crate) emitters: Emitters<BANDS>,
    /// The distance at which the irradiance may have changed by as much as itself.
    pub(crate) scale: f64,
    /// The least reach of this record.
    least: f64,
    /// Rays that looked around.
    pub(crate) rays: f64,
    /// Of the irradiance averaged over the bands, from the differences of neighbouring cells.
    pub(crate) variance: f64,
    /// Irradiance that comes otherwise, averaged over the bands.
    pub(crate) otherwise: f64,
}

store_fields!(Record: position, normal, irradiance, gradients, emitters, scale, least, rays, variance, otherwise);

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
        seen: &[GatheredRadiance<BANDS>],
        limits: &Limits,
    ) -> Self {
        assert_eq!(seen.len(), hemisphere.len(), "one observation a cell");
        let count = seen.len() as f64;
        let mut irradiance = [0.0; BANDS];
        let mut nearness = 0.0;
        let mut squares = 0.0;
        let mut before = mean(&seen[seen.len() - 1].radiance);
        for cell in seen {
            for (sum, radiance) in irradiance.iter_mut().zip(cell.radiance) {
                *sum += radiance * PI / count;
            }
            nearness += 1.0 / cell.distance.max(f64::MIN_POSITIVE) / count;
            let here = mean(&cell.radiance);
            squares += (here - before).powi(2);
            before = here;
        }
        let frame = Record::<BANDS>::frame(normal);
        let local = Gradients::new(hemisphere, seen);
        let to_world = |local: DVec3| frame[0] * local.x + frame[1] * local.y;
        let mut record = Record {
            position,
            normal,
            irradiance,
            gradients: Gradients {
                rotation: local.rotation.map(to_world),
                translation: local.translation.map(to_world),
            },
            emitters: Emitters::UNKNOWN,
            scale: 1.0 / nearness.max(f64::MIN_POSITIVE),
            least: limits.least,
            rays: count,
            variance: 0.5 * squares * (PI / count).powi(2),
            otherwise: 0.0,
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

    /// The irradiance of the place itself, on a facet that is turned to this unit normal.
    #[must_use]
    pub fn irradiance_on(&self, facet: DVec3) -> [f64; BANDS] {
        Fit::of(self).at(self, self.position, facet)
    }

    /// The same where so many rays have looked, not one a cell.
    #[must_use]
    pub fn resting_on(self, rays: usize) -> Self {
        Record { rays: rays as f64, ..self }
    }

    /// The same where so much irradiance, averaged over the bands, comes from elsewhere: from lights that rays do not look for. Beside it what is
    /// gathered need not be as exact.
    #[must_use]
    pub fn beside(self, otherwise: f64) -> Self {
        Record { otherwise, ..self }
    }

    /// The same where it is known what all rays hit, in the order of their directions; `offset` of 0…1 chooses the hits that
    /// are kept.
    #[must_use]
    pub fn with_hits(self, hits: &[GatherHit<BANDS>], offset: f64) -> Self {
        Record { emitters: Emitters::new(self.position, hits, offset), ..self }
    }

    /// Rays that looked around.
    #[must_use]
    pub fn rays(&self) -> f64 {
        self.rays
    }

    /// Takes in what further rays from the same place tell.
    pub(crate) fn add(&mut self, other: &Record<BANDS>) {
        let share = other.rays / (self.rays + other.rays);
        let scalar = |own: &mut f64, other: f64| *own += (other - *own) * share;
        let vector = |own: &mut DVec3, other: DVec3| *own += (other - *own) * share;
        let [before, further] = [mean(&self.irradiance) * self.rays, mean(&other.irradiance) * other.rays];
        self.emitters.add(&other.emitters, further / (before + further).max(f64::MIN_POSITIVE), self.rays + other.rays);
        for band in 0..BANDS {
            scalar(&mut self.irradiance[band], other.irradiance[band]);
            vector(&mut self.gradients.rotation[band], other.gradients.rotation[band]);
            vector(&mut self.gradients.translation[band], other.gradients.translation[band]);
        }
        scalar(&mut self.otherwise, other.otherwise);
        self.variance = self.variance * (1.0 - share).powi(2) + other.variance * share.powi(2);
        self.scale = self.scale.min(other.scale);
        self.rays += other.rays;
    }

    /// The scale stays within its limits; where it is raised to the least one, the gradient, which says too much, is lowered as much. A gradient that
    /// changes the irradiance by more than itself within the scale is noise.
    fn bound(&mut self, limits: &Limits) {
        let least = self.least / limits.accuracy;
        if self.scale < least {
            let share = self.scale / least;
            self.gradients.translation = self.gradients.translation.map(|gradient| gradient * share);
            self.scale = least;
        }
        self.scale = self.scale.min(limits.most / limits.accuracy);
        let slope = self.gradients.translation.iter().map(|gradient| gradient.length()).sum::<f64>() / BANDS as f64;
        let share = STEEPEST * mean(&self.irradiance) / (slope * self.scale).max(f64::MIN_POSITIVE);
        if share < 1.0 {
            self.gradients.translation = self.gradients.translation.map(|gradient| gradient * share);
        }
    }

    /// Whether a record that was saved is one that could have been made: finite, and with a reach within the limits.
    pub(crate) fn is_usable(&self, limits: &Limits) -> bool {
        let Gradients { rotation, translation } = &self.gradients;
        let numbers = [self.rays, self.variance, self.otherwise, self.least];
        let is_finite = self.position.is_finite()
            && self.normal.is_normalized()
            && self.irradiance.iter().chain(&numbers).all(|number| number.is_finite() && *number >= 0.0)
            && rotation.iter().chain(translation).all(|gradient| gradient.is_finite())
            && self.emitters.is_finite();
        // NaN is in no range.
        let reach = self.reach(limits) / limits.most;
        is_finite && self.rays > 0.0 && self.scale > 0.0 && (0.0..=1.0 + ROUNDING).contains(&reach)
    }

    /// The same for a cache of other limits.
    pub(crate) fn within(self, limits: &Limits) -> Self {
        let least = self.least.max(limits.least).min(limits.most);
        let scale = self.scale.min(limits.most / limits.accuracy).max(least / limits.accuracy);
        Record { least, scale, ..self }
    }

    /// How far the record reaches.
    pub(crate) fn reach(&self, limits: &Limits) -> f64 {
        limits.accuracy * self.scale
    }

    /// How badly a point is placed to use this record, where `reach` is how far one may be away: one and more is too bad.
    pub(crate) fn misplacement(&self, position: DVec3, normal: DVec3, reach: f64, accuracy: f64) -> f64 {
        let offset = position - self.position;
        let distance = offset.length() / reach;
        if distance >= 1.0 {
            return distance;
        }
        // Half of the squared chord is one minus the cosine.
        let turn = (0.5 * normal.distance_squared(self.normal)).sqrt() / (TURN * accuracy).min(1.0);
        // A point behind the record may see what the record cannot.
        let behind = -0.5 * offset.dot(normal + self.normal) / (BEHIND * reach);
        distance.max(turn).max(behind)
    }

    /// No record may be trusted further than a neighbour's trust and the way to it: something near that one of them saw the
    /// other may have missed.
    pub(crate) fn restrain(&mut self, other: &Record<BANDS>, accuracy: f64) {
        let bound = other.scale + self.position.distance(other.position);
        self.shorten(bound, accuracy);
    }

    /// Trusts the record less far, but not less than its limit.
    pub(crate) fn shorten(&mut self, scale: f64, accuracy: f64) {
        self.scale = self.scale.min(scale.max(self.least / accuracy));
    }
}

/// The mean of the bands.
pub(crate) fn mean<const BANDS: usize>(bands: &[f64; BANDS]) -> f64 {
    bands.iter().sum::<f64>() / BANDS as f64
}

/// A reach at its limit may be larger by so much, as a share.
const ROUNDING: f64 = 1e-9;

/// How many times itself the irradiance may change within the scale.
const STEEPEST: f64 = 2.0;

/// A turn counts as much as a move by this share of the reach.
const TURN: f64 = 2.5;

/// How far behind a record a point may be, as a share of its reach.
const BEHIND: f64 = 0.2;
