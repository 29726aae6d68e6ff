//! HTML report pages: values, false colour, error and settings in one file.

use crate::{Capture, CapturedImage, Error, Image};
use radsight_picture::Image as Values;
use radsight_report::{Decision, ErrorEstimate, ErrorMap, GreyPicture, Page, Quantity, RunRecord};

impl Image {
    /// A report page of the image, to which more can be added; [`Page::to_html`] writes it.
    ///
    /// It contains the luminance and radiance of each pixel, its standard error and number of rays
    /// if known, the skipped work, and the options. It contains no times: callers with a clock add
    /// them by [`Page::stage`].
    ///
    /// ```
    /// # use radsight::example::{scene, view};
    /// use radsight::Renderer;
    /// let image = Renderer::new(&scene())?.samples(4).render(&view(), 8, 8)?;
    /// assert!(image.report_page("ball").fact("room", "none").to_html().contains("ball"));
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn report_page(&self, title: &str) -> Page {
        let values = self.pixels().iter().flatten().copied().collect();
        let page =
            Page::new(title, self.map(3, values), Quantity::Radiance).expect("the picture has pixels of 3 bands");
        let page = page.record(self.record().clone()).text("Header", self.header().to_text());
        let page = match self.header().variable("VIEW") {
            Some(view) => page.fact("view", view),
            None => page,
        };
        let page = match self.relative_errors() {
            Some(errors) => page.error_map(ErrorMap::Relative(self.map(1, errors.to_vec()))),
            None => Ok(page),
        };
        let rays = self.samples().map(|samples| samples.iter().map(|samples| *samples as f32).collect());
        let page = match rays {
            Some(rays) => page.and_then(|page| page.ray_map(self.map(1, rays))),
            None => page,
        };
        page.expect("maps have the size of the picture")
    }

    /// The page as HTML: one file that loads nothing. Its title is "radsight".
    ///
    /// ```
    /// use radsight::{Renderer, Scene, View};
    /// # fn main() -> Result<(), radsight::Error> {
    /// let scene = Scene::from_text("void glow white 0 0 4 1 1 1 0 white sphere ball 0 0 4 0 9 0 2")?;
    /// let view = View::from_args("-vp 0 0 0 -vd 0 1 0 -vh 40 -vv 40")?;
    /// let image = Renderer::new(&scene)?.error(0.05).render(&view, 32, 32)?;
    /// assert!(image.report_html().contains("relative standard error"));
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn report_html(&self) -> String {
        self.report_page("radsight").to_html()
    }

    fn map(&self, components: usize, values: Vec<f32>) -> Values<f32> {
        Values::new(self.columns(), self.rows(), components, values).expect("values for every pixel")
    }
}

impl CapturedImage {
    /// A report page of the exposure, with the sensor's grey values if the camera has a sensor; see
    /// [`Image::report_page`].
    ///
    /// ```
    /// # use radsight::example::{capture, scene};
    /// let page = capture().samples(4).expose(&scene())?.report_page(&capture(), "ball")?;
    /// assert!(page.to_html().contains("ball"));
    /// # Ok::<(), radsight::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Size`] if the camera's size differs from the image's.
    pub fn report_page(&self, camera: &Capture, title: &str) -> Result<Page, Error> {
        let file = camera.camera_file();
        let wrong = |_| Error::Size { columns: self.columns, rows: self.rows, most: Image::MOST_PIXELS };
        let single = |values: &[f64]| {
            let data = values.iter().map(|value| *value as f32).collect();
            Values::new(self.columns, self.rows, 1, data).map_err(wrong)
        };
        let size = [file.camera.columns() as usize, file.camera.rows() as usize];
        if size != [self.columns, self.rows] {
            return Err(Error::Size { columns: self.columns, rows: self.rows, most: size[0] * size[1] });
        }
        let [across, along] = file.camera.pixel_pitch_m();
        let reason = "the maps have the size of the picture";
        let mut page = Page::new(title, single(&self.exposure_j_per_m2)?, Quantity::Exposure).expect(reason);
        page = page.pixel_aspect((along / across).clamp(1e-3, 1e3)).expect("it was clamped");
        page = page.fact("camera", file.summary()).record(self.record.clone());
        if let Some(pixels) = &self.pixels {
            let rays: Vec<f64> = pixels.samples.iter().map(|samples| f64::from(*samples)).collect();
            page = page.error_map(ErrorMap::Absolute(single(&pixels.standard_errors)?)).expect(reason);
            page = page.ray_map(single(&rays)?).expect(reason);
        }
        if let Some(sensor) = &file.sensor {
            let values = Values::new(self.columns, self.rows, 1, self.greys(camera)?).map_err(wrong)?;
            page = page.grey_picture(GreyPicture { values, largest: sensor.bits().largest() }).expect(reason);
        }
        Ok(page)
    }

    /// The page as HTML: one file that loads nothing. Its title is "radsight".
    ///
    /// ```
    /// # use radsight::example::{capture, scene};
    /// assert!(capture().samples(4).expose(&scene())?.report_html(&capture())?.starts_with("<!"));
    /// # Ok::<(), radsight::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`CapturedImage::report_page`].
    pub fn report_html(&self, camera: &Capture) -> Result<String, Error> {
        Ok(self.report_page(camera, "radsight")?.to_html())
    }
}

/// The record of a run: the renderer's decisions, and the options that determine its cost.
pub(crate) fn record(renderer: &radsight_render::Renderer, options: &radsight_render::RenderOptions) -> RunRecord {
    let decision = |decision: &radsight_render::PlanDecision| Decision {
        what: decision.what.clone(),
        why: decision.why.clone(),
        skipped: decision.skip.is_some(),
    };
    let mut record = RunRecord {
        software: concat!("radsight ", env!("CARGO_PKG_VERSION")).to_owned(),
        cache_noise: renderer.irradiance_noise(),
        decisions: renderer.plan().decisions().iter().map(decision).collect(),
        ..RunRecord::default()
    };
    record.push_setting("seed", options.seed.to_string());
    record.push_setting("diffuse interreflections", options.ambient_bounces.to_string());
    if options.ambient_bounces > 0 {
        let gathering = &options.gathering;
        record.push_setting("accuracy of cached irradiance", gathering.accuracy.to_string());
        record.push_setting("rays of a cache point", format!("{} + {}", gathering.divisions, gathering.super_samples));
    }
    record
}

/// The estimated error.
pub(crate) fn reached(error: Option<f64>, uncertainty: Option<f64>, asked: Option<f64>) -> Option<ErrorEstimate> {
    error.map(|reached| ErrorEstimate { asked, reached, uncertainty })
}
