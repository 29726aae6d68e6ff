//! Records of numbers as `rcalc` and `total` read and write them: lines of columns, or binary
//! numbers.

use crate::Error;
use crate::arguments::Arguments;
use crate::number_text::short_decimal;
use crate::supply::Supply;
use crate::text::{Text, is_space};
use radsight_units::number::number_or_zero;

/// Largest binary record, bytes.
const LARGEST_BINARY_RECORD: usize = 16_384;

/// The encoding of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Encoding {
    /// As text.
    Ascii,
    /// As IEEE numbers.
    Binary(BinaryNumber),
}

/// The form of an IEEE number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BinaryNumber {
    /// 8 bytes instead of 4.
    double: bool,
    /// Big-endian.
    swapped: bool,
}

impl Encoding {
    /// The encoding named by the first letter of the text after `-i` or `-o`.
    pub(crate) fn of_text(text: &str) -> Option<Encoding> {
        match text.as_bytes().first()? {
            b'a' => Some(Encoding::Ascii),
            b'd' => Some(Encoding::Binary(BinaryNumber { double: true, swapped: false })),
            b'D' => Some(Encoding::Binary(BinaryNumber { double: true, swapped: true })),
            b'f' => Some(Encoding::Binary(BinaryNumber { double: false, swapped: false })),
            b'F' => Some(Encoding::Binary(BinaryNumber { double: false, swapped: true })),
            _ => None,
        }
    }

    /// Bytes of a binary number.
    fn size(self) -> usize {
        match self {
            Encoding::Binary(BinaryNumber { double: true, .. }) => 8,
            _ => 4,
        }
    }
}

/// The format of input records.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InputForm {
    pub(crate) encoding: Encoding,
    /// Numbers per binary record.
    pub(crate) columns: usize,
    /// Separator of columns.
    pub(crate) separator: u8,
    /// Whether runs of white space form one separator, if the separator is white space.
    pub(crate) blanks_join: bool,
}

impl InputForm {
    /// Parses the one-byte text of the option `-t`.
    pub(crate) fn take_separator(&mut self, text: &str, arguments: &Arguments<'_>) -> Result<(), Error> {
        let &[separator] = text.as_bytes() else { return Err(arguments.unknown()) };
        self.separator = separator;
        Ok(())
    }

    /// Parses the text of an option such as `-id3`.
    pub(crate) fn take_encoding(&mut self, text: &str, arguments: &Arguments<'_>) -> Result<(), Error> {
        self.encoding = Encoding::of_text(text).ok_or_else(|| arguments.unknown())?;
        let digits = text.get(1..).unwrap_or_default();
        self.columns = crate::number_text::leading_integer(digits).map_or(1, |(count, _)| count.max(0) as usize);
        if self.columns.saturating_mul(self.encoding.size()) > LARGEST_BINARY_RECORD {
            let position = arguments.position() - 1;
            return Err(arguments.mistake(position, format!("{} columns are more than a record holds", self.columns)));
        }
        Ok(())
    }

    /// The next record, or `None` at the end. Flushes `text` before it reads more.
    pub(crate) fn next_record<'a>(
        &self,
        supply: &'a mut Supply<'_>,
        text: &mut Text,
    ) -> Result<Option<Record<'a>>, Error> {
        let range = match self.encoding {
            Encoding::Ascii => supply.line(text)?,
            Encoding::Binary(_) => match self.columns * self.encoding.size() {
                0 => None,
                length => supply.exactly(length, text)?,
            },
        };
        Ok(range.map(|range| Record { bytes: supply.bytes(range), form: *self }))
    }

    /// What is left of binary input where no whole record is: a record of fewer numbers, `None` if there is none.
    pub(crate) fn last_record<'a>(&self, supply: &'a mut Supply<'_>) -> Option<Record<'a>> {
        let size = self.encoding.size();
        let columns = match self.encoding {
            Encoding::Ascii => 0,
            Encoding::Binary(_) => supply.window().len() / size,
        };
        let range = supply.take(columns * size);
        (columns > 0).then(|| Record { bytes: supply.bytes(range), form: InputForm { columns, ..*self } })
    }
}

/// One line, or one row of binary numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Record<'a> {
    pub(crate) bytes: &'a [u8],
    form: InputForm,
}

impl Record<'_> {
    /// The value of a column, from 1; zero if it does not exist.
    pub(crate) fn column(&self, column: usize) -> f64 {
        match self.form.encoding {
            Encoding::Ascii => number_at_start(self.field(column)),
            Encoding::Binary(_) if column > self.form.columns => 0.0,
            Encoding::Binary(number) => {
                let size = self.form.encoding.size();
                let field = &self.bytes[(column - 1) * size..column * size];
                decode(field, number)
            }
        }
    }

    /// Number of columns.
    pub(crate) fn columns(&self) -> usize {
        if self.form.encoding != Encoding::Ascii {
            return self.form.columns;
        }
        let mut rest = self.bytes;
        let mut count = 0;
        while !rest.is_empty() {
            if self.joins() {
                rest = skip(rest, is_blank);
                count += usize::from(!rest.is_empty());
                rest = skip(rest, |byte| !is_blank(byte));
            } else {
                count += usize::from(rest[0] != b'\n');
                rest = self.behind_separator(rest);
            }
        }
        count
    }

    fn joins(&self) -> bool {
        self.form.blanks_join && is_blank(self.form.separator)
    }

    fn field(&self, column: usize) -> &[u8] {
        let mut rest = self.bytes;
        for _ in 1..column {
            if rest.is_empty() {
                break;
            }
            rest = if self.joins() {
                skip(skip(rest, is_blank), |byte| !is_blank(byte))
            } else {
                self.behind_separator(rest)
            };
        }
        rest
    }

    fn behind_separator<'a>(&self, rest: &'a [u8]) -> &'a [u8] {
        let rest = skip(rest, |byte| byte != self.form.separator);
        rest.get(1..).unwrap_or_default()
    }
}

fn skip(bytes: &[u8], wanted: impl Fn(u8) -> bool) -> &[u8] {
    let count = bytes.iter().take_while(|byte| wanted(**byte)).count();
    &bytes[count..]
}

pub(crate) fn is_blank(byte: u8) -> bool {
    is_space(byte as char)
}

/// C's `atof` of the bytes.
pub(crate) fn number_at_start(bytes: &[u8]) -> f64 {
    let word = skip(bytes, is_blank);
    if let Some(value) = short_decimal(word) {
        return value;
    }
    number_or_zero(word)
}

/// A binary number.
fn decode(field: &[u8], BinaryNumber { double, swapped }: BinaryNumber) -> f64 {
    let mut bytes = [0u8; 8];
    bytes[..field.len()].copy_from_slice(field);
    if swapped {
        bytes[..field.len()].reverse();
    }
    match double {
        true => f64::from_le_bytes(bytes),
        false => f64::from(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
    }
}

/// Appends a binary number.
pub(crate) fn encode(text: &mut Text, value: f64, BinaryNumber { double, swapped }: BinaryNumber) -> Result<(), Error> {
    let (mut bytes, size) = match double {
        true => (value.to_le_bytes(), 8),
        false => {
            let [a, b, c, d] = (value as f32).to_le_bytes();
            ([a, b, c, d, 0, 0, 0, 0], 4)
        }
    };
    if swapped {
        bytes[..size].reverse();
    }
    Ok(text.push_bytes(&bytes[..size])?)
}
