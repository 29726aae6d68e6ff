//! Tables of measured rows: observation, entrance, [rotation,] value; degrees.

use radsight_diag::{Diagnostic, SourceId, SourceMap};
use radsight_retro::{Geometry, Row};

/// The quantity in the last column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Column {
    /// R_A, cd/(lx m²).
    Coefficient,
    /// BRDF, 1/sr.
    Brdf,
}

impl Column {
    fn name(self) -> &'static str {
        match self {
            Column::Coefficient => "R_A",
            Column::Brdf => "BRDF",
        }
    }
}

/// The fields of a line, separated by commas, semicolons or white space, with their offsets.
fn fields(line: &str, separator: fn(char) -> bool) -> Vec<(usize, &str)> {
    let place = |part: &str| part.as_ptr() as usize - line.as_ptr() as usize;
    line.split(separator).map(str::trim).map(|part| (place(part), part)).collect()
}

/// The rows of a text. Lines that begin with `#` are comments; the first line may hold column
/// names.
///
/// # Errors
/// All invalid lines, at their fields.
pub(super) fn read_rows(source: SourceId, sources: &SourceMap, column: Column) -> Result<Vec<Row>, Vec<Diagnostic>> {
    let bytes = sources.text(source).clone();
    let Ok(text) = std::str::from_utf8(&bytes) else {
        return Err(vec![Diagnostic::error("the table is not UTF-8 text").at(sources.span(source, 0, 1))]);
    };
    let (mut rows, mut errors) = (Vec::new(), Vec::new());
    let (mut start, mut may_be_header) = (0, true);
    for line in text.split_inclusive('\n') {
        let (at, content) = (start, line.trim_end());
        start += line.len();
        if content.trim().is_empty() || content.trim_start().starts_with('#') {
            continue;
        }
        let has_names = content.contains(|letter: char| letter.is_alphabetic() && !matches!(letter, 'e' | 'E'));
        if std::mem::take(&mut may_be_header) && has_names {
            continue;
        }
        match row(content, column) {
            Ok(row) => rows.push(row),
            Err((from, to, message)) => {
                errors.push(Diagnostic::error(message).at(sources.span(source, at + from, at + to)));
            }
        }
    }
    if errors.is_empty() && rows.is_empty() {
        errors.push(Diagnostic::error("the table has no rows").at(sources.span(source, 0, 0)));
    }
    if errors.is_empty() { Ok(rows) } else { Err(errors) }
}

fn row(line: &str, column: Column) -> Result<Row, (usize, usize, String)> {
    let fields = if line.contains([',', ';']) {
        fields(line, |letter| matches!(letter, ',' | ';'))
    } else {
        let words = line.split_whitespace();
        words.map(|word| (word.as_ptr() as usize - line.as_ptr() as usize, word)).collect()
    };
    if !(3..=4).contains(&fields.len()) {
        let message = format!("{} fields, expected observation, entrance, [rotation,] {}", fields.len(), column.name());
        return Err((0, line.len(), message));
    }
    let mut numbers = Vec::with_capacity(4);
    for (place, field) in &fields {
        match field.parse::<f64>() {
            Ok(number) if number.is_finite() => numbers.push(number),
            _ => return Err((*place, place + field.len(), format!("\"{field}\" is not a number"))),
        }
    }
    let out_of_range = |index: usize, expected: &str| {
        let (place, field) = fields[index];
        Err((place, place + field.len(), format!("{field}, expected {expected}")))
    };
    let (observation, entrance, value) = (numbers[0], numbers[1], numbers[numbers.len() - 1]);
    if !(0.0..=90.0).contains(&observation) {
        return out_of_range(0, "an observation angle of 0 to 90 degrees");
    }
    if !(-89.0..=89.0).contains(&entrance) {
        return out_of_range(1, "an entrance angle of -89 to 89 degrees");
    }
    if value < 0.0 {
        return out_of_range(numbers.len() - 1, "a value of at least 0");
    }
    let rotation = if numbers.len() == 4 { numbers[2] } else { 0.0 };
    Ok(Row { geometry: Geometry::from_degrees(observation, entrance, rotation), coefficient: value })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<Row>, Vec<Diagnostic>> {
        let mut sources = SourceMap::default();
        let source = sources.add("data.csv", text.as_bytes().to_vec(), None);
        read_rows(source, &sources, Column::Coefficient)
    }

    #[test]
    fn rows_with_and_without_a_rotation_are_read() {
        let rows = read("# source\nobservation,entrance,rotation,ra\n.2, -4, 90, 800\n0.5 30 2e2\n").unwrap();
        assert_eq!(rows.len(), 2);
        assert_eq!(rows[0], Row { geometry: Geometry::from_degrees(0.2, -4.0, 90.0), coefficient: 800.0 });
        assert_eq!(rows[1].coefficient, 200.0);
    }

    #[test]
    fn every_wrong_line_is_reported() {
        assert_eq!(read(".2,-4,800\n.2,x,3\n.2\n95,1,1\n.2,4,-1\n").unwrap_err().len(), 4);
        assert_eq!(read("").unwrap_err().len(), 1);
        assert_eq!(read("a,b,c\n").unwrap_err().len(), 1);
    }
}
