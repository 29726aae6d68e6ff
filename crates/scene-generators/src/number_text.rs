//! Numbers at the start of a word, parsed as in C's `atof` and `atoi`.

use radsight_units::number::decimal_length;

/// The number at the start of `word` after white space, and its length in bytes including the white
/// space.
///
/// Accepts the decimal syntax of `strtod`: a sign, digits with at most one point, an exponent. Not
/// `inf`, `nan` or hexadecimal.
pub(crate) fn leading_number(word: &str) -> Option<(f64, usize)> {
    let bytes = word.as_bytes();
    let start = skip(bytes, 0, |byte| crate::text::is_space(byte as char));
    let length = decimal_length(bytes.get(start..).unwrap_or_default());
    let end = start + length;
    Some((word[start..end].parse().ok()?, end))
}

/// Largest number of digits that always fit into 53 bits.
const SHORT_DIGITS: usize = 15;

/// Powers of ten, exact in double precision.
const POWERS_OF_TEN: [f64; SHORT_DIGITS + 1] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];

/// The number at the start of `word`, if it has at most 15 digits, all decimal, and no exponent. Faster than
/// [`leading_number`] for the most common numbers, with the same bits, since the quotient of two
/// exact numbers is rounded once.
pub(crate) fn short_decimal(word: &[u8]) -> Option<f64> {
    let is_negative = word.first() == Some(&b'-');
    let digits = if is_negative || word.first() == Some(&b'+') { &word[1..] } else { word };
    let (mut mantissa, mut count, mut point) = (0u64, 0, None);
    for byte in digits {
        match byte {
            b'0'..=b'9' if count == SHORT_DIGITS => return None,
            b'0'..=b'9' => {
                mantissa = 10 * mantissa + u64::from(byte - b'0');
                count += 1;
            }
            b'.' if point.is_none() => point = Some(count),
            b'e' | b'E' => return None,
            b'x' | b'X' if (mantissa, count, point) == (0, 1, None) => return None,
            _ => break,
        }
    }
    if count == 0 {
        return None;
    }
    let value = mantissa as f64 / POWERS_OF_TEN[count - point.unwrap_or(count)];
    Some(if is_negative { -value } else { value })
}

/// The decimal integer at the start of `word` after white space, and its length in bytes including
/// the white space.
pub(crate) fn leading_integer(word: &str) -> Option<(i64, usize)> {
    let bytes = word.as_bytes();
    let start = skip(bytes, 0, |byte| crate::text::is_space(byte as char));
    let digits_start = if matches!(bytes.get(start), Some(b'+' | b'-')) { start + 1 } else { start };
    let end = skip(bytes, digits_start, |byte| byte.is_ascii_digit());
    if end == digits_start {
        return None;
    }
    Some((word[start..end].parse().ok()?, end))
}

/// Whether the whole word is a number, as Radiance's own readers require.
pub(crate) fn whole_number(word: &str) -> Option<f64> {
    leading_number(word).filter(|(_, end)| *end == word.len()).map(|(value, _)| value)
}

fn skip(bytes: &[u8], from: usize, wanted: impl Fn(u8) -> bool) -> usize {
    let rest = bytes.get(from..).unwrap_or_default();
    from + rest.iter().take_while(|byte| wanted(**byte)).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_end_where_c_ends_them() {
        assert_eq!(leading_number(" -.5e1x"), Some((-5.0, 6)));
        assert_eq!(leading_number("1.e"), Some((1.0, 2)));
        assert_eq!(leading_number("+3e+"), Some((3.0, 2)));
        assert_eq!(leading_number("."), None);
        assert_eq!(leading_number("nan"), None);
        assert_eq!(leading_integer("12:30"), Some((12, 2)));
        assert_eq!(leading_integer("99999999999999999999"), None);
    }

    #[test]
    fn short_numbers_have_the_bits_of_all_others() {
        let mut random = 12345u64;
        for _ in 0..20_000 {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let digits = (random >> 20) % 10u64.pow(1 + (random >> 8) as u32 % 15);
            let mut word = digits.to_string();
            word.insert((random >> 40) as usize % (word.len() + 1), '.');
            let word = format!("{}{word}", ["", "-", "+"][(random >> 50) as usize % 3]);
            let (slow, _) = leading_number(&word).unwrap();
            assert_eq!(short_decimal(word.as_bytes()).map(f64::to_bits), Some(slow.to_bits()), "{word}");
        }
        for (word, value) in [
            ("12.5.7", Some(12.5)),
            ("-.5x", Some(-0.5)),
            ("7e3", None),
            ("0x7", None),
            (".", None),
            ("-", None),
            ("", None),
        ] {
            assert_eq!(short_decimal(word.as_bytes()), value, "{word}");
        }
        assert_eq!(short_decimal(b"1234567890123456"), None);
    }
}
