//! Derivatives of exposures.

mod engine;
mod fisher;
mod parameter;
mod part;

pub use engine::{ExposureDerivatives, ParameterDerivative, expose_derivatives};
pub use fisher::FisherInformation;
pub use parameter::Parameter;

use crate::capture::Capture;
use crate::capture_series::BuiltScenes;
use crate::error::Error;
use crate::scene::SceneBuilder;
use radsight_capture::{Progress, Silent};

/// Differentiates captures by the pose of parts, the light ring and the camera.
///
/// Outlines and shadow edges are part of the derivatives. Each has a standard error per pixel, and
/// an estimate of the error of its finite step; `docs/derivatives.md` describes the method.
///
/// ```
/// use radsight::{Capture, CaptureDerivatives, MemoryLoader, Parameter, Scene};
/// # fn main() -> Result<(), radsight::Error> {
/// # let camera = b"[camera]\nposition_m = [0, 0, 0.5]\ndirection = [0, 0, -1]\nup = [0, 1, 0]\npixels = [12, 10]\npixel_pitch_um = [200, 200]
/// # focal_distance_mm = 6.75\npinhole_diameter_mm = 0.1\nexposure_ms = 10\n";
/// let capture = Capture::from_text("camera.toml", camera, &MemoryLoader::default())?.error(0.02);
/// let scene = "void glow white 0 0 4 1 1 1 0 white ring disk 0 0 8 .01 0 0 0 0 1 0 .03";
/// let parameters = ["disk.x".parse::<Parameter>()?, "pinhole.diameter".parse()?];
/// let derivatives = CaptureDerivatives::new(Scene::builder().text("disk.rad", scene));
/// let exposed = derivatives.expose(&capture, &parameters, 0.05)?;
/// // The disk moves across the picture without a change of its total light.
/// let by_x = &exposed.derivatives[0].derivative;
/// let size = by_x.values.iter().map(|value| value.abs()).sum::<f64>();
/// assert!(by_x.values.iter().sum::<f64>().abs() < 0.05 * size);
/// # Ok(())
/// # }
/// ```
pub struct CaptureDerivatives<'l> {
    scene: SceneBuilder<'l>,
}

impl<'l> CaptureDerivatives<'l> {
    /// For a scene without a light ring; the ring of the camera file is added.
    #[must_use]
    pub fn new(scene: SceneBuilder<'l>) -> CaptureDerivatives<'l> {
        CaptureDerivatives { scene }
    }

    /// Exposes a capture and differentiates it by parameters, until the rms of the standard errors
    /// of each derivative is `error` times the rms of the derivative.
    ///
    /// # Errors
    /// As [`Capture::expose`], [`Error::Parameter`] for a parameter that this capture does not
    /// have, and [`Error::Scene`] for a part that cannot be moved.
    pub fn expose(
        &self,
        capture: &Capture,
        parameters: &[Parameter],
        error: f64,
    ) -> Result<ExposureDerivatives, Error> {
        let exposed = self.expose_with_progress(capture, parameters, error, &Silent)?;
        Ok(exposed.expect("nobody stops it"))
    }

    /// The same with progress reports. `progress` can stop the work; the result is then `None`.
    ///
    /// # Errors
    /// As [`CaptureDerivatives::expose`].
    pub fn expose_with_progress(
        &self,
        capture: &Capture,
        parameters: &[Parameter],
        error: f64,
        progress: &dyn Progress,
    ) -> Result<Option<ExposureDerivatives>, Error> {
        expose_derivatives(&BuiltScenes::new(&self.scene), capture, parameters, error, progress)
    }
}
