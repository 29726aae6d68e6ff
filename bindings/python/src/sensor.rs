//! Sensors and their calibration.

use crate::array_argument::{array_argument, wrong_shape};
use crate::errors::{RadsightError, exception, wrong};
use crate::whole_argument;
use numpy::ndarray::{Ix1, IxDyn};
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use radsight_sensor::{Estimate, ExposureUnit, calibrate as fitted};

/// The sensor of a camera file; `Capture.sensor` gives it.
#[pyclass(frozen, module = "radsight")]
pub(crate) struct Sensor(pub(crate) radsight_sensor::Sensor);

#[pymethods]
impl Sensor {
    /// Grey values of exposures.
    ///
    /// Parameters
    /// ----------
    /// exposure_j_per_m2 : array of float
    ///     J/m², of any shape; pixels count in its order.
    /// seed : int
    ///     Chooses the noise.
    ///
    /// Returns
    /// -------
    /// array of uint16
    ///     Of the same shape.
    ///
    /// Raises
    /// ------
    /// RadsightError
    ///     If an exposure is not finite or below 0.
    #[pyo3(signature = (exposure_j_per_m2, *, seed=0))]
    fn grey<'py>(
        &self,
        py: Python<'py>,
        exposure_j_per_m2: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = whole_argument::seed)] seed: u64,
    ) -> PyResult<Bound<'py, PyArrayDyn<u16>>> {
        let exposures = array_argument::<IxDyn>("exposure_j_per_m2", exposure_j_per_m2, "(…)")?;
        let exposures = exposures.as_array();
        let shape = exposures.shape().to_vec();
        // A copy: another thread may change the array meanwhile.
        let exposures: Vec<f64> = exposures.iter().copied().collect();
        radsight_sensor::Sensor::check_exposures(exposures.iter().copied())
            .map_err(|error| RadsightError::new_err(error.to_string()))?;
        let greys = py.detach(|| self.0.greys(&exposures, seed));
        PyArray1::from_vec(py, greys).reshape(shape)
    }

    /// Bits of a grey value.
    #[getter]
    fn bits(&self) -> u8 {
        self.0.bits().bits()
    }

    /// The largest grey value.
    #[getter]
    fn largest(&self) -> u16 {
        self.0.bits().largest()
    }
}

impl Sensor {
    pub(crate) fn of(capture: &radsight::Capture) -> PyResult<Sensor> {
        let sensor = capture.camera_file().sensor.clone();
        sensor.map(Sensor).ok_or_else(|| exception(radsight::Error::NoSensor))
    }
}

/// A sensor fitted to measured pairs: ``G = k E^gamma + grey_background``, up to ``grey_max``.
#[pyclass(frozen, module = "radsight", get_all)]
pub(crate) struct Calibration {
    /// Grey levels at 1 unit of exposure.
    k: f64,
    /// Exponent of the response.
    gamma: f64,
    /// Grey levels without light.
    grey_background: f64,
    /// ``None`` where the data do not reach saturation.
    grey_max: Option<f64>,
    /// Root mean square of the residuals, grey levels.
    rms_residual: f64,
    /// Points taken as saturated.
    saturated: usize,
    /// The unit of exposure to which ``k`` belongs.
    unit: String,
    /// Interval of 99 % confidence of ``k``: (low, high).
    k_interval: (f64, f64),
    /// Interval of 99 % confidence of ``gamma``: (low, high).
    gamma_interval: (f64, f64),
    /// Interval of 99 % confidence of ``grey_background``: (low, high).
    grey_background_interval: (f64, f64),
}

/// Fit K, gamma, G0 and Gmax to measured pairs.
///
/// Parameters
/// ----------
/// exposure : (n,) array of float
///     In ``unit``.
/// grey : (n,) array of float
///     Grey levels.
/// unit : str
///     Such as ``uJ/cm2`` or ``J/m2``.
///
/// Returns
/// -------
/// Calibration
///     The fitted numbers with their intervals.
///
/// Raises
/// ------
/// RadsightError
///     If the unit is unknown, lengths differ, or the pairs do not determine the numbers.
///
/// Examples
/// --------
/// >>> import numpy as np, radsight
/// >>> exposure = np.linspace(0.001, 0.01, 20)
/// >>> fit = radsight.calibrate(exposure, 12 + 3000 * exposure**0.85)
/// >>> round(fit.gamma, 3), round(fit.k)
/// (0.85, 3000)
#[pyfunction]
#[pyo3(signature = (exposure, grey, *, unit="uJ/cm2"))]
pub(crate) fn calibrate(exposure: &Bound<'_, PyAny>, grey: &Bound<'_, PyAny>, unit: &str) -> PyResult<Calibration> {
    let of_unit = ExposureUnit::from_name(unit).ok_or_else(|| wrong("unit", unit, "uJ/cm2, J/m2, …"))?;
    let exposure = array_argument::<Ix1>("exposure", exposure, "(n,)")?;
    let shape = format!("({},), that of exposure", exposure.len()?);
    let grey = array_argument::<Ix1>("grey", grey, &shape)?;
    let (exposure, grey) = (exposure.as_array(), grey.as_array());
    if exposure.len() != grey.len() {
        return Err(wrong_shape("grey", grey.shape(), &shape));
    }
    let pair = |(exposure, grey): (&f64, &f64)| fitted::Measurement { exposure: *exposure, grey: *grey };
    let pairs: Vec<fitted::Measurement> = exposure.iter().zip(grey).map(pair).collect();
    let fit = fitted::calibrate(&pairs, of_unit).map_err(|error| RadsightError::new_err(error.to_string()))?;
    let interval = |estimate: &Estimate| (estimate.low, estimate.high);
    Ok(Calibration {
        k: fit.k,
        gamma: fit.gamma,
        grey_background: fit.grey_background,
        grey_max: fit.grey_max,
        rms_residual: fit.rms_residual,
        saturated: fit.saturated,
        unit: of_unit.name().to_owned(),
        k_interval: interval(&fit.intervals.k),
        gamma_interval: interval(&fit.intervals.gamma),
        grey_background_interval: interval(&fit.intervals.grey_background),
    })
}
