//! A rectangle of a picture whose other parts are rendered elsewhere.

use crate::light_strata::LightStrata;
use crate::view_camera::{ViewCamera, traced};
use radsight_adaptive::{MAX_SAMPLES, ray_number};
use radsight_render::{RayWorker, Renderer};
use radsight_sampling::{DimensionSet, RaySampler};
use rayon::prelude::*;
use std::ops::Range;

/// A pixel with a fixed number of samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SampledPixel {
    /// The mean of its samples, W/(sr·m²): equal to the last bit to that of [`crate::Film`] with
    /// [`crate::SamplingBudget::Samples`].
    pub mean: [f64; 3],
    /// Half the difference between the means of its two halves, which estimates the standard error
    /// of the mean; NaN with one sample.
    pub half_difference: [f64; 3],
}

/// The pixels of a rectangle, top row first, with a fixed number of samples each. Independent of
/// other pixels and of threads.
///
/// # Panics
/// If the camera has fewer columns or rows.
#[must_use]
pub fn sampled_tile(
    renderer: &Renderer,
    camera: &ViewCamera,
    (columns, rows): (Range<usize>, Range<usize>),
    samples: u32,
) -> Vec<SampledPixel> {
    assert!(columns.end <= camera.columns(), "columns to {} of {}", columns.end, camera.columns());
    assert!(rows.end <= camera.rows(), "rows to {} of {}", rows.end, camera.rows());
    let samples = samples.clamp(1, MAX_SAMPLES);
    let strata = LightStrata::for_samples(samples, renderer.plan(), camera, (columns.clone(), rows.clone()));
    let source = PixelRays { renderer, camera, strata: &strata };
    let width = columns.len();
    let pixel = |place: usize| (rows.start + place / width) * camera.columns() + columns.start + place % width;
    (0..width * rows.len())
        .into_par_iter()
        .with_min_len(16)
        .map_init(|| renderer.worker(), |worker, place| sampled(worker, &source, pixel(place), samples))
        .collect()
}

fn sampled(worker: &mut RayWorker<'_>, rays: &PixelRays<'_, '_>, pixel: usize, samples: u32) -> SampledPixel {
    let (mut sum, mut first_half) = ([0.0; 3], [0.0; 3]);
    let half = samples / 2;
    for sample in 0..samples {
        if sample == half {
            first_half = sum;
        }
        let value = rays.radiance(worker, pixel, sample);
        sum = std::array::from_fn(|band| sum[band] + value[band]);
    }
    let halves = [f64::from(half), f64::from(samples - half)];
    let half_difference =
        std::array::from_fn(|band| 0.5 * ((sum[band] - first_half[band]) / halves[1] - first_half[band] / halves[0]));
    SampledPixel { mean: sum.map(|sum| sum / f64::from(samples)), half_difference }
}

/// The rays of pixels.
pub(crate) struct PixelRays<'f, 'r> {
    pub(crate) renderer: &'r Renderer,
    pub(crate) camera: &'f ViewCamera,
    pub(crate) strata: &'f LightStrata,
}

impl PixelRays<'_, '_> {
    /// The weighted radiance of a sample of a pixel. Every pixel has its own scramble of the
    /// sequence.
    pub(crate) fn radiance(&self, worker: &mut RayWorker<'_>, pixel: usize, sample: u32) -> [f64; 3] {
        let (column, row) = (pixel % self.camera.columns(), pixel / self.camera.columns());
        let index = ray_number(pixel as u64, sample);
        let sampler = RaySampler::new(self.renderer.plan().seed(), index);
        let [x, y, across, along] = sampler.take(DimensionSet::CAMERA);
        let ([x, y], weight) = self.strata.place(pixel, [x, y]);
        let ray = self.camera.ray_of(column, row, [x, y, across, along], &sampler);
        ray.and_then(|ray| traced(worker, index, &ray))
            .map_or([0.0; 3], |traced| traced.value.map(|band| weight * band))
    }
}
