//! The items of scene text.

use super::lexer;
use std::borrow::Cow;
use std::ops::Range;

/// A half-open range of bytes of the text.
pub type Place = Range<u32>;

/// A word of the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Word {
    /// The first byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
    /// Whether the word contains quotes to be removed.
    pub is_quoted: bool,
}

impl Word {
    /// Its range, including quotes.
    #[must_use]
    pub fn place(self) -> Place {
        self.start..self.end
    }

    /// Its characters without quotes. `text` is the whole text.
    #[must_use]
    pub fn of(self, text: &[u8]) -> Cow<'_, [u8]> {
        let raw = &text[self.start as usize..self.end as usize];
        if self.is_quoted { Cow::Owned(lexer::without_quotes(raw)) } else { Cow::Borrowed(raw) }
    }
}

/// One item of scene text.
#[derive(Clone, Debug)]
pub enum Item<'a> {
    /// From `#` to the end of the line.
    Comment(Place),
    /// From `!` to the end of the line, continuation lines included.
    Command(Place),
    /// `modifier alias name target`.
    Alias(Alias<'a>),
    /// `modifier type name`, then three groups of arguments.
    Primitive(Primitive<'a>),
}

/// Another name for a modifier.
#[derive(Clone, Copy, Debug)]
pub struct Alias<'a> {
    pub(crate) whole: &'a [u8],
    /// The modifier of the new name; `inherit` for the target's own modifier.
    pub modifier: Word,
    /// The word `alias`.
    pub kind: Word,
    /// The new name.
    pub name: Word,
    /// The target.
    pub target: Word,
}

impl<'a> Alias<'a> {
    /// The characters of one of its words.
    #[must_use]
    pub fn text(&self, word: Word) -> Cow<'a, [u8]> {
        word.of(self.whole)
    }
}

/// Any primitive but an alias.
#[derive(Clone, Copy, Debug)]
pub struct Primitive<'a> {
    pub(crate) whole: &'a [u8],
    /// Its modifier.
    pub modifier: Word,
    /// Its type.
    pub kind: crate::Kind,
    /// The word that names the type.
    pub kind_word: Word,
    /// Its identifier.
    pub name: Word,
    /// String arguments.
    pub strings: &'a [Word],
    /// Integer arguments. No type of Radiance has any.
    pub integers: &'a [i64],
    /// Real arguments.
    pub reals: &'a [f64],
    /// Where the counts of the three groups stand.
    pub counts: [Word; 3],
    /// One past the last byte.
    pub end: u32,
}

impl<'a> Primitive<'a> {
    /// The characters of one of its words.
    #[must_use]
    pub fn text(&self, word: Word) -> Cow<'a, [u8]> {
        word.of(self.whole)
    }

    /// Its range, from the modifier to the last argument.
    #[must_use]
    pub fn place(&self) -> Place {
        self.modifier.start..self.end
    }

    /// The range of a real argument, found by scanning from the count.
    #[must_use]
    pub fn real_place(&self, index: usize) -> Place {
        let [_, _, count] = self.counts;
        let rest = &self.whole[count.end as usize..self.end as usize];
        lexer::words(rest, count.end).nth(index).map_or(count.place(), Word::place)
    }
}
