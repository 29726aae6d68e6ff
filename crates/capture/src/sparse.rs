//! Pictures that are smooth nearly everywhere, from few of their pixels.
//!
//! The exposure of a sheet changes little from pixel to pixel: hole, lamp and pixel blur all that is sharp. So the pixels of a coarse
//! lattice are exposed, and the others are interpolated. A cell of the lattice is refined where the level before does not say what its
//! points are, and exposed pixel by pixel where its pixels may see an edge ([`Edges`]). The error that is asked for is shared by the noise of
//! the exposed pixels and by interpolation.
//!
//! What neither finds is found by an audit: rays of some of the pixels that were not exposed, unbiased as all rays are, must agree on the
//! average with what was interpolated. The place of the lattice changes with the seed.

use crate::adaptive::{CHANCE_AGREEMENT, Estimate, GOLDEN, MAX_PASSES, MAX_SAMPLES, Pixel, Work};
use crate::checkpoint::AdaptiveState;
use crate::edges::Edges;
use crate::lattice::Lattice;
use crate::sparse_estimate::SparseEstimate;
use radsight_pinhole::Hole;
use radsight_sampling::{DimensionSet, PixelError, RaySampler, doublings};
use rayon::prelude::*;
use std::sync::atomic::Ordering;

/// Where more than this share of the pixels beside edges is to be exposed, all pixels are: the adaptive sampler then needs fewer rays.
const MOST_NODES: f64 = 0.06;

/// The part of the squared error that interpolation may make.
const INTERPOLATION: f64 = 0.25;

/// Cells are refined for small interpolation errors once noise is no more than so many times what it may be.
const QUIET: f64 = 2.0;

/// A pixel in each square of so many pixels a side is audited.
const AUDIT_SIDE: usize = 2;

/// An audit of fewer rays says nothing of a cell, and a mean so many standard errors away is wrong.
const LEAST_AUDITED: f64 = 8.0;
const WRONG: f64 = 5.0;

/// A ray that brings so many times what is brightest in its cell has met something that the lattice has missed.
const OUTLIER: f64 = 30.0;

/// No picture is audited more often.
const MOST_AUDITS: u32 = 3;

/// Numbers the draws that place a lattice and choose pixels to audit apart from those of rays.
const PLACE: u64 = u64::MAX;

/// The lattice of one picture, and how fine it is where.
struct Sparse {
    lattice: Lattice,
    /// By cell.
    levels: Vec<u8>,
    /// By pixel; [`Lattice::nodes`].
    nodes: Vec<u8>,
    /// By pixel, those of cells that may see an edge.
    sharp: Vec<bool>,
}

impl Sparse {
    /// Makes some cells finer.
    fn refine(&mut self, cells: impl IntoIterator<Item = (usize, u8)>) {
        let finest = self.lattice.finest();
        for (cell, level) in cells {
            self.levels[cell] = level.max(self.levels[cell]).min(finest);
        }
        self.nodes = self.lattice.nodes(&self.levels);
    }

    /// Whether so many pixels are exposed beside edges, or so few lie there, that interpolating the others is not worth it.
    fn is_dense(&self) -> bool {
        let smooth = || self.nodes.iter().zip(&self.sharp).filter(|(_, sharp)| !**sharp);
        let (nodes, pixels) = (smooth().filter(|(node, _)| **node > 0).count(), smooth().count());
        nodes as f64 > MOST_NODES * pixels as f64 || 2 * pixels < self.nodes.len()
    }

    fn estimate(&self, state: &AdaptiveState) -> SparseEstimate {
        SparseEstimate::new(&self.lattice, &self.levels, &self.nodes, &state.pixels)
    }
}

impl Work<'_> {
    /// Exposes some pixels and interpolates the others, until the error is what it is to be. `None` if that is not worth it, with no
    /// samples kept, or if it was stopped: then some pixels have samples and others none, and the checkpoint is empty.
    pub(crate) fn sparse(&self, state: &mut AdaptiveState, error: f64) -> Option<Estimate> {
        let mut sparse = self.lattice().filter(|sparse| !sparse.is_dense())?;
        self.is_on_lattice.store(true, Ordering::Relaxed);
        let mut audits = 0;
        while state.passes < MAX_PASSES {
            self.expose_nodes(state, &sparse.nodes);
            if self.progress.stops() {
                return None;
            }
            let estimate = sparse.estimate(state);
            let mean = estimate.mean();
            if mean <= 0.0 {
                break;
            }
            let allowed = (error * mean / CHANCE_AGREEMENT).powi(2);
            let refined = cells_to_refine(&sparse, &estimate, allowed);
            let needed = samples_to_double(&estimate, allowed);
            state.passes += 1;
            if refined.is_empty() && needed.is_empty() {
                let found = if audits < MOST_AUDITS { self.audit(&sparse, &estimate, audits) } else { Vec::new() };
                audits += 1;
                if self.progress.stops() {
                    return None;
                }
                if found.is_empty() {
                    self.is_on_lattice.store(false, Ordering::Relaxed);
                    return Some(take_over(state, &sparse, &estimate));
                }
                sparse.refine(found);
                continue;
            }
            sparse.refine(refined);
            if sparse.is_dense() {
                break;
            }
            for pending in needed {
                state.pending = pending;
                self.double(state);
            }
        }
        self.is_on_lattice.store(false, Ordering::Relaxed);
        let given_up = state.pixels.iter().map(|pixel| u64::from(pixel.samples)).sum();
        self.discarded.fetch_add(given_up, Ordering::Relaxed);
        *state = std::mem::take(state).restarted();
        None
    }

    /// The lattice with which a picture begins; `None` where pixels have little in common.
    fn lattice(&self) -> Option<Sparse> {
        let exposer = self.exposer;
        let (rays, camera) = (exposer.rays, exposer.rays.camera());
        let is_plain = self.bands == 0 && rays.hole() != Hole::Pattern && rays.cells() == camera.pixel_count();
        if !is_plain || !exposer.by_row.is_empty() || exposer.weights.has_mosaic() {
            return None;
        }
        let [x, y, ..] = RaySampler::new(rays.seed(), PLACE).take(DimensionSet::CAMERA);
        let lattice = Lattice::new(camera.columns(), camera.rows(), [x, y])?;
        let edges = Edges::find(exposer, &self.images);
        let [across, down] = lattice.cells();
        let levels: Vec<u8> = (0..across * down).map(|cell| edges.level(&lattice, cell)).collect();
        let nodes = lattice.nodes(&levels);
        let mut sharp = vec![false; nodes.len()];
        for cell in (0..levels.len()).filter(|cell| levels[*cell] == lattice.finest()) {
            lattice.pixels(cell).for_each(|(pixel, _)| sharp[pixel] = true);
        }
        Some(Sparse { lattice, levels, nodes, sharp })
    }

    /// The first samples of the nodes that have none.
    fn expose_nodes(&self, state: &mut AdaptiveState, nodes: &[u8]) {
        let new =
            state.pixels.par_iter_mut().enumerate().filter(|(index, pixel)| nodes[*index] > 0 && pixel.samples == 0);
        let new: Vec<(usize, &mut Pixel)> = new.collect();
        new.into_par_iter().with_min_len(8).for_each_init(
            || self.exposer.workers(),
            |worker, (index, pixel)| {
                if !self.progress.stops() {
                    *pixel = self.first(worker, index);
                    self.report(pixel.samples);
                }
            },
        );
    }

    /// Compares what was interpolated with rays of its own, and says which cells have to be how fine.
    fn audit(&self, sparse: &Sparse, estimate: &SparseEstimate, round: u32) -> Vec<(usize, u8)> {
        let chosen = self.audited_pixels(sparse, round);
        let rays: Vec<(usize, f64)> = chosen
            .into_par_iter()
            .with_min_len(32)
            .map_init(
                || self.exposer.workers(),
                |worker, pixel| {
                    self.report(1);
                    self.discarded.fetch_add(1, Ordering::Relaxed);
                    (pixel, self.sums(worker, pixel, 0..1).whole)
                },
            )
            .collect();
        let mut brought = vec![f64::NAN; estimate.values.len()];
        rays.into_iter().for_each(|(pixel, light)| brought[pixel] = light);
        Audit::new(sparse, estimate, &brought).found(sparse)
    }

    /// One of each square of pixels, where it is interpolated.
    fn audited_pixels(&self, sparse: &Sparse, round: u32) -> Vec<usize> {
        let columns = sparse.lattice.columns();
        let rows = sparse.nodes.len() / columns;
        let seed = self.exposer.rays.seed();
        let of_square = |(x, y): (usize, usize)| {
            let number = PLACE - 1 - (y * columns + x) as u64;
            let u = RaySampler::new(seed, number).take(DimensionSet::render(round));
            let [x, y] = [(x, u[0]), (y, u[1])].map(|(first, u)| first + (u * AUDIT_SIDE as f64) as usize);
            (x < columns && y < rows).then_some(y * columns + x)
        };
        let squares = (0..rows).step_by(AUDIT_SIDE).flat_map(|y| (0..columns).step_by(AUDIT_SIDE).map(move |x| (x, y)));
        squares.filter_map(of_square).filter(|pixel| sparse.nodes[*pixel] == 0).collect()
    }
}

/// What rays say of interpolated pixels, cell by cell.
struct Audit {
    cells: Vec<Residuals>,
    across: usize,
}

/// Differences of rays from what was interpolated.
#[derive(Clone, Copy, Debug, Default)]
struct Residuals {
    count: f64,
    sum: f64,
    squares: f64,
    has_outlier: bool,
}

impl Residuals {
    fn added(self, other: &Residuals) -> Residuals {
        Residuals {
            count: self.count + other.count,
            sum: self.sum + other.sum,
            squares: self.squares + other.squares,
            has_outlier: self.has_outlier || other.has_outlier,
        }
    }

    /// Whether their mean cannot be zero.
    fn are_wrong(&self) -> bool {
        let mean = self.sum / self.count;
        let variance = (self.squares / self.count - mean * mean).max(0.0) / (self.count - 1.0);
        self.count >= LEAST_AUDITED && mean * mean > WRONG * WRONG * variance
    }
}

impl Audit {
    /// `brought` is NaN where no ray was sent.
    fn new(sparse: &Sparse, estimate: &SparseEstimate, brought: &[f64]) -> Audit {
        let of_cell = |cell: usize| {
            let pixels = || sparse.lattice.pixels(cell).map(|(pixel, _)| pixel);
            let brightest = pixels().map(|pixel| estimate.values[pixel]).fold(0.0, f64::max);
            let mut residuals = Residuals::default();
            for pixel in pixels().filter(|pixel| !brought[*pixel].is_nan()) {
                let residual = brought[pixel] - estimate.values[pixel];
                residuals.count += 1.0;
                residuals.sum += residual;
                residuals.squares += residual * residual;
                residuals.has_outlier |= brought[pixel] > OUTLIER * brightest;
            }
            residuals
        };
        let [across, down] = sparse.lattice.cells();
        Audit { cells: (0..across * down).map(of_cell).collect(), across }
    }

    /// The cells that are wrong, one by one or together with those around them, and the levels that they need.
    fn found(&self, sparse: &Sparse) -> Vec<(usize, u8)> {
        let judge = |cell: usize| {
            let alone = &self.cells[cell];
            if alone.has_outlier {
                return Some((cell, sparse.lattice.finest()));
            }
            let together = self.around(cell).fold(Residuals::default(), |sum, near| sum.added(&self.cells[near]));
            let is_wrong = alone.are_wrong() || together.are_wrong();
            (alone.count > 0.0 && is_wrong).then_some((cell, sparse.levels[cell] + 1))
        };
        (0..self.cells.len()).filter_map(judge).collect()
    }

    fn around(&self, cell: usize) -> impl Iterator<Item = usize> {
        let down = self.cells.len() / self.across;
        let near = |at: usize, count: usize| at.saturating_sub(1)..(at + 2).min(count);
        let columns = near(cell % self.across, self.across);
        near(cell / self.across, down).flat_map(move |y| columns.clone().map(move |x| y * self.across + x))
    }
}

/// The cells whose interpolation is worse than it may be, each with the next level: the worst first, as many as it takes.
fn cells_to_refine(sparse: &Sparse, estimate: &SparseEstimate, allowed: f64) -> Vec<(usize, u8)> {
    let [noise, bias] = estimate.squared_errors();
    if bias <= INTERPOLATION * allowed {
        return Vec::new();
    }
    let is_quiet = noise <= QUIET * allowed;
    let is_candidate = |cell: &usize| {
        let residual = &estimate.residuals[*cell];
        residual.error() > 0.0 && (is_quiet || residual.is_significant())
    };
    let mut worst: Vec<usize> = (0..sparse.levels.len()).filter(is_candidate).collect();
    worst.sort_by(|a, b| estimate.residuals[*b].error().total_cmp(&estimate.residuals[*a].error()));
    let mut left = bias * estimate.values.len() as f64;
    let enough = 0.5 * INTERPOLATION * allowed * estimate.values.len() as f64;
    let mut refined = Vec::new();
    for cell in worst {
        if left <= enough {
            break;
        }
        left -= estimate.residuals[cell].error() * sparse.lattice.pixels(cell).count() as f64;
        refined.push((cell, sparse.levels[cell] + 1));
    }
    refined
}

/// The nodes whose samples are to be doubled; those that need it more than once stand in several lists.
fn samples_to_double(estimate: &SparseEstimate, allowed: f64) -> Vec<Vec<usize>> {
    let [_, bias] = estimate.squared_errors();
    let target = (allowed - bias.min(INTERPOLATION * allowed)) * estimate.values.len() as f64;
    let errors: Vec<PixelError> = estimate.nodes.iter().map(|(_, error)| *error).collect();
    let needed = doublings(&errors, target / errors.len() as f64, MAX_SAMPLES);
    // What is needed beyond a doubling is an extrapolation: one less is done at a time.
    let list = |times: usize| -> Vec<usize> {
        let least = if times == 0 { 0.0 } else { times as f64 + 1.0 };
        let nodes = estimate.nodes.iter().zip(&needed);
        let is_chosen = |node: usize, needed: f64| needed > least + (node as f64 * GOLDEN).fract();
        nodes.filter(|((node, _), needed)| is_chosen(*node, **needed)).map(|((node, _), _)| *node).collect()
    };
    (0..3).map(list).take_while(|list| !list.is_empty()).collect()
}

/// Gives the pixels that were not exposed what was interpolated, as if of as many samples as the nodes around them have: whoever goes on with
/// them sees their errors and doubles them as any others.
fn take_over(state: &mut AdaptiveState, sparse: &Sparse, estimate: &SparseEstimate) -> Estimate {
    // Cubic interpolation can undershoot beside a dark part; no exposure is below zero.
    let mean = estimate.values.iter().map(|value| value.max(0.0)).sum::<f64>() / estimate.values.len() as f64;
    let unit = (mean * mean).recip();
    let samples: u64 = estimate.nodes.iter().map(|(_, error)| u64::from(error.samples)).sum();
    let samples = ((samples / estimate.nodes.len().max(1) as u64).max(1) as u32).next_power_of_two().min(MAX_SAMPLES);
    let mut errors = Vec::with_capacity(state.pixels.len());
    for (index, pixel) in state.pixels.iter_mut().enumerate() {
        let squared = estimate.noise[index] + estimate.bias[index];
        errors.push(PixelError { squared: unit * squared, gain: 0.5, samples: pixel.samples });
        if sparse.nodes[index] == 0 {
            let sum = estimate.values[index].max(0.0) * f64::from(samples);
            *pixel = Pixel { samples, sum, last: squared, before: 2.0 * squared, ..Pixel::default() };
        }
    }
    Estimate { pixels: errors, mean }
}
