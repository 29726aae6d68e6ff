//! The format of output values: numbers or pixels.

use radsight_picture::{Header, encode_spectrum, put_scientific};
use radsight_pinhole::stream::NumberFormat;

/// The format of output values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OutputFormat {
    /// As text or binary numbers.
    Numbers(NumberFormat),
    /// Four-byte pixels.
    Pixels,
}

/// Decimals of a number in text.
const DIGITS: usize = 6;

/// Length of such a number with its sign and a tab.
const CHARACTERS: usize = DIGITS + 8;

impl OutputFormat {
    /// The formats of input and output for letters after `-f`; one letter sets both. `None` for
    /// other letters.
    pub(crate) fn pair_from_letters(letters: &str) -> Option<(NumberFormat, OutputFormat)> {
        let mut letters = letters.chars();
        let input = letters.next().and_then(NumberFormat::from_letter)?;
        let output = match letters.next() {
            None => OutputFormat::Numbers(input),
            Some('c') => OutputFormat::Pixels,
            Some(letter) => OutputFormat::Numbers(NumberFormat::from_letter(letter)?),
        };
        letters.next().is_none().then_some((input, output))
    }

    /// The name of the format in a header; `pixels` is the name of the pixel format.
    pub(crate) fn name(self, pixels: &str) -> &str {
        match self {
            OutputFormat::Numbers(NumberFormat::Ascii) => "ascii",
            OutputFormat::Numbers(NumberFormat::Float) => "float",
            OutputFormat::Numbers(NumberFormat::Double) => "double",
            OutputFormat::Pixels => pixels,
        }
    }

    /// Ends a header with byte order and format; `pixels` is the name of the pixel format.
    pub(crate) fn end_header(self, header: &mut Header, pixels: &str) {
        if matches!(self, OutputFormat::Numbers(NumberFormat::Float | NumberFormat::Double)) {
            header.push_variable("BigEndian", if cfg!(target_endian = "big") { "1" } else { "0" });
        }
        header.push_variable("FORMAT", self.name(pixels));
    }

    /// Appends numbers, in text each with a tab after it, or the pixel of three numbers.
    pub(crate) fn put(self, values: &[f64], out: &mut Vec<u8>) {
        match self {
            OutputFormat::Numbers(NumberFormat::Ascii) => {
                out.reserve(CHARACTERS * values.len());
                for value in values {
                    put_scientific(*value, DIGITS, out);
                    out.push(b'\t');
                }
            }
            OutputFormat::Numbers(format) => format.encode(values, out),
            OutputFormat::Pixels => {
                let single: Vec<f32> = values.iter().map(|value| *value as f32).collect();
                let start = out.len();
                out.resize(start + single.len() + 1, 0);
                encode_spectrum(&single, &mut out[start..]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use radsight_picture::scientific;

    #[test]
    fn numbers_are_formatted_as_in_c() {
        assert_eq!(scientific(0.05, DIGITS), "5.000000e-02");
        assert_eq!(scientific(-1e10, DIGITS), "-1.000000e+10");
        assert_eq!(scientific(1e-123, DIGITS), "1.000000e-123");
    }
}
