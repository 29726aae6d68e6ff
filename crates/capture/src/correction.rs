//! Correction of interpolated pixels by rays of their own.
//!
//! A lattice of pixels, and an unblurred film, predict the light of each ray of the picture. The mean
//! difference of rays from their predictions is the error of a pixel: the prediction is a control
//! variate (multilevel Monte Carlo: Heinrich 2001; Giles 2008). The error changes little from pixel to
//! pixel, so it is averaged over a window of them. Then one ray of every ninth pixel suffices: the
//! audited rays. Errors of nodes, interpolation and blur are corrected together. What is left is
//! noise without a sign, except where errors change within a window.

use crate::window_sums::WindowSums;

/// How far windows reach to each side, pixels: the next one where one has too few rays, as beside the
/// border.
const REACHES: [usize; 3] = [3, 6, 9];

/// Minimum number of rays in these windows. Fewer do not tell the variance.
const LEAST_RAYS: f64 = 8.0;

/// Smaller windows. They are used where their squared error is below this fraction of what is allowed.
const NARROW_REACHES: [usize; 2] = [1, 2];
const NARROW_ERROR: f64 = 0.2;

/// The squared errors that corrections may have: that of the pixel without correction, or what any
/// pixel may have, if that is more.
pub(crate) struct AllowedErrors {
    pub(crate) of_pixels: Vec<f64>,
    pub(crate) of_any: f64,
}

impl AllowedErrors {
    fn of(&self, pixel: usize) -> f64 {
        self.of_pixels[pixel].max(self.of_any)
    }
}

/// A value to be added to a pixel.
#[derive(Clone, Copy, Debug)]
struct Correction {
    value: f64,
    /// Its squared error.
    squared_error: f64,
}

/// The corrections of a picture, by pixel of the film.
#[derive(Debug)]
pub(crate) struct Corrections(Vec<Option<Correction>>);

impl Corrections {
    /// From the residuals of some pixels: by how much the light of a ray exceeds its prediction.
    pub(crate) fn new(
        residuals: &[Option<f64>],
        columns: usize,
        allowed: &AllowedErrors,
        is_corrected: impl Fn(usize) -> bool,
    ) -> Corrections {
        let terms = |residual: &Option<f64>| residual.map_or([0.0; 3], |own| [1.0, own, own * own]);
        let sums = WindowSums::new(residuals.iter().map(terms), columns);
        let correction = |pixel: usize| {
            let around = |reach: &usize| sums.signed_around(pixel, *reach);
            let wide = REACHES.iter().map(around).find(|[rays, ..]| *rays >= LEAST_RAYS)?;
            let [rays, sum, squares] = wide;
            let variance = (squares - sum * sum / rays).max(0.0) / (rays - 1.0);
            let most = NARROW_ERROR * allowed.of(pixel);
            let is_accurate = |[rays, ..]: &[f64; 3]| *rays >= 1.0 && variance <= most * rays;
            let [rays, sum, _] = NARROW_REACHES.iter().map(around).find(is_accurate).unwrap_or(wide);
            let squared_error = variance / rays;
            (squared_error <= allowed.of(pixel)).then(|| Correction { value: sum / rays, squared_error })
        };
        let of_pixel = |pixel: usize| if is_corrected(pixel) { correction(pixel) } else { None };
        Corrections((0..residuals.len()).map(of_pixel).collect())
    }

    /// Adds them to the pixels. `squared_errors` are those of the pixels, which may become larger.
    pub(crate) fn apply(&self, values: &mut [f64], squared_errors: &mut [f64]) {
        for ((value, squared), correction) in values.iter_mut().zip(squared_errors).zip(&self.0) {
            if let Some(correction) = correction {
                *value = (*value + correction.value).max(0.0);
                *squared = squared.max(correction.squared_error);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLUMNS: usize = 40;

    fn allowed(squared: f64) -> AllowedErrors {
        AllowedErrors { of_pixels: vec![squared; COLUMNS * COLUMNS], of_any: 0.0 }
    }

    /// Values of 1 after corrections by the residuals of every ninth pixel.
    fn corrected(allowed: &AllowedErrors, residual: impl Fn(usize, usize) -> f64) -> Vec<f64> {
        let of_pixel = |pixel: usize| {
            let (x, y) = (pixel % COLUMNS, pixel / COLUMNS);
            (x % 3 == y % 2 && y % 3 == 1).then(|| residual(x, y))
        };
        let residuals: Vec<Option<f64>> = (0..COLUMNS * COLUMNS).map(of_pixel).collect();
        let (mut values, mut errors) = (vec![1.0; residuals.len()], vec![0.0; residuals.len()]);
        Corrections::new(&residuals, COLUMNS, allowed, |pixel| pixel != 7).apply(&mut values, &mut errors);
        assert!(errors.iter().zip(&allowed.of_pixels).all(|(error, allowed)| error <= allowed));
        values
    }

    #[test]
    fn a_constant_error_is_corrected_everywhere() {
        let values = corrected(&allowed(1e-9), |_, _| 0.25);
        let wrong = values.iter().enumerate().filter(|(_, value)| (*value - 1.25).abs() > 1e-12);
        assert_eq!(wrong.map(|(pixel, _)| pixel).collect::<Vec<usize>>(), [7]);
    }

    #[test]
    fn noisy_residuals_correct_nothing() {
        let noise = |x: usize, y: usize| if (x / 3 + y / 3).is_multiple_of(2) { 0.5 } else { -0.5 };
        assert!(corrected(&allowed(1e-3), noise).iter().all(|value| *value == 1.0));
        let values = corrected(&allowed(0.1), noise);
        assert!(values.iter().any(|value| *value != 1.0) && values.iter().all(|value| (value - 1.0).abs() < 0.5));
    }

    #[test]
    fn small_errors_are_corrected_where_they_are() {
        let ramp = |x: usize, _: usize| 0.001 * x as f64;
        let values = corrected(&allowed(1.0), ramp);
        let middle = 20 * COLUMNS..20 * COLUMNS + COLUMNS;
        for (x, value) in values[middle].iter().enumerate() {
            assert!((value - 1.0 - 0.001 * x as f64).abs() < 0.0021, "{x}: {value}");
        }
    }
}
