//! Tables: `.dat` files.

use super::modifiers::RawWord;
use super::reader::Reader;
use crate::syntax::{is_space, parse_integer, parse_real};
use radsight_diag::{Diagnostic, SourceId, Span};
use radsight_ir::{Axis, DataGrid, Handle};
use radsight_loader::{FileKind, Loader};
use std::sync::Arc;

/// Largest number of dimensions of a table. Radiance's own limit is 6.
const MOST_DIMENSIONS: usize = 16;

impl Reader<'_> {
    /// The table of a file, loaded at its first use. `None` after a mistake, which was reported.
    pub(super) fn grid(&mut self, file: &RawWord) -> Option<Handle<DataGrid>> {
        if let Some(known) = self.grids.get(&file.text) {
            return *known;
        }
        let grid = match self.loader.load(&file.text, FileKind::Data) {
            Ok(loaded) => {
                let source = self.sources.add(loaded.path, loaded.bytes, Some(file.span));
                let text = Arc::clone(self.sources.text(source));
                match read_grid(&file.text, &text, source) {
                    Ok((grid, warning)) => {
                        self.log.extend(warning);
                        Some(self.scene.grids.add(grid))
                    }
                    Err(error) => {
                        self.log.push(error);
                        None
                    }
                }
            }
            Err(error) => {
                self.log.push(Diagnostic::error(error.to_string()).at(file.span));
                None
            }
        };
        self.grids.insert(file.text.clone(), grid);
        grid
    }
}

/// Reads a table: the number of dimensions, one line per axis (first, last, count; if first = last,
/// the coordinates follow), then the values.
///
/// # Errors
/// The first mistake, with its position.
fn read_grid(file: &str, text: &[u8], source: SourceId) -> Result<(DataGrid, Option<Diagnostic>), Diagnostic> {
    let mut words = DataWords { text, at: 0, source };
    let dimensions = words.integer("the number of dimensions")?;
    if !(1..=MOST_DIMENSIONS as i64).contains(&dimensions) {
        let message = format!("the number of dimensions is {dimensions}, expected 1 to {MOST_DIMENSIONS}");
        return Err(words.error(message));
    }
    let mut axes = Vec::new();
    let mut size = 1_usize;
    for axis in 1..=dimensions {
        let axis = words.axis(axis)?;
        let left = text.len() - words.at;
        size = size.saturating_mul(axis.count());
        // A value takes at least two bytes: a digit and a space before it.
        if size > left / 2 + 1 {
            return Err(words.error(format!("at least {size} values must follow, but only {left} bytes are left")));
        }
        axes.push(axis);
    }
    let mut values = Vec::with_capacity(size);
    for index in 1..=size {
        values.push(words.real(|| format!("value {index} of {size}"))? as f32);
    }
    let warning = words
        .next()
        .map(|(_, span)| Diagnostic::warning(format!("only the first {size} values of \"{file}\" are used")).at(span));
    Ok((DataGrid { file: file.to_owned(), axes, values }, warning))
}

/// The words of a table; `#` begins a comment anywhere.
struct DataWords<'t> {
    text: &'t [u8],
    at: usize,
    source: SourceId,
}

impl<'t> DataWords<'t> {
    fn next(&mut self) -> Option<(&'t [u8], Span)> {
        loop {
            let rest = self.text.get(self.at..)?;
            self.at += rest.iter().take_while(|byte| is_space(**byte)).count();
            let rest = &self.text[self.at..];
            match rest.first()? {
                b'#' => self.at += rest.iter().take_while(|byte| **byte != b'\n').count(),
                _ => {
                    let length = rest.iter().take_while(|byte| !is_space(**byte) && **byte != b'#').count();
                    let start = self.at;
                    self.at += length;
                    let span = Span { source: self.source, start: clamp(start), end: clamp(self.at) };
                    return Some((&rest[..length], span));
                }
            }
        }
    }

    fn axis(&mut self, number: i64) -> Result<Axis, Diagnostic> {
        let first = self.real(|| format!("the first coordinate of axis {number}"))?;
        let last = self.real(|| format!("the last coordinate of axis {number}"))?;
        let count = self.integer(&format!("the number of points of axis {number}"))?;
        let left = self.text.len() - self.at;
        if count < 2 || count > left as i64 / 2 + 1 {
            let expected = if count < 2 {
                "at least 2".to_owned()
            } else {
                format!("a count that fits into the remaining {left} bytes")
            };
            return Err(self.error(format!("axis {number} has {count} points, expected {expected}")));
        }
        if first != last {
            return Ok(Axis::Regular { first, last, count: count as usize });
        }
        let mut points: Vec<f64> = Vec::with_capacity(count as usize);
        for point in 1..=count {
            let value = self.real(|| format!("coordinate {point} of {count} of axis {number}"))?;
            points.push(value);
            let is_monotonic = match points[..] {
                [.., a, b, c] => a != b && b != c && (a < b) == (b < c),
                [a, b] => a != b,
                _ => true,
            };
            if !is_monotonic {
                let message = format!(
                    "coordinate {point} of axis {number} is {value}, but coordinates must only rise or only fall"
                );
                return Err(self.error(message));
            }
        }
        Ok(Axis::Irregular(points))
    }

    fn integer(&mut self, what: &str) -> Result<i64, Diagnostic> {
        self.value(|| what.to_owned(), "an integer", parse_integer)
    }

    fn real(&mut self, what: impl Fn() -> String) -> Result<f64, Diagnostic> {
        self.value(what, "a finite number", |word| parse_real(word).filter(|value| value.is_finite()))
    }

    fn value<T>(
        &mut self,
        what: impl Fn() -> String,
        form: &str,
        parse: impl Fn(&[u8]) -> Option<T>,
    ) -> Result<T, Diagnostic> {
        let Some((word, span)) = self.next() else {
            let last = self.text.iter().rposition(|byte| !is_space(*byte)).unwrap_or(0);
            let span = Span { source: self.source, start: clamp(last), end: clamp(last + 1) };
            return Err(Diagnostic::error(format!("the data end where {} was expected", what())).at(span));
        };
        parse(word).ok_or_else(|| {
            let word = String::from_utf8_lossy(word);
            Diagnostic::error(format!("{} is \"{word}\", expected {form}", what())).at(span)
        })
    }

    /// An error about the word just read.
    fn error(&self, message: String) -> Diagnostic {
        let start = self.text[..self.at].iter().rposition(|byte| is_space(*byte)).map_or(0, |at| at + 1);
        Diagnostic::error(message).at(Span { source: self.source, start: clamp(start), end: clamp(self.at) })
    }
}

fn clamp(offset: usize) -> u32 {
    u32::try_from(offset).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use radsight_diag::SourceMap;

    fn read(text: &str) -> Result<DataGrid, String> {
        let mut sources = SourceMap::default();
        let source = sources.add("t.dat", text.as_bytes(), None);
        read_grid("t.dat", text.as_bytes(), source).map(|(grid, _)| grid).map_err(|error| error.message)
    }

    #[test]
    fn regular_and_irregular_axes_are_read() {
        let grid = read("# photometry\n2 0 90 3 # polar\n0 0 2 -1 5\n1 2 3#x\n4 .5 6e0").unwrap();
        let axes = [Axis::Regular { first: 0.0, last: 90.0, count: 3 }, Axis::Irregular(vec![-1.0, 5.0])];
        assert_eq!(grid.axes, axes);
        assert_eq!(grid.values, [1.0, 2.0, 3.0, 4.0, 0.5, 6.0]);
    }

    #[test]
    fn mistakes_name_what_was_expected() {
        for (text, expected) in [
            ("", "the data end where the number of dimensions was expected"),
            ("1.5", "the number of dimensions is \"1.5\", expected an integer"),
            ("99", "the number of dimensions is 99, expected 1 to 16"),
            ("1 0 1 1 5", "axis 1 has 1 points, expected at least 2"),
            (
                "1 0 1 1000000000 5",
                "axis 1 has 1000000000 points, expected a count that fits into the remaining 2 bytes",
            ),
            ("2 0 1 9 0 1 9 1 2 3 4 5 6 7 8 9 1 2 3", "at least 81 values must follow, but only 24 bytes are left"),
            ("1 0 0 3 1 5 2 1 1 1", "coordinate 3 of axis 1 is 2, but coordinates must only rise or only fall"),
            ("1 0 1 2 3", "the data end where value 2 of 2 was expected"),
            ("1 0 1 2 3 nan", "value 2 of 2 is \"nan\", expected a finite number"),
        ] {
            assert_eq!(read(text).unwrap_err(), expected, "{text}");
        }
    }
}
