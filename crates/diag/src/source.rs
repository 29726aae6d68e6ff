//! Source texts, spans in them, and their chains of inclusion.

use std::sync::{Arc, OnceLock};

/// Identifies a text in a [`SourceMap`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SourceId(u32);

/// A half-open range of bytes in one text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Span {
    /// The text.
    pub source: SourceId,
    /// The first byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// The smallest span that holds both, or `self` where they are in different texts.
    #[must_use]
    pub fn to(self, other: Span) -> Span {
        if self.source != other.source {
            return self;
        }
        Span { source: self.source, start: self.start.min(other.start), end: self.end.max(other.end) }
    }
}

/// The line and column at which a span begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Position {
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
}

#[derive(Clone, Debug)]
struct Source {
    name: String,
    text: Arc<[u8]>,
    included_at: Option<Span>,
    /// Offsets of the line starts: found for the first message, kept when the text is dropped.
    line_starts: OnceLock<Vec<u32>>,
}

impl Source {
    fn new(name: String, text: Arc<[u8]>, included_at: Option<Span>) -> Source {
        Source { name, text, included_at, line_starts: OnceLock::new() }
    }

    /// A message needs them, and there can be a thousand.
    fn line_starts(&self) -> &[u32] {
        self.line_starts.get_or_init(|| {
            let ends = self.text.iter().enumerate().filter(|(_, byte)| **byte == b'\n');
            let starts = ends.map(|(at, _)| u32::try_from(at + 1).unwrap_or(u32::MAX));
            std::iter::once(0).chain(starts).collect()
        })
    }
}

/// All the texts that were read.
#[derive(Clone, Debug, Default)]
pub struct SourceMap {
    sources: Vec<Source>,
}

impl SourceMap {
    /// Adds a text. `included_at` is the span that included it: a `!xform` line, a function file's
    /// name, and so on.
    pub fn add(&mut self, name: impl Into<String>, text: impl Into<Arc<[u8]>>, included_at: Option<Span>) -> SourceId {
        let id = SourceId(u32::try_from(self.sources.len()).expect("fewer than 2^32 files are read"));
        self.sources.push(Source::new(name.into(), text.into(), included_at));
        id
    }

    /// Gives a text that was added empty its bytes, for readers that write it as they go. Spans may
    /// point into it before.
    pub fn set_text(&mut self, source: SourceId, text: impl Into<Arc<[u8]>>) {
        let source = &mut self.sources[source.0 as usize];
        *source = Source::new(std::mem::take(&mut source.name), text.into(), source.included_at);
    }

    /// A span of bytes `start..end` of `source`. Offsets past 4 GiB are clamped.
    #[must_use]
    pub fn span(&self, source: SourceId, start: usize, end: usize) -> Span {
        let clamp = |offset: usize| u32::try_from(offset).unwrap_or(u32::MAX);
        Span { source, start: clamp(start), end: clamp(end.max(start)) }
    }

    /// The name under which the text was added.
    #[must_use]
    pub fn name(&self, source: SourceId) -> &str {
        &self.sources[source.0 as usize].name
    }

    /// The bytes of the text.
    #[must_use]
    pub fn text(&self, source: SourceId) -> &Arc<[u8]> {
        &self.sources[source.0 as usize].text
    }

    /// All texts that are still kept, in the order in which they were added; a dropped text is
    /// empty.
    pub fn texts(&self) -> impl Iterator<Item = &[u8]> {
        self.sources.iter().map(|source| &source.text[..])
    }

    /// The span that included the text.
    #[must_use]
    pub fn included_at(&self, source: SourceId) -> Option<Span> {
        self.sources[source.0 as usize].included_at
    }

    /// Drops the bytes of a text to save memory. Spans into it then print without their line, and
    /// with columns in bytes.
    pub fn forget_text(&mut self, source: SourceId) {
        let source = &mut self.sources[source.0 as usize];
        source.line_starts();
        source.text = Arc::from(&b""[..]);
    }

    /// Line and column where the span begins.
    #[must_use]
    pub fn position(&self, span: Span) -> Position {
        let source = &self.sources[span.source.0 as usize];
        let line_starts = source.line_starts();
        let line = line_starts.partition_point(|start| *start <= span.start).max(1);
        let line_start = line_starts[line - 1];
        let before = source.text.get(line_start as usize..).unwrap_or_default();
        let bytes = span.start - line_start;
        let column = match before.len() {
            0 => bytes as usize,
            length => String::from_utf8_lossy(&before[..length.min(bytes as usize)]).chars().count(),
        };
        let number = |from_zero: usize| u32::try_from(from_zero + 1).unwrap_or(u32::MAX);
        Position { line: number(line - 1), column: number(column) }
    }

    /// The whole line in which the span begins, without its line end, and the offset of its first
    /// byte.
    #[must_use]
    pub fn line(&self, span: Span) -> (String, usize) {
        let text = self.text(span.source);
        let start = (span.start as usize).min(text.len());
        let first = text[..start].iter().rposition(|&byte| byte == b'\n').map_or(0, |at| at + 1);
        let last = text[first..].iter().position(|&byte| byte == b'\n').map_or(text.len(), |at| first + at);
        (String::from_utf8_lossy(&text[first..last]).trim_end_matches('\r').to_owned(), first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_a_long_text_are_counted_from_its_start() {
        let text: Vec<u8> = (0..12_288).map(|at| if at % 7 == 3 { b'\n' } else { b'x' }).collect();
        let mut sources = SourceMap::default();
        let file = sources.add("a", &b""[..], None);
        sources.set_text(file, &text[..]);
        for start in [0, 3, 4, 4095, 4096, 4097, 8197, 12_288, 16_384] {
            let before = &text[..start.min(text.len())];
            let mut lines = before.split(|byte| *byte == b'\n');
            let expected = Position {
                line: lines.clone().count() as u32,
                column: 1 + lines.next_back().map_or(0, |line| line.len() as u32),
            };
            assert_eq!(sources.position(sources.span(file, start, start)), expected, "at byte {start}");
        }
    }

    #[test]
    fn a_forgotten_text_keeps_its_lines_and_columns() {
        let mut sources = SourceMap::default();
        let file = sources.add("a", &b"one\ntwo three\n"[..], None);
        let span = sources.span(file, 8, 13);
        let before = sources.position(span);
        sources.forget_text(file);
        sources.forget_text(file);
        assert!(sources.text(file).is_empty());
        assert_eq!((sources.position(span), before), (Position { line: 2, column: 5 }, before));
    }
}
