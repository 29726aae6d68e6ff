//! Differentiates an exposure by each parameter.

use super::parameter::{Kind, Parameter};
use super::part::MovingPart;
use crate::capture::Capture;
use crate::capture_series::SeriesScenes;
use crate::error::Error;
use crate::part_move::{PartMove, move_parts};
use radsight_camera::CameraFile;
use radsight_capture::{Derivative, DerivativeSamples, Exposer, Exposure, Motion, ParameterStep, Progress};
use radsight_ir::{Scene, ValidScene};
use radsight_pinhole::{BandWeights, PinholeModel, Rays};
use radsight_render::{Ray, RenderPlan, Renderer};
use std::collections::BTreeSet;

/// Largest number of parameters of one study.
const MOST_PARAMETERS: usize = 1 << 16;

/// Distance of the scene, where no ray on the axis of the camera hits it, metres.
const USUAL_DISTANCE_M: f64 = 1.0;

/// An exposure and its derivatives.
#[derive(Clone, Debug)]
pub struct ExposureDerivatives {
    /// The exposure itself, to the capture's error.
    pub exposure: Exposure,
    /// In the order of the parameters.
    pub derivatives: Vec<ParameterDerivative>,
}

/// The derivative of the exposure by one parameter.
#[derive(Clone, Debug)]
pub struct ParameterDerivative {
    /// The parameter.
    pub parameter: Parameter,
    /// Step of the central differences, in the parameter's unit.
    pub step: f64,
    /// The derivative of each pixel, J/m² per unit of the parameter.
    pub derivative: Derivative,
}

/// Exposes a capture and differentiates it by parameters, until the rms of the standard errors of
/// each derivative is `error` times the rms of the derivative. `None` if the work was stopped.
///
/// # Errors
/// As [`SeriesScenes`], [`Error::Parameter`] for a parameter that this capture does not have, and
/// [`Error::Option`] for an error out of range.
pub fn expose_derivatives<S: SeriesScenes>(
    scenes: &S,
    capture: &Capture,
    parameters: &[Parameter],
    error: f64,
    progress: &dyn Progress,
) -> Result<Option<ExposureDerivatives>, S::Failure> {
    capture.check()?;
    capture.check_camera()?;
    check(capture, parameters, error)?;
    let file = capture.camera_file();
    let scene = scenes.read(file)?;
    let plan = scenes.plan(scene.clone(), capture.options().clone())?;
    let center = Side::new(capture, file, Renderer::new(plan))?;
    let study = Study { scenes, capture, scene, center, error, progress };
    let exposer = study.center.exposer(&study.center);
    let exposure = capture.sampled(&exposer, None, progress);
    let mut derivatives = Vec::new();
    for (stream, parameter) in (0..).zip(parameters) {
        match study.derivative(parameter, stream)? {
            Some(derivative) => derivatives.push(derivative),
            None => return Ok(None),
        }
    }
    scenes.check(study.center.plan())?;
    Ok((!exposure.is_partial).then_some(ExposureDerivatives { exposure, derivatives }))
}

fn check(capture: &Capture, parameters: &[Parameter], error: f64) -> Result<(), Error> {
    if !(error > 0.0 && error.is_finite()) {
        let expected = "a relative error above 0, such as 0.01";
        return Err(Error::Option { option: "derivative error", value: error.to_string(), expected });
    }
    if parameters.len() > MOST_PARAMETERS {
        let (option, expected) = ("number of parameters", "at most 65536");
        return Err(Error::Option { option, value: parameters.len().to_string(), expected });
    }
    if parameters.is_empty() {
        let (option, expected) = ("number of parameters", "at least 1");
        return Err(Error::Option { option, value: "0".to_owned(), expected });
    }
    let mut seen = BTreeSet::new();
    if let Some(twice) = parameters.iter().find(|parameter| !seen.insert(parameter.name())) {
        return Err(twice.wrong("it is given twice"));
    }
    match parameters.first() {
        Some(first) if capture.camera_file().camera.pinhole_model() == PinholeModel::Diffraction => {
            Err(first.wrong("an exposure with pinhole_model = \"diffraction\" has no derivatives"))
        }
        Some(first) if capture.camera_file().camera.telecentric_lens().is_some() => {
            Err(first.wrong("an exposure with projection = \"parallel\" has no derivatives"))
        }
        _ => Ok(()),
    }
}

/// Scene and camera for one value of a parameter.
struct Side {
    /// `None` for the scene of the center.
    renderer: Option<Renderer>,
    rays: Rays,
    weights: BandWeights,
}

impl Side {
    fn new(capture: &Capture, file: &CameraFile, renderer: Renderer) -> Result<Side, Error> {
        let weights = band_weights(file, renderer.plan())?;
        let rays = Rays::new(&file.camera, capture.fixed_samples().unwrap_or(1), capture.options().seed);
        Ok(Side { renderer: Some(renderer), rays, weights })
    }

    fn plan(&self) -> &RenderPlan {
        self.renderer.as_ref().expect("the center has a renderer").plan()
    }

    fn exposer<'s>(&'s self, center: &'s Side) -> Exposer<'s> {
        let renderer = self.renderer.as_ref().or(center.renderer.as_ref()).expect("the center has a renderer");
        Exposer { renderer, rays: &self.rays, weights: &self.weights, by_row: &[] }
    }
}

fn band_weights(file: &CameraFile, plan: &RenderPlan) -> Result<BandWeights, Error> {
    file.band_weights_for(plan.bands()).map_err(|error| Error::Bands(error.to_string()))
}

struct Study<'s, S> {
    scenes: &'s S,
    capture: &'s Capture,
    scene: ValidScene,
    center: Side,
    error: f64,
    progress: &'s dyn Progress,
}

impl<S: SeriesScenes> Study<'_, S> {
    fn derivative(&self, parameter: &Parameter, stream: u32) -> Result<Option<ParameterDerivative>, S::Failure> {
        let file = self.capture.camera_file();
        let part = match &parameter.kind {
            Kind::Part(part) => Some(
                MovingPart::find(&self.scene, part, file.camera.scene_unit_m())
                    .map_err(|error| self.scenes.invalid(vec![error]))?,
            ),
            _ => None,
        };
        let (step, motion) = match &part {
            Some(part) => (part.step(parameter, &file.camera)?, part.motion()),
            None => (parameter.step(file, self.distance_m())?, motion(&parameter.kind)),
        };
        let side = |amount: f64| self.side(parameter, part.as_ref(), amount);
        let is_linear = matches!(parameter.kind, Kind::LedIntensity(_) | Kind::ExposureTime);
        let (below, above) = (side(-step)?, side(step)?);
        let far = if is_linear { None } else { Some([side(-2.0 * step)?, side(2.0 * step)?]) };
        let exposer = |side| Side::exposer(side, &self.center);
        let far = far.as_ref().map(|[below, above]| [exposer(below), exposer(above)]);
        let [center, below, above] = [&self.center, &below, &above].map(exposer);
        let sides = ParameterStep { center, below, above, far, step, motion: &motion, stream };
        let derivative = sides.derivative(DerivativeSamples::ToError(self.error), self.progress);
        Ok(derivative.map(|derivative| ParameterDerivative { parameter: parameter.clone(), step, derivative }))
    }

    /// Distance of what the camera sees on its axis, metres.
    fn distance_m(&self) -> f64 {
        let camera = self.center.rays.camera();
        let unit = camera.scene_unit_m();
        let ray = Ray::new(camera.position_m() / unit, camera.direction());
        let mut worker = self.center.exposer(&self.center).renderer.worker();
        let hit = ray.and_then(|ray| worker.trace(0, &ray).first_hit);
        hit.map(|hit| hit.distance * unit).filter(|distance| distance.is_finite()).unwrap_or(USUAL_DISTANCE_M)
    }

    /// Scene and camera with the parameter changed by an amount.
    fn side(&self, parameter: &Parameter, part: Option<&MovingPart<'_>>, amount: f64) -> Result<Side, S::Failure> {
        let lead = self.capture.camera_file();
        let file = parameter.changed(lead, amount)?;
        let ring = |file: &CameraFile| file.rig.as_ref().map(|rig| rig.scene_text());
        let scene = match part {
            Some(part) => Some(self.placed(&part.moved(amount))?),
            None if ring(&file) == ring(lead) => None,
            None => Some(self.scenes.read(&file)?),
        };
        let options = self.capture.options().clone();
        let renderer = scene.map(|scene| self.scenes.plan(scene, options).map(Renderer::new)).transpose()?;
        let plan = renderer.as_ref().map_or(self.center.plan(), Renderer::plan);
        let weights = band_weights(&file, plan)?;
        Ok(Side { renderer, rays: Rays::new(&file.camera, 1, self.capture.options().seed), weights })
    }

    fn placed(&self, moved: &PartMove) -> Result<ValidScene, S::Failure> {
        let mut scene = Scene::clone(&self.scene);
        move_parts(&mut scene, std::slice::from_ref(moved)).map_err(|error| self.scenes.invalid(vec![error]))?;
        scene.validate().map(|valid| valid.scene).map_err(|errors| self.scenes.invalid(errors))
    }
}

/// How a parameter that is no part's moves the picture.
fn motion(kind: &Kind) -> Motion {
    match kind {
        Kind::LedIntensity(_) | Kind::RingDiameter | Kind::ExposureTime => Motion::Still,
        Kind::Part(_) | Kind::Distance | Kind::PinholeDiameter | Kind::FocalDistance => Motion::Camera,
    }
}
