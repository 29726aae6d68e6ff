//! Sampling with a fixed number of rays per pixel.

use crate::checkpoint::{Checkpoint, FixedState, State};
use crate::radiance::{MAX_BANDS, radiance, radiance_apart};
use crate::{Exposer, Exposure, Progress, Workers};
use radsight_adaptive::Stop;
use radsight_pinhole::PixelAverage;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

/// Pixels of a thread's unit of work.
const CHUNK: usize = 64;

impl Exposer<'_> {
    /// Exposes every pixel with its rays of [`Rays`](radsight_pinhole::Rays). Continues from a
    /// checkpoint with the same number of rays per pixel.
    #[must_use]
    pub fn with_samples(&self, start: Option<Checkpoint>, progress: &dyn Progress) -> Exposure {
        let samples = self.rays.samples();
        let pixels = self.rays.camera().pixel_count();
        let cells = self.rays.cells();
        let bands = self.rays.bands_apart(self.weights).unwrap_or(1) as u64;
        let mut values = match start {
            Some(Checkpoint(State::Fixed(state))) if state.samples == samples => state.values,
            _ => Vec::new(),
        };
        values.resize((cells * bands) as usize, None);
        let known = |values: &[Option<f64>]| values.iter().flatten().count() as u64 / bands;
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
            // Diffraction spreads light over the picture, so it needs all pixels.
            values: if cells_done == cells {
                self.rays.picture(exposures, self.weights)
            } else {
                self.before_diffraction(&exposures[..(pixels * bands) as usize])
            },
            rays: cells_done * u64::from(samples),
            estimated_error: None,
            pixels_done: known(&values[..(pixels * bands) as usize]),
            is_partial: cells_done < cells,
            stopped: (cells_done < cells).then_some(Stop::Time),
            pixels: None,
        }
    }

    /// Exposes some of [`Rays::cells`](radsight_pinhole::Rays::cells), each with its rays; other
    /// processes can expose the rest.
    /// Returns the exposure in J/m², equal to the last bit to that of [`Exposer::with_samples`],
    /// and half the difference of the exposures of the two halves of the rays, which estimates the
    /// standard error (NaN with one ray). `None` if the work was stopped.
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

    /// E_pixel of one pixel in J/m², and half the difference between the halves of its rays.
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

    /// The exposures of pixels before diffraction spreads them.
    fn before_diffraction(&self, exposures: &[f64]) -> Vec<f64> {
        match self.rays.bands_apart(self.weights) {
            None => exposures.to_vec(),
            Some(bands) => {
                let pixels = (0..).zip(exposures.chunks_exact(bands));
                pixels.map(|(pixel, light)| self.weights.combine_apart(pixel, light)).collect()
            }
        }
    }

    /// Exposes cells without a value, until none is left or the work is interrupted.
    fn expose_unknown(&self, values: &mut [Option<f64>], progress: &dyn Progress) {
        let bands = self.rays.bands_apart(self.weights);
        let each = bands.unwrap_or(1);
        let cells = (values.len() / each) as u64;
        let done = AtomicU64::new((values.iter().flatten().count() / each) as u64);
        values.par_chunks_mut(CHUNK * each).enumerate().for_each_init(
            || self.workers(),
            |worker, (chunk, values)| {
                if progress.stops() || progress.wants_checkpoint() {
                    return;
                }
                let mut exposed = 0;
                let unknown = |(_, values): &(u64, &mut [Option<f64>])| values.iter().any(Option::is_none);
                for (cell, values) in ((chunk * CHUNK) as u64..).zip(values.chunks_exact_mut(each)).filter(unknown) {
                    match bands {
                        None => values[0] = Some(self.exposure(worker, cell)),
                        Some(_) => self.expose_apart(worker, cell, values),
                    }
                    exposed += 1;
                }
                let before = done.fetch_add(exposed, Ordering::Relaxed);
                progress.report(before + exposed, cells);
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

    /// The exposures of one cell by separate band, J/m².
    fn expose_apart(&self, worker: &mut Workers<'_>, cell: u64, values: &mut [Option<f64>]) {
        let rays = self.rays;
        let mut averages = [PixelAverage::default(); MAX_BANDS];
        for sample in 0..rays.samples() {
            let index = cell * u64::from(rays.samples()) + u64::from(sample);
            let ray = rays.of_sample(cell, sample);
            let bands = radiance_apart(worker, index, (rays, cell), &ray, self.weights);
            averages.iter_mut().zip(bands).for_each(|(average, band)| average.add(ray.cos4, band));
        }
        values.iter_mut().zip(averages).for_each(|(value, average)| *value = Some(average.exposure(rays.camera())));
    }
}
