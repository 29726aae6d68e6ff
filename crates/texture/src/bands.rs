//! Layout of colours and spectra in the arrays of a ray.
//!
//! A ray carries an array of `BANDS` elements: one for a grey scene, three for red, green and blue,
//! and a multiple of three for spectra. There the first third holds the bands that take their value
//! from the red of a colour, the second third those of green, the last those of blue. Colours can
//! thus be spread over the bands without knowing the wavelengths. Unused elements repeat a band.

use radsight_ir::Rgb;
use radsight_spectrum::Sampling;
use radsight_units::color::LUMINANCE_WEIGHTS;

/// Spreads red, green and blue over the elements of a ray; a grey scene takes the first alone.
#[inline]
pub fn spread<const BANDS: usize>(color: [f64; 3]) -> [f64; BANDS] {
    std::array::from_fn(|element| color[element * 3 / BANDS])
}

/// Red, green and blue of a ray's elements: the mean of each third.
#[inline]
pub fn gathered<const BANDS: usize>(elements: &[f64; BANDS]) -> [f64; 3] {
    if BANDS < 3 {
        return [elements[0]; 3];
    }
    let third = BANDS / 3;
    std::array::from_fn(|part| elements[part * third..][..third].iter().sum::<f64>() / third as f64)
}

/// Values that are the same for all rays.
#[derive(Clone, Debug, PartialEq)]
pub enum Bands {
    /// A colour.
    Color(Rgb),
    /// A value for each element.
    Spectrum(Box<[f64]>),
}

impl Bands {
    /// Whether all bands are the same.
    #[must_use]
    pub fn is_grey(&self) -> bool {
        match self {
            Bands::Color(color) => color.is_grey(),
            Bands::Spectrum(_) => false,
        }
    }

    /// Multiplies a colour band by band.
    #[inline]
    pub fn multiply<const BANDS: usize>(&self, color: &mut [f64; BANDS]) {
        match self {
            Bands::Color(by) => {
                for (band, factor) in color.iter_mut().zip(spread::<BANDS>(by.0)) {
                    *band *= factor;
                }
            }
            Bands::Spectrum(elements) => {
                for (band, factor) in color.iter_mut().zip(elements) {
                    *band *= factor;
                }
            }
        }
    }
}

/// Values of up to 24 bands, from the longest wavelength to the shortest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandValues {
    values: [f32; Sampling::MOST_BANDS],
    count: u8,
}

impl BandValues {
    /// Takes at most [`Sampling::MOST_BANDS`] values.
    pub fn new(bands: impl Iterator<Item = f64>) -> BandValues {
        let mut all = BandValues { values: [0.0; Sampling::MOST_BANDS], count: 0 };
        for (value, band) in all.values.iter_mut().zip(bands) {
            *value = band as f32;
            all.count += 1;
        }
        all
    }

    /// Adds the values of as many bands.
    pub fn add(&mut self, other: &BandValues) {
        for (sum, value) in self.values.iter_mut().zip(&other.values) {
            *sum += value;
        }
    }

    /// Products with the values of as many bands.
    #[must_use]
    pub fn times(&self, other: &BandValues) -> BandValues {
        BandValues { values: std::array::from_fn(|band| self.values[band] * other.values[band]), count: self.count }
    }

    /// Multiplies all values.
    pub fn scale(&mut self, factor: f64) {
        for value in &mut self.values {
            *value *= factor as f32;
        }
    }

    /// One value a band.
    #[must_use]
    pub fn as_slice(&self) -> &[f32] {
        &self.values[..usize::from(self.count)]
    }
}

/// Layout of a sampling's bands in the elements of a ray.
#[derive(Clone, Debug)]
pub struct BandLayout {
    sampling: Sampling,
    /// Band of each element.
    band_of: Vec<usize>,
    /// Element of each band.
    element_of: Vec<usize>,
}

/// Array sizes for spectra; the last holds any sampling.
pub(crate) const ELEMENTS: [usize; 4] = [3, 27, 36, 3 * Sampling::MOST_BANDS];

impl BandLayout {
    /// Layout of these bands.
    #[must_use]
    pub fn new(sampling: Sampling) -> BandLayout {
        let bands_of: [Vec<usize>; 3] =
            [0, 1, 2].map(|part| (0..sampling.bands()).filter(|band| sampling.part(*band) == part).collect());
        let widest = bands_of.iter().map(Vec::len).max().unwrap_or(0);
        let elements = ELEMENTS.into_iter().find(|elements| elements / 3 >= widest).unwrap_or(3 * widest);
        let mut element_of = vec![0; sampling.bands()];
        let mut band_of = Vec::with_capacity(elements);
        for element in 0..elements {
            let bands = &bands_of[element * 3 / elements];
            let index = element % (elements / 3);
            if let Some(band) = bands.get(index) {
                element_of[*band] = element;
            }
            // A third without bands repeats the last band.
            band_of.push(bands.get(index).or(bands.last()).copied().unwrap_or(0));
        }
        BandLayout { sampling, band_of, element_of }
    }

    /// Sampling of the spectrum.
    #[must_use]
    pub fn sampling(&self) -> &Sampling {
        &self.sampling
    }

    /// Number of elements of a ray's array.
    pub fn elements(&self) -> usize {
        self.band_of.len()
    }

    /// Band of each element.
    pub fn band_of(&self) -> &[usize] {
        &self.band_of
    }

    /// Arranges values of bands in the elements of a ray.
    pub fn arrange(&self, bands: &[f64]) -> Bands {
        if self.sampling.is_rgb() {
            return Bands::Color(Rgb([bands[0], bands[1], bands[2]]));
        }
        Bands::Spectrum(self.band_of.iter().map(|band| bands[*band]).collect())
    }

    /// Collects the value of each band from the elements of a ray.
    pub fn collect(&self, elements: &[f64]) -> impl Iterator<Item = f64> {
        self.element_of.iter().map(|element| elements[*element])
    }
}

/// Spreads a colour over the elements of a ray.
#[inline]
pub fn bands<const BANDS: usize>(color: Rgb) -> [f64; BANDS] {
    spread(color.0)
}

/// Product, band by band.
#[inline]
pub fn product<const BANDS: usize>(a: [f64; BANDS], b: [f64; BANDS]) -> [f64; BANDS] {
    std::array::from_fn(|band| a[band] * b[band])
}

/// The largest band.
pub fn strongest<const BANDS: usize>(bands: &[f64; BANDS]) -> f64 {
    bands.iter().copied().fold(0.0, f64::max)
}

/// Luminance of a colour relative to white, with Radiance's weights of its primaries.
pub fn luminance<const BANDS: usize>(bands: &[f64; BANDS]) -> f64 {
    let [red, green, blue] = gathered(bands);
    let [of_red, of_green, of_blue] = LUMINANCE_WEIGHTS;
    of_red * red + of_green * green + of_blue * blue
}

/// The reflectance of a surface whose pattern may be negative: it takes no light from others. What is
/// not a number remains, and is reported.
#[inline]
#[must_use]
pub fn not_negative<const BANDS: usize>(color: [f64; BANDS]) -> [f64; BANDS] {
    color.map(|band| if band < 0.0 { 0.0 } else { band })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_band_takes_its_third_of_a_colour() {
        for (bands, range) in [(4, [380.0, 780.0]), (18, [380.0, 780.0]), (24, [380.0, 780.0]), (24, [400.0, 2500.0])] {
            let sampling = Sampling::new(bands, range).unwrap();
            let layout = BandLayout::new(sampling);
            let colors: Vec<f64> = match layout.elements() {
                27 => spread::<27>([1.0, 2.0, 3.0]).to_vec(),
                36 => spread::<36>([1.0, 2.0, 3.0]).to_vec(),
                _ => spread::<72>([1.0, 2.0, 3.0]).to_vec(),
            };
            for (band, value) in layout.collect(&colors).enumerate() {
                assert_eq!(value, 1.0 + sampling.part(band) as f64, "band {band} of {bands}");
            }
        }
    }

    #[test]
    fn collect_inverts_arrange() {
        let layout = BandLayout::new(Sampling::new(11, [390.0, 710.0]).unwrap());
        let values: Vec<f64> = (0..11).map(f64::from).collect();
        let Bands::Spectrum(elements) = layout.arrange(&values) else { panic!("a spectrum is no colour") };
        assert_eq!(layout.collect(&elements).collect::<Vec<_>>(), values);
    }
}
