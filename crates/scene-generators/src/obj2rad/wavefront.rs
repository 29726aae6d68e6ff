//! Statements of Wavefront text, and their vertices.

use crate::facets::{dot, normalize};
use crate::number_text::{leading_integer, whole_number};

/// The statements of a text; a backslash joins lines.
pub(crate) struct Statements<'a> {
    lines: std::str::Lines<'a>,
    line: usize,
}

impl<'a> Statements<'a> {
    pub(crate) fn new(text: &'a str) -> Self {
        Statements { lines: text.lines(), line: 0 }
    }

    /// The current line, from 1.
    pub(crate) fn line(&self) -> usize {
        self.line
    }

    /// The words of the next non-empty statement. Quotes inside words become `^`, since Radiance
    /// names cannot contain them.
    pub(crate) fn next_statement(&mut self) -> Option<Vec<String>> {
        loop {
            let mut words = Vec::new();
            loop {
                let Some(line) = self.lines.next() else {
                    // The text ends in a backslash.
                    return Some(words).filter(|words| !words.is_empty());
                };
                self.line += 1;
                let (line, goes_on) = match line.strip_suffix('\\') {
                    Some(line) => (line, true),
                    None => (line, false),
                };
                let separates = |character: char| character.is_ascii_whitespace() || character == '\x0b';
                let parts =
                    line.split(separates).map(|word| word.trim_start_matches('\\')).filter(|word| !word.is_empty());
                words.extend(parts.map(|word| word.replace(['"', '\''], "^")));
                if !goes_on {
                    break;
                }
            }
            if !words.is_empty() {
                return Some(words);
            }
        }
    }
}

/// The mistake of a statement with fewer than three numbers.
fn missing_number(keyword: &str, words: &[String], numbers: usize) -> String {
    match words.get(numbers) {
        Some(word) => format!("number {} of {keyword} is \"{word}\", expected a finite number", numbers + 1),
        None => format!("{keyword} is followed by {numbers} numbers, expected 3"),
    }
}

/// A corner of a face.
#[derive(Clone, Copy)]
pub(crate) struct Corner {
    point: usize,
    pub(crate) normal: Option<usize>,
    /// Texture coordinates.
    pub(crate) texture: Option<usize>,
}

/// Points, normals and texture coordinates so far.
#[derive(Default)]
pub(crate) struct Vertices {
    points: Vec<[f64; 3]>,
    normals: Vec<[f64; 3]>,
    textures: Vec<[f64; 2]>,
    /// Number of normals of zero length.
    pub(crate) zero_normals: usize,
}

impl Vertices {
    /// Parses a statement `v`, `vn` or `vt`; false if a `vt` is malformed.
    pub(crate) fn add(&mut self, words: &[String]) -> Result<bool, String> {
        let numbers: Vec<f64> =
            words[1..].iter().map_while(|word| whole_number(word)).filter(|value| value.is_finite()).collect();
        match (words[0].as_str(), &numbers[..]) {
            ("v", [x, y, z, ..]) => self.points.push([*x, *y, *z]),
            ("vn", [x, y, z, ..]) => {
                let normal = normalize([*x, *y, *z]);
                self.zero_normals += usize::from(normal.is_none());
                self.normals.push(normal.unwrap_or_default());
            }
            ("vt", [u, v, ..]) => self.textures.push([*u, *v]),
            ("vt", _) => return Ok(false),
            (keyword, _) => return Err(missing_number(keyword, &words[1..], numbers.len())),
        }
        Ok(true)
    }

    /// Parses `point`, `point/texture` or `point/texture/normal`; indices count from 1, or
    /// backwards from the end.
    pub(crate) fn corner(&self, word: &str) -> Result<Corner, String> {
        let mut parts = word.split('/').map(|part| leading_integer(part).map_or(0, |(index, _)| index));
        let [point, texture, normal] = [0; 3].map(|_| parts.next().unwrap_or(0));
        let find = |index: i64, count: usize, what: &str| -> Result<Option<usize>, String> {
            let found = if index > 0 { index - 1 } else { index.saturating_add(count as i64) };
            match usize::try_from(found) {
                _ if index == 0 => Ok(None),
                Ok(found) if found < count => Ok(Some(found)),
                _ => Err(format!("\"{word}\" names {what} {index}, of {count} so far")),
            }
        };
        let point = find(point, self.points.len(), "point")?;
        let texture = find(texture, self.textures.len(), "texture coordinate")?;
        let normal = find(normal, self.normals.len(), "normal")?;
        let point = point.ok_or_else(|| format!("\"{word}\" names no point"))?;
        let has_length = |normal: &usize| dot(self.normals[*normal], self.normals[*normal]) > 1e-6;
        Ok(Corner { point, normal: normal.filter(has_length), texture })
    }

    pub(crate) fn point(&self, corner: &Corner) -> [f64; 3] {
        self.points[corner.point]
    }

    pub(crate) fn normal(&self, normal: usize) -> [f64; 3] {
        self.normals[normal]
    }

    pub(crate) fn texture(&self, texture: usize) -> [f64; 2] {
        self.textures[texture]
    }
}
