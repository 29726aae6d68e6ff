//! Parses command lines in the style of Radiance's programs: short options, each followed by its
//! values.

use crate::disk::Commands;
use crate::failure::Failure;
use crate::option_table::{options_of, parse_option, unknown_option};
use crate::trust::{Existing, OutputName, Trust};
use radsight_options::{OptionForm, Program};
use radsight_picture::{RgbPrimaries, leading_number};

/// A cursor over the words of a command line.
#[derive(Clone, Debug)]
pub(crate) struct Words<'a> {
    all: &'a [String],
    at: usize,
    trust: &'a Trust,
    table: &'static Program,
}

impl<'a> Words<'a> {
    /// `all[0]` is the program's name.
    pub(crate) fn new(all: &'a [String], trust: &'a Trust) -> Words<'a> {
        Words { all, at: 1, trust, table: options_of(&all[0]) }
    }

    pub(crate) fn trust(&self) -> &'a Trust {
        self.trust
    }

    /// Whether commands may run in place of files.
    pub(crate) fn commands(&self) -> Commands {
        self.trust.own_commands()
    }

    /// An output file; `-` for standard output.
    pub(crate) fn output(&self, name: &str) -> Result<OutputName, Failure> {
        if name == "-" { Ok(OutputName::standard_output()) } else { self.trust.output(name, Existing::Kept) }
    }

    /// The output file given as the value of an option.
    pub(crate) fn output_value(&mut self, option: &str, expected: &str) -> Result<OutputName, Failure> {
        let name = self.value(option, expected)?;
        self.output(name)
    }

    pub(crate) fn program(&self) -> &'a str {
        &self.all[0]
    }

    /// The next word if it is an option of the table: `-` followed by more.
    pub(crate) fn option(&mut self) -> Result<Option<&'a str>, Failure> {
        let word = self.next_if(|word| word.len() > 1 && word.starts_with('-'));
        word.map(|word| self.meant(word)).transpose()
    }

    /// The name of an option if it is identified by its first letters, otherwise the word.
    pub(crate) fn meant(&self, word: &'a str) -> Result<&'a str, Failure> {
        let option = parse_option(self.table, word)?.option;
        Ok(if option.form == OptionForm::Beginning { option.name } else { word })
    }

    /// The next word if it satisfies a condition.
    pub(crate) fn next_if(&mut self, wanted: impl Fn(&str) -> bool) -> Option<&'a str> {
        let word = self.all.get(self.at).filter(|word| wanted(word))?;
        self.at += 1;
        Some(word)
    }

    /// The value of an option.
    pub(crate) fn value(&mut self, option: &str, expected: &str) -> Result<&'a str, Failure> {
        let missing = || {
            let program = self.program();
            Failure::usage(format!(
                "{program}: option \"{option}\" ends the command line, expected {expected} after it"
            ))
        };
        let word = self.all.get(self.at).ok_or_else(missing)?;
        self.at += 1;
        Ok(word)
    }

    /// The number after an option.
    pub(crate) fn number(&mut self, option: &str) -> Result<f64, Failure> {
        let word = self.value(option, "a number")?;
        self.number_in(word, option)
    }

    /// The integer after an option; a fraction is truncated.
    pub(crate) fn integer(&mut self, option: &str) -> Result<i64, Failure> {
        Ok(self.number(option)? as i64)
    }

    /// The primaries after an option: x and y of red, green, blue and white.
    pub(crate) fn primaries(&mut self, option: &str) -> Result<RgbPrimaries, Failure> {
        const EXPECTED: &str = "eight numbers: x and y of red, green, blue and white";
        let mut chromaticities = [0.0; 8];
        for chromaticity in &mut chromaticities {
            let word = self.value(option, EXPECTED)?;
            *chromaticity = self.parsed(word, option, EXPECTED)?;
        }
        Ok(RgbPrimaries::from_array(chromaticities))
    }

    /// Parses a word as a number.
    pub(crate) fn number_in(&self, word: &str, option: &str) -> Result<f64, Failure> {
        self.parsed(word, option, "a number")
    }

    fn parsed(&self, word: &str, option: &str, expected: &str) -> Result<f64, Failure> {
        let (number, used) = leading_number(word.as_bytes());
        if used > 0 && word[used..].trim().is_empty() && number.is_finite() {
            return Ok(number);
        }
        let program = self.program();
        Err(Failure::usage(format!("{program}: option \"{option}\" is followed by \"{word}\", expected {expected}")))
    }

    /// The remaining words.
    pub(crate) fn rest(&self) -> &'a [String] {
        &self.all[self.at..]
    }

    /// All words.
    pub(crate) fn all(&self) -> Vec<&'a str> {
        self.all.iter().map(String::as_str).collect()
    }

    /// The name and the consumed words, for a header.
    pub(crate) fn taken(&self) -> Vec<&'a str> {
        self.all[..self.at].iter().map(String::as_str).collect()
    }

    /// The single file after the options; `-` if there is none.
    pub(crate) fn one_file(&self) -> Result<&'a str, Failure> {
        match self.rest() {
            [] => Ok("-"),
            [file] => Ok(file),
            [_, second, ..] => Err(self.too_many(second)),
        }
    }

    /// The input and output files; `-` for missing ones.
    pub(crate) fn input_and_output(&self) -> Result<(&'a str, &'a str), Failure> {
        match self.rest() {
            [] => Ok(("-", "-")),
            [input] => Ok((input, "-")),
            [input, output] => self.output(output).map(|_| (input.as_str(), output.as_str())),
            [_, _, third, ..] => Err(self.too_many(third)),
        }
    }

    pub(crate) fn too_many(&self, word: &str) -> Failure {
        Failure::usage(format!("{}: unexpected argument \"{word}\"", self.program()))
    }

    pub(crate) fn unknown(&self, option: &str) -> Failure {
        unknown_option(self.table, option)
    }
}
