//! Statements of Wavefront text, and the vertices that they name.

use crate::facets::{dot, normalize};
use crate::number_text::{leading_integer, whole_number};

/// The statements of a text, with backslashes joining lines.
pub(super) struct Statements<'a> {
    lines: std::str::Lines<'a>,
    line: usize,
}

impl<'a> Statements<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Statements { lines: text.lines(), line: 0 }
    }

    /// The line that was read last, from 1.
    pub(super) fn line(&self) -> usize {
        self.line
    }

    /// The words of the next statement that has any. Quotes inside of words become `^`, as Radiance cannot have them in names.
    pub(super) fn next_statement(&mut self) -> Option<Vec<String>> {
        loop {
            let mut words = Vec::new();
            loop {
                let line = self.lines.next()?;
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

/// A corner of a face.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    point: usize,
    pub(super) normal: Option<usize>,
}

/// Points and normals so far; texture coordinates are only counted.
#[derive(Default)]
pub(super) struct Vertices {
    points: Vec<[f64; 3]>,
    normals: Vec<[f64; 3]>,
    textures: usize,
    /// How many normals have no length.
    pub(super) zero_normals: usize,
}

impl Vertices {
    /// Takes a statement `v`, `vn` or `vt`; false when a `vt` makes no sense.
    pub(super) fn add(&mut self, words: &[String]) -> Result<bool, String> {
        let numbers: Vec<f64> =
            words[1..].iter().map_while(|word| whole_number(word)).filter(|value| value.is_finite()).collect();
        match (words[0].as_str(), &numbers[..]) {
            ("v", [x, y, z, ..]) => self.points.push([*x, *y, *z]),
            ("vn", [x, y, z, ..]) => {
                let normal = normalize([*x, *y, *z]);
                self.zero_normals += usize::from(normal.is_none());
                self.normals.push(normal.unwrap_or_default());
            }
            ("vt", [_, _, ..]) => self.textures += 1,
            ("vt", _) => return Ok(false),
            (keyword, _) => return Err(format!("{keyword} is followed by {} numbers, expected 3", numbers.len())),
        }
        Ok(true)
    }

    /// Reads `point`, `point/texture` or `point/texture/normal`; numbers count from 1, or back from the end.
    pub(super) fn corner(&self, word: &str) -> Result<Corner, String> {
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
        find(texture, self.textures, "texture coordinate")?;
        let normal = find(normal, self.normals.len(), "normal")?;
        let point = point.ok_or_else(|| format!("\"{word}\" names no point"))?;
        let has_length = |normal: &usize| dot(self.normals[*normal], self.normals[*normal]) > 1e-6;
        Ok(Corner { point, normal: normal.filter(has_length) })
    }

    pub(super) fn point(&self, corner: &Corner) -> [f64; 3] {
        self.points[corner.point]
    }

    pub(super) fn normal(&self, normal: usize) -> [f64; 3] {
        self.normals[normal]
    }
}
