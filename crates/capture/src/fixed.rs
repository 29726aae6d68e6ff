//! The same number of rays for every pixel.

use crate::{Exposure, Progress};
use radsight_pinhole::{BandWeights, CameraRay, PixelAverage, Rays};
use radsight_render::{Ray, RayWorker, Renderer};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Pixels that a thread takes at a time.
const CHUNK: usize = 64;

/// Exposes every pixel with the rays of `rays`.
#[must_use]
pub fn expose_with_samples(
    renderer: &Renderer,
    rays: &Rays,
    weights: &BandWeights,
    progress: &dyn Progress,
) -> Exposure {
    let camera = rays.camera();
    let pixels = camera.pixel_count();
    let mut values = vec![0.0; pixels as usize];
    let is_left_out = AtomicBool::new(false);
    let done = AtomicU64::new(0);
    values.par_chunks_mut(CHUNK).enumerate().for_each_init(
        || renderer.worker(),
        |worker, (chunk, values)| {
            if progress.stops() {
                return is_left_out.store(true, Ordering::Relaxed);
            }
            for (pixel, value) in ((chunk * CHUNK) as u64..).zip(values.iter_mut()) {
                let mut average = PixelAverage::default();
                for sample in 0..rays.samples() {
                    let index = pixel * u64::from(rays.samples()) + u64::from(sample);
                    let ray = rays.of_sample(pixel, sample);
                    average.add(ray.cos4, radiance(worker, index, (rays, pixel), &ray, weights));
                }
                *value = average.exposure(camera);
            }
            let before = done.fetch_add(values.len() as u64, Ordering::Relaxed);
            progress.report(before + values.len() as u64, pixels);
        },
    );
    let (pixels_done, is_partial) = (done.into_inner(), is_left_out.into_inner());
    let traced = pixels_done * u64::from(rays.samples());
    Exposure { values, rays: traced, estimated_error: None, pixels_done, is_partial, pixels: None }
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
