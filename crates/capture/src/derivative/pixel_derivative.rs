//! Samples of the derivative of one pixel.
//!
//! The derivative is a sum of three terms ([`Term`]), each sampled for itself: a part's wall may be
//! seen by one ray in thirty and have all of the noise.

use super::flow::Flow;
use super::{Motion, ParameterStep, RANDOMISATIONS};
use crate::domain::Domain;
use crate::radiance::radiance;
use crate::{Exposer, Workers};
use glam::DVec2;
use radsight_adaptive::ray_number;
use radsight_render::Ray;
use radsight_sampling::{DimensionSet, RaySampler};
use std::f64::consts::TAU;
use std::ops::Range;

/// A term of the derivative of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Term {
    /// The integral over the domain, where rays show neither what moves nor what is close beside it.
    Rest,
    /// The same, where they do. Beside a mirror, a retroreflector is lit through it.
    Moving,
    /// The integral over the rim of the domain.
    Rim,
}

impl Term {
    pub(super) const ALL: [Term; 3] = [Term::Rest, Term::Moving, Term::Rim];
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

/// Number of points of the domain per sample of [`Term::Moving`]. Where a point does not show what
/// moves, only its first hit is computed; so samples of all terms cost about the same.
const POINTS_PER_SAMPLE: u32 = 4;

/// Points of the domain beside a point, radii of the pinhole or pixels.
const BESIDE: [DVec2; 4] =
    [DVec2::new(REACH, 0.0), DVec2::new(-REACH, 0.0), DVec2::new(0.0, REACH), DVec2::new(0.0, -REACH)];
const REACH: f64 = 0.06;

/// Sequences of each pixel: outlines, and for each randomisation one of each term.
const SEQUENCES: u64 = 1 + (Term::ALL.len() as u64) * RANDOMISATIONS as u64;

/// The workers of one thread.
pub(super) struct StepWorkers<'a> {
    center: Workers<'a>,
    below: Workers<'a>,
    above: Workers<'a>,
}

impl ParameterStep<'_> {
    pub(super) fn step_workers(&self) -> StepWorkers<'_> {
        StepWorkers { center: self.center.workers(), below: self.below.workers(), above: self.above.workers() }
    }

    /// The number of a sample's ray, for the renderer's random numbers.
    pub(super) fn index(&self, sequence: u64, pixel: u64, sample: u32) -> u64 {
        let cells = self.center.rays.camera().pixel_count();
        let block = (u64::from(self.stream) * SEQUENCES + sequence) * cells + pixel;
        ray_number(block, sample)
    }

    /// Sums of samples of a term of a pixel.
    pub(super) fn sum(
        &self,
        workers: &mut StepWorkers<'_>,
        (pixel, flow, term): (u64, Option<&Flow>, Term),
        randomisation: u32,
        samples: Range<u32>,
    ) -> TermSums {
        let domain = Domain::of(self.center.rays.hole());
        let sequence = 1 + u64::from(randomisation) * Term::ALL.len() as u64 + term as u64;
        let mut sums = TermSums::default();
        match (term, flow) {
            (Term::Rim, None) => {}
            (Term::Rim, Some(flow)) => {
                sums.rays = samples.len() as u64;
                for sample in samples {
                    let index = self.index(sequence, pixel, sample);
                    sums.slope -= self.across_rim(workers, (pixel, domain, flow), index);
                }
            }
            (Term::Moving, _) if !matches!(self.motion, Motion::Part(_)) => {}
            (Term::Rest | Term::Moving, _) => {
                let points = if term == Term::Moving { POINTS_PER_SAMPLE } else { 1 };
                for point in samples.start * points..samples.end * points {
                    let index = self.index(sequence, pixel, point);
                    self.add_inside(&mut sums, workers, (pixel, domain, flow), (term, index));
                }
                let share = f64::from(points).recip();
                (sums.slope, sums.exposure) = (sums.slope * share, sums.exposure * share);
            }
        }
        sums
    }

    /// Adds a sample of Dg/Dθ + g·div V and one of g, where the point belongs to the term.
    fn add_inside(
        &self,
        sums: &mut TermSums,
        workers: &mut StepWorkers<'_>,
        (pixel, domain, flow): (u64, Domain, Option<&Flow>),
        (term, index): (Term, u64),
    ) {
        let (fixed, drawn) = self.drawn(domain, index);
        let at = domain.uniform(drawn);
        let moved = flow.map_or(DVec2::ZERO, |flow| flow.velocity(fixed, at) * self.step);
        if self.term_of((pixel, domain, fixed), at, moved) != term {
            return;
        }
        let below = integrand(&self.below, &mut workers.below, (pixel, domain), (fixed, at - moved), index);
        let above = integrand(&self.above, &mut workers.above, (pixel, domain), (fixed, at + moved), index);
        let mean = 0.5 * (above + below);
        sums.slope += (above - below) / (2.0 * self.step) + flow.map_or(0.0, Flow::divergence) * mean;
        sums.exposure += mean;
        sums.rays += 2;
    }

    /// The term to which a sample belongs: it moves if it or a point beside it shows what moves. This
    /// is a function of the sample's points alone, so the terms add up to the whole integral.
    fn term_of(&self, (pixel, domain, fixed): (u64, Domain, DVec2), at: DVec2, moved: DVec2) -> Term {
        let Motion::Part(part) = self.motion else { return Term::Rest };
        let shows_part = |side: &Exposer<'_>, at: DVec2| {
            let ray = domain.ray(side.rays, pixel, fixed, at).and_then(|ray| Ray::new(ray.origin, ray.direction));
            let hit = ray.and_then(|ray| side.renderer.plan().first_hit(&ray, None));
            hit.is_some_and(|hit| part.moves(hit.surface.index()))
        };
        let is_beside = || BESIDE.iter().any(|offset| shows_part(&self.center, at + *offset));
        let is_moving = shows_part(&self.below, at - moved) || shows_part(&self.above, at + moved) || is_beside();
        if is_moving { Term::Moving } else { Term::Rest }
    }

    /// A sample of ∮ g·V·n ds.
    fn across_rim(
        &self,
        workers: &mut StepWorkers<'_>,
        (pixel, domain, flow): (u64, Domain, &Flow),
        index: u64,
    ) -> f64 {
        let (fixed, drawn) = self.drawn(domain, index);
        let (at, normal, length) = rim(domain, drawn[0]);
        let outflow = flow.velocity(fixed, at).dot(normal) * length / domain.area();
        outflow * integrand(&self.center, &mut workers.center, (pixel, domain), (fixed, at), index)
    }

    /// The fixed point, and two random numbers for the point of the domain.
    fn drawn(&self, domain: Domain, index: u64) -> (DVec2, [f64; 2]) {
        let u = RaySampler::new(self.center.rays.seed(), index).take(DimensionSet::CAMERA);
        match domain {
            Domain::Disk => (DVec2::new(u[0], u[1]), [u[2], u[3]]),
            Domain::Square => (DVec2::ZERO, [u[0], u[1]]),
        }
    }
}

/// A point of the rim, its outward normal, and the length of the rim.
fn rim(domain: Domain, u: f64) -> (DVec2, DVec2, f64) {
    if domain == Domain::Disk {
        let at = DVec2::from_angle(TAU * u);
        return (at, at, TAU);
    }
    let along = (4.0 * u).fract();
    let (at, normal) = match (4.0 * u) as u32 {
        0 => (DVec2::new(0.0, along), DVec2::NEG_X),
        1 => (DVec2::new(1.0, along), DVec2::X),
        2 => (DVec2::new(along, 0.0), DVec2::NEG_Y),
        _ => (DVec2::new(along, 1.0), DVec2::Y),
    };
    (at, normal, 4.0)
}

/// The exposure by light along one ray, as if all of the pixel's rays were like it, J/m².
fn integrand(
    exposer: &Exposer<'_>,
    workers: &mut Workers<'_>,
    (pixel, domain): (u64, Domain),
    (fixed, at): (DVec2, DVec2),
    index: u64,
) -> f64 {
    let rays = exposer.rays;
    let Some(ray) = domain.ray(rays, pixel, fixed, at) else { return 0.0 };
    let light = radiance(workers, index, (rays, pixel), &ray, exposer.weights);
    rays.camera().exposure_per_radiance() * ray.cos4 * light
}
