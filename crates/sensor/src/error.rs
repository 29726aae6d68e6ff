//! What is wrong with a sensor's description.

/// A sensor that cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SensorError {
    /// A quantity outside its range.
    #[error("{quantity} must be {expected}, not {value}")]
    OutOfRange {
        /// Which, as the camera file calls it.
        quantity: &'static str,
        /// The range in words.
        expected: &'static str,
        /// The value found.
        value: f64,
    },
    /// A saturation level that the bits cannot hold.
    #[error("grey_max {grey_max} does not fit in {bits} bits: the largest grey value is {largest}")]
    TooBright {
        /// The level.
        grey_max: f64,
        /// The width.
        bits: u8,
        /// The largest grey value of that width.
        largest: u16,
    },
    /// A picture without contrast.
    #[error("grey_max {grey_max} must be above grey_background {grey_background}")]
    NoRange {
        /// The saturation level.
        grey_max: f64,
        /// The level without light.
        grey_background: f64,
    },
    /// A wavelength that a table does not reach.
    #[error("the quantum efficiency is known from {first_nm} to {last_nm} nm, not at {wavelength_nm} nm")]
    OutsideTable {
        /// The wavelength asked for.
        wavelength_nm: f64,
        /// The first of the table.
        first_nm: f64,
        /// The last of the table.
        last_nm: f64,
    },
    /// A width that no picture has.
    #[error("bits must be 8, 10, 12, 14 or 16, not {bits}")]
    Bits {
        /// The width found.
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
