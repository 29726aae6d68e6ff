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
    pub(crate) fn number(&mut self, number: General) -> fmt::Result {
        let mut buffer = [b' '; number::SHORT];
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
    fn write_fast(&self, buffer: &mut [u8; number::SHORT]) -> Option<usize> {
        let start = number::short_general(self.value, self.precision, buffer)?;
        Some(start.min(number::SHORT.saturating_sub(self.width)))
    }
}

impl Display for General {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        let mut buffer = [b' '; number::SHORT];
        if let Some(start) = self.write_fast(&mut buffer) {
            // The buffer holds digits, a sign and a point only.
            return formatter.write_str(std::str::from_utf8(&buffer[start..]).unwrap_or_default());
        }
        let width = self.width;
        write!(formatter, "{:>width$}", number::general(self.value, self.precision))
    }
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
