//! `cube_corner`: sheeting of corner prisms, by ray optics.
//!
//! | parameter | meaning | unit | range |
//! |---|---|---|---|
//! | backing | `air`: total reflection; `metal`: coated faces | | |
//! | index | refractive index of the prisms | 1 | 1.3…2.2 |
//! | dihedral error | excess of the angles between faces over 90° | rad | −0.002…0.002 |
//! | spread s | rms width of a spot in each of two directions | rad | 0.0005…0.05 |
//!
//! For each direction the prism is traced: refraction at the front, the three faces in each of six
//! orders, refraction out. The fraction of the light in each order is the area of the front through
//! which rays of that order enter and leave again (after Eckhardt, "Simple Model of Corner
//! Reflector Phenomena", Applied Optics 10(7), 1971). Half of the prisms are rotated by 180°, as in
//! sheeting. Each spot is a Gaussian, whose width accounts for scratches, waviness and diffraction.
//! The azimuth of the pattern is that of the frame's x axis. The model is reciprocal and conserves
//! energy.

mod corner;
mod polygon;

pub use corner::Faces;

use crate::radial::direction_near;
use corner::{BEAMS, Beam, CubeCorner};
use glam::DVec3;
use std::borrow::Borrow;
use std::f64::consts::TAU;

/// Sheeting of cube corners.
#[derive(Clone, Debug)]
pub struct CubeCornerSheeting {
    corner: CubeCorner,
    /// κ = 1/s²: a spot is `κ/2π exp(−κ |x|²/2)` in the distance x of directions.
    sharpness: f64,
    /// Largest distance of a spot from the incident direction: it is 1e-17 of its peak there.
    reach: f64,
    /// Probability of sampling spots that are [`TAIL_WIDTH`] times as wide.
    tail_share: f64,
}

/// Centres of the spots from which light comes, and the probabilities of choosing them.
pub(crate) type Spots = [(DVec3, f64); 2 * BEAMS];

/// Probability of a beam without light, times the number of beams: keeps the density positive next
/// to the limits of beams.
const LEAST_SHARE: f64 = 1e-3;
/// Standard deviations at which a spot ends.
const SPOT_END: f64 = 9.0;
/// Width of the wide spots. Where the prisms stop returning light, only the tails of the spots
/// contribute.
const TAIL_WIDTH: f64 = 2.5;

impl CubeCornerSheeting {
    /// Prisms of this index with dihedral angles of 90° plus `dihedral_error` (radians), and spots
    /// of rms width `spread` (radians).
    #[must_use]
    pub fn new(index: f64, dihedral_error: f64, spread: f64, faces: Faces) -> CubeCornerSheeting {
        // Deviations are 3.27 n ε at normal incidence and grow with obliqueness.
        let reach = 20.0 * index * dihedral_error.abs() + SPOT_END * spread;
        let corner = CubeCorner::new(index, dihedral_error, faces);
        CubeCornerSheeting { corner, sharpness: 1.0 / (spread * spread), reach, tail_share: 0.0 }
    }

    /// The same sheeting, sampled from wider spots with this probability (0…1): less noise where
    /// almost no light returns.
    #[must_use]
    pub fn with_tail(self, tail_share: f64) -> CubeCornerSheeting {
        CubeCornerSheeting { tail_share, ..self }
    }

    /// Value of a spot at this distance from its centre, 1/sr.
    fn spot(&self, distance: DVec3) -> f64 {
        spot(self.sharpness, distance)
    }

    fn is_far(&self, outgoing: DVec3, incident: DVec3) -> bool {
        outgoing.z <= 0.0 || incident.z <= 0.0 || (outgoing - incident).length() > self.reach
    }

    /// f, 1/sr. Symmetric in both directions: beams come in pairs of opposite deviation, for
    /// opposite orders of the faces.
    #[must_use]
    pub fn value(&self, outgoing: DVec3, incident: DVec3) -> f64 {
        if self.is_far(outgoing, incident) {
            return 0.0;
        }
        let between = outgoing - incident;
        let beams = self.corner.beams((outgoing + incident).normalize());
        let sum: f64 = beams
            .iter()
            .map(|beam| beam.share * (self.spot(between - beam.deviation) + self.spot(between + beam.deviation)))
            .sum();
        sum / outgoing.z.max(incident.z)
    }

    /// Density of [`CubeCornerSheeting::sample`], 1/sr.
    #[must_use]
    pub fn pdf(&self, outgoing: DVec3, incident: DVec3) -> f64 {
        self.pdf_among(outgoing, incident, || self.targets(outgoing))
    }

    /// The same, with the spots computed only if they are needed.
    pub(crate) fn pdf_among<S: Borrow<Spots>>(
        &self,
        outgoing: DVec3,
        incident: DVec3,
        spots: impl FnOnce() -> S,
    ) -> f64 {
        if self.is_far(outgoing, incident) { 0.0 } else { self.density(spots().borrow(), incident) }
    }

    /// Samples an incident direction; none if the light is absorbed. `u` is uniform in [0, 1)³, the
    /// third number chooses a spot.
    #[must_use]
    pub fn sample(&self, outgoing: DVec3, u: [f64; 3]) -> Option<DVec3> {
        if outgoing.z <= 0.0 { None } else { self.sample_among(outgoing, &self.targets(outgoing), u) }
    }

    /// The same for known spots.
    pub(crate) fn sample_among(&self, outgoing: DVec3, targets: &Spots, u: [f64; 3]) -> Option<DVec3> {
        let mut left = u[2];
        let chosen = targets.iter().find(|(_, probability)| {
            left -= probability;
            left < 0.0
        });
        let (middle, probability) = *chosen.unwrap_or(&targets[0]);
        let in_tail = 1.0 + left / probability < self.tail_share;
        let sharpness = if in_tail { self.sharpness / (TAIL_WIDTH * TAIL_WIDTH) } else { self.sharpness };
        // 1 − cos δ is exponential: with |x|² = 2 (1 − cos δ) that is the spot's density on the
        // sphere.
        let fall = -(1.0 - u[0]).ln() / sharpness;
        if fall >= 2.0 {
            return None;
        }
        let incident = direction_near(middle, 2.0 * (0.5 * fall).sqrt().asin(), TAU * u[1]);
        (!self.is_far(outgoing, incident)).then_some(incident)
    }

    /// Centres of the spots of light seen from `outgoing`, and the probabilities of choosing them.
    pub(crate) fn targets(&self, outgoing: DVec3) -> Spots {
        let beams = self.corner.beams(outgoing);
        let total: f64 = beams.iter().map(|beam| 2.0 * (beam.share + LEAST_SHARE)).sum();
        std::array::from_fn(|index| {
            let Beam { deviation, share } = beams[index / 2];
            let sign = if index % 2 == 0 { 1.0 } else { -1.0 };
            ((outgoing - deviation * sign).normalize(), (share + LEAST_SHARE) / total)
        })
    }

    fn density(&self, targets: &[(DVec3, f64)], incident: DVec3) -> f64 {
        let value = |distance: DVec3| {
            if self.tail_share == 0.0 {
                return self.spot(distance);
            }
            let tail = spot(self.sharpness / (TAIL_WIDTH * TAIL_WIDTH), distance);
            self.tail_share * tail + (1.0 - self.tail_share) * self.spot(distance)
        };
        targets.iter().map(|(middle, probability)| probability * value(incident - *middle)).sum::<f64>()
    }
}

fn spot(sharpness: f64, distance: DVec3) -> f64 {
    sharpness / TAU * (-0.5 * sharpness * distance.length_squared()).exp()
}
