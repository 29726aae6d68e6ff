//! Collects diagnostics: each once, up to a limit.

use radsight_diag::{Diagnostic, Severity, SourceId};
use std::collections::{HashMap, HashSet};
use std::hash::{DefaultHasher, Hash, Hasher};

/// Number of messages beyond which further ones are only counted.
const MOST_MESSAGES: usize = 1000;

#[derive(Debug, Default)]
pub(crate) struct Log {
    pub(crate) diagnostics: Vec<Diagnostic>,
    /// Number of messages that were left out.
    pub(crate) omitted: usize,
    seen: HashSet<u64>,
    /// Maps each source to the first one with the same text: a text may be read many times, each
    /// time as another source.
    first_reading: HashMap<SourceId, SourceId>,
}

impl Log {
    /// Declares that a source has the same text as an earlier one, so that a mistake in it is
    /// reported once.
    pub(crate) fn same_text(&mut self, source: SourceId, first: SourceId) {
        self.first_reading.insert(source, first);
    }

    pub(crate) fn push(&mut self, diagnostic: Diagnostic) {
        let mut hasher = DefaultHasher::new();
        diagnostic.message.hash(&mut hasher);
        if let Some(span) = diagnostic.span {
            let source = self.first_reading.get(&span.source).copied().unwrap_or(span.source);
            (source, span.start, span.end).hash(&mut hasher);
        }
        if self.seen.len() < 64 * MOST_MESSAGES && !self.seen.insert(hasher.finish()) {
            return;
        }
        if self.diagnostics.len() < MOST_MESSAGES {
            self.diagnostics.push(diagnostic);
        } else if diagnostic.severity == Severity::Error
            && let Some(warning) = self.diagnostics.iter_mut().rev().find(|other| other.severity < Severity::Error)
        {
            // When the log is full, an error replaces a warning.
            *warning = diagnostic;
            self.omitted += 1;
        } else {
            self.omitted += 1;
        }
    }

    /// Turns the errors from message number `count` on into warnings, and returns the first of
    /// them.
    pub(crate) fn tolerate_since(&mut self, count: usize) -> Option<String> {
        let new = self.diagnostics.get_mut(count..).unwrap_or_default();
        new.iter_mut().for_each(|diagnostic| diagnostic.severity = diagnostic.severity.min(Severity::Warning));
        new.first().map(|diagnostic| diagnostic.message.clone())
    }

    pub(crate) fn extend(&mut self, diagnostics: impl IntoIterator<Item = Diagnostic>) {
        diagnostics.into_iter().for_each(|diagnostic| self.push(diagnostic));
    }
}
