//! Series files: a comma-separated table of pictures.

use crate::capture::Capture;
use crate::error::{Error, Report};
use crate::part_move::{PartMove, moved_surfaces};
use radsight_diag::{Diagnostic, SourceId, SourceMap, Span};
use radsight_ir::Scene;
use radsight_loader::Loader;
use std::collections::BTreeSet;

/// Largest series file, bytes.
const LARGEST_FILE: usize = 64 << 20;

/// Number of mistakes after which reading stops.
const MOST_ERRORS: usize = 20;

/// Prefix of a column that moves a part; the name of its surfaces follows.
const MOVE: &str = "move ";

/// One row of a series file.
///
/// ```
/// let rows = radsight::read_series("rings.csv", b"rig.ring_diameter_mm\n20\n30\n")?;
/// assert_eq!((rows[1].line, rows[1].keys[0].1.as_str()), (3, "30"));
/// # Ok::<(), radsight::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SeriesRow {
    /// Its name; by default its number in the file, from 1, with leading zeros.
    pub name: String,
    /// The line of the file, from 1.
    pub line: u32,
    /// Keys of the camera file to replace (`table.key`), with their values.
    pub keys: Vec<(String, String)>,
    /// Parts with another pose.
    pub moves: Vec<PartMove>,
}

/// The meaning of a column.
enum Column {
    Name,
    Key(String),
    Move(String),
}

/// Parses a series: the first line names the columns, each other line is a picture.
///
/// A column is `name`, a key of the camera file such as `rig.ring_diameter_mm`, or `move NAME` with
/// the transform of the surfaces with that name ([`PartMove::new`]). An empty cell changes nothing.
/// Cells with commas are put in double quotes. Empty lines and lines that begin with `#` are
/// skipped.
///
/// ```
/// let text = b"move washer_*,rig.ring_diameter_mm\n-t .01 0 0,20\n,30\n";
/// let rows = radsight::read_series("poses.csv", text).unwrap();
/// assert_eq!((rows.len(), rows[0].moves.len(), rows[1].moves.len()), (2, 1, 0));
/// assert_eq!(rows[1].keys, [("rig.ring_diameter_mm".to_owned(), "30".to_owned())]);
/// let error = radsight::read_series("poses.csv", b"move washer_*\n-t .01 0\n").unwrap_err();
/// assert!(error.to_string().contains("poses.csv:2:1: error: missing z of -t"), "{error}");
/// ```
///
/// # Errors
/// [`Error::Series`] with the first twenty mistakes.
pub fn read_series(name: &str, text: &[u8]) -> Result<Vec<SeriesRow>, Error> {
    let mut sources = SourceMap::default();
    let source = sources.add(name, text, None);
    let mut reader = Reader { source, sources: &sources, errors: Vec::new() };
    let rows = reader.rows(text);
    match reader.errors.is_empty() {
        true => Ok(rows),
        false => Err(Error::Series(Report::new(reader.errors, sources))),
    }
}

/// Checks that a scene has the parts that the rows of a series move. `name` and `text` are those of the
/// file that [`read_series`] read.
///
/// ```
/// let text = b"move washer,rig.ring_diameter_mm\n-t .01 0 0,20\n";
/// let rows = radsight::read_series("poses.csv", text).unwrap();
/// let scene = radsight_ir::Scene::default();
/// let error = radsight::check_moved_parts("poses.csv", text, &rows, &scene).unwrap_err();
/// assert!(error.to_string().contains("poses.csv:1:6: error: the scene has no surface \"washer\""), "{error}");
/// ```
///
/// # Errors
/// [`Error::Series`] at the names of those that it lacks.
pub fn check_moved_parts(name: &str, text: &[u8], rows: &[SeriesRow], scene: &Scene) -> Result<(), Error> {
    let mut sources = SourceMap::default();
    let source = sources.add(name, text, None);
    let mut reader = Reader { source, sources: &sources, errors: Vec::new() };
    let text = std::str::from_utf8(text).unwrap_or_default();
    let head = reader.next_line(text, &mut 0).unwrap_or_default();
    let mut mistakes = Vec::new();
    for Cell { text: column, span } in head {
        let is_wanted = |part: &&PartMove| moved_part(&column) == Some(part.surfaces());
        let part = rows.iter().flat_map(|row| &row.moves).find(is_wanted);
        let Some((part, mistake)) = part.and_then(|part| Some((part, moved_surfaces(scene, [part]).err()?))) else {
            continue;
        };
        let written = &text[span.start as usize..span.end as usize];
        let start = written.rfind(part.surfaces()).map(|offset| span.start as usize + offset);
        let place = start.map_or(span, |start| reader.span(start, start + part.surfaces().len()));
        mistakes.push(mistake.at(place));
    }
    match mistakes.is_empty() {
        true => Ok(()),
        false => Err(Error::Series(Report::new(mistakes, sources))),
    }
}

impl SeriesRow {
    /// The capture of a camera file with the keys of this row. `table` has the name and text of the
    /// file that [`read_series`] read.
    ///
    /// ```
    /// use radsight::{MemoryLoader, example, read_series};
    /// let table = ("rings.csv", &b"name,camera.exposure_ms\na,5\nb,-3\n"[..]);
    /// let rows = read_series(table.0, table.1)?;
    /// let camera = ("camera.toml", example::CAMERA);
    /// assert!(rows[0].capture(camera, table, &MemoryLoader::default()).is_ok());
    /// let error = rows[1].capture(camera, table, &MemoryLoader::default()).unwrap_err();
    /// assert!(error.to_string().contains("rings.csv:3:3"), "{error}");
    /// # Ok::<(), radsight::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Series`] at the cell of a key that the camera file may not have, or of a wrong value;
    /// [`Error::Camera`] with the mistakes of the file itself.
    pub fn capture(
        &self,
        (name, text): (&str, &[u8]),
        table: (&str, &[u8]),
        loader: &dyn Loader,
    ) -> Result<Capture, Error> {
        let with = |keys: &[(String, String)]| Capture::with_keys(name, text, keys, loader);
        let together = match with(&self.keys) {
            Ok(capture) => return Ok(capture),
            Err(together) => together,
        };
        with(&[])?;
        let alone = |key: &(String, String)| Some((key.clone(), with(std::slice::from_ref(key)).err()?));
        let mut wrong: Vec<((String, String), Error)> = self.keys.iter().filter_map(alone).collect();
        if wrong.is_empty() {
            // Keys that do not go together: the last one is named.
            wrong.extend(self.keys.last().map(|key| (key.clone(), together)));
        }
        let rewritten = |(key, value): &(String, String)| {
            let text = std::str::from_utf8(text).ok()?;
            radsight_camera::with_key(text, key, value).ok()
        };
        let mut sources = SourceMap::default();
        let cells = self.cells(table, &mut sources);
        let mistakes = wrong.into_iter().flat_map(|(key, error)| {
            let cells = cells.iter().find(|(column, ..)| *column == key.0).map(|(_, head, cell)| [*head, *cell]);
            let whole = rewritten(&key).unwrap_or_default();
            mistakes(error).into_iter().map(move |mistake| {
                let written = mistake.span.and_then(|span| whole.get(span.start as usize..span.end as usize));
                let is_key = written.is_none_or(|written| key.0.ends_with(written));
                let place = cells.map(|[head, cell]| if is_key { head } else { cell });
                Diagnostic { span: place, ..mistake }
            })
        });
        let mistakes = mistakes.collect();
        Err(Error::Series(Report::new(mistakes, sources)))
    }

    /// The columns of the table, each with the place of its name and of its cell in this row.
    fn cells(&self, (name, text): (&str, &[u8]), sources: &mut SourceMap) -> Vec<(String, Span, Span)> {
        let source = sources.add(name, text, None);
        let mut reader = Reader { source, sources, errors: Vec::new() };
        let mut lines = reader.lines(std::str::from_utf8(text).unwrap_or_default()).into_iter();
        let head = lines.next().unwrap_or_default();
        let is_own =
            |cells: &Vec<Cell>| cells.first().is_some_and(|cell| sources.position(cell.span).line == self.line);
        let own = lines.find(is_own).unwrap_or_default();
        head.into_iter().zip(own).map(|(column, cell)| (column.text, column.span, cell.span)).collect()
    }
}

/// The mistakes of an error, with the places that they have in the camera file.
fn mistakes(error: Error) -> Vec<Diagnostic> {
    match error {
        Error::Camera(report) => report.diagnostics,
        other => vec![Diagnostic::error(other.to_string())],
    }
}

/// The surfaces that a column moves, which may be empty; `None` for another column.
fn moved_part(column: &str) -> Option<&str> {
    column.strip_prefix(MOVE).map(str::trim)
}

struct Reader<'s> {
    source: SourceId,
    sources: &'s SourceMap,
    errors: Vec<Diagnostic>,
}

/// One cell of the table, trimmed and unquoted.
struct Cell {
    text: String,
    span: Span,
}

impl Reader<'_> {
    fn rows(&mut self, text: &[u8]) -> Vec<SeriesRow> {
        let whole = self.sources.span(self.source, 0, 0);
        if text.len() > LARGEST_FILE {
            self.error(whole, format!("the series has {} bytes, expected at most {LARGEST_FILE}", text.len()));
            return Vec::new();
        }
        let Ok(text) = std::str::from_utf8(text) else {
            self.error(whole, "the series is not UTF-8 text".to_owned());
            return Vec::new();
        };
        let mut lines = self.lines(text).into_iter();
        let Some(head) = lines.next() else {
            self.error(whole, "the series is empty, expected a line with the names of its columns".to_owned());
            return Vec::new();
        };
        let columns = self.columns(head);
        let rows: Vec<(SeriesRow, Span)> = lines.filter_map(|cells| self.row(&columns, cells)).collect();
        if rows.is_empty() && self.errors.is_empty() {
            self.error(whole, "the series has no picture, expected a line for each".to_owned());
        }
        self.named(rows)
    }

    /// The cells of each non-empty line.
    fn lines(&mut self, text: &str) -> Vec<Vec<Cell>> {
        let mut at = 0;
        std::iter::from_fn(|| self.next_line(text, &mut at)).collect()
    }

    /// The cells of the next non-empty line after a position, which moves on.
    fn next_line(&mut self, text: &str, at: &mut usize) -> Option<Vec<Cell>> {
        if *at == 0 && text.starts_with('\u{feff}') {
            *at = 3;
        }
        while self.errors.len() < MOST_ERRORS {
            let start = *at;
            let line = text[start..].split_inclusive('\n').next()?;
            *at += line.len();
            let line = line.trim_end_matches(['\n', '\r']);
            if line.trim().is_empty() || line.trim_start().starts_with('#') {
                continue;
            }
            if let Some(cells) = self.cells(line, start) {
                return Some(cells);
            }
        }
        None
    }

    fn cells(&mut self, line: &str, start: usize) -> Option<Vec<Cell>> {
        let (mut cells, mut at) = (Vec::new(), 0);
        loop {
            let rest = &line[at..];
            let lead = rest.len() - rest.trim_start().len();
            let (text, length) = match rest[lead..].strip_prefix('"') {
                Some(quoted) => {
                    let Some((text, length)) = unquoted(quoted) else {
                        let span = self.span(start + at + lead, start + line.len());
                        self.error(span, "the quotes are not closed".to_owned());
                        return None;
                    };
                    (text, lead + 1 + length)
                }
                None => {
                    let length = rest.find(',').unwrap_or(rest.len());
                    (rest[..length].trim().to_owned(), length)
                }
            };
            let between = &rest[length..rest[length..].find(',').map_or(rest.len(), |comma| length + comma)];
            if !between.trim().is_empty() {
                let span = self.span(start + at + length, start + at + length + between.len());
                self.error(span, "expected a comma after the quotes".to_owned());
                return None;
            }
            let end = start + at + rest[..length].trim_end().len();
            cells.push(Cell { text, span: self.span((start + at + lead).min(end), end) });
            at += length + between.len();
            if at >= line.len() {
                return Some(cells);
            }
            at += 1;
        }
    }

    fn columns(&mut self, head: Vec<Cell>) -> Vec<Column> {
        let mut seen = BTreeSet::new();
        let mut columns = Vec::new();
        for Cell { text, span } in head {
            if !seen.insert(text.clone()) {
                self.error(span, format!("a second column \"{text}\""));
            }
            columns.push(match moved_part(&text) {
                _ if text == "name" => Column::Name,
                Some(surfaces) if !surfaces.is_empty() => Column::Move(surfaces.to_owned()),
                None if text.contains('.') => Column::Key(text),
                _ => {
                    let message = format!(
                        "unknown column \"{text}\", expected name, move NAME, or a key of the camera file such as rig.ring_diameter_mm"
                    );
                    self.error(span, message);
                    Column::Name
                }
            });
        }
        columns
    }

    /// A picture, and the place of its name, or of its line if it has none.
    fn row(&mut self, columns: &[Column], cells: Vec<Cell>) -> Option<(SeriesRow, Span)> {
        let first = cells.first()?.span;
        if cells.len() != columns.len() {
            self.error(first, format!("{} cells, expected {}", cells.len(), columns.len()));
            return None;
        }
        let line = self.sources.position(first).line;
        let mut place = first;
        let mut row = SeriesRow { name: String::new(), line, keys: Vec::new(), moves: Vec::new() };
        for (column, cell) in columns.iter().zip(cells).filter(|(_, cell)| !cell.text.is_empty()) {
            match column {
                Column::Name if cell.text.contains(['/', '\\', '\0']) => {
                    self.error(cell.span, format!("\"{}\" cannot be part of a file's name", cell.text));
                }
                Column::Name => (row.name, place) = (cell.text, cell.span),
                Column::Key(key) => row.keys.push((key.clone(), cell.text)),
                Column::Move(surfaces) => match PartMove::new(surfaces, &cell.text) {
                    Ok(moved) => row.moves.push(moved),
                    Err(mistake) => self.error(cell.span, mistake),
                },
            }
        }
        Some((row, place))
    }

    /// Numbers the pictures without a name, and checks that names are unique.
    fn named(&mut self, mut rows: Vec<(SeriesRow, Span)>) -> Vec<SeriesRow> {
        let digits = rows.len().to_string().len();
        let mut seen = BTreeSet::new();
        for (number, (row, place)) in (1..).zip(&mut rows) {
            if row.name.is_empty() {
                row.name = format!("{number:0digits$}");
            }
            if !seen.insert(row.name.clone()) {
                self.error(*place, format!("a second picture \"{}\"", row.name));
            }
        }
        rows.into_iter().map(|(row, _)| row).collect()
    }

    fn span(&self, start: usize, end: usize) -> Span {
        self.sources.span(self.source, start, end)
    }

    fn error(&mut self, span: Span, message: String) {
        if self.errors.len() < MOST_ERRORS {
            self.errors.push(Diagnostic::error(message).at(span));
        }
    }
}

/// The text up to the closing quote, and its length including the quote; two quotes stand for one.
fn unquoted(quoted: &str) -> Option<(String, usize)> {
    let mut text = String::new();
    let mut at = 0;
    loop {
        let end = at + quoted[at..].find('"')?;
        text.push_str(&quoted[at..end]);
        if !quoted[end + 1..].starts_with('"') {
            return Some((text, end + 1));
        }
        text.push('"');
        at = end + 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors(text: &str) -> String {
        read_series("s.csv", text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn quotes_hold_commas_and_quotes() {
        let text = "name,camera.position_m,camera.pinhole_model\n a , \"[0, 0, .5]\" ,\"\"\"point\"\"\"\n";
        let rows = read_series("s.csv", text.as_bytes()).unwrap();
        assert_eq!(rows[0].name, "a");
        assert_eq!(rows[0].keys[0].1, "[0, 0, .5]");
        assert_eq!(rows[0].keys[1].1, "\"point\"");
    }

    #[test]
    fn pictures_without_a_name_are_numbered() {
        let rows = read_series("s.csv", "rig.leds\n# a comment\n\n1\n2\r\n".as_bytes()).unwrap();
        assert_eq!(rows.iter().map(|row| (&*row.name, row.line)).collect::<Vec<_>>(), [("1", 4), ("2", 5)]);
    }

    #[test]
    fn every_mistake_says_where() {
        let text = "name,leds,move \nx,1,\n../y,1,\nz,1\n\"a,b\n";
        let message = errors(text);
        for expected in [
            "s.csv:1:6: error: unknown column \"leds\"",
            "s.csv:1:11: error: unknown column \"move\"",
            "s.csv:3:1: error: \"../y\" cannot be part of a file's name",
            "s.csv:4:1: error: 2 cells, expected 3",
            "s.csv:5:1: error: the quotes are not closed",
        ] {
            assert!(message.contains(expected), "{expected}\n{message}");
        }
        assert!(errors("rig.leds\n").contains("has no picture"));
        assert!(errors("").contains("is empty"));
        assert!(errors("name,rig.leds\na,1\na,2\n").contains("s.csv:3:1: error: a second picture \"a\""));
        assert!(errors("rig.leds,rig.leds\n1,2\n").contains("1:10: error: a second column"));
    }
}
