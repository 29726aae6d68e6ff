//! Further rays of the finest pixels, where they cost little beside the rest of an interpolated picture.
//!
//! The finest pixels show edges, texture, shadows and noise, where one ray is far from the mean of a pixel. A small
//! picture takes hardly longer with several rays for them than a program needs to start, and one whose irradiance took
//! millions of rays not noticeably longer.
//!
//! Pixels get rays in proportion to the contrast of those around them. Their own value must not decide: rare bright
//! pixels would be averaged with further rays, and dark ones that missed the same light would not.

use crate::grid::{Pixel, numbered};
use crate::interpolated::{Block, PixelMean, SPARE_STREAM, Wanted};
use crate::pixel_sample::mean;
use radsight_render::RayWorker;
use rayon::prelude::*;

/// Number of rays that a small picture casts in all, if it has enough pixels with contrast; they take about a hundredth
/// of a second.
const OF_SMALL_PICTURE: f64 = (1 << 14) as f64;

/// Number of rays that are cast for the finest pixels, relative to those of cached irradiance.
const OF_CACHE: f64 = 1.0 / 16.0;

/// Number of further rays of a pixel that has any.
const LEAST: u32 = 4;
const MOST: u32 = 16;

/// Number of steps that halve the interval of the factor between contrast and rays.
const HALVINGS: u32 = 24;

impl Block<'_> {
    /// The number of further rays through pixels.
    fn spare_rays(&self) -> f64 {
        let [casts, of_finest] = [self.casts, self.casts_of_finest].map(|casts| casts as f64);
        let fraction = self.fraction();
        let spare = fraction * f64::max(OF_SMALL_PICTURE - casts / fraction, OF_CACHE * self.renderer.casts_of_cache());
        spare * self.finest.len() as f64 / of_finest.max(1.0)
    }

    /// The fraction of the picture's rows that are in the block.
    pub(crate) fn fraction(&self) -> f64 {
        self.rows as f64 / self.camera.rows() as f64
    }

    /// Adds further rays to the means of the finest pixels.
    pub(crate) fn add_spare_rays(&self, means: &mut [PixelMean]) {
        let spare = self.spare_rays();
        if spare < f64::from(LEAST) {
            return;
        }
        let dark = self.typical_darkness();
        let contrast = |wanted: &Wanted| self.contrast_around(wanted.pixel, (means, dark));
        let contrasts: Vec<f64> = self.finest.par_iter().with_min_len(256).map(contrast).collect();
        let rays = shared_out(&contrasts, spare);
        let chosen: Vec<(&Wanted, u32)> = self.finest.iter().zip(rays).filter(|(_, rays)| *rays > 0).collect();
        let renderer = self.renderer;
        let sums: Vec<[f64; 3]> = chosen
            .par_iter()
            .with_min_len(16)
            .map_init(|| renderer.worker(), |worker, (wanted, rays)| self.sum_of_rays(worker, wanted, *rays))
            .collect();
        for ((wanted, rays), sum) in chosen.into_iter().zip(sums) {
            let Some(index) = self.samples.index(self.at(wanted.pixel)) else { continue };
            let PixelMean { mean, rays: before } = means[index];
            let all = before + rays;
            let mean = [0, 1, 2].map(|band| (f64::from(before) * mean[band] + sum[band]) / f64::from(all));
            means[index] = PixelMean { mean, rays: all };
        }
    }

    /// The standard deviation of the pixels around one that see the same surface, relative to their mean.
    fn contrast_around(&self, pixel: Pixel, (means, dark): (&[PixelMean], f64)) -> f64 {
        let at = self.at(pixel);
        let (Some(own), Some(sample)) = (self.samples.index(at), self.samples.get(at)) else { return 0.0 };
        let (mut count, mut sum, mut squares) = (0.0, 0.0, 0.0);
        for (near, _) in
            self.around(pixel).filter(|(near, other)| *near != own && sample.surface.continues(&other.surface))
        {
            let value = mean(&means[near].mean);
            (count, sum, squares) = (count + 1.0, sum + value, squares + value * value);
        }
        let mean = sum / f64::max(count, 1.0);
        (squares / f64::max(count, 1.0) - mean * mean).max(0.0).sqrt() / (mean + dark).max(f64::MIN_POSITIVE)
    }

    /// The sum of so many further rays through a pixel.
    fn sum_of_rays(&self, worker: &mut RayWorker<'_>, wanted: &Wanted, rays: u32) -> [f64; 3] {
        let pixel = [wanted.pixel.0, wanted.pixel.1 + self.first_row];
        let near = self.records_around(wanted);
        let mut sum = [0.0; 3];
        for number in 0..rays {
            let index = numbered(pixel, (1, SPARE_STREAM), MOST, number);
            let of_ray = self.value_of_ray(worker, (pixel, index), (near.as_deref(), &mut None));
            sum = [0, 1, 2].map(|band| sum[band] + of_ray.value[band]);
        }
        sum
    }
}

/// The number of further rays of each pixel, in proportion to its contrast, with about so many in all.
fn shared_out(contrasts: &[f64], spare: f64) -> Vec<u32> {
    let rays = |contrast: f64, factor: f64| {
        let wanted = (factor * contrast) as u32;
        if wanted < LEAST { 0 } else { wanted.min(MOST) }
    };
    let all = |factor: f64| contrasts.iter().map(|contrast| f64::from(rays(*contrast, factor))).sum::<f64>();
    let highest = contrasts.iter().copied().fold(0.0, f64::max);
    // The contrast that is worth the most rays; at the higher end no pixel has any.
    let (mut low, mut high) = (0.0, 1.01 * highest * f64::from(MOST) / f64::from(LEAST));
    for _ in 0..HALVINGS {
        let contrast = 0.5 * (low + high);
        if all(f64::from(MOST) / contrast) > spare { low = contrast } else { high = contrast }
    }
    let factor = if high > 0.0 { f64::from(MOST) / high } else { 0.0 };
    contrasts.iter().map(|contrast| rays(*contrast, factor)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_follow_the_contrast() {
        assert_eq!(shared_out(&[0.0, 0.1, 0.2, 0.4], 20.0), [0, 0, 6, 13]);
        assert_eq!(shared_out(&[0.3, 0.3, 0.3, 0.4], 6.0), [0, 0, 0, 5]);
    }

    #[test]
    fn no_more_rays_than_spare_ones_are_shared_out() {
        let contrasts: Vec<f64> = (0..1_000).map(|i| f64::from(i * 619 % 1_000) / 700.0).collect();
        for spare in [4.0, 100.0, 1_000.0, 5_000.0] {
            let all: u32 = shared_out(&contrasts, spare).into_iter().sum();
            assert!((0.9 * spare - 15.0..=spare).contains(&f64::from(all)), "{all} of {spare}");
        }
        assert_eq!(shared_out(&[0.3; 4], 1e9), [16; 4]);
        assert_eq!(shared_out(&[0.0; 4], 1e9), [0; 4]);
    }
}
