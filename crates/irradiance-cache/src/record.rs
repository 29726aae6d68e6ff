//! The irradiance of one point, from its gather rays.

use crate::bands::mean;
use crate::emitter::{Emitters, GatherHit};
use crate::gradient::{Gradients, rotation};
use crate::hemisphere::{GatheredRadiance, Hemisphere};
use crate::obstacles::{Obstacles, Occluders};
use crate::stored::store_fields;
use glam::DVec3;
use std::f64::consts::PI;

/// Limits for the use of records.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Target of the relative interpolation error (Radiance's `-aa`).
    pub accuracy: f64,
    /// Minimum reach of a record, a length.
    pub min_reach: f64,
    /// Maximum reach of a record, a length.
    pub max_reach: f64,
    /// Fraction of the variance estimated from rays that is subtracted from squared residuals, 0…1.
    /// The estimate ignores stratification across neighbours and is several times too high, so
    /// values below 1 find weaker nonlinearity, at the cost of more records.
    pub explained: f64,
}

/// The irradiance of one point, from its own rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record<const BANDS: usize> {
    pub(crate) position: DVec3,
    /// Unit.
    pub(crate) normal: DVec3,
    pub(crate) irradiance: [f64; BANDS],
    pub(crate) gradients: Gradients<BANDS>,
    /// The emitters around it.
    pub(crate) emitters: Emitters<BANDS>,
    /// What stands on the surface around it.
    obstacles: Obstacles,
    /// The distance at which the irradiance may change by 100 %.
    pub(crate) scale: f64,
    /// The minimum reach of this record.
    min_reach: f64,
    /// Number of rays.
    pub(crate) rays: f64,
    /// Of the irradiance averaged over the bands, from the differences between neighbouring cells.
    pub(crate) variance: f64,
    /// Irradiance that is not gathered, averaged over the bands.
    pub(crate) ungathered: f64,
}

store_fields!(
    Record: position,
    normal,
    irradiance,
    gradients,
    emitters,
    obstacles,
    scale,
    min_reach,
    rays,
    variance,
    ungathered
);

impl<const BANDS: usize> Record<BANDS> {
    /// Makes a record from the gathered radiance of each cell of the hemisphere over a unit
    /// `normal`, in the local frame of [`Record::frame`].
    ///
    /// # Panics
    /// If there is not one value per cell.
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
            gradients: Gradients { translation: local.translation.map(to_world), ..local },
            emitters: Emitters::UNKNOWN,
            obstacles: Obstacles::NONE,
            scale: 1.0 / nearness.max(f64::MIN_POSITIVE),
            min_reach: limits.min_reach,
            rays: count,
            variance: 0.5 * squares * (PI / count).powi(2),
            ungathered: 0.0,
        };
        record.bound(limits);
        record
    }

    /// The local frame of a record: two unit tangents, and the unit normal.
    #[must_use]
    pub fn frame(normal: DVec3) -> [DVec3; 3] {
        let (x, y) = normal.any_orthonormal_pair();
        [x, y, normal]
    }

    /// The same record with this number of rays, if it differs from one per cell.
    #[must_use]
    pub fn with_rays(self, rays: usize) -> Self {
        Record { rays: rays as f64, ..self }
    }

    /// The same record with irradiance from elsewhere, averaged over the bands: from lights that
    /// gather rays ignore. The gathered irradiance can be less accurate relative to it.
    #[must_use]
    pub fn with_ungathered(self, ungathered: f64) -> Self {
        Record { ungathered, ..self }
    }

    /// The same record with the hits of all rays, in the order of their directions, from which the
    /// irradiance for other normals follows; `offset` of 0…1 selects the hits that are kept.
    #[must_use]
    pub fn with_hits(self, hits: &[GatherHit<BANDS>], offset: f64) -> Self {
        let emitters = Emitters::new(self.position, hits, offset);
        let obstacles = Obstacles::new(Record::<BANDS>::frame(self.normal), hits);
        let gradients = Gradients { rotation: rotation(self.normal, hits), ..self.gradients };
        Record { emitters, obstacles, gradients, ..self }
    }

    /// Number of rays.
    #[must_use]
    pub fn rays(&self) -> f64 {
        self.rays
    }

    /// Adds the result of further rays from the same position.
    pub(crate) fn add(&mut self, other: &Record<BANDS>) {
        let share = other.rays / (self.rays + other.rays);
        let scalar = |own: &mut f64, other: f64| *own += (other - *own) * share;
        let vector = |own: &mut DVec3, other: DVec3| *own += (other - *own) * share;
        let [before, further] = [mean(&self.irradiance) * self.rays, mean(&other.irradiance) * other.rays];
        self.emitters.add(&other.emitters, further / (before + further).max(f64::MIN_POSITIVE), self.rays + other.rays);
        self.obstacles.add(&other.obstacles);
        for band in 0..BANDS {
            scalar(&mut self.irradiance[band], other.irradiance[band]);
            vector(&mut self.gradients.rotation[band], other.gradients.rotation[band]);
            vector(&mut self.gradients.translation[band], other.gradients.translation[band]);
        }
        scalar(&mut self.ungathered, other.ungathered);
        self.variance = self.variance * (1.0 - share).powi(2) + other.variance * share.powi(2);
        self.scale = self.scale.min(other.scale);
        self.rays += other.rays;
    }

    /// Limits the scale. Where it is raised to the minimum, the overestimated gradient is reduced
    /// in proportion. A gradient that changes the irradiance by more than 100 % within the scale is
    /// noise.
    fn bound(&mut self, limits: &Limits) {
        let min_reach = self.min_reach / limits.accuracy;
        if self.scale < min_reach {
            let share = self.scale / min_reach;
            self.gradients.translation = self.gradients.translation.map(|gradient| gradient * share);
            self.scale = min_reach;
        }
        self.scale = self.scale.min(limits.max_reach / limits.accuracy);
        let slope = self.gradients.translation.iter().map(|gradient| gradient.length()).sum::<f64>() / BANDS as f64;
        let share = MAX_RELATIVE_GRADIENT * mean(&self.irradiance) / (slope * self.scale).max(f64::MIN_POSITIVE);
        if share < 1.0 {
            self.gradients.translation = self.gradients.translation.map(|gradient| gradient * share);
        }
    }

    /// Whether a restored record is possible: finite, and with a reach within the limits.
    pub(crate) fn is_usable(&self, limits: &Limits) -> bool {
        let Gradients { rotation, translation } = &self.gradients;
        let numbers = [self.rays, self.variance, self.ungathered, self.min_reach];
        let is_finite = self.position.is_finite()
            && self.normal.is_normalized()
            && self.irradiance.iter().chain(&numbers).all(|number| number.is_finite() && *number >= 0.0)
            && rotation.iter().chain(translation).all(|gradient| gradient.is_finite())
            && self.emitters.is_finite()
            && self.obstacles.is_usable();
        // NaN is in no range.
        let reach = self.reach(limits) / limits.max_reach;
        is_finite && self.rays > 0.0 && self.scale > 0.0 && (0.0..=1.0 + ROUNDING).contains(&reach)
    }

    /// The same record for a cache with other limits.
    pub(crate) fn within(self, limits: &Limits) -> Self {
        let min_reach = self.min_reach.max(limits.min_reach).min(limits.max_reach);
        let scale = self.scale.min(limits.max_reach / limits.accuracy).max(min_reach / limits.accuracy);
        Record { min_reach, scale, ..self }
    }

    /// The reach of the record.
    pub(crate) fn reach(&self, limits: &Limits) -> f64 {
        limits.accuracy * self.scale
    }

    /// The interpolation error of a point relative to its limit, where `reach` is the maximum
    /// distance: from 1 on, the record is not used.
    pub(crate) fn relative_error(&self, position: DVec3, normal: DVec3, reach: f64, accuracy: f64) -> f64 {
        let offset = position - self.position;
        let distance = offset.length() / reach;
        if distance >= 1.0 {
            return distance;
        }
        // Half of the squared chord is one minus the cosine.
        let turn = (0.5 * normal.distance_squared(self.normal)).sqrt() / (ROTATION_WEIGHT * accuracy).min(1.0);
        // A point behind the record may see what the record cannot see.
        let behind = -0.5 * offset.dot(normal + self.normal) / (MAX_DEPTH_BEHIND * reach);
        distance.max(turn).max(behind)
    }

    /// Whether something stands between the record and a point of a surface with this normal.
    pub(crate) fn is_hidden_from(&self, position: DVec3, normal: DVec3, occluders: &dyn Occluders) -> bool {
        self.may_be_hidden_from(position) && occluders.separate(position, normal, self.position)
            || self.is_on_another_level(position, normal, occluders)
    }

    /// Whether the record and a point lie at different heights, and something covers the lower one: the
    /// surface of the other, as a panel before a wall. Points of one sphere or cylinder have the same
    /// height along their mean normal.
    pub(crate) fn is_on_another_level(&self, position: DVec3, normal: DVec3, occluders: &dyn Occluders) -> bool {
        let offset = self.position - position;
        let height = 0.5 * offset.dot(normal + self.normal);
        let covered = MEASURED_HEIGHT * height.abs();
        match height / offset.length() {
            LEAST_SLOPE.. => occluders.cover(position, normal, covered),
            ..=LEAST_DESCENT => occluders.cover(self.position, self.normal, covered),
            _ => false,
        }
    }

    /// Whether something may stand between the record and a point of the surface.
    pub(crate) fn may_be_hidden_from(&self, position: DVec3) -> bool {
        let offset = position - self.position;
        let [x, y, _] = Record::<BANDS>::frame(self.normal);
        self.obstacles.may_hide(offset.dot(x), offset.dot(y))
    }

    /// Neighbour clamping: the reach of a record is at most that of a neighbour plus the distance
    /// between them, since it may have missed nearby geometry that the neighbour saw.
    pub(crate) fn clamp_to_neighbour(&mut self, other: &Record<BANDS>, accuracy: f64) {
        let bound = other.scale + self.position.distance(other.position);
        self.reduce_scale(bound, accuracy);
    }

    /// Reduces the reach of the record, down to its limit.
    pub(crate) fn reduce_scale(&mut self, scale: f64, accuracy: f64) {
        self.scale = self.scale.min(scale.max(self.min_reach / accuracy));
    }
}

/// Relative rounding tolerance of a reach at its limit.
const ROUNDING: f64 = 1e-9;

/// Maximum relative change of the irradiance within the scale.
const MAX_RELATIVE_GRADIENT: f64 = 2.0;

/// Slope between two points, relative to their mean normal, from which they may lie on different
/// levels.
const LEAST_SLOPE: f64 = 1e-3;
const LEAST_DESCENT: f64 = -LEAST_SLOPE;

/// The height up to which a point must not be covered, relative to that of the other: its own surface
/// counts.
const MEASURED_HEIGHT: f64 = 1.01;

/// Error of a rotation relative to that of a translation by this fraction of the reach.
const ROTATION_WEIGHT: f64 = 2.5;

/// Maximum distance of a point behind a record, relative to its reach.
const MAX_DEPTH_BEHIND: f64 = 0.2;
