//! Rays in, radiance out.

use crate::plan::RenderPlan;
use crate::ray::Ray;
use crate::trace::{Traced, Tracer};
use rayon::prelude::*;

/// Answers rays.
#[derive(Debug)]
pub struct Renderer {
    plan: RenderPlan,
}

/// The memory with which one thread answers rays.
#[derive(Debug)]
pub struct RayWorker<'r>(Bands<'r>);

#[derive(Debug)]
enum Bands<'r> {
    Grey(Tracer<'r, 1>),
    Color(Tracer<'r, 3>),
}

/// Rays that one thread takes at a time.
const CHUNK: usize = 1024;

impl Renderer {
    /// Renders according to a plan.
    #[must_use]
    pub fn new(plan: RenderPlan) -> Renderer {
        Renderer { plan }
    }

    /// The plan.
    #[must_use]
    pub fn plan(&self) -> &RenderPlan {
        &self.plan
    }

    /// A worker for the calling thread.
    #[must_use]
    pub fn worker(&self) -> RayWorker<'_> {
        RayWorker(match self.plan.bands {
            1 => Bands::Grey(Tracer::new(&self.plan)),
            _ => Bands::Color(Tracer::new(&self.plan)),
        })
    }

    /// Answers a batch of rays on all threads; the first has number `first_index`. A gap has its number and no answer.
    #[must_use]
    pub fn trace_all(&self, first_index: u64, rays: &[Option<Ray>]) -> Vec<Option<Traced>> {
        rays.par_chunks(CHUNK)
            .enumerate()
            .map_init(
                || self.worker(),
                |worker, (chunk, rays)| {
                    let first = first_index + (chunk * CHUNK) as u64;
                    let trace = |(ray, index): (&Option<Ray>, u64)| ray.as_ref().map(|ray| worker.trace(index, ray));
                    rays.iter().zip(first..).map(trace).collect::<Vec<_>>()
                },
            )
            .flatten_iter()
            .collect()
    }
}

impl RayWorker<'_> {
    /// Answers ray number `index` of its stream.
    #[must_use]
    pub fn trace(&mut self, index: u64, ray: &Ray) -> Traced {
        match &mut self.0 {
            Bands::Grey(tracer) => tracer.trace(index, ray),
            Bands::Color(tracer) => tracer.trace(index, ray),
        }
    }
}
