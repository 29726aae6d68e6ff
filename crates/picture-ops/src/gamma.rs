//! Gamma encoding of pixels to bytes and back: the integer arithmetic of Radiance's converters,
//! with tables.

use crate::brightness::WEIGHTS;

/// Largest number of halvings with a table of its own.
const MOST_HALVINGS: usize = 31;
/// The exponent byte of pixels in [½, 1).
const UNIT_EXPONENT: i32 = 128;

/// The tables for a gamma.
#[derive(Clone, Debug)]
pub struct GammaTable {
    /// Bytes, by the number of halvings and the mantissa.
    bytes: Vec<[u8; 256]>,
    /// Mantissa and number of halvings of each byte.
    mantissas: [(u8, u8); 256],
}

impl GammaTable {
    /// Tables for displays whose luminance is the byte to the power of `gamma`.
    #[must_use]
    pub fn new(gamma: f64) -> GammaTable {
        let table = |halvings: usize| -> [u8; 256] {
            let scale = 0.5f64.powi(halvings as i32) / 256.0;
            std::array::from_fn(|mantissa| (256.0 * ((mantissa as f64 + 0.5) * scale).powf(1.0 / gamma)) as u8)
        };
        let mut mantissas = [(0, 0); 256];
        let (mut halvings, mut scale) = (0u8, 256.0);
        for byte in (0..256usize).rev() {
            let value = ((byte as f64 + 0.5) / 256.0).powf(gamma);
            while scale * value < 128.0 && usize::from(halvings) < 127 {
                halvings += 1;
                scale *= 2.0;
            }
            mantissas[byte] = ((scale * value) as u8, halvings);
        }
        GammaTable { bytes: (0..=MOST_HALVINGS).map(table).collect(), mantissas }
    }

    /// The bytes of a pixel; values above 1 become 255.
    #[must_use]
    pub fn to_bytes(&self, [red, green, blue, exponent]: [u8; 4]) -> [u8; 3] {
        let exponent = i32::from(exponent) - UNIT_EXPONENT;
        let darkest = -(MOST_HALVINGS as i32);
        [red, green, blue].map(|mantissa| match exponent {
            _ if exponent < darkest - 8 => 0,
            _ if exponent < darkest => {
                let rounded = ((mantissa >> (darkest - 1 - exponent)) + 1) >> 1;
                self.bytes[MOST_HALVINGS][usize::from(rounded)]
            }
            _ if exponent > 8 => 255,
            _ if exponent > 0 => {
                let doubled = (usize::from(mantissa) << 1 | 1) << (exponent - 1);
                self.bytes[0].get(doubled).copied().unwrap_or(255)
            }
            _ => self.bytes[exponent.unsigned_abs() as usize][usize::from(mantissa)],
        })
    }

    /// The pixel of three bytes.
    #[must_use]
    pub fn pixel(&self, bytes: [u8; 3]) -> [u8; 4] {
        let found = bytes.map(|byte| self.mantissas[usize::from(byte)]);
        let fewest = found.iter().map(|(_, halvings)| *halvings).min().unwrap_or(0);
        let [red, green, blue] =
            found.map(|(mantissa, halvings)| mantissa.checked_shr(u32::from(halvings - fewest)).unwrap_or(0));
        [red, green, blue, (UNIT_EXPONENT - i32::from(fewest)) as u8]
    }
}

/// A pixel brightened by a number of stops.
#[must_use]
pub fn shifted([red, green, blue, exponent]: [u8; 4], stops: i32) -> [u8; 4] {
    if stops == 0 {
        return [red, green, blue, exponent];
    }
    if i32::from(exponent) <= (-stops).max(0) {
        return [0; 4];
    }
    [red, green, blue, (i32::from(exponent) + stops).clamp(0, 255) as u8]
}

/// A pixel with its brightness in place of green, in integer arithmetic.
#[must_use]
pub fn with_grey([red, green, blue, exponent]: [u8; 4]) -> [u8; 4] {
    let weighted = |mantissa: u8, part: usize| u32::from(mantissa) * (WEIGHTS[part] * 256.0 + 0.5) as u32;
    let sum = weighted(red, 0) + weighted(green, 1) + weighted(blue, 2);
    [red, (sum >> 8).min(255) as u8, blue, exponent]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_come_back() {
        let table = GammaTable::new(2.2);
        for byte in 0..=255u8 {
            let [red, green, blue] = table.to_bytes(table.pixel([byte; 3]));
            assert!(red.abs_diff(byte) <= 1 && green == red && blue == red, "{byte} {red}");
        }
        assert_eq!(table.to_bytes([255, 128, 0, 140]), [255; 3]);
        assert_eq!(table.to_bytes([0; 4]), [0; 3]);
    }
}
