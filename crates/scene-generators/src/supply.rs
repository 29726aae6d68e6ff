//! Streaming input: reads only as much as needed, and flushes pending output before each read.

use std::io::{ErrorKind, Read};
use std::ops::Range;

use radsight_loader::LoadError;

use crate::Error;
use crate::text::Text;

/// Number of bytes per read.
const READ_SIZE: usize = 1 << 16;

/// Longest record, bytes. Only one record and the rest of the last read are kept.
const LONGEST_RECORD: usize = 1 << 28;

/// An input with a window of bytes read but not consumed.
pub(crate) struct Supply<'a> {
    source: Box<dyn Read + 'a>,
    name: String,
    buffer: Vec<u8>,
    /// The window.
    start: usize,
    end: usize,
    ended: bool,
}

impl<'a> Supply<'a> {
    pub(crate) fn new(name: &str, source: Box<dyn Read + 'a>) -> Self {
        Supply { source, name: name.to_owned(), buffer: Vec::new(), start: 0, end: 0, ended: false }
    }

    /// The name of the input in messages.
    pub(crate) fn name(&self) -> &str {
        crate::source_name(&self.name)
    }

    /// The bytes read but not consumed.
    pub(crate) fn window(&self) -> &[u8] {
        &self.buffer[self.start..self.end]
    }

    /// The bytes of a range returned by another method; the next read overwrites them.
    pub(crate) fn bytes(&self, range: Range<usize>) -> &[u8] {
        &self.buffer[range]
    }

    /// Consumes bytes at the start of the window.
    pub(crate) fn take(&mut self, count: usize) -> Range<usize> {
        let begin = self.start;
        self.start = self.start.saturating_add(count).min(self.end);
        begin..self.start
    }

    /// Skips the rest of the input.
    pub(crate) fn stop(&mut self) {
        self.start = self.end;
        self.ended = true;
    }

    /// Consumes a line with its line end, which the last one may lack; `None` at the end of the
    /// input.
    pub(crate) fn line(&mut self, text: &mut Text) -> Result<Option<Range<usize>>, Error> {
        let mut searched = 0;
        loop {
            if let Some(length) = self.window()[searched..].iter().position(|byte| *byte == b'\n') {
                return Ok(Some(self.take(searched + length + 1)));
            }
            searched = self.end - self.start;
            if !self.more(text)? {
                return Ok((searched > 0).then(|| self.take(searched)));
            }
        }
    }

    /// Consumes exactly `count` bytes; `None` if there are fewer.
    pub(crate) fn exactly(&mut self, count: usize, text: &mut Text) -> Result<Option<Range<usize>>, Error> {
        while self.end - self.start < count {
            if !self.more(text)? {
                return Ok(None);
            }
        }
        Ok(Some(self.take(count)))
    }

    /// Reads more bytes after the window; `false` at the end of the input. Flushes the output
    /// before, since the writer of the input may wait for it.
    pub(crate) fn more(&mut self, text: &mut Text) -> Result<bool, Error> {
        if self.ended {
            return Ok(false);
        }
        text.flush()?;
        if self.end - self.start > LONGEST_RECORD {
            return Err(self.unreadable(format!("a record is longer than {LONGEST_RECORD} bytes")));
        }
        self.make_room();
        loop {
            match self.source.read(&mut self.buffer[self.end..]) {
                Ok(0) => self.ended = true,
                Ok(count) => self.end += count,
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) => {
                    let words = error.to_string();
                    return Err(self.unreadable(words.split(" (os error").next().unwrap_or(&words).to_lowercase()));
                }
            }
            return Ok(!self.ended);
        }
    }

    fn make_room(&mut self) {
        if self.start > 0 {
            self.buffer.copy_within(self.start..self.end, 0);
            (self.start, self.end) = (0, self.end - self.start);
        }
        let room = self.buffer.len() - self.end;
        if room < READ_SIZE {
            // The buffer for a long record doubles.
            self.buffer.resize((self.end + READ_SIZE).max(2 * self.end), 0);
        }
    }

    fn unreadable(&self, reason: String) -> Error {
        Error::Load(LoadError::Unreadable { path: self.name().to_owned(), reason })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns one byte at a time.
    struct Drops(&'static [u8]);

    impl Read for Drops {
        fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
            let count = self.0.len().min(1);
            buffer[..count].copy_from_slice(&self.0[..count]);
            self.0 = &self.0[count..];
            Ok(count)
        }
    }

    #[test]
    fn lines_come_whole_however_the_input_comes() {
        let mut text = Text::default();
        let mut supply = Supply::new("-", Box::new(Drops(b"one\n\nthree")));
        let mut lines = Vec::new();
        while let Some(range) = supply.line(&mut text).unwrap() {
            lines.push(supply.bytes(range).to_vec());
        }
        assert_eq!(lines, [&b"one\n"[..], b"\n", b"three"]);
    }

    #[test]
    fn a_record_without_enough_bytes_is_none() {
        let mut text = Text::default();
        let mut supply = Supply::new("-", Box::new(Drops(b"12345")));
        let range = supply.exactly(3, &mut text).unwrap().unwrap();
        assert_eq!(supply.bytes(range), b"123");
        assert_eq!(supply.exactly(3, &mut text).unwrap(), None);
        assert_eq!(supply.window(), b"45");
        let rest = supply.take(usize::MAX);
        assert_eq!(supply.bytes(rest), b"45");
    }
}
