//! MGF colours: chromaticities, or spectra from 380 to 780 nm in steps of 10 nm.

use radsight_units::photometry::LUMINOUS_EFFICACY;

/// First and last wavelength, and the step, in nm.
pub(crate) const FIRST_NM: i32 = 380;
pub(crate) const LAST_NM: i32 = 780;
pub(crate) const STEP_NM: i32 = 10;
/// Number of samples of a spectrum.
pub(crate) const SAMPLES: usize = 41;
/// Largest value of a spectrum; values are integers.
const LARGEST: f64 = 10_000.0;
/// Lumens per watt of one unit of a spectrum weighted by the observer's ȳ.
const LUMENS_PER_WATT: f64 = LUMINOUS_EFFICACY / 10_000.0;

/// The CIE 1931 standard observer, times 10,000.
#[rustfmt::skip]
const OBSERVER: [[i32; SAMPLES]; 3] = [
    [14, 42, 143, 435, 1344, 2839, 3483, 3362, 2908, 1954, 956, 320, 49, 93, 633, 1655, 2904, 4334, 5945, 7621, 9163,
     10263, 10622, 10026, 8544, 6424, 4479, 2835, 1649, 874, 468, 227, 114, 58, 29, 14, 7, 3, 2, 1, 0],
    [0, 1, 4, 12, 40, 116, 230, 380, 600, 910, 1390, 2080, 3230, 5030, 7100, 8620, 9540, 9950, 9950, 9520, 8700, 7570,
     6310, 5030, 3810, 2650, 1750, 1070, 610, 320, 170, 82, 41, 21, 10, 5, 2, 1, 1, 0, 0],
    [65, 201, 679, 2074, 6456, 13856, 17471, 17721, 16692, 12876, 8130, 4652, 2720, 1582, 782, 422, 203, 87, 39, 21, 17,
     11, 8, 3, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0],
];

/// A colour without its level.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Color {
    definition: Definition,
    /// The name of the spectrum's definition.
    pub(crate) spectrum_name: Option<String>,
}

#[derive(Clone, Debug, PartialEq)]
enum Definition {
    Chromaticity([f64; 2]),
    Spectrum(Box<[i32; SAMPLES]>),
}

impl Default for Color {
    /// Grey.
    fn default() -> Self {
        Color::of_chromaticity([1.0 / 3.0, 1.0 / 3.0])
    }
}

impl Color {
    /// `[x, y]`
    pub(crate) fn of_chromaticity(chromaticity: [f64; 2]) -> Color {
        Color { definition: Definition::Chromaticity(chromaticity), spectrum_name: None }
    }

    /// A spectrum with equal steps from `first` to `last` nm; `None` if no part is visible.
    pub(crate) fn of_samples(first: f64, last: f64, samples: &[f64]) -> Option<Color> {
        if samples.len() < 2 || first >= f64::from(LAST_NM) || last <= f64::from(FIRST_NM) || first >= last {
            return None;
        }
        let step = (last - first) / (samples.len() - 1) as f64;
        let at = |nm: f64| -> Option<f64> {
            let place = (nm - first) / step;
            let end = (samples.len() - 1) as f64;
            if place < -1e-3 || place > end + 1e-3 {
                return None;
            }
            let index = (place.max(0.0) as usize).min(samples.len() - 2);
            let fraction = (place - index as f64).clamp(0.0, 1.0);
            Some(samples[index] * (1.0 - fraction) + samples[index + 1] * fraction)
        };
        // Fine spectra are averaged over each step; coarse ones are interpolated.
        let finer = (f64::from(STEP_NM) / step).round().clamp(1.0, 1000.0) as i32;
        let values = std::array::from_fn(|index| {
            let centre = f64::from(FIRST_NM + STEP_NM * index as i32);
            let offsets = (0..finer).map(|part| (f64::from(part) - f64::from(finer - 1) / 2.0) * step);
            let parts: Vec<f64> = offsets.filter_map(|offset| at(centre + offset)).collect();
            if at(centre).is_some() { parts.iter().sum::<f64>() / parts.len().max(1) as f64 } else { 0.0 }
        });
        Color::of_spectrum(values)
    }

    /// The spectrum of a black body; `None` below 1000 K.
    pub(crate) fn of_black_body(kelvin: f64) -> Option<Color> {
        if kelvin.is_nan() || kelvin < 1000.0 {
            return None;
        }
        // The second radiation constant, m·K; the spectrum's scale is arbitrary.
        const C2: f64 = 1.4388e-2;
        let values = std::array::from_fn(|index| {
            let metres = f64::from(FIRST_NM + STEP_NM * index as i32) * 1e-9;
            1e-35 / (metres.powi(5) * ((C2 / (kelvin * metres)).exp() - 1.0))
        });
        Color::of_spectrum(values)
    }

    fn of_spectrum(values: [f64; SAMPLES]) -> Option<Color> {
        let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        if !(largest > 0.0 && largest.is_finite()) {
            return None;
        }
        let rounded = values.map(|value| (value * LARGEST / largest + 0.5).floor() as i32);
        Some(Color { definition: Definition::Spectrum(Box::new(rounded)), spectrum_name: None })
    }

    /// Two colours mixed by luminance; the name is that of the first.
    pub(crate) fn mixed(&self, weight: f64, other: &Color, other_weight: f64) -> Color {
        if weight == 0.0 {
            return other.clone();
        }
        if other_weight == 0.0 {
            return self.clone();
        }
        if let (Definition::Spectrum(a), Definition::Spectrum(b)) = (&self.definition, &other.definition) {
            let (luminous_a, luminous_b) = (weighted(a, 1), weighted(b, 1));
            let values = std::array::from_fn(|index| {
                weight / luminous_a * f64::from(a[index]) + other_weight / luminous_b * f64::from(b[index])
            });
            let mixed = Color::of_spectrum(values).unwrap_or_default();
            return Color { spectrum_name: self.spectrum_name.clone(), ..mixed };
        }
        let ([x1, y1], [x2, y2]) = (self.chromaticity(), other.chromaticity());
        let (w1, w2) = (weight * y2, other_weight * y1);
        if w1 + w2 == 0.0 {
            return Color::default();
        }
        Color::of_chromaticity([(w1 * x1 + w2 * x2) / (w1 + w2), (w1 * y1 + w2 * y2) / (w1 + w2)])
    }

    /// `[x, y]`
    pub(crate) fn chromaticity(&self) -> [f64; 2] {
        match &self.definition {
            Definition::Chromaticity(chromaticity) => *chromaticity,
            Definition::Spectrum(samples) => {
                let [x, y, z] = [0, 1, 2].map(|axis| {
                    let whole: i32 = OBSERVER[axis].iter().sum();
                    weighted(samples, axis) / f64::from(whole)
                });
                let sum = x + y + z;
                if sum > 1e-6 { [x / sum, y / sum] } else { [1.0 / 3.0, 1.0 / 3.0] }
            }
        }
    }

    /// The samples, scaled to the luminance of a flat spectrum of 1.
    pub(crate) fn scaled_spectrum(&self) -> Option<[f64; SAMPLES]> {
        const FLAT_EFFICACY: f64 = 178.006;
        let Definition::Spectrum(samples) = &self.definition else { return None };
        let scale = SAMPLES as f64 * FLAT_EFFICACY / (LUMENS_PER_WATT * weighted(samples, 1));
        Some(samples.map(|sample| f64::from(sample) * scale))
    }

    /// Whether the two colours match visually and are of one kind.
    pub(crate) fn is_equivalent(&self, other: &Color) -> bool {
        let ([x1, y1], [x2, y2]) = (self.chromaticity(), other.chromaticity());
        let near = (x1 - x2).abs() + (y1 - y2).abs() <= 0.015;
        match (&self.definition, &other.definition) {
            (Definition::Chromaticity(_), Definition::Chromaticity(_)) => near,
            (Definition::Spectrum(a), Definition::Spectrum(b)) => {
                let (sum_a, sum_b) = (a.iter().sum::<i32>(), b.iter().sum::<i32>());
                let threshold = i64::from(LARGEST as i32 / 200) * i64::from(sum_a + sum_b);
                let differs = |(a, b): (&i32, &i32)| {
                    (i64::from(*a) * i64::from(sum_b) - i64::from(*b) * i64::from(sum_a)).abs() > threshold
                };
                near && !a.iter().zip(b.iter()).any(differs)
            }
            _ => false,
        }
    }

    /// Whether the chromaticity is within 0.01 of white.
    pub(crate) fn is_grey(&self) -> bool {
        self.chromaticity().iter().all(|value| (0.323..=0.343).contains(value))
    }
}

/// The spectrum weighted by x̄, ȳ or z̄.
fn weighted(samples: &[i32; SAMPLES], axis: usize) -> f64 {
    samples.iter().zip(&OBSERVER[axis]).map(|(sample, weight)| f64::from(*sample) * f64::from(*weight)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_black_body_of_6500_kelvin_has_its_chromaticity() {
        let [x, y] = Color::of_black_body(6500.0).unwrap().chromaticity();
        assert!((x - 0.3136).abs() < 1e-3 && (y - 0.3237).abs() < 1e-3, "{x} {y}");
        assert!(Color::of_black_body(500.0).is_none());
    }

    #[test]
    fn a_flat_spectrum_is_grey_at_any_sampling() {
        for count in [2, 5, 41, 401] {
            let color = Color::of_samples(380.0, 780.0, &vec![0.3; count]).unwrap();
            assert!(color.is_grey());
            assert!(color.scaled_spectrum().unwrap().iter().all(|value| (value - 1.0).abs() < 1e-3));
        }
    }

    #[test]
    fn luminances_add_when_colours_are_mixed() {
        let (red, green) = (Color::of_chromaticity([0.64, 0.33]), Color::of_chromaticity([0.29, 0.6]));
        let [x, y] = red.mixed(1.0, &green, 1.0).chromaticity();
        let mean = |a: f64, b: f64| (a + b) / (1.0 / 0.33 + 1.0 / 0.6);
        assert!((x - mean(0.64 / 0.33, 0.29 / 0.6)).abs() < 1e-12 && (y - mean(1.0, 1.0)).abs() < 1e-12);
    }
}
