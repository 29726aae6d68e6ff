//! What can be wrong with the form of scene text.

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

/// A mistake and its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SyntaxError {
    /// Where.
    pub place: Place,
    /// What.
    pub mistake: Mistake,
    /// What to do about it.
    pub hint: Option<String>,
}

/// What is wrong with the form of a text.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Mistake {
    /// The text ends inside a primitive.
    #[error("the text ends where {expected} was expected")]
    EndOfText {
        /// In words.
        expected: String,
    },
    /// The second word of a primitive is not a type.
    #[error("unknown type \"{word}\"")]
    UnknownType {
        /// As written.
        word: String,
    },
    /// Something stands between two primitives.
    #[error("expected a primitive, found \"{word}\"")]
    StrayWord {
        /// As written.
        word: String,
    },
    /// A count is not a number of things.
    #[error("expected the number of {} arguments of {primitive}, found \"{word}\"", section.words())]
    BadCount {
        /// Which arguments.
        section: Section,
        /// Type and name.
        primitive: String,
        /// As written.
        word: String,
    },
    /// A count is larger than what the rest of the text can hold.
    #[error("{primitive} announces {count} {} arguments, but only {bytes} bytes follow", section.words())]
    CountTooLarge {
        /// Which arguments.
        section: Section,
        /// Type and name.
        primitive: String,
        /// As written.
        count: u64,
        /// How many bytes the text still has.
        bytes: usize,
    },
    /// An argument is not a number.
    #[error("expected {} argument {number} of {count} of {primitive}, found \"{word}\"", section.words())]
    BadArgument {
        /// Integers or reals.
        section: Section,
        /// From 1.
        number: usize,
        /// How many are announced.
        count: usize,
        /// Type and name.
        primitive: String,
        /// As written.
        word: String,
    },
    /// A number is too large for the machine.
    #[error("number \"{word}\" is too large")]
    TooLarge {
        /// As written.
        word: String,
    },
    /// A word is quoted and the quote does not end.
    #[error("the quote is never closed")]
    UnclosedQuote,
    /// The text cannot be addressed with 32 bits.
    #[error("the text has {bytes} bytes, more than the {} that can be read", super::MAX_TEXT_BYTES)]
    TextTooLong {
        /// Its length.
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

    /// An error about a word where a type should be.
    pub(super) fn unknown_type(place: Place, word: String) -> Self {
        let hint = hint_nearest(&word, Kind::ALL.iter().map(|kind| kind.name()));
        SyntaxError::new(place, Mistake::UnknownType { word }).maybe_hint(hint)
    }

    /// For the user.
    #[must_use]
    pub fn diagnostic(&self, source: SourceId) -> Diagnostic {
        let span = Span { source, start: self.place.start, end: self.place.end };
        Diagnostic::error(self.mistake.to_string()).at(span).maybe_hint(self.hint.clone())
    }
}
