//! The encoding of values in a page: half floats with a common factor, predicted from their
//! neighbours, deflated.
//!
//! A code has 16 bits. It is stored as the difference to the code on its left (in the first column:
//! above), modulo 2¹⁶. For each component all high bytes are stored first, then all low bytes. They
//! are deflated (RFC 1950), which browsers decode natively, and written in base64.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use half::f16;
use radsight_picture::Image;
use std::io::Write as _;

/// Encoded values with their scale.
pub(crate) struct StoredValues {
    /// The factor of half floats; `None` if codes are the values.
    pub(crate) factor: Option<f64>,
    /// Deflated differences of codes, in base64.
    pub(crate) text: String,
}

/// The exponent of the largest half float, minus one, so that sums of a few values stay finite.
const TOP: i32 = 14;

impl StoredValues {
    /// Stores numbers with a relative precision of 2⁻¹¹.
    pub(crate) fn of_numbers(image: &Image<f32>) -> StoredValues {
        let finite = image.data().iter().filter(|value| value.is_finite());
        let largest = finite.fold(0.0_f64, |largest, value| largest.max(f64::from(value.abs())));
        let factor = if largest > 0.0 { 2f64.powi(largest.log2().floor() as i32 - TOP) } else { 1.0 };
        let code = |value: f32| f16::from_f64(f64::from(value) / factor).to_bits();
        let codes: Vec<u16> = image.data().iter().map(|value| code(*value)).collect();
        let text = packed(&codes, image.width(), image.components());
        StoredValues { factor: Some(factor), text }
    }

    /// Stores integers exactly.
    pub(crate) fn of_whole(image: &Image<u16>) -> StoredValues {
        StoredValues { factor: None, text: packed(image.data(), image.width(), image.components()) }
    }
}

fn packed(codes: &[u16], columns: usize, components: usize) -> String {
    let mut bytes = Vec::with_capacity(2 * codes.len());
    for component in 0..components {
        let plane: Vec<u16> = codes.iter().skip(component).step_by(components).copied().collect();
        let before = |place: usize| match place {
            _ if !place.is_multiple_of(columns) => plane[place - 1],
            _ if place >= columns => plane[place - columns],
            _ => 0,
        };
        let differences =
            || plane.iter().enumerate().map(|(place, code)| code.wrapping_sub(before(place)).to_be_bytes());
        bytes.extend(differences().map(|[high, _]| high));
        bytes.extend(differences().map(|[_, low]| low));
    }
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(&bytes).expect("memory takes all bytes");
    STANDARD.encode(encoder.finish().expect("memory takes all bytes"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::ZlibDecoder;
    use std::io::Read as _;

    /// Decodes as the page's script does.
    fn codes(text: &str, columns: usize, components: usize) -> Vec<Vec<u16>> {
        let mut bytes = Vec::new();
        ZlibDecoder::new(&STANDARD.decode(text).unwrap()[..]).read_to_end(&mut bytes).unwrap();
        let count = bytes.len() / 2 / components;
        let plane = |component: usize| {
            let mut codes: Vec<u16> = Vec::new();
            for place in 0..count {
                let before = if !place.is_multiple_of(columns) {
                    codes[place - 1]
                } else if place >= columns {
                    codes[place - columns]
                } else {
                    0
                };
                let start = 2 * component * count;
                codes.push(
                    before.wrapping_add(u16::from_be_bytes([bytes[start + place], bytes[start + count + place]])),
                );
            }
            codes
        };
        (0..components).map(plane).collect()
    }

    #[test]
    fn numbers_come_back_to_eleven_bits_over_eight_decades() {
        let value =
            |i: usize| (if i.is_multiple_of(5) { -1.0 } else { 1.0 }) * 3e-30 * 10f32.powf(8.0 * i as f32 / 299.0);
        let image = Image::new(50, 2, 3, (0..300).map(value).collect()).unwrap();
        let stored = StoredValues::of_numbers(&image);
        let planes = codes(&stored.text, 50, 3);
        for (i, value) in image.data().iter().enumerate() {
            let back = f16::from_bits(planes[i % 3][i / 3]).to_f64() * stored.factor.unwrap();
            let expected = f64::from(*value);
            assert!((back / expected - 1.0).abs() <= 1.01 * 2f64.powi(-11), "{back} instead of {expected}");
        }
    }

    #[test]
    fn what_is_no_number_stays_so_and_whole_numbers_stay_exact() {
        let image = Image::new(4, 1, 1, vec![f32::NAN, f32::INFINITY, 0.0, 2.0]).unwrap();
        let stored = StoredValues::of_numbers(&image);
        let back: Vec<f32> = codes(&stored.text, 4, 1)[0].iter().map(|code| f16::from_bits(*code).to_f32()).collect();
        assert!(back[0].is_nan() && back[1] == f32::INFINITY && back[2] == 0.0);
        let greys = Image::new(2, 3, 1, vec![0, 65535, 1, 4097, 32769, 12]).unwrap();
        assert_eq!(codes(&StoredValues::of_whole(&greys).text, 2, 1)[0], greys.data());
    }
}
