//! How colours and spectra stand in the arrays with which rays are traced.
//!
//! A tracer has an array of `BANDS` places: one for a grey scene, three for red, green and blue, and for spectra a multiple of three.
//! There the first third of the places holds the bands that take their value from the red of a colour, the second those of its green,
//! the last those of its blue, so that colours are spread without knowing the wavelengths. Places that are left over repeat a band.

use radsight_ir::Rgb;
use radsight_spectrum::Sampling;
use radsight_units::color::LUMINANCE_WEIGHTS;

/// Red, green and blue in the places of a tracer; the first alone where the scene is grey.
#[inline]
pub fn spread<const BANDS: usize>(color: [f64; 3]) -> [f64; BANDS] {
    std::array::from_fn(|place| color[place * 3 / BANDS])
}

/// What stands for red, green and blue in the places of a tracer: the mean of each third.
#[inline]
pub fn gathered<const BANDS: usize>(places: &[f64; BANDS]) -> [f64; 3] {
    if BANDS < 3 {
        return [places[0]; 3];
    }
    let third = BANDS / 3;
    std::array::from_fn(|part| places[part * third..][..third].iter().sum::<f64>() / third as f64)
}

/// Values that are the same for all rays.
#[derive(Clone, Debug, PartialEq)]
pub enum Bands {
    /// A colour.
    Color(Rgb),
    /// A value for each place.
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
            Bands::Spectrum(places) => {
                for (band, factor) in color.iter_mut().zip(places) {
                    *band *= factor;
                }
            }
        }
    }
}

/// The values of up to 24 bands, from the longest wavelength to the shortest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandValues {
    values: [f32; Sampling::MOST_BANDS],
    count: u8,
}

impl BandValues {
    /// As many as there are, at most [`Sampling::MOST_BANDS`].
    pub fn new(bands: impl Iterator<Item = f64>) -> BandValues {
        let mut all = BandValues { values: [0.0; Sampling::MOST_BANDS], count: 0 };
        for (value, band) in all.values.iter_mut().zip(bands) {
            *value = band as f32;
            all.count += 1;
        }
        all
    }

    /// Adds as many other values.
    pub fn add(&mut self, other: &BandValues) {
        for (sum, value) in self.values.iter_mut().zip(&other.values) {
            *sum += value;
        }
    }

    /// The products with as many other values.
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

/// Which band of a sampling stands in which place.
#[derive(Clone, Debug)]
pub struct BandLayout {
    sampling: Sampling,
    /// By place.
    band_of: Vec<usize>,
    /// By band.
    place_of: Vec<usize>,
}

/// How many places there can be; the last holds any sampling.
pub(crate) const PLACES: [usize; 4] = [3, 27, 36, 3 * Sampling::MOST_BANDS];

impl BandLayout {
    /// The layout of these bands.
    #[must_use]
    pub fn new(sampling: Sampling) -> BandLayout {
        let bands_of: [Vec<usize>; 3] =
            [0, 1, 2].map(|part| (0..sampling.bands()).filter(|band| sampling.part(*band) == part).collect());
        let widest = bands_of.iter().map(Vec::len).max().unwrap_or(0);
        let places = PLACES.into_iter().find(|places| places / 3 >= widest).unwrap_or(3 * widest);
        let mut place_of = vec![0; sampling.bands()];
        let mut band_of = Vec::with_capacity(places);
        for place in 0..places {
            let bands = &bands_of[place * 3 / places];
            let index = place % (places / 3);
            if let Some(band) = bands.get(index) {
                place_of[*band] = place;
            }
            // A third without bands repeats the first of all.
            band_of.push(bands.get(index).or(bands.last()).copied().unwrap_or(0));
        }
        BandLayout { sampling, band_of, place_of }
    }

    /// The bands.
    #[must_use]
    pub fn sampling(&self) -> &Sampling {
        &self.sampling
    }

    /// How many places a tracer needs.
    pub fn places(&self) -> usize {
        self.band_of.len()
    }

    /// The band in each place.
    pub fn band_of(&self) -> &[usize] {
        &self.band_of
    }

    /// Values of bands in the places of a tracer.
    pub fn arrange(&self, bands: &[f64]) -> Bands {
        if self.sampling.is_rgb() {
            return Bands::Color(Rgb([bands[0], bands[1], bands[2]]));
        }
        Bands::Spectrum(self.band_of.iter().map(|band| bands[*band]).collect())
    }

    /// The value of each band.
    pub fn collect(&self, places: &[f64]) -> impl Iterator<Item = f64> {
        self.place_of.iter().map(|place| places[*place])
    }
}

/// A colour in the places of a tracer.
#[inline]
pub fn bands<const BANDS: usize>(color: Rgb) -> [f64; BANDS] {
    spread(color.0)
}

/// Band by band.
#[inline]
pub fn product<const BANDS: usize>(a: [f64; BANDS], b: [f64; BANDS]) -> [f64; BANDS] {
    std::array::from_fn(|band| a[band] * b[band])
}

/// The largest band.
pub fn strongest<const BANDS: usize>(bands: &[f64; BANDS]) -> f64 {
    bands.iter().copied().fold(0.0, f64::max)
}

/// Brightness of a colour, with Radiance's weights of its primaries.
pub fn luminance<const BANDS: usize>(bands: &[f64; BANDS]) -> f64 {
    let [red, green, blue] = gathered(bands);
    let [of_red, of_green, of_blue] = LUMINANCE_WEIGHTS;
    of_red * red + of_green * green + of_blue * blue
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_band_takes_its_part_of_a_colour() {
        for (bands, range) in [(4, [380.0, 780.0]), (18, [380.0, 780.0]), (24, [380.0, 780.0]), (24, [400.0, 2500.0])] {
            let sampling = Sampling::new(bands, range).unwrap();
            let layout = BandLayout::new(sampling);
            let colors: Vec<f64> = match layout.places() {
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
    fn what_is_arranged_is_collected() {
        let layout = BandLayout::new(Sampling::new(11, [390.0, 710.0]).unwrap());
        let values: Vec<f64> = (0..11).map(f64::from).collect();
        let Bands::Spectrum(places) = layout.arrange(&values) else { panic!("a spectrum is no colour") };
        assert_eq!(layout.collect(&places).collect::<Vec<_>>(), values);
    }
}
