//! Renders jobs and fills the irradiance cache that the parts of a job share.

use super::{JobResult, JobTarget, RenderJob};
use crate::error::Error;
use crate::option_check::{check_options, wrong};
use crate::{Capture, Image, Renderer, View};
use radsight_camera::CameraFile;
use radsight_capture::{Exposer, Progress, Silent};
use radsight_film::{ViewCamera, sampled_tile};
use radsight_pinhole::Rays;
use radsight_render::{Ray, RaySpacing, RenderOptions, Uncached};

/// Number of rows between two reports of progress.
const ROWS_AT_A_TIME: usize = 16;

/// Number of rays between two reports of progress.
const RAYS_AT_A_TIME: usize = 1 << 15;

impl RenderJob {
    /// Columns and rows of the whole picture. The size of a capture is that of its camera.
    ///
    /// ```
    /// # use radsight::example::view;
    /// use radsight::{JobTarget, RenderJob};
    /// let job = RenderJob::new(JobTarget::picture(&view(), 8, 8), 2);
    /// assert_eq!(job.picture_size()?, [8, 8]);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::View`] and [`Error::Size`]; [`Error::Option`] for another target.
    pub fn picture_size(&self) -> Result<[usize; 2], Error> {
        let (_, columns, rows) = self.view()?;
        Ok([columns, rows])
    }

    /// The options for compiling the scene.
    ///
    /// ```
    /// use radsight::{JobTarget, RenderJob};
    /// let mut job = RenderJob::new(JobTarget::capture("camera.toml"), 64);
    /// job.ambient_bounces = 2;
    /// assert_eq!(job.render_options()?.ambient_bounces, 2);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Option`] for a number out of range.
    pub fn render_options(&self) -> Result<RenderOptions, Error> {
        self.check()?;
        let mut options = match self.target {
            JobTarget::Picture { .. } | JobTarget::Trace { .. } => Renderer::picture_options(),
            JobTarget::Capture { .. } => RenderOptions::default(),
        };
        (options.seed, options.ambient_bounces) = (self.seed, self.ambient_bounces);
        if let JobTarget::Trace { quantity, .. } = &self.target {
            options.gathering.uncached = Uncached::Split;
            options.gathering.bounded = true;
            options.quantity = (*quantity).into();
        }
        if self.ambient_bounces > 0 {
            options.gathering.accuracy = self.ambient_accuracy;
            options.gathering.divisions = self.ambient_divisions.unwrap_or(options.gathering.divisions);
            options.gathering.super_samples = self.ambient_super_samples.unwrap_or(options.gathering.super_samples);
        }
        check_options(&options)?;
        Ok(options)
    }

    /// Whether the job uses cached irradiance. The cache is filled once for the whole job by
    /// [`RenderJob::fill_irradiance_cache`] and loaded for each part: separate caches of the parts
    /// would have other values.
    ///
    /// ```
    /// use radsight::{JobTarget, RenderJob};
    /// let mut job = RenderJob::new(JobTarget::capture("camera.toml"), 64);
    /// (job.ambient_bounces, job.ambient_accuracy) = (2, 0.2);
    /// assert!(job.caches_irradiance());
    /// ```
    #[must_use]
    pub fn caches_irradiance(&self) -> bool {
        self.ambient_bounces > 0 && self.ambient_accuracy > 0.0
    }

    /// Fills the irradiance cache for the whole job, not only its part, as a single process does
    /// before its first pixel. `rays` are all rays of a job of rays, and ignored for others. `None`
    /// if it was stopped.
    ///
    /// # Errors
    /// As [`RenderJob::render`], and [`Error::Option`] for a job without a cache.
    pub fn fill_irradiance_cache(
        &self,
        renderer: &mut radsight_render::Renderer,
        rays: &[Ray],
        progress: &dyn Progress,
    ) -> Result<Option<()>, Error> {
        if !self.caches_irradiance() {
            return Err(wrong(
                "ambient_accuracy",
                self.ambient_accuracy,
                "more than 0, with ambient_bounces, for a cache",
            ));
        }
        let (rays, spacing) = match self.target {
            JobTarget::Trace { .. } => (rays.iter().copied().map(Some).collect(), RaySpacing::UNKNOWN),
            _ => {
                let camera = self.view_camera()?;
                (camera.prepass_rays(1), camera.spread(1))
            }
        };
        Ok(renderer.gather_irradiance_until(&rays, spacing, &|| progress.stops()).map(drop))
    }

    /// Renders a part of a picture. `renderer` must have the options of
    /// [`RenderJob::render_options`], and the job's irradiance cache if there is one.
    ///
    /// # Errors
    /// [`Error::View`], [`Error::Size`] and [`Error::Option`]. `None` if the work was stopped.
    pub fn render(
        &self,
        renderer: &radsight_render::Renderer,
        progress: &dyn Progress,
    ) -> Result<Option<JobResult>, Error> {
        self.check_cache(renderer)?;
        let camera = self.view_camera()?;
        let size = [camera.columns(), camera.rows()];
        let tile = self.tile_of(size)?;
        let mut result = JobResult::new(self, size, &tile, 3);
        for first in tile.rows.clone().step_by(ROWS_AT_A_TIME) {
            if progress.stops() {
                return Ok(None);
            }
            let last = (first + ROWS_AT_A_TIME).min(tile.rows.end);
            for pixel in sampled_tile(renderer, &camera, (tile.columns.clone(), first..last), self.samples) {
                result.push(&pixel.mean, &pixel.half_difference);
            }
            progress.report((last - tile.rows.start) as u64, tile.rows.len() as u64);
        }
        Ok(Some(result))
    }

    /// Exposes a part of a camera's pixels. `renderer` must have the options of
    /// [`RenderJob::render_options`] and the camera's light ring.
    ///
    /// # Errors
    /// [`Error::Bands`], and [`Error::Option`] for a camera whose pixels cannot be exposed separately.
    /// `None` if the work was stopped.
    pub fn expose(
        &self,
        renderer: &radsight_render::Renderer,
        camera: &CameraFile,
        progress: &dyn Progress,
    ) -> Result<Option<JobResult>, Error> {
        let size = [camera.camera.columns() as usize, camera.camera.rows() as usize];
        let tile = self.tile_of(size)?;
        let rays = Rays::new(&camera.camera, self.samples, self.seed);
        if rays.cells() != camera.camera.pixel_count() || !camera.flickering.is_empty() {
            return Err(wrong(
                "camera",
                "one with diffraction or flicker",
                "one whose pixels are exposed each by itself",
            ));
        }
        let weights = camera.band_weights_for(renderer.plan().bands());
        let weights = weights.map_err(|error| Error::Bands(error.to_string()))?;
        let exposer = Exposer { renderer, rays: &rays, weights: &weights, by_row: &[] };
        let mut result = JobResult::new(self, size, &tile, 1);
        // Whole rows follow each other without a gap.
        let at_once = if tile.columns.len() == size[0] { tile.rows.len() } else { 1 };
        for row in tile.rows.clone().step_by(at_once) {
            let first = row * size[0] + tile.columns.start;
            let last = (row + at_once - 1) * size[0] + tile.columns.end;
            let Some(exposed) = exposer.cells(first as u64..last as u64, progress) else { return Ok(None) };
            exposed.iter().for_each(|[exposure, half]| result.push(&[*exposure], &[*half]));
        }
        Ok(Some(result))
    }

    /// Traces a range of rays; `rays` are all rays of the whole job. `renderer` is as for
    /// [`RenderJob::render`].
    ///
    /// # Errors
    /// [`Error::Option`] for rays that do not exist. `None` if the work was stopped.
    pub fn trace(
        &self,
        renderer: &radsight_render::Renderer,
        rays: &[Ray],
        progress: &dyn Progress,
    ) -> Result<Option<JobResult>, Error> {
        let JobTarget::Trace { .. } = self.target else {
            return Err(wrong("target", "a picture or capture", "\"trace\""));
        };
        self.check_cache(renderer)?;
        let size = [rays.len(), 1];
        let tile = self.tile_of(size)?;
        let mut result = JobResult::new(self, size, &tile, 3);
        for first in tile.columns.clone().step_by(RAYS_AT_A_TIME) {
            if progress.stops() {
                return Ok(None);
            }
            let last = (first + RAYS_AT_A_TIME).min(tile.columns.end);
            let some: Vec<Option<Ray>> = rays[first..last].iter().copied().map(Some).collect();
            let traced = renderer.trace_all(first as u64, &some);
            traced.iter().flatten().for_each(|traced| result.push(&traced.value, &[f64::NAN; 3]));
            progress.report((last - tile.columns.start) as u64, tile.columns.len() as u64);
        }
        Ok(Some(result))
    }

    fn view_camera(&self) -> Result<ViewCamera, Error> {
        let (view, columns, rows) = self.view()?;
        let mut camera = ViewCamera::new(view.view, columns, rows);
        camera.jitter = 1.0;
        Ok(camera)
    }

    fn view(&self) -> Result<(View, usize, usize), Error> {
        let JobTarget::Picture { view, columns, rows } = &self.target else {
            return Err(wrong("target", "a capture or rays", "\"picture\""));
        };
        let view = View::from_args(view)?;
        let (columns, rows) = view.view.fit(*columns, *rows, 1.0);
        Image::check_size(columns, rows)?;
        Ok((view, columns, rows))
    }

    /// Without the job's cache the values would differ from those of other parts.
    fn check_cache(&self, renderer: &radsight_render::Renderer) -> Result<(), Error> {
        if renderer.caches_irradiance() && renderer.irradiance_noise().is_none() {
            return Err(wrong(
                "irradiance_cache",
                "none",
                "one that was made for the whole job, or ambient_accuracy 0",
            ));
        }
        Ok(())
    }
}

impl Renderer {
    /// Renders the part of a picture that a job requests, with the job's options.
    ///
    /// ```
    /// # use radsight::example::{scene, view};
    /// use radsight::{JobTarget, RenderJob, Renderer};
    /// let job = RenderJob::new(JobTarget::picture(&view(), 8, 8), 2);
    /// let result = Renderer::new(&scene())?.run_job(&job)?;
    /// assert_eq!(result.values.len(), 3 * 64);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`RenderJob::render`], and [`Error::Material`] where a ray met a material that is
    /// not supported.
    pub fn run_job(&mut self, job: &RenderJob) -> Result<JobResult, Error> {
        Ok(self.run_job_with_progress(job, &[], &Silent)?.expect("nobody stopped it"))
    }

    /// As [`Renderer::run_job`], also for a job of rays, of which `rays` are all. `progress` receives
    /// the progress and can stop the work; the result is `None` then.
    ///
    /// # Errors
    /// As [`Renderer::run_job`] and [`RenderJob::trace`].
    pub fn run_job_with_progress(
        &mut self,
        job: &RenderJob,
        rays: &[Ray],
        progress: &dyn Progress,
    ) -> Result<Option<JobResult>, Error> {
        let renderer = self.ready_for(job.render_options()?)?;
        let result = match job.target {
            JobTarget::Trace { .. } => job.trace(renderer, rays, progress)?,
            _ => job.render(renderer, progress)?,
        };
        self.check_met()?;
        Ok(result)
    }

    /// The irradiance cache of a whole job, for [`Renderer::only_irradiance_cache`] before its parts
    /// are run; `rays` are all rays of a job of rays. `None` if it was stopped.
    ///
    /// ```
    /// # use radsight::example::{scene, view};
    /// use radsight::{JobTarget, RenderJob, Renderer};
    /// let mut job = RenderJob::new(JobTarget::picture(&view(), 8, 8), 2);
    /// (job.ambient_bounces, job.ambient_accuracy) = (1, 0.2);
    /// assert!(Renderer::new(&scene())?.irradiance_cache_for(&job, &[], &radsight::Silent)?.is_some());
    /// # Ok::<(), radsight::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`RenderJob::fill_irradiance_cache`].
    pub fn irradiance_cache_for(
        &mut self,
        job: &RenderJob,
        rays: &[Ray],
        progress: &dyn Progress,
    ) -> Result<Option<Vec<u8>>, Error> {
        let renderer = self.ready_for(job.render_options()?)?;
        if job.fill_irradiance_cache(renderer, rays, progress)?.is_none() {
            return Ok(None);
        }
        self.check_met()?;
        Ok(self.save_irradiance_cache())
    }
}

impl Capture {
    /// Exposes the pixels that a job requests, with the job's options and samples. The scene of
    /// `renderer` must have the camera's light ring.
    ///
    /// ```
    /// # use radsight::example::{capture, scene};
    /// use radsight::{JobTarget, RenderJob, Renderer, Silent};
    /// let job = RenderJob::new(JobTarget::capture("camera.toml"), 4);
    /// let result = capture().run_job(&mut Renderer::new(&scene())?, &job, &Silent)?;
    /// assert_eq!(result.unwrap().values.len(), 256);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`RenderJob::expose`] and [`Capture::expose`]. `None` if the work was stopped.
    pub fn run_job(
        &self,
        renderer: &mut Renderer,
        job: &RenderJob,
        progress: &dyn Progress,
    ) -> Result<Option<JobResult>, Error> {
        let result = job.expose(renderer.ready_for(job.render_options()?)?, self.camera_file(), progress)?;
        renderer.check_met()?;
        Ok(result)
    }
}
