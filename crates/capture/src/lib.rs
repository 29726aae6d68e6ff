//! Exposes the pixels of a camera to a scene: with a fixed number of rays a pixel, or with as many as an asked error needs.
//!
//! With fixed samples the result is, bit for bit, what `pinhole rays | rtrace | pinhole average` gives: the same rays with the
//! same numbers through the same average. Results do not depend on the number of threads. Knows neither files nor sensors.
#![forbid(unsafe_code)]

mod adaptive;
mod background;
mod checkpoint;
mod edges;
mod fixed;
mod lattice;
mod mirrored_lights;
mod region;
mod sparse;
mod sparse_estimate;

pub use adaptive::MAX_SAMPLES;
pub use background::Background;
pub use checkpoint::{Checkpoint, CheckpointError};
pub use region::{LitRegion, Region};

use radsight_pinhole::{BandWeights, Rays};
use radsight_render::{RayWorker, Renderer};

/// A camera in front of a scene. [`Exposer::with_samples`] and [`Exposer::to_error`] expose it.
#[derive(Clone, Copy, Debug)]
pub struct Exposer<'a> {
    /// Answers rays.
    pub renderer: &'a Renderer,
    /// The camera's rays.
    pub rays: &'a Rays,
    /// How the bands of radiance add up.
    pub weights: &'a BandWeights,
    /// The light of lamps whose brightness differs from row to row; it is added to the renderer's. Empty for most.
    pub by_row: &'a [LightByRow],
}

/// The light of some lamps of a scene, which is not equally bright for all rows.
#[derive(Debug)]
pub struct LightByRow {
    /// Answers rays by the light of these lamps alone.
    pub renderer: Renderer,
    /// By what its radiance is multiplied in each row, from the top.
    pub brightness: Vec<f64>,
}

/// What answers the rays of one thread.
pub(crate) struct Workers<'a> {
    main: RayWorker<'a>,
    by_row: Vec<(RayWorker<'a>, &'a [f64])>,
}

impl Exposer<'_> {
    pub(crate) fn workers(&self) -> Workers<'_> {
        let by_row = self.by_row.iter().map(|light| (light.renderer.worker(), light.brightness.as_slice())).collect();
        Workers { main: self.renderer.worker(), by_row }
    }
}

/// The exposed picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Exposure {
    /// E_pixel in J/m², in scanline order from the top left.
    pub values: Vec<f64>,
    /// Rays from the camera on which the exposure rests.
    pub rays: u64,
    /// Estimated rms error over the pixels as a share of the mean exposure, where it was estimated.
    pub estimated_error: Option<f64>,
    /// How many pixels have a value; the others have 0. All of them, unless the work was stopped.
    pub pixels_done: u64,
    /// Whether the work was stopped before it was done.
    pub is_partial: bool,
    /// What is known of each pixel, where the error was estimated.
    pub pixels: Option<PixelStatistics>,
    /// With it the exposure can go on: to its end, or to a smaller error.
    pub checkpoint: Checkpoint,
}

/// How exact each pixel is, in scanline order from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct PixelStatistics {
    /// Estimated standard error of E_pixel, J/m², pooled with its neighbours. Its rms over the mean exposure is
    /// [`Exposure::estimated_error`].
    pub standard_errors: Vec<f64>,
    /// Rays that were traced for the pixel.
    pub samples: Vec<u32>,
}

impl Exposure {
    /// Mean exposure, J/m².
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.values.iter().sum::<f64>() / self.values.len().max(1) as f64
    }
}

/// Hears how far the work is.
pub trait Progress: Sync {
    /// `done` of `total` steps; `total` may grow.
    fn report(&self, done: u64, total: u64);

    /// Whether the work is to stop where it is; once it is so it stays so.
    fn stops(&self) -> bool {
        false
    }

    /// Whether [`Progress::save`] is to be called soon. Until then it stays so.
    fn wants_checkpoint(&self) -> bool {
        false
    }

    /// Takes what is done so far; [`Progress::wants_checkpoint`] is false after it.
    fn save(&self, _checkpoint: Checkpoint) {}
}

/// Says nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn report(&self, _done: u64, _total: u64) {}
}
