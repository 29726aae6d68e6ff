//! The same number of rays for every pixel.

use crate::checkpoint::{Checkpoint, FixedState, State};
use crate::{Exposer, Exposure, Progress};
use radsight_pinhole::{BandWeights, CameraRay, PixelAverage, Rays};
use radsight_render::{Ray, RayWorker};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// Pixels that a thread takes at a time.
const CHUNK: usize = 64;

impl Exposer<'_> {
    /// Exposes every pixel with its rays of [`Rays`]; goes on with a checkpoint of as many rays a pixel.
    #[must_use]
    pub fn with_samples(&self, start: Option<Checkpoint>, progress: &dyn Progress) -> Exposure {
        let samples = self.rays.samples();
        let pixels = self.rays.camera().pixel_count();
        let mut values = match start {
            Some(Checkpoint(State::Fixed(state))) if state.samples == samples => state.values,
            _ => Vec::new(),
        };
        values.resize(pixels as usize, None);
        let known = |values: &[Option<f64>]| values.iter().flatten().count() as u64;
        let checkpoint =
            |values: &[Option<f64>]| Checkpoint(State::Fixed(FixedState { samples, values: values.to_vec() }));
        loop {
            self.expose_unknown(&mut values, progress);
            if known(&values) == pixels || progress.stops() {
                break;
            }
            progress.save(checkpoint(&values));
        }
        let pixels_done = known(&values);
        Exposure {
            checkpoint: checkpoint(&values),
            values: values.into_iter().map(|value| value.unwrap_or(0.0)).collect(),
            rays: pixels_done * u64::from(samples),
            estimated_error: None,
            pixels_done,
            is_partial: pixels_done < pixels,
            pixels: None,
        }
    }

    /// Exposes what is not known yet, until it is all or something else is wanted.
    fn expose_unknown(&self, values: &mut [Option<f64>], progress: &dyn Progress) {
        let pixels = values.len() as u64;
        let done = AtomicU64::new(values.iter().flatten().count() as u64);
        values.par_chunks_mut(CHUNK).enumerate().for_each_init(
            || self.renderer.worker(),
            |worker, (chunk, values)| {
                if progress.stops() || progress.wants_checkpoint() {
                    return;
                }
                let mut exposed = 0;
                for (pixel, value) in ((chunk * CHUNK) as u64..).zip(values).filter(|(_, value)| value.is_none()) {
                    *value = Some(self.exposure(worker, pixel));
                    exposed += 1;
                }
                let before = done.fetch_add(exposed, Ordering::Relaxed);
                progress.report(before + exposed, pixels);
            },
        );
    }

    /// E_pixel of one pixel in J/m².
    fn exposure(&self, worker: &mut RayWorker<'_>, pixel: u64) -> f64 {
        let rays = self.rays;
        let mut average = PixelAverage::default();
        for sample in 0..rays.samples() {
            let index = pixel * u64::from(rays.samples()) + u64::from(sample);
            let ray = rays.of_sample(pixel, sample);
            average.add(ray.cos4, radiance(worker, index, (rays, pixel), &ray, self.weights));
        }
        average.exposure(rays.camera())
    }
}

/// The radiance of ray number `index`, which goes to a pixel, bands added up.
#[inline]
pub(crate) fn radiance(
    worker: &mut RayWorker<'_>,
    index: u64,
    (rays, pixel): (&Rays, u64),
    ray: &CameraRay,
    weights: &BandWeights,
) -> f64 {
    // Nothing comes through a stop.
    if ray.cos4 == 0.0 {
        return 0.0;
    }
    match Ray::new(ray.origin, ray.direction) {
        Some(traced) => {
            let mut value = worker.trace(index, &traced).value;
            let bands = &mut value[..weights.as_slice().len().min(3)];
            rays.weigh_bands(ray, bands);
            weights.combine_at(pixel, bands)
        }
        None => 0.0,
    }
}
