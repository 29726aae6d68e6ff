//! Iterates over the items of a text.

use super::error::{Mistake, Section};
use super::lexer::{self, is_space};
use super::real::{leading_real, parse_integer, parse_real};
use super::{Alias, Item, Primitive, SyntaxError, Word};
use crate::Kind;
use radsight_diag::hint_nearest;

/// Longest text that 32-bit offsets can address, bytes.
pub const MAX_TEXT_BYTES: usize = u32::MAX as usize - 1;

/// Iterates over the items of scene text.
///
/// An item borrows the iterator's buffers, so the caller must use it before the next call. After an
/// error, the iterator resumes at the next position that looks like the start of an item.
#[derive(Debug)]
pub struct Items<'t> {
    whole: &'t [u8],
    rest: &'t [u8],
    strings: Vec<Word>,
    integers: Vec<i64>,
    reals: Vec<f64>,
    /// Type, name and number of real arguments of the previous primitive, for a hint.
    before: Option<(Kind, Word, usize)>,
}

/// The three words at the start of a primitive.
struct Head {
    modifier: Word,
    kind_word: Word,
    kind: Kind,
    name: Word,
}

impl<'t> Items<'t> {
    /// Starts at the beginning of a text.
    ///
    /// # Errors
    /// When the text is longer than [`MAX_TEXT_BYTES`].
    pub fn new(text: &'t [u8]) -> Result<Self, SyntaxError> {
        if text.len() > MAX_TEXT_BYTES {
            return Err(SyntaxError::new(0..0, Mistake::TextTooLong { bytes: text.len() }));
        }
        let (strings, integers, reals) = (Vec::new(), Vec::new(), Vec::new());
        Ok(Items { whole: text, rest: text, strings, integers, reals, before: None })
    }

    /// The next item or mistake; `None` at the end of the text.
    pub fn advance(&mut self) -> Option<Result<Item<'_>, SyntaxError>> {
        let blank = self.rest.iter().take_while(|byte| is_space(**byte)).count();
        self.rest = &self.rest[blank..];
        let line = match self.rest.first()? {
            b'#' => lexer::comment(self.rest),
            b'!' => lexer::command(self.rest),
            _ => return Some(self.primitive()),
        };
        let (rest, line) = line.expect("the first byte was checked");
        let end = self.offset(rest);
        let place = end - line.len() as u32..end;
        self.rest = rest;
        Some(Ok(if line[0] == b'#' { Item::Comment(place) } else { Item::Command(place) }))
    }

    /// Number of bytes left.
    #[must_use]
    pub fn remaining_bytes(&self) -> usize {
        self.rest.len()
    }

    fn primitive(&mut self) -> Result<Item<'_>, SyntaxError> {
        let start = self.rest;
        match self.read_primitive() {
            Ok(Read::Alias(alias)) => Ok(Item::Alias(alias)),
            Ok(Read::Primitive(head, counts)) => {
                self.before = Some((head.kind, head.name, self.reals.len()));
                Ok(Item::Primitive(Primitive {
                    whole: self.whole,
                    modifier: head.modifier,
                    kind: head.kind,
                    kind_word: head.kind_word,
                    name: head.name,
                    strings: &self.strings,
                    integers: &self.integers,
                    reals: &self.reals,
                    counts,
                    end: self.offset(self.rest),
                }))
            }
            Err(error) => {
                self.recover(start, error.place.start);
                Err(error)
            }
        }
    }

    fn read_primitive(&mut self) -> Result<Read<'t>, SyntaxError> {
        let head = self.head()?;
        if head.kind == Kind::Alias {
            let target = self.word(|_| "the target of an alias".to_owned())?;
            let Head { modifier, kind_word, name, .. } = head;
            return Ok(Read::Alias(Alias { whole: self.whole, modifier, kind: kind_word, name, target }));
        }
        let strings = self.count(&head, Section::Strings)?;
        self.strings.clear();
        for _ in 0..strings.1 {
            let word = self.word(|_| "a string argument".to_owned())?;
            self.strings.push(word);
        }
        let integers = self.count(&head, Section::Integers)?;
        self.integers.clear();
        for number in 1..=integers.1 {
            let value = self.integer(&head, number, integers.1)?;
            self.integers.push(value);
        }
        let reals = self.count(&head, Section::Reals)?;
        self.reals.clear();
        for number in 1..=reals.1 {
            let value = self.real(&head, number, reals.1)?;
            self.reals.push(value);
        }
        Ok(Read::Primitive(head, [strings.0, integers.0, reals.0]))
    }

    fn head(&mut self) -> Result<Head, SyntaxError> {
        let before = self.before;
        let modifier = self.word(|_| "a modifier".to_owned())?;
        let first = self.rest;
        let kind_word = match self.word(|_| "a type".to_owned()) {
            Ok(word) => word,
            Err(_) => return Err(self.stray(modifier, before)),
        };
        let unquoted = kind_word.of(self.whole);
        let Some(kind) = Kind::from_word(&unquoted) else {
            self.rest = first;
            let modifier_said = modifier.of(self.whole);
            if parse_real(&modifier_said).is_some() || resembles_head(first) {
                return Err(self.stray(modifier, before));
            }
            return Err(SyntaxError::unknown_type(kind_word.place(), lossy(&unquoted)));
        };
        let name = self.word(|_| format!("the name of a {kind}"))?;
        Ok(Head { modifier, kind_word, kind, name })
    }

    /// An error about a word between two primitives.
    fn stray(&self, word: Word, before: Option<(Kind, Word, usize)>) -> SyntaxError {
        let unquoted = word.of(self.whole);
        let hint = before.filter(|_| parse_real(&unquoted).is_some()).map(|(kind, name, reals)| {
            let name = lossy(&name.of(self.whole));
            format!("{kind} \"{name}\" declares {reals} real arguments; is the count too small?")
        });
        SyntaxError::new(word.place(), Mistake::StrayWord { word: lossy(&unquoted) }).maybe_hint(hint)
    }

    #[inline]
    fn word(&mut self, expected: impl Fn(&Self) -> String) -> Result<Word, SyntaxError> {
        match lexer::raw_word(self.rest) {
            Ok((rest, (raw, is_quoted))) => {
                let end = self.offset(rest);
                let word = Word { start: end - raw.len() as u32, end, is_quoted };
                if is_quoted && rest.is_empty() {
                    self.check_quotes(word, raw)?;
                }
                self.rest = rest;
                Ok(word)
            }
            Err(_) => Err(self.end_of_text(expected(self))),
        }
    }

    fn check_quotes(&self, word: Word, raw: &[u8]) -> Result<(), SyntaxError> {
        match lexer::unclosed_quote(raw) {
            Some(at) => {
                let start = word.start + at as u32;
                Err(SyntaxError::new(start..start + 1, Mistake::UnclosedQuote))
            }
            None => Ok(()),
        }
    }

    fn end_of_text(&self, expected: String) -> SyntaxError {
        let last = self.whole.iter().rposition(|byte| !is_space(*byte)).unwrap_or(0) as u32;
        SyntaxError::new(last..last + 1, Mistake::EndOfText { expected })
    }

    /// Reads the count of an argument group and checks it against the length of the remaining text.
    fn count(&mut self, head: &Head, section: Section) -> Result<(Word, usize), SyntaxError> {
        let start = self.rest;
        let expected =
            |items: &Self| format!("the number of {} arguments of {}", section_word(section), items.called(head));
        let word = self.word(expected)?;
        let unquoted = word.of(self.whole);
        let count = parse_integer(&unquoted).and_then(|count| u64::try_from(count).ok());
        let Some(count) = count else {
            self.rest = start;
            let mistake = Mistake::BadCount { section, primitive: self.called(head), word: lossy(&unquoted) };
            return Err(SyntaxError::new(word.place(), mistake).maybe_hint(self.count_hint(&unquoted, word)));
        };
        // Each argument takes at least two bytes. A small count that is not met is found at the end
        // of the text.
        let bytes = self.rest.len();
        if count > 1000 && count > bytes as u64 / 2 {
            let mistake = Mistake::CountTooLarge { section, primitive: self.called(head), count, bytes };
            return Err(SyntaxError::new(word.place(), mistake));
        }
        Ok((word, count as usize))
    }

    fn count_hint(&self, unquoted: &[u8], word: Word) -> Option<String> {
        if unquoted.starts_with(b"#") {
            return Some("a comment cannot stand inside a primitive".to_owned());
        }
        let is_head = resembles_head(&self.whole[word.end as usize..]);
        is_head.then(|| "three counts follow the name: strings, integers, reals, each 0 if there are none".to_owned())
    }

    fn integer(&mut self, head: &Head, number: usize, count: usize) -> Result<i64, SyntaxError> {
        let expected = |items: &Self| format!("integer argument {number} of {count} of {}", items.called(head));
        let word = self.word(expected)?;
        let unquoted = word.of(self.whole);
        parse_integer(&unquoted).ok_or_else(|| self.bad_argument(head, word, (Section::Integers, number, count)))
    }

    #[inline]
    fn real(&mut self, head: &Head, number: usize, count: usize) -> Result<f64, SyntaxError> {
        let blank = self.rest.iter().take_while(|byte| is_space(**byte)).count();
        let text = &self.rest[blank..];
        if let Some((value, length)) = leading_real(text)
            && text.get(length).is_none_or(|byte| is_space(*byte))
            && value.is_finite()
        {
            self.rest = &text[length..];
            return Ok(value);
        }
        self.slow_real(head, number, count)
    }

    /// Reads a real argument that is quoted or malformed.
    #[cold]
    fn slow_real(&mut self, head: &Head, number: usize, count: usize) -> Result<f64, SyntaxError> {
        let expected = |items: &Self| format!("real argument {number} of {count} of {}", items.called(head));
        let word = self.word(expected)?;
        let unquoted = word.of(self.whole);
        match parse_real(&unquoted) {
            Some(value) if value.is_finite() => Ok(value),
            Some(_) => Err(SyntaxError::new(word.place(), Mistake::TooLarge { word: lossy(&unquoted) })),
            None => Err(self.bad_argument(head, word, (Section::Reals, number, count))),
        }
    }

    fn bad_argument(&self, head: &Head, word: Word, (section, number, count): (Section, usize, usize)) -> SyntaxError {
        let unquoted = word.of(self.whole);
        let hint = if unquoted.starts_with(b"#") {
            Some("a comment cannot stand inside a primitive".to_owned())
        } else if resembles_head(&self.whole[word.end as usize..]) {
            Some(format!("\"{}\" seems to begin the next primitive; is the count {count} too large?", lossy(&unquoted)))
        } else {
            None
        };
        let mistake =
            Mistake::BadArgument { section, number, count, primitive: self.called(head), word: lossy(&unquoted) };
        SyntaxError::new(word.place(), mistake).maybe_hint(hint)
    }

    /// Type and name, for messages.
    fn called(&self, head: &Head) -> String {
        format!("{} \"{}\"", head.kind, lossy(&head.name.of(self.whole)))
    }

    /// Moves to the next position that looks like the start of an item: the faulty word itself, or
    /// the start of a line.
    fn recover(&mut self, start: &'t [u8], fault: u32) {
        let begin = self.offset(start) as usize;
        let fault = fault as usize;
        if fault > begin && resembles_primitive(&self.whole[fault..]) {
            self.rest = &self.whole[fault..];
            return;
        }
        let mut at = fault.max(begin);
        while let Some(line_end) = self.whole[at..].iter().position(|byte| *byte == b'\n' || *byte == b'\r') {
            at += line_end + 1;
            let line = &self.whole[at..];
            let blank = line.iter().take_while(|byte| **byte == b' ' || **byte == b'\t').count();
            let is_line_item = matches!(line.get(blank), Some(b'!' | b'#'));
            if is_line_item || resembles_primitive(line) {
                self.rest = line;
                return;
            }
        }
        self.rest = &[];
    }

    #[inline]
    fn offset(&self, rest: &[u8]) -> u32 {
        (self.whole.len() - rest.len()) as u32
    }
}

enum Read<'t> {
    Alias(Alias<'t>),
    Primitive(Head, [Word; 3]),
}

/// Whether the first word is a type, so that the word before it begins a primitive.
fn resembles_head(text: &[u8]) -> bool {
    lexer::raw_word(text).is_ok_and(|(_, (word, _))| Kind::from_word(word).is_some())
}

/// Whether the second word is a type or resembles one.
fn resembles_primitive(text: &[u8]) -> bool {
    let Ok((rest, (first, _))) = lexer::raw_word(text) else { return false };
    if parse_real(first).is_some() && !resembles_head(rest) {
        return false;
    }
    let Ok((rest, (kind, _))) = lexer::raw_word(rest) else { return false };
    if Kind::from_word(kind).is_some() {
        return true;
    }
    // A misspelt type counts if a name and a count follow.
    let kind = lossy(kind);
    let is_slip = hint_nearest(&kind, Kind::ALL.iter().map(|kind| kind.name())).is_some();
    let mut after = lexer::words(rest, 0);
    is_slip && after.nth(1).is_some_and(|count| parse_integer(&count.of(rest)).is_some())
}

fn section_word(section: Section) -> &'static str {
    match section {
        Section::Strings => "string",
        Section::Integers => "integer",
        Section::Reals => "real",
    }
}

/// Bytes as text for messages, shortened to one line.
pub(super) fn lossy(bytes: &[u8]) -> String {
    const LONGEST: usize = 60;
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * LONGEST)]);
    if text.chars().count() <= LONGEST {
        return text.into_owned();
    }
    text.chars().take(LONGEST).chain(['…']).collect()
}
