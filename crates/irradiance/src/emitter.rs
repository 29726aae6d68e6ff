//! Where the light comes from that a record's rays found, in a few points.
//!
//! Irradiance bends where its source is near: under a bright patch it is a dome, which a plane through neighbouring records
//! misses. What the rays hit says how it bends. A few hits stand for all of them ([`Emitters`]), and those of all
//! neighbours together are a model of the irradiance around a record ([`EmitterModel`]), in which each point emitter of
//! radiance L and area A contributes
//!
//! `E(x) = L A cos θ cos θ' / r²`
//!
//! with θ and θ' the angles of the way to the surface normals at x and at the emitter, and r its length. The model knows
//! nothing of occlusion. It serves as a control variate: only its changes are used, and the records are fitted to what
//! remains.

use crate::record::mean;
use glam::DVec3;

/// What one ray from the place of a record found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit<const BANDS: usize> {
    /// Unit, from the place to what was hit.
    pub direction: DVec3,
    /// Length of the way; infinite where it leads to the sky.
    pub distance: f64,
    /// Unit geometric normal of what was hit, turned to the place; `None` where that is not known.
    pub normal: Option<DVec3>,
    /// What the ray contributes to the irradiance.
    pub irradiance: [f64; BANDS],
}

/// Points that stand for all hits of a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Emitters<const BANDS: usize> {
    points: [Emitter<BANDS>; COUNT],
    /// Either none of the points or all of them.
    is_known: bool,
}

/// A point that contributes to the irradiance around it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Emitter<const BANDS: usize> {
    /// Its position, or the unit direction towards it where it is at infinity.
    place: DVec3,
    is_distant: bool,
    /// Zero where the emitter faces every point alike.
    normal: DVec3,
    /// What it contributes to the irradiance of its record.
    irradiance: [f32; BANDS],
}

/// So many points stand for the hits of a record.
const COUNT: usize = 8;

/// A model of a neighbourhood has about so many points.
const POINTS_OF_A_MODEL: usize = 96;

/// Cosines below this count as this: a hit at a grazing angle would change without bounds.
const LEAST_COSINE: f64 = 0.05;

/// Distances are lengthened, in squares, by this share of the radius of the neighbourhood: nearer emitters change more than
/// neighbouring records can tell.
const SOFTENING: f64 = 0.3;

impl<const BANDS: usize> Emitters<BANDS> {
    /// None.
    pub(crate) const UNKNOWN: Self = Emitters {
        points: [Emitter {
            place: DVec3::ZERO,
            is_distant: false,
            normal: DVec3::ZERO,
            irradiance: [0.0; BANDS],
        }; COUNT],
        is_known: false,
    };

    /// Chooses points that stand for these hits, by systematic resampling: in equal steps of their contributions, from an
    /// `offset` of 0…1 on.
    pub(crate) fn new(position: DVec3, hits: &[Hit<BANDS>], offset: f64) -> Self {
        let total: f64 = hits.iter().map(|hit| mean(&hit.irradiance)).sum();
        let step = total / COUNT as f64;
        if !(step > 0.0 && step.is_finite()) {
            return Self::UNKNOWN;
        }
        let mut emitters = Emitters { is_known: true, ..Self::UNKNOWN };
        let (mut chosen, mut sum) = (0, 0.0);
        for hit in hits {
            let contribution = mean(&hit.irradiance);
            sum += contribution;
            while chosen < COUNT && (chosen as f64 + offset) * step < sum {
                emitters.points[chosen] = Emitter::new(position, hit, step / contribution);
                chosen += 1;
            }
        }
        // Rounding may leave the last step just beyond the sum.
        emitters.is_known = chosen == COUNT;
        emitters
    }

    /// Takes in those of further rays from the same place, which have this share in all light found by now.
    pub(crate) fn add(&mut self, other: &Self, share: f64, seed: f64) {
        if !other.is_known || !self.is_known {
            if other.is_known {
                *self = *other;
            }
            return;
        }
        for (slot, (point, other)) in self.points.iter_mut().zip(&other.points).enumerate() {
            if (GOLDEN * (slot as f64 + 1.0) + seed).fract() < share {
                *point = *other;
            }
        }
    }
}

/// Steps of the golden section are spread evenly.
const GOLDEN: f64 = 0.618_033_988_749_895;

impl<const BANDS: usize> Emitter<BANDS> {
    fn new(position: DVec3, hit: &Hit<BANDS>, share: f64) -> Self {
        let is_distant = !hit.distance.is_finite();
        Emitter {
            place: if is_distant { hit.direction } else { position + hit.direction * hit.distance },
            is_distant,
            normal: hit.normal.unwrap_or(DVec3::ZERO),
            irradiance: hit.irradiance.map(|band| (band * share) as f32),
        }
    }

    /// What it contributes at a point of a surface with this unit normal is in proportion to this; lengths below `softening`
    /// (squared) make no difference.
    fn form_factor(&self, position: DVec3, normal: DVec3, softening: f64) -> f64 {
        if self.is_distant {
            return normal.dot(self.place).max(LEAST_COSINE);
        }
        let way = self.place - position;
        let squared = way.length_squared() + softening;
        let least = LEAST_COSINE * squared.sqrt();
        let received = normal.dot(way).max(least);
        let emitted = if self.normal == DVec3::ZERO { squared.sqrt() } else { (-self.normal.dot(way)).max(least) };
        received * emitted / (squared * squared)
    }
}

/// How the irradiance changes around a record, by the emitters of all its neighbours.
#[derive(Debug)]
pub(crate) struct EmitterModel<const BANDS: usize> {
    points: Vec<Emitter<BANDS>>,
    softening: f64,
}

/// The change of the irradiance around a point, to second order, in two tangents x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Change {
    pub(crate) slope: [f64; 2],
    /// Second derivatives: xx, yy, xy.
    pub(crate) curvature: [f64; 3],
}

impl<const BANDS: usize> EmitterModel<BANDS> {
    /// From records at positions with unit normals, and the weight of each, which sum to 1; `radius` is that of the
    /// neighbourhood.
    pub(crate) fn new<'r>(
        records: impl ExactSizeIterator<Item = (&'r Emitters<BANDS>, DVec3, DVec3, f64)>,
        radius: f64,
    ) -> Self {
        let softening = (SOFTENING * radius).powi(2);
        let stride = (records.len() * COUNT).div_ceil(POINTS_OF_A_MODEL).min(COUNT);
        let mut points = Vec::with_capacity(POINTS_OF_A_MODEL + COUNT);
        for (index, (emitters, position, normal, weight)) in records.enumerate() {
            if !emitters.is_known {
                continue;
            }
            let first = index % stride;
            let count = (COUNT - first).div_ceil(stride);
            let share = weight * COUNT as f64 / count as f64;
            for point in emitters.points[first..].iter().step_by(stride) {
                let scale = share / point.form_factor(position, normal, softening);
                let irradiance = point.irradiance.map(|band| (f64::from(band) * scale) as f32);
                points.push(Emitter { irradiance, ..*point });
            }
        }
        EmitterModel { points, softening }
    }

    /// The irradiance at a point of a surface with this unit normal.
    pub(crate) fn irradiance(&self, position: DVec3, normal: DVec3) -> [f64; BANDS] {
        let mut sum = [0.0; BANDS];
        for point in &self.points {
            let factor = point.form_factor(position, normal, self.softening);
            for (sum, band) in sum.iter_mut().zip(point.irradiance) {
                *sum += factor * f64::from(band);
            }
        }
        sum
    }

    /// How it changes around a point, by differences over a length `step` along two tangents.
    pub(crate) fn change(&self, position: DVec3, [x, y, normal]: [DVec3; 3], step: f64) -> [Change; BANDS] {
        let at = |along: f64, across: f64| {
            self.irradiance(position + x * (along * step) + y * (across * step), normal)
        };
        let [middle, right, left, up, down, aslant] =
            [(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (1.0, 1.0)].map(|(x, y)| at(x, y));
        std::array::from_fn(|band| {
            let (here, squared) = (middle[band], step * step);
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
