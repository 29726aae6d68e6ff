//! One table of a camera file, and the checks that every key shares.

use crate::Found;
use radsight_diag::{Diagnostic, SourceId, SourceMap, Span, hint_nearest, nearest};
use radsight_loader::{FileKind, Loader};
use std::cell::RefCell;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The longest piece of a file's own text that a message repeats, characters.
const LONGEST_QUOTE: usize = 80;

/// The largest number of a camera file. Products of several such numbers are still finite.
const LARGEST: f64 = 1e30;

/// The smallest positive number of a camera file. Quotients by products of such numbers are finite.
const SMALLEST: f64 = 1e-60;

/// The allowed range of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Range {
    /// Any finite number.
    Finite,
    /// Above 0.
    Positive,
    /// 0 or above.
    NotNegative,
}

/// A table of the file while it is read.
#[derive(Debug)]
pub(crate) struct Section<'a> {
    /// Such as `camera`, or `flicker.tube` for a table inside another one.
    name: String,
    table: &'a DeTable<'a>,
    source: SourceId,
    header: std::ops::Range<usize>,
    asked: RefCell<Vec<&'static str>>,
    missing: RefCell<Vec<(&'static str, Diagnostic)>>,
}

/// A value with its place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed<T> {
    pub(crate) value: T,
    pub(crate) span: Span,
}

impl<'a> Section<'a> {
    /// The table `name` of the document, if it is there and is a table.
    pub(crate) fn open(
        document: &'a DeTable<'a>,
        name: &'static str,
        source: SourceId,
        sources: &SourceMap,
        found: &mut Found,
    ) -> Option<Self> {
        let (key, value) = document.get_key_value(name)?;
        if let DeValue::Table(table) = value.get_ref() {
            return Some(Section {
                name: name.to_owned(),
                table,
                source,
                header: key.span(),
                asked: RefCell::default(),
                missing: RefCell::default(),
            });
        }
        let place = sources.span(source, value.span().start, value.span().end);
        let kind = kind_of(value.get_ref());
        found.errors.push(Diagnostic::error(format!("\"{name}\" must be a table, not {kind}")).at(place));
        None
    }

    /// The tables inside the table `name`, each with its key.
    pub(crate) fn open_inner(
        document: &'a DeTable<'a>,
        name: &'static str,
        source: SourceId,
        sources: &SourceMap,
        found: &mut Found,
    ) -> Vec<(&'a str, Section<'a>)> {
        let Some(outer) = Section::open(document, name, source, sources, found) else { return Vec::new() };
        let mut inner = Vec::new();
        for (key, value) in outer.table {
            let key: &'a Spanned<_> = key;
            match value.get_ref() {
                DeValue::Table(table) => {
                    let (asked, missing) = (RefCell::default(), RefCell::default());
                    let name = format!("{name}.{}", shorten(key.get_ref()));
                    inner.push((
                        key.get_ref().as_ref(),
                        Section { name, table, source, header: key.span(), asked, missing },
                    ));
                }
                other => {
                    let message = format!("[{name}] has \"{}\", {}", shorten(key.get_ref()), kind_of(other));
                    let hint = format!("a table for each modifier, such as [{name}.tube]");
                    found.errors.push(Diagnostic::error(message).at(outer.span(value, sources)).hint(hint));
                }
            }
        }
        inner
    }

    /// Where the table begins.
    pub(crate) fn header_span(&self, sources: &SourceMap) -> Span {
        sources.span(self.source, self.header.start, self.header.end)
    }

    /// Where the value of `key` stands, or the header where it has none.
    pub(crate) fn span_of(&self, key: &str, sources: &SourceMap) -> Span {
        self.table.get(key).map_or_else(|| self.header_span(sources), |value| self.span(value, sources))
    }

    pub(crate) fn has(&self, key: &'static str) -> bool {
        self.table.contains_key(key)
    }

    /// The text of a string, without a message where it is none.
    pub(crate) fn text(&self, key: &'static str) -> Option<&'a str> {
        match self.table.get(key)?.get_ref() {
            DeValue::String(text) => Some(text.as_ref()),
            _ => None,
        }
    }

    /// The key among these whose number is farthest from 1, by orders of magnitude.
    pub(crate) fn most_extreme(&self, keys: &[&'static str]) -> &'static str {
        let orders = |key: &str| {
            let numbers = self.table.get(key).map_or(&[][..], |value| match value.get_ref() {
                DeValue::Array(list) => list,
                _ => std::slice::from_ref(value),
            });
            let sizes = numbers.iter().filter_map(|number| match number.get_ref() {
                DeValue::Float(float) => float.as_str().parse::<f64>().ok(),
                number => whole_of(number).map(|whole| whole as f64),
            });
            sizes.map(|size| size.abs().log10().abs()).fold(0.0, f64::max)
        };
        keys.iter().copied().max_by(|a, b| orders(a).total_cmp(&orders(b))).unwrap_or_default()
    }

    /// Refuses a key for a reason of its own.
    pub(crate) fn refuse(&self, key: &'static str, message: String, sources: &SourceMap, found: &mut Found) {
        if self.get(key).is_some() {
            found.errors.push(Diagnostic::error(message).at(self.span_of(key, sources)));
        }
    }

    fn span(&self, value: &Spanned<DeValue<'_>>, sources: &SourceMap) -> Span {
        sources.span(self.source, value.span().start, value.span().end)
    }

    fn get(&self, key: &'static str) -> Option<&'a Spanned<DeValue<'a>>> {
        self.asked.borrow_mut().push(key);
        self.table.get(key)
    }

    /// Notes that a required key is missing, with an example of it.
    fn missing(&self, key: &'static str, example: &str, sources: &SourceMap) {
        let message = format!("[{}] has no \"{key}\"", self.name);
        let hint = format!("for example {key} = {example}");
        let error = Diagnostic::error(message).at(self.header_span(sources)).hint(hint);
        self.missing.borrow_mut().push((key, error));
    }

    /// A required number; `example` shows how it is written.
    pub(crate) fn number(
        &self,
        key: &'static str,
        range: Range,
        example: &str,
        sources: &SourceMap,
        found: &mut Found,
    ) -> Option<f64> {
        if !self.has(key) {
            self.get(key);
            self.missing(key, example, sources);
            return None;
        }
        self.optional_number(key, range, sources, found)
    }

    /// A number, if it is there.
    pub(crate) fn optional_number(
        &self,
        key: &'static str,
        range: Range,
        sources: &SourceMap,
        found: &mut Found,
    ) -> Option<f64> {
        let value = self.get(key)?;
        self.checked_number(key, value, range, sources, found)
    }

    /// A list of numbers, if it is there; `length` is what it must have, where that is fixed.
    pub(crate) fn optional_numbers(
        &self,
        key: &'static str,
        length: Option<usize>,
        range: Range,
        sources: &SourceMap,
        found: &mut Found,
    ) -> Option<Vec<f64>> {
        let value = self.get(key)?;
        let expected = length.map_or("a list of numbers".to_owned(), |length| format!("a list of {length} numbers"));
        let list = match value.get_ref() {
            DeValue::Array(list) if length.is_none_or(|length| list.len() == length) => list,
            DeValue::Array(list) => {
                let message = format!("\"{key}\" must be {expected}, not of {}", list.len());
                found.errors.push(Diagnostic::error(message).at(self.span(value, sources)));
                return None;
            }
            other => {
                let message = format!("\"{key}\" must be {expected}, not {}", kind_of(other));
                found.errors.push(Diagnostic::error(message).at(self.span(value, sources)));
                return None;
            }
        };
        let numbers: Vec<Option<f64>> =
            list.iter().map(|item| self.checked_number(key, item, range, sources, found)).collect();
        numbers.into_iter().collect()
    }

    /// A required list of exactly `N` numbers.
    pub(crate) fn numbers<const N: usize>(
        &self,
        key: &'static str,
        range: Range,
        example: &str,
        sources: &SourceMap,
        found: &mut Found,
    ) -> Option<[f64; N]> {
        if !self.has(key) {
            self.get(key);
            self.missing(key, example, sources);
            return None;
        }
        self.optional_numbers(key, Some(N), range, sources, found)?.try_into().ok()
    }

    /// A whole number from `least` to `most`, if it is there.
    pub(crate) fn optional_whole(
        &self,
        key: &'static str,
        [least, most]: [i64; 2],
        sources: &SourceMap,
        found: &mut Found,
    ) -> Option<i64> {
        let value = self.get(key)?;
        self.checked_whole(key, value, [least, most], sources, found)
    }

    /// A required whole number from `least` to `most`.
    pub(crate) fn whole(
        &self,
        key: &'static str,
        range: [i64; 2],
        example: &str,
        sources: &SourceMap,
        found: &mut Found,
    ) -> Option<i64> {
        if !self.has(key) {
            self.get(key);
            self.missing(key, example, sources);
            return None;
        }
        self.optional_whole(key, range, sources, found)
    }

    /// A required pair of whole numbers.
    pub(crate) fn whole_pair(
        &self,
        key: &'static str,
        range: [i64; 2],
        example: &str,
        sources: &SourceMap,
        found: &mut Found,
    ) -> Option<[i64; 2]> {
        let Some(value) = self.get(key) else {
            self.missing(key, example, sources);
            return None;
        };
        let list = value.get_ref().as_array().filter(|list| list.len() == 2);
        let Some(list) = list else {
            let message = format!("\"{key}\" must be a list of 2 whole numbers");
            found.errors.push(
                Diagnostic::error(message).at(self.span(value, sources)).hint(format!("for example {key} = {example}")),
            );
            return None;
        };
        let pair: Vec<_> = list.iter().map(|item| self.checked_whole(key, item, range, sources, found)).collect();
        Some([pair[0]?, pair[1]?])
    }

    /// A string, if it is there.
    pub(crate) fn optional_string(
        &self,
        key: &'static str,
        sources: &SourceMap,
        found: &mut Found,
    ) -> Option<Placed<&'a str>> {
        let value = self.get(key)?;
        let span = self.span(value, sources);
        match value.get_ref() {
            DeValue::String(text) => Some(Placed { value: text.as_ref(), span }),
            other => {
                let message = format!("\"{key}\" must be a string in quotes, not {}", kind_of(other));
                found.errors.push(Diagnostic::error(message).at(span));
                None
            }
        }
    }

    /// A required string.
    pub(crate) fn string(
        &self,
        key: &'static str,
        example: &str,
        sources: &SourceMap,
        found: &mut Found,
    ) -> Option<Placed<&'a str>> {
        if !self.has(key) {
            self.get(key);
            self.missing(key, example, sources);
            return None;
        }
        self.optional_string(key, sources, found)
    }

    /// Ends the reading: required keys that are missing are errors, and so is every key that nobody
    /// asked for. A misspelt required key is one error, not two.
    pub(crate) fn close(self, sources: &SourceMap, found: &mut Found) {
        let asked = self.asked.borrow();
        let mut missing = self.missing.take();
        for key in self.table.keys().filter(|key| !asked.contains(&key.get_ref().as_ref())) {
            let place = sources.span(self.source, key.span().start, key.span().end);
            let message = format!("unknown key \"{}\" in [{}]", shorten(key.get_ref()), self.name);
            let absent = missing.iter().map(|(key, _)| *key);
            let meant = nearest(key.get_ref(), absent);
            missing.retain(|(key, _)| Some(*key) != meant);
            let hint = hint_nearest(key.get_ref(), meant.map_or(asked.clone(), |meant| vec![meant]));
            found.errors.push(Diagnostic::error(message).at(place).maybe_hint(hint));
        }
        found.errors.extend(missing.into_iter().map(|(_, error)| error));
    }

    /// Ends the reading where nothing tells which keys are known: only missing keys are errors.
    pub(crate) fn close_without_keys(self, found: &mut Found) {
        found.errors.extend(self.missing.into_inner().into_iter().map(|(_, error)| error));
    }

    fn checked_number(
        &self,
        key: &str,
        value: &Spanned<DeValue<'_>>,
        range: Range,
        sources: &SourceMap,
        found: &mut Found,
    ) -> Option<f64> {
        let parsed = match value.get_ref() {
            DeValue::Float(float) => float.as_str().parse::<f64>().ok(),
            DeValue::Integer(_) => whole_of(value.get_ref()).map(|whole| whole as f64),
            other => {
                let message = format!("\"{key}\" must be a number, not {}", kind_of(other));
                found.errors.push(Diagnostic::error(message).at(self.span(value, sources)));
                return None;
            }
        };
        let (expected, holds): (&str, fn(f64) -> bool) = match range {
            Range::Finite => ("finite", |_| true),
            Range::Positive => ("positive", |number| number > 0.0),
            Range::NotNegative => ("at least 0", |number| number >= 0.0),
        };
        let is_too_small = |number: f64| range != Range::Finite && number > 0.0 && number < SMALLEST;
        match parsed {
            Some(number) if number.is_finite() && (number.abs() > LARGEST || is_too_small(number)) => {
                let message = format!(
                    "\"{key}\" is {}, expected a size from {} to {}",
                    shown(number),
                    shown(SMALLEST),
                    shown(LARGEST)
                );
                found.errors.push(Diagnostic::error(message).at(self.span(value, sources)));
            }
            Some(number) if number.is_finite() && holds(number) => return Some(number),
            Some(number) => {
                let expected = if number.is_finite() { expected } else { "finite" };
                let message = format!("\"{key}\" must be {expected}, not {}", shown(number));
                found.errors.push(Diagnostic::error(message).at(self.span(value, sources)));
            }
            None => {
                let message = format!("\"{key}\" is too large to hold");
                found.errors.push(Diagnostic::error(message).at(self.span(value, sources)));
            }
        }
        None
    }

    fn checked_whole(
        &self,
        key: &str,
        value: &Spanned<DeValue<'_>>,
        [least, most]: [i64; 2],
        sources: &SourceMap,
        found: &mut Found,
    ) -> Option<i64> {
        let place = self.span(value, sources);
        let range = format!("a whole number from {least} to {most}");
        let number = match value.get_ref() {
            DeValue::Integer(_) => whole_of(value.get_ref()),
            other => {
                let message = format!("\"{key}\" must be {range}, not {}", kind_of(other));
                found.errors.push(Diagnostic::error(message).at(place));
                return None;
            }
        };
        if let Some(number) = number.filter(|number| (least..=most).contains(number)) {
            return Some(number);
        }
        let shown = number.map_or("one too large to hold".to_owned(), |number| number.to_string());
        found.errors.push(Diagnostic::error(format!("\"{key}\" must be {range}, not {shown}")).at(place));
        None
    }
}

/// Loads a file that a key names, which is looked for beside the camera file.
pub(crate) fn load_beside(
    name: &Placed<&str>,
    file: &str,
    sources: &mut SourceMap,
    loader: &dyn Loader,
    found: &mut Found,
) -> Option<SourceId> {
    let beside = Path::new(file).parent().unwrap_or(Path::new("")).join(name.value);
    match loader.load(&beside.to_string_lossy(), FileKind::Other) {
        Ok(loaded) => Some(sources.add(loaded.path, loaded.bytes, Some(name.span))),
        Err(error) => {
            found.errors.push(Diagnostic::error(shorten(&error.to_string())).at(name.span));
            None
        }
    }
}

/// A number as people write it: very large and very small ones with an exponent.
fn shown(number: f64) -> String {
    let size = number.abs();
    if size != 0.0 && !(1e-6..1e9).contains(&size) && number.is_finite() {
        format!("{number:e}")
    } else {
        number.to_string().to_lowercase()
    }
}

fn whole_of(value: &DeValue<'_>) -> Option<i64> {
    let integer = value.as_integer()?;
    i64::from_str_radix(integer.as_str(), integer.radix()).ok()
}

fn kind_of(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "a string",
        DeValue::Integer(_) => "a whole number",
        DeValue::Float(_) => "a number with a point",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}

/// The text, cut where it is long.
pub(crate) fn shorten(text: &str) -> String {
    let mut short: String = text.chars().take(LONGEST_QUOTE).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short
}
