//! Spectral samplings of a rendering.

use crate::rgb::{xyz_of_bands, xyz_to_rgb};

/// Red, green and blue, or equal bands from the longest wavelength to the shortest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    bands: usize,
    splits_nm: [f64; 4],
}

/// Limits between red and green, and between green and blue, nm.
const RED_GREEN_BLUE_NM: [f64; 2] = [588.0, 480.0];

/// A range is not a range of colours if it begins above the first of these or ends below the
/// second, nm.
const BLUE_PEAK_NM: f64 = 469.0;
const RED_PEAK_NM: f64 = 607.0;

/// Smallest range of wavelengths, nm.
const LEAST_RANGE_NM: f64 = 50.0;

impl Sampling {
    /// Red, green and blue.
    pub const RGB: Sampling = Sampling { bands: 3, splits_nm: [780.0, 588.0, 480.0, 380.0] };

    /// Maximum number of bands.
    pub const MOST_BANDS: usize = 24;

    /// `bands` equal bands, at most [`Self::MOST_BANDS`], between two wavelengths in nm, in any
    /// order; 3 bands are red, green and blue. `None` for fewer than 3 bands, and for a range of
    /// less than 50 nm.
    #[must_use]
    pub fn new(bands: usize, [first_nm, last_nm]: [f64; 2]) -> Option<Sampling> {
        let (longest, shortest) = (first_nm.max(last_nm), first_nm.min(last_nm));
        let range = longest - shortest;
        if bands < 3 || !(range.is_finite() && range >= LEAST_RANGE_NM) {
            return None;
        }
        let [red_end, green_end] = if shortest >= BLUE_PEAK_NM || longest <= RED_PEAK_NM {
            [longest - range / 3.0, longest - range * 2.0 / 3.0]
        } else {
            RED_GREEN_BLUE_NM
        };
        Some(Sampling { bands: bands.min(Self::MOST_BANDS), splits_nm: [longest, red_end, green_end, shortest] })
    }

    /// Number of bands.
    #[must_use]
    pub fn bands(&self) -> usize {
        self.bands
    }

    /// Whether the bands are red, green and blue, which have no wavelengths.
    #[must_use]
    pub fn is_rgb(&self) -> bool {
        self.bands == 3
    }

    /// Longest wavelength, end of red, end of green, shortest wavelength; nm, descending.
    #[must_use]
    pub fn splits_nm(&self) -> [f64; 4] {
        self.splits_nm
    }

    /// Width of a band, nm.
    #[must_use]
    pub fn step_nm(&self) -> f64 {
        (self.splits_nm[0] - self.splits_nm[3]) / self.bands as f64
    }

    /// Colour component from which a band takes its value, by the band's centre: red (0), green (1)
    /// or blue (2).
    ///
    /// # Panics
    /// If there is no such band.
    #[must_use]
    pub fn part(&self, band: usize) -> usize {
        assert!(band < self.bands, "there are {} bands", self.bands);
        if self.is_rgb() {
            return band;
        }
        // Accumulated as in Radiance's released programs, two bands at a time, so that a centre on a
        // limit falls to the same side: that of 480 nm is blue with 6 and 22 bands, green with 10.
        let step = -self.step_nm();
        let first = self.splits_nm[0] + 0.5 * step + (band % 2) as f64 * step;
        let middle = (0..band / 2).fold(first, |middle, _| middle + 2.0 * step);
        match middle {
            _ if middle >= self.splits_nm[1] => 0,
            _ if middle >= self.splits_nm[2] => 1,
            _ => 2,
        }
    }

    /// Red, green and blue of values in these bands.
    ///
    /// # Panics
    /// If there are fewer values than bands.
    #[must_use]
    pub fn rgb(&self, values: &[f64]) -> [f64; 3] {
        if self.is_rgb() {
            return [values[0], values[1], values[2]];
        }
        xyz_to_rgb(xyz_of_bands(&values[..self.bands], [self.splits_nm[0], self.splits_nm[3]]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_take_red_green_or_blue_by_their_centres() {
        let sampling = Sampling::new(5, [380.0, 780.0]).unwrap();
        let parts: Vec<usize> = (0..5).map(|band| sampling.part(band)).collect();
        assert_eq!(parts, [0, 0, 1, 1, 2]);
    }

    #[test]
    fn impossible_samplings_are_none() {
        assert_eq!(Sampling::new(2, [380.0, 780.0]), None);
        assert_eq!(Sampling::new(9, [500.0, 549.0]), None);
        assert_eq!(Sampling::new(9, [500.0, f64::NAN]), None);
    }

    #[test]
    fn equal_energy_light_is_white() {
        for bands in [4, 9, 18, 99] {
            let sampling = Sampling::new(bands, [380.0, 780.0]).unwrap();
            let rgb = sampling.rgb(&[1.0; 24]);
            assert!(rgb.iter().all(|value| (value - 1.0).abs() < 2e-3), "{bands} bands: {rgb:?}");
        }
    }
}
