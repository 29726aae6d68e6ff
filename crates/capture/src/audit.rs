//! Comparison of interpolated pixels with their own rays.

use crate::lattice::Lattice;
use crate::neighbourhood::around;

/// Minimum number of audited rays of a cell, and the number of standard errors from which a mean
/// residual is significant.
const MIN_AUDITED: f64 = 8.0;
const SIGNIFICANT_ERRORS: f64 = 5.0;

/// A ray this many times as bright as the brightest pixel of its cell has hit something that the
/// lattice missed.
const OUTLIER_RATIO: f64 = 30.0;

/// The residuals of audited pixels, by cell.
pub(crate) struct Audit {
    cells: Vec<Residuals>,
}

/// Differences between rays and interpolation.
#[derive(Clone, Copy, Debug, Default)]
struct Residuals {
    count: f64,
    sum: f64,
    squares: f64,
    has_outlier: bool,
}

impl Residuals {
    fn added(self, other: &Residuals) -> Residuals {
        Residuals {
            count: self.count + other.count,
            sum: self.sum + other.sum,
            squares: self.squares + other.squares,
            has_outlier: self.has_outlier || other.has_outlier,
        }
    }

    /// Whether the mean differs significantly from zero, and its square exceeds `allowed`.
    fn are_wrong(&self, allowed: f64) -> bool {
        let mean = self.sum / self.count;
        let variance = (self.squares / self.count - mean * mean).max(0.0) / (self.count - 1.0);
        let least = allowed.max(SIGNIFICANT_ERRORS * SIGNIFICANT_ERRORS * variance);
        self.count >= MIN_AUDITED && mean * mean > least
    }
}

impl Audit {
    /// `traced` is NaN where no ray was traced.
    pub(crate) fn new(lattice: &Lattice, values: &[f64], traced: &[f64]) -> Audit {
        let of_cell = |cell: usize| {
            let pixels = || lattice.pixels(cell).map(|(pixel, _)| pixel);
            let brightest = pixels().map(|pixel| values[pixel]).fold(0.0, f64::max);
            let mut residuals = Residuals::default();
            for pixel in pixels().filter(|pixel| !traced[*pixel].is_nan()) {
                let residual = traced[pixel] - values[pixel];
                residuals.count += 1.0;
                residuals.sum += residual;
                residuals.squares += residual * residual;
                residuals.has_outlier |= traced[pixel] > OUTLIER_RATIO * brightest;
            }
            residuals
        };
        let [across, down] = lattice.cells();
        Audit { cells: (0..across * down).map(of_cell).collect() }
    }

    /// The cells with significant residuals, alone or together with their neighbours, and their new
    /// levels. Mean residuals whose square is below `allowed` are left to
    /// [`Corrections`](crate::correction::Corrections).
    pub(crate) fn cells_to_refine(&self, lattice: &Lattice, levels: &[u8], allowed: f64) -> Vec<(usize, u8)> {
        let size = lattice.cells();
        let judge = |cell: usize| {
            let alone = &self.cells[cell];
            if alone.has_outlier {
                return Some((cell, lattice.finest()));
            }
            let together = around(cell, size).fold(Residuals::default(), |sum, near| sum.added(&self.cells[near]));
            let is_wrong = alone.are_wrong(allowed) || together.are_wrong(allowed);
            (alone.count > 0.0 && is_wrong).then_some((cell, levels[cell] + 1))
        };
        (0..self.cells.len()).filter_map(judge).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The cells to refine for a residual of each pixel; all pixels are audited and have a value of 1.
    fn refined(residual: impl Fn(usize) -> f64) -> Vec<(usize, u8)> {
        let lattice = Lattice::new([64; 2], 64, [0.5; 2]).expect("the picture is large enough");
        let count = lattice.pixel_count();
        let traced: Vec<f64> = (0..count).map(|pixel| 1.0 + residual(pixel)).collect();
        let levels = vec![1; lattice.cells().iter().product()];
        Audit::new(&lattice, &vec![1.0; count], &traced).cells_to_refine(&lattice, &levels, 0.01)
    }

    fn noise(pixel: usize) -> f64 {
        if (pixel + pixel / 64).is_multiple_of(2) { 0.5 } else { -0.5 }
    }

    #[test]
    fn noise_is_no_error() {
        assert_eq!(refined(noise), []);
    }

    #[test]
    fn a_wrong_mean_refines_cells_by_one_level() {
        let found = refined(|pixel| noise(pixel) + 0.5);
        assert!(!found.is_empty() && found.iter().all(|(_, level)| *level == 2), "{found:?}");
    }

    #[test]
    fn a_small_mean_is_left_to_corrections() {
        assert_eq!(refined(|_| 0.09), []);
        assert!(!refined(|_| 0.11).is_empty());
    }

    #[test]
    fn a_bright_ray_refines_its_cell_alone() {
        let found = refined(|pixel| if pixel == 64 * 30 + 30 { 40.0 } else { noise(pixel) });
        assert!(matches!(found[..], [(_, level)] if level > 2), "{found:?}");
    }
}
