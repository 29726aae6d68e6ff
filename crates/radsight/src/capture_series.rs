//! Series of captures of similar scenes.

mod engine;

pub use engine::{SeriesExposure, SeriesPicture, SeriesScenes, expose_series};

use crate::capture::CapturedImage;
use crate::error::{Error, Report};
use crate::renderer::check_materials;
use crate::report_page;
use crate::scene::{Scene, SceneBuilder};
use radsight_camera::CameraFile;
use radsight_capture::{Progress, Silent};
use radsight_diag::Diagnostic;
use radsight_ir::ValidScene;
use radsight_render::{RenderOptions, RenderPlan};
use std::cell::RefCell;

/// Captures of a scene that differ in camera, ring, exposure, sensor, or poses of parts.
///
/// Common work is done once. The scene is read once per light ring. Pictures that differ in the
/// sensor, the exposure time or the LEDs' intensity share their rays. Pictures that differ in the
/// poses of parts share all pixels whose light does not meet the parts. These shared pixels get
/// more rays than in a single picture, and their error is the same in all pictures.
///
/// ```
/// use radsight::{Capture, CaptureSeries, MemoryLoader, PartMove, Scene, SeriesPicture};
/// # fn main() -> Result<(), radsight::Error> {
/// # let camera = b"[camera]\nposition_m = [0, 0, 0.5]\ndirection = [0, 0, -1]\nup = [0, 1, 0]\npixels = [24, 20]\npixel_pitch_um = [100, 100]
/// # focal_distance_mm = 6.75\npinhole_diameter_mm = 0.1\nexposure_ms = 10\n";
/// let capture = Capture::from_text("camera.toml", camera, &MemoryLoader::default())?.error(0.02);
/// let scene = "void glow sky 0 0 4 1 1 1 0 sky source up 0 0 4 0 0 1 180
///     void mirror steel 0 0 3 .8 .8 .8 steel sphere ball 0 0 4 0 0 .01 .01";
/// let series = CaptureSeries::new(Scene::builder().text("scene.rad", scene));
/// let pictures = ["-t 0 0 0", "-t .03 0 0", "-t .06 .02 0"].map(|pose| SeriesPicture {
///     capture: capture.clone(),
///     moves: vec![PartMove::new("ball", pose).expect("a transform")],
/// });
/// let mut images = Vec::new();
/// series.expose(&pictures, |_, image| images.push(image))?;
/// assert_ne!(images[0].exposure_j_per_m2, images[1].exposure_j_per_m2);
/// # Ok(())
/// # }
/// ```
pub struct CaptureSeries<'l> {
    scene: SceneBuilder<'l>,
}

impl<'l> CaptureSeries<'l> {
    /// A series for a scene without a light ring; the ring of each camera file is added.
    #[must_use]
    pub fn new(scene: SceneBuilder<'l>) -> CaptureSeries<'l> {
        CaptureSeries { scene }
    }

    /// Exposes all pictures. `visit` receives each with its index in the list; the order may differ
    /// from the list.
    ///
    /// # Errors
    /// As [`Capture::expose`](crate::Capture::expose), and [`Error::Scene`] for parts that cannot
    /// be moved.
    pub fn expose(&self, pictures: &[SeriesPicture], visit: impl FnMut(usize, CapturedImage)) -> Result<(), Error> {
        self.expose_with_progress(pictures, &Silent, visit)
    }

    /// The same with progress reports. `progress` receives the finished share of each exposure and
    /// can stop it; a stopped picture is not visited.
    ///
    /// # Errors
    /// As [`CaptureSeries::expose`].
    pub fn expose_with_progress(
        &self,
        pictures: &[SeriesPicture],
        progress: &dyn Progress,
        mut visit: impl FnMut(usize, CapturedImage),
    ) -> Result<(), Error> {
        let scenes = BuiltScenes::new(&self.scene);
        expose_series(&scenes, pictures, progress, &mut |exposed: SeriesExposure<'_>| {
            let capture = &pictures[exposed.picture].capture;
            let record = report_page::record(exposed.renderer, capture.options());
            visit(exposed.picture, capture.image(exposed.exposure, record));
            Ok(())
        })
    }
}

/// The scenes that a builder reads.
pub(crate) struct BuiltScenes<'s, 'l> {
    builder: &'s SceneBuilder<'l>,
    /// The last scene read: it holds the sources of messages, and the materials.
    last: RefCell<Option<Scene>>,
}

impl<'s, 'l> BuiltScenes<'s, 'l> {
    pub(crate) fn new(builder: &'s SceneBuilder<'l>) -> BuiltScenes<'s, 'l> {
        BuiltScenes { builder, last: RefCell::new(None) }
    }

    fn report(&self, errors: Vec<Diagnostic>) -> Box<Report> {
        let sources = self.last.borrow().as_ref().map(|scene| scene.sources.clone());
        Report::new(errors, sources.unwrap_or_default())
    }
}

impl SeriesScenes for BuiltScenes<'_, '_> {
    type Failure = Error;

    fn read(&self, camera: &CameraFile) -> Result<ValidScene, Error> {
        let ring = camera.rig.as_ref().map(|rig| rig.scene_text());
        let scene = self.builder.read(ring.as_deref())?;
        let valid = scene.scene.clone();
        *self.last.borrow_mut() = Some(scene);
        Ok(valid)
    }

    fn plan(&self, scene: ValidScene, options: RenderOptions) -> Result<RenderPlan, Error> {
        let materials = self.last.borrow().as_ref().map(|scene| scene.materials.clone()).unwrap_or_default();
        RenderPlan::new(scene, options, &materials).map_err(|errors| Error::Scene(self.report(errors)))
    }

    fn check(&self, plan: &RenderPlan) -> Result<(), Error> {
        match &*self.last.borrow() {
            Some(scene) => check_materials(plan, &scene.sources),
            None => Ok(()),
        }
    }

    fn invalid(&self, errors: Vec<Diagnostic>) -> Error {
        Error::Scene(self.report(errors))
    }
}
