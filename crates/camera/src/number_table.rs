//! Two columns of numbers as text, separated by commas or tabs: LED tables and measured sensors.

use crate::section::shorten;
use radsight_diag::{Diagnostic, SourceId, SourceMap, Span};
use radsight_sensor::calibrate::Measurement;

/// The largest table that is read, bytes.
const LARGEST_TABLE: usize = 16 << 20;
/// Errors after which reading stops.
const MOST_ERRORS: usize = 20;

/// One row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NumberTableRow {
    /// The two numbers, finite.
    pub values: [f64; 2],
    /// Where each stands.
    pub spans: [Span; 2],
}

/// A table of two columns.
///
/// One row a line; empty lines and lines that begin with `#` are passed over; the first line may
/// name the columns, and then must name these.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberTable {
    /// The rows in file order.
    pub rows: Vec<NumberTableRow>,
}

impl NumberTable {
    /// Reads the text that stands in `sources` under `source`. `columns` are the names that the
    /// first line may have.
    ///
    /// # Errors
    /// The first twenty mistakes of the text; never empty.
    pub fn read(source: SourceId, sources: &SourceMap, columns: [&str; 2]) -> Result<Self, Vec<Diagnostic>> {
        let text = sources.text(source).clone();
        if text.len() > LARGEST_TABLE {
            let message = format!("the table has {} bytes, expected at most {LARGEST_TABLE}", text.len());
            return Err(vec![Diagnostic::error(message).at(sources.span(source, 0, 0))]);
        }
        let mut start = if text.starts_with("\u{feff}".as_bytes()) { 3 } else { 0 };
        let (mut rows, mut errors, mut first) = (Vec::new(), Vec::new(), true);
        for line in text[start..].split(|&byte| byte == b'\n') {
            let at = start;
            start += line.len() + 1;
            if line.trim_ascii().is_empty() || line.trim_ascii_start().starts_with(b"#") {
                continue;
            }
            let line = Line { source, sources, at, bytes: line };
            if !(std::mem::replace(&mut first, false) && line.names(columns)) {
                match line.row(columns) {
                    Ok(row) => rows.push(row),
                    Err(error) => errors.push(error),
                }
            }
            if errors.len() == MOST_ERRORS {
                break;
            }
        }
        if errors.is_empty() { Ok(NumberTable { rows }) } else { Err(errors) }
    }
}

/// Reads measured pairs of exposure (in any one unit) and grey level; the first line may be
/// `exposure,grey`.
///
/// # Errors
/// The first twenty mistakes of the text; never empty.
pub fn read_measurements(source: SourceId, sources: &SourceMap) -> Result<Vec<Measurement>, Vec<Diagnostic>> {
    let table = NumberTable::read(source, sources, ["exposure", "grey"])?;
    let negative = table.rows.iter().filter(|row| row.values[0] < 0.0).take(MOST_ERRORS);
    let errors: Vec<_> = negative
        .map(|row| Diagnostic::error(format!("exposure {} is negative", row.values[0])).at(row.spans[0]))
        .collect();
    if !errors.is_empty() {
        return Err(errors);
    }
    Ok(table.rows.iter().map(|row| Measurement { exposure: row.values[0], grey: row.values[1] }).collect())
}

/// A line and its place.
struct Line<'a> {
    source: SourceId,
    sources: &'a SourceMap,
    at: usize,
    bytes: &'a [u8],
}

impl Line<'_> {
    /// Each field without the white space around it, with its place.
    fn fields(&self) -> Vec<(String, Span)> {
        let mut start = self.at;
        let mut fields = Vec::new();
        // One field more than fits is enough to see that there are too many.
        for field in self.bytes.splitn(4, |&byte| byte == b',' || byte == b'\t') {
            let lead = field.len() - field.trim_ascii_start().len();
            let word = field.trim_ascii();
            let span = self.sources.span(self.source, start + lead, start + lead + word.len());
            fields.push((String::from_utf8_lossy(word).into_owned(), span));
            start += field.len() + 1;
        }
        fields
    }

    fn names(&self, columns: [&str; 2]) -> bool {
        let fields = self.fields();
        fields.len() == 2 && fields.iter().zip(columns).all(|((word, _), name)| word.eq_ignore_ascii_case(name))
    }

    fn row(&self, columns: [&str; 2]) -> Result<NumberTableRow, Diagnostic> {
        let whole = self.sources.span(self.source, self.at, self.at + self.bytes.trim_ascii_end().len());
        let [(first, first_span), (second, second_span)]: [(String, Span); 2] =
            self.fields().try_into().map_err(|fields: Vec<_>| {
                let found = if fields.len() > 3 { "more than 3".to_owned() } else { fields.len().to_string() };
                let message = format!("{found} field(s), expected 2: {}, {}", columns[0], columns[1]);
                Diagnostic::error(message).at(whole)
            })?;
        let values = [number(&first, first_span, columns[0])?, number(&second, second_span, columns[1])?];
        Ok(NumberTableRow { values, spans: [first_span, second_span] })
    }
}

fn number(word: &str, span: Span, column: &str) -> Result<f64, Diagnostic> {
    let parsed: Option<f64> = word.parse().ok();
    match parsed {
        Some(value) if value.is_finite() => Ok(value),
        Some(_) => Err(Diagnostic::error(format!("{column} is {}, expected a finite number", shorten(word))).at(span)),
        None => Err(Diagnostic::error(format!("expected a number for {column}, found \"{}\"", shorten(word))).at(span)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &[u8]) -> Result<Vec<Measurement>, String> {
        let mut sources = SourceMap::default();
        let source = sources.add("data.csv", text, None);
        read_measurements(source, &sources)
            .map_err(|errors| errors.iter().map(|error| error.render(&sources)).collect::<String>())
    }

    #[test]
    fn header_comments_blank_lines_and_line_ends_are_passed_over() {
        let rows = read(b"\xef\xbb\xbf# measured\r\nExposure, grey\r\n\r\n1e-3 , 12\r\n2e-3\t25.5").unwrap();
        let expected = [(1e-3, 12.0), (2e-3, 25.5)].map(|(exposure, grey)| Measurement { exposure, grey });
        assert_eq!(rows, expected);
    }

    #[test]
    fn each_bad_line_is_shown() {
        let errors = read(b"exposure,gray\n1,2\n1,nan\n1\n-1,5\n1,2,3,4,5\n").unwrap_err();
        insta::assert_snapshot!(errors);
    }

    #[test]
    fn a_negative_exposure_is_refused() {
        assert!(read(b"-1,5\n").unwrap_err().starts_with("data.csv:1:1: error: exposure -1 is negative"));
    }

    #[test]
    fn hostile_bytes_give_a_bounded_number_of_errors() {
        let errors = read(&[b"\xff\x00,\n".repeat(100_000), vec![b','; 1_000_000]].concat()).unwrap_err();
        assert_eq!(errors.matches("error:").count(), MOST_ERRORS);
    }
}
