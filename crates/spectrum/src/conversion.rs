//! Spectra of one sampling in another.

use crate::rgb::{band_weights, xyz_to_rgb};
use crate::sampling::Sampling;

/// Takes spectra of a fixed form to the bands of a [`Sampling`]; red, green and blue are found by way of the standard observer.
#[derive(Clone, Debug, PartialEq)]
pub struct Conversion {
    /// For each band of the result (X, Y and Z for red, green and blue) the weight of each value.
    weights: Vec<Vec<f64>>,
    is_rgb: bool,
}

/// Two ranges of wavelengths are the same below this sum of squared differences, nm².
const SAME_RANGE: f64 = 0.5;

impl Conversion {
    /// For spectra of `count` values in equal bands from a first wavelength to a last, nm, rising or falling. Where they say nothing,
    /// they are zero.
    #[must_use]
    pub fn new(to: &Sampling, count: usize, [first_nm, last_nm]: [f64; 2]) -> Conversion {
        let [longest, .., shortest] = to.splits_nm();
        if !to.is_rgb() {
            let weights = overlaps(to.bands(), [longest, shortest], count, [first_nm, last_nm]);
            return Conversion { weights, is_rgb: false };
        }
        // Radiance takes a long or rising spectrum to the range of its colours first.
        if count <= Sampling::MOST_BANDS && first_nm > last_nm {
            return Conversion { weights: xyz_rows(count, [first_nm, last_nm]), is_rgb: true };
        }
        let share = (longest - shortest) / (first_nm - last_nm).abs();
        let bands = ((count as f64 * share + 0.99) as usize).min(Sampling::MOST_BANDS);
        let step = overlaps(bands, [longest, shortest], count, [first_nm, last_nm]);
        let weights = xyz_rows(bands, [longest, shortest])
            .into_iter()
            .map(|row| (0..count).map(|value| row.iter().zip(&step).map(|(a, band)| a * band[value]).sum()).collect())
            .collect();
        Conversion { weights, is_rgb: true }
    }

    /// The value in each band of the result; `bands` holds as many as the sampling has.
    pub fn apply(&self, values: &[f64], bands: &mut [f64]) {
        let sum = |row: &Vec<f64>| row.iter().zip(values).map(|(weight, value)| weight * value).sum::<f64>();
        if self.is_rgb {
            let rgb = xyz_to_rgb(std::array::from_fn(|row| sum(&self.weights[row])));
            bands[..3].copy_from_slice(&rgb);
            return;
        }
        for (band, row) in bands.iter_mut().zip(&self.weights) {
            *band = sum(row);
        }
    }
}

fn xyz_rows(bands: usize, range_nm: [f64; 2]) -> Vec<Vec<f64>> {
    let weights: Vec<[f64; 3]> = band_weights(bands, range_nm).collect();
    (0..3).map(|row| weights.iter().map(|weight| weight[row]).collect()).collect()
}

/// For each band the share of it that each value covers.
fn overlaps(bands: usize, to_nm: [f64; 2], count: usize, from_nm: [f64; 2]) -> Vec<Vec<f64>> {
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
    (0..bands).map(|band| (0..count).map(|value| share(band, value)).collect()).collect()
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
            Conversion::new(&sampling, 5, range).apply(&values, &mut bands);
            let integral = bands.iter().sum::<f64>() * sampling.step_nm();
            assert!((integral - 20.0 * 80.0).abs() < 1e-9, "{integral}");
        }
    }

    #[test]
    fn a_rising_spectrum_is_the_falling_one_turned() {
        let sampling = Sampling::new(12, [780.0, 380.0]).unwrap();
        let (mut rising, mut falling) = ([0.0; 12], [0.0; 12]);
        Conversion::new(&sampling, 3, [400.0, 700.0]).apply(&[1.0, 2.0, 3.0], &mut rising);
        Conversion::new(&sampling, 3, [700.0, 400.0]).apply(&[3.0, 2.0, 1.0], &mut falling);
        assert!(rising.iter().zip(&falling).all(|(a, b)| (a - b).abs() < 1e-12), "{rising:?} {falling:?}");
        assert!(rising[0] < 1.0 && rising[11] < 1.0, "what is said nothing of is zero");
    }
}
