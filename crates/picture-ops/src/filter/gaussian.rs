//! The Gaussian filter, tabulated.

use super::{Bar, Resampling};
use std::f64::consts::PI;

/// Support of the filter, in radii.
pub(super) const REACH: f64 = 2.0;
/// √(4/π): a disk of this radius has the area of a square with a side of two radii.
pub(super) const DISK: f64 = 1.13;
/// Table entries per unit of squared distance.
const STEPS: f64 = 20.0;

/// exp(−d²) of the squared distance d² in radii, constant within an input pixel.
#[derive(Debug)]
pub(super) struct Gaussian {
    pub(super) radius: f64,
    table: Vec<f32>,
}

impl Gaussian {
    pub(super) fn new(radius: f64, resampling: &Resampling) -> Gaussian {
        let plateau = plateau(radius, resampling);
        let entries = (444.0 * REACH * REACH) as usize;
        let flat = (-plateau).exp() as f32;
        let value = |index: usize| {
            let distance = index as f64 * 0.05;
            if index == 0 || distance <= plateau { flat } else { (-(index as f64) * 0.05).exp() as f32 }
        };
        Gaussian { radius, table: (0..entries).map(value).collect() }
    }

    /// Scales the table so that the weights of an output pixel sum to the area of an input pixel.
    pub(super) fn normalized(mut self, resampling: &Resampling) -> Gaussian {
        let plateau = plateau(self.radius, resampling);
        let mut integral = PI * plateau * (-plateau).exp();
        let mut distance = plateau.sqrt() + 0.05;
        while distance <= DISK * REACH {
            integral += 0.1 * 2.0 * PI * distance * (-distance * distance).exp();
            distance += 0.1;
        }
        let scale = resampling.x_scale * resampling.y_scale / (self.radius * self.radius * integral);
        self.table.iter_mut().for_each(|weight| *weight = (f64::from(*weight) * scale) as f32);
        self
    }

    /// The weight at the centre.
    pub(super) fn middle(&self) -> f32 {
        self.table[0]
    }

    /// The weight at a squared distance in radii.
    pub(super) fn weight(&self, squared: f64) -> f32 {
        self.table.get((STEPS * squared + 0.5) as usize).copied().unwrap_or(0.0)
    }

    /// Support of the filter along an axis, input pixels.
    pub(super) fn reach(&self, scale: f64) -> usize {
        (REACH * self.radius / scale + 1.0) as usize
    }

    /// Computes an output pixel. `N` is the number of components, or 0 if only `sums` knows it.
    pub(super) fn put<const N: usize>(
        &self,
        row: usize,
        column: usize,
        resampling: &Resampling,
        bar: &Bar,
        sums: &mut [f32],
    ) {
        let components = if N == 0 { sums.len() } else { N };
        let sums = &mut sums[..components];
        let (across, down) = (self.reach(resampling.x_scale) as isize, self.reach(resampling.y_scale) as isize);
        let (middle_column, middle_row) =
            (resampling.middle_column(column) as isize, resampling.middle_row(row) as isize);
        let rows = (middle_row - down).max(0)..(middle_row + down + 1).min(resampling.in_rows as isize);
        let columns = resampling.inside(middle_column - across..middle_column + across + 1);
        let mut total = 1e-6;
        sums.fill(0.0);
        for y in rows {
            let dy = (resampling.y_scale * (y as f64 + 0.5) - (row as f64 + 0.5)) / self.radius;
            let scanline = bar.row(y as usize);
            for x in columns.clone() {
                let dx = (resampling.x_scale * (x as f64 + 0.5) - (column as f64 + 0.5)) / self.radius;
                let weight = self.weight(dx * dx + dy * dy);
                total += f64::from(weight);
                let pixel = &scanline[resampling.wrapped(x) * components..][..components];
                for (sum, value) in sums.iter_mut().zip(pixel) {
                    *sum += *value * weight;
                }
            }
        }
        let scale = (1.0 / total) as f32;
        sums.iter_mut().for_each(|sum| *sum *= scale);
    }
}

/// The squared distance, in radii, within which the filter is constant: half an input pixel.
fn plateau(radius: f64, resampling: &Resampling) -> f64 {
    resampling.x_scale * resampling.y_scale * 0.25 / (radius * radius)
}
