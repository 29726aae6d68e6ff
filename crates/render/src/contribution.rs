//! What a ray owes to the modifiers that it meets: the hook of `rcontrib`.
//!
//! Where no modifier is tracked, all of this is one pointer that is null.

use crate::options::RenderOptions;
use crate::ray::Hit;
use crate::shader::Shader;
use crate::trace::{Segment, Tracer, product};
use crate::view::{Encounter, View};
use radsight_cal::Host;
use radsight_ir::Scene;
use std::collections::HashMap;

/// What a ray owes to one surface: emitted light that has come along the ray, or, of a surface that emits none, the share of the radiance
/// there that would come.
///
/// It is the [`Host`] of functions that look at the ray where it met the surface, in scene coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Contribution {
    /// Which of the tracked modifiers, in the order of the options.
    pub modifier: usize,
    /// Red, green, blue. Of an emitter W/(sr·m²), or W/m² where irradiance is asked for; else a share.
    pub value: [f64; 3],
    encounter: Encounter,
}

impl Host for Contribution {
    fn channel(&self, channel: u32) -> f64 {
        View::new(&self.encounter, None).channel(channel)
    }
}

/// What the present ray owes.
#[derive(Debug, Default)]
pub(crate) struct Contributions<const BANDS: usize> {
    settled: Vec<Contribution>,
    /// What light sampling has found at a point whose share of the ray is not yet known.
    owed: Vec<(u32, Encounter, [f64; BANDS])>,
}

impl<const BANDS: usize> Contributions<BANDS> {
    /// Memory for them, if they are wanted.
    pub(crate) fn wanted(options: &RenderOptions) -> Option<Box<Contributions<BANDS>>> {
        (!options.tracked_modifiers.is_empty()).then(Box::default)
    }

    /// Adds what has come from a surface along the whole ray.
    pub(crate) fn add(&mut self, shader: &Shader, encounter: &Encounter, value: [f64; BANDS]) {
        if let Some(modifier) = shader.tracked {
            self.push(modifier, encounter, value);
        }
    }

    /// Adds what a light gives to a point on the way, until [`Contributions::settle`].
    pub(crate) fn owe(&mut self, shader: &Shader, encounter: &Encounter, value: [f64; BANDS]) {
        if let Some(modifier) = shader.tracked {
            self.owed.push((modifier, *encounter, value));
        }
    }

    /// Tells the share that the point has in the ray.
    pub(crate) fn settle(&mut self, throughput: [f64; BANDS]) {
        let mut owed = std::mem::take(&mut self.owed);
        for (modifier, encounter, value) in owed.drain(..) {
            self.push(modifier, &encounter, product(throughput, value));
        }
        self.owed = owed;
    }

    fn push(&mut self, modifier: u32, encounter: &Encounter, value: [f64; BANDS]) {
        if value.iter().any(|band| *band > 0.0) {
            let value = std::array::from_fn(|band| value[band.min(BANDS - 1)]);
            // Functions of the ray see it in the coordinates of the scene.
            let encounter = Encounter { placed: None, ..*encounter };
            self.settled.push(Contribution { modifier: modifier as usize, value, encounter });
        }
    }
}

impl<const BANDS: usize> Tracer<'_, BANDS> {
    /// Notes that a ray has met a surface that emits nothing.
    pub(crate) fn note_met(&mut self, segment: &Segment<BANDS>, hit: &Hit, shader: &Shader) {
        if shader.tracked.is_none() || shader.kind.emitter().is_some() {
            return;
        }
        let encounter = Encounter::at(&segment.ray, hit, segment.travelled + hit.distance);
        if let Some(contributions) = &mut self.contributions {
            contributions.add(shader, &encounter, segment.throughput);
        }
    }

    /// What the last ray owes.
    pub(crate) fn take_contributions(&mut self) -> Vec<Contribution> {
        let taken = self.contributions.as_mut().map(|contributions| std::mem::take(&mut contributions.settled));
        taken.unwrap_or_default()
    }
}

/// Marks the shaders of tracked modifiers.
pub(crate) fn mark_tracked(shaders: &mut [Shader], scene: &Scene, names: &[String]) {
    if names.is_empty() {
        return;
    }
    let numbered: HashMap<&str, u32> = names.iter().map(String::as_str).zip(0..).collect();
    for shader in shaders {
        let name = shader.home.scene(scene).modifier_name(shader.modifier);
        shader.tracked = numbered.get(name).copied();
    }
}
