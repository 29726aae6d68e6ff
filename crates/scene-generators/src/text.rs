//! Text output with a size limit, and C's `printf` formats of numbers.

use radsight_units::number;
use std::cell::RefCell;
use std::fmt::{self, Display, Formatter, Write};
use std::io;
use std::rc::Rc;

/// Largest output of a command; more is an error instead of exhausted memory.
pub const MAX_OUTPUT_BYTES: usize = 1 << 30;

/// Number of bytes per write to the sink.
const SENT_AT_A_TIME: usize = 1 << 16;

/// The destination of a program's streamed output. The caller keeps the error of a failed write.
pub type Sink = Rc<RefCell<dyn io::Write>>;

/// A program's output, collected or streamed. Writing fails when more than [`MAX_OUTPUT_BYTES`] are
/// collected, or when the sink fails.
#[derive(Default)]
pub(crate) struct Text {
    bytes: Vec<u8>,
    sink: Option<Sink>,
}

impl Drop for Text {
    fn drop(&mut self) {
        // Flush output that precedes a mistake. A failure cannot be reported here.
        let _ = self.flush();
    }
}

impl Text {
    /// Output streamed to a sink, or collected if there is none.
    pub(crate) fn to(sink: Option<Sink>) -> Text {
        Text { bytes: Vec::new(), sink }
    }

    pub(crate) fn into_bytes(mut self) -> Vec<u8> {
        std::mem::take(&mut self.bytes)
    }

    /// Ends the output and returns the part that was not streamed.
    pub(crate) fn finish(mut self) -> Result<Vec<u8>, fmt::Error> {
        self.flush()?;
        Ok(self.into_bytes())
    }

    /// Writes buffered output to the sink. Collected output stays.
    pub(crate) fn flush(&mut self) -> fmt::Result {
        let Some(sink) = &self.sink else { return Ok(()) };
        if self.bytes.is_empty() {
            return Ok(());
        }
        let mut sink = sink.borrow_mut();
        let sent = sink.write_all(&self.bytes).and_then(|()| sink.flush());
        self.bytes.clear();
        sent.map_err(|_| fmt::Error)
    }

    /// Bytes so far.
    pub(crate) fn len(&self) -> usize {
        self.bytes.len()
    }

    /// Appends bytes that need not be UTF-8.
    pub(crate) fn push_bytes(&mut self, bytes: &[u8]) -> fmt::Result {
        if bytes.len() > MAX_OUTPUT_BYTES - self.bytes.len() {
            return Err(fmt::Error);
        }
        self.bytes.extend_from_slice(bytes);
        if self.bytes.len() >= SENT_AT_A_TIME && self.sink.is_some() {
            return self.flush();
        }
        Ok(())
    }

    /// Fails at once if `count` more items of at least `bytes_each` cannot fit.
    pub(crate) fn expect_room(&self, count: f64, bytes_each: f64) -> fmt::Result {
        if self.sink.is_some() {
            return Ok(());
        }
        let wanted = self.bytes.len() as f64 + count * bytes_each;
        if wanted <= MAX_OUTPUT_BYTES as f64 { Ok(()) } else { Err(fmt::Error) }
    }

    /// One line of three coordinates, each `%18.12g`, with a tab before and between them.
    pub(crate) fn vertex(&mut self, x: f64, y: f64, z: f64) -> fmt::Result {
        for number in [x, y, z] {
            self.push_bytes(b"\t")?;
            self.number(wide(number))?;
        }
        self.push_bytes(b"\n")
    }

    /// One line of three numbers, each `%18.12g`, with a space between them.
    pub(crate) fn row(&mut self, [x, y, z]: [f64; 3]) -> fmt::Result {
        for (number, end) in [(x, b" "), (y, b" "), (z, b"\n")] {
            self.number(wide(number))?;
            self.push_bytes(end)?;
        }
        Ok(())
    }

    /// Faster than formatting: meshes consist of numbers.
    fn number(&mut self, number: General) -> fmt::Result {
        let mut buffer = [b' '; FAST_WIDTH];
        match number.write_fast(&mut buffer) {
            Some(start) => self.push_bytes(&buffer[start..]),
            None => write!(self, "{number}"),
        }
    }

    /// The head of a primitive without string and integer arguments, up to the count of real
    /// arguments.
    pub(crate) fn primitive(&mut self, modifier: &str, kind: &str, name: impl Display, numbers: usize) -> fmt::Result {
        write!(self, "\n{modifier} {kind} {name}\n0\n0\n{numbers}\n")
    }

    /// The command as a comment line, with words quoted as in Radiance.
    pub(crate) fn command_comment(&mut self, argv: &[String]) -> fmt::Result {
        self.write_str("#")?;
        for (index, word) in argv.iter().enumerate() {
            let word = if index == 0 { word.rsplit('/').next().unwrap_or(word) } else { word };
            write!(self, " {}", Quoted(&word.replace(['\n', '\r'], " ")))?;
        }
        self.write_str("\n")
    }

    /// The command as a comment line, with words unquoted.
    pub(crate) fn plain_command_comment(&mut self, argv: &[String]) -> fmt::Result {
        writeln!(self, "# {}", argv.join(" ").replace(['\n', '\r'], " "))
    }
}

impl Write for Text {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.push_bytes(text.as_bytes())
    }
}

/// A word as Radiance writes it: quoted when it is empty, has white space, or has a quote inside.
pub(crate) struct Quoted<'a>(pub(crate) &'a str);

impl Display for Quoted<'_> {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        let word = self.0;
        // Of the quotes inside, the last one decides, as in Radiance; one at either end is ignored.
        let inside = word.as_bytes().get(1..word.len().saturating_sub(1)).unwrap_or_default();
        let quote = match inside.iter().rev().find(|byte| matches!(byte, b'"' | b'\'')) {
            Some(b'"') => Some('\''),
            Some(_) => Some('"'),
            None => None,
        };
        match quote {
            Some(quote) => write!(formatter, "{quote}{word}{quote}"),
            None if word.is_empty() || word.contains(is_space) => write!(formatter, "\"{word}\""),
            None => formatter.write_str(word),
        }
    }
}

/// White space as in C's `isspace`.
pub(crate) fn is_space(character: char) -> bool {
    matches!(character, ' ' | '\t' | '\n' | '\r' | '\x0b' | '\x0c')
}

/// A number as C's `%{width}.{precision}g` prints it.
#[derive(Clone, Copy)]
pub struct General {
    value: f64,
    width: usize,
    precision: usize,
}

/// `%18.12g`, the form of most generators.
pub(crate) fn wide(value: f64) -> General {
    General { value, width: 18, precision: 12 }
}

/// `%.{precision}g`.
pub(crate) fn general(value: f64, precision: usize) -> General {
    General { value, width: 0, precision }
}

/// `%{width}.{precision}g`.
#[must_use]
pub fn padded(value: f64, width: usize, precision: usize) -> General {
    General { value, width, precision }
}

impl General {
    /// Writes common numbers at the end of a buffer of spaces. Returns the index of the first character,
    /// padding included; `None` for other numbers.
    fn write_fast(&self, buffer: &mut [u8; FAST_WIDTH]) -> Option<usize> {
        let start = write_fast(buffer, self.value, self.precision)?;
        Some(start.min(FAST_WIDTH.saturating_sub(self.width)))
    }
}

impl Display for General {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        let mut buffer = [b' '; FAST_WIDTH];
        if let Some(start) = self.write_fast(&mut buffer) {
            // The buffer holds digits, a sign and a point only.
            return formatter.write_str(std::str::from_utf8(&buffer[start..]).unwrap_or_default());
        }
        let width = self.width;
        write!(formatter, "{:>width$}", number::general(self.value, self.precision))
    }
}

/// Buffer size of [`write_fast`].
const FAST_WIDTH: usize = 32;

/// Formats common numbers (0 and those of moderate magnitude, up to 15 digits) at the end of the
/// buffer. Returns the index of the first character; `None` for other numbers.
///
/// The digits are computed in integer arithmetic from m·2^q times a power of ten, so they are
/// rounded exactly as in C.
fn write_fast(buffer: &mut [u8; FAST_WIDTH], value: f64, precision: usize) -> Option<usize> {
    let size = value.abs();
    let is_zero = size == 0.0;
    if !(is_zero || (1e-10..1e15).contains(&size)) || !(6..=15).contains(&precision) {
        return None;
    }
    let (mut digits, exponent) = if is_zero { (0, 0) } else { rounded_digits(size, precision)? };
    if exponent >= precision as i32 {
        return None;
    }
    let mut place = FAST_WIDTH;
    let mut put = |byte: u8| {
        place -= 1;
        buffer[place] = byte;
    };
    let mut decimals = precision as i32 - 1;
    if exponent < -4 {
        let exponent = exponent.unsigned_abs() as u8;
        for byte in [b'0' + exponent % 10, b'0' + exponent / 10, b'-', b'e'] {
            put(byte);
        }
    } else {
        // The digit before the point is the first one, or a zero in front of it.
        decimals -= exponent;
    }
    while decimals > 0 && digits.is_multiple_of(10) {
        digits /= 10;
        decimals -= 1;
    }
    put_decimal(&mut put, digits, decimals);
    if value.is_sign_negative() {
        put(b'-');
    }
    Some(place)
}

/// Puts digits of which some are decimals, from the last one to the first.
fn put_decimal(put: &mut impl FnMut(u8), mut digits: u64, decimals: i32) {
    for _ in 0..decimals {
        put(b'0' + (digits % 10) as u8);
        digits /= 10;
    }
    if decimals > 0 {
        put(b'.');
    }
    loop {
        put(b'0' + (digits % 10) as u8);
        digits /= 10;
        if digits == 0 {
            break;
        }
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

/// The exponent of the first digit of a normal number, given its bits, or one less. Bits are about a
/// logarithm to base 2 in fixed point, at most .09 too small.
fn decimal_exponent(bits: u64) -> i32 {
    /// log₁₀ 2 · 2³².
    const LOG_OF_TWO: i64 = 1_292_913_986;
    let logarithm = (bits.cast_signed() - (1023 << 52)) >> 32;
    ((logarithm * LOG_OF_TWO) >> 52) as i32
}

/// The first `precision` digits of a number as an integer, and the decimal exponent of the first
/// digit.
fn rounded_digits(size: f64, precision: usize) -> Option<(u64, i32)> {
    let bits = size.to_bits();
    let (mantissa, power) = ((bits & ((1 << 52) - 1)) | 1 << 52, ((bits >> 52) & 0x7ff) as i32 - 1075);
    let mut exponent = decimal_exponent(bits);
    // It may be off by one near a power of ten.
    for _ in 0..2 {
        let scale = usize::try_from(precision as i32 - 1 - exponent).ok()?;
        let product = u128::from(mantissa).checked_mul(*POWERS_OF_TEN.get(scale)?)?;
        let digits = match u32::try_from(-power) {
            Ok(shift) if shift < 128 => {
                let (whole, rest) = (product >> shift, product & ((1u128 << shift) - 1));
                let half = 1u128 << shift.saturating_sub(1);
                let rounds_up = shift > 0 && (rest > half || rest == half && whole & 1 == 1);
                whole + u128::from(rounds_up)
            }
            Ok(_) => return None,
            Err(_) => product.checked_mul(1u128 << u32::try_from(power).ok()?.min(100))?,
        };
        let smallest = POWERS_OF_TEN[precision - 1];
        if digits < smallest {
            exponent -= 1;
        } else if digits >= 10 * smallest {
            exponent += 1;
        } else {
            return Some((u64::try_from(digits).ok()?, exponent));
        }
    }
    None
}

/// A number as C's `%.{digits}e` prints it: a sign and at least two digits of exponent.
#[derive(Clone, Copy)]
pub(crate) struct Exponential(pub(crate) f64, pub(crate) usize);

impl Display for Exponential {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        formatter.write_str(&number::scientific(self.0, self.1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn general_numbers_are_those_of_c() {
        let cases = [
            (0.0, "0"),
            (-0.0, "-0"),
            (1.0, "1"),
            (0.1, "0.1"),
            (123_456.0, "123456"),
            (1e12, "1e+12"),
            (123_456_789_012.0, "123456789012"),
            (1e-4, "0.0001"),
            (1e-5, "1e-05"),
            (1.0 / 3.0, "0.333333333333"),
            (-2.0 / 3.0 * 1e-7, "-6.66666666667e-08"),
            (1e100, "1e+100"),
            (99_999.999_999_999_9, "100000"),
            (1_234_500_000.25, "1234500000.25"),
        ];
        for (value, expected) in cases {
            assert_eq!(general(value, 12).to_string(), expected);
        }
        assert_eq!(wide(0.5).to_string(), "               0.5");
        assert_eq!(general(1_234_567.0, 6).to_string(), "1.23457e+06");
        assert_eq!(padded(1_234_567.0, 12, 6).to_string(), " 1.23457e+06");
    }

    #[test]
    fn the_fast_way_gives_the_digits_of_the_slow_one() {
        let mut state = 1u64;
        let mut fast = 0;
        for round in 0..200_000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let fraction = (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
            let value = match round % 4 {
                0 => fraction * 10f64.powi((state % 24) as i32 - 8),
                1 => (fraction * 1e6).round() / 8.0,
                2 => 10f64.powi((state % 20) as i32 - 6) * (1.0 + 1e-13 * (state % 9) as f64),
                _ => (fraction * 1e4).round() / 1e3,
            };
            for precision in [6, 9, 12, 15] {
                let slow = number::general(value, precision);
                assert_eq!(general(value, precision).to_string(), slow, "{value:e}");
                fast += usize::from(write_fast(&mut [b' '; FAST_WIDTH], value, precision).is_some());
            }
        }
        assert!(fast > 400_000);
    }

    #[test]
    fn exponents_have_two_digits_and_a_sign() {
        assert_eq!(Exponential(12_345.678, 3).to_string(), "1.235e+04");
        assert_eq!(Exponential(0.0, 3).to_string(), "0.000e+00");
        assert_eq!(Exponential(1e-101, 3).to_string(), "1.000e-101");
    }

    #[test]
    fn words_are_quoted_as_radiance_quotes_them() {
        for (word, expected) in
            [("a", "a"), ("", "\"\""), ("a b", "\"a b\""), ("x'y", "\"x'y\""), ("x\"y", "'x\"y'"), ("x\"", "x\"")]
        {
            assert_eq!(Quoted(word).to_string(), expected);
        }
    }
}
