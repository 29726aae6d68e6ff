//! A simulated sensor under uniform illumination.

use crate::characterise::Device;
use crate::{Emva1288, emva1288::FixedPattern};

/// A specimen of a simulated sensor under uniform illumination, as a [`Device`].
#[derive(Clone, Debug)]
pub struct EvenLight {
    sensor: Emva1288,
    pixels: [u32; 2],
    pattern: FixedPattern,
}

impl EvenLight {
    /// A sensor with this number of columns and rows.
    #[must_use]
    pub fn new(sensor: Emva1288, pixels: [u32; 2]) -> EvenLight {
        let pattern = sensor.fixed_pattern(u64::from(pixels[0]) * u64::from(pixels[1]));
        EvenLight { sensor, pixels, pattern }
    }
}

impl Device for EvenLight {
    fn pixels(&self) -> [u32; 2] {
        self.pixels
    }

    fn exposure_s(&self) -> f64 {
        self.sensor.description().exposure_s
    }

    fn largest_grey(&self) -> u16 {
        self.sensor.bits().largest()
    }

    fn picture(&self, photons: f64, exposure_s: f64, seed: u64) -> Vec<u16> {
        // The method never uses a time that is not positive, and such a time would leave the sensor
        // unchanged.
        let sensor = self.sensor.with_exposure_s(exposure_s).unwrap_or(self.sensor);
        sensor.even_picture(photons / sensor.photons_per_exposure(), seed, &self.pattern)
    }
}
