//! Derivatives of captures, and the Fisher information of a picture about parameters.

use crate::array_view::array_view;
use crate::capture::Capture;
use crate::errors::exception;
use crate::scene::{Scene, scene_builder};
use crate::supervise::{Watch, stopped, supervised};
use numpy::{PyArray1, PyArray2, PyArray3};
use pyo3::prelude::*;
use radsight::Parameter;

/// Differentiates captures by the pose of parts, the light ring and the camera. Outlines and shadow edges are part of the derivatives.
///
/// Parameters
/// ----------
/// scene : Scene
///     Without a light ring: each camera's own is added.
///
/// Examples
/// --------
/// >>> import radsight
/// >>> camera = radsight.Capture.from_text('''[camera]
/// ... position_m = [0, 0, 0.5]
/// ... direction = [0, 0, -1]
/// ... up = [0, 1, 0]
/// ... pixels = [12, 10]
/// ... pixel_pitch_um = [200, 200]
/// ... focal_distance_mm = 6.75
/// ... pinhole_diameter_mm = 0.1
/// ... exposure_ms = 10
/// ... ''', error=0.02)
/// >>> scene = radsight.Scene.from_text("void glow white 0 0 4 1 1 1 0 white ring disk 0 0 8 .01 0 0 0 0 1 0 .03")
/// >>> exposed = radsight.CaptureDerivatives(scene).expose(camera, ["disk.x", "exposure.time"], error=0.05)
/// >>> exposed.units
/// ['m', 's']
/// >>> by_x, by_time = exposed.derivative_j_per_m2_per_unit
/// >>> bool(abs(by_x.sum()) < 0.05 * abs(by_x).sum())  # The disk moves without a change of its light.
/// True
#[pyclass(frozen, module = "radsight")]
pub(crate) struct CaptureDerivatives {
    scene: Py<Scene>,
}

#[pymethods]
impl CaptureDerivatives {
    #[new]
    fn new(scene: Py<Scene>) -> CaptureDerivatives {
        CaptureDerivatives { scene }
    }

    /// Expose a capture and differentiate it.
    ///
    /// Parameters
    /// ----------
    /// capture : Capture
    ///     The camera; its error or samples are those of the exposure itself.
    /// parameters : sequence of str
    ///     ``NAME.x``, ``.y``, ``.z`` (position of the surfaces ``NAME``, a final ``*`` matches any ending), ``NAME.rx``, ``.ry``,
    ///     ``.rz`` (rotation about the centre of their bounding box), ``led.intensity``, ``led[K].intensity``, ``ring.diameter``,
    ///     ``distance``, ``pinhole.diameter``, ``focal.distance``, ``exposure.time``.
    /// error : float
    ///     Requested error of a derivative: rms of its standard errors over the picture, relative to the rms of the derivative.
    /// progress : callable, optional
    ///     Called with the share of the current derivative that is done.
    ///
    /// Returns
    /// -------
    /// ExposureDerivatives
    ///     The exposure and its derivatives.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     If a part is not in the scene, or cannot be moved.
    /// RadsightError
    ///     For a parameter that this capture does not have.
    #[pyo3(signature = (capture, parameters, *, error=0.01, progress=None))]
    fn expose(
        &self,
        py: Python<'_>,
        capture: Py<Capture>,
        parameters: Vec<String>,
        error: f64,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<ExposureDerivatives> {
        let parameters: Vec<Parameter> =
            parameters.iter().map(|name| name.parse()).collect::<Result<_, _>>().map_err(exception)?;
        let scene = self.scene.get();
        let camera = capture.get();
        let (models, files) = (scene.models(py)?, scene.loader());
        let exposed = supervised(py, scene.threads(camera.threads), progress, &scene.raised, |watch: &Watch| {
            let derivatives = radsight::CaptureDerivatives::new(scene_builder(&scene.texts, files, models));
            derivatives.expose_with_progress(&camera.capture, &parameters, error, watch)
        })?;
        let exposed = exposed.map_err(exception)?.ok_or_else(stopped)?;
        Ok(ExposureDerivatives::new(exposed, camera.capture.clone()))
    }

    fn __repr__(&self) -> String {
        "<radsight.CaptureDerivatives>".to_owned()
    }
}

/// An exposure and its derivatives by parameters.
#[pyclass(frozen, module = "radsight")]
pub(crate) struct ExposureDerivatives {
    exposed: radsight::ExposureDerivatives,
    capture: radsight::Capture,
    /// Of all parameters, one after the other.
    values: Vec<f64>,
    standard_errors: Vec<f64>,
}

impl ExposureDerivatives {
    fn new(exposed: radsight::ExposureDerivatives, capture: radsight::Capture) -> ExposureDerivatives {
        let derivatives = || exposed.derivatives.iter().map(|by| &by.derivative);
        let values = derivatives().flat_map(|derivative| &derivative.values).copied().collect();
        let standard_errors = derivatives().flat_map(|derivative| &derivative.standard_errors).copied().collect();
        ExposureDerivatives { exposed, capture, values, standard_errors }
    }

    /// Rows and columns.
    fn shape(&self) -> [usize; 2] {
        let camera = &self.capture.camera_file().camera;
        [camera.rows() as usize, camera.columns() as usize]
    }

    /// Parameters, rows and columns.
    fn shape_of_all(&self) -> [usize; 3] {
        let [rows, columns] = self.shape();
        [self.exposed.derivatives.len(), rows, columns]
    }
}

#[pymethods]
impl ExposureDerivatives {
    /// Names of the parameters.
    #[getter]
    fn parameters(&self) -> Vec<&str> {
        self.exposed.derivatives.iter().map(|by| by.parameter.name()).collect()
    }

    /// Units of the parameters: ``"m"``, ``"degree"``, ``"W/sr"`` or ``"s"``.
    #[getter]
    fn units(&self) -> Vec<&'static str> {
        self.exposed.derivatives.iter().map(|by| by.parameter.unit()).collect()
    }

    /// Exposure of each pixel, J/m²: (rows, columns), a read-only view.
    #[getter]
    fn exposure_j_per_m2<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        array_view(slf, slf.get().shape(), |this| &this.exposed.exposure.values)
    }

    /// Derivatives, J/m² per unit of each parameter: (parameters, rows, columns), a read-only view.
    #[getter]
    fn derivative_j_per_m2_per_unit<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        array_view(slf, slf.get().shape_of_all(), |this| &this.values)
    }

    /// Standard errors of the derivatives, J/m² per unit of each parameter: (parameters, rows, columns), a read-only view.
    #[getter]
    fn standard_error_j_per_m2_per_unit<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        array_view(slf, slf.get().shape_of_all(), |this| &this.standard_errors)
    }

    /// Rms of the standard errors of each derivative, as a share of its rms.
    #[getter]
    fn relative_error(&self) -> Vec<f64> {
        self.exposed.derivatives.iter().map(|by| by.derivative.relative_error).collect()
    }

    /// Estimated rms error of each derivative by its finite step, as a share of its rms.
    #[getter]
    fn step_error(&self) -> Vec<f64> {
        self.exposed.derivatives.iter().map(|by| by.derivative.step_error).collect()
    }

    /// Step of the central differences, in the unit of each parameter.
    #[getter]
    fn step(&self) -> Vec<f64> {
        self.exposed.derivatives.iter().map(|by| by.step).collect()
    }

    /// Rays that were traced for each derivative.
    #[getter]
    fn rays(&self) -> Vec<u64> {
        self.exposed.derivatives.iter().map(|by| by.derivative.rays).collect()
    }

    /// How precisely the sensor's picture determines the parameters.
    ///
    /// Returns
    /// -------
    /// FisherInformation
    ///     Of the grey values of all pixels together.
    ///
    /// Raises
    /// ------
    /// RadsightError
    ///     If the camera file has no sensor.
    fn fisher_information(&self) -> PyResult<FisherInformation> {
        let sensor = self.capture.camera_file().sensor.as_ref();
        radsight::FisherInformation::new(&self.exposed, sensor).map(FisherInformation).map_err(exception)
    }

    fn __repr__(&self) -> String {
        format!("<radsight.ExposureDerivatives by {}>", self.parameters().join(", "))
    }
}

/// The Fisher information of one picture about parameters.
///
/// F_ij = Σ ∂μ/∂θ_i ∂μ/∂θ_j / σ² over the pixels, with mean μ and variance σ² of the grey value.
#[pyclass(frozen, module = "radsight")]
pub(crate) struct FisherInformation(radsight::FisherInformation);

#[pymethods]
impl FisherInformation {
    /// Names of the parameters.
    #[getter]
    fn parameters(&self) -> Vec<String> {
        self.0.parameters.clone()
    }

    /// Units of the parameters.
    #[getter]
    fn units(&self) -> Vec<&'static str> {
        self.0.units.clone()
    }

    /// F, per units of the parameters: (parameters, parameters).
    #[getter]
    fn matrix<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        Ok(PyArray2::from_vec2(py, &self.0.matrix)?)
    }

    /// Smallest possible standard deviation of each parameter if all others are known, in its unit.
    ///
    /// Infinite where the picture does not depend on it.
    #[getter]
    fn deviations_alone<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.0.deviations_alone)
    }

    /// The same if all parameters are estimated together (Cramér and Rao); ``None`` if the picture does not tell them apart.
    #[getter]
    fn deviations_together<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.0.deviations_together.as_ref().map(|deviations| PyArray1::from_slice(py, deviations))
    }

    fn __repr__(&self) -> String {
        format!("<radsight.FisherInformation about {}>", self.0.parameters.join(", "))
    }
}
