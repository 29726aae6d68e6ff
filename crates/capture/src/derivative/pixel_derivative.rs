//! Samples of the derivative of one pixel.
//!
//! The derivative is a sum of three terms ([`Term`]), each sampled for itself: a part's wall may be
//! seen by one ray in thirty and have all of the noise.

use super::flow::Flow;
use super::place::{Border, DrawBorder, Place, on_rim, on_sides, ray, uniform};
use super::ray_index::TERMS;
use super::{Motion, ParameterStep};
use crate::radiance::radiance;
use crate::{Exposer, Workers};
use radsight_pinhole::Hole;
use radsight_render::Ray;
use radsight_sampling::{DimensionSet, RaySampler};
use std::ops::Range;

/// A term of the derivative of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Term {
    /// The integral over pixel and pinhole, where rays show neither what moves nor what is close
    /// beside it.
    Rest,
    /// The same, where they do. Beside a mirror, a retroreflector is lit through it.
    Moving,
    /// The integral over the sides of the pixel, and over the pinhole.
    Sides,
    /// The integral over the pixel, and over the rim of the pinhole.
    Rim,
}

impl Term {
    pub(super) const ALL: [Term; TERMS] = [Term::Rest, Term::Moving, Term::Sides, Term::Rim];
}

/// Sums over samples of a term.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct TermSums {
    /// Of dE/dθ.
    pub(super) slope: f64,
    /// Of E.
    pub(super) exposure: f64,
    /// Number of rays whose light was computed.
    pub(super) rays: u64,
}

/// Number of places per sample of [`Term::Moving`]. Where a place does not show what moves, only its
/// first hit is computed; so samples of all terms cost about the same.
const PLACES_PER_SAMPLE: u32 = 4;

/// The workers of one thread.
pub(super) struct StepWorkers<'a> {
    center: Workers<'a>,
    below: Workers<'a>,
    above: Workers<'a>,
}

impl<'a> StepWorkers<'a> {
    /// Those below and above the parameter's value.
    pub(super) fn sides(&mut self) -> [&mut Workers<'a>; 2] {
        [&mut self.below, &mut self.above]
    }
}

impl ParameterStep<'_> {
    pub(super) fn step_workers(&self) -> StepWorkers<'_> {
        StepWorkers { center: self.center.workers(), below: self.below.workers(), above: self.above.workers() }
    }

    /// Sums of samples of a term of a pixel.
    pub(super) fn sum(
        &self,
        workers: &mut StepWorkers<'_>,
        (pixel, flow, term): (u64, Option<&Flow>, Term),
        randomisation: u32,
        samples: Range<u32>,
    ) -> TermSums {
        let sequence = 1 + u64::from(randomisation) * Term::ALL.len() as u64 + term as u64;
        let mut sums = TermSums::default();
        match (term, flow) {
            (Term::Sides, Some(flow)) => {
                let numbers = samples.map(|sample| self.index(sequence, pixel, sample));
                self.add_border(&mut sums, workers, (pixel, flow, on_sides), numbers);
            }
            (Term::Rim, Some(flow)) if self.center.rays.hole() != Hole::Point => {
                let numbers = samples.map(|sample| self.index(sequence, pixel, sample));
                self.add_border(&mut sums, workers, (pixel, flow, on_rim), numbers);
            }
            (Term::Sides | Term::Rim, _) => {}
            (Term::Moving, _) if !matches!(self.motion, Motion::Part(_)) => {}
            (Term::Rest | Term::Moving, _) => {
                let places = if term == Term::Moving { PLACES_PER_SAMPLE } else { 1 };
                for place in samples.start * places..samples.end * places {
                    let index = self.index(sequence, pixel, place);
                    self.add_inside(&mut sums, workers, (pixel, flow), (term, index));
                }
                let share = f64::from(places).recip();
                (sums.slope, sums.exposure) = (sums.slope * share, sums.exposure * share);
            }
        }
        sums
    }

    /// Adds a sample of Dg/Dθ + g·div V and one of g, where the place belongs to the term.
    fn add_inside(
        &self,
        sums: &mut TermSums,
        workers: &mut StepWorkers<'_>,
        (pixel, flow): (u64, Option<&Flow>),
        (term, index): (Term, u64),
    ) {
        let at = uniform(self.drawn(index));
        let moved = flow.map_or(Place::ZERO, |flow| flow.velocity(at) * self.step);
        if self.term_of((pixel, flow), at, moved) != term {
            return;
        }
        let below = integrand(&self.below, &mut workers.below, (pixel, at - moved), index);
        let above = integrand(&self.above, &mut workers.above, (pixel, at + moved), index);
        let mean = 0.5 * (above + below);
        sums.slope += (above - below) / (2.0 * self.step) + flow.map_or(0.0, Flow::divergence) * mean;
        sums.exposure += mean;
        sums.rays += 2;
    }

    /// The term to which a sample belongs: it moves if it or a place beside it shows what moves. This
    /// is a function of the sample's place alone, so the terms add up to the whole integral.
    fn term_of(&self, (pixel, flow): (u64, Option<&Flow>), at: Place, moved: Place) -> Term {
        let Motion::Part(part) = self.motion else { return Term::Rest };
        let shows_part = |side: &Exposer<'_>, at: Place| {
            let ray = ray(side.rays, pixel, at).and_then(|ray| Ray::new(ray.origin, ray.direction));
            let hit = ray.and_then(|ray| side.renderer.plan().first_hit(&ray, None));
            hit.is_some_and(|hit| part.moves(hit.surface.index()))
        };
        let is_beside =
            || flow.is_some_and(|flow| flow.beside(at).into_iter().any(|beside| shows_part(&self.center, beside)));
        let is_moving = shows_part(&self.below, at - moved) || shows_part(&self.above, at + moved) || is_beside();
        if is_moving { Term::Moving } else { Term::Rest }
    }

    /// Adds samples of −∮ g·V·n ds.
    fn add_border(
        &self,
        sums: &mut TermSums,
        workers: &mut StepWorkers<'_>,
        (pixel, flow, border): (u64, &Flow, DrawBorder),
        numbers: impl Iterator<Item = u64>,
    ) {
        for index in numbers {
            let Border { at, normal, share } = border(self.drawn(index));
            let outflow = flow.velocity(at).dot(normal) * share;
            sums.slope -= outflow * integrand(&self.center, &mut workers.center, (pixel, at), index);
            sums.rays += 1;
        }
    }

    fn drawn(&self, index: u64) -> [f64; 4] {
        RaySampler::new(self.center.rays.seed(), index).take(DimensionSet::CAMERA)
    }
}

/// The exposure by light along one ray, as if all of the pixel's rays were like it, J/m².
fn integrand(exposer: &Exposer<'_>, workers: &mut Workers<'_>, (pixel, at): (u64, Place), index: u64) -> f64 {
    let rays = exposer.rays;
    let Some(ray) = ray(rays, pixel, at) else { return 0.0 };
    let light = radiance(workers, index, (rays, pixel), &ray, exposer.weights);
    rays.camera().exposure_per_radiance() * ray.cos4 * light
}
