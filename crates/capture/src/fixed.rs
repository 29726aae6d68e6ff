//! The same number of rays for every pixel.

use crate::checkpoint::{Checkpoint, FixedState, State};
use crate::{Exposer, Exposure, Progress, Workers};
use radsight_pinhole::{BandWeights, CameraRay, PixelAverage, Rays};
use radsight_render::Ray;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

/// Pixels that a thread takes at a time.
const CHUNK: usize = 64;

impl Exposer<'_> {
    /// Exposes every pixel with its rays of [`Rays`]; goes on with a checkpoint of as many rays a pixel.
    #[must_use]
    pub fn with_samples(&self, start: Option<Checkpoint>, progress: &dyn Progress) -> Exposure {
        let samples = self.rays.samples();
        let pixels = self.rays.camera().pixel_count();
        let cells = self.rays.cells();
        let mut values = match start {
            Some(Checkpoint(State::Fixed(state))) if state.samples == samples => state.values,
            _ => Vec::new(),
        };
        values.resize(cells as usize, None);
        let known = |values: &[Option<f64>]| values.iter().flatten().count() as u64;
        let checkpoint =
            |values: &[Option<f64>]| Checkpoint(State::Fixed(FixedState { samples, values: values.to_vec() }));
        loop {
            self.expose_unknown(&mut values, progress);
            if known(&values) == cells || progress.stops() {
                break;
            }
            progress.save(checkpoint(&values));
        }
        let cells_done = known(&values);
        let checkpoint = checkpoint(&values);
        let exposures: Vec<f64> = values.iter().map(|value| value.unwrap_or(0.0)).collect();
        Exposure {
            checkpoint,
            // What diffraction spreads is known when all is.
            values: if cells_done == cells {
                self.rays.picture(exposures)
            } else {
                exposures[..pixels as usize].to_vec()
            },
            rays: cells_done * u64::from(samples),
            estimated_error: None,
            pixels_done: known(&values[..pixels as usize]),
            is_partial: cells_done < cells,
            pixels: None,
        }
    }

    /// Exposes some of [`Rays::cells`], each with its rays, for who exposes the others elsewhere: the exposure in J/m², to the last
    /// bit that of [`Exposer::with_samples`], and half the difference of the exposures that the two halves of its rays give, which
    /// estimates its standard error (NaN with one ray). `None` if the work was stopped.
    #[must_use]
    pub fn cells(&self, cells: Range<u64>, progress: &dyn Progress) -> Option<Vec<[f64; 2]>> {
        let (done, total) = (AtomicU64::new(0), cells.end.saturating_sub(cells.start));
        (cells.start as usize..cells.end as usize)
            .into_par_iter()
            .with_min_len(CHUNK)
            .map_init(
                || self.workers(),
                |worker, cell| {
                    let exposed = (!progress.stops()).then(|| self.halves(worker, cell as u64));
                    let before = done.fetch_add(1, Ordering::Relaxed);
                    if (before + 1).is_multiple_of(CHUNK as u64) {
                        progress.report(before + 1, total);
                    }
                    exposed
                },
            )
            .collect()
    }

    /// E_pixel of one pixel in J/m², and half the difference of what the halves of its rays give.
    fn halves(&self, worker: &mut Workers<'_>, pixel: u64) -> [f64; 2] {
        let rays = self.rays;
        let mut averages = [PixelAverage::default(); 3];
        for sample in 0..rays.samples() {
            let index = pixel * u64::from(rays.samples()) + u64::from(sample);
            let ray = rays.of_sample(pixel, sample);
            let radiance = radiance(worker, index, (rays, pixel), &ray, self.weights);
            let half = if sample < rays.samples() / 2 { 1 } else { 2 };
            averages[0].add(ray.cos4, radiance);
            averages[half].add(ray.cos4, radiance);
        }
        let [whole, first, second] = averages.map(|average| average.exposure(rays.camera()));
        [whole, if rays.samples() < 2 { f64::NAN } else { 0.5 * (second - first) }]
    }

    /// Exposes what is not known yet, until it is all or something else is wanted.
    fn expose_unknown(&self, values: &mut [Option<f64>], progress: &dyn Progress) {
        let pixels = values.len() as u64;
        let done = AtomicU64::new(values.iter().flatten().count() as u64);
        values.par_chunks_mut(CHUNK).enumerate().for_each_init(
            || self.workers(),
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
    fn exposure(&self, worker: &mut Workers<'_>, pixel: u64) -> f64 {
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
    worker: &mut Workers<'_>,
    index: u64,
    (rays, pixel): (&Rays, u64),
    ray: &CameraRay,
    weights: &BandWeights,
) -> f64 {
    // Nothing comes through a stop.
    if ray.cos4 == 0.0 {
        return 0.0;
    }
    let Some(traced) = Ray::new(ray.origin, ray.direction) else { return 0.0 };
    let combine = |mut value: [f64; 3]| {
        let bands = &mut value[..weights.as_slice().len().min(3)];
        rays.weigh_bands(ray, bands);
        weights.combine_at(pixel, bands)
    };
    let mut sum = combine(worker.main.trace(index, &traced).value);
    for (lamps, brightness) in &mut worker.by_row {
        let row = (pixel / u64::from(rays.camera().columns())) as usize;
        // Equal numbers would draw equal samples, which is no harm: each sum of them is right on the average.
        sum += brightness.get(row).map_or(0.0, |share| share * combine(lamps.trace(index, &traced).value));
    }
    sum
}
