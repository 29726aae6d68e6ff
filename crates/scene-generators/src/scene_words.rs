//! White-space separated words of a Radiance file, with quotes.

use crate::text::is_space;

/// A cursor over the bytes of a file.
pub(crate) struct SceneWords<'a> {
    bytes: &'a [u8],
    position: usize,
}

impl<'a> SceneWords<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        SceneWords { bytes, position: 0 }
    }

    /// Number of bytes consumed.
    pub(crate) fn position(&self) -> usize {
        self.position
    }

    /// The next byte that is not white space, without consuming it.
    pub(crate) fn peek(&mut self) -> Option<u8> {
        while self.bytes.get(self.position).is_some_and(|byte| is_space(*byte as char)) {
            self.position += 1;
        }
        self.bytes.get(self.position).copied()
    }

    /// The next word. A quote protects white space up to its matching quote; quotes are removed.
    pub(crate) fn word(&mut self) -> Option<String> {
        self.peek()?;
        let mut word = Vec::new();
        let mut quote = None;
        while let Some(&byte) = self.bytes.get(self.position) {
            match (byte, quote) {
                (byte, Some(open)) if byte == open => quote = None,
                (b'"' | b'\'', None) => quote = Some(byte),
                (byte, None) if is_space(byte as char) => break,
                _ => word.push(byte),
            }
            self.position += 1;
        }
        Some(String::from_utf8_lossy(&word).into_owned())
    }

    /// The next word as a number; `None` at the end or if it is not one.
    pub(crate) fn number(&mut self) -> Option<f64> {
        crate::number_text::whole_number(&self.word()?)
    }

    /// The next word as a count.
    pub(crate) fn count(&mut self) -> Option<usize> {
        self.word()?.parse().ok()
    }

    /// The rest of the line with its line end.
    pub(crate) fn line(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.position..];
        let length = rest.iter().position(|byte| *byte == b'\n').map_or(rest.len(), |index| index + 1);
        self.position += length;
        &rest[..length]
    }

    /// The rest of the line, including continuation lines after a backslash, without the last line
    /// end.
    pub(crate) fn continued_line(&mut self) -> String {
        let mut joined = Vec::new();
        loop {
            let line = self.line();
            joined.extend_from_slice(line);
            if !joined.ends_with(b"\\\n") && !joined.ends_with(b"\\\r\n") {
                break;
            }
        }
        String::from_utf8_lossy(&joined).trim_end_matches(['\n', '\r']).to_owned()
    }
}
