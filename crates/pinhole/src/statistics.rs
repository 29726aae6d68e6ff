//! A running estimate of the standard error of a pixel's average.

/// Maximum number of blocks; when all are full, neighbours are merged and blocks become twice as
/// long.
const BLOCKS: usize = 16;

/// Running mean of a pixel's samples, with a standard error from the means of blocks.
///
/// Samples of a scrambled low-discrepancy sequence are not independent, but whole aligned blocks of
/// 2ᵏ nearly are. The variance of the block means overestimates the error, since blocks also
/// balance each other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelStatistics {
    full: [f64; BLOCKS],
    blocks: usize,
    block_length_log2: u32,
    open: f64,
    in_open: u64,
    sum: f64,
    count: u64,
}

impl PixelStatistics {
    /// Adds the next sample: L·cos⁴θ of the next ray.
    pub fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
        self.open += value;
        self.in_open += 1;
        if self.in_open == 1 << self.block_length_log2 {
            self.close_block();
        }
    }

    fn close_block(&mut self) {
        self.full[self.blocks] = self.open / self.in_open as f64;
        self.blocks += 1;
        (self.open, self.in_open) = (0.0, 0);
        if self.blocks == BLOCKS {
            for pair in 0..BLOCKS / 2 {
                self.full[pair] = 0.5 * (self.full[2 * pair] + self.full[2 * pair + 1]);
            }
            self.blocks = BLOCKS / 2;
            self.block_length_log2 += 1;
        }
    }

    /// Number of samples so far.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The mean of all samples; 0 before the first.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.sum / self.count.max(1) as f64
    }

    /// The estimated standard error of the mean, in the unit of the samples; infinite before the
    /// second block.
    #[must_use]
    pub fn standard_error(&self) -> f64 {
        if self.blocks < 2 {
            return f64::INFINITY;
        }
        let blocks = self.blocks as f64;
        let full = &self.full[..self.blocks];
        let mean = full.iter().sum::<f64>() / blocks;
        let squares: f64 = full.iter().map(|block| (block - mean).powi(2)).sum();
        (squares / (blocks - 1.0) / blocks).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use radsight_sampling::{DimensionSet, RaySampler};

    #[test]
    fn the_mean_is_that_of_all_samples() {
        let mut statistics = PixelStatistics::default();
        (0..1000).for_each(|value| statistics.add(f64::from(value)));
        assert_eq!((statistics.mean(), statistics.count()), (499.5, 1000));
    }

    #[test]
    fn one_sample_gives_no_error_estimate() {
        let mut statistics = PixelStatistics::default();
        statistics.add(1.0);
        assert_eq!(statistics.standard_error(), f64::INFINITY);
        statistics.add(1.0);
        assert_eq!(statistics.standard_error(), 0.0);
    }

    /// Over many pixels the estimate must be neither too low nor uselessly high.
    #[test]
    fn the_estimated_error_covers_the_true_error() {
        let (mut estimated, mut true_error) = (0.0, 0.0);
        for pixel in 0..400u64 {
            let mut statistics = PixelStatistics::default();
            for sample in 0..128 {
                let u = RaySampler::new(5, pixel * 128 + sample).take(DimensionSet::CAMERA);
                let inside = (u[0] - 0.5).hypot(u[1] - 0.5) < 0.4 && u[2] + u[3] > 0.7;
                statistics.add(f64::from(u8::from(inside)));
            }
            let truth = std::f64::consts::PI * 0.16 * (1.0 - 0.49 / 2.0);
            true_error += (statistics.mean() - truth).powi(2) / 400.0;
            estimated += statistics.standard_error().powi(2) / 400.0;
        }
        let ratio = (estimated / true_error).sqrt();
        assert!((0.9..4.0).contains(&ratio), "estimated over true error is {ratio}");
    }
}
