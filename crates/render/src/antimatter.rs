//! Antimatter: volumes that are cut out of others.
//!
//! As in Radiance, a ray carries the set of modifiers whose surfaces are not there for it: entering antimatter (through its front) adds
//! those that it cuts, leaving it takes them out again, and what passes through a surface goes on with the new set, what is reflected
//! with the old one. If antimatter names a material to shade the cut with, its surface is there, turned inside out, where the
//! ray is within one of the bodies that it cuts; the ray knows that by counting the fronts less the backs of their surfaces that it passed.

use crate::shader::{Kind, Shader};
use crate::trace::PathIntegrator;
use glam::DVec3;
use radsight_accel::{Intersection, ShaderId};

/// What the `antimatter` material does.
#[derive(Clone, Debug)]
pub(crate) struct Antimatter {
    /// Shaders of the surfaces that it cuts, ascending.
    pub(crate) cuts: Vec<ShaderId>,
    /// Shades the surface of the cut.
    pub(crate) shade: Option<ShaderId>,
}

/// What is cut for a ray, and what bodies it is within.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Subtraction {
    /// Shaders of the surfaces that are not there, ascending.
    gone: Vec<ShaderId>,
    /// For shaders that any antimatter cuts: how many more fronts than backs the ray has passed. Ascending, none of them zero.
    passed: Vec<(ShaderId, i32)>,
}

/// Names a cut that the present ray has met; the first is that of nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct SubtractionId(u32);

/// What becomes of a ray at a surface, by antimatter alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AntimatterEvent {
    /// The surface is not there. The ray goes on with this cut.
    Nothing(SubtractionId),
    /// The surface is there. What passes through it goes on with this cut.
    Surface(SubtractionId),
}

impl Antimatter {
    pub(crate) fn new(mut cuts: Vec<ShaderId>, shade: Option<ShaderId>) -> Antimatter {
        cuts.sort_unstable();
        cuts.dedup();
        Antimatter { cuts, shade }
    }
}

impl Subtraction {
    fn pass(&mut self, shader: ShaderId, step: i32) {
        match self.passed.binary_search_by_key(&shader, |(shader, _)| *shader) {
            Ok(place) if self.passed[place].1 + step == 0 => {
                self.passed.remove(place);
            }
            Ok(place) => self.passed[place].1 += step,
            Err(place) => self.passed.insert(place, (shader, step)),
        }
    }

    fn add(&mut self, shader: ShaderId) {
        if let Err(place) = self.gone.binary_search(&shader) {
            self.gone.insert(place, shader);
        }
    }

    fn is_within_any(&self, shaders: &[ShaderId]) -> bool {
        let passed = self.passed.iter().filter(|(shader, _)| shaders.binary_search(shader).is_ok());
        passed.map(|(_, count)| count).sum::<i32>() > 0
    }
}

/// The shaders that any antimatter cuts, ascending.
pub(crate) fn all_cut(shaders: &[Shader]) -> Vec<ShaderId> {
    let of_shader = |shader: &Shader| match &shader.kind {
        Kind::Antimatter(antimatter) => antimatter.cuts.clone(),
        _ => Vec::new(),
    };
    let mut all: Vec<ShaderId> = shaders.iter().flat_map(of_shader).collect();
    all.sort_unstable();
    all.dedup();
    all
}

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// Whether a surface is there for a ray with this cut. Where antimatter shows its own surface, the hit becomes that of the
    /// material there.
    pub(crate) fn resolve(&mut self, cut: SubtractionId, direction: DVec3, hit: &mut Intersection) -> AntimatterEvent {
        let plan = self.plan;
        let behind = direction.dot(hit.front) > 0.0;
        let before = &self.cuts[cut.0 as usize];
        let is_gone = before.gone.binary_search(&hit.shader).is_ok();
        let mut beyond = before.clone();
        if plan.cut_shaders.binary_search(&hit.shader).is_ok() {
            beyond.pass(hit.shader, if behind { -1 } else { 1 });
        }
        let antimatter = match &plan.shader_at(hit.shader).kind {
            Kind::Antimatter(antimatter) if !is_gone => antimatter,
            _ if is_gone => return AntimatterEvent::Nothing(self.add_subtraction(beyond)),
            _ => return AntimatterEvent::Surface(self.add_subtraction(beyond)),
        };
        if behind {
            beyond.gone.retain(|shader| antimatter.cuts.binary_search(shader).is_err());
        } else {
            antimatter.cuts.iter().for_each(|shader| beyond.add(*shader));
        }
        match antimatter.shade {
            Some(shade) if before.is_within_any(&antimatter.cuts) => {
                hit.shader = shade;
                hit.front = -hit.front;
                if let Some(placed) = &mut hit.placed {
                    placed.perturbation = -placed.perturbation;
                }
                AntimatterEvent::Surface(self.add_subtraction(beyond))
            }
            _ => AntimatterEvent::Nothing(self.add_subtraction(beyond)),
        }
    }

    pub(crate) fn cut(&self, id: SubtractionId) -> &Subtraction {
        &self.cuts[id.0 as usize]
    }

    pub(crate) fn add_subtraction(&mut self, cut: Subtraction) -> SubtractionId {
        let known = self.cuts.iter().position(|known| *known == cut);
        let index = known.unwrap_or_else(|| {
            self.cuts.push(cut);
            self.cuts.len() - 1
        });
        SubtractionId(index as u32)
    }
}
