//! Conversion between spectral samplings.

use crate::rgb::{band_weights, xyz_to_rgb};
use crate::sampling::Sampling;

/// Converts spectra of a fixed form to the bands of a [`Sampling`]; red, green and blue use the
/// standard observer.
#[derive(Clone, Debug, PartialEq)]
pub struct Conversion {
    /// For each value its weight in each band of the result; for red, green and blue its weights in
    /// X, Y and Z.
    weights: Vec<Box<[f64]>>,
    through_xyz: bool,
}

/// Two ranges of wavelengths are equal below this sum of squared differences, nm².
const SAME_RANGE: f64 = 0.5;

impl Conversion {
    /// Conversion of spectra of `count` values in equal bands between two wavelengths, nm,
    /// ascending or descending. Outside that range a spectrum is zero.
    #[must_use]
    pub fn new(to: &Sampling, count: usize, [first_nm, last_nm]: [f64; 2]) -> Conversion {
        let [longest, .., shortest] = to.splits_nm();
        if !to.is_rgb() {
            let weights = overlaps(to.bands(), [longest, shortest], count, [first_nm, last_nm]);
            return Conversion { weights, through_xyz: false };
        }
        // Radiance first converts a long or ascending spectrum to the range of its colours.
        if count <= Sampling::MOST_BANDS && first_nm > last_nm {
            if count == 3 {
                return Conversion { weights: unit(), through_xyz: false };
            }
            let weights = band_weights(count, [first_nm, last_nm]).map(Box::from).collect();
            return Conversion { weights, through_xyz: true };
        }
        let share = (longest - shortest) / (first_nm - last_nm).abs();
        let bands = ((count as f64 * share + 0.99) as usize).min(Sampling::MOST_BANDS);
        if bands == 3 {
            return Conversion {
                weights: overlaps(3, [longest, shortest], count, [first_nm, last_nm]),
                through_xyz: false,
            };
        }
        let of_bands: Vec<[f64; 3]> = band_weights(bands, [longest, shortest]).collect();
        let weights = overlaps(bands, [longest, shortest], count, [first_nm, last_nm])
            .into_iter()
            .map(|shares| {
                (0..3).map(|i| shares.iter().zip(&of_bands).map(|(share, xyz)| share * xyz[i]).sum()).collect()
            })
            .collect();
        Conversion { weights, through_xyz: true }
    }

    /// Computes the value in each band of the result; `bands` has the length of the sampling.
    ///
    /// # Panics
    /// If `bands` has fewer than three elements.
    pub fn apply(&self, values: impl IntoIterator<Item = f64>, bands: &mut [f64]) {
        bands.fill(0.0);
        for (value, weights) in values.into_iter().zip(&self.weights) {
            for (band, weight) in bands.iter_mut().zip(weights) {
                *band += value * weight;
            }
        }
        if self.through_xyz {
            let rgb = xyz_to_rgb([bands[0], bands[1], bands[2]]);
            bands[..3].copy_from_slice(&rgb);
        }
    }
}

/// Three values are red, green and blue in Radiance, whatever their wavelengths.
fn unit() -> Vec<Box<[f64]>> {
    (0..3).map(|value| (0..3).map(|band| f64::from(u8::from(band == value))).collect()).collect()
}

/// For each value, the fraction of each band that it covers.
fn overlaps(bands: usize, to_nm: [f64; 2], count: usize, from_nm: [f64; 2]) -> Vec<Box<[f64]>> {
    let is_same = bands == count && (0..2).map(|i| (to_nm[i] - from_nm[i]).powi(2)).sum::<f64>() <= SAME_RANGE;
    let edges = |[first, last]: [f64; 2], count: usize, index: usize| {
        let edge = |index: usize| first + (last - first) * index as f64 / count as f64;
        let (a, b) = (edge(index), edge(index + 1));
        (a.min(b), a.max(b))
    };
    let share = |band: usize, value: usize| {
        if is_same {
            return f64::from(u8::from(band == value));
        }
        let (low, high) = edges(to_nm, bands, band);
        let (from, to) = edges(from_nm, count, value);
        (high.min(to) - low.max(from)).max(0.0) / (high - low)
    };
    (0..count).map(|value| (0..bands).map(|band| share(band, value)).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spectrum_keeps_its_integral() {
        let sampling = Sampling::new(7, [780.0, 380.0]).unwrap();
        let values = [1.0, 4.0, 2.0, 8.0, 5.0];
        for range in [[380.0, 780.0], [780.0, 380.0]] {
            let mut bands = [0.0; 7];
            Conversion::new(&sampling, 5, range).apply(values, &mut bands);
            let integral = bands.iter().sum::<f64>() * sampling.step_nm();
            assert!((integral - 20.0 * 80.0).abs() < 1e-9, "{integral}");
        }
    }

    #[test]
    fn an_ascending_spectrum_is_the_reversed_descending_one() {
        let sampling = Sampling::new(12, [780.0, 380.0]).unwrap();
        let (mut rising, mut falling) = ([0.0; 12], [0.0; 12]);
        Conversion::new(&sampling, 3, [400.0, 700.0]).apply([1.0, 2.0, 3.0], &mut rising);
        Conversion::new(&sampling, 3, [700.0, 400.0]).apply([3.0, 2.0, 1.0], &mut falling);
        assert!(rising.iter().zip(&falling).all(|(a, b)| (a - b).abs() < 1e-12), "{rising:?} {falling:?}");
        assert!(rising[0] < 1.0 && rising[11] < 1.0, "the spectrum is zero outside its range");
    }
}
