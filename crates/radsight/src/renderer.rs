//! Renders a scene.

use crate::camera::Camera;
use crate::error::{Error, Report};
use crate::error_budget::ErrorBudget;
use crate::image::{Image, Maps, RenderReport};
use crate::integrator::{Integrator, PathIntegrator};
use crate::irradiance_cache::CacheFilling;
use crate::option_check::{check_budget, check_options, check_pixel_jitter};
use crate::{Scene, View, report_page};
use radsight_capture::{Progress, Silent};
use radsight_diag::SourceMap;
use radsight_film::{Film, SamplingBudget, ViewCamera};
use radsight_picture::Header;
use radsight_render::{Gathering, Ray, RaySpacing, RayWorker, RenderOptions, RenderPlan, Traced, Uncached};
use rayon::prelude::*;

/// Number of rays between two progress reports.
pub(crate) const RAYS_AT_A_TIME: usize = 1 << 17;

/// Number of consecutive rays that a thread traces, where there are as many for each.
const RAYS_OF_A_THREAD: usize = 1024;

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
    pub(crate) budget: ErrorBudget,
    jitter: Option<f64>,
    /// The compiled renderer, and the options with which it was made.
    pub(crate) ready: Option<(RenderOptions, radsight_render::Renderer)>,
    /// A loaded irradiance cache, applied to each new renderer.
    pub(crate) loaded: Option<Vec<u8>>,
    pub(crate) filling: CacheFilling,
}

impl Renderer {
    /// A renderer with Radiance's defaults for pictures.
    ///
    /// ```
    /// # use radsight::example::scene;
    /// assert!(radsight::Renderer::new(&scene()).is_ok());
    /// ```
    ///
    /// # Errors
    /// [`Error::Scene`] for a material or light that cannot be rendered.
    pub fn new(scene: &Scene) -> Result<Renderer, Error> {
        Renderer::with_options(scene, Renderer::picture_options())
    }

    /// Radiance's defaults for pictures (`rpict -defaults`), with the `-ds` of rays (0.2): a renderer
    /// traces both.
    ///
    /// ```
    /// assert_eq!(radsight::Renderer::picture_options().gathering.divisions, 512); // -ad
    /// ```
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
    /// ```
    /// # use radsight::example::{scene, view};
    /// use radsight::Renderer;
    /// use radsight::RenderOptions;
    /// let options = RenderOptions { ambient_bounces: 1, ..Renderer::picture_options() };
    /// let image = Renderer::with_options(&scene(), options)?.samples(4).render(&view(), 8, 8)?;
    /// # let _ = (image, RenderOptions::default());
    /// # Ok::<(), radsight::Error>(())
    /// ```
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
    ///
    /// ```
    /// # use radsight::example::{scene, view};
    /// use radsight::Renderer;
    /// let mut renderer = Renderer::new(&scene())?.ambient_bounces(1).samples(4);
    /// assert!(renderer.render(&view(), 8, 8)?.report().cache_noise.is_some());
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn ambient_bounces(mut self, bounces: u32) -> Renderer {
        self.options.ambient_bounces = bounces;
        self
    }

    /// Relative interpolation error of the irradiance cache (`-aa`); 0 disables it. Default 0.2.
    ///
    /// ```
    /// # use radsight::example::{scene, view};
    /// use radsight::Renderer;
    /// let mut renderer = Renderer::new(&scene())?.ambient_bounces(1).ambient_accuracy(0.0).samples(4);
    /// assert_eq!(renderer.render(&view(), 8, 8)?.report().cache_noise, None); // paths alone
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn ambient_accuracy(mut self, accuracy: f64) -> Renderer {
        self.options.gathering.accuracy = accuracy;
        self
    }

    /// Number of hemisphere samples per cache point, and of additional ones (`-ad`, `-as`). Default
    /// 512 and 128.
    ///
    /// ```
    /// # use radsight::example::scene;
    /// let mut renderer = radsight::Renderer::new(&scene())?.ambient_divisions(1024, 0);
    /// assert_eq!(renderer.options_mut().gathering.divisions, 1024);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn ambient_divisions(mut self, divisions: u32, super_samples: u32) -> Renderer {
        self.options.gathering.divisions = divisions;
        self.options.gathering.super_samples = super_samples;
        self
    }

    /// Refines until a picture's estimated relative error reaches this value, such as 0.02.
    ///
    /// ```
    /// # use radsight::example::{scene, view};
    /// use radsight::Renderer;
    /// let image = Renderer::new(&scene())?.error(0.1).render(&view(), 8, 8)?;
    /// assert!(image.report().error.unwrap() <= 0.1);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn error(self, error: f64) -> Renderer {
        self.budget(ErrorBudget::error(error))
    }

    /// Traces this many rays per pixel.
    ///
    /// ```
    /// # use radsight::example::{scene, view};
    /// use radsight::Renderer;
    /// let image = Renderer::new(&scene())?.samples(16).render(&view(), 8, 8)?;
    /// assert_eq!(image.samples().unwrap()[0], 16);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn samples(self, samples: u32) -> Renderer {
        self.budget(ErrorBudget::samples(samples))
    }

    /// The quality of pictures. Default: a preview, as with Radiance's defaults.
    ///
    /// ```
    /// # use radsight::example::{scene, view};
    /// use radsight::Renderer;
    /// use radsight::ErrorBudget;
    /// let image = Renderer::new(&scene())?.budget(ErrorBudget::error(0.1).at_most(64)).render(&view(), 8, 8)?;
    /// assert!(*image.samples().unwrap().iter().max().unwrap() <= 64);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn budget(mut self, budget: ErrorBudget) -> Renderer {
        self.budget = budget;
        self
    }

    /// Side of the square in a pixel over which its rays are jittered, pixels (`-pj`). Default: the
    /// whole pixel, or 0.67 in a preview.
    ///
    /// ```
    /// # use radsight::example::{scene, view};
    /// use radsight::Renderer;
    /// let image = Renderer::new(&scene())?.samples(4).pixel_jitter(0.0).render(&view(), 8, 8)?;
    /// assert!(image.pixels().iter().all(|pixel| pixel[0] == 1.0 || pixel[0] < 0.3)); // no smooth edge
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn pixel_jitter(mut self, side: f64) -> Renderer {
        self.jitter = Some(side);
        self
    }

    /// The seed of the sample sequence. Default 0.
    ///
    /// ```
    /// # use radsight::example::{scene, view};
    /// use radsight::Renderer;
    /// let [a, b] = [1, 2].map(|seed| Renderer::new(&scene()).unwrap().samples(1).seed(seed).render(&view(), 8, 8).unwrap());
    /// assert_ne!(a.pixels(), b.pixels());
    /// ```
    #[must_use]
    pub fn seed(mut self, seed: u64) -> Renderer {
        self.options.seed = seed;
        self
    }

    /// All options, mutable.
    ///
    /// ```
    /// # use radsight::example::scene;
    /// let mut renderer = radsight::Renderer::new(&scene())?;
    /// renderer.options_mut().seed = 7;
    /// # Ok::<(), radsight::Error>(())
    /// ```
    pub fn options_mut(&mut self) -> &mut RenderOptions {
        &mut self.options
    }

    /// Renders a view within a size; the picture keeps the view's aspect ratio.
    ///
    /// ```
    /// # use radsight::example::{scene, view};
    /// use radsight::Renderer;
    /// let image = Renderer::new(&scene())?.samples(4).render(&view(), 16, 8)?;
    /// assert_eq!((image.columns(), image.rows()), (8, 8)); // square pixels
    /// # Ok::<(), radsight::Error>(())
    /// ```
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
        let (columns, rows) = view.view.fit(columns, rows, 1.0);
        Image::check_size(columns, rows)?;
        self.check(view)?;
        let mut camera = ViewCamera::new(view.view, columns, rows);
        camera.aperture = view.aperture;
        camera.jitter = self.jitter.unwrap_or(self.budget.pixel_jitter());
        let mut options = self.options.clone();
        let pixels = self.budget.apply(&mut options);
        let (asked, used) = (self.budget.asked_error(), options.clone());
        let side = self.budget.prepass_spacing(&options.gathering);
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

    /// Renders a custom camera, or the one of a [`Capture`](crate::Capture::camera), to the error of
    /// [`Renderer::error`] or with the number of rays per pixel from [`Renderer::samples`]. Without
    /// both, as in a preview, each pixel has 16 rays. With an error, no irradiance is cached, so
    /// the picture is unbiased.
    ///
    /// ```
    /// # use radsight::example::{scene, view};
    /// use radsight::Renderer;
    /// let image = Renderer::new(&scene())?.error(0.1).render_camera(&view().thin_lens(0.1), 8, 8)?;
    /// assert!(image.report().error.unwrap() <= 0.1);
    /// # Ok::<(), radsight::Error>(())
    /// ```
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
    /// ```
    /// # use radsight::example::{scene, view};
    /// use radsight::Renderer;
    /// use radsight::PathIntegrator;
    /// let image = Renderer::new(&scene())?.samples(4).render_with(&PathIntegrator, &view(), 8, 8)?;
    /// assert_eq!(image.pixel(4, 4), [1.0; 3]);
    /// # Ok::<(), radsight::Error>(())
    /// ```
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

    /// Traces rays: radiance (or irradiance, as the options request), first hit and effective
    /// distance of each. The index in the list identifies a ray.
    ///
    /// ```
    /// # use radsight::example::scene;
    /// use glam::DVec3;
    /// use radsight::{Ray, Renderer};
    /// let ahead = Ray::new(DVec3::ZERO, DVec3::Y).unwrap();
    /// assert_eq!(Renderer::new(&scene())?.trace(&[ahead])?[0].value, [1.0; 3]);
    /// # Ok::<(), radsight::Error>(())
    /// ```
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
    /// ```
    /// # use radsight::example::scene;
    /// use glam::DVec3;
    /// use radsight::{Ray, Renderer};
    /// let ahead = Ray::new(DVec3::ZERO, DVec3::Y).unwrap();
    /// let mut renderer = Renderer::new(&scene())?;
    /// let distances = renderer.trace_part(1000, &[ahead], |traced| traced.first_hit.unwrap().distance, &radsight::Silent)?;
    /// assert!((distances.unwrap()[0] - 7.0).abs() < 1e-9);
    /// # Ok::<(), radsight::Error>(())
    /// ```
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
        options.gathering.bounded = true;
        let all = || rays.iter().copied().map(Some).collect();
        if self.gather(&options, all, RaySpacing::UNKNOWN, progress)?.is_none() {
            return Ok(None);
        }
        let renderer = &*self.prepare(options)?;
        let mut results = Vec::with_capacity(rays.len());
        for some in rays.chunks(RAYS_AT_A_TIME) {
            if progress.stops() {
                return Ok(None);
            }
            let number = first.wrapping_add(results.len() as u64);
            let answer = |worker: &mut RayWorker<'_>, (place, ray): (usize, &Ray)| {
                of(worker.trace(number.wrapping_add(place as u64), ray))
            };
            let of_a_thread = RAYS_OF_A_THREAD.min(some.len().div_ceil(rayon::current_num_threads()));
            let answers = some.par_iter().enumerate().with_min_len(of_a_thread);
            results.par_extend(answers.map_init(|| renderer.worker(), answer));
            progress.report(results.len() as u64, rays.len() as u64);
        }
        self.check_met()?;
        Ok(Some(results))
    }

    /// The compiled renderer for these options.
    pub(crate) fn ready_for(&mut self, options: RenderOptions) -> Result<&mut radsight_render::Renderer, Error> {
        self.prepare(options)
    }

    /// Reports an unusable material that a ray met.
    pub(crate) fn check_met(&self) -> Result<(), Error> {
        self.ready.as_ref().map_or(Ok(()), |(_, renderer)| check_materials(renderer.plan(), &self.scene.sources))
    }

    /// Checks options and camera before a picture.
    pub(crate) fn check(&self, camera: &dyn Camera) -> Result<(), Error> {
        check_options(&self.options)?;
        check_budget(&self.budget)?;
        self.jitter.map_or(Ok(()), check_pixel_jitter)?;
        camera.check()
    }

    /// The compiled renderer for these options, rebuilt if they changed.
    pub(crate) fn prepare(&mut self, options: RenderOptions) -> Result<&mut radsight_render::Renderer, Error> {
        check_options(&options)?;
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

/// The error estimate of a picture, and the skipped work.
pub(crate) fn report(renderer: &radsight_render::Renderer, estimate: Option<radsight_film::Estimate>) -> RenderReport {
    let skipped = renderer.plan().decisions().iter().filter(|decision| decision.skip.is_some());
    let skipped = skipped.map(|decision| format!("{}: {}", decision.what, decision.why)).collect();
    RenderReport::new(estimate, renderer.irradiance_noise(), skipped)
}

pub(crate) fn header(view: &str) -> Header {
    let mut header = Header::new("RADIANCE");
    header.push_variable("SOFTWARE", concat!(" radsight ", env!("CARGO_PKG_VERSION")));
    if !view.is_empty() {
        header.push_variable("VIEW", view);
    }
    header
}

pub(crate) fn check_materials(plan: &RenderPlan, sources: &SourceMap) -> Result<(), Error> {
    match plan.fatal_fault() {
        Some(error) => Err(Error::Material(Report::new(vec![error], sources.clone()))),
        None => Ok(()),
    }
}
