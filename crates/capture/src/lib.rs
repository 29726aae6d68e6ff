//! Exposes the pixels of a camera to a scene, with a fixed number of rays per pixel or adaptively
//! to a requested error.
//!
//! With a fixed number of samples the result is, bit for bit, that of `pinhole rays | rtrace |
//! pinhole average`: the same rays with the same numbers are averaged in the same order. Results do
//! not depend on the number of threads. Knows neither files nor sensors.
#![forbid(unsafe_code)]

mod adaptive;
mod apart_images;
mod audit;
mod audited_rays;
mod background;
mod checkpoint;
mod correction;
mod cubic;
mod curved_image;
mod derivative;
mod disk_overlap;
mod domain;
mod edges;
mod ellipse;
mod film;
mod film_blur;
mod film_image_light;
mod film_image_search;
mod film_images;
mod film_sums;
mod fixed;
mod highlights;
mod image_light;
mod image_region;
mod interpolated;
mod lattice;
mod mirrored_lights;
mod neighbourhood;
mod piecewise_linear;
mod pinhole_blur;
mod pinhole_derivatives;
mod pixel_errors;
mod plane_images;
mod radiance;
mod region;
mod region_search;
mod shared_film;
mod sparse;
mod sparse_estimate;
mod subpixel_kernels;
mod subpixels;
mod sums;
mod two_phase;
mod window_sums;

pub use background::{Background, PlacedParts};
pub use checkpoint::{Checkpoint, CheckpointError};
pub use derivative::{Derivative, DerivativeSamples, Motion, ParameterStep, PartMotion, RANDOMISATIONS};
pub use radsight_adaptive::{ErrorTarget, MAX_SAMPLES, Stop};
pub use region::{LitRegion, Region};

use radsight_pinhole::{BandWeights, Rays};
use radsight_render::{CountedLight, CubatureError, RayWorker, Renderer};

/// A camera in front of a scene. [`Exposer::with_samples`] and [`Exposer::to_error`] expose it.
#[derive(Clone, Copy, Debug)]
pub struct Exposer<'a> {
    /// Traces the rays.
    pub renderer: &'a Renderer,
    /// The camera's rays.
    pub rays: &'a Rays,
    /// The weights of the bands of a radiance.
    pub weights: &'a BandWeights,
    /// The light of lamps whose brightness varies from row to row, added to the renderer's. Usually
    /// empty.
    pub by_row: &'a [LightByRow],
}

/// The light of some lamps of a scene, whose brightness varies from row to row.
#[derive(Debug)]
pub struct LightByRow {
    /// Traces rays with the light of these lamps alone.
    pub renderer: Renderer,
    /// Relative brightness of each row, from the top.
    pub brightness: Vec<f64>,
}

/// The ray workers of one thread.
pub(crate) struct Workers<'a> {
    main: RayWorker<'a>,
    by_row: Vec<(RayWorker<'a>, &'a [f64])>,
}

impl Workers<'_> {
    /// Computes a part of the radiance of later rays.
    pub(crate) fn count(&mut self, counted: CountedLight) {
        self.main.count(counted);
        self.by_row.iter_mut().for_each(|(worker, _)| worker.count(counted));
    }

    /// Integrates small lights, with this error relative to each light's contribution, or samples
    /// them.
    pub(crate) fn integrate_lights(&mut self, allowed: Option<CubatureError>) {
        self.main.integrate_lights(allowed);
        self.by_row.iter_mut().for_each(|(worker, _)| worker.integrate_lights(allowed));
    }
}

impl<'a> Exposer<'a> {
    pub(crate) fn workers(&self) -> Workers<'a> {
        let by_row = self.by_row.iter().map(|light| (light.renderer.worker(), light.brightness.as_slice())).collect();
        Workers { main: self.renderer.worker(), by_row }
    }
}

/// An exposed picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Exposure {
    /// E_pixel in J/m², in scanline order from the top left.
    pub values: Vec<f64>,
    /// Camera rays that contribute to the exposure.
    pub rays: u64,
    /// Estimated rms error over the pixels, relative to the mean exposure; with adaptive sampling
    /// only.
    pub estimated_error: Option<f64>,
    /// Number of pixels with a value; the others are 0. All pixels, unless the work was stopped.
    pub pixels_done: u64,
    /// Whether the work was stopped before its end.
    pub is_partial: bool,
    /// Why the requested error was not reached; `None` if it was, or with a fixed number of rays
    /// that was not stopped.
    pub stopped: Option<Stop>,
    /// Statistics of each pixel, where the error was estimated.
    pub pixels: Option<PixelStatistics>,
    /// With it the exposure can be resumed, up to its end or to a smaller error.
    pub checkpoint: Checkpoint,
}

/// Accuracy of each pixel, in scanline order from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct PixelStatistics {
    /// Estimated standard error of E_pixel, J/m², pooled with its neighbours. Its rms over the mean
    /// exposure is [`Exposure::estimated_error`].
    pub standard_errors: Vec<f64>,
    /// Number of rays of each pixel.
    pub samples: Vec<u32>,
}

impl Exposure {
    /// Mean exposure, J/m².
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.values.iter().sum::<f64>() / self.values.len().max(1) as f64
    }
}

/// Receives the progress of the work.
pub trait Progress: Sync {
    /// `done` of `total` steps; `total` may grow.
    fn report(&self, done: u64, total: u64);

    /// Whether the work should stop now. Once true, it stays true.
    fn stops(&self) -> bool {
        false
    }

    /// Whether [`Progress::save`] should be called soon. Stays true until then.
    fn wants_checkpoint(&self) -> bool {
        false
    }

    /// Receives the state so far; [`Progress::wants_checkpoint`] is false afterwards.
    fn save(&self, _checkpoint: Checkpoint) {}
}

/// Reports nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn report(&self, _done: u64, _total: u64) {}
}
