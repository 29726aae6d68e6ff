//! Responses of the eye other than the standard observer's.

use radsight_units::photometry::{WHITE_MELANOPIC_EFFICACY, WHITE_SCOTOPIC_EFFICACY};
use std::sync::LazyLock;

/// A response of the eye.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Response {
    /// Scotopic vision, by the rods.
    Scotopic,
    /// Melanopic response, which drives the circadian rhythm.
    Melanopic,
}

/// First wavelength of the curves, nm, and their step.
const FIRST_NM: usize = 380;
const STEP_NM: usize = 10;

/// V'(λ) in steps of 10 nm (CIE 1951).
#[rustfmt::skip]
const SCOTOPIC: [f64; 33] = [
    0.000589, 0.002209, 0.00929, 0.03484, 0.0966, 0.1998, 0.3281, 0.455, 0.567, 0.676, 0.793, 0.904, 0.982, 0.997, 0.935, 0.811, 0.65, 0.481, 0.3288,
    0.2076, 0.1212, 0.0655, 0.03315, 0.01593, 0.00737, 0.003335, 0.001497, 0.000677, 0.0003129, 0.000148, 0.0000715, 0.00003533, 0.0000178,
];

/// Melanopic action spectrum in steps of 10 nm (CIE S 026:2018), to the resolution of Radiance's
/// sums.
#[rustfmt::skip]
const MELANOPIC: [f64; 27] = [
    0.0012, 0.0036, 0.013, 0.0514, 0.1462, 0.2664, 0.4159, 0.5692, 0.7242, 0.8733, 0.9727, 1., 0.9594, 0.8491, 0.6825, 0.5018, 0.3368, 0.2044, 0.111, 0.0544, 0.0248, 0.0109, 0.0047, 0.002, 0.0008, 0.0004, 0.0002,
];

/// Cumulative sums up to each whole wavelength, normalised to 1.
static CUMULATIVE: LazyLock<[Vec<f64>; 2]> = LazyLock::new(|| [sums(&SCOTOPIC), sums(&MELANOPIC)]);

fn sums(curve: &[f64]) -> Vec<f64> {
    let last = (curve.len() - 1) * STEP_NM;
    let value = |index: usize| {
        let first = (index / STEP_NM).clamp(1, curve.len() - 3) - 1;
        let x = index as f64 / STEP_NM as f64 - first as f64;
        // The cubic through the four nearest points, as for the observer.
        let weight = |point: usize| -> f64 {
            let others = (0..4).filter(|other| *other != point);
            others.map(|other| (x - other as f64) / (point as f64 - other as f64)).product()
        };
        (0..4).map(|point| weight(point) * curve[first + point]).sum::<f64>().max(0.0)
    };
    let mut sum = 0.0;
    let mut sums: Vec<f64> = Vec::with_capacity(last + 1);
    for index in 0..=last {
        sum += value(index);
        sums.push(sum);
    }
    sums.iter_mut().for_each(|part| *part /= sum);
    sums
}

impl Response {
    /// Efficacy of white light by Radiance's convention, lm/W.
    #[must_use]
    pub fn white_efficacy(self) -> f64 {
        match self {
            Response::Scotopic => WHITE_SCOTOPIC_EFFICACY,
            Response::Melanopic => WHITE_MELANOPIC_EFFICACY,
        }
    }

    /// Fraction of the response in each of `bands` equal bands, where equal-energy light has 1 in
    /// total. Band limits are rounded to whole nanometres, as in Radiance.
    pub fn of_whole_bands(self, bands: usize, [first_nm, last_nm]: [f64; 2]) -> impl Iterator<Item = f64> {
        let up_to = move |band: usize| {
            let edge = (first_nm + (last_nm - first_nm) * band as f64 / bands as f64).trunc();
            let sums = &CUMULATIVE[self as usize];
            // A wavelength at a limit counts to the band that it begins.
            match (edge as usize).checked_sub(FIRST_NM + 1) {
                Some(index) if edge > 0.0 => sums[index.min(sums.len() - 1)],
                _ => 0.0,
            }
        };
        (0..bands).map(move |band| (up_to(band + 1) - up_to(band)).abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MELANOPIC_OF_RGB, SCOTOPIC_OF_RGB};

    #[test]
    fn the_fractions_of_white_light_sum_to_one() {
        for response in [Response::Scotopic, Response::Melanopic] {
            for bands in [1, 7, 24] {
                let total: f64 = response.of_whole_bands(bands, [780.0, 380.0]).sum();
                assert!((total - 1.0).abs() < 2e-3, "{response:?} {total}");
            }
        }
    }

    #[test]
    fn red_green_and_blue_have_radiances_weights() {
        for (response, of_rgb) in [(Response::Scotopic, SCOTOPIC_OF_RGB), (Response::Melanopic, MELANOPIC_OF_RGB)] {
            for (range, part) in [([780.0, 588.0], 0), ([588.0, 480.0], 1), ([480.0, 380.0], 2)] {
                let found = response.white_efficacy() * response.of_whole_bands(1, range).sum::<f64>();
                let white = response.white_efficacy();
                assert!((found - of_rgb[part]).abs() < 0.005 * white, "{response:?} {part}: {found}");
            }
        }
    }
}
