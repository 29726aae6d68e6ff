//! Exposes the pictures of a series and shares what they have in common.

use crate::capture::Capture;
use crate::error::Error;
use crate::part_move::{PartMove, change_only_what_meets_them, move_parts, moved_surfaces, regions, without};
use radsight_camera::CameraFile;
use radsight_capture::{
    Background, Checkpoint, ErrorTarget, Exposer, Exposure, LitRegion, PlacedParts, Progress, Region,
};
use radsight_diag::Diagnostic;
use radsight_ir::{Rgb, Scene, SurfaceHandle, ValidScene};
use radsight_pinhole::{BandWeights, PinholeModel, Rays};
use radsight_render::{NoModels, RayTreeOutput, RenderOptions, RenderPlan, Renderer};

/// Smallest number of poses for which a shared background pays off.
const FEWEST_POSES: usize = 3;

/// Smallest ratio of the background's error to the pictures' error. For n pictures the ratio is
/// n^−⅓, since more pictures share its cost.
const LEAST_BACKGROUND_ERROR: f64 = 0.25;

/// One picture of a series: a capture and the poses of the scene's parts.
///
/// All captures of a series use the error, samples and options of the first.
///
/// ```no_run
/// use radsight::{Capture, PartMove, SeriesPicture};
/// let capture = Capture::load("fig14.toml")?;
/// let moves = vec![PartMove::new("washer_*", "-rz 30").expect("a rotation")];
/// let picture = SeriesPicture { capture, moves };
/// # Ok::<(), radsight::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct SeriesPicture {
    /// Camera, ring, sensor.
    pub capture: Capture,
    /// Parts with a pose different from the scene's.
    pub moves: Vec<PartMove>,
}

/// Reads and compiles the scenes of a series.
///
/// [`CaptureSeries`](crate::CaptureSeries) is an implementation for the library's scenes, with an
/// example.
pub trait SeriesScenes {
    /// The error type.
    type Failure: From<Error>;

    /// The scene with the light ring of a camera file.
    ///
    /// # Errors
    /// When the scene is wrong.
    fn read(&self, camera: &CameraFile) -> Result<ValidScene, Self::Failure>;

    /// Compiles a scene derived from the last one read.
    ///
    /// # Errors
    /// When a material is not available.
    fn plan(&self, scene: ValidScene, options: RenderOptions) -> Result<RenderPlan, Self::Failure>;

    /// Checks a plan after its rays were traced.
    ///
    /// # Errors
    /// When a ray met an unusable material.
    fn check(&self, plan: &RenderPlan) -> Result<(), Self::Failure>;

    /// The error for these diagnostics of the last scene read.
    fn invalid(&self, errors: Vec<Diagnostic>) -> Self::Failure;
}

/// One exposed picture of a series: an argument of the visitor of [`expose_series`].
#[derive(Debug)]
pub struct SeriesExposure<'r> {
    /// Its index in the list of pictures.
    pub picture: usize,
    /// The exposure.
    pub exposure: Exposure,
    /// The renderer of its rays.
    pub renderer: &'r Renderer,
}

/// Exposes all pictures of a series; those that share rays follow each other.
///
/// # Errors
/// As [`SeriesScenes`], and [`Error::Option`] for an error or a number of samples out of range.
pub fn expose_series<S: SeriesScenes>(
    scenes: &S,
    pictures: &[SeriesPicture],
    progress: &dyn Progress,
    visit: &mut dyn FnMut(SeriesExposure<'_>) -> Result<(), S::Failure>,
) -> Result<(), S::Failure> {
    let Some(first) = pictures.first() else { return Ok(()) };
    first.capture.check()?;
    first.capture.check_camera()?;
    let all: Vec<usize> = (0..pictures.len()).collect();
    let scales = only_the_ring_gives_light(scenes, pictures)?;
    let share_rays = |a: usize, b: usize| {
        let [a, b] = [a, b].map(|picture| &pictures[picture].capture);
        have_one_light(a, b) && (scales || brightness(a.camera_file(), b.camera_file()) == 1.0)
    };
    for group in grouped(&all, share_rays) {
        let lead = &pictures[group[0]].capture;
        let scene = scenes.read(lead.camera_file())?;
        let poses = grouped(&group, |a, b| pictures[a].moves == pictures[b].moves);
        let series = Series { scenes, pictures, settings: &first.capture, lead, scene, progress };
        series.expose(&poses, visit)?;
        if progress.stops() {
            break;
        }
    }
    Ok(())
}

/// Groups equal items; each group keeps their order.
fn grouped(items: &[usize], equal: impl Fn(usize, usize) -> bool) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for &item in items {
        match groups.iter_mut().find(|group| equal(group[0], item)) {
            Some(group) => group.push(item),
            None => groups.push(vec![item]),
        }
    }
    groups
}

/// Whether the exposure is proportional to the intensity of the LEDs: nothing else gives light. False for pictures of
/// one intensity, for which it does not matter.
fn only_the_ring_gives_light<S: SeriesScenes>(scenes: &S, pictures: &[SeriesPicture]) -> Result<bool, S::Failure> {
    let [first, others @ ..] = pictures else { return Ok(false) };
    let first = &first.capture;
    let is_even = |other: &SeriesPicture| brightness(first.camera_file(), other.capture.camera_file()) == 1.0;
    if others.iter().all(is_even) || first.options().ambient_value != Rgb::BLACK {
        return Ok(false);
    }
    let without_ring = CameraFile { rig: None, ..first.camera_file().clone() };
    let plan = RenderPlan::new(scenes.read(&without_ring)?, first.options().clone(), &NoModels);
    // What cannot be compiled without plugins may emit.
    Ok(plan.is_ok_and(|plan| !plan.has_emitters()))
}

/// Whether two captures of one scene differ at most in exposure time, intensity of the LEDs and
/// sensor.
fn have_one_light(a: &Capture, b: &Capture) -> bool {
    let [a, b] = [a.camera_file(), b.camera_file()].map(|file| {
        let camera = file.camera.clone().with_exposure(1.0).expect("one second is positive");
        let rig = file.rig.clone().map(|mut rig| {
            (rig.camera, rig.led_intensity_w_per_sr) = (camera.clone(), 1.0);
            rig
        });
        (camera, rig, file.band_weights.clone())
    });
    a == b
}

/// Ratio of the LED intensities of two rings; 1 without a ring.
fn brightness(a: &CameraFile, b: &CameraFile) -> f64 {
    match (&a.rig, &b.rig) {
        (Some(a), Some(b)) if a.led_intensity_w_per_sr != b.led_intensity_w_per_sr => {
            a.led_intensity_w_per_sr / b.led_intensity_w_per_sr
        }
        _ => 1.0,
    }
}

/// Pictures with the same light, camera and scene that differ only in the poses of parts.
struct Series<'s, S> {
    scenes: &'s S,
    pictures: &'s [SeriesPicture],
    /// The capture whose error, samples and options apply to all.
    settings: &'s Capture,
    /// The first picture, exposed with its own exposure time and intensity.
    lead: &'s Capture,
    scene: ValidScene,
    progress: &'s dyn Progress,
}

/// Where an exposure starts.
enum Start<'s> {
    /// Without a sample.
    Alone,
    /// From another exposure of the same pose.
    Checkpoint(Checkpoint),
    /// From the scene without parts, which are in these regions, with the virtual sources in their
    /// mirrors.
    Background(&'s Background, &'s [Region], Vec<LitRegion>),
}

/// The static part of a scene with moving parts.
struct Shared {
    background: Background,
    moved: Vec<SurfaceHandle>,
}

impl<S: SeriesScenes> Series<'_, S> {
    fn expose(
        &self,
        poses: &[Vec<usize>],
        visit: &mut dyn FnMut(SeriesExposure<'_>) -> Result<(), S::Failure>,
    ) -> Result<(), S::Failure> {
        let shared = if poses.len() < FEWEST_POSES { None } else { self.shared(poses)? };
        for pose in poses {
            if self.progress.stops() {
                break;
            }
            self.expose_pose(pose, shared.as_ref(), visit)?;
        }
        Ok(())
    }

    /// Exposes the pictures with the same pose.
    fn expose_pose(
        &self,
        pose: &[usize],
        shared: Option<&Shared>,
        visit: &mut dyn FnMut(SeriesExposure<'_>) -> Result<(), S::Failure>,
    ) -> Result<(), S::Failure> {
        let scene = self.placed(&self.pictures[pose[0]].moves)?;
        let parts = shared.and_then(|shared| regions(&scene, &shared.moved));
        let renderer = self.renderer(scene, self.settings.options().clone())?;
        let mut start = match shared.zip(parts.as_deref()) {
            Some((shared, parts)) => regions_of_virtual_sources(renderer.plan(), &shared.moved, parts)
                .map_or(Start::Alone, |lit| Start::Background(&shared.background, parts, lit)),
            None => Start::Alone,
        };
        for &picture in pose {
            let capture = &self.pictures[picture].capture;
            let exposure = self.exposure(&renderer, capture, start)?;
            if exposure.is_partial {
                return Ok(());
            }
            // The next picture has the same rays, so it continues from this one.
            start = match self.settings.fixed_samples() {
                None => Start::Checkpoint(exposure.checkpoint.clone()),
                Some(_) => Start::Alone,
            };
            visit(SeriesExposure { picture, exposure, renderer: &renderer })?;
        }
        self.scenes.check(renderer.plan())
    }

    fn exposure(&self, renderer: &Renderer, capture: &Capture, start: Start<'_>) -> Result<Exposure, S::Failure> {
        let (rays, weights) = self.rays(capture.camera_file(), renderer.plan())?;
        let exposer = Exposer { renderer, rays: &rays, weights: &weights, by_row: &[] };
        let mut exposure = match (start, self.settings.error_target()) {
            (Start::Background(background, parts, lit), Some(target)) => {
                let placed = PlacedParts { parts, virtual_sources: &lit };
                background.expose_with_parts(&exposer, placed, target, self.progress)
            }
            (Start::Checkpoint(start), _) => self.settings.sampled(&exposer, Some(start), self.progress),
            _ => self.settings.sampled(&exposer, None, self.progress),
        };
        let brighter = brightness(capture.camera_file(), self.lead.camera_file());
        if brighter != 1.0 {
            let errors = exposure.pixels.iter_mut().flat_map(|pixels| &mut pixels.standard_errors);
            exposure.values.iter_mut().chain(errors).for_each(|value| *value *= brighter);
        }
        Ok(exposure)
    }

    /// The part common to all poses; `None` if the moving parts may affect any pixel.
    fn shared(&self, poses: &[Vec<usize>]) -> Result<Option<Shared>, S::Failure> {
        let moves = poses.iter().map(|pose| &self.pictures[pose[0]].moves);
        let moved = moved_surfaces(&self.scene, moves.clone().flatten()).map_err(|error| self.wrong(error))?;
        let options = self.settings.options();
        let Some(target) = self.settings.error_target() else { return Ok(None) };
        let is_local = options.ambient_bounces == 0
            && self.lead.camera_file().camera.pinhole_model() != PinholeModel::Diffraction
            && change_only_what_meets_them(&self.scene, &moved);
        if !is_local || moved.is_empty() {
            return Ok(None);
        }
        let mut within = Region::EMPTY;
        for moves in moves {
            let mut scene = Scene::clone(&self.scene);
            move_parts(&mut scene, moves).map_err(|error| self.wrong(error))?;
            let Some(parts) = regions(&scene, &moved) else { return Ok(None) };
            within = parts.iter().fold(within, |within, part| within.union(part));
        }
        let bare = without(&self.scene, &moved).validate().map_err(|errors| self.scenes.invalid(errors))?.scene;
        let with_tree = RenderOptions { ray_tree: Some(RayTreeOutput::AllAndLit), ..options.clone() };
        let tree_renderer = self.renderer(bare.clone(), with_tree)?;
        let renderer = self.renderer(bare, options.clone())?;
        let (rays, weights) = self.rays(self.lead.camera_file(), renderer.plan())?;
        let exposer = Exposer { renderer: &renderer, rays: &rays, weights: &weights, by_row: &[] };
        let share = (poses.len() as f64).cbrt().recip().max(LEAST_BACKGROUND_ERROR);
        let target = ErrorTarget { error: share * target.error, ..target };
        let background = Background::expose(&exposer, &tree_renderer, &within, target, self.progress);
        self.scenes.check(renderer.plan())?;
        Ok(background.map(|background| Shared { background, moved }))
    }

    /// The scene with its parts in their poses.
    fn placed(&self, moves: &[PartMove]) -> Result<ValidScene, S::Failure> {
        if moves.is_empty() {
            return Ok(self.scene.clone());
        }
        let mut scene = Scene::clone(&self.scene);
        move_parts(&mut scene, moves).map_err(|error| self.wrong(error))?;
        scene.validate().map(|valid| valid.scene).map_err(|errors| self.scenes.invalid(errors))
    }

    fn renderer(&self, scene: ValidScene, options: RenderOptions) -> Result<Renderer, S::Failure> {
        self.scenes.plan(scene, options).map(Renderer::new)
    }

    fn rays(&self, file: &CameraFile, plan: &RenderPlan) -> Result<(Rays, BandWeights), S::Failure> {
        let weights = file.band_weights_for(plan.bands()).map_err(|error| Error::Bands(error.to_string()))?;
        let samples = self.settings.fixed_samples().unwrap_or(1);
        Ok((Rays::new(&file.camera, samples, self.settings.options().seed), weights))
    }

    fn wrong(&self, error: Diagnostic) -> S::Failure {
        self.scenes.invalid(vec![error])
    }
}

/// The regions lit by virtual sources in moving mirrors; `None` for more than one reflection, or a
/// mirror or light without a bounded region.
fn regions_of_virtual_sources(plan: &RenderPlan, moved: &[SurfaceHandle], parts: &[Region]) -> Option<Vec<LitRegion>> {
    let mut lit = Vec::new();
    for light in &plan.lights {
        let index_of = |surface| moved.binary_search(&surface).ok();
        if !light.virtual_sources.iter().any(|source| index_of(source.surface).is_some()) {
            continue;
        }
        let [source] = &light.virtual_sources[..] else { return None };
        let is_near = light.radius.is_finite();
        let mirror = parts[index_of(source.surface)?];
        lit.push(is_near.then_some(LitRegion { mirror, image: light.center, radius: light.radius })?);
    }
    Some(lit)
}
