//! Pixels with a shared exponent: three or more mantissa bytes and one exponent byte.
//!
//! Source: G. Ward, "Real Pixels", Graphics Gems II, 1991. With mantissa m and exponent byte e > 0
//! a value is (m + ½)·2^(e − 136); e = 0 means all zero. The encoder uses the exponent of the
//! largest value and truncates mantissas; the half step added by the decoder makes the mean error
//! zero.

/// Pixels whose largest value is below this are black.
const DARKEST: f64 = 1e-32;

/// 2^(e − 136) of each exponent byte, 0 for 0.
const STEP: [f32; 256] = steps();

const fn steps() -> [f32; 256] {
    let mut table = [0.0; 256];
    let mut exponent = 1;
    while exponent < 256 {
        // Below 2^-126, which is exponent byte 10, single precision has no leading one.
        let bits = if exponent < 10 { 1 << (exponent + 13) } else { (exponent - 9) << 23 };
        table[exponent as usize] = f32::from_bits(bits);
        exponent += 1;
    }
    table
}

/// The quantisation step of an exponent byte, 2^(e − 136), or 0 for 0.
#[must_use]
pub fn mantissa_step(exponent: u8) -> f32 {
    STEP[usize::from(exponent)]
}

/// Decodes three mantissas and an exponent.
///
/// ```
/// assert_eq!(radsight_picture::decode_rgbe([128, 64, 0, 129]), [1.00390625, 0.50390625, 0.00390625]);
/// assert_eq!(radsight_picture::encode_rgbe([1.0, 0.5, -3.0]), [128, 64, 0, 129]);
/// ```
#[must_use]
pub fn decode_rgbe([red, green, blue, exponent]: [u8; 4]) -> [f32; 3] {
    let step = mantissa_step(exponent);
    [red, green, blue].map(|mantissa| (f32::from(mantissa) + 0.5) * step)
}

/// Encodes three values as Radiance does. Negative values and NaN become 0. Values from 2^127 on,
/// where Radiance's exponent overflows to black, are clamped to the brightest pixel.
#[must_use]
pub fn encode_rgbe([red, green, blue]: [f32; 3]) -> [u8; 4] {
    let Some((scale, exponent)) = scale_of(red.max(green).max(blue)) else { return [0; 4] };
    [(red * scale) as u8, (green * scale) as u8, (blue * scale) as u8, exponent]
}

/// Decodes any number of values. `pixel` holds their mantissas and then the exponent.
pub fn decode_spectrum(pixel: &[u8], values: &mut [f32]) {
    let Some((exponent, mantissas)) = pixel.split_last() else { return };
    let step = mantissa_step(*exponent);
    for (value, mantissa) in values.iter_mut().zip(mantissas) {
        *value = (f32::from(*mantissa) + 0.5) * step;
    }
}

/// Encodes any number of values. `pixel` receives their mantissas and then the exponent.
pub fn encode_spectrum(values: &[f32], pixel: &mut [u8]) {
    let Some((last, mantissas)) = pixel.split_last_mut() else { return };
    let Some((scale, exponent)) = scale_of(values.iter().copied().fold(0.0, f32::max)) else {
        pixel.fill(0);
        return;
    };
    *last = exponent;
    for (mantissa, value) in mantissas.iter_mut().zip(values) {
        *mantissa = (value * scale) as u8;
    }
}

/// The factor that scales the largest value to 128..256, and the exponent byte; `None` for black.
fn scale_of(largest: f32) -> Option<(f32, u8)> {
    if f64::from(largest) <= DARKEST || largest.is_nan() {
        return None;
    }
    // largest = fraction · 2^exponent with 0.5 <= fraction < 1; the bound keeps the exponent within
    // a byte.
    let exponent = ((largest.to_bits() >> 23) as i32 - 126).min(127);
    let scale = f32::from_bits(((135 - exponent) as u32) << 23);
    Some((scale, (exponent + 128) as u8))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_steps_are_powers_of_two() {
        assert_eq!(mantissa_step(0), 0.0);
        for exponent in 1..=255u8 {
            assert_eq!(f64::from(mantissa_step(exponent)), 2f64.powi(i32::from(exponent) - 136), "{exponent}");
        }
    }

    #[test]
    fn every_pixel_with_a_leading_one_survives_a_round_trip() {
        for exponent in 23..=255u8 {
            for mantissa in [128, 129, 200, 255] {
                let pixel = [mantissa, 0, 77, exponent];
                assert_eq!(encode_rgbe(decode_rgbe(pixel)), pixel);
                let mut spectrum = [0; 6];
                let values = [1.0, 0.3, 0.2, 0.7, 0.0].map(|part| part * decode_rgbe(pixel)[0]);
                encode_spectrum(&values, &mut spectrum);
                assert_eq!(&spectrum[5..], &[exponent]);
            }
        }
    }

    #[test]
    fn odd_values_do_no_harm() {
        assert_eq!(encode_rgbe([f32::INFINITY, 1.0, 0.0]), [255, 0, 0, 255]);
        assert_eq!(encode_rgbe([f32::MAX, -1.0, 0.0]), [255, 0, 0, 255]);
        assert_eq!(encode_rgbe([f32::NAN, 1.0, f32::NAN]), [0, 128, 0, 129]);
        assert_eq!(encode_rgbe([f32::NAN; 3]), [0; 4]);
        assert_eq!(encode_rgbe([0.9e-32, 0.0, -1.0]), [0; 4]);
        assert_eq!(encode_rgbe([1.1e-32, 0.0, f32::NEG_INFINITY])[1..], [0, 0, 22]);
    }
}
