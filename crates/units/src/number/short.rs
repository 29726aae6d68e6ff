//! Numbers of moderate magnitude and few digits, printed by integer arithmetic.
//!
//! The digits are those of m·2^q times a power of ten, in 128 bits, so they are rounded exactly as
//! in C.

/// Size of a buffer for a short number: 17 digits, sign, point, four zeros and an exponent.
pub const SHORT: usize = 32;

/// Most digits of a short number.
const MOST_DIGITS: usize = 17;

/// Writes `%.{precision}g` at the end of a buffer and returns the index of the first character;
/// `None` for numbers that are too large, too small or too long.
#[must_use]
pub fn short_general(value: f64, precision: usize, buffer: &mut [u8; SHORT]) -> Option<usize> {
    let (mut digits, exponent) = rounded_digits(value.abs(), precision)?;
    let mut line = Line { buffer, place: SHORT };
    let is_exponential = exponent < -4 || exponent >= precision as i32;
    let mut decimals = precision as i32 - 1;
    if !is_exponential {
        // The digit before the point is the first one, or a zero in front of it.
        decimals -= exponent;
    }
    while decimals > 0 && digits.is_multiple_of(10) {
        digits /= 10;
        decimals -= 1;
    }
    if is_exponential {
        line.put_exponent(exponent);
    }
    line.put_decimal(digits, decimals);
    Some(line.with_sign_of(value))
}

/// Writes `%.{digits}e` as [`short_general`] does.
#[must_use]
pub fn short_scientific(value: f64, digits: usize, buffer: &mut [u8; SHORT]) -> Option<usize> {
    let (all_digits, exponent) = rounded_digits(value.abs(), digits.checked_add(1)?)?;
    let mut line = Line { buffer, place: SHORT };
    line.put_exponent(exponent);
    line.put_decimal(all_digits, digits as i32);
    Some(line.with_sign_of(value))
}

/// A buffer that is filled from its end.
struct Line<'a> {
    buffer: &'a mut [u8; SHORT],
    /// Index of the first character so far.
    place: usize,
}

impl Line<'_> {
    fn put(&mut self, byte: u8) {
        self.place -= 1;
        self.buffer[self.place] = byte;
    }

    fn put_digit(&mut self, digits: &mut u64) {
        self.put(b'0' + (*digits % 10) as u8);
        *digits /= 10;
    }

    /// An exponent of two digits.
    fn put_exponent(&mut self, exponent: i32) {
        let mut size = u64::from(exponent.unsigned_abs());
        self.put_digit(&mut size);
        self.put_digit(&mut size);
        self.put(if exponent < 0 { b'-' } else { b'+' });
        self.put(b'e');
    }

    /// Digits of which some are decimals.
    fn put_decimal(&mut self, mut digits: u64, decimals: i32) {
        for _ in 0..decimals {
            self.put_digit(&mut digits);
        }
        if decimals > 0 {
            self.put(b'.');
        }
        self.put_digit(&mut digits);
        while digits > 0 {
            self.put_digit(&mut digits);
        }
    }

    fn with_sign_of(mut self, value: f64) -> usize {
        if value.is_sign_negative() {
            self.put(b'-');
        }
        self.place
    }
}

/// All that an integer of 128 bits holds.
const POWERS_OF_TEN: [u128; 39] = {
    let mut powers = [1; 39];
    let mut index = 1;
    while index < powers.len() {
        powers[index] = 10 * powers[index - 1];
        index += 1;
    }
    powers
};

/// Largest power of ten whose product with 53 bits has less than 128.
const MOST_SCALE: i32 = 22;

/// The exponent of the first digit of a normal number, given its bits, or one less. Bits are about a
/// logarithm to base 2 in fixed point, at most .09 too small.
fn decimal_exponent(bits: u64) -> i32 {
    /// log₁₀ 2 · 2³².
    const LOG_OF_TWO: i64 = 1_292_913_986;
    let logarithm = (bits.cast_signed() - (1023 << 52)) >> 32;
    ((logarithm * LOG_OF_TWO) >> 52) as i32
}

/// The first `precision` digits of a number that is not negative, as an integer, and the decimal
/// exponent of the first digit.
fn rounded_digits(size: f64, precision: usize) -> Option<(u64, i32)> {
    if size == 0.0 && (1..=MOST_DIGITS).contains(&precision) {
        return Some((0, 0));
    }
    if !(1e-30..1e37).contains(&size) || !(1..=MOST_DIGITS).contains(&precision) {
        return None;
    }
    let bits = size.to_bits();
    let (mantissa, power) = ((bits & ((1 << 52) - 1)) | 1 << 52, ((bits >> 52) & 0x7ff) as i32 - 1075);
    let mut exponent = decimal_exponent(bits);
    let smallest = POWERS_OF_TEN[precision - 1];
    // It may be off by one near a power of ten.
    for _ in 0..2 {
        let scale = precision as i32 - 1 - exponent;
        let digits = match scale {
            0..=MOST_SCALE => scaled_up(mantissa, power, POWERS_OF_TEN[scale as usize])?,
            ..0 => scaled_down(mantissa, power, *POWERS_OF_TEN.get(scale.unsigned_abs() as usize)?),
            _ => return None,
        };
        if digits < smallest {
            exponent -= 1;
        } else if digits >= 10 * smallest {
            exponent += 1;
        } else {
            return Some((digits as u64, exponent));
        }
    }
    None
}

/// mantissa · 2^power · factor, rounded to even; `None` if it exceeds 128 bits.
fn scaled_up(mantissa: u64, power: i32, factor: u128) -> Option<u128> {
    let product = u128::from(mantissa) * factor;
    if power >= 0 {
        let power = power.unsigned_abs();
        return (power < product.leading_zeros()).then(|| product << power);
    }
    let shift = power.unsigned_abs();
    if shift >= u128::BITS {
        return None;
    }
    let (whole, rest, half) = (product >> shift, product & ((1 << shift) - 1), 1 << (shift - 1));
    let rounds_up = rest > half || rest == half && whole & 1 == 1;
    Some(whole + u128::from(rounds_up))
}

/// mantissa · 2^power / divisor, rounded to even, for numbers between the divisor / 10 and 10³⁷.
fn scaled_down(mantissa: u64, power: i32, divisor: u128) -> u128 {
    let (number, divisor) = match power {
        0.. => (u128::from(mantissa) << power, divisor),
        _ => (u128::from(mantissa), divisor << power.unsigned_abs()),
    };
    let (whole, rest) = (number / divisor, number % divisor);
    let rounds_up = 2 * rest > divisor || 2 * rest == divisor && whole & 1 == 1;
    whole + u128::from(rounds_up)
}

#[cfg(test)]
mod tests {
    use super::super::{exact_general, exact_scientific};
    use super::*;

    fn check(value: f64) -> usize {
        let mut short = 0;
        for value in [value, -value] {
            for digits in 0..=17 {
                let mut buffer = [b' '; SHORT];
                if let Some(start) = short_general(value, digits, &mut buffer) {
                    let text = std::str::from_utf8(&buffer[start..]).unwrap();
                    assert_eq!(text, exact_general(value, digits), "%.{digits}g of {value:e}");
                    short += 1;
                }
                if let Some(start) = short_scientific(value, digits, &mut buffer) {
                    let text = std::str::from_utf8(&buffer[start..]).unwrap();
                    assert_eq!(text, exact_scientific(value, digits), "%.{digits}e of {value:e}");
                    short += 1;
                }
            }
        }
        short
    }

    #[test]
    fn short_numbers_have_the_digits_of_exact_ones() {
        let mut state = 1u64;
        let mut short = 0;
        for round in 0..16_000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let fraction = (state >> 11) as f64 / (1u64 << 53) as f64;
            short += check(match round % 6 {
                0 => fraction * 10f64.powi((state % 24) as i32 - 8),
                // Halves and eighths are ties.
                1 => (fraction * 1e6).round() / 8.0,
                2 => 10f64.powi((state % 20) as i32 - 6) * (1.0 + 1e-13 * (state % 9) as f64),
                3 => (fraction * 1e4).round() / 1e3,
                4 => f64::from((fraction * 1e3) as f32),
                _ => f64::from_bits(state),
            });
        }
        assert!(short > 600_000, "{short}");
    }

    #[test]
    fn neighbours_of_powers_of_ten_and_two_have_the_digits_of_exact_numbers() {
        let tens = (-35..42).map(|power| format!("1e{power}").parse::<f64>().expect("a number"));
        let twos = (-110..130).map(|power| 2f64.powi(power));
        let ties = (0..60).map(|power| 0.5 + 2f64.powi(power));
        for value in tens.chain(twos).chain(ties) {
            for neighbour in [value, value.next_up(), value.next_down(), 5.0 * value, 9.995 * value, 9.999_995 * value]
            {
                check(neighbour);
            }
        }
        for value in [0.0, f64::MIN_POSITIVE, 5e-324, f64::MAX, f64::INFINITY, f64::NAN] {
            check(value);
        }
    }
}
