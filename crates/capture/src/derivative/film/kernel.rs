//! What a pixel sees of the points of a film.

use crate::disk_overlap::Parallelogram;
use glam::{DMat2, DVec2};

/// Entries of the table by pixel. The interpolated kernel is a kernel of its own, a hundred-thousandth
/// beside the other, and samples differentiate it exactly.
const PER_PIXEL: f64 = 32.0;

/// The fraction of the pinhole that sees a point of the film from a pixel, by the vector from the
/// middle of the pixel to the point: a table of one quadrant, which is symmetric.
#[derive(Debug)]
pub(super) struct PixelKernel {
    columns: usize,
    values: Vec<f64>,
    /// Beyond it the kernel is 0, pixels along both axes.
    reach: DVec2,
}

impl PixelKernel {
    /// For a shift of a film point per radius of the pinhole.
    pub(super) fn new(shift: DVec2) -> PixelKernel {
        let reach = shift.abs() + 0.5;
        let [columns, rows] = [reach.x, reach.y].map(|reach| (reach * PER_PIXEL).ceil() as usize + 2);
        let to_pinhole = DMat2::from_diagonal(shift.abs().recip());
        let pixel = Parallelogram::new(to_pinhole);
        let at = |index: usize| DVec2::new((index % columns) as f64, (index / columns) as f64) / PER_PIXEL;
        let values = (0..columns * rows).map(|index| pixel.overlap(to_pinhole * at(index)).area).collect();
        PixelKernel { columns, values, reach }
    }

    pub(super) fn reach(&self) -> DVec2 {
        self.reach
    }

    #[inline]
    pub(super) fn at(&self, offset: DVec2) -> f64 {
        let offset = offset.abs();
        if offset.cmpge(self.reach).any() {
            return 0.0;
        }
        let place = offset * PER_PIXEL;
        let [x, y] = [place.x as usize, place.y as usize];
        let along = place - DVec2::new(x as f64, y as f64);
        let row = |row: usize| {
            let first = row * self.columns + x;
            self.values[first] + along.x * (self.values[first + 1] - self.values[first])
        };
        row(y) + along.y * (row(y + 1) - row(y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every point of the film is seen through the whole pinhole, from all pixels together.
    #[test]
    fn the_kernels_of_all_pixels_add_up_to_one() {
        let kernel = PixelKernel::new(DVec2::new(1.9, -1.6));
        for point in [[0.0, 0.0], [0.21, 0.4], [0.49, 0.11], [0.5, 0.5]] {
            let pixels = (-4..=4).flat_map(|y| (-4..=4).map(move |x| DVec2::new(f64::from(x), f64::from(y))));
            let sum: f64 = pixels.map(|pixel| kernel.at(DVec2::from(point) - pixel)).sum();
            assert!((sum - 1.0).abs() < 1e-4, "{sum}");
        }
        assert_eq!(kernel.at(DVec2::new(2.41, 0.0)), 0.0);
    }
}
