//! A linear sensor by the model of EMVA Standard 1288, release 4.0 (linear).
//!
//! Photons per pixel are `μ_p = A·E·λ/(h·c)`. Electrons are Poisson with mean `η·μ_p + I_d·t`, plus
//! Gaussian read noise of standard deviation `σ_d`, up to the full well. The grey value is
//! `y = y_dark + K·electrons`, rounded once. Mean and variance of the grey value then follow the
//! photon transfer line `σ_y² = K²σ_d² + 1/12 + K(μ_y − y_dark)`, by which the standard measures K.
//! A [`NonUniformity`] multiplies each pixel's photoelectrons (PRNU) and adds an offset to its
//! signal (DSNU).

use crate::error::{not_negative, positive, within};
use crate::{BitDepth, NonUniformity, SensorError};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Poisson, StandardNormal};

/// Planck's constant, J·s (exact in the SI).
const PLANCK: f64 = 6.626_070_15e-34;
/// The speed of light, m/s (exact in the SI).
const LIGHT_SPEED: f64 = 299_792_458.0;

/// Largest accepted full well, electrons.
const LARGEST_WELL: f64 = 1e9;

/// Parameters of a linear sensor; [`Emva1288::new`] checks them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emva1288Description {
    /// Quantum efficiency η at `wavelength_m`, electrons per photon, above 0 and at most 1.
    pub quantum_efficiency: f64,
    /// System gain K, grey levels per electron.
    pub gain_dn_per_e: f64,
    /// Dark grey level y_dark at zero exposure time.
    pub dark_offset_dn: f64,
    /// Dark current I_d, electrons per second.
    pub dark_current_e_per_s: f64,
    /// Standard deviation σ_d of the read noise, electrons.
    pub read_noise_e: f64,
    /// Full-well capacity, electrons.
    pub full_well_e: f64,
    /// Bit depth of the grey values.
    pub bits: BitDepth,
    /// A, area of a pixel, m².
    pub pixel_area_m2: f64,
    /// Wavelength λ, metres.
    pub wavelength_m: f64,
    /// Exposure time t, seconds.
    pub exposure_s: f64,
}

/// A checked linear sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emva1288 {
    description: Emva1288Description,
    electrons_per_exposure: f64,
    non_uniformity: Option<NonUniformity>,
}

/// Deviation of a single pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PixelPattern {
    response: f64,
    dark_offset_e: f64,
}

/// A pixel without deviation.
const EVEN: PixelPattern = PixelPattern { response: 1.0, dark_offset_e: 0.0 };

/// Deviations of all pixels of a specimen, for many pictures.
#[derive(Clone, Debug)]
pub struct FixedPattern(Vec<PixelPattern>);

impl Emva1288 {
    /// Checks the parameters.
    ///
    /// # Errors
    /// The first quantity that is out of range.
    pub fn new(description: &Emva1288Description) -> Result<Self, SensorError> {
        within("quantum_efficiency", description.quantum_efficiency, "above 0 and at most 1", |value| {
            value > 0.0 && value <= 1.0
        })?;
        positive("gain_dn_per_e", description.gain_dn_per_e)?;
        not_negative("dark_offset_dn", description.dark_offset_dn)?;
        not_negative("dark_current_e_per_s", description.dark_current_e_per_s)?;
        not_negative("read_noise_e", description.read_noise_e)?;
        within("full_well_e", description.full_well_e, "at least 1 and at most 1e9", |value| {
            (1.0..=LARGEST_WELL).contains(&value)
        })?;
        positive("pixel area", description.pixel_area_m2)?;
        positive("wavelength", description.wavelength_m)?;
        positive("exposure time", description.exposure_s)?;
        let photons = description.pixel_area_m2 * description.wavelength_m / (PLANCK * LIGHT_SPEED);
        Ok(Emva1288 {
            description: *description,
            electrons_per_exposure: photons * description.quantum_efficiency,
            non_uniformity: None,
        })
    }

    /// The same sensor with spatial non-uniformity.
    ///
    /// # Errors
    /// The first standard deviation that is out of range.
    pub fn with_non_uniformity(self, non_uniformity: NonUniformity) -> Result<Self, SensorError> {
        Ok(Emva1288 { non_uniformity: Some(non_uniformity.checked()?), ..self })
    }

    /// The same sensor with another exposure time.
    ///
    /// # Errors
    /// If the time is not positive.
    pub fn with_exposure_s(self, exposure_s: f64) -> Result<Self, SensorError> {
        positive("exposure time", exposure_s)?;
        Ok(Emva1288 { description: Emva1288Description { exposure_s, ..self.description }, ..self })
    }

    /// The same sensor with another number of pixels per row, which determines each pixel's row and
    /// column.
    #[must_use]
    pub fn with_columns(self, columns: u32) -> Self {
        let non_uniformity = self.non_uniformity.map(|uneven| NonUniformity { columns, ..uneven });
        Emva1288 { non_uniformity, ..self }
    }

    /// Spatial non-uniformity, if there is any.
    #[must_use]
    pub fn non_uniformity(&self) -> Option<&NonUniformity> {
        self.non_uniformity.as_ref()
    }

    /// Photons per pixel at an exposure of 1 J/m².
    #[must_use]
    pub fn photons_per_exposure(&self) -> f64 {
        self.electrons_per_exposure / self.description.quantum_efficiency
    }

    /// Parameters of the sensor.
    #[must_use]
    pub fn description(&self) -> &Emva1288Description {
        &self.description
    }

    /// Bit depth of the grey values.
    #[must_use]
    pub fn bits(&self) -> BitDepth {
        self.description.bits
    }

    /// Mean electrons of a pixel at `exposure` J/m², including dark current and ignoring the full
    /// well. NaN counts as no light.
    #[must_use]
    pub fn mean_electrons(&self, exposure: f64) -> f64 {
        exposure.max(0.0) * self.electrons_per_exposure
            + self.description.dark_current_e_per_s * self.description.exposure_s
    }

    /// Saturated grey value without noise and before rounding.
    #[must_use]
    pub fn exact_grey(&self, exposure: f64) -> f64 {
        self.grey_of_electrons(self.mean_electrons(exposure))
    }

    /// Grey levels per J/m² below saturation.
    #[must_use]
    pub fn grey_per_exposure(&self) -> f64 {
        self.description.gain_dn_per_e * self.electrons_per_exposure
    }

    /// Grey value of pixel number `pixel`, with noise; a function of (`seed`, `pixel`, exposure)
    /// only.
    #[must_use]
    pub fn grey(&self, exposure: f64, seed: u64, pixel: u64) -> u16 {
        self.grey_of(exposure, seed, pixel, self.pattern_of(pixel))
    }

    /// Deviations of the first `pixels` pixels.
    #[must_use]
    pub fn fixed_pattern(&self, pixels: u64) -> FixedPattern {
        FixedPattern((0..pixels).map(|pixel| self.pattern_of(pixel)).collect())
    }

    /// A picture of uniform exposure `exposure` J/m², with the same values as [`grey`](Self::grey).
    #[must_use]
    pub fn even_picture(&self, exposure: f64, seed: u64, pattern: &FixedPattern) -> Vec<u16> {
        (0..).zip(&pattern.0).map(|(pixel, &own)| self.grey_of(exposure, seed, pixel, own)).collect()
    }

    fn pattern_of(&self, pixel: u64) -> PixelPattern {
        self.non_uniformity.map_or(EVEN, |uneven| PixelPattern {
            response: uneven.response(pixel),
            dark_offset_e: uneven.dark_offset_e(pixel),
        })
    }

    fn grey_of(&self, exposure: f64, seed: u64, pixel: u64, own: PixelPattern) -> u16 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(pixel);
        // Far above the full well the count does not matter; the limit suits the generator of
        // Poisson numbers.
        let mean = self.mean_electrons(exposure * own.response).min(2.0 * LARGEST_WELL);
        let counted = Poisson::new(mean).map_or(0.0, |poisson| poisson.sample(&mut random));
        let normal: f64 = StandardNormal.sample(&mut random);
        let read_out = self.description.read_noise_e * normal;
        let electrons = counted.min(self.description.full_well_e) + (read_out + own.dark_offset_e);
        self.description.bits.quantise(self.description.dark_offset_dn + self.description.gain_dn_per_e * electrons)
    }

    fn grey_of_electrons(&self, electrons: f64) -> f64 {
        let description = &self.description;
        let grey = description.dark_offset_dn + description.gain_dn_per_e * electrons.min(description.full_well_e);
        grey.min(f64::from(description.bits.largest()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn description() -> Emva1288Description {
        Emva1288Description {
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
        }
    }

    /// Mean and variance of the grey values of many pixels at one exposure.
    fn statistics(sensor: &Emva1288, exposure: f64) -> (f64, f64) {
        let n = 40_000;
        let greys: Vec<f64> = (0..n).map(|pixel| f64::from(sensor.grey(exposure, 11, pixel))).collect();
        let mean = greys.iter().sum::<f64>() / n as f64;
        (mean, greys.iter().map(|grey| (grey - mean).powi(2)).sum::<f64>() / (n - 1) as f64)
    }

    #[test]
    fn photons_are_counted_as_the_standard_does() {
        // The standard's Eq. 3: μ_p = 50.34 · A[µm²] · t[ms] · λ[µm] · E[µW/cm²].
        let sensor = Emva1288::new(&Emva1288Description { quantum_efficiency: 1.0, ..description() }).unwrap();
        let shorthand = 50.34 * 25.0 * 20.0 * 0.532 * 3.0;
        let exposure = 3.0 * 1e-6 * 1e4 * 0.02;
        let photons = sensor.mean_electrons(exposure) - 500.0 * 0.02;
        assert!((photons / shorthand - 1.0).abs() < 1e-4, "{photons} against {shorthand}");
    }

    #[test]
    fn mean_and_variance_follow_the_photon_transfer_line() {
        let sensor = Emva1288::new(&description()).unwrap();
        let description = description();
        for electrons in [0.0, 5.0, 200.0, 3000.0, 9000.0] {
            let exposure = electrons / sensor.electrons_per_exposure;
            let (mean, variance) = statistics(&sensor, exposure);
            let expected_mean = 60.0 + 0.25 * (electrons + 10.0);
            assert!((mean - expected_mean).abs() < 4.0 * (variance / 4e4).sqrt(), "{mean} against {expected_mean}");
            let line = (description.gain_dn_per_e * description.read_noise_e).powi(2)
                + 1.0 / 12.0
                + description.gain_dn_per_e * (expected_mean - description.dark_offset_dn);
            // The variance of 40,000 values has a standard error of 0.7 %.
            assert!((variance / line - 1.0).abs() < 0.03, "{electrons} e: {variance} against {line}");
        }
    }

    #[test]
    fn the_gain_is_found_from_two_exposures_as_the_standard_measures_it() {
        let sensor = Emva1288::new(&description()).unwrap();
        let (dark_mean, dark_variance) = statistics(&sensor, 0.0);
        let (mean, variance) = statistics(&sensor, 7000.0 / sensor.electrons_per_exposure);
        let gain = (variance - dark_variance) / (mean - dark_mean);
        assert!((gain / 0.25 - 1.0).abs() < 0.03, "{gain}");
    }

    #[test]
    fn the_well_saturates_with_read_noise_only() {
        let sensor = Emva1288::new(&description()).unwrap();
        let (mean, variance) = statistics(&sensor, 1e6);
        assert!((mean - (60.0 + 0.25 * 14_000.0)).abs() < 0.1, "{mean}");
        assert!((variance - 9.0 - 1.0 / 12.0).abs() < 0.3, "{variance}");
        assert_eq!(sensor.exact_grey(f64::INFINITY), 3560.0);
        assert_eq!(sensor.grey(f64::INFINITY, 0, 0), sensor.grey(1e300, 0, 0));
    }

    #[test]
    fn noise_depends_on_seed_and_pixel_only() {
        let sensor = Emva1288::new(&description()).unwrap();
        let exposure = 1000.0 / sensor.electrons_per_exposure;
        let picture = |seed| (0..50).map(|pixel| sensor.grey(exposure, seed, pixel)).collect::<Vec<_>>();
        assert_eq!(picture(1), picture(1));
        assert_ne!(picture(1), picture(2));
        assert_eq!(sensor.grey(f64::NAN, 3, 4), sensor.grey(0.0, 3, 4));
    }

    #[test]
    fn impossible_sensors_are_rejected() {
        let message = |description: Emva1288Description| Emva1288::new(&description).unwrap_err().to_string();
        assert_eq!(
            message(Emva1288Description { quantum_efficiency: 60.0, ..description() }),
            "quantum_efficiency must be above 0 and at most 1, not 60"
        );
        assert_eq!(
            message(Emva1288Description { read_noise_e: -1.0, ..description() }),
            "read_noise_e must be at least 0 and finite, not -1"
        );
    }
}
