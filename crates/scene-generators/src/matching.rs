//! Matches records of a format in text, for `rcalc -i`.

use std::collections::HashMap;

use crate::Error;
use crate::record_format::Field;
use crate::records::{is_blank, number_at_start};
use crate::supply::Supply;
use crate::text::Text;

/// The input without records that is copied to the output.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Passing {
    Nothing,
    /// `-p`
    Unmatched,
    /// `-P`
    UnmatchedAndRefused,
}

/// Longest field of the input, bytes.
const LONGEST_FIELD: usize = 1023;

/// The string variables.
#[derive(Default)]
pub(crate) struct Strings {
    presets: HashMap<String, String>,
    matched: HashMap<String, String>,
}

impl Strings {
    /// Parses `name=value` of the option `-s`; words without an equals sign are ignored.
    pub(crate) fn preset(&mut self, equation: &str) {
        if let Some((name, value)) = equation.split_once('=') {
            self.presets.insert(name.to_owned(), value.to_owned());
        }
    }

    pub(crate) fn value(&self, name: &str) -> Option<&str> {
        self.presets.get(name).or_else(|| self.matched.get(name)).map(String::as_str)
    }
}

/// Searches an input for records.
pub(crate) struct Matcher<'a> {
    fields: Vec<&'a Field>,
    /// The first literal without its leading blanks, with which no record begins.
    first_literal: Option<Vec<u8>>,
    /// The input; its window begins at the current record.
    input: Supply<'a>,
    /// Offset up to which the current record is matched.
    position: usize,
    blanks: Blanks,
    passing: Passing,
    numbers: Vec<(&'a str, f64)>,
}

/// How blanks of a format match blanks of the input.
#[derive(Clone, Copy)]
pub(crate) struct Blanks {
    /// Whether a run of blanks matches any other.
    pub(crate) join: bool,
    /// Whether records extend over lines, so that line ends are blanks.
    pub(crate) across_lines: bool,
}

impl Blanks {
    fn contain(self, byte: u8) -> bool {
        if self.across_lines { is_blank(byte) } else { byte == b' ' || byte == b'\t' }
    }
}

impl<'a> Matcher<'a> {
    pub(crate) fn new(fields: &'a [Field], input: Supply<'a>, blanks: Blanks, passing: Passing) -> Self {
        let mut fields: Vec<&Field> = fields.iter().collect();
        let mut matcher_literal = None;
        if blanks.join
            && let Some(Field::Literal(bytes)) = fields.first()
        {
            let leading = bytes.iter().take_while(|byte| blanks.contain(**byte)).count();
            if leading == bytes.len() {
                fields.remove(0);
            } else {
                matcher_literal = Some(bytes[leading..].to_vec());
            }
        }
        Matcher { fields, first_literal: matcher_literal, input, position: 0, blanks, passing, numbers: Vec::new() }
    }

    /// The numbers of the current record.
    pub(crate) fn numbers(&self) -> &[(&'a str, f64)] {
        &self.numbers
    }

    /// Whether the current record is empty, so that it would match again.
    pub(crate) fn is_empty_match(&self) -> bool {
        self.position == 0
    }

    /// Finds the next record; false at the end of the input.
    pub(crate) fn next_record(&mut self, strings: &mut Strings, text: &mut Text) -> Result<bool, Error> {
        while self.peek(text)?.is_some() {
            if self.blanks.join {
                while self.peek(text)?.is_some_and(|byte| self.blanks.contain(byte)) {
                    self.skip(text)?;
                }
            }
            let Some(first) = self.peek(text)? else { return Ok(false) };
            let eats_line = !self.blanks.across_lines && first != b'\n';
            strings.matched.clear();
            self.numbers.clear();
            if self.fields(strings, text)? {
                return Ok(true);
            }
            self.skip(text)?;
            if eats_line {
                while self.peek(text)?.is_some_and(|byte| byte != b'\n') {
                    self.skip(text)?;
                }
                if self.peek(text)?.is_none() {
                    return Ok(false);
                }
                self.skip(text)?;
            }
        }
        Ok(false)
    }

    /// Advances past the current record.
    pub(crate) fn accept(&mut self) {
        self.input.take(self.position);
        self.position = 0;
    }

    /// Advances past the current record, which is copied if requested.
    pub(crate) fn refuse(&mut self, text: &mut Text) -> Result<(), Error> {
        let record = self.input.take(self.position);
        if self.passing == Passing::UnmatchedAndRefused {
            text.push_bytes(self.input.bytes(record))?;
        }
        self.position = 0;
        Ok(())
    }

    fn peek(&mut self, text: &mut Text) -> Result<Option<u8>, Error> {
        while self.position >= self.input.window().len() {
            if !self.input.more(text)? {
                return Ok(None);
            }
        }
        Ok(Some(self.input.window()[self.position]))
    }

    /// Skips one byte and tries to match a record after it.
    fn skip(&mut self, text: &mut Text) -> Result<(), Error> {
        let byte = self.input.take(1);
        if self.passing != Passing::Nothing {
            text.push_bytes(self.input.bytes(byte))?;
        }
        self.position = 0;
        Ok(())
    }

    fn fields(&mut self, strings: &mut Strings, text: &mut Text) -> Result<bool, Error> {
        for index in 0..self.fields.len() {
            if !self.field(index, strings, text)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn field(&mut self, index: usize, strings: &mut Strings, text: &mut Text) -> Result<bool, Error> {
        match self.fields[index] {
            Field::Literal(bytes) => match (index, self.first_literal.take()) {
                (0, Some(stripped)) => {
                    let matches = self.literal(&stripped, text);
                    self.first_literal = Some(stripped);
                    matches
                }
                (_, kept) => {
                    self.first_literal = kept;
                    self.literal(bytes, text)
                }
            },
            Field::Text { name, width } => self.string((index, *width), name, strings, text),
            Field::Number { name, width } => self.number((index, *width), name, text),
        }
    }

    fn literal(&mut self, bytes: &[u8], text: &mut Text) -> Result<bool, Error> {
        let blanks = self.blanks;
        let is_blank = |byte: u8| blanks.contain(byte);
        let mut rest = bytes;
        while let Some(first) = rest.first() {
            if self.blanks.join && is_blank(*first) {
                if !self.peek(text)?.is_some_and(is_blank) {
                    return Ok(false);
                }
                rest = &rest[rest.iter().take_while(|byte| is_blank(**byte)).count()..];
                while self.peek(text)?.is_some_and(is_blank) {
                    self.position += 1;
                }
            } else if self.peek(text)? == Some(*first) {
                rest = &rest[1..];
                self.position += 1;
            } else {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The first byte of the literal after a field.
    fn delimiter(&self, index: usize) -> Option<u8> {
        match self.fields.get(index + 1) {
            Some(Field::Literal(bytes)) => bytes.first().copied(),
            _ => None,
        }
    }

    /// Whether a byte belongs to the field: up to the delimiter if there is one, otherwise up to
    /// the field's width.
    fn belongs(&self, byte: u8, delimiter: Option<u8>, length: usize, width: usize) -> bool {
        match delimiter {
            Some(delimiter) if self.blanks.join => match self.blanks.contain(delimiter) {
                true => !self.blanks.contain(byte),
                false => byte != delimiter,
            },
            _ => length < width,
        }
    }

    fn string(
        &mut self,
        (index, width): (usize, usize),
        name: &str,
        strings: &mut Strings,
        text: &mut Text,
    ) -> Result<bool, Error> {
        let (delimiter, start) = (self.delimiter(index), self.position);
        while let Some(byte) = self.peek(text)? {
            let length = self.position - start;
            if byte == b'\n' || length == LONGEST_FIELD || !self.belongs(byte, delimiter, length, width) {
                break;
            }
            self.position += 1;
        }
        let value = String::from_utf8_lossy(&self.input.window()[start..self.position]);
        Ok(match strings.value(name) {
            Some(known) => known == value,
            None => {
                strings.matched.insert(name.to_owned(), value.into_owned());
                true
            }
        })
    }

    fn number(&mut self, (index, width): (usize, usize), name: &'a str, text: &mut Text) -> Result<bool, Error> {
        let (delimiter, start) = (self.delimiter(index), self.position);
        let mut number_start = None;
        while let Some(byte) = self.peek(text)? {
            let length = self.position - start;
            let leading = number_start.is_none() && self.blanks.contain(byte);
            let numeric = byte.is_ascii_digit() || b"-.+eE".contains(&byte);
            if !(leading || numeric) || length == LONGEST_FIELD || !self.belongs(byte, delimiter, length, width) {
                break;
            }
            if !leading {
                number_start.get_or_insert(self.position);
            }
            self.position += 1;
        }
        let value = number_start.map_or(0.0, |start| number_at_start(&self.input.window()[start..self.position]));
        Ok(match self.numbers.iter().find(|(known, _)| *known == name) {
            Some((_, before)) => {
                let difference = (before - value) / if value == 0.0 { 1.0 } else { value };
                difference.abs() <= 0.001
            }
            None => {
                self.numbers.push((name, value));
                true
            }
        })
    }
}
