//! Division of the sky into patches by Tregenza and Reinhart.
//!
//! Tregenza (Lighting Research and Technology 19, 1987) divides the sky into seven rings and the
//! zenith, 145 patches in all. Reinhart subdivides each of these patches into rows and columns. All
//! rows have the same height in altitude, except for the zenith patch, which has half of it.
//!
//! Guarantees: patches are numbered from 0, with rows from the horizon up, as in Radiance's
//! `reinhart.cal` without the ground; no input makes a function panic. The crate knows neither the
//! orientation nor the radiance of the sky.
//!
//! ```
//! use radsight_sky::SkyDivision;
//! let sky = SkyDivision::new(2);
//! assert_eq!((sky.patches(), sky.rows(), sky.columns(0)), (577, 14, 60));
//! assert_eq!(sky.row_and_column(61), (1, 1));
//! assert_eq!(sky.row_and_column(576), (sky.rows(), 0));
//! ```
#![forbid(unsafe_code)]

use std::f64::consts::FRAC_PI_2;

/// Number of patches in Tregenza's rings, from the horizon up; the zenith has one.
const TREGENZA: [u32; 7] = [30, 30, 24, 24, 18, 12, 6];

/// A division of the sky.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SkyDivision {
    subdivision: u32,
}

impl SkyDivision {
    /// Division of each of Tregenza's patches into `subdivision` parts along each side, at least
    /// one.
    #[must_use]
    pub fn new(subdivision: u32) -> SkyDivision {
        SkyDivision { subdivision: subdivision.max(1) }
    }

    /// Number of rows, without the zenith.
    #[must_use]
    pub fn rows(self) -> u32 {
        (TREGENZA.len() as u32).saturating_mul(self.subdivision)
    }

    /// Height of a row in altitude, radians.
    #[must_use]
    pub fn row_height(self) -> f64 {
        FRAC_PI_2 / (f64::from(self.rows()) + 0.5)
    }

    /// Number of patches in a row; 1 from the zenith on.
    #[must_use]
    pub fn columns(self, row: u32) -> u64 {
        let ring = TREGENZA.get((row / self.subdivision) as usize);
        ring.map_or(1, |patches| u64::from(*patches) * u64::from(self.subdivision))
    }

    /// Number of patches, including the zenith.
    #[must_use]
    pub fn patches(self) -> u64 {
        let subdivision = u64::from(self.subdivision);
        (u64::from(TREGENZA.iter().sum::<u32>()) * subdivision).saturating_mul(subdivision).saturating_add(1)
    }

    /// Row and column of a patch; the zenith, and every larger number, is in the row after the last
    /// one.
    #[must_use]
    pub fn row_and_column(self, patch: u64) -> (u32, u64) {
        let mut column = patch;
        for row in 0..self.rows() {
            if column < self.columns(row) {
                return (row, column);
            }
            column -= self.columns(row);
        }
        (self.rows(), column)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sky_has_tregenzas_patches() {
        let count = |subdivision| SkyDivision::new(subdivision).patches();
        assert_eq!([count(0), count(1), count(2), count(4)], [145, 145, 577, 2305]);
    }

    #[test]
    fn rows_hold_all_patches() {
        for subdivision in [1, 3, 6] {
            let sky = SkyDivision::new(subdivision);
            assert_eq!((0..=sky.rows()).map(|row| sky.columns(row)).sum::<u64>(), sky.patches());
            let mut next = 0;
            for row in 0..=sky.rows() {
                for column in 0..sky.columns(row) {
                    assert_eq!(sky.row_and_column(next), (row, column));
                    next += 1;
                }
            }
        }
    }

    #[test]
    fn nothing_is_too_large() {
        let sky = SkyDivision::new(u32::MAX);
        assert!(sky.patches() > 1 << 60 && sky.row_height() > 0.0);
        assert_eq!(sky.columns(u32::MAX), 30 * u64::from(u32::MAX));
    }
}
