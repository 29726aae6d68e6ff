//! Mean, slope and variance of a pixel's grey value.

use crate::{Emva1288, PowerLaw, Sensor};

/// Variance of a rounded value, grey levels².
const ROUNDING: f64 = 1.0 / 12.0;

/// Statistics of the grey value of a pixel over repeated pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GreyStatistics {
    /// Grey levels, before rounding.
    pub mean: f64,
    /// Derivative of the mean by the exposure, grey levels per J/m²; 0 at saturation.
    pub slope: f64,
    /// Grey levels², rounding included. The fixed pattern of a specimen is not: it is the same in
    /// all pictures.
    pub variance: f64,
}

impl Sensor {
    /// Mean, slope and variance of the grey value at `exposure` J/m². A power-law sensor has no
    /// noise but its rounding.
    ///
    /// ```
    /// use radsight_sensor::{BitDepth, ExposureUnit, PowerLaw, PowerLawDescription, Sensor};
    /// # let description = PowerLawDescription { k: 100.0, gamma: 1.0, grey_background: 10.0, grey_max: 200.0,
    /// #     exposure_unit: ExposureUnit::JoulePerSquareMetre, bits: BitDepth::EIGHT };
    /// let sensor = Sensor::PowerLaw(PowerLaw::new(&description)?); // 10 + 100·E, up to 200
    /// let grey = sensor.grey_statistics(0.5);
    /// assert_eq!((grey.mean, grey.slope), (60.0, 100.0));
    /// assert_eq!(sensor.grey_statistics(2.0).slope, 0.0);
    /// # Ok::<(), radsight_sensor::SensorError>(())
    /// ```
    #[must_use]
    pub fn grey_statistics(&self, exposure: f64) -> GreyStatistics {
        match self {
            Sensor::PowerLaw(sensor) => of_power_law(sensor, exposure),
            Sensor::Emva1288(sensor) => of_linear(sensor, exposure),
        }
    }
}

fn of_power_law(sensor: &PowerLaw, exposure: f64) -> GreyStatistics {
    GreyStatistics { mean: sensor.exact_grey(exposure), slope: sensor.grey_slope(exposure), variance: ROUNDING }
}

/// The photon transfer line, EMVA 1288 release 4.0 (linear), Eq. 8.
fn of_linear(sensor: &Emva1288, exposure: f64) -> GreyStatistics {
    let description = sensor.description();
    let gain = description.gain_dn_per_e;
    let read_out = gain * gain * description.read_noise_e * description.read_noise_e;
    let electrons = sensor.mean_electrons(exposure);
    let largest = f64::from(sensor.bits().largest());
    let is_saturated = electrons >= description.full_well_e || description.dark_offset_dn + gain * electrons >= largest;
    let (slope, shot) = if is_saturated { (0.0, 0.0) } else { (sensor.grey_per_exposure(), gain * gain * electrons) };
    GreyStatistics { mean: sensor.exact_grey(exposure), slope, variance: read_out + ROUNDING + shot }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BitDepth, Emva1288Description, ExposureUnit, PowerLawDescription};

    #[test]
    fn mean_and_variance_are_those_of_many_pixels() {
        let sensor = Emva1288::new(&Emva1288Description {
            quantum_efficiency: 0.6,
            gain_dn_per_e: 0.25,
            dark_offset_dn: 60.0,
            dark_current_e_per_s: 500.0,
            read_noise_e: 12.0,
            full_well_e: 14_000.0,
            bits: BitDepth::new(12).unwrap(),
            pixel_area_m2: 5e-6 * 5e-6,
            wavelength_m: 532e-9,
            exposure_s: 0.02,
        })
        .unwrap();
        let exposure = 3000.0 / (sensor.grey_per_exposure() / 0.25);
        let sensor = Sensor::Emva1288(sensor);
        let greys: Vec<f64> = (0..40_000).map(|pixel| f64::from(sensor.grey(exposure, 11, pixel))).collect();
        let mean = greys.iter().sum::<f64>() / 4e4;
        let variance = greys.iter().map(|grey| (grey - mean).powi(2)).sum::<f64>() / 4e4;
        let grey = sensor.grey_statistics(exposure);
        assert!((mean - grey.mean).abs() < 4.0 * (grey.variance / 4e4).sqrt(), "{mean} against {}", grey.mean);
        assert!((variance / grey.variance - 1.0).abs() < 0.03, "{variance} against {}", grey.variance);
        let difference = sensor.grey_statistics(1.01 * exposure).mean - grey.mean;
        assert!((difference / (0.01 * exposure) / grey.slope - 1.0).abs() < 1e-9);
        assert_eq!(sensor.grey_statistics(1.0).slope, 0.0);
    }

    #[test]
    fn the_slope_of_a_power_law_is_its_derivative() {
        let description = PowerLawDescription {
            k: 33844.0,
            gamma: 0.85,
            grey_background: 12.0,
            grey_max: 161.0,
            exposure_unit: ExposureUnit::MicrojoulePerSquareCentimetre,
            bits: BitDepth::EIGHT,
        };
        let sensor = PowerLaw::new(&description).unwrap();
        let difference = (sensor.exact_grey(1.001e-6) - sensor.exact_grey(0.999e-6)) / 2e-9;
        assert!((sensor.grey_slope(1e-6) / difference - 1.0).abs() < 1e-5);
        assert_eq!((sensor.grey_slope(0.0), sensor.grey_slope(1.0)), (0.0, 0.0));
    }
}
