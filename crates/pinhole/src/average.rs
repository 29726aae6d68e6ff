//! From the radiances of a pixel's rays to its exposure.

use crate::PinholeCamera;

/// Weights that combine the bands of a coloured radiance into one value. They sum to 1.
///
/// They apply as `L₀ + Σ wₖ (Lₖ − L₀)`, so that equal bands give exactly their value, and a grey
/// scene traced in one band gives the same bits as the same scene traced in three.
#[derive(Clone, Debug, PartialEq)]
pub struct BandWeights {
    weights: Vec<f64>,
    mosaic: Option<FilterMosaic>,
}

/// A colour filter mosaic with cells of 2 x 2 pixels.
///
/// A filter transmits a fraction of each band, so the exposure behind it is `Σ wₖ Tₖ Lₖ`. A grey
/// radiance is equal in all bands.
#[derive(Clone, Debug, PartialEq)]
pub struct FilterMosaic {
    columns: u64,
    /// The filter of each pixel of the cell, row by row.
    cell: [usize; 4],
    /// wₖ·Tₖ of each filter over the bands.
    shares: [Vec<f64>; 3],
    /// Their sums.
    grey: [f64; 3],
}

impl FilterMosaic {
    /// The radiance transmitted to a pixel.
    #[inline]
    fn combine(&self, pixel: u64, radiance: &[f64]) -> f64 {
        let (row, column) = (pixel / self.columns, pixel % self.columns);
        let filter = self.cell[(2 * (row % 2) + column % 2) as usize];
        match radiance {
            [grey] => grey * self.grey[filter],
            bands => bands.iter().zip(&self.shares[filter]).map(|(band, share)| band * share).sum(),
        }
    }
}

/// An error in a list of band weights.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BandWeightsError {
    /// A weight is negative, NaN or infinite.
    #[error("band weight {value} is not a finite number of at least 0")]
    OutOfRange {
        /// The weight.
        value: f64,
        /// Its index in the list, from 0.
        index: usize,
    },
    /// All weights are 0.
    #[error("the band weights add up to 0")]
    AllZero,
    /// The number of diffraction wavelengths differs from the number of bands. A grey scene is
    /// white light of equal weights.
    #[error("{wavelengths} band_wavelengths_nm for {bands} band(s)")]
    Wavelengths {
        /// Bands of the radiances.
        bands: usize,
        /// Wavelengths given.
        wavelengths: usize,
    },
    /// The number of bands of the radiances differs from the number of weights.
    #[error("{bands} bands but {weights} band weights")]
    Count {
        /// Bands of the radiances.
        bands: usize,
        /// Weights given.
        weights: usize,
    },
}

impl BandWeights {
    /// Normalises a list of weights, one per band.
    ///
    /// # Errors
    /// If a weight is negative or not finite, or none is positive.
    pub fn new(weights: &[f64]) -> Result<Self, BandWeightsError> {
        if let Some((index, &value)) = weights.iter().enumerate().find(|(_, w)| !w.is_finite() || **w < 0.0) {
            return Err(BandWeightsError::OutOfRange { value, index });
        }
        let largest = weights.iter().fold(0.0f64, |most, &w| most.max(w));
        if largest == 0.0 {
            return Err(BandWeightsError::AllZero);
        }
        let sum: f64 = weights.iter().map(|w| w / largest).sum();
        Ok(BandWeights { weights: weights.iter().map(|w| w / largest / sum).collect(), mosaic: None })
    }

    /// The same weight for each of `bands` bands (at least one).
    #[must_use]
    pub fn equal(bands: usize) -> Self {
        let bands = bands.max(1);
        BandWeights { weights: vec![1.0 / bands as f64; bands], mosaic: None }
    }

    /// The same weights behind a colour filter mosaic. `cell` gives the index into `filters` of the
    /// pixels of each 2 x 2 cell, row by row, in pictures of `columns` columns. `filters` are
    /// transmittances by band, 0 to 1.
    ///
    /// # Errors
    /// If a filter has another number of bands, or a transmittance is out of range.
    pub fn with_mosaic(
        self,
        columns: u32,
        cell: [usize; 4],
        filters: &[Vec<f64>; 3],
    ) -> Result<Self, BandWeightsError> {
        for filter in filters {
            if filter.len() != self.weights.len() {
                return Err(BandWeightsError::Count { bands: filter.len(), weights: self.weights.len() });
            }
            if let Some((index, &value)) = filter.iter().enumerate().find(|(_, share)| !(0.0..=1.0).contains(*share)) {
                return Err(BandWeightsError::OutOfRange { value, index });
            }
        }
        let of_filter = |filter: &Vec<f64>| filter.iter().zip(&self.weights).map(|(share, w)| share * w).collect();
        let shares: [Vec<f64>; 3] = std::array::from_fn(|index| of_filter(&filters[index]));
        let grey = std::array::from_fn(|index| shares[index].iter().sum());
        let cell = cell.map(|filter| filter.min(2));
        let mosaic = Some(FilterMosaic { columns: u64::from(columns.max(1)), cell, shares, grey });
        Ok(BandWeights { mosaic, ..self })
    }

    /// These weights for radiances of `bands` bands. One band is grey and needs no weights.
    ///
    /// # Errors
    /// If the numbers differ.
    pub fn for_bands(&self, bands: usize) -> Result<Self, BandWeightsError> {
        match bands {
            1 => Ok(BandWeights { mosaic: self.mosaic.clone(), ..BandWeights::equal(1) }),
            _ if bands == self.weights.len() => Ok(self.clone()),
            _ => Err(BandWeightsError::Count { bands, weights: self.weights.len() }),
        }
    }

    /// The normalised weights.
    #[must_use]
    pub fn as_slice(&self) -> &[f64] {
        &self.weights
    }

    /// Combines the bands of a ray of a pixel into one radiance, through the pixel's colour filter
    /// if it has one.
    #[inline]
    #[must_use]
    pub fn combine_at(&self, pixel: u64, radiance: &[f64]) -> f64 {
        match &self.mosaic {
            None => self.combine(radiance),
            Some(mosaic) => mosaic.combine(pixel, radiance),
        }
    }

    /// Combines separate bands (see [`Rays::bands_apart`](crate::Rays::bands_apart)). A grey scene
    /// may have more of them than weights: it is white light of equal weights.
    #[must_use]
    pub fn combine_apart(&self, pixel: u64, bands: &[f64]) -> f64 {
        if self.weights.len() == 1 && bands.len() > 1 {
            return self.combine_at(pixel, &[BandWeights::equal(bands.len()).combine(bands)]);
        }
        self.combine_at(pixel, &bands[..bands.len().min(self.weights.len())])
    }

    /// Whether pixels have colour filters.
    #[must_use]
    pub fn has_mosaic(&self) -> bool {
        self.mosaic.is_some()
    }

    /// Combines the bands of a ray into one radiance, in band order, without colour filters.
    #[inline]
    #[must_use]
    pub fn combine(&self, radiance: &[f64]) -> f64 {
        let Some((&first, rest)) = radiance.split_first() else { return 0.0 };
        let differences = rest.iter().zip(self.weights.iter().skip(1));
        differences.fold(first, |sum, (&band, &weight)| sum + weight * (band - first))
    }
}

/// The average of one pixel: `E_pixel = τ·A_pinhole/f² · mean(L·cos⁴θ)`, Eqs. 3, 4 and 8 of the
/// paper without Eq. 7.
///
/// The sum is plain and in the order of the rays, so `capture` and the chain of programs give the
/// same bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelAverage {
    sum: f64,
    count: u32,
}

impl PixelAverage {
    /// Adds the next ray of the pixel: its cos⁴θ and its radiance, W/(sr·m²).
    #[inline]
    pub fn add(&mut self, cos4: f64, radiance: f64) {
        self.sum += radiance * cos4;
        self.count += 1;
    }

    /// Number of rays so far.
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

    #[test]
    fn filters_pass_their_share_of_each_band_to_their_pixels() {
        let filters = [vec![1.0, 0.0, 0.0], vec![0.1, 0.8, 0.1], vec![0.0, 0.0, 0.5]];
        let weights = BandWeights::new(&[2.0, 1.0, 1.0]).unwrap().with_mosaic(3, [0, 1, 1, 2], &filters).unwrap();
        let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-15, "{found} {expected}");
        near(weights.combine_at(0, &[4.0, 8.0, 16.0]), 2.0);
        near(weights.combine_at(1, &[4.0, 8.0, 16.0]), 0.2 + 1.6 + 0.4);
        // The second row begins with pixel 3: green, then blue.
        near(weights.combine_at(4, &[4.0, 8.0, 16.0]), 2.0);
        for pixel in [0, 1, 3, 4] {
            let grey = weights.for_bands(1).unwrap();
            near(grey.combine_at(pixel, &[7.0]), weights.combine_at(pixel, &[7.0; 3]));
        }
        assert!(BandWeights::equal(3).with_mosaic(3, [0, 1, 1, 2], &[vec![1.0], vec![1.0], vec![1.0]]).is_err());
        let bright = [vec![1.5], vec![1.0], vec![1.0]];
        assert!(BandWeights::equal(1).with_mosaic(3, [0, 1, 1, 2], &bright).is_err());
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
