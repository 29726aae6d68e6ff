//! Polygonal fonts.
//!
//! A font file (`.fnt`) is text. Each character has its code from 1 to 255, the number of its
//! vertices, and the vertices as pairs of integers from 0 to 255 in its cell, x to the right and y
//! up. Comments extend from `#` to the end of the line. A character without vertices is a space
//! (Radiance's `font.c`).

use crate::FormatError;

/// A polygonal font.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Font {
    /// The 256 glyphs by character code; `None` for characters that the font lacks.
    pub glyphs: Vec<Option<Glyph>>,
}

/// One character.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Glyph {
    /// Outline; holes are joined by seams. Empty for a space.
    pub vertices: Vec<(u8, u8)>,
}

/// Largest number of vertices that Radiance reads.
const MOST_VERTICES: i64 = 32_000;

impl Font {
    /// Reads a font.
    ///
    /// # Errors
    /// At the first word that is not valid in a font.
    ///
    /// ```
    /// use radsight_formats::Font;
    /// let font = Font::read(b"# a box and a space\n65 4 10 0 90 0 90 200 10 200\n32 0\n").unwrap();
    /// assert_eq!(font.glyphs[65].as_ref().unwrap().vertices[2], (90, 200));
    /// assert!(font.glyphs[32].as_ref().unwrap().vertices.is_empty() && font.glyphs[66].is_none());
    /// ```
    pub fn read(bytes: &[u8]) -> Result<Font, FormatError> {
        let mut words = Words { bytes, offset: 0 };
        let mut glyphs = vec![None; 256];
        while let Some(word) = words.next() {
            let code = word.integer(1..=255, "a character code from 1 to 255")?;
            if glyphs[code as usize].is_some() {
                return Err(word.unexpected("a character code that is not defined above"));
            }
            let count = words.expect("a number of vertices")?;
            let count = count.integer(0..=MOST_VERTICES, "a number of vertices from 0 to 32000")?;
            let mut vertices = Vec::new();
            for _ in 0..count {
                let mut coordinate = || -> Result<u8, FormatError> {
                    let word = words.expect("a coordinate")?;
                    word.integer(0..=255, "a coordinate from 0 to 255").map(|value| value as u8)
                };
                vertices.push((coordinate()?, coordinate()?));
            }
            glyphs[code as usize] = Some(Glyph { vertices });
        }
        Ok(Font { glyphs })
    }
}

/// A word and its offset.
struct Word<'a> {
    text: &'a [u8],
    offset: usize,
}

impl Word<'_> {
    fn integer(&self, range: std::ops::RangeInclusive<i64>, expected: &'static str) -> Result<i64, FormatError> {
        let text = std::str::from_utf8(self.text).ok();
        let value = text.and_then(|text| text.parse().ok());
        value.filter(|value| range.contains(value)).ok_or_else(|| self.unexpected(expected))
    }

    fn unexpected(&self, expected: &'static str) -> FormatError {
        let found = format!("\"{}\"", String::from_utf8_lossy(&self.text[..self.text.len().min(24)]));
        FormatError::Unexpected { offset: self.offset, expected: expected.into(), found }
    }
}

/// The words of a text, without comments.
struct Words<'a> {
    bytes: &'a [u8],
    offset: usize,
}

impl<'a> Words<'a> {
    fn expect(&mut self, expected: &'static str) -> Result<Word<'a>, FormatError> {
        let truncated = FormatError::Truncated { offset: self.bytes.len(), expected: expected.into() };
        self.next().ok_or(truncated)
    }

    fn skip(&mut self, is_skipped: impl Fn(u8) -> bool) {
        let rest = &self.bytes[self.offset..];
        self.offset += rest.iter().position(|byte| !is_skipped(*byte)).unwrap_or(rest.len());
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = Word<'a>;

    fn next(&mut self) -> Option<Word<'a>> {
        let is_space = |byte: u8| byte == b' ' || (9..=13).contains(&byte);
        loop {
            self.skip(is_space);
            match self.bytes.get(self.offset)? {
                b'#' => self.skip(|byte| byte != b'\n'),
                _ => break,
            }
        }
        let start = self.offset;
        self.skip(|byte| !is_space(byte) && byte != b'#');
        Some(Word { text: &self.bytes[start..self.offset], offset: start })
    }
}
