//! Conversion of exposure to grey values: the paper's power law, a linear sensor after EMVA 1288,
//! its characterisation, and calibration.
//!
//! Exposure is energy per area on a pixel, J/m². A [`Sensor`] converts it to a grey value, which is
//! saturated and then rounded once: half away from zero, between 0 and the largest value of the bit
//! depth.
//!
//! Guarantees: a [`PowerLaw`] or [`Emva1288`] holds only finite values within their ranges; the
//! grey value is a function of (exposure, seed, pixel) only. The crate does not know where the
//! exposure came from, and does no input or output.
//!
//! ```
//! use radsight_sensor::{BitDepth, ExposureUnit, PowerLaw, PowerLawDescription};
//! let sensor = PowerLaw::new(&PowerLawDescription {
//!     k: 33844.0,
//!     gamma: 0.85,
//!     grey_background: 12.0,
//!     grey_max: 161.0,
//!     exposure_unit: ExposureUnit::MicrojoulePerSquareCentimetre,
//!     bits: BitDepth::EIGHT,
//! })?;
//! assert_eq!(sensor.grey(0.0), 12);
//! assert_eq!(sensor.grey(1e-6), 25); // 33844·(1e-4)^0.85 + 12 = 25.47
//! assert_eq!(sensor.grey(1.0), 161);
//! # Ok::<(), radsight_sensor::SensorError>(())
//! ```
#![forbid(unsafe_code)]

mod bit_depth;
pub mod calibrate;
pub mod characterise;
mod emva1288;
mod error;
mod even_light;
mod exposure_unit;
mod grey_statistics;
mod interval;
mod mosaic;
mod non_uniformity;
pub mod plot;
mod power_law;
mod preset;
mod quantum_efficiency;

pub use bit_depth::BitDepth;
pub use emva1288::{Emva1288, Emva1288Description, FixedPattern};
pub use error::SensorError;
pub use even_light::EvenLight;
pub use exposure_unit::ExposureUnit;
pub use grey_statistics::GreyStatistics;
pub use interval::{CONFIDENCE, Estimate};
pub use mosaic::{Bayer, Demosaic};
pub use non_uniformity::{NonUniformity, SpatialDeviation};
pub use power_law::{PowerLaw, PowerLawDescription};
pub use preset::Preset;
pub use quantum_efficiency::{QuantumEfficiencyTable, dark_current_at};

/// A sensor of a camera file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Sensor {
    /// Eq. 5 of the paper, without noise.
    PowerLaw(PowerLaw),
    /// A linear sensor with photon and read noise.
    Emva1288(Emva1288),
}

impl Sensor {
    /// Grey value of pixel number `pixel` at `exposure` J/m². `seed` matters only for a sensor with
    /// noise.
    #[must_use]
    pub fn grey(&self, exposure: f64, seed: u64, pixel: u64) -> u16 {
        match self {
            Sensor::PowerLaw(sensor) => sensor.grey(exposure),
            Sensor::Emva1288(sensor) => sensor.grey(exposure, seed, pixel),
        }
    }

    /// Grey values of a picture's exposures (J/m²), from pixel 0. They must be finite and at least 0, as
    /// [`Sensor::check_exposures`] checks.
    #[must_use]
    pub fn greys(&self, exposures: &[f64], seed: u64) -> Vec<u16> {
        (0..).zip(exposures).map(|(pixel, &exposure)| self.grey(exposure, seed, pixel)).collect()
    }

    /// Checks exposures that come from outside before they become grey values.
    ///
    /// # Errors
    /// [`SensorError::Exposure`] for the first that is not finite or below 0.
    ///
    /// ```
    /// use radsight_sensor::Sensor;
    /// assert!(Sensor::check_exposures([0.0, 1e-6]).is_ok());
    /// let error = Sensor::check_exposures([0.0, f64::NAN]).unwrap_err();
    /// assert_eq!(error.to_string(), "the exposure has the value NaN, expected finite values of at least 0 (J/m²)");
    /// ```
    pub fn check_exposures<T>(exposures: impl IntoIterator<Item = T>) -> Result<(), SensorError>
    where
        T: Copy + Into<f64> + std::fmt::Display,
    {
        let is_wrong = |value: &T| {
            let value: f64 = (*value).into();
            !(value.is_finite() && value >= 0.0)
        };
        match exposures.into_iter().find(is_wrong) {
            Some(value) => Err(SensorError::Exposure { value: value.to_string() }),
            None => Ok(()),
        }
    }

    /// The same sensor with another number of pixels per row, which determines each pixel's row and column
    /// and so its non-uniformity.
    #[must_use]
    pub fn with_columns(self, columns: u32) -> Sensor {
        match self {
            Sensor::PowerLaw(_) => self,
            Sensor::Emva1288(sensor) => Sensor::Emva1288(sensor.with_columns(columns)),
        }
    }

    /// The exposure whose electrons are those of the dark current in one second, J/m² per second.
    #[must_use]
    pub fn dark_exposure_per_s(&self) -> f64 {
        match self {
            Sensor::PowerLaw(_) => 0.0,
            Sensor::Emva1288(sensor) => {
                let description = sensor.description();
                description.dark_current_e_per_s * description.gain_dn_per_e / sensor.grey_per_exposure()
            }
        }
    }

    /// Bit depth of the grey values.
    #[must_use]
    pub fn bits(&self) -> BitDepth {
        match self {
            Sensor::PowerLaw(sensor) => sensor.bits(),
            Sensor::Emva1288(sensor) => sensor.bits(),
        }
    }
}
