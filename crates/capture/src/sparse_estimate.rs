//! The estimate of all pixels from the exposed pixels of a lattice, with its error.

use crate::adaptive::{ERROR_WINDOW, GAIN_WINDOW, Pixel, gain, unit_error};
use crate::edges::EdgeBlurs;
use crate::lattice::Lattice;
use crate::shared_rays::{PinholeBlur, UnblurredFilm};
use radsight_adaptive::{FIRST_SAMPLES, PixelError};

/// Squared interpolation error of a level relative to the squared residual of the previous level,
/// which has twice the stride: 1/16 for a function with a kink, as the profiles of lamps have them.
/// Measured at a stride of 4: 1/10 in the mean, and more in cells beside a kink.
const SMOOTH_RATIO: f64 = 1.0 / 5.0;

/// The same for an edge that a lamp or the pinhole blurs, and for one that both blur. The exposure
/// begins with the power 3/2, or 3, of the distance from the border of the edge, so the ratio tends
/// to 2⁻³ or 2⁻⁶. Measured at strides of 2 and 4: 1/7 to 1/20 and 1/39 to 1/49.
const BLURRED_RATIO: f64 = 1.0 / 8.0;
const TWICE_BLURRED_RATIO: f64 = 1.0 / 32.0;

/// The squared interpolation error of a cell relative to its squared residual.
pub(crate) fn residual_ratio(blurs: EdgeBlurs) -> f64 {
    match blurs {
        EdgeBlurs::None => SMOOTH_RATIO,
        EdgeBlurs::One => BLURRED_RATIO,
        EdgeBlurs::Two => TWICE_BLURRED_RATIO,
    }
}

/// Mean squared weight of interpolation along both axes: the fraction of a node's variance in each
/// pixel.
const MEAN_SQUARED_WEIGHT: f64 = 0.6;

/// How the noise of a pixel is pooled with that of pixels around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NoisePooling {
    /// With the pixels beside it.
    Near,
    /// With a wider window until the pixel has [`MIN_KNOWN`] samples, then with the pixels beside it.
    /// Glossy surfaces that are lit by way of others, and what dielectrics show, have rare and bright
    /// rays. A pixel whose first rays met some would get more of them, and one whose rays met none
    /// would stay too dark.
    WideFirst,
}

impl NoisePooling {
    /// Whether the noise of a pixel is that of a wider window.
    fn is_wide(self, pixel: &Pixel) -> bool {
        self == NoisePooling::WideFirst && pixel.samples < MIN_KNOWN
    }
}

/// Number of samples from which a pixel's own noise counts, where some rays are rare and bright.
const MIN_KNOWN: u32 = 16;

/// How well the previous level predicts the nodes of a cell.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct InterpolationResidual {
    /// Mean squared difference.
    squared: f64,
    /// Expected from noise alone.
    noise: f64,
    /// Squared error of interpolation relative to the squared difference.
    ratio: f64,
}

impl InterpolationResidual {
    /// The squared interpolation error in the cell.
    pub(crate) fn error(&self) -> f64 {
        self.without_noise().max(0.0)
    }

    /// The same, with an error of its own that vanishes in the mean over many cells.
    fn without_noise(&self) -> f64 {
        self.ratio * (self.squared - self.noise)
    }
}

/// The picture as estimated from its nodes, in units of radiance.
#[derive(Debug)]
pub(crate) struct SparseEstimate {
    /// Of each pixel.
    pub(crate) values: Vec<f64>,
    /// Squared error of each pixel due to the noise of the nodes.
    pub(crate) noise: Vec<f64>,
    /// Squared error of each pixel due to interpolation.
    pub(crate) bias: Vec<f64>,
    /// Its mean over all pixels.
    mean_bias: f64,
    /// The nodes, with the contribution of their noise to the sum of squared errors over all
    /// pixels.
    pub(crate) nodes: Vec<(usize, PixelError)>,
    /// Number of pixels for which each node stands.
    areas: Vec<f64>,
    /// Of each cell.
    pub(crate) residuals: Vec<InterpolationResidual>,
    /// Mean over all pixels of the picture.
    mean: f64,
    /// Mean squared error of all pixels of the picture due to noise.
    mean_noise: f64,
    /// Number of pixels of the picture.
    pub(crate) pixel_count: usize,
}

impl SparseEstimate {
    /// From the nodes of a lattice, whose levels are those of [`Lattice::nodes`].
    /// The cells have levels and ratios of residuals.
    pub(crate) fn new(
        lattice: &Lattice,
        (levels, ratios): (&[u8], &[f64]),
        nodes: &[u8],
        (pixels, pooling): (&[Pixel], NoisePooling),
        film: Option<&UnblurredFilm>,
    ) -> SparseEstimate {
        let mut values: Vec<f64> = pixels.iter().map(Pixel::mean).collect();
        lattice.fill(&mut values, nodes, |weight| weight);
        let errors = node_errors(lattice, nodes, (pixels, pooling));
        let mut noise = vec![0.0; values.len()];
        errors.iter().for_each(|(pixel, error)| noise[*pixel] = error.squared);
        lattice.fill(&mut noise, nodes, |weight| weight * weight);
        let residuals: Vec<InterpolationResidual> = (0..levels.len())
            .map(|cell| InterpolationResidual {
                ratio: ratios[cell],
                ..residual(lattice, (cell, levels[cell]), &values, &noise)
            })
            .collect();
        let mut bias = vec![0.0_f64; values.len()];
        let (mut total, mut count) = (0.0, 0.0);
        for (cell, residual) in residuals.iter().enumerate() {
            for (pixel, _) in lattice.pixels(cell).filter(|(pixel, _)| nodes[*pixel] == 0) {
                bias[pixel] = bias[pixel].max(residual.error());
                total += residual.without_noise();
                count += 1.0;
            }
        }
        let interpolated = nodes.iter().filter(|node| **node == 0).count() as f64 / nodes.len() as f64;
        let mean_bias = interpolated * f64::max(total / f64::max(count, 1.0), 0.0);
        let weigh = |(pixel, error): (usize, PixelError)| {
            let area = area_of(nodes[pixel]);
            let spread = match film {
                Some(film) => film.share(pixel) * film.squared_weights(area, MEAN_SQUARED_WEIGHT),
                None if area > 1.0 => MEAN_SQUARED_WEIGHT * area,
                None => 1.0,
            };
            (pixel, PixelError { squared: spread * error.squared, ..error })
        };
        let areas = errors.iter().map(|(pixel, _)| area_of(nodes[*pixel])).collect();
        let nodes: Vec<_> = errors.into_iter().map(weigh).collect();
        let (pixel_count, mean, mean_noise) = match film {
            None => {
                let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
                (values.len(), mean(&values), mean(&noise))
            }
            Some(film) => {
                let count = film.picture_pixels();
                let sum = values.iter().enumerate().map(|(pixel, value)| film.share(pixel) * value).sum::<f64>();
                let noise = nodes.iter().map(|(_, error)| error.squared).sum::<f64>();
                (count, sum / count as f64, noise / count as f64)
            }
        };
        SparseEstimate { values, noise, bias, mean_bias, nodes, areas, residuals, mean, mean_noise, pixel_count }
    }

    pub(crate) fn mean(&self) -> f64 {
        self.mean
    }

    /// Mean squared error of all pixels due to noise and to interpolation.
    pub(crate) fn squared_errors(&self) -> [f64; 2] {
        [self.mean_noise, self.mean_bias]
    }

    /// The number of samples that a pixel of the picture would need for the noise that each node
    /// causes.
    pub(crate) fn own_samples(&self, film: &UnblurredFilm) -> impl Iterator<Item = f64> {
        self.nodes.iter().zip(&self.areas).map(|((_, error), area)| {
            f64::from(error.samples) * area / film.squared_weights(*area, MEAN_SQUARED_WEIGHT)
        })
    }

    /// The picture that the film blurs to, in the frame of the film.
    pub(crate) fn blurred(&self, blur: &PinholeBlur<'_>, (lattice, nodes): (&Lattice, &[u8])) -> Picture {
        let film = blur.film;
        let mut spread = vec![0.0; self.values.len()];
        for ((pixel, error), area) in self.nodes.iter().zip(&self.areas) {
            spread[*pixel] = error.squared / (area * film.share(*pixel)).max(f64::MIN_POSITIVE);
        }
        lattice.fill(&mut spread, nodes, |weight| weight);
        // Single cells know their errors less well than all together.
        let with_mean = |values: Vec<f64>, mean: f64| -> Vec<f64> {
            let positive: Vec<f64> = values.into_iter().map(|value| value.max(0.0)).collect();
            let scale = mean / film.mean_over_picture(&positive).max(f64::MIN_POSITIVE);
            positive.into_iter().map(|value| scale * value).collect()
        };
        let picture = blur.picture(&self.values);
        let mut bias = with_mean(film.blurred(&self.bias), self.mean_bias);
        bias.iter_mut().zip(picture.squared_errors).for_each(|(bias, squared)| *bias += squared);
        let values = picture.values.into_iter().map(|value| value.max(0.0)).collect();
        Picture { values, noise: with_mean(film.blurred(&spread), self.mean_noise), bias }
    }
}

/// All pixels of a picture, in units of radiance.
#[derive(Debug)]
pub(crate) struct Picture {
    pub(crate) values: Vec<f64>,
    /// Squared error due to noise.
    pub(crate) noise: Vec<f64>,
    /// Squared error due to interpolation.
    pub(crate) bias: Vec<f64>,
}

/// Number of pixels for which a node of a level stands.
fn area_of(level: u8) -> f64 {
    Lattice::stride(level).pow(2) as f64
}

/// The noise of each node, pooled with neighbouring nodes as the adaptive sampler pools pixels.
fn node_errors(lattice: &Lattice, nodes: &[u8], samples: (&[Pixel], NoisePooling)) -> Vec<(usize, PixelError)> {
    pooled_errors(samples, lattice.columns(), |pixel| if nodes[pixel] > 0 { Lattice::stride(nodes[pixel]) } else { 0 })
}

/// The noise of some pixels, pooled with the others near them. `stride` gives the distance between
/// them around a pixel, and 0 for all other pixels. Those without a second half of samples are not
/// pooled.
pub(crate) fn pooled_errors(
    (pixels, pooling): (&[Pixel], NoisePooling),
    columns: usize,
    stride: impl Fn(usize) -> usize,
) -> Vec<(usize, PixelError)> {
    let counted = |(index, pixel): (usize, &Pixel)| {
        let samples = f64::from(pixel.samples);
        let is_pooled = pixel.samples >= FIRST_SAMPLES && stride(index) > 0;
        if is_pooled { [1.0, pixel.last * samples, pixel.before * samples] } else { [0.0; 3] }
    };
    let sums = WindowSums::new(pixels.iter().enumerate().map(counted), columns);
    let everywhere = pixels.len().max(columns);
    let of_pixel = |index: usize| {
        let stride = stride(index);
        let wide = sums.around(index, GAIN_WINDOW * stride);
        let wide = if wide[0] < 0.5 { sums.around(index, everywhere) } else { wide };
        let near = sums.around(index, ERROR_WINDOW * stride);
        let near = if near[0] < 0.5 { wide } else { near };
        let gain = gain(wide[1] / wide[0].max(1.0), wide[2] / wide[0].max(1.0));
        if pooling.is_wide(&pixels[index]) {
            let unknown = Pixel { last: 0.0, ..pixels[index] };
            return (index, unit_error(&unknown, wide[1] / wide[0].max(1.0), gain, 1.0));
        }
        (index, unit_error(&pixels[index], near[1] / near[0].max(1.0), gain, 1.0))
    };
    (0..pixels.len()).filter(|pixel| stride(*pixel) > 0).map(of_pixel).collect()
}

fn residual(lattice: &Lattice, (cell, level): (usize, u8), values: &[f64], noise: &[f64]) -> InterpolationResidual {
    if level == lattice.finest() {
        return InterpolationResidual::default();
    }
    let (mut residual, mut count) = (InterpolationResidual::default(), 0.0);
    for (pixel, _) in lattice.pixels(cell).filter(|(_, rank)| *rank == level) {
        let Some(predicted) = lattice.predicted(pixel, values, |weight| weight) else { continue };
        let expected = lattice.predicted(pixel, noise, |weight| weight * weight).unwrap_or(0.0);
        residual.squared += (values[pixel] - predicted).powi(2);
        residual.noise += noise[pixel] + expected;
        count += 1.0;
    }
    let count = f64::max(count, 1.0);
    InterpolationResidual { squared: residual.squared / count, noise: residual.noise / count, ..residual }
}

/// Summed-area table of pixels with several values each.
pub(crate) struct WindowSums<const N: usize> {
    /// Sums of all values left of and above each corner.
    corners: Vec<[f64; N]>,
    columns: usize,
}

impl<const N: usize> WindowSums<N> {
    pub(crate) fn new(values: impl ExactSizeIterator<Item = [f64; N]>, columns: usize) -> WindowSums<N> {
        let mut corners = vec![[0.0; N]; columns + 1];
        corners.reserve(values.len() + values.len() / columns.max(1));
        let mut of_row = [0.0; N];
        let mut column = 0;
        for value in values {
            if column == 0 {
                of_row = [0.0; N];
                corners.push(of_row);
            }
            let above = corners[corners.len() - columns - 1];
            of_row.iter_mut().zip(value).for_each(|(sum, value)| *sum += value);
            corners.push(std::array::from_fn(|index| above[index] + of_row[index]));
            column = if column + 1 == columns { 0 } else { column + 1 };
        }
        WindowSums { corners, columns }
    }

    /// Sums over the square of pixels within `reach` of a pixel, clipped to the picture, of values
    /// that are not negative.
    fn around(&self, pixel: usize, reach: usize) -> [f64; N] {
        self.signed_around(pixel, reach).map(|sum| sum.max(0.0))
    }

    /// The same of any values.
    pub(crate) fn signed_around(&self, pixel: usize, reach: usize) -> [f64; N] {
        let rows = self.corners.len() / (self.columns + 1) - 1;
        let near = |at: usize, count: usize| [at.saturating_sub(reach), (at + reach + 1).min(count)];
        let [left, right] = near(pixel % self.columns, self.columns);
        let [top, bottom] = near(pixel / self.columns, rows);
        let corner = |x: usize, y: usize| self.corners[y * (self.columns + 1) + x];
        let (first, last) = (corner(left, top), corner(right, bottom));
        let (beside, below) = (corner(right, top), corner(left, bottom));
        std::array::from_fn(|index| last[index] - below[index] - beside[index] + first[index])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn window_sums_are_clipped_to_the_picture() {
        let sums = WindowSums::new((0..12).map(|value| [1.0, f64::from(value)]), 4);
        assert_eq!(sums.around(0, 1), [4.0, 0.0 + 1.0 + 4.0 + 5.0]);
        assert_eq!(sums.around(5, 1), [9.0, [0, 1, 2, 4, 5, 6, 8, 9, 10].iter().sum::<i32>().into()]);
        assert_eq!(sums.around(11, 9), [12.0, 66.0]);
    }
    #[test]
    fn pixels_without_a_second_half_take_the_noise_of_the_others() {
        let pair = Pixel { samples: 2, ..Pixel::default() };
        let known = Pixel { samples: FIRST_SAMPLES, last: 0.5, before: 1.0, ..Pixel::default() };
        let mut pixels = vec![pair; 30];
        pixels[7] = known;
        let errors = pooled_errors((&pixels, NoisePooling::Near), 10, |_| 1);
        let squared = |pixel: usize| errors[pixel].1.squared;
        assert_eq!(squared(7), 0.5);
        // Half as many samples, beside it and far away.
        assert_eq!([squared(6), squared(17), squared(20), squared(29)], [1.0; 4]);
    }

    #[test]
    fn a_pixel_with_few_samples_has_the_noise_of_a_wider_window() {
        let quiet = Pixel { samples: FIRST_SAMPLES, ..Pixel::default() };
        let mut pixels = vec![quiet; 100];
        pixels[33] = Pixel { last: 0.5, before: 1.0, ..quiet };
        let squared = |pixels: &[Pixel], pixel: usize| {
            pooled_errors((pixels, NoisePooling::WideFirst), 10, |_| 1)[pixel].1.squared
        };
        // The 49 pixels around it have the same noise, and those beyond have none.
        assert_eq!([33, 34, 66].map(|pixel| squared(&pixels, pixel)), [0.5 / 49.0; 3]);
        assert_eq!(squared(&pixels, 37), 0.0);
        pixels[33].samples = MIN_KNOWN;
        assert!(squared(&pixels, 33) > 0.1);
    }
}
