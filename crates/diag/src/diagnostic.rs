//! A message to the user.

use crate::{SourceMap, Span};
use std::fmt::Write;

/// Severity of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Information; nothing is wrong.
    Note,
    /// A suspicious input; the work continues.
    Warning,
    /// The input is wrong.
    Error,
}

impl Severity {
    fn word(self) -> &'static str {
        match self {
            Severity::Note => "note",
            Severity::Warning => "warning",
            Severity::Error => "error",
        }
    }
}

/// A message with its position and hints.
///
/// Messages are lower case, without a full stop. They name the wrong value and what was expected.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// How serious the message is.
    pub severity: Severity,
    /// The problem.
    pub message: String,
    /// The position, if known.
    pub span: Option<Span>,
    /// Ways to correct it.
    pub hints: Vec<String>,
}

impl Diagnostic {
    /// A diagnostic for wrong input.
    pub fn error(message: impl Into<String>) -> Self {
        Diagnostic { severity: Severity::Error, message: message.into(), span: None, hints: Vec::new() }
    }

    /// A diagnostic for suspicious input.
    pub fn warning(message: impl Into<String>) -> Self {
        Diagnostic { severity: Severity::Warning, ..Diagnostic::error(message) }
    }

    /// A diagnostic for information.
    pub fn note(message: impl Into<String>) -> Self {
        Diagnostic { severity: Severity::Note, ..Diagnostic::error(message) }
    }

    /// Sets the position.
    #[must_use]
    pub fn at(mut self, span: Span) -> Self {
        self.span = Some(span);
        self
    }

    /// Adds a hint.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hints.push(hint.into());
        self
    }

    /// Adds a hint if there is one.
    #[must_use]
    pub fn maybe_hint(mut self, hint: Option<String>) -> Self {
        self.hints.extend(hint);
        self
    }

    /// The message as text, with the source line, the caret, the hints and the chain of inclusion.
    #[must_use]
    pub fn render(&self, sources: &SourceMap) -> String {
        let mut out = String::new();
        match self.span {
            Some(span) => {
                let at = sources.position(span);
                let _ = writeln!(
                    out,
                    "{}:{}:{}: {}: {}",
                    sources.name(span.source),
                    at.line,
                    at.column,
                    self.severity.word(),
                    self.message
                );
                render_line(&mut out, sources, span, at.line);
                render_inclusions(&mut out, sources, span);
            }
            None => {
                let _ = writeln!(out, "{}: {}", self.severity.word(), self.message);
            }
        }
        for hint in &self.hints {
            let _ = writeln!(out, "hint: {hint}");
        }
        out
    }
}

/// Longest part of a source line to show, in characters.
const WIDEST_LINE: usize = 160;

fn render_line(out: &mut String, sources: &SourceMap, span: Span, line_number: u32) {
    let (line, first) = sources.line(span);
    if line.trim().is_empty() {
        return;
    }
    let before_bytes = (span.start as usize).saturating_sub(first).min(line.len());
    let before = String::from_utf8_lossy(&line.as_bytes()[..before_bytes]).chars().count();
    let marked_bytes = ((span.end as usize).saturating_sub(first)).min(line.len()).saturating_sub(before_bytes);
    let marked = String::from_utf8_lossy(&line.as_bytes()[before_bytes..before_bytes + marked_bytes]).chars().count();
    // Shorten a long line to the part around the caret.
    let cut = before.saturating_sub(WIDEST_LINE / 2);
    let shown: String =
        line.chars().skip(cut).take(WIDEST_LINE).map(|c| if c == '\t' || c.is_control() { ' ' } else { c }).collect();
    let gutter = line_number.to_string();
    let lead = if cut > 0 { "…" } else { "" };
    let carets = marked.clamp(1, WIDEST_LINE.saturating_sub(before - cut).max(1));
    let _ = writeln!(out, "  {gutter} | {lead}{shown}");
    let _ = writeln!(
        out,
        "  {:width$} | {}{}",
        "",
        " ".repeat(before - cut + lead.chars().count()),
        "^".repeat(carets),
        width = gutter.len()
    );
}

fn render_inclusions(out: &mut String, sources: &SourceMap, span: Span) {
    const DEEPEST: usize = 16;
    let mut from = sources.included_at(span.source);
    for _ in 0..DEEPEST {
        let Some(span) = from else { return };
        let at = sources.position(span);
        let _ = writeln!(out, "  from {}:{}:{}", sources.name(span.source), at.line, at.column);
        from = sources.included_at(span.source);
    }
    if from.is_some() {
        let _ = writeln!(out, "  from …");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chain_of_inclusion_is_shown() {
        let mut sources = SourceMap::default();
        let outer = sources.add("room.rad", &b"!xform -t 0 0 1 chair.rad\n"[..], None);
        let asked = sources.span(outer, 16, 25);
        let inner = sources.add("chair.rad", &b"\n\twood plastic x\n"[..], Some(asked));
        let text = Diagnostic::error("undefined modifier \"wood\"").at(sources.span(inner, 2, 6)).render(&sources);
        assert_eq!(
            text,
            "chair.rad:2:2: error: undefined modifier \"wood\"\n  2 |  wood plastic x\n    |  ^^^^\n  from room.rad:1:17\n"
        );
    }

    #[test]
    fn a_span_past_the_end_does_not_panic() {
        let mut sources = SourceMap::default();
        let file = sources.add("a", &b"\xff\xfe x"[..], None);
        let text = Diagnostic::warning("odd").at(Span { source: file, start: 900, end: 2 }).render(&sources);
        assert!(text.starts_with("a:1:"));
    }

    #[test]
    fn a_very_long_line_is_cut_around_the_mark() {
        let mut sources = SourceMap::default();
        let line = "1 ".repeat(100_000);
        let file = sources.add("a", line.as_bytes(), None);
        let text = Diagnostic::error("x").at(sources.span(file, 150_000, 150_001)).render(&sources);
        assert!(text.len() < 1000, "{} bytes", text.len());
    }
}
