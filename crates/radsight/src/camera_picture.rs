//! Pictures of custom cameras and integrators.

use crate::camera::{Camera, CheckedCamera};
use crate::image::{Image, Maps};
use crate::integrator::{Integrator, RayQueries};
use crate::renderer::{check_materials, header, report};
use crate::{Error, Renderer, report_page};
use radsight_adaptive::{
    ErrorTarget, FIRST_SAMPLES, PixelSamples, PixelSource, SampleCounter, Stop, pixel_of_ray, ray_number,
};
use radsight_capture::Progress;
use radsight_film::{Estimate, PixelNoise, SamplingBudget};
use radsight_render::{Ray, RaySpacing, RayWorker};
use radsight_sampling::{DimensionSet, RaySampler};
use rayon::prelude::*;
use std::ops::Range;

/// Default number of rays per pixel.
const USUAL_SAMPLES: u32 = 16;

/// Approximate number of rays requested from a custom camera at once.
const CAMERA_BATCH: usize = 4096;

/// The rays of a picture, and the progress of tracing them.
struct CameraRays<'s> {
    renderer: &'s radsight_render::Renderer,
    integrator: &'s dyn Integrator,
    camera: &'s CheckedCamera<'s>,
    size: [usize; 2],
    progress: &'s dyn Progress,
    /// Of samples to an error, of pixels with a fixed number of samples.
    counter: SampleCounter,
}

/// A finished picture.
struct Finished {
    pixels: Vec<[f32; 3]>,
    maps: Maps,
    estimate: Option<Estimate>,
}

impl Renderer {
    pub(crate) fn render_until(
        &mut self,
        integrator: &dyn Integrator,
        camera: &dyn Camera,
        size: [usize; 2],
        progress: &dyn Progress,
    ) -> Result<Option<Image>, Error> {
        Image::check_size(size[0], size[1])?;
        self.check(camera)?;
        let mut options = self.options.clone();
        let budget = match self.budget.apply(&mut options) {
            SamplingBudget::Interpolated(_) => SamplingBudget::Samples(USUAL_SAMPLES),
            budget => budget,
        };
        if let SamplingBudget::Error(_) = budget {
            // The error would not include that of cached irradiance.
            options.gathering.accuracy = 0.0;
        }
        let (used, sources, asked) = (options.clone(), self.scene.sources.clone(), self.budget.asked_error());
        let camera = CheckedCamera::new(camera);
        if self.gather(&options, || central_rays(&camera, size), RaySpacing::UNKNOWN, progress)?.is_none() {
            return Ok(None);
        }
        let renderer = &*self.prepare(options)?;
        let per_pixel = if let SamplingBudget::Error(_) = budget { FIRST_SAMPLES } else { 1 };
        let counter = SampleCounter::new(0, (size[0] * size[1]) as u64 * u64::from(per_pixel));
        let rays = CameraRays { renderer, integrator, camera: &camera, size, progress, counter };
        let finished = match budget {
            SamplingBudget::Error(target) => rays.to_error(target),
            SamplingBudget::Samples(samples) => rays.with_samples(samples),
            SamplingBudget::Interpolated(_) => unreachable!("it was replaced above"),
        };
        camera.fault().take()?;
        let Some(Finished { pixels, maps, estimate }) = finished else { return Ok(None) };
        check_materials(renderer.plan(), &sources)?;
        let image = Image::new(size[0], pixels, header(""), report(renderer, estimate));
        Ok(Some(image.with_accounts(maps, report_page::record(renderer, &used), asked)))
    }
}

impl CameraRays<'_> {
    fn pixels(&self) -> usize {
        self.size[0] * self.size[1]
    }

    fn report(&self, counted: u64) {
        let [done, planned] = self.counter.add(counted);
        self.progress.report(done, planned);
    }

    /// Traces rays with these numbers; `visit` receives the number and the radiance of each that
    /// sees something.
    fn trace(&self, worker: &mut RayWorker<'_>, numbers: &[u64], mut visit: impl FnMut(u64, [f64; 3])) {
        let seed = self.renderer.plan().seed();
        let at = |&number: &u64| {
            let [x, y, across, along] = RaySampler::new(seed, number).take(DimensionSet::CAMERA);
            (film_point(self.size, pixel_of_ray(number) as usize, [x, y]), [across, along])
        };
        let (film, aperture): (Vec<_>, Vec<_>) = numbers.iter().map(at).unzip();
        for (number, ray) in numbers.iter().zip(self.camera.rays(&film, &aperture)) {
            let Some((ray, weight)) = ray else { continue };
            let value = self.integrator.radiance(&mut RayQueries::new(worker, seed, *number), &ray);
            if !value.iter().all(|band| band.is_finite()) {
                let [red, green, blue] = value;
                let mistake = format!(
                    "it gave ({red}, {green}, {blue}) for the ray from {} along {}, expected finite numbers",
                    ray.origin, ray.direction
                );
                self.camera.fault().set(Error::OwnIntegrator(mistake));
                return;
            }
            visit(*number, value.map(|band| weight * band));
        }
    }

    /// Whether the work ends: it was stopped, or camera or integrator made a mistake.
    fn ends(&self) -> bool {
        self.progress.stops() || self.camera.fault().is_set()
    }

    /// A fixed number of rays per pixel; `None` if it was stopped.
    fn with_samples(&self, samples: u32) -> Option<Finished> {
        let (pixels, at_once) = (self.pixels(), (CAMERA_BATCH / samples as usize).max(1));
        let batch = |worker: &mut RayWorker<'_>, batch: usize| {
            if self.ends() {
                return None;
            }
            let range = batch * at_once..pixels.min((batch + 1) * at_once);
            let of_pixel = |pixel: usize| (0..samples).map(move |sample| ray_number(pixel as u64, sample));
            let numbers: Vec<u64> = range.clone().flat_map(of_pixel).collect();
            let mut sums = vec![[0.0; 3]; range.len()];
            self.trace(worker, &numbers, |number, value| {
                let sum = &mut sums[pixel_of_ray(number) as usize - range.start];
                *sum = std::array::from_fn(|band| sum[band] + value[band]);
            });
            self.report(range.len() as u64);
            Some(sums.into_iter().map(|sum| sum.map(|band| (band / f64::from(samples)) as f32)).collect())
        };
        let batches: Option<Vec<Vec<[f32; 3]>>> =
            (0..pixels.div_ceil(at_once)).into_par_iter().map_init(|| self.renderer.worker(), batch).collect();
        let maps = Maps { relative_errors: None, samples: Some(vec![samples; pixels]) };
        Some(Finished { pixels: batches?.concat(), maps, estimate: None })
    }

    /// As many rays as the error needs; `None` if it was stopped.
    fn to_error(&self, target: ErrorTarget) -> Option<Finished> {
        let (mut noise, mut state) = PixelNoise::begin(self, self.size, target);
        if self.stops() {
            return None;
        }
        let squared = target.error * target.error;
        let left = noise.reduce((self, &mut state), &(0..self.pixels()), squared, target.most_samples);
        if left.stop == Some(Stop::Time) {
            return None;
        }
        let samples = state.pixels.iter().map(|pixel| pixel.samples).collect();
        Some(Finished {
            pixels: state.pixels.iter().map(|pixel| pixel.mean().map(|band| band.max(0.0) as f32)).collect(),
            maps: Maps { relative_errors: Some(left.relative_errors()), samples: Some(samples) },
            estimate: left.estimate(),
        })
    }
}

impl<'s> PixelSource for CameraRays<'s> {
    type Sums = [f64; 3];
    type Worker = RayWorker<'s>;

    fn worker(&self) -> RayWorker<'s> {
        self.renderer.worker()
    }

    fn sums(&self, worker: &mut RayWorker<'s>, pixel: usize, samples: Range<u32>) -> [f64; 3] {
        let numbers: Vec<u64> = samples.map(|sample| ray_number(pixel as u64, sample)).collect();
        let mut sum = [0.0; 3];
        for numbers in numbers.chunks(CAMERA_BATCH) {
            self.trace(worker, numbers, |_, value| sum = std::array::from_fn(|band| sum[band] + value[band]));
        }
        sum
    }

    /// Asks the camera once, since a call may be expensive.
    fn first(&self, worker: &mut RayWorker<'s>, pixel: usize) -> PixelSamples<[f64; 3]> {
        let numbers: [u64; FIRST_SAMPLES as usize] =
            std::array::from_fn(|sample| ray_number(pixel as u64, sample as u32));
        let mut values = [[0.0; 3]; FIRST_SAMPLES as usize];
        self.trace(worker, &numbers, |number, value| values[(number - numbers[0]) as usize] = value);
        let mut first = PixelSamples::of(values[0], 1);
        first.double(&values[1]);
        first.double(&std::array::from_fn(|band| values[2][band] + values[3][band]));
        first
    }

    fn stops(&self) -> bool {
        self.ends()
    }

    fn plan(&self, samples: u64) {
        self.counter.plan(samples);
    }

    fn traced(&self, samples: u32) {
        self.report(samples.into());
    }
}

/// The film point of a point of a pixel.
fn film_point([columns, rows]: [usize; 2], pixel: usize, [x, y]: [f64; 2]) -> [f64; 2] {
    [((pixel % columns) as f64 + x) / columns as f64, ((pixel / columns) as f64 + y) / rows as f64]
}

/// The rays through the centres of pixels and aperture.
fn central_rays(camera: &CheckedCamera<'_>, size: [usize; 2]) -> Vec<Option<Ray>> {
    let pixels = size[0] * size[1];
    let mut first = Vec::with_capacity(pixels);
    for begin in (0..pixels).step_by(CAMERA_BATCH) {
        let batch = begin..pixels.min(begin + CAMERA_BATCH);
        let film: Vec<[f64; 2]> = batch.map(|pixel| film_point(size, pixel, [0.5; 2])).collect();
        let rays = camera.rays(&film, &vec![[0.5; 2]; film.len()]);
        first.extend(rays.into_iter().map(|ray| ray.map(|(ray, _)| ray)));
    }
    first
}
