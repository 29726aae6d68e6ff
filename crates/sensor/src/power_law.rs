//! Eq. 5 of the paper: `G = K·E^γ + G₀` up to `G_max`.

use crate::error::{not_negative, positive};
use crate::{BitDepth, ExposureUnit, SensorError};

/// Parameters of a power-law sensor; [`PowerLaw::new`] checks them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerLawDescription {
    /// K: grey levels above the background at an exposure of 1 `exposure_unit`.
    pub k: f64,
    /// γ, dimensionless.
    pub gamma: f64,
    /// G₀, the grey level without light.
    pub grey_background: f64,
    /// G_max, the grey level at saturation.
    pub grey_max: f64,
    /// Unit of E.
    pub exposure_unit: ExposureUnit,
    /// Bit depth of the grey values.
    pub bits: BitDepth,
}

/// A checked power-law sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerLaw(PowerLawDescription);

impl PowerLaw {
    /// Checks the parameters.
    ///
    /// # Errors
    /// The first quantity that is out of range.
    pub fn new(description: &PowerLawDescription) -> Result<Self, SensorError> {
        positive("k", description.k)?;
        positive("gamma", description.gamma)?;
        let grey_background = not_negative("grey_background", description.grey_background)?;
        let grey_max = positive("grey_max", description.grey_max)?;
        if grey_max <= grey_background {
            return Err(SensorError::NoRange { grey_max, grey_background });
        }
        let largest = description.bits.largest();
        if grey_max > f64::from(largest) {
            return Err(SensorError::TooBright { grey_max, bits: description.bits.bits(), largest });
        }
        Ok(PowerLaw(*description))
    }

    /// Parameters of the sensor.
    #[must_use]
    pub fn description(&self) -> &PowerLawDescription {
        &self.0
    }

    /// Bit depth of the grey values.
    #[must_use]
    pub fn bits(&self) -> BitDepth {
        self.0.bits
    }

    /// Eq. 5, saturated, before rounding. An exposure (J/m²) of 0 or less, or NaN, gives the
    /// background.
    #[must_use]
    pub fn exact_grey(&self, exposure: f64) -> f64 {
        let description = &self.0;
        let energy = (exposure * description.exposure_unit.per_joule_per_square_metre()).max(0.0);
        (description.k * energy.powf(description.gamma) + description.grey_background).min(description.grey_max)
    }

    /// Derivative of Eq. 5 by the exposure, grey levels per J/m²: 0 at saturation and without light.
    #[must_use]
    pub fn grey_slope(&self, exposure: f64) -> f64 {
        let description = &self.0;
        if exposure > 0.0 && exposure < self.saturation_exposure() {
            let grey = self.exact_grey(exposure) - description.grey_background;
            description.gamma * grey / exposure
        } else {
            0.0
        }
    }

    /// Eq. 5, saturated and rounded.
    #[must_use]
    pub fn grey(&self, exposure: f64) -> u16 {
        self.0.bits.quantise(self.exact_grey(exposure))
    }

    /// Exposure (J/m²) at which the sensor saturates: `E_sat = ((G_max − G₀)/K)^(1/γ)`.
    #[must_use]
    pub fn saturation_exposure(&self) -> f64 {
        let description = &self.0;
        let energy =
            ((description.grey_max - description.grey_background) / description.k).powf(description.gamma.recip());
        energy / description.exposure_unit.per_joule_per_square_metre()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paper() -> PowerLawDescription {
        PowerLawDescription {
            k: 33844.0,
            gamma: 0.85,
            grey_background: 12.0,
            grey_max: 161.0,
            exposure_unit: ExposureUnit::MicrojoulePerSquareCentimetre,
            bits: BitDepth::EIGHT,
        }
    }

    #[test]
    fn hand_numbers_of_equation_5() {
        let sensor = PowerLaw::new(&paper()).unwrap();
        // 1e-5 J/m² are 1e-3 µJ/cm²: 33844·10^(−2.55) + 12 = 33844·0.0028184 + 12.
        assert!((sensor.exact_grey(1e-5) - 107.385).abs() < 1e-3, "{}", sensor.exact_grey(1e-5));
        assert_eq!(sensor.exact_grey(0.0), 12.0);
        assert_eq!((sensor.exact_grey(-1.0), sensor.exact_grey(f64::NAN)), (12.0, 12.0));
        assert_eq!(sensor.exact_grey(f64::INFINITY), 161.0);
    }

    #[test]
    fn saturation_begins_at_the_saturation_exposure() {
        let sensor = PowerLaw::new(&paper()).unwrap();
        let edge = sensor.saturation_exposure();
        assert!((sensor.exact_grey(edge * 0.999) - 161.0).abs() < 0.2);
        assert!(sensor.exact_grey(edge * 0.999) < 161.0);
        assert_eq!(sensor.exact_grey(edge * 1.000001), 161.0);
    }

    #[test]
    fn impossible_sensors_are_rejected() {
        let message = |description: PowerLawDescription| PowerLaw::new(&description).unwrap_err().to_string();
        assert_eq!(message(PowerLawDescription { k: -1.0, ..paper() }), "k must be positive and finite, not -1");
        assert_eq!(
            message(PowerLawDescription { gamma: f64::NAN, ..paper() }),
            "gamma must be positive and finite, not NaN"
        );
        assert_eq!(
            message(PowerLawDescription { grey_max: 12.0, ..paper() }),
            "grey_max 12 must be above grey_background 12"
        );
        assert_eq!(
            message(PowerLawDescription { grey_max: 300.0, ..paper() }),
            "grey_max 300 does not fit in 8 bits: the largest grey value is 255"
        );
    }
}
