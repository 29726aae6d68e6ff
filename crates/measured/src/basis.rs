//! Angle bases: divisions of the hemisphere into rings of patches.
//!
//! Source: J. H. Klems, ASHRAE Transactions 100(1), 1994; the bases of LBNL's WINDOW. A ring spans
//! a range of polar angles. Its patches are equal ranges of azimuth, the first of them centred on
//! azimuth zero. Points are directions projected onto the surface.

use std::f64::consts::{PI, TAU};

/// An angle basis.
#[derive(Clone, Debug, PartialEq)]
pub struct AngleBasis {
    pub(crate) name: String,
    rings: Vec<Ring>,
}

/// The patches between two polar angles.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ring {
    /// sin² of the polar angles.
    inner: f64,
    outer: f64,
    /// Number of patches in the rings inside this one.
    before: usize,
    patches: usize,
}

/// Predefined bases: name, and for each ring its outer angle (degrees) and its number of patches.
type Known = (&'static str, &'static [(f64, usize)]);
const KNOWN: [Known; 3] = [
    (
        "LBNL/Klems Full",
        &[(5.0, 1), (15.0, 8), (25.0, 16), (35.0, 20), (45.0, 24), (55.0, 24), (65.0, 24), (75.0, 16), (90.0, 12)],
    ),
    ("LBNL/Klems Half", &[(6.5, 1), (19.5, 8), (32.5, 12), (45.5, 16), (58.5, 20), (71.5, 12), (90.0, 8)]),
    ("LBNL/Klems Quarter", &[(9.0, 1), (27.0, 8), (45.0, 12), (63.0, 12), (90.0, 8)]),
];

impl AngleBasis {
    /// Klems' full, half and quarter basis.
    #[must_use]
    pub fn known() -> Vec<AngleBasis> {
        KNOWN.iter().map(|(name, rings)| AngleBasis::new((*name).to_owned(), rings)).collect()
    }

    /// A basis from each ring's outer angle (degrees, ascending, at most 90) and number of patches
    /// (at least one).
    pub(crate) fn new(name: String, ends: &[(f64, usize)]) -> AngleBasis {
        let (mut inner, mut before) = (0.0, 0_usize);
        let rings = ends.iter().map(|&(degrees, patches)| {
            let outer = if degrees >= 90.0 { 1.0 } else { degrees.to_radians().sin().powi(2) };
            let ring = Ring { inner, outer, before, patches };
            inner = outer;
            before = before.saturating_add(patches);
            ring
        });
        AngleBasis { name, rings: rings.collect() }
    }

    /// Number of patches.
    #[must_use]
    #[allow(clippy::len_without_is_empty, reason = "none is empty")]
    pub fn len(&self) -> usize {
        self.rings.last().map_or(0, |ring| ring.before.saturating_add(ring.patches))
    }

    /// Patch that contains a point of the disk; none outside of all rings.
    pub(crate) fn patch(&self, [x, y]: [f64; 2]) -> Option<usize> {
        let squared = x * x + y * y;
        let at = self.rings.partition_point(|ring| ring.outer <= squared);
        // A point exactly at the horizon belongs to the last ring, so that rounding does not lose
        // it.
        let ring = self.rings.get(at).or(self.rings.last().filter(|ring| ring.outer == 1.0))?;
        let turns = y.atan2(x) / TAU;
        let azimuth = if turns < 0.0 { turns + 1.0 } else { turns };
        let patch = (azimuth * ring.patches as f64 + 0.5) as usize;
        Some(ring.before + patch % ring.patches)
    }

    /// Projected solid angle of a patch, sr.
    pub(crate) fn projected_solid_angle(&self, patch: usize) -> f64 {
        let ring = self.ring_of(patch);
        PI * (ring.outer - ring.inner) / ring.patches as f64
    }

    /// Maps `u` and `v` to a point of a patch, uniform in projected solid angle.
    #[must_use]
    pub fn point(&self, patch: usize, [u, v]: [f64; 2]) -> [f64; 2] {
        let ring = self.ring_of(patch);
        let radius = (ring.inner + u * (ring.outer - ring.inner)).sqrt();
        let azimuth = TAU * ((patch - ring.before) as f64 + v - 0.5) / ring.patches as f64;
        [radius * azimuth.cos(), radius * azimuth.sin()]
    }

    fn ring_of(&self, patch: usize) -> &Ring {
        let after = self.rings.partition_point(|ring| ring.before <= patch);
        &self.rings[after.max(1) - 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_klems_bases_cover_the_hemisphere() {
        for (basis, count) in AngleBasis::known().iter().zip([145, 77, 41]) {
            assert_eq!(basis.len(), count);
            let total: f64 = (0..count).map(|patch| basis.projected_solid_angle(patch)).sum();
            assert!((total - PI).abs() < 1e-12, "{total}");
        }
    }

    #[test]
    fn a_point_of_a_patch_is_found_in_it() {
        for basis in AngleBasis::known() {
            for patch in 0..basis.len() {
                for inside in [[0.01, 0.01], [0.5, 0.5], [0.99, 0.01], [0.01, 0.99], [0.99, 0.99]] {
                    assert_eq!(basis.patch(basis.point(patch, inside)), Some(patch), "{} {patch}", basis.name);
                }
            }
            assert!(basis.patch([1.0, 0.0]).is_some() && basis.patch([0.0, -1.0 - 1e-9]).is_some());
        }
    }
}
