//! Samples of the derivative of one pixel.

use super::flow::Flow;
use super::{ParameterStep, RANDOMISATIONS};
use crate::domain::Domain;
use crate::fixed::radiance;
use crate::{Exposer, Workers};
use glam::DVec2;
use radsight_adaptive::ray_number;
use radsight_sampling::{DimensionSet, RaySampler};
use std::f64::consts::TAU;
use std::ops::Range;

/// Sequences of each pixel: outlines, and for each randomisation those inside the domain and those
/// on its rim.
const SEQUENCES: u64 = 1 + 2 * RANDOMISATIONS as u64;

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

    /// Sums of samples of dE/dθ and of E of a pixel.
    pub(super) fn sum(
        &self,
        workers: &mut StepWorkers<'_>,
        (pixel, flow): (u64, Option<&Flow>),
        randomisation: u32,
        samples: Range<u32>,
    ) -> [f64; 2] {
        let domain = Domain::of(self.center.rays.hole());
        let sequence = 1 + 2 * u64::from(randomisation);
        let [mut sum, mut exposure] = [0.0; 2];
        for sample in samples {
            let [slope, mean] = self.inside(workers, (pixel, domain, flow), self.index(sequence, pixel, sample));
            sum += slope;
            exposure += mean;
            if let Some(flow) = flow {
                sum -= self.across_rim(workers, (pixel, domain, flow), self.index(sequence + 1, pixel, sample));
            }
        }
        [sum, exposure]
    }

    /// A sample of Dg/Dθ + g·div V, and one of g.
    fn inside(
        &self,
        workers: &mut StepWorkers<'_>,
        (pixel, domain, flow): (u64, Domain, Option<&Flow>),
        index: u64,
    ) -> [f64; 2] {
        let (fixed, drawn) = self.drawn(domain, index);
        let at = domain.uniform(drawn);
        let moved = flow.map_or(DVec2::ZERO, |flow| flow.velocity(fixed, at) * self.step);
        let above = integrand(&self.above, &mut workers.above, (pixel, domain), (fixed, at + moved), index);
        let below = integrand(&self.below, &mut workers.below, (pixel, domain), (fixed, at - moved), index);
        let mean = 0.5 * (above + below);
        [(above - below) / (2.0 * self.step) + flow.map_or(0.0, Flow::divergence) * mean, mean]
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
