//! Interpolation of pictures that are smooth nearly everywhere.
//!
//! The exposure of a sheet varies slowly from pixel to pixel: pinhole, lamp and pixel blur all
//! sharp features. So the pixels of a coarse lattice are exposed, and the others are interpolated.
//! A cell that may see an edge ([`Edges`]) begins with a level that resolves the edge. Cells are
//! refined where the previous level does not predict their points. Noise of the exposed pixels and
//! interpolation share the requested error.
//!
//! An audit finds the remaining errors: rays of some interpolated pixels, which are unbiased, must
//! agree on average with the interpolation. The position of the lattice depends on the seed.

use crate::Workers;
use crate::adaptive::{AdaptiveSampler, ImagesApart, MAX_PASSES, RESERVED_NUMBER};
use crate::apart_images::ApartImages;
use crate::audit::Audit;
use crate::checkpoint::AdaptiveState;
use crate::edges::{Edges, SearchedFilm};
use crate::film::UnblurredFilm;
use crate::image_light::{ExposedImages, IMAGE_FRACTION};
use crate::lattice::{LEAST_FILM_SIDE, LEAST_SIDE, Lattice};
use crate::pinhole_blur::PinholeBlur;
use crate::pixel_errors::{Estimate, NoisePooling, SELECTION_BIAS, relative_unit};
use crate::shared_film::FilmRecord;
use crate::sparse_estimate::{Picture, SparseEstimate, residual_ratio};
use crate::subpixels::Subpixels;
use crate::sums::{Pixel, Sums};
use radsight_adaptive::{
    ErrorTarget, FIRST_SAMPLES, MAX_SAMPLES, PixelError, PixelSource, Stop, double, doublings, selection_threshold,
};
use radsight_sampling::{DimensionSet, RaySampler};
use rayon::prelude::*;
use std::sync::atomic::Ordering;

/// If the lattice and its refinement would expose more than this fraction of the pixels, all pixels
/// are exposed.
const MAX_NODE_FRACTION: f64 = 0.6;

/// Fraction of the squared error that is allotted to interpolation.
const INTERPOLATION_FRACTION: f64 = 0.1;

/// Maximum fraction of the squared error that is due to blurring an unblurred film.
const MAX_FILM_FRACTION: f64 = 0.7;

/// It is not trusted while the squared error due to noise is above this multiple of what is
/// requested.
const QUIET: f64 = 4.0;

/// Change of that error, relative to the requested squared error, that is taken into account.
const FILM_ERROR_STEP: f64 = 0.02;

/// Cells are refined only when the noise is below this multiple of what is allowed.
const LOW_NOISE: f64 = 2.0;

/// The squared error relative to what is allowed from which a picture is not finished: then a user would be
/// told.
const MOST_EXCEEDED: f64 = 1.05 * 1.05;

/// Number of passes from which more samples are traced than seem to be needed, and the factor of the
/// allowed noise for each further pass. What is known of rare bright rays grows with the samples, and
/// the error would be followed in ever smaller steps.
const UNHURRIED_PASSES: u32 = 12;
const HASTE: f64 = 0.97;

/// First samples of pixels that see refracted light, or a highlight that is narrower than a pixel. Both have
/// rare and bright rays: pixels whose first rays met none would stay too dark.
const FIRST_OF_RARE: u32 = 64;

/// Number of samples of a point and its mirror image.
const PAIR: u32 = 2;

/// Fraction of the nodes that have enough samples to tell their noise, at the least.
const NOISE_NODES: f64 = 0.25;

/// Steps of the two-dimensional sequence of lowest discrepancy, M. Roberts' R2: the powers of the
/// inverse of the plastic ratio.
const R2: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_2];

/// Squared mean residual of a cell up to which it is corrected and not refined, relative to the
/// requested mean squared error.
const MOST_CORRECTED: f64 = 16.0;

/// Maximum number of audits of a picture.
const MAX_AUDITS: u32 = 3;

/// The lattice of a picture, with its local refinement.
pub(crate) struct Sparse {
    lattice: Lattice,
    /// By cell.
    levels: Vec<u8>,
    /// By pixel; [`Lattice::nodes`].
    nodes: Vec<u8>,
    /// Whether radiance is smooth within each pixel.
    is_smooth: bool,
    /// By cell: what a residual says about the error of interpolation.
    ratios: Vec<f64>,
    /// By pixel: the width of the sharpest edge.
    edge_widths: Vec<f64>,
    pooling: NoisePooling,
}

impl Sparse {
    /// Refines cells.
    fn refine(&mut self, cells: impl IntoIterator<Item = (usize, u8)>) {
        let finest = self.lattice.finest();
        for (cell, level) in cells {
            self.levels[cell] = level.max(self.levels[cell]).min(finest);
        }
        self.nodes = self.lattice.nodes(&self.levels);
    }

    /// Refines all cells to the finest level where interpolation does not pay.
    fn refine_all_if_dense(&mut self) {
        if self.is_dense() {
            self.levels.fill(self.lattice.finest());
            self.nodes = self.lattice.nodes(&self.levels);
        }
    }

    /// Whether interpolation does not pay.
    fn is_dense(&self) -> bool {
        let nodes = self.nodes.iter().filter(|node| **node > 0).count();
        nodes as f64 > MAX_NODE_FRACTION * self.nodes.len() as f64
    }

    /// `error` is the requested one, relative to the mean.
    fn estimate(&self, state: &AdaptiveState, film: Option<&UnblurredFilm>, error: f64) -> SparseEstimate {
        let (cells, samples) = ((&*self.levels, &*self.ratios), (&*state.pixels, self.pooling));
        let requested = (error / SELECTION_BIAS).powi(2);
        SparseEstimate::new(&self.lattice, cells, &self.nodes, samples, (film, requested))
    }
}

/// The mean squared error that is due to blurring an unblurred film.
#[derive(Default)]
struct FilmError(Option<f64>);

impl FilmError {
    /// As measured before, or now; 0 without a film.
    fn known(&mut self, blur: Option<&PinholeBlur<'_>>, estimate: &SparseEstimate) -> f64 {
        *self.0.get_or_insert_with(|| FilmError::measured(blur, estimate))
    }

    /// Measures it again; whether it has grown by more than `step`, and is then known.
    fn has_grown(&mut self, blur: Option<&PinholeBlur<'_>>, estimate: &SparseEstimate, step: f64) -> bool {
        let measured = FilmError::measured(blur, estimate);
        let has_grown = self.0.is_none_or(|known| measured > known + step);
        if has_grown {
            self.0 = Some(measured);
        }
        has_grown
    }

    fn measured(blur: Option<&PinholeBlur<'_>>, estimate: &SparseEstimate) -> f64 {
        blur.map_or(0.0, |blur| blur.mean_squared_error(&estimate.values))
    }
}

impl<'a> AdaptiveSampler<'a> {
    /// Whether each ray adds its radiance to one pixel, in the same way for all pixels.
    pub(crate) fn is_plain(&self) -> bool {
        let (exposer, rays) = (self.exposer, self.exposer.rays);
        let has_points = rays.hole().has_points() && rays.cells() == rays.camera().pixel_count();
        self.bands == 0 && has_points && exposer.by_row.is_empty() && !exposer.weights.has_mosaic()
    }

    /// Exposes some pixels and interpolates the others, until the requested error is reached.
    /// `None` if this does not pay, with no samples kept, or if it was stopped: then some pixels
    /// have samples and others have none, and the checkpoint is empty.
    pub(crate) fn sparse(
        &self,
        state: &mut AdaptiveState,
        target: ErrorTarget,
        images: Option<&mut ApartImages>,
        mut sparse: Sparse,
    ) -> Option<(Estimate, Option<Stop>)> {
        let most = target.most_samples.min(MAX_SAMPLES);
        let mirrors_points = || sparse.is_smooth && self.exposer.renderer.integrates_all_lights();
        let mirrors_points = self.shared.known().map_or_else(mirrors_points, |known| known.record.mirrors_points);
        self.mirrors_points.store(mirrors_points, Ordering::Relaxed);
        self.is_on_lattice.store(true, Ordering::Relaxed);
        let mut blur = self.film.as_ref().map(|film| self.blur(film, (&sparse.lattice, &sparse.levels)));
        let (mut audits, mut film_error) = (0, FilmError::default());
        loop {
            self.expose_nodes(state, &sparse.nodes);
            if self.progress.stops() {
                return None;
            }
            let estimate = sparse.estimate(state, self.film.as_deref(), target.error);
            let of_images = images.as_ref().map_or(0.0, |images| images.sum()) / estimate.pixel_count as f64;
            let mean = estimate.mean() + of_images;
            if relative_unit(mean) == 0.0 {
                break;
            }
            let all = (target.error * mean / SELECTION_BIAS).powi(2);
            let requested = if images.is_some() { (1.0 - IMAGE_FRACTION) * all } else { all };
            let most_known = MAX_FILM_FRACTION * requested;
            let mut known = film_error.known(blur.as_ref(), &estimate);
            if known > most_known {
                film_error = FilmError::default();
                if estimate.squared_errors()[0] <= QUIET * requested {
                    break;
                }
                // Noise looks like edges.
                known = most_known;
            }
            let refined = cells_to_refine(&sparse, &estimate, requested - known);
            let needed = samples_to_double(&estimate, (requested - known, state.passes), most);
            let has_passes = state.passes < MAX_PASSES;
            state.passes += 1;
            if has_passes && !(refined.is_empty() && needed.is_empty()) {
                self.expose_further(state, &mut sparse, refined, needed);
                continue;
            }
            // With less noise there are more edges.
            if has_passes && film_error.has_grown(blur.as_ref(), &estimate, FILM_ERROR_STEP * requested) {
                continue;
            }
            if let Some(blur) = blur.as_mut() {
                let stands_alone = |pixel: usize| sparse.nodes[pixel] == sparse.lattice.finest();
                let samples = (&*state.pixels, stands_alone);
                blur.subpixels = Some(Subpixels::new(blur.film, &estimate.values, &self.subpixels, samples));
            }
            let picture = blur.as_ref().map(|blur| estimate.blurred(blur, (&sparse.lattice, &sparse.nodes)));
            let values = picture.as_ref().map_or(&estimate.values, |picture| &picture.values);
            let audited = self.audited((&sparse.lattice, &sparse.nodes), audits);
            let mut refined = Vec::new();
            if has_passes && audits < MAX_AUDITS {
                let audit = Audit::new(&sparse.lattice, values, &audited);
                refined = audit.cells_to_refine(&sparse.lattice, &sparse.levels, MOST_CORRECTED * requested);
            }
            audits += 1;
            if self.progress.stops() {
                return None;
            }
            if refined.is_empty() {
                let left = all - known - estimate.squared_errors().iter().sum::<f64>();
                let squared = estimate.pixel_count as f64 * left.max(0.5 * IMAGE_FRACTION * all);
                self.keep(state, &sparse, &estimate);
                let (mut estimate, mut picture) = (estimate, picture);
                let estimates = (&mut estimate, picture.as_mut());
                self.correct(estimates, (&sparse.lattice, &sparse.nodes), (&audited, blur.as_ref()), requested);
                let images = images.map(|images| images.expose(self, squared, most));
                let stop = images.as_ref().and_then(|images| images.stop);
                let is_exhausted = !has_passes || estimate.nodes.iter().any(|(_, error)| error.samples >= most);
                let traced = state.samples();
                let found = self.finish(state, &sparse, (&estimate, picture), images);
                let is_short = found.relative_error().powi(2) > MOST_EXCEEDED * target.error.powi(2);
                if is_short && stop.is_none() && !is_exhausted && self.film.is_none() {
                    self.abandon(state, traced);
                    return None;
                }
                let limit = if is_exhausted { Stop::Rays } else { Stop::Shared };
                return Some((found, stop.or(Some(limit))));
            }
            sparse.refine(refined);
        }
        let traced = state.samples();
        self.abandon(state, traced);
        None
    }

    /// Records a finished lattice where others use it.
    fn keep(&self, state: &AdaptiveState, sparse: &Sparse, estimate: &SparseEstimate) {
        if let Some(mut record) = self.shared.record() {
            let mut state = state.clone();
            fill_interpolated(&mut state, sparse, estimate);
            record.film.clone_from(&self.film);
            record.edge_widths.clone_from(&sparse.edge_widths);
            record.outlines.clone_from(&self.outlines);
            record.mirrors_points = self.mirrors_points.load(Ordering::Relaxed);
            record.pixels = state.pixels;
            record.subpixels = self.subpixels.to_vec();
        }
    }

    /// Refines cells; where there are none, doubles the samples of nodes.
    fn expose_further(
        &self,
        state: &mut AdaptiveState,
        sparse: &mut Sparse,
        refined: Vec<(usize, u8)>,
        needed: Vec<Vec<usize>>,
    ) {
        let is_refined = !refined.is_empty();
        sparse.refine(refined);
        sparse.refine_all_if_dense();
        // Refined cells need fewer samples at their old nodes.
        if !is_refined {
            for pending in needed {
                state.pending = pending;
                double(self, state);
            }
        }
    }

    /// Assigns the values of a finished lattice to the pixels.
    fn finish(
        &self,
        state: &mut AdaptiveState,
        sparse: &Sparse,
        (estimate, picture): (&SparseEstimate, Option<Picture>),
        images: Option<ExposedImages>,
    ) -> Estimate {
        self.is_on_lattice.store(false, Ordering::Relaxed);
        let mut rest = match (&self.film, picture) {
            (Some(film), Some(picture)) => develop(state, film, estimate, &picture),
            _ => fill_interpolated(state, sparse, estimate),
        };
        if let Some(images) = images {
            images.add_to(state, &mut rest);
        }
        rest
    }

    /// Forgets the samples of a lattice, and what was recorded of it.
    fn abandon(&self, state: &mut AdaptiveState, traced: u64) {
        if let Some(mut record) = self.shared.record() {
            *record = FilmRecord::default();
        }
        self.is_on_lattice.store(false, Ordering::Relaxed);
        self.mirrors_points.store(false, Ordering::Relaxed);
        self.discarded.fetch_add(traced, Ordering::Relaxed);
        *state = AdaptiveState::new(state.pixels.len());
    }

    /// The first lattice of a picture or a film, and the pixels that see the outline of a surface;
    /// `None` where the picture's neighbouring pixels have little in common. Those of a film share their
    /// rays in any case.
    pub(crate) fn lattice(&self) -> Option<(Sparse, Vec<bool>)> {
        let exposer = self.exposer;
        if !self.is_plain() {
            return None;
        }
        let [x, y, ..] = RaySampler::new(exposer.rays.seed(), RESERVED_NUMBER).take(DimensionSet::CAMERA);
        let images = matches!(self.images_apart, ImagesApart::No).then_some(&self.images);
        let (unblurred, known) = (self.film.as_deref(), self.shared.known());
        let film = SearchedFilm { exposer, images, highlights: &self.highlights, unblurred, known };
        let least = if self.film.is_some() { LEAST_FILM_SIDE } else { LEAST_SIDE };
        let lattice = Lattice::new(film.size().map(|count| count as u32), least, [x, y])?;
        let edges = Edges::find(film, &lattice);
        let [across, down] = lattice.cells();
        let levels: Vec<u8> = (0..across * down).map(|cell| edges.level(&lattice, cell)).collect();
        let nodes = lattice.nodes(&levels);
        let ratio = |(cell, level): (usize, &u8)| residual_ratio(edges.blurs(&lattice, cell, *level));
        let ratios = levels.iter().enumerate().map(ratio).collect();
        let is_smooth = edges.are_wider_than_pixels();
        let (edge_widths, outlines) = edges.into_widths_and_outlines();
        let plan = exposer.renderer.plan();
        let pooling = if plan.has_rare_rays() { NoisePooling::WideFirst } else { NoisePooling::Near };
        let mut sparse = Sparse { lattice, levels, nodes, is_smooth, ratios, edge_widths, pooling };
        if self.film.is_none() && sparse.is_dense() {
            return None;
        }
        sparse.refine_all_if_dense();
        Some((sparse, outlines))
    }

    /// Traces the first samples of the nodes that have none.
    fn expose_nodes(&self, state: &mut AdaptiveState, nodes: &[u8]) {
        let new =
            state.pixels.par_iter_mut().enumerate().filter(|(index, pixel)| nodes[*index] > 0 && pixel.samples == 0);
        let new: Vec<(usize, &mut Pixel)> = new.collect();
        new.into_par_iter().with_min_len(8).for_each_init(
            || self.worker(),
            |worker, (index, pixel)| {
                if !self.progress.stops() {
                    let shared = self.shared.known();
                    if let Some(known) = shared.and_then(|known| known.subpixels(index)) {
                        self.subpixels.add(index, known);
                    }
                    let known = shared.and_then(|known| known.samples(index));
                    *pixel = known.unwrap_or_else(|| self.first_of_node(worker, index, nodes[index]));
                    self.report(pixel.samples);
                }
            },
        );
    }

    /// The first samples of a node. Where points are mirrored, one pair is accurate: a second one is
    /// traced at some of the nodes, for the noise of all.
    fn first_of_node(&self, worker: &mut Workers<'a>, index: usize, level: u8) -> Pixel {
        if self.refracted.get(index) == Some(&true) || self.highlights.get(index) == Some(&true) {
            let mut pixel = self.first(worker, index);
            while pixel.samples < FIRST_OF_RARE {
                let known = pixel.samples;
                pixel.double(&self.sums(worker, index, known..2 * known));
            }
            return pixel;
        }
        if !self.mirrors_points.load(Ordering::Relaxed) {
            return self.first(worker, index);
        }
        let mut node = Pixel::of(self.sums(worker, index, 0..PAIR), PAIR);
        if level == 1 || tells_noise(index, self.columns()) {
            node.double(&self.sums(worker, index, PAIR..2 * PAIR));
            // Two pairs are independent.
            node.before = 2.0 * node.last;
        }
        node
    }

    /// Columns of the film or of the picture.
    pub(crate) fn columns(&self) -> usize {
        let of_picture = || self.exposer.rays.camera().columns() as usize;
        self.film.as_ref().map_or_else(of_picture, |film| film.size()[0])
    }
}

/// Whether a node gets the samples that tell its noise: a fraction of [`NOISE_NODES`] of the nodes of
/// any stride, evenly over the picture (the R2 sequence).
fn tells_noise(pixel: usize, columns: usize) -> bool {
    let (x, y) = ((pixel % columns) as f64, (pixel / columns) as f64);
    (x * R2[0] + y * R2[1]).fract() < NOISE_NODES
}

/// The cells with too much interpolation error, each with the next level: the worst first, as many
/// as needed.
fn cells_to_refine(sparse: &Sparse, estimate: &SparseEstimate, allowed: f64) -> Vec<(usize, u8)> {
    let [noise, bias] = estimate.squared_errors();
    if bias <= INTERPOLATION_FRACTION * allowed || noise > LOW_NOISE * allowed_noise(bias, allowed) {
        return Vec::new();
    }
    let error = |cell: usize| estimate.residuals[cell].error();
    let interpolated = |cell: usize| sparse.lattice.pixels(cell).filter(|(pixel, _)| sparse.nodes[*pixel] == 0).count();
    let candidates = (0..sparse.levels.len()).filter(|cell| error(*cell) > 0.0);
    let mut worst: Vec<(usize, usize)> = candidates.map(|cell| (cell, interpolated(cell))).collect();
    worst.retain(|(_, pixels)| *pixels > 0);
    worst.sort_by(|(a, _), (b, _)| error(*b).total_cmp(&error(*a)));
    let mut left = bias * estimate.values.len() as f64;
    let enough = 0.5 * INTERPOLATION_FRACTION * allowed * estimate.values.len() as f64;
    let mut refined = Vec::new();
    for (cell, pixels) in worst {
        if left <= enough {
            break;
        }
        left -= error(cell) * pixels as f64;
        refined.push((cell, sparse.levels[cell] + 1));
    }
    refined
}

/// The allowed squared error due to noise. As long as interpolation errors are too large, noise need
/// only be smaller than they are.
fn allowed_noise(bias: f64, allowed: f64) -> f64 {
    if bias > INTERPOLATION_FRACTION * allowed { allowed.max(0.5 * bias) } else { allowed - bias }
}

/// The nodes whose samples are to be doubled. A node that needs several doublings is in several
/// lists.
fn samples_to_double(estimate: &SparseEstimate, (all, passes): (f64, u32), most: u32) -> Vec<Vec<usize>> {
    let [noise, bias] = estimate.squared_errors();
    let allowed = allowed_noise(bias, all);
    let haste = if noise > allowed { HASTE.powi(passes.saturating_sub(UNHURRIED_PASSES) as i32) } else { 1.0 };
    let target = haste * allowed * estimate.pixel_count as f64;
    let needed = doubled_to(estimate, target, most);
    if !needed.is_empty() || noise + bias <= MOST_EXCEEDED * all {
        return needed;
    }
    // Beside the border of a picture nodes have more influence than their areas.
    let of_areas = estimate.nodes.iter().map(|(_, error)| error.squared).sum::<f64>();
    doubled_to(estimate, target * of_areas / (noise * estimate.pixel_count as f64), most)
}

/// The same for a target of the sum of the nodes' squared errors.
fn doubled_to(estimate: &SparseEstimate, target: f64, most: u32) -> Vec<Vec<usize>> {
    let errors: Vec<PixelError> = estimate.nodes.iter().map(|(_, error)| *error).collect();
    let needed = doublings(&errors, target / errors.len() as f64, most);
    // More than one doubling is an extrapolation, so one doubling less is done at a time.
    let chosen = |is_chosen: &dyn Fn(usize, f64) -> bool| -> Vec<usize> {
        let nodes = estimate.nodes.iter().zip(&needed);
        nodes.filter(|((node, _), needed)| is_chosen(*node, **needed)).map(|((node, _), _)| *node).collect()
    };
    let most_needed = needed.iter().copied().fold(0.0, f64::max);
    let list = |times: usize| -> Vec<usize> {
        let least = if times == 0 { 0.0 } else { times as f64 + 1.0 };
        let nodes = chosen(&|node, needed| needed > least + selection_threshold(node));
        // Where all need a small fraction, those that need most.
        let is_done = times > 0 || most_needed == 0.0 || !nodes.is_empty();
        if is_done { nodes } else { chosen(&|_, needed| needed > 0.5 * most_needed) }
    };
    (0..3).map(list).take_while(|list| !list.is_empty()).collect()
}

/// Assigns interpolated values to the pixels that were not exposed, with the number of samples of
/// the nodes around them. The adaptive sampler can then refine them like any others.
fn fill_interpolated(state: &mut AdaptiveState, sparse: &Sparse, estimate: &SparseEstimate) -> Estimate {
    // Cubic interpolation can undershoot next to a dark region; exposures are never negative.
    let mean = estimate.values.iter().map(|value| value.max(0.0)).sum::<f64>() / estimate.values.len() as f64;
    let unit = relative_unit(mean);
    let samples: u64 = estimate.nodes.iter().map(|(_, error)| u64::from(error.samples)).sum();
    let samples = ((samples / estimate.nodes.len().max(1) as u64).max(1) as u32).next_power_of_two().min(MAX_SAMPLES);
    let mut errors = Vec::with_capacity(state.pixels.len());
    for (index, pixel) in state.pixels.iter_mut().enumerate() {
        let squared = estimate.noise[index] + estimate.bias[index];
        errors.push(PixelError { squared: unit * squared, gain: 0.5, samples: pixel.samples });
        let is_node = sparse.nodes[index] > 0;
        if !is_node {
            let sum = estimate.values[index].max(0.0) * f64::from(samples);
            (pixel.samples, pixel.sums) = (samples, Sums { whole: sum, ..Sums::default() });
        }
        if !is_node || pixel.samples < FIRST_SAMPLES {
            (pixel.last, pixel.before) = (squared, 2.0 * squared);
        }
    }
    Estimate { pixels: errors, mean }
}

/// Assigns the blurred picture to pixels, with the number of samples that each would need by itself.
/// The adaptive sampler can then refine them like any others.
fn develop(state: &mut AdaptiveState, film: &UnblurredFilm, estimate: &SparseEstimate, picture: &Picture) -> Estimate {
    let whole = |samples: f64| (samples.max(1.0) as u32).next_power_of_two().min(MAX_SAMPLES);
    let nodes = estimate.nodes.len().max(1) as f64;
    let own = whole(estimate.own_samples(film).sum::<f64>() / nodes);
    let traced = state.samples();
    let pixels = film.picture_pixels() as u64;
    // Evenly over the picture, in whole numbers that add up.
    let share = |index: u64| ((index + 1) * traced / pixels - index * traced / pixels) as u32;
    let in_picture: Vec<usize> = (0..picture.values.len()).filter(|pixel| film.in_picture(*pixel).is_some()).collect();
    let mean = film.mean_over_picture(&picture.values);
    let unit = relative_unit(mean);
    let squared = |pixel: usize| picture.noise[pixel] + picture.bias[pixel];
    let error = |(index, &pixel): (usize, &usize)| PixelError {
        squared: unit * squared(pixel),
        gain: 0.5,
        samples: share(index as u64),
    };
    let developed = |pixel: usize| {
        let sums = Sums { whole: picture.values[pixel] * f64::from(own), ..Sums::default() };
        Pixel { samples: own, sums, last: squared(pixel), before: 2.0 * squared(pixel) }
    };
    *state = AdaptiveState {
        pixels: in_picture.iter().map(|pixel| developed(*pixel)).collect(),
        passes: state.passes,
        pending: Vec::new(),
    };
    Estimate { pixels: in_picture.iter().enumerate().map(error).collect(), mean }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_window_of_nodes_of_any_stride_has_some_that_tell_the_noise() {
        let columns = 192;
        for stride in [1, 2, 4] {
            for (left, top) in (0..20).flat_map(|x| (0..20).map(move |y| (x, y))) {
                let window = (0..7).flat_map(|x| (0..7).map(move |y| (left + stride * x, top + stride * y)));
                let count = window.filter(|(x, y)| tells_noise(y * columns + x, columns)).count();
                assert!((7..=18).contains(&count), "{count} of 49 nodes at {left}, {top} with stride {stride}");
            }
        }
    }
}
