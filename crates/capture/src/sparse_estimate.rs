//! The estimate of all pixels from the exposed pixels of a lattice, with its error.

use crate::adaptive::{ERROR_WINDOW, GAIN_WINDOW, Pixel, gain, unit_error};
use crate::lattice::Lattice;
use radsight_adaptive::PixelError;

/// Squared interpolation error of a level relative to the squared residual of the previous level.
/// With the stride, it falls by 16² for a smooth function of four points and by 4² for one with a
/// kink. The profiles of lamps have kinks, blurred by pinhole and lamp.
const RESIDUAL_RATIO: f64 = 1.0 / 16.0;

/// A squared residual this many times that of noise shows interpolation error.
const SIGNIFICANT_RATIO: f64 = 9.0;

/// Mean squared weight of interpolation along both axes: the fraction of a node's variance in each
/// pixel.
const MEAN_SQUARED_WEIGHT: f64 = 0.6;

/// How well the previous level predicts the nodes of a cell.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct InterpolationResidual {
    /// Mean squared difference.
    squared: f64,
    /// Expected from noise alone.
    noise: f64,
}

impl InterpolationResidual {
    /// The squared interpolation error in the cell.
    pub(crate) fn error(&self) -> f64 {
        RESIDUAL_RATIO * self.squared
    }

    /// Whether the residual is more than noise.
    pub(crate) fn is_significant(&self) -> bool {
        self.squared > SIGNIFICANT_RATIO * self.noise
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
    /// The nodes, with the contribution of their noise to the sum of squared errors over all
    /// pixels.
    pub(crate) nodes: Vec<(usize, PixelError)>,
    /// Of each cell.
    pub(crate) residuals: Vec<InterpolationResidual>,
}

impl SparseEstimate {
    /// From the nodes of a lattice, whose levels are those of [`Lattice::nodes`].
    pub(crate) fn new(lattice: &Lattice, levels: &[u8], nodes: &[u8], pixels: &[Pixel]) -> SparseEstimate {
        let mut values: Vec<f64> = pixels.iter().map(Pixel::mean).collect();
        lattice.fill(&mut values, nodes, |weight| weight);
        let errors = node_errors(lattice, nodes, pixels);
        let mut noise = vec![0.0; values.len()];
        errors.iter().for_each(|(pixel, error)| noise[*pixel] = error.squared);
        lattice.fill(&mut noise, nodes, |weight| weight * weight);
        let residuals: Vec<InterpolationResidual> =
            (0..levels.len()).map(|cell| residual(lattice, (cell, levels[cell]), &values, &noise)).collect();
        let mut bias = vec![0.0_f64; values.len()];
        for (cell, residual) in residuals.iter().enumerate() {
            for (pixel, _) in lattice.pixels(cell).filter(|(pixel, _)| nodes[*pixel] == 0) {
                bias[pixel] = bias[pixel].max(residual.error());
            }
        }
        let weigh = |(pixel, error): (usize, PixelError)| {
            let area = Lattice::stride(nodes[pixel]).pow(2) as f64;
            let spread = if area > 1.0 { MEAN_SQUARED_WEIGHT * area } else { 1.0 };
            (pixel, PixelError { squared: spread * error.squared, ..error })
        };
        let nodes = errors.into_iter().map(weigh).collect();
        SparseEstimate { values, noise, bias, nodes, residuals }
    }

    pub(crate) fn mean(&self) -> f64 {
        self.values.iter().sum::<f64>() / self.values.len() as f64
    }

    /// Mean squared error of all pixels due to noise and to interpolation.
    pub(crate) fn squared_errors(&self) -> [f64; 2] {
        [&self.noise, &self.bias].map(|errors| errors.iter().sum::<f64>() / errors.len() as f64)
    }
}

/// The noise of each node, pooled with neighbouring nodes as the adaptive sampler pools pixels.
fn node_errors(lattice: &Lattice, nodes: &[u8], pixels: &[Pixel]) -> Vec<(usize, PixelError)> {
    let columns = lattice.columns();
    let summed = |of_node: fn(&Pixel) -> f64| {
        Sums::new(pixels.iter().zip(nodes).map(|(pixel, node)| if *node > 0 { of_node(pixel) } else { 0.0 }), columns)
    };
    let count = summed(|_| 1.0);
    let last = summed(|pixel| pixel.last * f64::from(pixel.samples));
    let before = summed(|pixel| pixel.before * f64::from(pixel.samples));
    let of_node = |(index, level): (usize, &u8)| {
        let stride = Lattice::stride(*level);
        let mean = |sums: &Sums, reach: usize| sums.around(index, reach * stride) / count.around(index, reach * stride);
        let gain = gain(mean(&last, GAIN_WINDOW), mean(&before, GAIN_WINDOW));
        (index, unit_error(&pixels[index], mean(&last, ERROR_WINDOW), gain, 1.0))
    };
    nodes.iter().enumerate().filter(|(_, level)| **level > 0).map(of_node).collect()
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
    InterpolationResidual { squared: residual.squared / count, noise: residual.noise / count }
}

/// Summed-area table of pixels.
struct Sums {
    /// Sum of all values left of and above each corner.
    corners: Vec<f64>,
    columns: usize,
}

impl Sums {
    fn new(values: impl Iterator<Item = f64>, columns: usize) -> Sums {
        let mut corners = vec![0.0; columns + 1];
        let mut of_row = 0.0;
        for value in values {
            if corners.len().is_multiple_of(columns + 1) {
                of_row = 0.0;
                corners.push(0.0);
            }
            of_row += value;
            corners.push(corners[corners.len() - columns - 1] + of_row);
        }
        Sums { corners, columns }
    }

    /// Sum over the square of pixels within `reach` of a pixel, clipped to the picture.
    fn around(&self, pixel: usize, reach: usize) -> f64 {
        let rows = self.corners.len() / (self.columns + 1) - 1;
        let near = |at: usize, count: usize| [at.saturating_sub(reach), (at + reach + 1).min(count)];
        let [left, right] = near(pixel % self.columns, self.columns);
        let [top, bottom] = near(pixel / self.columns, rows);
        let corner = |x: usize, y: usize| self.corners[y * (self.columns + 1) + x];
        (corner(right, bottom) - corner(left, bottom) - corner(right, top) + corner(left, top)).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn window_sums_are_clipped_to_the_picture() {
        let sums = Sums::new((0..12).map(f64::from), 4);
        assert_eq!(sums.around(0, 1), 0.0 + 1.0 + 4.0 + 5.0);
        assert_eq!(sums.around(5, 1), [0, 1, 2, 4, 5, 6, 8, 9, 10].iter().sum::<i32>().into());
        assert_eq!(sums.around(11, 9), 66.0);
    }
}
