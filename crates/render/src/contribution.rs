//! Contributions of tracked modifiers to a ray, for `rcontrib`.
//!
//! Without tracked modifiers all of this costs one null pointer.

mod note;

use radsight_cal::Host;
use radsight_compile::{RenderOptions, Shader};
use radsight_texture::{BandValues, FunctionView, SurfaceInteraction, product};

/// The contribution of one surface to a ray: emitted light that arrives along the ray or, for a
/// surface that does not emit, its coefficient or the radiance that comes from it.
///
/// It is the [`Host`] of functions of the ray at the surface, in scene coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Contribution {
    /// Index of the tracked modifier, in the order of the options.
    pub modifier: usize,
    /// Red, green, blue, or the traced bands. For an emitter W/(sr·m²), or W/m² for irradiance;
    /// otherwise see [`TrackedValue`](crate::TrackedValue).
    pub value: BandValues,
    interaction: SurfaceInteraction,
}

impl Host for Contribution {
    fn channel(&self, channel: u32) -> f64 {
        FunctionView::new(&self.interaction, None).channel(channel)
    }
}

/// The contributions to the current ray.
#[derive(Debug, Default)]
pub(crate) struct Contributions<const BANDS: usize> {
    settled: Vec<DeferredContribution<BANDS>>,
    /// Contributions found by light sampling at a point whose throughput is not yet known.
    pending: Vec<DeferredContribution<BANDS>>,
    /// Surfaces hit by the ray whose radiance is requested, until all rays from there are finished.
    open: Vec<Open<BANDS>>,
}

/// A contribution of one modifier.
#[derive(Clone, Copy, Debug)]
struct DeferredContribution<const BANDS: usize> {
    modifier: u32,
    interaction: SurfaceInteraction,
    value: [f64; BANDS],
}

/// A surface that does not emit and whose radiance is requested.
#[derive(Clone, Copy, Debug)]
struct Open<const BANDS: usize> {
    modifier: u32,
    interaction: SurfaceInteraction,
    /// Radiance of the ray before this surface was reached.
    before: [f64; BANDS],
    /// Number of other pending rays at that time; pending rays beyond it start at this surface.
    waiting: usize,
}

impl<const BANDS: usize> Contributions<BANDS> {
    /// Allocates memory if contributions are requested.
    pub(crate) fn wanted(options: &RenderOptions) -> Option<Box<Contributions<BANDS>>> {
        (!options.tracked_modifiers.is_empty()).then(Box::default)
    }

    /// Adds what arrives from a surface along the whole ray.
    pub(crate) fn add(&mut self, shader: &Shader, interaction: &SurfaceInteraction, value: [f64; BANDS]) {
        if let Some(modifier) = shader.tracked {
            self.push(modifier, interaction, value);
        }
    }

    /// Adds the contribution of a light to a point of the path, until [`Contributions::settle`].
    pub(crate) fn defer(&mut self, shader: &Shader, interaction: &SurfaceInteraction, value: [f64; BANDS]) {
        if let Some(modifier) = shader.tracked {
            self.pending.push(DeferredContribution { modifier, interaction: *interaction, value });
        }
    }

    /// Multiplies deferred contributions by the throughput of their point.
    pub(crate) fn settle(&mut self, throughput: [f64; BANDS]) {
        let mut pending = std::mem::take(&mut self.pending);
        for deferred in pending.drain(..) {
            self.push(deferred.modifier, &deferred.interaction, product(throughput, deferred.value));
        }
        self.pending = pending;
    }

    /// Finishes surfaces whose rays are done, given the ray's radiance and the number of pending
    /// rays.
    pub(crate) fn close(&mut self, radiance: [f64; BANDS], waiting: usize) {
        while let Some(open) = self.open.pop_if(|open| waiting < open.waiting) {
            self.close_one(&open, radiance);
        }
    }

    /// Number of unfinished surfaces.
    pub(crate) fn open(&self) -> usize {
        self.open.len()
    }

    /// Finishes all but the first `open` surfaces with the ray's radiance.
    pub(crate) fn close_until(&mut self, open: usize, radiance: [f64; BANDS]) {
        while self.open.len() > open
            && let Some(last) = self.open.pop()
        {
            self.close_one(&last, radiance);
        }
    }

    fn close_one(&mut self, open: &Open<BANDS>, radiance: [f64; BANDS]) {
        let value = std::array::from_fn(|band| radiance[band] - open.before[band]);
        self.push(open.modifier, &open.interaction, value);
    }

    fn push(&mut self, modifier: u32, interaction: &SurfaceInteraction, value: [f64; BANDS]) {
        if value.iter().any(|band| *band > 0.0) {
            // Functions of the ray use the coordinates of the scene.
            self.settled.push(DeferredContribution {
                modifier,
                interaction: SurfaceInteraction { instance: None, ..*interaction },
                value,
            });
        }
    }
}
