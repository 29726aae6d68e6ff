//! The estimate of all pixels from the exposed pixels of a lattice, with its error.

use crate::edges::EdgeBlurs;
use crate::film::UnblurredFilm;
use crate::lattice::Lattice;
use crate::pinhole_blur::PinholeBlur;
use crate::pixel_errors::{NoisePooling, pooled_errors};
use crate::sums::Pixel;
use radsight_adaptive::PixelError;

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

/// Squared error due to points outside a cell from which it counts, relative to the requested mean squared
/// error. Less is left to corrections.
const LEAST_OUTSIDE: f64 = 16.0;

/// Squared difference from a prediction, relative to its expected noise, from which it is no noise.
const SIGNIFICANT: f64 = 9.0;

/// How well the previous level predicts the nodes of a cell.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct InterpolationResidual {
    /// Mean squared difference.
    squared: f64,
    /// Expected from noise alone.
    noise: f64,
    /// Squared error of interpolation relative to the squared difference.
    ratio: f64,
    /// Squared error due to points outside the cell that the previous level does not predict.
    outside: f64,
}

impl InterpolationResidual {
    /// The squared interpolation error in the cell.
    pub(crate) fn error(&self) -> f64 {
        self.without_noise().max(0.0)
    }

    /// The same, with an error of its own that vanishes in the mean over many cells.
    fn without_noise(&self) -> f64 {
        let own = self.ratio * (self.squared - self.noise);
        if self.outside > 0.0 { own.max(self.outside) } else { own }
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
    /// The cells have levels and ratios of residuals. The requested squared error is relative to the squared
    /// mean.
    pub(crate) fn new(
        lattice: &Lattice,
        (levels, ratios): (&[u8], &[f64]),
        nodes: &[u8],
        (pixels, pooling): (&[Pixel], NoisePooling),
        (film, requested): (Option<&UnblurredFilm>, f64),
    ) -> SparseEstimate {
        let mut values: Vec<f64> = pixels.iter().map(Pixel::mean).collect();
        lattice.fill(&mut values, nodes, |weight| weight);
        let errors = node_errors(lattice, nodes, (pixels, pooling));
        let mut noise = vec![0.0; values.len()];
        errors.iter().for_each(|(pixel, error)| noise[*pixel] = error.squared);
        lattice.fill(&mut noise, nodes, |weight| weight * weight);
        let unpredicted = unpredicted(lattice, &values, &noise);
        let least = LEAST_OUTSIDE * requested * (values.iter().sum::<f64>() / values.len() as f64).powi(2);
        let outside = |cell: usize| {
            let squared = lattice.weighted_outside((cell, levels[cell]), &unpredicted);
            if squared > least { squared } else { 0.0 }
        };
        let residuals: Vec<InterpolationResidual> = (0..levels.len())
            .map(|cell| InterpolationResidual {
                ratio: ratios[cell],
                outside: outside(cell),
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
                // The kernel's weights are negative here and there, and so are some shares in the margin.
                Some(film) => film.share(pixel).max(0.0) * film.squared_weights(area, MEAN_SQUARED_WEIGHT),
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
        for ((pixel, _), area) in self.nodes.iter().zip(&self.areas) {
            spread[*pixel] = film.squared_weights(*area, MEAN_SQUARED_WEIGHT) * self.noise[*pixel] / area;
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

/// By pixel: the squared difference of a node from what the previous level predicts for it, beyond its
/// noise; 0 where it may be noise.
fn unpredicted(lattice: &Lattice, values: &[f64], noise: &[f64]) -> Vec<f64> {
    let of_pixel = |pixel: usize| {
        let Some(predicted) = lattice.predicted(pixel, values, |weight| weight) else { return 0.0 };
        let expected = noise[pixel] + lattice.predicted(pixel, noise, |weight| weight * weight).unwrap_or(0.0);
        let squared = (values[pixel] - predicted).powi(2);
        if squared > SIGNIFICANT * expected { squared - expected } else { 0.0 }
    };
    (0..values.len()).map(of_pixel).collect()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::tests::{film, in_picture};
    use crate::lattice::LEAST_FILM_SIDE;
    use crate::pinhole_derivatives::PinholeDerivatives;
    use crate::sums::Sums;

    /// Where the nodes of a film have the same noise, all pixels of its picture have, those at the border too.
    #[test]
    fn noise_without_a_place_is_that_of_all_pixels() {
        let film = film([1.8, 1.6], [24, 20]);
        let lattice = Lattice::new(film.size().map(|count| count as u32), LEAST_FILM_SIDE, [0.5; 2]);
        let lattice = lattice.expect("the film is large enough");
        let levels = vec![lattice.finest(); lattice.cells().iter().product()];
        let nodes = lattice.nodes(&levels);
        let sums = Sums { whole: 4.0, ..Sums::default() };
        let pixels = vec![Pixel { samples: 4, sums, last: 0.01, before: 0.02 }; film.pixel_count()];
        let cells = (&*levels, &*vec![SMOOTH_RATIO; levels.len()]);
        let estimate = SparseEstimate::new(&lattice, cells, &nodes, (&pixels, NoisePooling::Near), (Some(&film), 1e-4));
        let blur = PinholeBlur { film: &film, derivatives: PinholeDerivatives::zero(&film), subpixels: None };
        let noise = in_picture(&film, &estimate.blurred(&blur, (&lattice, &nodes)).noise);
        let mean = noise.iter().sum::<f64>() / noise.len() as f64;
        assert!((mean / estimate.squared_errors()[0] - 1.0).abs() < 1e-9, "{mean}");
        assert!(noise.iter().all(|own| (own / mean - 1.0).abs() < 0.2), "{mean}: {noise:?}");
    }
}
