//! The radiance of a camera's rays.

use crate::Workers;
use radsight_pinhole::{BandWeights, CameraRay, Rays};
use radsight_render::Ray;

/// Maximum number of bands of a renderer.
pub(crate) const MAX_BANDS: usize = 3;

/// Number of separate bands; 0 if bands are added up ray by ray.
pub(crate) fn bands_apart(rays: &Rays, weights: &BandWeights) -> usize {
    rays.bands_apart(weights).map_or(0, |bands| bands.min(MAX_BANDS))
}

/// The radiance of ray number `index` of a pixel, bands added up.
#[inline]
pub(crate) fn radiance(
    worker: &mut Workers<'_>,
    index: u64,
    (rays, pixel): (&Rays, u64),
    ray: &CameraRay,
    weights: &BandWeights,
) -> f64 {
    let combine = |mut value: [f64; MAX_BANDS]| {
        let bands = &mut value[..weights.as_slice().len().min(MAX_BANDS)];
        rays.weigh_bands(ray, bands);
        [weights.combine_at(pixel, bands)]
    };
    let [sum] = traced(worker, index, (rays, pixel), ray, combine);
    sum
}

/// The radiance by separate band; the others are 0.
pub(crate) fn radiance_apart(
    worker: &mut Workers<'_>,
    index: u64,
    (rays, pixel): (&Rays, u64),
    ray: &CameraRay,
    weights: &BandWeights,
) -> [f64; MAX_BANDS] {
    let kept = bands_apart(rays, weights);
    let known = weights.as_slice().len().min(MAX_BANDS);
    let keep = |value: [f64; MAX_BANDS]| {
        let mut bands = [0.0; MAX_BANDS];
        rays.keep_apart(ray, &value[..known], &mut bands[..kept]);
        bands
    };
    traced(worker, index, (rays, pixel), ray, keep)
}

/// Sum over all renderers of what `light` computes from the radiance of a ray.
#[inline]
fn traced<const N: usize>(
    worker: &mut Workers<'_>,
    index: u64,
    (rays, pixel): (&Rays, u64),
    ray: &CameraRay,
    light: impl Fn([f64; MAX_BANDS]) -> [f64; N],
) -> [f64; N] {
    // A stop blocks the ray.
    if ray.cos4 == 0.0 {
        return [0.0; N];
    }
    let Some(traced) = Ray::new(ray.origin, ray.direction) else { return [0.0; N] };
    let mut sum = light(worker.main.trace(index, &traced).value);
    for (lamps, brightness) in &mut worker.by_row {
        let row = (pixel / u64::from(rays.camera().columns())) as usize;
        // Equal ray numbers draw equal samples. This is harmless: each term of the sum is unbiased.
        let of_lamps = light(lamps.trace(index, &traced).value);
        let share = brightness.get(row).copied();
        sum.iter_mut().zip(of_lamps).for_each(|(sum, light)| *sum += share.map_or(0.0, |share| share * light));
    }
    sum
}
