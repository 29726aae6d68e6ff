//! Renders a scene.

use crate::camera::{self, Camera};
use crate::error::{Error, Report};
use crate::error_budget::ErrorBudget;
use crate::image::{Image, Maps, RenderReport};
use crate::integrator::{Integrator, PathIntegrator, RayQueries};
use crate::irradiance_cache::CacheFilling;
use crate::{Scene, View, report_page};
use radsight_capture::{Progress, Silent};
use radsight_diag::SourceMap;
use radsight_film::{ErrorTarget, Film, SamplingBudget, ViewCamera};
use radsight_picture::Header;
use radsight_render::{Gathering, Ray, RaySpacing, RayWorker, RenderOptions, RenderPlan, Traced, Uncached};
use radsight_sampling::{DimensionSet, RaySampler};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// Default number of rays per pixel of a custom camera.
const USUAL_SAMPLES: u32 = 16;

/// Approximate number of rays requested from a custom camera at once.
const CAMERA_BATCH: usize = 4096;

/// Number of rays between two progress reports.
const RAYS_AT_A_TIME: usize = 1 << 17;

/// Number of consecutive rays that a thread traces, where there are as many for each.
const RAYS_OF_A_THREAD: usize = 1024;

/// Number of bits of a ray's number that identify the sample of a pixel.
const SEQUENCE_LOG2: u32 = 16;

/// Renders a scene.
///
/// ```
/// use radsight::{Ray, Renderer, Scene};
/// # use glam::DVec3;
/// let scene = Scene::from_text("void glow sky 0 0 4 2 2 2 0 sky source dome 0 0 4 0 0 1 360")?;
/// let up = Ray::new(DVec3::ZERO, DVec3::Z).expect("a direction");
/// let mut renderer = Renderer::new(&scene)?;
/// assert_eq!(renderer.trace(&[up])?[0].value, [2.0; 3]);
/// # Ok::<(), radsight::Error>(())
/// ```
#[derive(Debug)]
pub struct Renderer {
    pub(crate) scene: Scene,
    pub(crate) options: RenderOptions,
    budget: ErrorBudget,
    jitter: Option<f64>,
    /// The compiled renderer, and the options with which it was made.
    pub(crate) ready: Option<(RenderOptions, radsight_render::Renderer)>,
    /// A loaded irradiance cache, applied to each new renderer.
    pub(crate) loaded: Option<Vec<u8>>,
    pub(crate) filling: CacheFilling,
}

/// The contribution of one of the requested modifiers to a ray.
///
/// ```
/// use glam::DVec3;
/// use radsight::{Ray, Renderer, Scene};
/// let scene = Scene::from_text("void glow white 0 0 4 1 2 3 0 white sphere ball 0 0 4 0 9 0 2")?;
/// let ahead = Ray::new(DVec3::ZERO, DVec3::Y).unwrap();
/// let found = Renderer::new(&scene)?.contributions(&[ahead], &["white"])?;
/// assert_eq!((found[0][0].modifier, found[0][0].value), (0, [1.0, 2.0, 3.0]));
/// # Ok::<(), radsight::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModifierContribution {
    /// Index of the modifier in the request.
    pub modifier: usize,
    /// Red, green and blue, W/(sr·m²), or W/m² if irradiance is requested.
    pub value: [f64; 3],
}

impl Renderer {
    /// A renderer with Radiance's defaults for pictures.
    ///
    /// # Errors
    /// [`Error::Scene`] for a material or light that cannot be rendered.
    pub fn new(scene: &Scene) -> Result<Renderer, Error> {
        Renderer::with_options(scene, Renderer::picture_options())
    }

    /// Radiance's defaults for pictures (`rpict -defaults`).
    #[must_use]
    pub fn picture_options() -> RenderOptions {
        let gathering = Gathering {
            accuracy: 0.2,
            resolution: 64,
            divisions: 512,
            super_samples: 128,
            uncached: Uncached::TraceOne,
            ..Gathering::default()
        };
        RenderOptions { mirror_sources: 1, gathering, highlight_threshold: 0.15, ..RenderOptions::default() }
    }

    /// A renderer with given options.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn with_options(scene: &Scene, options: RenderOptions) -> Result<Renderer, Error> {
        let budget = ErrorBudget::default();
        let mut renderer = Renderer {
            scene: scene.clone(),
            options,
            budget,
            jitter: None,
            ready: None,
            loaded: None,
            filling: CacheFilling::Gather,
        };
        let options = renderer.options.clone();
        renderer.prepare(options)?;
        Ok(renderer)
    }

    /// Number of diffuse interreflections (`-ab`). Default 0.
    #[must_use]
    pub fn ambient_bounces(mut self, bounces: u32) -> Renderer {
        self.options.ambient_bounces = bounces;
        self
    }

    /// Relative interpolation error of the irradiance cache (`-aa`); 0 disables it. Default 0.2.
    #[must_use]
    pub fn ambient_accuracy(mut self, accuracy: f64) -> Renderer {
        self.options.gathering.accuracy = accuracy;
        self
    }

    /// Number of hemisphere samples per cache point, and of additional ones (`-ad`, `-as`). Default
    /// 512 and 128.
    #[must_use]
    pub fn ambient_divisions(mut self, divisions: u32, super_samples: u32) -> Renderer {
        self.options.gathering.divisions = divisions;
        self.options.gathering.super_samples = super_samples;
        self
    }

    /// Refines until a picture's estimated relative error reaches this value, such as 0.02.
    #[must_use]
    pub fn error(self, error: f64) -> Renderer {
        self.budget(ErrorBudget::error(error))
    }

    /// Traces this many rays per pixel.
    #[must_use]
    pub fn samples(self, samples: u32) -> Renderer {
        self.budget(ErrorBudget::samples(samples))
    }

    /// The quality of pictures. Default: a preview, as with Radiance's defaults.
    #[must_use]
    pub fn budget(mut self, budget: ErrorBudget) -> Renderer {
        self.budget = budget;
        self
    }

    /// Side of the square in a pixel over which its rays are jittered, pixels (`-pj`). Default: the
    /// whole pixel, or 0.67 in a preview.
    #[must_use]
    pub fn pixel_jitter(mut self, side: f64) -> Renderer {
        self.jitter = Some(side);
        self
    }

    /// The seed of the sample sequence. Default 0.
    #[must_use]
    pub fn seed(mut self, seed: u64) -> Renderer {
        self.options.seed = seed;
        self
    }

    /// All options, mutable.
    pub fn options_mut(&mut self) -> &mut RenderOptions {
        &mut self.options
    }

    /// Renders a view within a size; the picture keeps the view's aspect ratio.
    ///
    /// # Errors
    /// [`Error::Size`], [`Error::Option`], and [`Error::Material`] if a ray met an unusable
    /// material.
    pub fn render(&mut self, view: &View, columns: usize, rows: usize) -> Result<Image, Error> {
        let image = self.render_with_progress(view, columns, rows, &Silent)?;
        Ok(image.expect("nobody stopped it"))
    }

    /// The same with progress reports. `progress` receives the number of finished rows and can stop
    /// the work, also while an irradiance cache is filled; the result is then `None`.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn render_with_progress(
        &mut self,
        view: &View,
        columns: usize,
        rows: usize,
        progress: &dyn Progress,
    ) -> Result<Option<Image>, Error> {
        let (columns, rows) = view.0.fit(columns, rows, 1.0);
        Image::check_size(columns, rows)?;
        let mut camera = ViewCamera::new(view.0, columns, rows);
        camera.jitter = self.jitter.unwrap_or(self.budget.pixel_jitter());
        let mut options = self.options.clone();
        let pixels = self.budget.apply(&mut options);
        check_budget(pixels)?;
        let (asked, used) = (self.budget.asked_error(), options.clone());
        let side = self.budget.prepass_spacing();
        let sources = self.scene.sources.clone();
        if let SamplingBudget::Error(_) = pixels {
            self.prepare(options.clone())?.guide_paths(&camera.prepass_rays(side), camera.spread(side));
        }
        if self.gather(&options, || camera.prepass_rays(side), camera.spread(side), progress)?.is_none() {
            return Ok(None);
        }
        let renderer = &*self.prepare(options)?;
        let mut film = Film::new(renderer, camera, pixels);
        let mut image = Vec::with_capacity(columns * rows);
        let mut row = 0;
        while row < rows {
            let block = film.block_of(row);
            // With a fixed number of samples, pixels are independent, so progress can be reported
            // within a block.
            let block = match pixels {
                SamplingBudget::Samples(samples) => {
                    let at_a_time = (RAYS_AT_A_TIME / (columns * samples as usize)).max(1);
                    row..block.end.min(row + at_a_time)
                }
                _ => block,
            };
            image.extend(film.finish_block(block.clone()));
            row = block.end;
            progress.report(row as u64, rows as u64);
            if progress.stops() {
                return Ok(None);
            }
        }
        check_materials(renderer.plan(), &sources)?;
        let report = report(renderer, film.estimate());
        let maps = Maps { relative_errors: film.relative_errors(), samples: film.samples() };
        let image = Image::new(columns, image, header(&view.to_args()), report);
        Ok(Some(image.with_accounts(maps, report_page::record(renderer, &used), asked)))
    }

    /// Renders a custom camera with the number of rays per pixel from [`Renderer::samples`]
    /// (default 16).
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn render_camera(&mut self, camera: &dyn Camera, columns: usize, rows: usize) -> Result<Image, Error> {
        self.render_with(&PathIntegrator, camera, columns, rows)
    }

    /// The same with progress reports. `progress` receives the number of finished pixels and can
    /// stop the work; the result is then `None`.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn render_camera_with_progress(
        &mut self,
        camera: &dyn Camera,
        columns: usize,
        rows: usize,
        progress: &dyn Progress,
    ) -> Result<Option<Image>, Error> {
        self.render_until(&PathIntegrator, camera, [columns, rows], progress)
    }

    /// The same with a custom integrator.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn render_with(
        &mut self,
        integrator: &dyn Integrator,
        camera: &dyn Camera,
        columns: usize,
        rows: usize,
    ) -> Result<Image, Error> {
        let image = self.render_until(integrator, camera, [columns, rows], &Silent)?;
        Ok(image.expect("nobody stopped it"))
    }

    fn render_until(
        &mut self,
        integrator: &dyn Integrator,
        camera: &dyn Camera,
        [columns, rows]: [usize; 2],
        progress: &dyn Progress,
    ) -> Result<Option<Image>, Error> {
        Image::check_size(columns, rows)?;
        let mut options = self.options.clone();
        let samples = match self.budget.apply(&mut options) {
            SamplingBudget::Samples(samples) => samples,
            _ => USUAL_SAMPLES,
        };
        check_budget(SamplingBudget::Samples(samples))?;
        let used = options.clone();
        let (seed, sources) = (options.seed, self.scene.sources.clone());
        let place = |pixel: usize, [x, y]: [f64; 2]| {
            [((pixel % columns) as f64 + x) / columns as f64, ((pixel / columns) as f64 + y) / rows as f64]
        };
        let pixels = columns * rows;
        let mut first = Vec::with_capacity(pixels);
        for begin in (0..pixels).step_by(CAMERA_BATCH) {
            let film: Vec<[f64; 2]> =
                (begin..pixels.min(begin + CAMERA_BATCH)).map(|pixel| place(pixel, [0.5; 2])).collect();
            let rays = camera.rays(&film, &vec![[0.5; 2]; film.len()]);
            first.extend(rays.into_iter().map(|ray| ray.and_then(camera::checked).map(|(ray, _)| ray)));
        }
        if self.gather(&options, || first, RaySpacing::UNKNOWN, progress)?.is_none() {
            return Ok(None);
        }
        let renderer = &*self.prepare(options)?;
        let (at_once, done) = ((CAMERA_BATCH / samples as usize).max(1), AtomicU64::new(0));
        let batches: Option<Vec<Vec<[f32; 3]>>> = (0..pixels.div_ceil(at_once))
            .into_par_iter()
            .map_init(
                || renderer.worker(),
                |worker, batch| {
                    if progress.stops() {
                        return None;
                    }
                    let range = batch * at_once..pixels.min((batch + 1) * at_once);
                    let numbers = range.clone().flat_map(|pixel| {
                        (0..samples).map(move |sample| (pixel as u64) << SEQUENCE_LOG2 | u64::from(sample))
                    });
                    let numbers: Vec<u64> = numbers.collect();
                    let points = numbers.iter().map(|index| RaySampler::new(seed, *index).take(DimensionSet::CAMERA));
                    let at = |index: &u64, [x, y, across, along]: [f64; 4]| {
                        (place((index >> SEQUENCE_LOG2) as usize, [x, y]), [across, along])
                    };
                    let (film, aperture): (Vec<_>, Vec<_>) =
                        numbers.iter().zip(points).map(|(index, point)| at(index, point)).unzip();
                    let mut sums = vec![[0.0; 3]; range.len()];
                    for (index, ray) in numbers.iter().zip(camera.rays(&film, &aperture)) {
                        let Some((ray, weight)) = ray.and_then(camera::checked) else { continue };
                        let value = integrator.radiance(&mut RayQueries::new(worker, seed, *index), &ray);
                        let sum = &mut sums[(index >> SEQUENCE_LOG2) as usize - range.start];
                        *sum = std::array::from_fn(|band| sum[band] + weight * value[band]);
                    }
                    let before = done.fetch_add(range.len() as u64, Ordering::Relaxed);
                    progress.report(before + range.len() as u64, pixels as u64);
                    let mean = |sum: [f64; 3]| sum.map(|band| (band / f64::from(samples)) as f32);
                    Some(sums.into_iter().map(mean).collect())
                },
            )
            .collect();
        let Some(batches) = batches else { return Ok(None) };
        let pixels = batches.concat();
        check_materials(renderer.plan(), &sources)?;
        let maps = Maps { relative_errors: None, samples: Some(vec![samples; columns * rows]) };
        let image = Image::new(columns, pixels, header(""), report(renderer, None));
        Ok(Some(image.with_accounts(maps, report_page::record(renderer, &used), None)))
    }

    /// Traces rays: radiance (or irradiance, as the options request), first hit and effective
    /// distance of each. The index in the list identifies a ray.
    ///
    /// # Errors
    /// [`Error::Material`] if a ray met an unusable material.
    pub fn trace(&mut self, rays: &[Ray]) -> Result<Vec<Traced>, Error> {
        Ok(self.trace_part(0, rays, |traced| traced, &Silent)?.expect("nobody stopped it"))
    }

    /// Traces a part of a longer list that starts at index `first`. Without cached irradiance, or
    /// with only that of [`Renderer::only_irradiance_cache`], the results equal those of the whole
    /// list. `of` converts each result on the thread that traced it, so that only what it returns
    /// is kept. `progress` receives the finished share and can stop the work; the result is then
    /// `None`.
    ///
    /// # Errors
    /// As [`Renderer::trace`].
    pub fn trace_part<T: Send>(
        &mut self,
        first: u64,
        rays: &[Ray],
        of: impl Fn(Traced) -> T + Sync,
        progress: &dyn Progress,
    ) -> Result<Option<Vec<T>>, Error> {
        let mut options = self.options.clone();
        options.gathering.uncached = Uncached::Split;
        let all = || rays.iter().copied().map(Some).collect();
        if self.gather(&options, all, RaySpacing::UNKNOWN, progress)?.is_none() {
            return Ok(None);
        }
        let renderer = &*self.prepare(options)?;
        let mut told = Vec::with_capacity(rays.len());
        for some in rays.chunks(RAYS_AT_A_TIME) {
            if progress.stops() {
                return Ok(None);
            }
            let number = first + told.len() as u64;
            let answer =
                |worker: &mut RayWorker<'_>, (place, ray): (usize, &Ray)| of(worker.trace(number + place as u64, ray));
            let of_a_thread = RAYS_OF_A_THREAD.min(some.len().div_ceil(rayon::current_num_threads()));
            let answers = some.par_iter().enumerate().with_min_len(of_a_thread);
            told.par_extend(answers.map_init(|| renderer.worker(), answer));
            progress.report(told.len() as u64, rays.len() as u64);
        }
        self.check_met()?;
        Ok(Some(told))
    }

    /// The contributions of modifiers with these names to each ray: the radiance of their emitters
    /// times its coefficient, as in `rcontrib`.
    ///
    /// # Errors
    /// As [`Renderer::trace`].
    pub fn contributions(&mut self, rays: &[Ray], modifiers: &[&str]) -> Result<Vec<Vec<ModifierContribution>>, Error> {
        Ok(self.contributions_part(0, rays, modifiers, &Silent)?.expect("nobody stopped it"))
    }

    /// The same for a part of a longer list, as in [`Renderer::trace_part`].
    ///
    /// # Errors
    /// As [`Renderer::trace`].
    pub fn contributions_part(
        &mut self,
        first: u64,
        rays: &[Ray],
        modifiers: &[&str],
        progress: &dyn Progress,
    ) -> Result<Option<Vec<Vec<ModifierContribution>>>, Error> {
        let mut options = self.options.clone();
        options.tracked_modifiers = modifiers.iter().map(|name| (*name).to_owned()).collect();
        options.tracked_value = radsight_render::TrackedValue::Radiance;
        options.gathering.accuracy = 0.0;
        options.gathering.uncached = Uncached::Split;
        let renderer = &*self.prepare(options)?;
        let mut owed = Vec::with_capacity(rays.len());
        for some in rays.chunks(RAYS_AT_A_TIME) {
            if progress.stops() {
                return Ok(None);
            }
            let before = owed.len() as u64;
            let of_rays = some.par_iter().enumerate().map_init(
                || renderer.worker(),
                |worker, (index, ray)| contributions_of(worker, first + before + index as u64, ray, modifiers.len()),
            );
            owed.extend(of_rays.collect::<Vec<_>>());
            progress.report(owed.len() as u64, rays.len() as u64);
        }
        self.check_met()?;
        Ok(Some(owed))
    }

    /// The compiled renderer for these options.
    pub(crate) fn ready_for(&mut self, options: RenderOptions) -> Result<&mut radsight_render::Renderer, Error> {
        self.prepare(options)
    }

    /// Reports an unusable material that a ray met.
    pub(crate) fn check_met(&self) -> Result<(), Error> {
        self.ready.as_ref().map_or(Ok(()), |(_, renderer)| check_materials(renderer.plan(), &self.scene.sources))
    }

    /// The compiled renderer for these options, rebuilt if they changed.
    pub(crate) fn prepare(&mut self, options: RenderOptions) -> Result<&mut radsight_render::Renderer, Error> {
        if self.ready.as_ref().is_none_or(|(made, _)| *made != options) {
            self.ready = None;
            let plan = RenderPlan::new(self.scene.scene.clone(), options.clone(), &self.scene.materials)
                .map_err(|errors| Error::Scene(Report::new(errors, self.scene.sources.clone())))?;
            let mut renderer = radsight_render::Renderer::new(plan);
            if let Some(cache) = self.loaded.as_ref().filter(|_| renderer.caches_irradiance()) {
                renderer.load_irradiance_cache(cache, self.scene.scene.fingerprint())?;
            }
            self.ready = Some((options, renderer));
        }
        Ok(&mut self.ready.as_mut().expect("it was created above").1)
    }
}

fn contributions_of(worker: &mut RayWorker<'_>, index: u64, ray: &Ray, modifiers: usize) -> Vec<ModifierContribution> {
    let mut sums = vec![[0.0; 3]; modifiers];
    worker.contributions(index, ray, |contribution| {
        let bands = contribution.value.as_slice();
        let sum = &mut sums[contribution.modifier];
        *sum = std::array::from_fn(|band| sum[band] + f64::from(bands[band.min(bands.len() - 1)]));
    });
    let told = sums.into_iter().enumerate();
    told.map(|(modifier, value)| ModifierContribution { modifier, value }).collect()
}

/// The error estimate of a picture, and the skipped work.
fn report(renderer: &radsight_render::Renderer, estimate: Option<radsight_film::Estimate>) -> RenderReport {
    let skipped = renderer.plan().decisions().iter().filter(|decision| decision.skip.is_some());
    let skipped = skipped.map(|decision| format!("{}: {}", decision.what, decision.why)).collect();
    RenderReport::new(estimate, renderer.irradiance_noise(), skipped)
}

fn header(view: &str) -> Header {
    let mut header = Header::new("RADIANCE");
    header.push_variable("SOFTWARE", concat!(" radsight ", env!("CARGO_PKG_VERSION")));
    if !view.is_empty() {
        header.push_variable("VIEW", view);
    }
    header
}

fn check_budget(budget: SamplingBudget) -> Result<(), Error> {
    let wrong = |option, value: String, expected| Err(Error::Option { option, value, expected });
    match budget {
        SamplingBudget::Error(ErrorTarget { error, .. }) if !(error > 0.0 && error.is_finite()) => {
            wrong("error", error.to_string(), "a relative error above 0, such as 0.02")
        }
        SamplingBudget::Samples(samples) if !(1..=radsight_film::MAX_SAMPLES).contains(&samples) => {
            wrong("samples", samples.to_string(), "1 to 65536")
        }
        _ => Ok(()),
    }
}

pub(crate) fn check_materials(plan: &RenderPlan, sources: &SourceMap) -> Result<(), Error> {
    match plan.fatal_fault() {
        Some(error) => Err(Error::Material(Report::new(vec![error], sources.clone()))),
        None => Ok(()),
    }
}
