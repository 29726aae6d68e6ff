//! Numbers and strings of Radiance's binary files: big-endian integers of any width, floats of a
//! 31-bit mantissa and an exponent, zero-terminated strings (`getint`, `getflt` and `getstr` of
//! Radiance's `portio.c`).

use crate::FormatError;
use radsight_picture::Header;
use std::borrow::Cow;
use std::ffi::CStr;

/// The mantissa that represents one.
const FULL_MANTISSA: f64 = 0x7fff_ffff as f64;

/// Size of a float in bytes.
pub(crate) const FLOAT_SIZE: usize = 5;

/// A reader that advances from the start of a file to its end.
#[derive(Clone, Debug)]
pub(crate) struct Reader<'a> {
    bytes: &'a [u8],
    offset: usize,
}

impl<'a> Reader<'a> {
    /// Reads the header, which must name the format, and continues after it.
    pub(crate) fn new(bytes: &'a [u8], format: &'static str) -> Result<(Header, Self), FormatError> {
        let (header, offset) = Header::read(bytes)?;
        match header.format() {
            Some(found) if found == format => Ok((header, Reader { bytes, offset })),
            found => {
                let found = found.map_or("not stated".to_owned(), |found| format!("\"{found}\""));
                Err(FormatError::Format { found, expected: format })
            }
        }
    }

    /// A reader of bytes without a header.
    #[cfg(test)]
    pub(crate) fn of(bytes: &'a [u8]) -> Self {
        Reader { bytes, offset: 0 }
    }

    pub(crate) fn unexpected(
        &self,
        offset: usize,
        expected: impl Into<Cow<'static, str>>,
        found: impl ToString,
    ) -> FormatError {
        FormatError::Unexpected { offset, expected: expected.into(), found: found.to_string() }
    }

    pub(crate) fn offset(&self) -> usize {
        self.offset
    }

    pub(crate) fn take(&mut self, count: usize, what: &'static str) -> Result<&'a [u8], FormatError> {
        let end = self.offset.checked_add(count).filter(|end| *end <= self.bytes.len());
        let Some(end) = end else {
            return Err(FormatError::Truncated { offset: self.bytes.len(), expected: what.into() });
        };
        let taken = &self.bytes[self.offset..end];
        self.offset = end;
        Ok(taken)
    }

    /// A signed big-endian integer of one to eight bytes.
    pub(crate) fn integer(&mut self, size: usize, what: &'static str) -> Result<i64, FormatError> {
        let bytes = self.take(size, what)?;
        let sign = if bytes.first().is_some_and(|byte| byte & 0x80 != 0) { -1 } else { 0 };
        Ok(bytes.iter().fold(sign, |sum, byte| (sum << 8) | i64::from(*byte)))
    }

    /// An integer within a range.
    pub(crate) fn integer_in(
        &mut self,
        size: usize,
        range: std::ops::RangeInclusive<i64>,
        what: &'static str,
    ) -> Result<usize, FormatError> {
        let offset = self.offset;
        let value = self.integer(size, what)?;
        if range.contains(&value) {
            return Ok(value as usize);
        }
        Err(self.unexpected(offset, format!("{what} from {} to {}", range.start(), range.end()), value))
    }

    /// An unsigned two-byte integer.
    pub(crate) fn count(&mut self, what: &'static str) -> Result<usize, FormatError> {
        Ok((self.integer(2, what)? & 0xffff) as usize)
    }

    /// A four-byte mantissa and a one-byte exponent. Half a unit is added, since writing truncates.
    pub(crate) fn float(&mut self, what: &'static str) -> Result<f64, FormatError> {
        let Some((mantissa, [exponent])) = self.take(FLOAT_SIZE, what)?.split_first_chunk() else { return Ok(0.0) };
        let (mantissa, exponent) = (i32::from_be_bytes(*mantissa), i8::from_be_bytes([*exponent]));
        if mantissa == 0 {
            return Ok(0.0);
        }
        let half = if mantissa < 0 { -0.5 } else { 0.5 };
        Ok((f64::from(mantissa) + half) / FULL_MANTISSA * power_of_two(exponent))
    }

    /// A string without its terminating zero.
    pub(crate) fn string(&mut self, what: &'static str) -> Result<&'a [u8], FormatError> {
        let rest = &self.bytes[self.offset..];
        let Ok(string) = CStr::from_bytes_until_nul(rest) else {
            return Err(FormatError::Truncated { offset: self.bytes.len(), expected: what.into() });
        };
        self.offset += string.count_bytes() + 1;
        Ok(string.to_bytes())
    }

    /// A finite number written as a string.
    pub(crate) fn number_string(&mut self, what: &'static str) -> Result<f64, FormatError> {
        let offset = self.offset;
        let string = self.string(what)?;
        let number = std::str::from_utf8(string).ok().and_then(|text| text.trim().parse::<f64>().ok());
        number
            .filter(|number| number.is_finite())
            .ok_or_else(|| self.unexpected(offset, what, format!("\"{}\"", String::from_utf8_lossy(string))))
    }
}

/// Two to the power of `exponent`.
fn power_of_two(exponent: i8) -> f64 {
    const BIAS: i16 = 1023;
    f64::from_bits(((BIAS + i16::from(exponent)) as u64) << 52)
}

/// Appends a big-endian integer of `size` bytes.
pub(crate) fn push_integer(out: &mut Vec<u8>, value: i64, size: usize) {
    out.extend_from_slice(&value.to_be_bytes()[8 - size..]);
}

/// Appends a float. Overflow gives the largest value, underflow zero.
pub(crate) fn push_float(out: &mut Vec<u8>, value: f64) {
    let (fraction, exponent) = split(value);
    let (mantissa, exponent) = match exponent {
        128.. => (FULL_MANTISSA.copysign(value), 127),
        -128..=127 => ((fraction * FULL_MANTISSA).trunc(), exponent),
        _ => (0.0, 0),
    };
    push_integer(out, mantissa as i64, 4);
    push_integer(out, exponent, 1);
}

/// Appends a zero-terminated string. The string ends before any zero byte of its own.
pub(crate) fn push_string(out: &mut Vec<u8>, string: &[u8]) {
    out.extend(string.iter().take_while(|byte| **byte != 0));
    out.push(0);
}

/// A mantissa from ½ to 1 and a binary exponent, as in C's `frexp`.
fn split(value: f64) -> (f64, i64) {
    if value == 0.0 {
        return (0.0, 0);
    }
    if !value.is_finite() {
        return (value, i64::MAX);
    }
    let mut exponent = 0;
    let mut fraction = value;
    if fraction.abs() < f64::MIN_POSITIVE {
        fraction *= f64::powi(2.0, 64);
        exponent = -64;
    }
    let biased = (fraction.to_bits() >> 52) & 0x7ff;
    exponent += biased as i64 - 1022;
    let bits = (fraction.to_bits() & !(0x7ff << 52)) | (1022 << 52);
    (f64::from_bits(bits), exponent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn integers_keep_their_sign_in_any_width() {
        for size in 1..=8 {
            for value in [0, 1, -1, 100, -128, 127] {
                let mut bytes = Vec::new();
                push_integer(&mut bytes, value, size);
                assert_eq!((bytes.len(), Reader::of(&bytes).integer(size, "").unwrap()), (size, value));
            }
        }
    }

    #[test]
    fn powers_of_two_are_exact() {
        assert!((i8::MIN..=i8::MAX).all(|exponent| power_of_two(exponent) == f64::powi(2.0, exponent.into())));
    }

    #[test]
    fn one_is_what_radiance_writes() {
        let mut bytes = Vec::new();
        push_float(&mut bytes, 1.0);
        assert_eq!(bytes, [0x3f, 0xff, 0xff, 0xff, 1]);
        assert_eq!(Reader::of(&bytes).float("").unwrap(), 1.0);
    }

    #[test]
    fn floats_that_do_not_fit_go_to_the_nearest_end() {
        for (value, read) in [(0.0, 0.0), (1e-300, 0.0), (5e-324, 0.0), (1e300, f64::powi(2.0, 127))] {
            let mut bytes = Vec::new();
            push_float(&mut bytes, value);
            let found = Reader::of(&bytes).float("").unwrap();
            assert!((found - read).abs() <= 1e-9 * read, "{value}: {found}");
        }
    }

    proptest! {
        #[test]
        fn floats_read_back_to_nine_digits(fraction in -1.0..1.0_f64, exponent in -120..120_i32) {
            let value = fraction * f64::powi(2.0, exponent);
            let mut bytes = Vec::new();
            push_float(&mut bytes, value);
            let found = Reader::of(&bytes).float("").unwrap();
            prop_assert!((found - value).abs() <= 5e-10 * value.abs());
        }
    }
}
