//! Adaptive sampling of pictures.
//!
//! The samples of a pixel are doubled where that lowers the error of the picture most
//! ([`refine`]), until the estimated error is the requested one (`noise.rs`).
//!
//! Where irradiance is cached, its error counts as well. It is estimated and corrected by
//! independent paths (`residual.rs`).

use crate::drawn_lights::DrawnLights;
use crate::glint_lights::GlintLights;
use crate::interpolated::{self, Interpolation};
use crate::light_strata::LightStrata;
use crate::noise::{Estimate, Finished, Pixel, PixelNoise, RemainingNoise};
use crate::part::PixelRays;
use crate::residual::{Assessment, Residuals};
use crate::view_camera::{CameraRay, ViewCamera, traced};
use radsight_adaptive::{ErrorTarget, MAX_SAMPLES, PixelError, PixelSource, SamplingState, Stop, ray_number};
use radsight_render::{RayWorker, Renderer};
use rayon::prelude::*;
use std::ops::Range;

/// Number of pixels that are finished together; rounded to whole rows.
const BLOCK: usize = 1 << 14;

/// Number of rows that are finished together with interpolation: a multiple of this, which is a
/// multiple of every cell size, with about so many pixels. Cells between two blocks are sampled for
/// both, so small pictures are a single block.
const INTERPOLATED_ROWS: usize = 64;
const INTERPOLATED_BLOCK: usize = 1 << 17;

/// Fraction of the squared error allotted to the pixels' own noise where irradiance is cached.
const NOISE_FRACTION: f64 = 0.3;

/// Distance of a ray that hits nothing, as in Radiance.
const NO_HIT_DISTANCE: f64 = 1e10;

/// The number of rays of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SamplingBudget {
    /// A fixed number.
    Samples(u32),
    /// As few as the error allows.
    Error(ErrorTarget),
    /// As in Radiance: smooth regions are interpolated.
    Interpolated(Interpolation),
}

/// Whether there is time left for a block, given the fraction of the picture that is finished after
/// it.
pub type TimeLeft<'t> = dyn Fn(f64) -> bool + Sync + 't;

/// A picture that is being rendered.
pub struct Film<'r> {
    renderer: &'r Renderer,
    camera: ViewCamera,
    budget: SamplingBudget,
    strata: LightStrata,
    drawn_lights: DrawnLights,
    glint_lights: GlintLights,
    state: SamplingState<[f64; 3]>,
    noise: PixelNoise,
    finished: Finished,
    /// Squared relative errors of the finished pixels, if an error was requested.
    errors: Vec<f32>,
    /// Rays besides those of the pixels' own samples.
    extra_rays: Vec<u32>,
    time_left: Option<Box<TimeLeft<'r>>>,
}

impl std::fmt::Debug for Film<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Film { camera, budget, finished, .. } = self;
        formatter
            .debug_struct("Film")
            .field("camera", camera)
            .field("budget", budget)
            .field("finished", finished)
            .finish_non_exhaustive()
    }
}

impl<'r> Film<'r> {
    /// Begins a picture. With a requested error this traces the first rays of all pixels, for the
    /// typical value.
    #[must_use]
    pub fn new(renderer: &'r Renderer, camera: ViewCamera, budget: SamplingBudget) -> Film<'r> {
        let pixels = camera.columns() * camera.rows();
        let finished = Finished::default();
        let part = (0..camera.columns(), 0..camera.rows());
        let plan = renderer.plan();
        let (mut strata, mut drawn_lights) = (LightStrata::default(), DrawnLights::default());
        let mut glint_lights = GlintLights::default();
        match budget {
            SamplingBudget::Samples(samples) => strata = LightStrata::for_samples(samples, plan, &camera, part),
            SamplingBudget::Error(_) => strata = LightStrata::find(plan, &camera, part),
            SamplingBudget::Interpolated(interpolation) => {
                drawn_lights = DrawnLights::find(renderer, &camera, interpolation.widest_drawn_light(&camera));
                glint_lights = GlintLights::find(plan, &camera);
            }
        }
        let mut frame = Film {
            renderer,
            camera,
            budget,
            strata,
            drawn_lights,
            glint_lights,
            state: SamplingState::new(if let SamplingBudget::Samples(_) = budget { pixels } else { 0 }),
            noise: PixelNoise::new(&[], camera.columns()),
            finished,
            errors: Vec::new(),
            extra_rays: Vec::new(),
            time_left: None,
        };
        if let SamplingBudget::Error(target) = budget {
            frame.errors = vec![f32::NAN; pixels];
            frame.extra_rays = vec![0; pixels];
            let source = FilmRays { pixels: frame.pixel_rays(), has_time: &|| true };
            (frame.noise, frame.state) = PixelNoise::begin(&source, [camera.columns(), camera.rows()], target);
        }
        frame
    }

    /// Stops adaptive sampling when there is no time left.
    #[must_use]
    pub fn while_time_is_left(mut self, time_left: Box<TimeLeft<'r>>) -> Film<'r> {
        self.time_left = Some(time_left);
        self
    }

    /// Columns.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.camera.columns()
    }

    /// The rows that are finished together with a row. Requesting all of them costs no more than
    /// requesting one.
    #[must_use]
    pub fn block_of(&self, row: usize) -> Range<usize> {
        let height = match self.budget {
            SamplingBudget::Interpolated(_) => {
                let pixels = (INTERPOLATED_ROWS * self.camera.columns()).max(1);
                INTERPOLATED_ROWS * (INTERPOLATED_BLOCK / pixels).max(1)
            }
            _ => (BLOCK / self.camera.columns().max(1)).max(1),
        };
        let first = row - row % height;
        first..(first + height).min(self.camera.rows())
    }

    /// Finishes a block of rows and returns its pixels.
    pub fn finish_block(&mut self, block: Range<usize>) -> Vec<[f32; 3]> {
        let columns = self.camera.columns();
        let range = block.start * columns..block.end * columns;
        match self.budget {
            SamplingBudget::Interpolated(interpolation) => {
                let lights = (&self.drawn_lights, &self.glint_lights);
                return interpolated::block(self.renderer, &self.camera, lights, interpolation, &block);
            }
            SamplingBudget::Samples(samples) => self.trace_all(range.clone(), samples.clamp(1, MAX_SAMPLES)),
            SamplingBudget::Error(target) => return self.finish_to_error(&range, target),
        }
        self.state.pixels[range].iter().map(|pixel| pixel.mean().map(|band| band.max(0.0) as f32)).collect()
    }

    /// Finishes pixels to a requested error.
    fn finish_to_error(&mut self, range: &Range<usize>, target: ErrorTarget) -> Vec<[f32; 3]> {
        let ErrorTarget { error, most_samples } = target;
        let most = most_samples.min(MAX_SAMPLES);
        let is_cached = self.renderer.irradiance_noise().is_some();
        let share = if is_cached { NOISE_FRACTION } else { 1.0 };
        let remaining = self.reduce_noise(range, share * error * error, most);
        let assessment =
            is_cached.then(|| self.correct((range, &remaining.pixels), error * error * range.len() as f64, most));
        let (mut corrections, mut of_pixels) = (vec![[0.0; 3]; range.len()], vec![0.0; range.len()]);
        let mut scales = vec![1.0; range.len()];
        if let Some(assessment) = assessment {
            self.finished.add_cached([assessment.squared, assessment.variance]);
            (corrections, of_pixels, scales) = (assessment.corrections, assessment.of_pixels, assessment.scales);
        }
        let noise = range.clone().zip(remaining.by_pixel());
        for ((index, (pixel, parts)), (of_cache, scale)) in noise.zip(of_pixels.iter().zip(scales)) {
            self.finished.add(parts, scale, pixel.samples + self.extra_rays[index]);
            self.errors[index] = (scale * pixel.squared + of_cache) as f32;
        }
        let corrected = |(pixel, correction): (&Pixel, [f64; 3])| {
            let mean = pixel.mean();
            std::array::from_fn(|band| (mean[band] + correction[band]).max(0.0) as f32)
        };
        self.state.pixels[range.clone()].iter().zip(corrections).map(corrected).collect()
    }

    /// Doubles samples until the pixels' own squared noise plus one standard error is `squared`;
    /// returns what is left.
    fn reduce_noise(&mut self, range: &Range<usize>, squared: f64, most: u32) -> RemainingNoise {
        let (mut state, mut noise) = (std::mem::take(&mut self.state), self.noise);
        let this = &*self;
        let has_time = || this.is_in_time(range);
        let rays = FilmRays { pixels: this.pixel_rays(), has_time: &has_time };
        let left = noise.reduce((&rays, &mut state), range, squared, most);
        (self.state, self.noise) = (state, noise);
        self.finished.add_stop(left.stop);
        left
    }

    /// Corrects cached irradiance until the estimated sum of its squared errors, with the pixels'
    /// own noise, is at most `squared`.
    fn correct(&mut self, (range, noise): (&Range<usize>, &[PixelError]), squared: f64, most: u32) -> Assessment {
        let units = self.state.pixels[range.clone()].iter().map(|pixel| self.noise.units(pixel)).collect();
        let mut residuals = Residuals::new(range.clone(), self.camera.columns(), units, self.noise.floors());
        let mut wanted = residuals.first_pixels();
        loop {
            residuals.trace(self.renderer, &self.camera, &wanted);
            let assessment = residuals.assess(most);
            let noise = noise.iter().zip(&assessment.scales).map(|(pixel, scale)| scale * pixel.squared).sum::<f64>();
            let allowed = squared - noise;
            let is_enough = assessment.upper() <= allowed;
            wanted = if is_enough { Vec::new() } else { assessment.wanted(allowed) };
            if !is_enough && wanted.is_empty() {
                self.finished.add_stop(Some(Stop::Rays));
            }
            if wanted.is_empty() || !self.has_time(range) {
                for index in range.clone() {
                    self.extra_rays[index] = residuals.rays_of(index - range.start);
                }
                return assessment;
            }
        }
    }

    /// Whether there is time left for a block.
    fn is_in_time(&self, range: &Range<usize>) -> bool {
        let share = range.end as f64 / (self.camera.columns() * self.camera.rows()) as f64;
        self.time_left.as_ref().is_none_or(|time_left| time_left(share))
    }

    /// The same; records it if there is none.
    fn has_time(&mut self, range: &Range<usize>) -> bool {
        let is_in_time = self.is_in_time(range);
        if !is_in_time {
            self.finished.add_stop(Some(Stop::Time));
        }
        is_in_time
    }

    /// The quality of the finished pixels; `None` if no error was requested.
    #[must_use]
    pub fn estimate(&self) -> Option<Estimate> {
        self.finished.estimate()
    }

    /// The standard errors of all pixels relative to their values: the rms over the bands, as in
    /// [`SamplingBudget::Error`]. NaN for unfinished pixels; `None` if no error was requested.
    #[must_use]
    pub fn relative_errors(&self) -> Option<Vec<f32>> {
        (!self.errors.is_empty()).then(|| self.errors.iter().map(|squared| squared.sqrt()).collect())
    }

    /// Number of rays of each pixel; `None` with interpolation.
    #[must_use]
    pub fn samples(&self) -> Option<Vec<u32>> {
        let is_interpolated = matches!(self.budget, SamplingBudget::Interpolated(_));
        let further = |index: usize| self.extra_rays.get(index).copied().unwrap_or(0);
        (!is_interpolated).then(|| {
            self.state.pixels.iter().enumerate().map(|(index, pixel)| pixel.samples + further(index)).collect()
        })
    }

    /// Distances along the rays through the centres of the pixels of some rows, through mirrors and
    /// panes, scene units; 1e10 for nothing.
    #[must_use]
    pub fn depths(&self, rows: Range<usize>) -> Vec<f32> {
        let columns = self.camera.columns();
        let pixels = rows.start * columns..rows.end * columns;
        pixels
            .into_par_iter()
            .with_min_len(64)
            .map_init(
                || self.renderer.worker(),
                |worker, pixel| {
                    let ray = self.camera.central_ray(pixel % columns, pixel / columns);
                    ray.map_or(NO_HIT_DISTANCE, |ray| distance(worker, ray_number(pixel as u64, 0), &ray)) as f32
                },
            )
            .collect()
    }

    fn pixel_rays(&self) -> PixelRays<'_, 'r> {
        PixelRays { renderer: self.renderer, camera: &self.camera, strata: &self.strata }
    }

    fn trace_all(&mut self, range: Range<usize>, samples: u32) {
        let Film { renderer, camera, strata, state, .. } = self;
        let pixels = PixelRays { renderer, camera, strata };
        let (rays, first) = (FilmRays { pixels, has_time: &|| true }, range.start);
        state.pixels[range].par_iter_mut().enumerate().with_min_len(16).for_each_init(
            || rays.worker(),
            |worker, (index, pixel)| *pixel = Pixel::of(rays.sums(worker, first + index, 0..samples), samples),
        );
    }
}

/// The rays of a film's pixels, for the adaptive sampler.
struct FilmRays<'f, 'r> {
    pixels: PixelRays<'f, 'r>,
    /// Whether there is time left.
    has_time: &'f (dyn Fn() -> bool + Sync),
}

impl<'r> PixelSource for FilmRays<'_, 'r> {
    type Sums = [f64; 3];
    type Worker = RayWorker<'r>;

    fn worker(&self) -> RayWorker<'r> {
        self.pixels.renderer.worker()
    }

    /// Sum of the radiances of some rays of a pixel.
    fn sums(&self, worker: &mut RayWorker<'r>, pixel: usize, samples: Range<u32>) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for sample in samples {
            let value = self.pixels.radiance(worker, pixel, sample);
            sum = std::array::from_fn(|band| sum[band] + value[band]);
        }
        sum
    }

    fn stops(&self) -> bool {
        !(self.has_time)()
    }

    /// Passes are finished, so that threads do not change the picture.
    fn pauses(&self) -> bool {
        false
    }
}

fn distance(worker: &mut RayWorker<'_>, index: u64, ray: &CameraRay) -> f64 {
    traced(worker, index, ray).map_or(NO_HIT_DISTANCE, |traced| traced.effective_distance.min(NO_HIT_DISTANCE))
}
