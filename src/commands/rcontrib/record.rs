//! Accumulates the rays of a record.

use super::bins::Bins;
use super::options::Options;
use crate::failure::Outcome;
use crate::ray_input::InputRay;
use radsight_cal::Scratch;
use radsight_render::{Quantity, Ray, RayWorker, Renderer};
use rayon::prelude::*;

/// Number of paths that one thread traces at a time.
const PATHS_AT_A_TIME: u64 = 1024;
/// Number of paths traced before their sums are written.
const PATHS_IN_A_BATCH: u64 = 1 << 17;
/// Largest memory for the sums of a batch, bytes.
const MOST_BYTES: usize = 1 << 28;

/// The result of an earlier run.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Earlier {
    Nothing,
    /// Number of rays traced.
    Rays(u64),
    /// The values of the single record that accumulates all rays.
    Sums(Vec<f64>),
}

/// Rays traced together.
pub(super) struct Batch<'b> {
    pub(super) renderer: &'b Renderer,
    pub(super) bins: &'b Bins,
    pub(super) rays: &'b [InputRay],
}

/// The current record.
pub(super) struct Records {
    /// Rays per record; 0 for all.
    accumulate: u64,
    samples: u64,
    /// Approximate number of paths per ray.
    paths: u64,
    limits_distance: bool,
    rays_at_a_time: usize,
    /// Rays of the current record, and of all.
    rays: u64,
    rays_in_all: u64,
    /// Red, green, blue, or all bands, of each bin.
    sums: Vec<f64>,
    /// The sums of an earlier run, if one record accumulates all rays.
    earlier: Vec<f64>,
}

/// Some paths of rays of one record. The division does not depend on the number of threads, so
/// records do not, either.
struct Work {
    /// Range in the batch.
    rays: std::ops::Range<usize>,
    samples: std::ops::Range<u64>,
    /// Number of rays of its record that it finishes.
    finished: u64,
}

impl Records {
    pub(super) fn new(options: &Options, bins: usize) -> Records {
        let (samples, paths) = (options.samples(), options.paths());
        let values = bins * options.components();
        let most = (PATHS_IN_A_BATCH / paths).clamp(1, 1 << 15) as usize;
        let fitting = (MOST_BYTES / (size_of::<f64>() * values.max(1))).max(1);
        let until_flush = options.flush_interval().map(|records| records.saturating_mul(options.accumulate.max(1)));
        let rays_at_a_time = until_flush.map_or(most, |rays| most.min(rays.min(1 << 15) as usize)).min(fitting);
        Records {
            accumulate: options.accumulate,
            samples,
            paths,
            limits_distance: options.limits_distance && options.render.quantity != Quantity::Irradiance,
            rays_at_a_time,
            rays: 0,
            rays_in_all: 0,
            sums: vec![0.0; values],
            earlier: Vec::new(),
        }
    }

    /// Continues after the rays of an earlier run, or adds to its sums.
    pub(super) fn go_on(&mut self, earlier: Earlier) {
        match earlier {
            Earlier::Nothing => {}
            Earlier::Rays(rays) => self.rays_in_all = rays,
            Earlier::Sums(sums) => self.earlier = sums,
        }
    }

    pub(super) fn rays_at_a_time(&self) -> usize {
        self.rays_at_a_time
    }

    /// Adds rays and passes the means of each finished record to `put`.
    pub(super) fn add(&mut self, batch: &Batch<'_>, mut put: impl FnMut(&[f64]) -> Outcome) -> Outcome {
        let work = self.work(batch.rays.len());
        let (first, samples) = (self.rays_in_all, self.samples);
        // Path numbers are aligned, so that each ray's samples are stratified.
        let stride = samples.next_power_of_two();
        let (values, limits_distance) = (self.sums.len(), self.limits_distance);
        let sums: Vec<Vec<f64>> = work
            .par_iter()
            .map_init(
                || (batch.renderer.worker(), Scratch::new()),
                |(worker, scratch), work| {
                    let mut sums = vec![0.0; values];
                    for place in work.rays.clone() {
                        let Some(ray) = batch.rays[place].ray else { continue };
                        if limits_distance {
                            worker.limit_distance(batch.rays[place].length);
                        }
                        let number = (first + place as u64) * stride;
                        for sample in work.samples.clone() {
                            add_path(batch.bins, worker, scratch, (number + sample, &ray), &mut sums);
                        }
                    }
                    sums
                },
            )
            .collect();
        for (work, part) in work.iter().zip(sums) {
            for (sum, part) in self.sums.iter_mut().zip(part) {
                *sum += part;
            }
            self.rays += work.finished;
            if self.accumulate > 0 && self.rays == self.accumulate {
                put(&self.take())?;
            }
        }
        self.rays_in_all += batch.rays.len() as u64;
        Ok(())
    }

    /// Splits rays into pieces within one record each.
    fn work(&self, rays: usize) -> Vec<Work> {
        let rays_a_piece = (PATHS_AT_A_TIME / self.paths).max(1);
        let samples_a_piece = (PATHS_AT_A_TIME * self.samples / self.paths).max(1);
        let mut pieces = Vec::new();
        let (mut at, mut in_record) = (0, self.rays);
        while at < rays {
            let left = if self.accumulate > 0 { self.accumulate - in_record } else { u64::MAX };
            let count = rays_a_piece.min(left).min((rays - at) as u64);
            let mut sample = 0;
            while sample < self.samples {
                let end = (sample + samples_a_piece).min(self.samples);
                let finished = if end == self.samples { count } else { 0 };
                pieces.push(Work { rays: at..at + count as usize, samples: sample..end, finished });
                sample = end;
            }
            at += count as usize;
            in_record = if count == left { 0 } else { in_record + count };
        }
        pieces
    }

    /// Takes the means of the current record and resets it; sums if one record accumulates all
    /// rays.
    fn take(&mut self) -> Vec<f64> {
        let rays = if self.accumulate > 0 { self.rays } else { 1 };
        let scale = 1.0 / (rays as f64 * self.samples as f64);
        let mut values: Vec<f64> = self.sums.iter().map(|sum| sum * scale).collect();
        for (value, earlier) in values.iter_mut().zip(self.earlier.drain(..)) {
            *value += earlier;
        }
        // Each contribution is within these bounds, but their sum may not be.
        let most = f64::from(f32::MAX);
        values.iter_mut().for_each(|value| *value = value.clamp(-most, most));
        self.sums.fill(0.0);
        self.rays = 0;
        values
    }

    /// The means of an incomplete record.
    pub(super) fn rest(&mut self) -> Option<Vec<f64>> {
        (self.rays > 0 || self.accumulate == 0).then(|| self.take())
    }
}

fn add_path(
    bins: &Bins,
    worker: &mut RayWorker<'_>,
    scratch: &mut Scratch,
    (number, ray): (u64, &Ray),
    sums: &mut [f64],
) {
    worker.contributions(number, ray, |contribution| {
        if let Some(bin) = bins.of(&contribution, scratch) {
            let value = contribution.value.as_slice();
            for (sum, band) in sums[bin * value.len()..].iter_mut().zip(value) {
                *sum += f64::from(*band);
            }
        }
    });
}
