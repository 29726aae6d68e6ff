//! Spatial non-uniformity: dark signal (DSNU) and photo response (PRNU), each with pixel, row and
//! column components.
//!
//! EMVA Standard 1288, release 4.0, splits the spatial variance of the dark image (DSNU) and of the
//! response (PRNU) into components that are constant along columns, along rows, or along neither.
//! Here each component is Gaussian with the given standard deviation. The pattern belongs to one
//! specimen: it is a function of the specimen's seed and the pixel's position, the same in every
//! picture.

use crate::SensorError;
use crate::error::within;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// Standard deviations of the components of a spatial non-uniformity. The total is the root of the
/// sum of their squares.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpatialDeviation {
    /// Pixel component.
    pub pixel: f64,
    /// Row component: constant along a row.
    pub row: f64,
    /// Column component: constant along a column.
    pub column: f64,
}

impl SpatialDeviation {
    /// Standard deviation over all pixels.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.pixel.hypot(self.row).hypot(self.column)
    }
}

/// Spatial non-uniformity of one specimen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NonUniformity {
    /// DSNU, electrons; an offset that does not depend on the exposure time.
    pub dsnu_e: SpatialDeviation,
    /// PRNU, relative to the response (0.01 is 1 %).
    pub prnu: SpatialDeviation,
    /// Number of pixels per row.
    pub columns: u32,
    /// Number of the specimen, a seed.
    pub specimen: u64,
}

/// Components with independent random streams.
#[derive(Clone, Copy, Debug)]
enum Part {
    DarkPixel,
    DarkRow,
    DarkColumn,
    ResponsePixel,
    ResponseRow,
    ResponseColumn,
}

impl NonUniformity {
    /// Checks the standard deviations; errors use the names of camera files.
    ///
    /// # Errors
    /// The first value that is negative, not finite, or a PRNU above 0.3, for which a Gaussian
    /// would give negative responses.
    pub fn checked(self) -> Result<Self, SensorError> {
        for value in [self.dsnu_e.pixel, self.dsnu_e.row, self.dsnu_e.column] {
            within("dsnu_e", value, "at least 0 and finite", |value| value >= 0.0)?;
        }
        for value in [self.prnu.pixel, self.prnu.row, self.prnu.column] {
            within("prnu_percent", 100.0 * value, "from 0 to 30", |value| (0.0..=30.0).contains(&value))?;
        }
        Ok(self)
    }

    /// Dark offset of a pixel, electrons.
    #[must_use]
    pub fn dark_offset_e(&self, pixel: u64) -> f64 {
        let [row, column] = self.place(pixel);
        let dsnu = &self.dsnu_e;
        self.part(dsnu.pixel, Part::DarkPixel, pixel)
            + self.part(dsnu.row, Part::DarkRow, row)
            + self.part(dsnu.column, Part::DarkColumn, column)
    }

    /// Response of a pixel relative to the mean, at least 0.
    #[must_use]
    pub fn response(&self, pixel: u64) -> f64 {
        let [row, column] = self.place(pixel);
        let prnu = &self.prnu;
        let share = self.part(prnu.pixel, Part::ResponsePixel, pixel)
            + self.part(prnu.row, Part::ResponseRow, row)
            + self.part(prnu.column, Part::ResponseColumn, column);
        (1.0 + share).max(0.0)
    }

    fn place(&self, pixel: u64) -> [u64; 2] {
        let columns = u64::from(self.columns.max(1));
        [pixel / columns, pixel % columns]
    }

    fn part(&self, deviation: f64, part: Part, index: u64) -> f64 {
        if deviation == 0.0 {
            return 0.0;
        }
        let mut random = ChaCha8Rng::seed_from_u64(self.specimen);
        random.set_stream((part as u64 + 1) << 56 | index);
        let normal: f64 = StandardNormal.sample(&mut random);
        deviation * normal
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PARTS: NonUniformity = NonUniformity {
        dsnu_e: SpatialDeviation { pixel: 2.0, row: 0.0, column: 1.5 },
        prnu: SpatialDeviation { pixel: 0.0, row: 0.01, column: 0.0 },
        columns: 200,
        specimen: 5,
    };

    #[test]
    fn a_row_part_is_the_same_along_a_row() {
        assert_eq!(PARTS.response(3 * 200), PARTS.response(3 * 200 + 199));
        assert_ne!(PARTS.response(3 * 200), PARTS.response(4 * 200));
    }

    #[test]
    fn the_deviation_is_the_given_one_and_specimens_differ() {
        let offsets: Vec<f64> = (0..40_000).map(|pixel| PARTS.dark_offset_e(pixel)).collect();
        let mean = offsets.iter().sum::<f64>() / offsets.len() as f64;
        let variance = offsets.iter().map(|offset| (offset - mean).powi(2)).sum::<f64>() / offsets.len() as f64;
        // 200 columns determine the column component to 5 %.
        assert!((variance / PARTS.dsnu_e.total().powi(2) - 1.0).abs() < 0.12, "{variance}");
        let other = NonUniformity { specimen: 6, ..PARTS };
        assert_ne!(other.dark_offset_e(17), PARTS.dark_offset_e(17));
    }

    #[test]
    fn impossible_deviations_are_rejected() {
        let prnu = SpatialDeviation { pixel: 0.5, ..SpatialDeviation::default() };
        let message = NonUniformity { prnu, ..PARTS }.checked().unwrap_err().to_string();
        assert_eq!(message, "prnu_percent must be from 0 to 30, not 50");
    }
}
