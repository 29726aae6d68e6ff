//! Samples pixels until the derivative has its error.

use super::derivative_picture::{Derivative, WINDOW, mean, mean_and_squared_error, pooled, relative_to, signal};
use super::flow::Flow;
use super::outline::{PixelRays, SeenPart, seen_parts};
use super::pixel_derivative::{StepWorkers, Term};
use super::{DerivativeSamples, ParameterStep, RANDOMISATIONS};
use crate::Progress;
use crate::neighbourhood::window_means;
use radsight_adaptive::{
    ErrorEstimate, NoiseTarget, PixelError, PixelSamples, PixelSource, SampleSums, SamplingState, Selection, begin,
    double, refine,
};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

/// Sums over the samples of one term of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct StepSums {
    /// Of the derivative, by randomisation.
    slopes: [f64; RANDOMISATIONS as usize],
    /// Of the exposure.
    exposure: f64,
}

/// Samples of one term of a pixel so far, of each randomisation. The sampler treats terms as if they
/// were pixels: first [`Term::Rest`] of all pixels, then the others.
type Cell = PixelSamples<StepSums>;

impl SampleSums for StepSums {
    /// The error follows from the randomisations.
    type HalfDifference = ();
    type Mean = f64;

    fn add(&mut self, other: &StepSums) {
        self.slopes.iter_mut().zip(other.slopes).for_each(|(sum, added)| *sum += added);
        self.exposure += other.exposure;
    }

    fn half_difference(_first: &StepSums, _second: &StepSums, _samples: u32) {}

    fn mean(&self, samples: u32) -> f64 {
        self.slopes.iter().sum::<f64>() / f64::from(RANDOMISATIONS * samples)
    }
}

/// Largest number of samples of a randomisation.
const MAX_SAMPLES: u32 = 1 << 14;

/// Factor by which a doubling of the samples lowers the squared error, for the choice of pixels.
const GAIN: f64 = 0.4;

const MAX_PASSES: u32 = 48;

/// Change of a pixel over a step, relative to its exposure, that rounding makes.
const ROUNDING: f64 = 1e-9;

/// First samples of each randomisation. Fewer miss the few samples that change sides at a shadow
/// edge, and with them the noise.
const FIRST_SAMPLES: u32 = 8;

/// The error of the step is estimated in one of this many pixels.
const STEP_LATTICE: usize = 7;

/// Its number of samples of a randomisation: this many, or this fraction of those of the derivative.
const STEP_SAMPLES: u32 = 64;
const STEP_SHARE: u32 = 4;

/// Squared standard error of the mean.
fn squared_error(cell: &Cell) -> f64 {
    let samples = f64::from(cell.samples.max(1));
    mean_and_squared_error(&cell.sums.slopes.map(|sum| sum / samples)).1
}

/// The derivative by samples of each pixel; `None` if the work was stopped.
pub(super) fn derivative(
    step: &ParameterStep<'_>,
    samples: DerivativeSamples,
    progress: &dyn Progress,
) -> Option<Derivative> {
    let rays = step.center.rays;
    let camera = rays.camera();
    let size = [camera.columns(), camera.rows()].map(|count| count as usize);
    let parts = seen_parts(step, &PixelRays { size, ray: &|pixel, u| Some(rays.ray(pixel, u)) }, progress);
    let flow = |(pixel, part): (usize, &Option<SeenPart>)| {
        let outline = part.filter(|part| part.has_outline)?.point;
        Flow::following(step, pixel as u64, outline)
    };
    let flows: Vec<Option<Flow>> = parts.par_iter().enumerate().map(flow).collect();
    let sampler = Sampler { step, flows: &flows, progress, traced: AtomicU64::new(0) };
    let mut state = SamplingState::new(Term::ALL.len() * flows.len());
    begin(&sampler, &mut state);
    match samples {
        DerivativeSamples::ToError(error) => sampler.refine(&mut state, error),
        DerivativeSamples::PerPixel(samples) => {
            let enough = |state: &SamplingState<StepSums>| state.pixels[0].samples * RANDOMISATIONS >= samples;
            while !state.pixels.is_empty() && !enough(&state) && !progress.stops() {
                state.pending = (0..state.pixels.len()).collect();
                double(&sampler, &mut state);
            }
        }
    }
    if progress.stops() {
        return None;
    }
    let estimate = DerivativeErrors::new(&state.pixels, rays.camera().columns() as usize, step.step);
    let size = estimate.signal.sqrt();
    let squared = of_pixels(&estimate.cells, |cell| cell.squared);
    Some(Derivative {
        relative_error: relative_to(mean(&squared), size),
        step_error: relative_to(sampler.squared_step_error(&state.pixels), size),
        values: of_pixels(&state.pixels, Cell::mean),
        standard_errors: squared.iter().map(|squared| squared.sqrt()).collect(),
        rays: sampler.traced.load(Ordering::Relaxed),
        outline_pixels: flows.iter().flatten().count(),
    })
}

/// Zero, if the step changes none of the first rays, as the rotation of a sphere about its middle does:
/// samples that follow an outline would have noise without end, and a relative error of zero cannot be
/// reached. `None` at the first change.
pub(super) fn zero_without_change(step: &ParameterStep<'_>, progress: &dyn Progress) -> Option<Derivative> {
    let traced = rays_without_change(step, progress)?;
    let zeros = vec![0.0; step.center.rays.camera().pixel_count() as usize];
    Some(Derivative {
        values: zeros.clone(),
        standard_errors: zeros,
        relative_error: 0.0,
        step_error: 0.0,
        rays: traced,
        outline_pixels: 0,
    })
}

/// Number of first rays, if the step changes none of them.
fn rays_without_change(step: &ParameterStep<'_>, progress: &dyn Progress) -> Option<u64> {
    let flows = vec![None; step.center.rays.camera().pixel_count() as usize];
    let sampler = Sampler { step, flows: &flows, progress, traced: AtomicU64::new(0) };
    let is_unchanged = |workers: &mut StepWorkers<'_>, cell: usize| {
        let sums = sampler.sums_of_step(step, workers, cell, 0..FIRST_SAMPLES);
        sums.slopes.iter().all(|slope| (slope * step.step).abs() <= ROUNDING * sums.exposure.abs())
    };
    // Without a flow there are only `Term::Rest` and `Term::Moving`.
    let cells = (0..2 * flows.len()).into_par_iter();
    let unchanged = cells.map_init(|| step.step_workers(), |workers, cell| is_unchanged(workers, cell)).all(|is| is);
    unchanged.then(|| sampler.traced.load(Ordering::Relaxed))
}

struct Sampler<'a> {
    step: &'a ParameterStep<'a>,
    flows: &'a [Option<Flow>],
    progress: &'a dyn Progress,
    traced: AtomicU64,
}

impl Sampler<'_> {
    /// Doubles samples where that lowers the error most, until the error is reached.
    fn refine(&self, state: &mut SamplingState<StepSums>, error: f64) {
        let columns = self.step.center.rays.camera().columns() as usize;
        let target = NoiseTarget {
            most_samples: MAX_SAMPLES,
            most_passes: MAX_PASSES,
            ..NoiseTarget::new(error * error, Selection::FractionOrFirst)
        };
        refine(self, state, &target, |cells| DerivativeErrors::new(cells, columns, self.step.step));
    }

    /// Samples of a cell with this step.
    fn sums_of_step(
        &self,
        step: &ParameterStep<'_>,
        workers: &mut StepWorkers<'_>,
        cell: usize,
        range: Range<u32>,
    ) -> StepSums {
        let (pixel, term) = (cell % self.flows.len(), Term::ALL[cell / self.flows.len()]);
        let flow = self.flows[pixel].as_ref();
        let (mut added, mut rays) = (StepSums::default(), 0);
        for (randomisation, slope) in (0..).zip(&mut added.slopes) {
            let sums = step.sum(workers, (pixel as u64, flow, term), randomisation, range.clone());
            *slope = sums.slope;
            added.exposure += sums.exposure;
            rays += sums.rays;
        }
        let done = self.traced.fetch_add(rays, Ordering::Relaxed) + rays;
        self.progress.report(done, done);
        added
    }

    /// Mean squared error due to the finite step, from a lattice of pixels. Products of the
    /// differences of independent randomisations have no noise in the mean. Terms on the rim do not
    /// depend on the step.
    fn squared_step_error(&self, cells: &[Cell]) -> f64 {
        let Some(doubled) = self.step.doubled() else { return 0.0 };
        let pixels = self.flows.len();
        let squares: Vec<f64> = (0..pixels)
            .into_par_iter()
            .step_by(STEP_LATTICE)
            .map_init(
                || [self.step.step_workers(), doubled.step_workers()],
                |[near, far], pixel| {
                    let [rest, moving] = [pixel, pixels + pixel].map(|cell| {
                        let range = 0..step_samples(&cells[cell]);
                        let [near, far] = [(self.step, &mut *near), (&doubled, &mut *far)]
                            .map(|(step, workers)| self.sums_of_step(step, workers, cell, range.clone()));
                        let mut slopes = far.slopes;
                        slopes.iter_mut().zip(near.slopes).for_each(|(far, near)| *far = (*far - near) / 3.0);
                        Cell::of(StepSums { slopes, exposure: 0.0 }, range.len() as u32)
                    });
                    (rest.mean() + moving.mean()).powi(2) - squared_error(&rest) - squared_error(&moving)
                },
            )
            .collect();
        mean(&squares).max(0.0)
    }
}

/// Number of samples of a cell for the error of the step.
fn step_samples(cell: &Cell) -> u32 {
    cell.samples.min(STEP_SAMPLES.max(cell.samples / STEP_SHARE))
}

impl<'a> PixelSource for Sampler<'a> {
    type Sums = StepSums;
    type Worker = StepWorkers<'a>;

    fn worker(&self) -> StepWorkers<'a> {
        self.step.step_workers()
    }

    fn sums(&self, workers: &mut StepWorkers<'a>, cell: usize, samples: Range<u32>) -> StepSums {
        self.sums_of_step(self.step, workers, cell, samples)
    }

    /// Without doublings: the error follows from the randomisations.
    fn first(&self, workers: &mut StepWorkers<'a>, cell: usize) -> Cell {
        Cell::of(self.sums(workers, cell, 0..FIRST_SAMPLES), FIRST_SAMPLES)
    }

    fn stops(&self) -> bool {
        self.progress.stops()
    }
}

/// The errors of the cells.
struct DerivativeErrors {
    cells: Vec<PixelError>,
    /// Mean square of the derivative.
    signal: f64,
}

impl DerivativeErrors {
    fn new(cells: &[Cell], columns: usize, step: f64) -> DerivativeErrors {
        let terms = cells.chunks((cells.len() / Term::ALL.len()).max(1));
        let squared = terms.flat_map(|cells| squared_errors(cells, columns));
        let of_cell = |(cell, squared): (&Cell, f64)| PixelError { squared, gain: GAIN, samples: cell.samples };
        let errors: Vec<PixelError> = cells.iter().zip(squared).map(of_cell).collect();
        let exposure = |cell: &Cell| cell.sums.exposure / f64::from(RANDOMISATIONS * cell.samples.max(1));
        let pictures = (&of_pixels(cells, Cell::mean)[..], &of_pixels(cells, exposure)[..]);
        let signal = signal(pictures, &of_pixels(&errors, |cell| cell.squared), step);
        DerivativeErrors { cells: errors, signal }
    }
}

impl ErrorEstimate for DerivativeErrors {
    fn pixels(&self) -> &[PixelError] {
        &self.cells
    }

    /// The squared error of a pixel is the sum of those of its cells, and the target their mean.
    fn unit(&self) -> f64 {
        self.signal / Term::ALL.len() as f64
    }
}

/// Sums over the terms of each pixel.
fn of_pixels<C>(cells: &[C], of_cell: impl Fn(&C) -> f64) -> Vec<f64> {
    let pixels = cells.len() / Term::ALL.len();
    (0..pixels).map(|pixel| cells.iter().skip(pixel).step_by(pixels).map(&of_cell).sum()).collect()
}

/// Squared standard error of each cell of a term: its own, and that of its window for equally many
/// samples.
fn squared_errors(cells: &[Cell], columns: usize) -> Vec<f64> {
    let own: Vec<f64> = cells.iter().map(squared_error).collect();
    let of_one: Vec<f64> = own.iter().zip(cells).map(|(own, cell)| own * f64::from(cell.samples)).collect();
    let near = window_means(&of_one, columns, WINDOW);
    let of_cell = |((own, near), cell): ((&f64, &f64), &Cell)| pooled(*own, near / f64::from(cell.samples.max(1)));
    own.iter().zip(&near).zip(cells).map(of_cell).collect()
}
