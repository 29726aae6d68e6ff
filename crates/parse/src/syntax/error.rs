//! Syntax errors of scene text.

use super::Place;
use crate::Kind;
use radsight_diag::{Diagnostic, SourceId, Span, hint_nearest};

/// One of the three groups of arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    /// String arguments.
    Strings,
    /// Integer arguments.
    Integers,
    /// Real arguments.
    Reals,
}

impl Section {
    fn words(self) -> &'static str {
        match self {
            Section::Strings => "string",
            Section::Integers => "integer",
            Section::Reals => "real",
        }
    }
}

/// A mistake and its position.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SyntaxError {
    /// Its position.
    pub place: Place,
    /// The mistake.
    pub mistake: Mistake,
    /// How to correct it.
    pub hint: Option<String>,
}

/// The kinds of syntax errors.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Mistake {
    /// The text ends inside a primitive.
    #[error("the text ends where {expected} was expected")]
    EndOfText {
        /// What was expected.
        expected: String,
    },
    /// The second word of a primitive is not a type.
    #[error("unknown type \"{word}\"")]
    UnknownType {
        /// The word as written.
        word: String,
    },
    /// A word stands between two primitives.
    #[error("expected a primitive, found \"{word}\"")]
    StrayWord {
        /// The word as written.
        word: String,
    },
    /// A count is not a non-negative integer.
    #[error("expected the number of {} arguments of {primitive}, found \"{word}\"", section.words())]
    BadCount {
        /// The group of arguments.
        section: Section,
        /// Type and name.
        primitive: String,
        /// The word as written.
        word: String,
    },
    /// A count exceeds what the rest of the text can hold.
    #[error("{primitive} declares {count} {} arguments, but only {bytes} bytes follow", section.words())]
    CountTooLarge {
        /// The group of arguments.
        section: Section,
        /// Type and name.
        primitive: String,
        /// The count as written.
        count: u64,
        /// Number of remaining bytes.
        bytes: usize,
    },
    /// An argument is not a number.
    #[error("expected {} argument {number} of {count} of {primitive}, found \"{word}\"", section.words())]
    BadArgument {
        /// Integers or reals.
        section: Section,
        /// Index of the argument, from 1.
        number: usize,
        /// Declared number of arguments.
        count: usize,
        /// Type and name.
        primitive: String,
        /// The word as written.
        word: String,
    },
    /// A number is too large for the machine.
    #[error("number \"{word}\" is too large")]
    TooLarge {
        /// The number as written.
        word: String,
    },
    /// A quoted word has no closing quote.
    #[error("the quote is never closed")]
    UnclosedQuote,
    /// The text is longer than 32-bit offsets can address.
    #[error("the text has {bytes} bytes, expected at most {}", super::MAX_TEXT_BYTES)]
    TextTooLong {
        /// Its length in bytes.
        bytes: usize,
    },
}

impl SyntaxError {
    pub(super) fn new(place: Place, mistake: Mistake) -> Self {
        SyntaxError { place, mistake, hint: None }
    }

    pub(super) fn maybe_hint(mut self, hint: Option<String>) -> Self {
        self.hint = self.hint.or(hint);
        self
    }

    /// An error about a word in place of a type.
    pub(crate) fn unknown_type(place: Place, word: String) -> Self {
        let hint = hint_nearest(&word, Kind::ALL.iter().map(|kind| kind.name()));
        SyntaxError::new(place, Mistake::UnknownType { word }).maybe_hint(hint)
    }

    /// The diagnostic for the user.
    #[must_use]
    pub fn diagnostic(&self, source: SourceId) -> Diagnostic {
        let span = Span { source, start: self.place.start, end: self.place.end };
        Diagnostic::error(self.mistake.to_string()).at(span).maybe_hint(self.hint.clone())
    }
}
