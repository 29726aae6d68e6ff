//! Bit depth of grey values, and their rounding.

use crate::SensorError;

/// Bit depth of a grey value: 8, 10, 12, 14 or 16. More than 8 bits are stored in 16-bit pictures,
/// without scaling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BitDepth(u8);

impl BitDepth {
    /// Grey values 0 to 255.
    pub const EIGHT: BitDepth = BitDepth(8);
    /// Grey values 0 to 65535.
    pub const SIXTEEN: BitDepth = BitDepth(16);
    /// The supported bit depths.
    pub const ALL: [u8; 5] = [8, 10, 12, 14, 16];

    /// Checks a bit depth.
    ///
    /// # Errors
    /// If it is not one of [`BitDepth::ALL`].
    pub fn new(bits: i64) -> Result<Self, SensorError> {
        let known = BitDepth::ALL.into_iter().find(|&known| i64::from(known) == bits);
        known.map(BitDepth).ok_or(SensorError::Bits { bits })
    }

    /// Number of bits.
    #[must_use]
    pub fn bits(self) -> u8 {
        self.0
    }

    /// The largest grey value.
    #[must_use]
    pub fn largest(self) -> u16 {
        u16::MAX >> (16 - self.0)
    }

    /// Rounds half away from zero and clamps to 0…[`largest`](Self::largest). NaN becomes 0.
    #[must_use]
    pub fn quantise(self, grey: f64) -> u16 {
        (grey.round() as u16).min(self.largest())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_round_away_from_zero_and_values_are_clamped() {
        let eight = BitDepth::EIGHT;
        assert_eq!([0.5, 1.5, 2.5, 2.499].map(|grey| eight.quantise(grey)), [1, 2, 3, 2]);
        assert_eq!([-7.0, 1e300, f64::NAN, 254.6].map(|grey| eight.quantise(grey)), [0, 255, 0, 255]);
        assert_eq!(BitDepth::new(12).unwrap().quantise(1e9), 4095);
        assert_eq!(BitDepth::SIXTEEN.quantise(1e9), 65535);
    }

    #[test]
    fn an_unsupported_bit_depth_is_rejected() {
        assert_eq!(BitDepth::new(9).unwrap_err().to_string(), "bits must be 8, 10, 12, 14 or 16, not 9");
    }
}
