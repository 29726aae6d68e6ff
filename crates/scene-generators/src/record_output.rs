//! Writes records of a format, for `rcalc -o`.

use std::fmt::Write;

use radsight_cal::Handle;

use crate::Error;
use crate::records::InputForm;
use crate::text::{Exponential, Text, general};

/// One part of an output format.
pub(crate) enum OutputField {
    Literal(Vec<u8>),
    Text { name: String, width: usize },
    Number { handle: Handle, width: usize },
}

/// Preserves columns: a value is padded to the width of its field unless other text touches it on
/// both sides.
pub(crate) struct Writer<'a> {
    fields: &'a [OutputField],
    blanks_join: bool,
    /// Whether a non-blank precedes.
    touched: bool,
}

impl<'a> Writer<'a> {
    /// A writer of records that have blanks as the input has.
    pub(crate) fn new(fields: &'a [OutputField], input: &InputForm) -> Self {
        Writer { fields, blanks_join: input.blanks_join, touched: false }
    }

    /// Whether a non-blank follows a field.
    fn touches_next(&self, index: usize) -> bool {
        self.blanks_join
            && match self.fields.get(index + 1) {
                None => false,
                Some(OutputField::Literal(bytes)) => bytes.first() != Some(&b' '),
                Some(_) => true,
            }
    }

    pub(crate) fn literal(&mut self, text: &mut Text, bytes: &[u8]) -> Result<(), Error> {
        self.touched = bytes.last().is_some_and(|byte| *byte != b' ');
        Ok(text.push_bytes(bytes)?)
    }

    pub(crate) fn string(&mut self, text: &mut Text, index: usize, value: &str, width: usize) -> Result<(), Error> {
        self.put(text, index, value, width)
    }

    pub(crate) fn number(&mut self, text: &mut Text, index: usize, value: f64, width: usize) -> Result<(), Error> {
        let size = value.abs();
        let whole = (size + 0.5).floor();
        let is_whole = size < 2_147_483_648.0 && whole != 0.0 && (size - whole).abs() <= size * 1e-14;
        let digits = if is_whole {
            format!("{value:.0}")
        } else if width <= 9 {
            general(value, 6).to_string()
        } else {
            Exponential(value, width - 5).to_string()
        };
        self.put(text, index, &digits, width)
    }

    fn put(&mut self, text: &mut Text, index: usize, value: &str, width: usize) -> Result<(), Error> {
        // Field widths come from the format's length, so padding cannot be long.
        match (self.touched, self.touches_next(index)) {
            (true, true) => text.write_str(value)?,
            (true, false) => write!(text, "{value:<width$}")?,
            (false, _) => write!(text, "{value:>width$}")?,
        }
        self.touched = true;
        Ok(())
    }
}
