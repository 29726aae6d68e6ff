//! Parses a program's arguments. Errors name the argument.

use crate::Error;
use crate::number_text::{leading_integer, leading_number};
use radsight_options::Program;

/// A cursor over `argv`, starting after the program's name.
pub(crate) struct Arguments<'a> {
    argv: &'a [String],
    usage: &'static str,
    /// The program's entry in the table of options.
    options: Option<&'static Program>,
    next: usize,
    /// Warnings about accepted but suspicious arguments.
    pub(crate) warnings: Vec<String>,
}

/// An option of a command line.
#[derive(Clone, Copy)]
pub(crate) struct GivenOption<'a> {
    /// Its name in the table.
    pub(crate) name: &'static str,
    /// The text attached to the name.
    pub(crate) text: &'a str,
}

impl<'a> Arguments<'a> {
    /// The arguments of a program in the table of options.
    pub(crate) fn new(argv: &'a [String]) -> Self {
        let arguments = Arguments::with_usage(argv, "");
        let options = radsight_options::program(arguments.program());
        Arguments { options, usage: options.map_or("", |program| program.synopsis), ..arguments }
    }

    /// The arguments of a program that is not in the table.
    pub(crate) fn with_usage(argv: &'a [String], usage: &'static str) -> Self {
        Arguments { argv, usage, options: None, next: 1.min(argv.len()), warnings: Vec::new() }
    }

    /// The next word if it begins with a dash: an option of the table.
    pub(crate) fn option(&mut self) -> Result<Option<GivenOption<'a>>, Error> {
        match self.peek() {
            Some(word) if word.starts_with('-') => self.last_options(),
            _ => Ok(None),
        }
    }

    /// As [`Arguments::option`], but `-` is not an option: it names standard input.
    pub(crate) fn option_before_files(&mut self) -> Result<Option<GivenOption<'a>>, Error> {
        if self.peek() == Some("-") { Ok(None) } else { self.option() }
    }

    /// The next word if it is an option of the table. Other words remain, since they may be
    /// negative numbers.
    pub(crate) fn option_before_numbers(&mut self) -> Option<GivenOption<'a>> {
        let given = self.given(self.peek()?)?;
        self.next += 1;
        Some(given)
    }

    /// The next option, where only options may follow.
    pub(crate) fn last_options(&mut self) -> Result<Option<GivenOption<'a>>, Error> {
        let Some(word) = self.word() else { return Ok(None) };
        self.given(word).map(Some).ok_or_else(|| self.unknown())
    }

    /// As [`Arguments::last_options`], where `+a` stands for `-a` unless it is an option itself, as
    /// in `gensky` and `gendaylit`.
    pub(crate) fn last_signed_options(&mut self) -> Result<Option<GivenOption<'a>>, Error> {
        let Some(word) = self.word() else { return Ok(None) };
        let minus = word.strip_prefix('+').map(|rest| format!("-{rest}"));
        let as_minus = || {
            let option = self.options?.parse_word(&minus?)?.option;
            Some(GivenOption { name: option.name, text: word.get(option.name.len()..).unwrap_or_default() })
        };
        self.given(word).or_else(as_minus).map(Some).ok_or_else(|| self.unknown())
    }

    /// A word as an option of the table.
    fn given(&self, word: &'a str) -> Option<GivenOption<'a>> {
        let option = self.options?.parse_word(word)?.option;
        Some(GivenOption { name: option.name, text: word.get(option.name.len()..).unwrap_or_default() })
    }

    /// The program's name without its directory.
    pub(crate) fn program(&self) -> &'a str {
        self.argv.first().map_or("", |word| word.rsplit('/').next().unwrap_or(word))
    }

    /// Index of the next word in `argv`.
    pub(crate) fn position(&self) -> usize {
        self.next
    }

    /// The next word, without consuming it.
    pub(crate) fn peek(&self) -> Option<&'a str> {
        self.argv.get(self.next).map(String::as_str)
    }

    /// The next word, if there is one.
    pub(crate) fn word(&mut self) -> Option<&'a str> {
        let word = self.peek()?;
        self.next += 1;
        Some(word)
    }

    /// The words from the next one on.
    pub(crate) fn rest(&self) -> &'a [String] {
        &self.argv[self.next.min(self.argv.len())..]
    }

    /// The remaining words as file names; `-` (standard input) if there are none.
    pub(crate) fn files(&self) -> Vec<&'a str> {
        match self.rest() {
            [] => vec!["-"],
            names => names.iter().map(String::as_str).collect(),
        }
    }

    /// The next word. `name` describes it in the error if it is missing.
    pub(crate) fn required(&mut self, name: &str) -> Result<&'a str, Error> {
        match self.word() {
            Some(word) => Ok(word),
            None => Err(self.mistake(self.next, format!("missing {name}"))),
        }
    }

    /// The next word as a finite number. Text after the number is ignored with a warning; C's
    /// `atof` ignores it silently.
    pub(crate) fn number(&mut self, name: &str) -> Result<f64, Error> {
        let position = self.next;
        let word = self.required(name)?;
        match leading_number(word) {
            Some((value, end)) if value.is_finite() => {
                self.warn_about_tail(word, end, name);
                Ok(value)
            }
            _ => Err(self.mistake(position, format!("{name} is \"{word}\", expected a finite number"))),
        }
    }

    /// The next word as a number above zero.
    pub(crate) fn positive(&mut self, name: &str) -> Result<f64, Error> {
        let position = self.next;
        let value = self.number(name)?;
        if value > 0.0 {
            return Ok(value);
        }
        Err(self.mistake(position, format!("{name} is {value}, expected a number above zero")))
    }

    /// The next word as an integer; a fraction is truncated with a warning.
    pub(crate) fn integer(&mut self, name: &str) -> Result<i64, Error> {
        let position = self.next;
        let word = self.required(name)?;
        match leading_integer(word) {
            Some((value, end)) => {
                self.warn_about_tail(word, end, name);
                Ok(value)
            }
            None => Err(self.mistake(position, format!("{name} is \"{word}\", expected an integer"))),
        }
    }

    /// The next word as an integer above zero.
    pub(crate) fn count(&mut self, name: &str) -> Result<usize, Error> {
        let position = self.next;
        let value = self.integer(name)?;
        match usize::try_from(value) {
            Ok(count) if count > 0 => Ok(count),
            _ => Err(self.mistake(position, format!("{name} is {value}, expected an integer above zero"))),
        }
    }

    /// The next words, one for each name.
    pub(crate) fn take<const COUNT: usize>(&mut self, names: [&str; COUNT]) -> Result<[&'a str; COUNT], Error> {
        let mut words = [""; COUNT];
        for (word, name) in words.iter_mut().zip(names) {
            *word = self.required(name)?;
        }
        Ok(words)
    }

    /// A second cursor that starts at an index of `argv`, for programs whose options follow what
    /// they affect.
    pub(crate) fn again_from(&self, next: usize) -> Arguments<'a> {
        Arguments { argv: self.argv, usage: self.usage, options: self.options, next, warnings: Vec::new() }
    }

    /// Three numbers. Errors call them `name` followed by `x`, `y` and `z`.
    pub(crate) fn vector(&mut self, name: &str) -> Result<[f64; 3], Error> {
        Ok([self.number(&format!("{name} x"))?, self.number(&format!("{name} y"))?, self.number(&format!("{name} z"))?])
    }

    /// An error about the last word, which is neither an option nor an argument.
    pub(crate) fn unknown(&self) -> Error {
        let position = self.next.saturating_sub(1);
        let word = self.argv.get(position).map_or("", String::as_str);
        let what = if word.starts_with(['-', '+']) { "unknown option" } else { "unexpected argument" };
        let near =
            self.options.and_then(|program| program.near(word)).map(|near| format!(", did you mean \"{near}\"?"));
        self.mistake(position, format!("{what} \"{word}\"{}", near.unwrap_or_default()))
    }

    /// An error about the word at an index of `argv`.
    pub(crate) fn mistake(&self, argument: usize, mistake: impl Into<String>) -> Error {
        Error::Argument { program: self.program().to_owned(), mistake: mistake.into(), usage: self.usage, argument }
    }

    /// An error about the combination of arguments.
    pub(crate) fn impossible(&self, mistake: impl Into<String>) -> Error {
        Error::Impossible { program: self.program().to_owned(), mistake: mistake.into() }
    }

    fn warn_about_tail(&mut self, word: &str, end: usize, name: &str) {
        if end < word.len() {
            self.warnings.push(format!("{name} is \"{word}\"; \"{}\" is ignored", &word[end..]));
        }
    }
}
