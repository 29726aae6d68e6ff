//! Numbers as C's `atof` reads them and `printf` writes them.

mod short;

pub use short::{SHORT, short_general, short_scientific};

/// The number at the start of the text, after white space, and the bytes it takes; 0 bytes if there
/// is none.
#[must_use]
pub fn leading_number(text: &[u8]) -> (f64, usize) {
    let start = text.iter().position(|byte| !is_space(*byte)).unwrap_or(text.len());
    let body = &text[start..];
    if let Some((value, length)) = hexadecimal(body) {
        return (value, start + length);
    }
    let length = decimal_length(body).max(word_length(body));
    let number = std::str::from_utf8(&body[..length]).ok().and_then(|number| number.parse().ok());
    match number {
        Some(value) => (value, start + length),
        None => (0.0, 0),
    }
}

/// The number at the start of the text, 0 if there is none: `atof`.
#[must_use]
pub fn number_or_zero(text: &[u8]) -> f64 {
    leading_number(text).0
}

/// Up to `N` numbers separated by white space; `None` unless all are there.
#[must_use]
pub fn leading_numbers<const N: usize>(text: &[u8]) -> Option<[f64; N]> {
    let mut rest = text;
    let mut numbers = [0.0; N];
    for number in &mut numbers {
        let (value, used) = leading_number(rest);
        if used == 0 {
            return None;
        }
        *number = value;
        rest = &rest[used..];
    }
    Some(numbers)
}

/// The integer at the start of the text, clamped, 0 if there is none: `atoi`.
#[must_use]
pub fn integer_or_zero(text: &[u8]) -> i64 {
    let start = text.iter().position(|byte| !is_space(*byte)).unwrap_or(text.len());
    let sign = usize::from(matches!(text.get(start), Some(b'+' | b'-')));
    let negative = text.get(start) == Some(&b'-');
    let digits = text[start + sign..].iter().take_while(|byte| byte.is_ascii_digit());
    let magnitude = digits.fold(0i64, |sum, digit| sum.saturating_mul(10).saturating_add(i64::from(digit - b'0')));
    if negative { -magnitude } else { magnitude }
}

/// C's `isspace`.
#[must_use]
pub fn is_space(byte: u8) -> bool {
    byte == b' ' || (9..=13).contains(&byte)
}

/// The text without white space at either end.
#[must_use]
pub fn trimmed(text: &[u8]) -> &[u8] {
    let start = text.iter().position(|byte| !is_space(*byte)).unwrap_or(text.len());
    let end = text.iter().rposition(|byte| !is_space(*byte)).map_or(start, |last| last + 1);
    &text[start..end]
}

/// Whether the whole text is a number in Radiance's sense: `-.5e3` is one, `1-` and `nan` are not.
#[must_use]
pub fn is_number(text: &[u8]) -> bool {
    let text = trimmed(text);
    !text.is_empty() && decimal_length(text) == text.len()
}

/// Length in bytes of the decimal number at the start: a sign, digits with at most one point, an
/// exponent; 0 if there is none.
#[must_use]
pub fn decimal_length(text: &[u8]) -> usize {
    let digits = |from: usize| text[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let mut at = usize::from(matches!(text.first(), Some(b'+' | b'-')));
    let whole = digits(at);
    at += whole;
    let mut fraction = 0;
    if text.get(at) == Some(&b'.') {
        fraction = digits(at + 1);
        if whole + fraction > 0 {
            at += 1 + fraction;
        }
    }
    if whole + fraction == 0 {
        return 0;
    }
    if matches!(text.get(at), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(text.get(at + 1), Some(b'+' | b'-')));
        let exponent = digits((at + 1 + sign).min(text.len()));
        if exponent > 0 {
            at += 1 + sign + exponent;
        }
    }
    at
}

/// A hexadecimal number such as `0x1.8p3` and its length in bytes; `None` for another one.
fn hexadecimal(text: &[u8]) -> Option<(f64, usize)> {
    let sign = usize::from(matches!(text.first(), Some(b'+' | b'-')));
    let body = text[sign..].strip_prefix(b"0x").or_else(|| text[sign..].strip_prefix(b"0X"))?;
    let (mut value, mut digits, mut point) = (0.0, 0, None);
    for &byte in body {
        match (char::from(byte).to_digit(16), byte) {
            (Some(digit), _) => {
                value = value * 16.0 + f64::from(digit);
                digits += 1;
            }
            (None, b'.') if point.is_none() => point = Some(digits),
            _ => break,
        }
    }
    if digits == 0 {
        return None;
    }
    let places = digits - point.unwrap_or(digits);
    let mut length = sign + 2 + digits + usize::from(point.is_some());
    let mut exponent = -4 * places as i64;
    if let [b'p' | b'P', rest @ ..] = &text[length..] {
        let of_sign = usize::from(matches!(rest.first(), Some(b'+' | b'-')));
        let power = rest[of_sign..].iter().take_while(|byte| byte.is_ascii_digit()).count();
        if power > 0 {
            exponent = exponent.saturating_add(integer_or_zero(rest));
            length += 1 + of_sign + power;
        }
    }
    // Beyond these, the result is 0 or infinite.
    let value: f64 = scaled_by_power_of_two(value, exponent.clamp(-1 << 14, 1 << 14) as i32);
    Some((if text.first() == Some(&b'-') { -value } else { value }, length))
}

/// `value` · 2^`exponent`, in steps whose factors do not overflow.
fn scaled_by_power_of_two(mut value: f64, mut exponent: i32) -> f64 {
    while exponent != 0 {
        let step = exponent.clamp(-1000, 1000);
        value *= 2f64.powi(step);
        exponent -= step;
    }
    value
}

fn word_length(text: &[u8]) -> usize {
    let sign = usize::from(matches!(text.first(), Some(b'+' | b'-')));
    let rest = text[sign..].to_ascii_lowercase_prefix(8);
    ["infinity", "inf", "nan"].iter().find(|word| rest.starts_with(word.as_bytes())).map_or(0, |word| sign + word.len())
}

trait LowercasePrefix {
    fn to_ascii_lowercase_prefix(&self, length: usize) -> Vec<u8>;
}

impl LowercasePrefix for [u8] {
    fn to_ascii_lowercase_prefix(&self, length: usize) -> Vec<u8> {
        self[..length.min(self.len())].to_ascii_lowercase()
    }
}

/// Format `%.{digits}e`.
#[must_use]
pub fn scientific(value: f64, digits: usize) -> String {
    let mut buffer = [b' '; SHORT];
    match short_scientific(value, digits, &mut buffer) {
        Some(start) => String::from_utf8_lossy(&buffer[start..]).into_owned(),
        None => exact_scientific(value, digits),
    }
}

/// Appends a number in the format `%.{digits}e`.
pub fn put_scientific(value: f64, digits: usize, out: &mut Vec<u8>) {
    let mut buffer = [b' '; SHORT];
    match short_scientific(value, digits, &mut buffer) {
        Some(start) => out.extend_from_slice(&buffer[start..]),
        None => out.extend_from_slice(exact_scientific(value, digits).as_bytes()),
    }
}

/// Format `%.{precision}g`.
#[must_use]
pub fn general(value: f64, precision: usize) -> String {
    let mut buffer = [b' '; SHORT];
    match short_general(value, precision, &mut buffer) {
        Some(start) => String::from_utf8_lossy(&buffer[start..]).into_owned(),
        None => exact_general(value, precision),
    }
}

/// Appends a number in the format `%.{precision}g`.
pub fn put_general(value: f64, precision: usize, out: &mut Vec<u8>) {
    let mut buffer = [b' '; SHORT];
    match short_general(value, precision, &mut buffer) {
        Some(start) => out.extend_from_slice(&buffer[start..]),
        None => out.extend_from_slice(exact_general(value, precision).as_bytes()),
    }
}

/// `%.{digits}e` of any number.
fn exact_scientific(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return not_finite(value);
    }
    let text = format!("{value:.digits$e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    // The exponent has a sign and at least two digits.
    let (sign, size) = exponent.strip_prefix('-').map_or(('+', exponent), |size| ('-', size));
    format!("{mantissa}e{sign}{size:0>2}")
}

/// `%.{precision}g` of any number.
fn exact_general(value: f64, precision: usize) -> String {
    if !value.is_finite() {
        return not_finite(value);
    }
    let precision = precision.max(1);
    let rounded = format!("{value:.*e}", precision - 1);
    let exponent: i32 = rounded.split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0);
    let places = i32::try_from(precision).unwrap_or(i32::MAX) - 1 - exponent;
    if exponent < -4 || places < 0 {
        let text = exact_scientific(value, precision - 1);
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "+00"));
        return format!("{}e{exponent}", without_trailing_zeros(mantissa));
    }
    without_trailing_zeros(&format!("{value:.*}", usize::try_from(places).unwrap_or(0))).to_owned()
}

fn without_trailing_zeros(number: &str) -> &str {
    if number.contains('.') { number.trim_end_matches('0').trim_end_matches('.') } else { number }
}

fn not_finite(value: f64) -> String {
    let word = if value.is_nan() { "nan" } else { "inf" };
    if value.is_sign_negative() { format!("-{word}") } else { word.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_print_as_in_c() {
        assert_eq!(scientific(5.062261, 4), "5.0623e+00");
        assert_eq!(scientific(-1.5e-300, 3), "-1.500e-300");
        let cases = [
            (0.1, 5, "0.1"),
            (100_000.0, 5, "1e+05"),
            (99_999.4, 5, "99999"),
            (99_999.6, 5, "1e+05"),
            (0.0001, 6, "0.0001"),
            (0.00001, 6, "1e-05"),
            (-64.825, 7, "-64.825"),
            (0.0, 6, "0"),
            (f64::INFINITY, 3, "inf"),
        ];
        for (value, precision, text) in cases {
            assert_eq!(general(value, precision), text);
        }
    }

    #[test]
    fn numbers_read_as_in_c() {
        assert_eq!(leading_number(b"  1.5e3x"), (1500.0, 7));
        assert_eq!(leading_number(b" -0x1.8p3z"), (-12.0, 9));
        assert_eq!(leading_number(b"0x10"), (16.0, 4));
        assert_eq!(leading_number(b"0x.8P-1"), (0.25, 7));
        assert_eq!(leading_number(b"0xg"), (0.0, 1));
        assert_eq!(leading_number(b"0x1p-99999"), (0.0, 10));
        assert_eq!(leading_number(b"1e"), (1.0, 1));
        assert_eq!(leading_number(b".5 "), (0.5, 2));
        assert_eq!(leading_number(b"1.e2"), (100.0, 4));
        assert_eq!(leading_number(b"."), (0.0, 0));
        assert_eq!(leading_number(b""), (0.0, 0));
        assert_eq!(leading_number(b"-Inf").0, f64::NEG_INFINITY);
        assert_eq!(integer_or_zero(b"     512     "), 512);
        assert_eq!(integer_or_zero(b"-99999999999999999999999"), -i64::MAX);
        assert!(is_number(b" -.5e+3 ") && is_number(b"1.") && !is_number(b"6-") && !is_number(b"nan"));
    }
}
