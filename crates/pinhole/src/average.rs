//! From the radiances of a pixel's rays to its exposure.

use crate::PinholeCamera;

/// How the bands of a coloured radiance add up to one: weights that sum to 1.
///
/// They apply as `L₀ + Σ wₖ (Lₖ − L₀)`, so that equal bands give exactly their value, and a grey scene traced in one band
/// gives the same bits as the same scene traced in three.
#[derive(Clone, Debug, PartialEq)]
pub struct BandWeights {
    weights: Vec<f64>,
}

/// What is wrong with a list of band weights.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BandWeightsError {
    /// A weight is negative, NaN or infinite.
    #[error("band weight {value} is not a finite number of at least 0")]
    OutOfRange {
        /// The weight.
        value: f64,
        /// Its place in the list, from 0.
        index: usize,
    },
    /// Nothing would be seen.
    #[error("the band weights add up to 0")]
    AllZero,
    /// The radiances have another number of bands than there are weights.
    #[error("{bands} bands but {weights} band weights")]
    Count {
        /// Bands of the radiances.
        bands: usize,
        /// Weights given.
        weights: usize,
    },
}

impl BandWeights {
    /// Normalises a list of weights, one a band.
    ///
    /// # Errors
    /// When a weight is negative or not finite, or none is positive.
    pub fn new(weights: &[f64]) -> Result<Self, BandWeightsError> {
        if let Some((index, &value)) = weights.iter().enumerate().find(|(_, w)| !w.is_finite() || **w < 0.0) {
            return Err(BandWeightsError::OutOfRange { value, index });
        }
        let largest = weights.iter().fold(0.0f64, |most, &w| most.max(w));
        if largest == 0.0 {
            return Err(BandWeightsError::AllZero);
        }
        let sum: f64 = weights.iter().map(|w| w / largest).sum();
        Ok(BandWeights { weights: weights.iter().map(|w| w / largest / sum).collect() })
    }

    /// The same weight for each of `bands` bands (at least one).
    #[must_use]
    pub fn equal(bands: usize) -> Self {
        let bands = bands.max(1);
        BandWeights { weights: vec![1.0 / bands as f64; bands] }
    }

    /// These weights for radiances of `bands` bands. One band is grey and needs no weights.
    ///
    /// # Errors
    /// When the numbers differ.
    pub fn for_bands(&self, bands: usize) -> Result<Self, BandWeightsError> {
        match bands {
            1 => Ok(BandWeights::equal(1)),
            _ if bands == self.weights.len() => Ok(self.clone()),
            _ => Err(BandWeightsError::Count { bands, weights: self.weights.len() }),
        }
    }

    /// The normalised weights.
    #[must_use]
    pub fn as_slice(&self) -> &[f64] {
        &self.weights
    }

    /// One radiance from the bands of one ray, in band order.
    #[inline]
    #[must_use]
    pub fn combine(&self, radiance: &[f64]) -> f64 {
        let Some((&first, rest)) = radiance.split_first() else { return 0.0 };
        let differences = rest.iter().zip(self.weights.iter().skip(1));
        differences.fold(first, |sum, (&band, &weight)| sum + weight * (band - first))
    }
}

/// The average of one pixel: `E_pixel = τ·A_pinhole/f² · mean(L·cos⁴θ)`, Eqs. 3, 4 and 8 of the paper without Eq. 7.
///
/// The sum is plain and in the order of the rays, so that the fused command and the chain through a pipe give the same bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelAverage {
    sum: f64,
    count: u32,
}

impl PixelAverage {
    /// Adds the next ray of the pixel: its cos⁴θ and the radiance that came back, W/(sr·m²).
    #[inline]
    pub fn add(&mut self, cos4: f64, radiance: f64) {
        self.sum += radiance * cos4;
        self.count += 1;
    }

    /// Rays so far.
    #[must_use]
    pub fn count(&self) -> u32 {
        self.count
    }

    /// E_pixel in J/m²; 0 before the first ray.
    #[must_use]
    pub fn exposure(&self, camera: &PinholeCamera) -> f64 {
        camera.exposure_per_radiance() * (self.sum / f64::from(self.count.max(1)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rays;
    use crate::camera::tests::paper_camera;

    #[test]
    fn equal_bands_give_exactly_their_value() {
        let weights = BandWeights::new(&[0.2126, 0.7152, 0.0722]).unwrap();
        for value in [0.1, 1.0 / 3.0, 7e-9, 123.456] {
            assert_eq!(weights.combine(&[value; 3]), value);
            assert_eq!(weights.for_bands(1).unwrap().combine(&[value]), value);
        }
    }

    #[test]
    fn weights_are_normalised() {
        let weights = BandWeights::new(&[2.0, 1.0, 1.0]).unwrap();
        assert_eq!(weights.combine(&[1.0, 0.0, 0.0]), 0.5);
        assert_eq!(weights.combine(&[0.0, 1.0, 0.0]), 0.25);
        let huge = BandWeights::new(&[f64::MAX, f64::MAX]).unwrap();
        assert_eq!(huge.as_slice(), [0.5, 0.5]);
    }

    #[test]
    fn bad_weights_are_refused() {
        assert_eq!(
            BandWeights::new(&[1.0, -1.0]).unwrap_err().to_string(),
            "band weight -1 is not a finite number of at least 0"
        );
        assert_eq!(BandWeights::new(&[0.0]).unwrap_err(), BandWeightsError::AllZero);
        assert_eq!(BandWeights::new(&[]).unwrap_err(), BandWeightsError::AllZero);
        assert_eq!(BandWeights::equal(3).for_bands(5).unwrap_err().to_string(), "5 bands but 3 band weights");
    }

    /// A hole in a uniform sky: the exposure of the middle pixel is τ·L·π d²/4f², Eq. 9 at θ = 0.
    #[test]
    fn a_uniform_scene_exposes_as_equation_9_on_the_axis() {
        let camera = paper_camera();
        let rays = Rays::new(&camera, 64, 0);
        let mut average = PixelAverage::default();
        for sample in 0..64 {
            average.add(rays.of_sample(82 * 192 + 96, sample).cos4, 2.0);
        }
        let expected = 2.0 * 0.01 * std::f64::consts::PI * 1e-8 / (4.0 * 6.75e-3 * 6.75e-3);
        assert!((average.exposure(&camera) / expected - 1.0).abs() < 1e-4);
    }
}
