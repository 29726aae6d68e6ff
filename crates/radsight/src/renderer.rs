//! A scene that is ready to answer rays.

use crate::camera::{self, Camera};
use crate::error::{Error, Report};
use crate::error_budget::ErrorBudget;
use crate::image::{Image, Maps, RenderReport};
use crate::integrator::{Integrator, PathIntegrator, RayQueries};
use crate::{Scene, View, report_page};
use radsight_capture::{Progress, Silent};
use radsight_diag::SourceMap;
use radsight_film::{Film, SamplingBudget, ViewCamera};
use radsight_picture::Header;
use radsight_render::{Gathering, Ray, RaySpacing, RayWorker, RenderOptions, RenderPlan, Traced, Uncached};
use radsight_sampling::{DimensionSet, RaySampler};
use rayon::prelude::*;

/// Rays through a pixel of a camera of one's own, unless it is said.
const USUAL_SAMPLES: u32 = 16;

/// Rays that a camera of one's own is asked for at once, about.
const CAMERA_BATCH: usize = 4096;

/// Rays after which it is asked whether to go on.
const RAYS_AT_A_TIME: usize = 1 << 17;

/// Bits of a ray's number that tell the samples of a pixel.
const SEQUENCE_LOG2: u32 = 16;

/// Hears how much of the work is done, from 0 to 1; what it gives says whether to go on.
type ProgressCallback<'p> = dyn FnMut(f64) -> bool + 'p;

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
    scene: Scene,
    options: RenderOptions,
    budget: ErrorBudget,
    jitter: Option<f64>,
    /// What answers rays, for the options with which it was made.
    ready: Option<(RenderOptions, radsight_render::Renderer)>,
    /// An irradiance cache that was loaded, for each `ready` that is made.
    loaded: Option<Vec<u8>>,
}

/// What a ray owes to one of the modifiers that were asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModifierContribution {
    /// The place of the modifier among those that were asked for.
    pub modifier: usize,
    /// Red, green and blue, W/(sr·m²); W/m² where irradiance is asked for.
    pub value: [f64; 3],
}

impl Renderer {
    /// For a scene, with Radiance's defaults for pictures.
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
            uncached: Uncached::DrawOne,
            ..Gathering::default()
        };
        RenderOptions { mirror_sources: 1, gathering, highlight_threshold: 0.15, ..RenderOptions::default() }
    }

    /// The same with options of one's own.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn with_options(scene: &Scene, options: RenderOptions) -> Result<Renderer, Error> {
        let budget = ErrorBudget::default();
        let mut renderer = Renderer { scene: scene.clone(), options, budget, jitter: None, ready: None, loaded: None };
        let options = renderer.options.clone();
        renderer.prepare(options)?;
        Ok(renderer)
    }

    /// Diffuse interreflections that are followed (`-ab`). Default 0.
    #[must_use]
    pub fn ambient_bounces(mut self, bounces: u32) -> Renderer {
        self.options.ambient_bounces = bounces;
        self
    }

    /// Error at which interpolation of irradiance aims, as a share (`-aa`); 0 caches nothing. Default 0.2.
    #[must_use]
    pub fn ambient_accuracy(mut self, accuracy: f64) -> Renderer {
        self.options.gathering.accuracy = accuracy;
        self
    }

    /// Rays of a cache point, and further ones (`-ad`, `-as`). Default 512 and 128.
    #[must_use]
    pub fn ambient_divisions(mut self, divisions: u32, super_samples: u32) -> Renderer {
        self.options.gathering.divisions = divisions;
        self.options.gathering.super_samples = super_samples;
        self
    }

    /// Goes on until a picture's estimated relative error is this, such as 0.02.
    #[must_use]
    pub fn error(self, error: f64) -> Renderer {
        self.budget(ErrorBudget::error(error))
    }

    /// Traces so many rays through every pixel.
    #[must_use]
    pub fn samples(self, samples: u32) -> Renderer {
        self.budget(ErrorBudget::samples(samples))
    }

    /// How good pictures are to be. Default a preview, as Radiance's defaults give.
    #[must_use]
    pub fn budget(mut self, budget: ErrorBudget) -> Renderer {
        self.budget = budget;
        self
    }

    /// Side of the square in a pixel over which its rays are spread, in pixels (`-pj`). Default the whole pixel, in a preview 0.67.
    #[must_use]
    pub fn pixel_jitter(mut self, side: f64) -> Renderer {
        self.jitter = Some(side);
        self
    }

    /// Chooses the sample sequence. Default 0.
    #[must_use]
    pub fn seed(mut self, seed: u64) -> Renderer {
        self.options.seed = seed;
        self
    }

    /// All options, to be changed.
    pub fn options_mut(&mut self) -> &mut RenderOptions {
        &mut self.options
    }

    /// Renders a view within a size; the picture has the view's own proportions.
    ///
    /// # Errors
    /// [`Error::Size`], [`Error::Option`], and [`Error::Material`] where a ray met a material that cannot be used.
    pub fn render(&mut self, view: &View, columns: usize, rows: usize) -> Result<Image, Error> {
        let image = self.render_with_progress(view, columns, rows, &mut |_| true)?;
        Ok(image.expect("nobody stopped it"))
    }

    /// The same; `progress` hears the share that is done and says whether to go on. `None` if it did not.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn render_with_progress(
        &mut self,
        view: &View,
        columns: usize,
        rows: usize,
        progress: &mut ProgressCallback<'_>,
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
        let renderer = self.prepare(options)?;
        let (rays, spread) = (camera.prepass_rays(side), camera.spread(side));
        if let SamplingBudget::Error { .. } = pixels {
            renderer.guide_paths(&rays, spread);
        }
        renderer.gather_irradiance(&rays, spread);
        let mut film = Film::new(renderer, camera, pixels);
        let mut image = Vec::with_capacity(columns * rows);
        let mut row = 0;
        while row < rows {
            let block = film.block_of(row);
            // Pixels of so many samples each do not depend on each other: the answer to whether to go on need not wait for a block.
            let block = match pixels {
                SamplingBudget::Samples(samples) => {
                    let at_a_time = (RAYS_AT_A_TIME / (columns * samples as usize)).max(1);
                    row..block.end.min(row + at_a_time)
                }
                _ => block,
            };
            image.extend(film.finish_block(block.clone()));
            row = block.end;
            if !progress(row as f64 / rows as f64) {
                return Ok(None);
            }
        }
        check_materials(renderer.plan(), &sources)?;
        let report = report(renderer, film.estimate());
        let maps = Maps { relative_errors: film.relative_errors(), samples: film.samples() };
        let image = Image::new(columns, image, header(&view.to_args()), report);
        Ok(Some(image.with_accounts(maps, report_page::record(renderer, &used), asked)))
    }

    /// Renders what a camera of one's own sees, with as many rays a pixel as [`Renderer::samples`] asks for (16 without that).
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn render_camera(&mut self, camera: &dyn Camera, columns: usize, rows: usize) -> Result<Image, Error> {
        self.render_with(&PathIntegrator, camera, columns, rows)
    }

    /// The same with an integrator of one's own.
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
        Image::check_size(columns, rows)?;
        let mut options = self.options.clone();
        let samples = match self.budget.apply(&mut options) {
            SamplingBudget::Samples(samples) => samples,
            _ => USUAL_SAMPLES,
        };
        check_budget(SamplingBudget::Samples(samples))?;
        let used = options.clone();
        let (seed, sources) = (options.seed, self.scene.sources.clone());
        let renderer = self.prepare(options)?;
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
        renderer.gather_irradiance(&first, RaySpacing::UNKNOWN);
        let renderer = &*renderer;
        let at_once = (CAMERA_BATCH / samples as usize).max(1);
        let batches: Vec<Vec<[f32; 3]>> = (0..pixels.div_ceil(at_once))
            .into_par_iter()
            .map_init(
                || renderer.worker(),
                |worker, batch| {
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
                    sums.into_iter().map(|sum| sum.map(|band| (band / f64::from(samples)) as f32)).collect()
                },
            )
            .collect();
        let pixels = batches.concat();
        check_materials(renderer.plan(), &sources)?;
        let maps = Maps { relative_errors: None, samples: Some(vec![samples; columns * rows]) };
        let image = Image::new(columns, pixels, header(""), report(renderer, None));
        Ok(image.with_accounts(maps, report_page::record(renderer, &used), None))
    }

    /// Answers rays: radiance (or irradiance, as the options ask), first hit and effective distance of each. Rays are told apart by
    /// their place in the list.
    ///
    /// # Errors
    /// [`Error::Material`] where a ray met a material that cannot be used.
    pub fn trace(&mut self, rays: &[Ray]) -> Result<Vec<Traced>, Error> {
        Ok(self.trace_part(0, rays, &Silent)?.expect("nobody stopped it"))
    }

    /// The same for a part of a longer list, in which the first of these rays has the place `first`: without cached irradiance
    /// the answers are those of the whole list. `progress` hears how far it is, and can stop it: it gives `None` then.
    ///
    /// # Errors
    /// As [`Renderer::trace`].
    pub fn trace_part(
        &mut self,
        first: u64,
        rays: &[Ray],
        progress: &dyn Progress,
    ) -> Result<Option<Vec<Traced>>, Error> {
        let mut options = self.options.clone();
        options.gathering.uncached = Uncached::Split;
        let renderer = self.prepare(options)?;
        let all: Vec<Option<Ray>> = rays.iter().copied().map(Some).collect();
        renderer.gather_irradiance(&all, RaySpacing::UNKNOWN);
        let mut traced = Vec::with_capacity(all.len());
        for some in all.chunks(RAYS_AT_A_TIME) {
            if progress.stops() {
                return Ok(None);
            }
            traced.extend(renderer.trace_all(first + traced.len() as u64, some).into_iter().flatten());
            progress.report(traced.len() as u64, all.len() as u64);
        }
        self.check_met()?;
        Ok(Some(traced))
    }

    /// What each ray owes to modifiers of these names: the radiance of emitters among them times what of it arrives, as `rcontrib`
    /// finds it.
    ///
    /// # Errors
    /// As [`Renderer::trace`].
    pub fn contributions(&mut self, rays: &[Ray], modifiers: &[&str]) -> Result<Vec<Vec<ModifierContribution>>, Error> {
        Ok(self.contributions_part(0, rays, modifiers, &Silent)?.expect("nobody stopped it"))
    }

    /// The same for a part of a longer list, as [`Renderer::trace_part`] has it.
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

    /// What answers rays with these options.
    pub(crate) fn ready_for(&mut self, options: RenderOptions) -> Result<&radsight_render::Renderer, Error> {
        self.prepare(options).map(|renderer| &*renderer)
    }

    /// Whether a ray met a material that cannot be used.
    pub(crate) fn check_met(&self) -> Result<(), Error> {
        self.ready.as_ref().map_or(Ok(()), |(_, renderer)| check_materials(renderer.plan(), &self.scene.sources))
    }

    /// The irradiance that pictures and rays have cached so far, as bytes for [`Renderer::load_irradiance_cache`]; `None` where there is none.
    ///
    /// ```
    /// use radsight::{Renderer, Scene, View};
    /// # fn main() -> Result<(), radsight::Error> {
    /// let text = "void plastic grey 0 0 5 .5 .5 .5 0 0 grey sphere ball 0 0 4 0 9 0 2 void glow sky 0 0 4 1 1 1 0 sky source dome 0 0 4 0 0 1 360";
    /// let scene = Scene::from_text(text)?;
    /// let view = View::from_args("-vp 0 0 0 -vd 0 1 0 -vh 40 -vv 40")?;
    /// let mut first = Renderer::new(&scene)?.ambient_bounces(1);
    /// let image = first.render(&view, 16, 16)?;
    /// let cache = first.save_irradiance_cache().expect("a bounce fills it");
    /// // In another process:
    /// let mut second = Renderer::new(&scene)?.ambient_bounces(1).seed(7);
    /// assert!(second.load_irradiance_cache(cache)? > 0);
    /// # let _ = (image, second.render(&view, 16, 16)?);
    /// # Ok(())
    /// # }
    /// ```
    pub fn save_irradiance_cache(&mut self) -> Option<Vec<u8>> {
        let scene = self.scene.scene.fingerprint();
        let cached = self.ready.as_mut().and_then(|(_, renderer)| renderer.save_irradiance_cache(scene));
        cached.or_else(|| self.loaded.clone())
    }

    /// Takes over irradiance that was saved for the same scene and for options that count the same light, and says from how many points it is. Rays for which it was
    /// gathered get the same answers, bit for bit.
    ///
    /// # Errors
    /// [`Error::Cache`] where it was saved for another scene or other options, here and where options are changed later; as [`Renderer::new`].
    pub fn load_irradiance_cache(&mut self, bytes: Vec<u8>) -> Result<usize, Error> {
        let (before, options) = (self.loaded.take(), self.options.clone());
        let scene = self.scene.scene.fingerprint();
        let records = match self.prepare(options)?.load_irradiance_cache(&bytes, scene) {
            Ok(records) => records,
            Err(error) => {
                self.loaded = before;
                return Err(error.into());
            }
        };
        self.loaded = Some(bytes);
        Ok(records)
    }

    /// What answers rays with these options; made anew where they are others than before.
    fn prepare(&mut self, options: RenderOptions) -> Result<&mut radsight_render::Renderer, Error> {
        if self.ready.as_ref().is_none_or(|(made, _)| *made != options) {
            self.ready = None;
            let plan = RenderPlan::new(self.scene.scene.clone(), options.clone(), &self.scene.materials)
                .map_err(|errors| Error::Scene(Report::new(errors, self.scene.sources.clone())))?;
            let mut renderer = radsight_render::Renderer::new(plan);
            if let Some(cache) = &self.loaded {
                renderer.load_irradiance_cache(cache, self.scene.scene.fingerprint())?;
            }
            self.ready = Some((options, renderer));
        }
        Ok(&mut self.ready.as_mut().expect("it was just made").1)
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

/// How good a picture is, and what was left out for it.
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
        SamplingBudget::Error { error, .. } if !(error > 0.0 && error.is_finite()) => {
            wrong("error", error.to_string(), "a share above 0, such as 0.02")
        }
        SamplingBudget::Samples(samples) if !(1..=radsight_film::MAX_SAMPLES).contains(&samples) => {
            wrong("samples", samples.to_string(), "1 to 65536")
        }
        _ => Ok(()),
    }
}

pub(crate) fn check_materials(plan: &RenderPlan, sources: &SourceMap) -> Result<(), Error> {
    match plan.unusable_met() {
        Some(error) => Err(Error::Material(Report::new(vec![error], sources.clone()))),
        None => Ok(()),
    }
}
