//! Errors in a sensor's description.

/// Why a sensor is impossible.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SensorError {
    /// A quantity is out of range.
    #[error("{quantity} must be {expected}, not {value}")]
    OutOfRange {
        /// Name of the quantity in a camera file.
        quantity: &'static str,
        /// The valid range, as text.
        expected: &'static str,
        /// The given value.
        value: f64,
    },
    /// The saturation level does not fit in the bits.
    #[error("grey_max {grey_max} does not fit in {bits} bits: the largest grey value is {largest}")]
    TooBright {
        /// The saturation level.
        grey_max: f64,
        /// The bit depth.
        bits: u8,
        /// The largest grey value of that bit depth.
        largest: u16,
    },
    /// The saturation level is not above the background.
    #[error("grey_max {grey_max} must be above grey_background {grey_background}")]
    NoRange {
        /// The saturation level.
        grey_max: f64,
        /// The grey level without light.
        grey_background: f64,
    },
    /// The wavelength is outside the table.
    #[error("the quantum efficiency is known from {first_nm} to {last_nm} nm, not at {wavelength_nm} nm")]
    OutsideTable {
        /// The wavelength.
        wavelength_nm: f64,
        /// First wavelength of the table.
        first_nm: f64,
        /// Last wavelength of the table.
        last_nm: f64,
    },
    /// An exposure that no pixel can have.
    #[error("the exposure has the value {value}, expected finite values of at least 0 (J/m²)")]
    Exposure {
        /// The value as text.
        value: String,
    },
    /// The bit depth is not supported.
    #[error("bits must be 8, 10, 12, 14 or 16, not {bits}")]
    Bits {
        /// The given number of bits.
        bits: i64,
    },
}

pub(crate) fn positive(quantity: &'static str, value: f64) -> Result<f64, SensorError> {
    within(quantity, value, "positive and finite", |value| value > 0.0)
}

pub(crate) fn not_negative(quantity: &'static str, value: f64) -> Result<f64, SensorError> {
    within(quantity, value, "at least 0 and finite", |value| value >= 0.0)
}

pub(crate) fn within(
    quantity: &'static str,
    value: f64,
    expected: &'static str,
    holds: impl Fn(f64) -> bool,
) -> Result<f64, SensorError> {
    if value.is_finite() && holds(value) {
        Ok(value)
    } else {
        Err(SensorError::OutOfRange { quantity, expected, value })
    }
}
