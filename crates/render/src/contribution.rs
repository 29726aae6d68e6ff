//! What a ray owes to the modifiers that it meets: the hook of `rcontrib`.
//!
//! Where no modifier is tracked, all of this is one pointer that is null.

mod note;

use radsight_cal::Host;
use radsight_compile::{RenderOptions, Shader};
use radsight_texture::{BandValues, FunctionView, SurfaceInteraction, product};

/// What a ray owes to one surface: emitted light that has come along the ray, or, of a surface that emits none, the share of the radiance
/// there that would come or the radiance that has come from there.
///
/// It is the [`Host`] of functions that look at the ray where it met the surface, in scene coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Contribution {
    /// Which of the tracked modifiers, in the order of the options.
    pub modifier: usize,
    /// Red, green, blue, or the bands that are traced. Of an emitter W/(sr·m²), or W/m² where irradiance is asked for; else as
    /// [`TrackedValue`](crate::TrackedValue) says.
    pub value: BandValues,
    interaction: SurfaceInteraction,
}

impl Host for Contribution {
    fn channel(&self, channel: u32) -> f64 {
        FunctionView::new(&self.interaction, None).channel(channel)
    }
}

/// What the present ray owes.
#[derive(Debug, Default)]
pub(crate) struct Contributions<const BANDS: usize> {
    settled: Vec<DeferredContribution<BANDS>>,
    /// What light sampling has found at a point whose share of the ray is not yet known.
    owed: Vec<DeferredContribution<BANDS>>,
    /// Surfaces whose radiance is wanted and that the ray has met, until all is followed that begins there.
    open: Vec<Open<BANDS>>,
}

/// What is owed to one modifier.
#[derive(Clone, Copy, Debug)]
struct DeferredContribution<const BANDS: usize> {
    modifier: u32,
    interaction: SurfaceInteraction,
    value: [f64; BANDS],
}

/// A surface that emits nothing and whose radiance is wanted.
#[derive(Clone, Copy, Debug)]
struct Open<const BANDS: usize> {
    modifier: u32,
    interaction: SurfaceInteraction,
    /// What the ray had brought before.
    before: [f64; BANDS],
    /// How many other rays waited; those beyond begin there.
    waiting: usize,
}

impl<const BANDS: usize> Contributions<BANDS> {
    /// Memory for them, if they are wanted.
    pub(crate) fn wanted(options: &RenderOptions) -> Option<Box<Contributions<BANDS>>> {
        (!options.tracked_modifiers.is_empty()).then(Box::default)
    }

    /// Adds what has come from a surface along the whole ray.
    pub(crate) fn add(&mut self, shader: &Shader, interaction: &SurfaceInteraction, value: [f64; BANDS]) {
        if let Some(modifier) = shader.tracked {
            self.push(modifier, interaction, value);
        }
    }

    /// Adds what a light gives to a point on the way, until [`Contributions::settle`].
    pub(crate) fn defer(&mut self, shader: &Shader, interaction: &SurfaceInteraction, value: [f64; BANDS]) {
        if let Some(modifier) = shader.tracked {
            self.owed.push(DeferredContribution { modifier, interaction: *interaction, value });
        }
    }

    /// Tells the share that the point has in the ray.
    pub(crate) fn settle(&mut self, throughput: [f64; BANDS]) {
        let mut owed = std::mem::take(&mut self.owed);
        for deferred in owed.drain(..) {
            self.push(deferred.modifier, &deferred.interaction, product(throughput, deferred.value));
        }
        self.owed = owed;
    }

    /// Tells what the ray has brought, now that no more than so many rays wait: what began at a surface and is followed to its end is
    /// the radiance from there.
    pub(crate) fn close(&mut self, radiance: [f64; BANDS], waiting: usize) {
        while let Some(open) = self.open.pop_if(|open| waiting < open.waiting) {
            self.close_one(&open, radiance);
        }
    }

    /// How many surfaces wait for what comes from there.
    pub(crate) fn open(&self) -> usize {
        self.open.len()
    }

    /// Tells what the ray has brought to all but the first `open` of them.
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
            // Functions of the ray see it in the coordinates of the scene.
            self.settled.push(DeferredContribution {
                modifier,
                interaction: SurfaceInteraction { placed: None, ..*interaction },
                value,
            });
        }
    }
}
