//! Adaptive sampling until the requested error is reached.
//!
//! The number of samples of a pixel is doubled where that lowers the estimated error most for its cost
//! ([`Estimate`]).

use crate::checkpoint::{AdaptiveState, Checkpoint, State};
use crate::film::{FilmRay, PixelPassage, UnblurredFilm};
use crate::film_images::FilmImages;
use crate::mirrored_lights::{PixelImages, RayPurpose};
use crate::pixel_errors::{Estimate, SELECTION_BIAS};
use crate::radiance::{MAX_BANDS, bands_apart, radiance, radiance_apart};
use crate::shared_film::{FilmRecord, SharedFilm};
use crate::subpixels::SubpixelRecord;
use crate::sums::{Pixel, Sums};
use crate::two_phase::{Chosen, FIRST_PHASE, choose, numbered};
use crate::{Exposer, Exposure, Progress, Workers};
use radsight_adaptive::{
    ErrorTarget, FIRST_SAMPLES, MAX_SAMPLES, NoiseTarget, PixelSource, Replicas, ReplicatedSource, SampleCounter,
    Selection, Stop, begin, ray_number, refine,
};
use radsight_pinhole::CameraRay;
use radsight_render::{CountedLight, CubatureError, OutlinedSurface, Ray};
use radsight_sampling::{DimensionSet, RaySampler};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Fraction of the requested error that cubature over a lamp may have.
const CUBATURE_FRACTION: f64 = 0.125;

/// Number of samples of a pixel from which small lights are sampled, and from which its outlines are
/// no longer resolved by two phases. What is left of the noise has other causes, and more of cheaper
/// rays are better.
const MAX_INTEGRATED: u32 = 16;
const MAX_IN_PHASES: u32 = 64;

/// Ray numbers of first phases begin at this pixel, so that their samples are independent of others.
const FIRST_PHASE_PIXEL: u64 = 1 << 41;

/// Distance of such pixels for the next replica of a pixel.
const REPLICA_STREAM: u64 = 1 << 32;

/// Ray number of the samples that place the lattice and select pixels for audits. No ray of a pixel
/// has it.
pub(crate) const RESERVED_NUMBER: u64 = u64::MAX;

/// The renderer's set of dimensions that chooses rays of the second phase. No path is that long.
pub(crate) const CHOICE_SET: u32 = 1 << 24;

/// Maximum number of passes, whatever the error is.
pub(crate) const MAX_PASSES: u32 = 64;

impl Exposer<'_> {
    /// Exposes until the estimated rms error over the pixels is the requested one, relative to the
    /// mean exposure. Continues from a checkpoint of such an exposure.
    ///
    /// Ignores the number of samples of [`Rays`](radsight_pinhole::Rays).
    #[must_use]
    pub fn to_error(&self, target: ErrorTarget, start: Option<Checkpoint>, progress: &dyn Progress) -> Exposure {
        let state = match start {
            Some(Checkpoint(State::Adaptive { state, .. })) => state,
            _ => AdaptiveState::default(),
        };
        self.shared_to_error(target, state, SharedFilm::Own, progress).0
    }

    /// The same from a state, with what it records for others.
    pub(crate) fn shared_to_error<'a>(
        &'a self,
        target: ErrorTarget,
        mut state: AdaptiveState,
        shared: SharedFilm<'a>,
        progress: &'a dyn Progress,
    ) -> (Exposure, FilmRecord) {
        let pixels = self.rays.camera().pixel_count() as usize;
        state.pixels.resize(pixels * Replicas::new(pixels, MAX_SAMPLES).count(), Pixel::default());
        let mut sampler = AdaptiveSampler::new(self, target.error, shared, progress);
        let (estimate, stop) = sampler.expose(&mut state, target);
        let record = sampler.shared.take_record();
        (sampler.exposure(state, (estimate, stop), target.error), record)
    }
}

/// How the light of images is exposed.
#[derive(Debug)]
pub(crate) enum ImagesApart {
    /// With all other light.
    No,
    /// Apart, in the pixels that see images ([`ImageLight`](crate::image_light::ImageLight)).
    ByPixel,
    /// Apart, for all pixels at once ([`FilmImageLight`](crate::film_image_light::FilmImageLight)).
    OnFilm(Arc<FilmImages>),
}

pub(crate) struct AdaptiveSampler<'a> {
    pub(crate) exposer: &'a Exposer<'a>,
    /// Of each pixel of the picture.
    pub(crate) replicas: Replicas,
    /// Number of separate bands; 0 where bands are added up.
    pub(crate) bands: usize,
    pub(crate) images: PixelImages,
    /// How the light of images is exposed.
    pub(crate) images_apart: ImagesApart,
    /// What is exposed instead of the picture.
    pub(crate) film: Option<Arc<UnblurredFilm>>,
    /// The samples of the film.
    pub(crate) subpixels: SubpixelRecord,
    pub(crate) shared: SharedFilm<'a>,
    /// Whether each pixel of the lattice sees the outline of a surface; empty without a lattice.
    pub(crate) outlines: Vec<bool>,
    /// Whether each pixel of the film sees light that is refracted by dielectrics; empty without any.
    pub(crate) refracted: Vec<bool>,
    /// Whether each pixel of the lattice may see a highlight that is narrower than a pixel; empty without
    /// glossy surfaces.
    pub(crate) highlights: Vec<bool>,
    pub(crate) progress: &'a dyn Progress,
    /// Whether points of a pixel are followed by their mirror images: the exposure is the integral of
    /// a smooth function over the pixel alone.
    pub(crate) mirrors_points: AtomicBool,
    /// Allowed error of the light of small lamps, relative to each lamp's.
    pub(crate) cubature_error: CubatureError,
    counter: SampleCounter,
    /// Traced rays that are no samples of a pixel: those of an abandoned lattice, and those that
    /// audited one.
    pub(crate) discarded: AtomicU64,
    /// Whether only the pixels of a lattice are exposed.
    pub(crate) is_on_lattice: AtomicBool,
}

impl<'a> AdaptiveSampler<'a> {
    fn new(
        exposer: &'a Exposer<'a>,
        error: f64,
        shared: SharedFilm<'a>,
        progress: &'a dyn Progress,
    ) -> AdaptiveSampler<'a> {
        AdaptiveSampler {
            exposer,
            replicas: Replicas::new(exposer.rays.camera().pixel_count() as usize, MAX_SAMPLES),
            bands: bands_apart(exposer.rays, exposer.weights),
            images: images(exposer),
            images_apart: ImagesApart::No,
            film: None,
            subpixels: SubpixelRecord::default(),
            shared,
            outlines: Vec::new(),
            refracted: Vec::new(),
            highlights: Vec::new(),
            progress,
            mirrors_points: AtomicBool::new(false),
            cubature_error: CubatureError(CUBATURE_FRACTION * error),
            counter: SampleCounter::new(0, 0),
            discarded: AtomicU64::new(0),
            is_on_lattice: AtomicBool::new(false),
        }
    }

    /// Exposes all pixels: those of a new exposure by interpolation where that pays. The estimate is
    /// `None` if the work was stopped before every pixel had samples.
    fn expose(&mut self, state: &mut AdaptiveState, target: ErrorTarget) -> (Option<Estimate>, Option<Stop>) {
        let unexposed = state.pixels.iter().filter(|pixel| pixel.samples == 0).count();
        self.counter.plan(unexposed as u64 * u64::from(FIRST_SAMPLES));
        if unexposed == state.pixels.len() {
            if let Some((estimate, stop)) = self.interpolated(state, target) {
                return (Some(estimate), stop);
            }
            if self.is_on_lattice.load(Ordering::Relaxed) {
                return (None, Some(Stop::Time));
            }
            self.start_from_known(state);
        }
        let traced = state.samples();
        self.counter.plan(traced);
        self.counter.add(traced);
        begin(&ReplicatedSource::new(self, self.replicas), state);
        if state.pixels.iter().any(|pixel| pixel.samples == 0) {
            return (None, Some(Stop::Time));
        }
        let (estimate, stop) = self.refine(state, target);
        (Some(estimate), stop)
    }

    /// Takes the samples of a known picture where parts do not affect it.
    fn start_from_known(&self, state: &mut AdaptiveState) {
        if let Some(known) = self.shared.known() {
            let pixels = state.pixels.iter_mut().enumerate();
            pixels.for_each(|(index, pixel)| *pixel = known.picture_samples(index, self.replicas).unwrap_or_default());
        }
    }

    /// The exposure of a state, with what is known of its error. `requested` is the relative error.
    fn exposure(
        &self,
        state: AdaptiveState,
        (estimate, stop): (Option<Estimate>, Option<Stop>),
        requested: f64,
    ) -> Exposure {
        let Exposer { rays, weights, .. } = *self.exposer;
        let scale = rays.camera().exposure_per_radiance();
        let pixels = self.replicas.merged(&state.pixels);
        let values = match estimate {
            None => pixels.iter().map(|pixel| scale * pixel.mean()).collect(),
            Some(_) => {
                let mut light = self.means(&pixels);
                light.extend(self.surround(&pixels));
                light.iter_mut().for_each(|mean| *mean *= scale);
                rays.picture(light, weights)
            }
        };
        let estimated_error = estimate.as_ref().map(Estimate::relative_error);
        let is_reached = estimated_error.is_some_and(|reached| reached <= requested);
        Exposure {
            values,
            rays: self.counter.traced() - self.discarded.load(Ordering::Relaxed),
            estimated_error,
            pixels_done: pixels.iter().filter(|pixel| pixel.samples > 0).count() as u64,
            is_partial: self.progress.stops() && !is_reached,
            stopped: stop.filter(|_| !is_reached),
            pixels: estimate.map(|estimate| estimate.statistics(scale)),
            checkpoint: self.checkpoint(state),
        }
    }

    pub(crate) fn report(&self, rays: u32) {
        let [done, planned] = self.counter.add(rays.into());
        self.progress.report(done, planned);
    }

    /// Reports rays that are no samples of a pixel.
    pub(crate) fn report_discarded(&self, rays: u32) {
        self.report(rays);
        self.discarded.fetch_add(rays.into(), Ordering::Relaxed);
    }

    /// Doubles samples where that lowers the error most for its cost, until the requested error is
    /// reached or the work is stopped. Where pixels need a fraction of a doubling, that fraction of
    /// them is doubled, evenly over the picture.
    fn refine(&self, state: &mut AdaptiveState, target: ErrorTarget) -> (Estimate, Option<Stop>) {
        let count = self.replicas.count();
        let columns = self.exposer.rays.camera().columns() as usize * count;
        let squared = self.replicas.squared_target((target.error / SELECTION_BIAS).powi(2));
        let noise = NoiseTarget {
            most_samples: self.replicas.most_samples(target.most_samples),
            most_passes: MAX_PASSES,
            ..NoiseTarget::new(squared, Selection::Fraction)
        };
        let source = ReplicatedSource::new(self, self.replicas);
        let (estimate, stop) = refine(&source, state, &noise, |pixels| Estimate::new(pixels, columns));
        (Estimate { pixels: self.replicas.merged_errors(&estimate.pixels), ..estimate }, stop)
    }

    /// The means of all pixels, by separate band if there are any.
    fn means(&self, pixels: &[Pixel]) -> Vec<f64> {
        if self.bands == 0 {
            return pixels.iter().map(Pixel::mean).collect();
        }
        let of_pixel = |pixel: &Pixel| pixel.sums.bands.map(|sum| sum / f64::from(pixel.samples.max(1)));
        pixels.iter().flat_map(|pixel| of_pixel(pixel).into_iter().take(self.bands)).collect()
    }

    /// The means of the cells around the picture, with the average number of rays of a pixel each.
    fn surround(&self, pixels: &[Pixel]) -> Vec<f64> {
        let taken: u64 = pixels.iter().map(|pixel| u64::from(pixel.samples)).sum();
        let samples = (taken / pixels.len() as u64).next_power_of_two().clamp(1, u64::from(MAX_SAMPLES)) as u32;
        let surround: Vec<Pixel> = (pixels.len()..self.exposer.rays.cells() as usize)
            .into_par_iter()
            .with_min_len(4)
            .map_init(
                || self.worker(),
                |worker, cell| {
                    self.report(samples);
                    Pixel::of(self.sums(worker, cell, 0..samples), samples)
                },
            )
            .collect();
        self.means(&surround)
    }

    /// The checkpoint of a state. A lattice of pixels takes seconds and depends on the seed alone,
    /// so its checkpoint is empty: a resumed exposure starts the same lattice again and ends with
    /// the same bits.
    fn checkpoint(&self, state: AdaptiveState) -> Checkpoint {
        let is_on_lattice = self.is_on_lattice.load(Ordering::Relaxed);
        // The lattice may be that of a film, which has more pixels.
        let pixels = self.exposer.rays.camera().pixel_count() as usize;
        let state = if is_on_lattice { AdaptiveState::new(pixels) } else { state };
        Checkpoint(State::Adaptive { state, bands: self.bands })
    }

    /// What a ray of a film counts.
    pub(crate) fn counted_on_film(&self, ray: &FilmRay) -> CountedLight {
        match &self.images_apart {
            ImagesApart::OnFilm(images) if images.are_shown_by(self.exposer.rays, ray) => CountedLight::WithoutImages,
            // Beside the picture there are no pixels that see images, but the same light is blurred into it.
            ImagesApart::ByPixel => ray.passage.map_or(CountedLight::WithoutImages, |passage| self.counted(&passage)),
            ImagesApart::OnFilm(_) | ImagesApart::No => CountedLight::All,
        }
    }

    /// What a ray of the picture counts.
    pub(crate) fn counted(&self, passage: &PixelPassage) -> CountedLight {
        match &self.images_apart {
            ImagesApart::ByPixel if self.images.are_aimed_at(passage) => CountedLight::WithoutImages,
            _ => CountedLight::All,
        }
    }

    /// The point of the unit cube of a pixel's sample. Where radiance is smooth, each point is
    /// followed by its mirror image about the centre of the pixel, so that linear variations cancel.
    /// Over a finite pinhole radiance varies more, and the plain sequence converges faster.
    fn camera_point(&self, pixel: usize, sample: u32) -> [f64; 4] {
        let is_mirrored = self.mirrors_points.load(Ordering::Relaxed);
        let number = if is_mirrored { sample / 2 } else { sample };
        let u = RaySampler::new(self.exposer.rays.seed(), ray_number(pixel as u64, number)).take(DimensionSet::CAMERA);
        if is_mirrored && sample % 2 == 1 { u.map(|u| (1.0 - u).min(1.0 - f64::EPSILON)) } else { u }
    }
}

/// Rays of a pixel in two phases.
pub(crate) struct Phases {
    /// Of the first phase: where each passes through the pixel, and the ray if it has radiance.
    pub(crate) rays: Vec<([f64; 2], Option<DrawnRay>)>,
    /// The numbers of their strata.
    pub(crate) strata: Vec<Option<usize>>,
    pub(crate) chosen: Vec<Chosen>,
}

/// A ray of a pixel.
pub(crate) struct DrawnRay {
    pub(crate) number: u64,
    pub(crate) ray: CameraRay,
    pub(crate) weight: f64,
    pub(crate) counted: CountedLight,
}

impl<'a> AdaptiveSampler<'a> {
    /// The ray of a pixel for a point of the unit cube; `None` if it has no radiance.
    pub(crate) fn drawn(&self, pixel: usize, number: u64, u: [f64; 4]) -> Option<DrawnRay> {
        let Exposer { renderer, rays, .. } = *self.exposer;
        let (ray, weight, counted) = match &self.film {
            Some(film) => {
                let ray = film.sampled_ray(rays, pixel, u)?;
                (ray.ray, 1.0, self.counted_on_film(&ray))
            }
            None if matches!(self.images_apart, ImagesApart::No) => {
                let (ray, weight) = self.images.ray((renderer.plan(), rays), (pixel, RayPurpose::AllLight), u)?;
                (ray, weight, CountedLight::All)
            }
            None => {
                let passage = PixelPassage::new(pixel, u);
                (self.images.plain_ray(rays, &passage)?, 1.0, self.counted(&passage))
            }
        };
        Some(DrawnRay { number, ray, weight, counted })
    }

    /// Sums over some samples of a pixel, in one phase.
    pub(crate) fn plain_sums(&self, worker: &mut Workers<'a>, pixel: usize, samples: Range<u32>) -> Sums {
        let drawn = |sample| {
            let (number, u) = self.sample_point(pixel, sample);
            self.drawn(pixel, number, u)
        };
        self.summed(worker, pixel, samples.filter_map(drawn))
    }

    /// The ray number and the point of the unit cube of a sample of a pixel.
    pub(crate) fn sample_point(&self, pixel: usize, sample: u32) -> (u64, [f64; 4]) {
        (ray_number(pixel as u64, sample), self.camera_point(pixel, sample))
    }

    /// What a ray sees first: the stratum to which it belongs.
    pub(crate) fn stratum(&self, drawn: &DrawnRay) -> Option<Option<OutlinedSurface>> {
        let ray = Ray::new(drawn.ray.origin, drawn.ray.direction)?;
        Some(self.exposer.renderer.plan().outlined_surface(&ray))
    }

    /// The rays for some samples of a pixel in two phases ([`two_phase`](crate::two_phase)).
    pub(crate) fn phases(&self, pixel: usize, samples: Range<u32>) -> Phases {
        let wanted = samples.end - samples.start;
        let seed = self.exposer.rays.seed();
        let [replica, start] = self.replicas.place(samples.start);
        let stream = FIRST_PHASE_PIXEL + u64::from(replica) * REPLICA_STREAM + pixel as u64;
        let number = |sample| ray_number(stream, sample);
        let first = FIRST_PHASE * start;
        let [offset, ..] = RaySampler::new(seed, number(first)).take(DimensionSet::render(CHOICE_SET));
        let drawn = |sample| {
            let u = RaySampler::new(seed, number(sample)).take(DimensionSet::CAMERA);
            ([u[0], u[1]], self.drawn(pixel, number(sample), u))
        };
        let rays: Vec<_> = (first..first + FIRST_PHASE * wanted).map(drawn).collect();
        let strata: Vec<Option<_>> = rays.iter().map(|(_, ray)| self.stratum(ray.as_ref()?)).collect();
        let strata = numbered(&strata);
        let chosen = choose(&strata, wanted, offset);
        Phases { rays, strata, chosen }
    }

    /// The rays of the second phase for some samples of a pixel.
    fn chosen_rays(&self, pixel: usize, samples: Range<u32>) -> Vec<DrawnRay> {
        let Phases { mut rays, chosen, .. } = self.phases(pixel, samples);
        let taken = chosen.into_iter().filter_map(|chosen| {
            let drawn = rays[chosen.index].1.take()?;
            Some(DrawnRay { weight: chosen.weight * drawn.weight, ..drawn })
        });
        taken.collect()
    }

    /// Sums of weighted radiance·cos⁴ over rays of a pixel.
    pub(crate) fn summed(&self, worker: &mut Workers<'a>, pixel: usize, drawn: impl Iterator<Item = DrawnRay>) -> Sums {
        let Exposer { rays, weights, .. } = *self.exposer;
        let number = pixel as u64;
        if self.bands == 0 {
            let light = drawn.map(|DrawnRay { number: index, ray, weight, counted }| {
                worker.count(counted);
                weight * ray.cos4 * radiance(worker, index, (rays, number), &ray, weights)
            });
            return Sums { whole: light.sum(), ..Sums::default() };
        }
        let mut bands = [0.0; MAX_BANDS];
        for DrawnRay { number: index, ray, weight, counted } in drawn {
            worker.count(counted);
            let light = radiance_apart(worker, index, (rays, number), &ray, weights);
            bands.iter_mut().zip(light).for_each(|(sum, light)| *sum += weight * ray.cos4 * light);
        }
        Sums { whole: weights.combine_apart(number, &bands[..self.bands]), bands }
    }
}

impl<'a> PixelSource for AdaptiveSampler<'a> {
    type Sums = Sums;
    type Worker = Workers<'a>;

    fn worker(&self) -> Workers<'a> {
        self.exposer.workers()
    }

    /// Sums of radiance·cos⁴ over some samples of a pixel. Every pixel has its own scramble of the
    /// sequence.
    fn sums(&self, worker: &mut Workers<'a>, pixel: usize, samples: Range<u32>) -> Sums {
        let [_, start] = self.replicas.place(samples.start);
        worker.integrate_lights((start < MAX_INTEGRATED).then_some(self.cubature_error));
        let is_in_phases = start < MAX_IN_PHASES && self.outlines.get(pixel) == Some(&true);
        if self.film.is_some() {
            let sums = if is_in_phases { Self::two_phase_film_sums } else { Self::film_sums };
            return sums(self, worker, pixel, samples);
        }
        if is_in_phases {
            let rays = self.chosen_rays(pixel, samples);
            return self.summed(worker, pixel, rays.into_iter());
        }
        self.plain_sums(worker, pixel, samples)
    }

    fn stops(&self) -> bool {
        self.progress.stops()
    }

    fn pauses(&self) -> bool {
        self.progress.stops() || self.progress.wants_checkpoint()
    }

    fn save(&self, state: &AdaptiveState) {
        self.progress.save(self.checkpoint(state.clone()));
    }

    fn plan(&self, samples: u64) {
        self.counter.plan(samples);
    }

    fn traced(&self, samples: u32) {
        self.report(samples);
    }
}

/// The mirror images of the first lights that any pixel sees. Rays are aimed at them.
fn images(exposer: &Exposer<'_>) -> PixelImages {
    let found = PixelImages::find(exposer.renderer, exposer.rays);
    let other = || exposer.by_row.iter().map(|light| PixelImages::find(&light.renderer, exposer.rays));
    if found.is_empty() { other().find(|images| !images.is_empty()).unwrap_or(found) } else { found }
}
