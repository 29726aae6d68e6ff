//! Stratification of the hemisphere over a point.

use glam::DVec3;
use std::f64::consts::PI;

/// A hemisphere divided into cells of equal projected solid angle: rings of equal width in `sin²θ`,
/// each divided into the same number of azimuths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hemisphere {
    pub(crate) rings: usize,
    pub(crate) azimuths: usize,
}

/// The result of a gather ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GatheredRadiance<const BANDS: usize> {
    /// Incident radiance.
    pub radiance: [f64; BANDS],
    /// Distance to the hit; infinite for none.
    pub distance: f64,
}

impl Hemisphere {
    /// About `count` cells, approximately square (`azimuths ≈ π · rings`); at least twelve.
    #[must_use]
    pub fn with_divisions(count: usize) -> Hemisphere {
        let rings = ((count as f64 / PI).sqrt().round() as usize).max(2);
        let azimuths = (count as f64 / rings as f64).round() as usize;
        Hemisphere { rings, azimuths: azimuths.max(6) }
    }

    /// Number of cells.
    #[must_use]
    #[expect(clippy::len_without_is_empty, reason = "there are always cells")]
    pub fn len(&self) -> usize {
        self.rings * self.azimuths
    }

    /// The unit direction at `within` (both coordinates 0…1) of a cell, +z along the normal; cells
    /// of one ring are consecutive. Uniform `within` give the pdf `cos θ/π`.
    #[must_use]
    pub fn direction(&self, cell: usize, within: [f64; 2]) -> DVec3 {
        let (ring, azimuth) = (cell / self.azimuths, cell % self.azimuths);
        let sine_squared = (ring as f64 + within[0]) / self.rings as f64;
        let angle = 2.0 * PI * (azimuth as f64 + within[1]) / self.azimuths as f64;
        let (sin, cos) = angle.sin_cos();
        let sine = sine_squared.sqrt();
        DVec3::new(sine * cos, sine * sin, (1.0 - sine_squared).max(0.0).sqrt())
    }

    /// The cell that contains a unit direction, +z along the normal.
    #[must_use]
    pub fn cell(&self, direction: DVec3) -> usize {
        let sine_squared = 1.0 - direction.z * direction.z;
        let angle = direction.y.atan2(direction.x);
        let turn = if angle < 0.0 { angle + 2.0 * PI } else { angle } / (2.0 * PI);
        let within = |share: f64, count: usize| ((share * count as f64) as usize).min(count - 1);
        within(sine_squared, self.rings) * self.azimuths + within(turn, self.azimuths)
    }

    /// Distributes a unit direction, +z along the normal, over its cell and adjacent ones, with
    /// weights that sum to 1.
    pub fn splat(&self, direction: DVec3, mut add: impl FnMut(usize, f64)) {
        let cell = self.cell(direction);
        let (ring, azimuth) = (cell / self.azimuths, cell % self.azimuths);
        for (across, share) in [(-1, 0.25), (0, 0.5), (1, 0.25)] {
            let ring = ring.saturating_add_signed(across).min(self.rings - 1);
            for (aside, of_ring) in [(self.azimuths - 1, 0.25), (0, 0.5), (1, 0.25)] {
                add(ring * self.azimuths + (azimuth + aside) % self.azimuths, share * of_ring);
            }
        }
    }

    /// Mean tangent of the angle to the normal over the projected solid angle of each ring.
    pub(crate) fn mean_tangents(&self) -> Vec<f64> {
        // ∫ tan θ d(sin² θ).
        let up_to = |sine: f64| sine.asin() - sine * (1.0 - sine * sine).sqrt();
        let edges: Vec<f64> = (0..=self.rings).map(|ring| up_to(self.edge_sine(ring))).collect();
        edges.windows(2).map(|edges| self.rings as f64 * (edges[1] - edges[0])).collect()
    }

    /// Sine of the angle between the normal and the inner edge of a ring.
    pub(crate) fn edge_sine(&self, ring: usize) -> f64 {
        (ring as f64 / self.rings as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_nearly_square_and_as_many_as_requested() {
        for count in [12, 64, 256, 1024, 1536, 4096] {
            let hemisphere = Hemisphere::with_divisions(count);
            let ratio = hemisphere.len() as f64 / count as f64;
            assert!((0.9..1.2).contains(&ratio), "{count}: {hemisphere:?}");
            let shape = hemisphere.azimuths as f64 / hemisphere.rings as f64;
            assert!((2.0..4.5).contains(&shape), "{count}: {hemisphere:?}");
        }
    }

    #[test]
    fn a_direction_lies_in_its_cell() {
        let hemisphere = Hemisphere::with_divisions(200);
        for cell in 0..hemisphere.len() {
            for within in [[0.01, 0.01], [0.5, 0.5], [0.99, 0.01], [0.3, 0.99]] {
                assert_eq!(hemisphere.cell(hemisphere.direction(cell, within)), cell);
            }
        }
    }

    #[test]
    fn splatting_conserves_weight_and_stays_near() {
        let hemisphere = Hemisphere::with_divisions(200);
        for cell in 0..hemisphere.len() {
            let direction = hemisphere.direction(cell, [0.5, 0.5]);
            let (mut sum, mut largest) = (0.0, (0, 0.0));
            hemisphere.splat(direction, |at, share| {
                sum += share;
                if share > largest.1 {
                    largest = (at, share);
                }
                let apart = hemisphere.direction(at, [0.5, 0.5]).angle_between(direction);
                assert!(apart < 1.0, "{cell} to {at}: {apart}");
            });
            assert!((sum - 1.0).abs() < 1e-12 && largest.0 == cell);
        }
    }

    #[test]
    fn the_mean_tangent_is_half_pi() {
        let tangents = Hemisphere::with_divisions(64).mean_tangents();
        assert!((tangents.iter().sum::<f64>() / tangents.len() as f64 - 0.5 * PI).abs() < 1e-12);
        assert!(tangents.is_sorted(), "{tangents:?}");
    }

    #[test]
    fn the_mean_cosine_is_two_thirds() {
        let hemisphere = Hemisphere::with_divisions(1024);
        let sum: f64 = (0..hemisphere.len()).map(|cell| hemisphere.direction(cell, [0.5, 0.5]).z).sum();
        assert!((sum / hemisphere.len() as f64 - 2.0 / 3.0).abs() < 1e-3);
    }
}
