//! A fast parser of decimal numbers.

/// Powers of ten that `f64` holds exactly.
const EXACT_POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];

/// Parses a whole word as a real number: an optional sign, digits with at most one point, an
/// optional exponent.
///
/// A number out of range gives an infinity. `inf`, `nan`, hexadecimal and trailing text give
/// `None`.
#[must_use]
pub fn parse_real(word: &[u8]) -> Option<f64> {
    leading_real(word).filter(|(_, length)| *length == word.len()).map(|(value, _)| value)
}

/// Parses a whole word as a decimal 64-bit integer.
#[must_use]
pub fn parse_integer(word: &[u8]) -> Option<i64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// The number at the start of `text`, and its length in bytes.
pub(super) fn leading_real(text: &[u8]) -> Option<(f64, usize)> {
    let digit = |at: usize| text.get(at).map(|byte| byte.wrapping_sub(b'0')).filter(|digit| *digit < 10);
    let negative = text.first() == Some(&b'-');
    let mut at = usize::from(negative || text.first() == Some(&b'+'));
    let first = at;
    let mut mantissa = 0_u64;
    while let Some(value) = digit(at) {
        mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(value));
        at += 1;
    }
    let mut digits = at - first;
    let mut exponent = 0_i64;
    if text.get(at) == Some(&b'.') {
        at += 1;
        let fraction = at;
        while let Some(value) = digit(at) {
            mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(value));
            at += 1;
        }
        digits += at - fraction;
        exponent -= (at - fraction) as i64;
    }
    if digits == 0 {
        return None;
    }
    if matches!(text.get(at), Some(b'e' | b'E')) {
        let (power, end) = exponent_digits(text, at + 1)?;
        exponent += power;
        at = end;
    }
    // Clinger's fast path: the product or quotient of an exact integer and an exact power of ten is
    // rounded once.
    let is_exact = digits <= 19 && mantissa <= 1 << 53 && exponent.abs() <= 22;
    let value = if is_exact {
        let power = EXACT_POWERS[exponent.unsigned_abs() as usize];
        let size = if exponent < 0 { mantissa as f64 / power } else { mantissa as f64 * power };
        if negative { -size } else { size }
    } else {
        std::str::from_utf8(&text[..at]).ok()?.parse().ok()?
    };
    Some((value, at))
}

fn exponent_digits(text: &[u8], from: usize) -> Option<(i64, usize)> {
    let negative = text.get(from) == Some(&b'-');
    let first = from + usize::from(negative || text.get(from) == Some(&b'+'));
    let digits = text[first.min(text.len())..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    if digits == 0 {
        return None;
    }
    let power = text[first..first + digits].iter().fold(0_i64, |power, byte| {
        // Beyond this bound every number is zero or infinite, so the exact power no longer matters.
        (power * 10 + i64::from(byte - b'0')).min(1_000_000_000)
    });
    Some((if negative { -power } else { power }, first + digits))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn all_the_forms_of_real_files_are_numbers() {
        for (word, value) in [
            (".5", 0.5),
            ("1.", 1.0),
            ("1e3", 1000.0),
            ("-.5E-2", -0.005),
            ("+7", 7.0),
            ("00012", 12.0),
            ("0.1000000000000000055511151231257827", 0.1),
            ("123456789012345678901234567890", 1.234_567_890_123_456_8e29),
        ] {
            assert_eq!(parse_real(word.as_bytes()), Some(value), "{word}");
        }
        assert_eq!(parse_real(b"1e999"), Some(f64::INFINITY));
        assert_eq!(parse_real(b"1e-99999999999999999999"), Some(0.0));
    }

    #[test]
    fn other_words_are_not_numbers() {
        for word in ["", ".", "-", "+.", "1e", "1e+", "nan", "inf", "0x10", "1.2.3", "5mm", "1 ", "--1", "e5"] {
            assert_eq!(parse_real(word.as_bytes()), None, "{word}");
        }
        assert_eq!(parse_integer(b"5."), None);
        assert_eq!(parse_integer(b"99999999999999999999"), None);
    }

    proptest! {
        #[test]
        fn every_number_reads_as_the_standard_library_reads_it(value in any::<f64>().prop_filter("finite", |v| v.is_finite()), precision in 0_usize..20) {
            for text in [format!("{value}"), format!("{value:e}"), format!("{value:.precision$e}")] {
                prop_assert_eq!(parse_real(text.as_bytes()), text.parse().ok());
            }
        }

        #[test]
        fn short_decimals_read_as_the_standard_library_reads_them(text in "-?[0-9]{0,9}\\.[0-9]{1,9}(e-?[0-9]{1,2})?") {
            prop_assert_eq!(parse_real(text.as_bytes()), text.parse().ok());
        }
    }
}
