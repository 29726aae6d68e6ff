//! Reads the primitives of compiled files.
//!
//! Messages need a text to point into. It holds the heads of the primitives: their words, the
//! string arguments and the counts, but no real arguments, which are most of a file.

use super::reader::{Context, Here, Reader};
use crate::Kind;
use crate::placement::Placement;
use crate::syntax::{Alias, Item, Primitive, SyntaxError, Word};
use crate::write::Quoted;
use radsight_diag::Span;
use radsight_formats::{Object, PackedObjects};
use std::fmt::{Display, Write};
use std::ops::ControlFlow;

/// What is done with a primitive, and the name of its modifier.
type Visit<'v> = dyn FnMut(&Object<'_>, Option<&[u8]>) -> ControlFlow<()> + 'v;

/// The primitives of a compiled file.
pub(super) trait Objects {
    /// Calls `visit` for each of them, with the name of its modifier, until it breaks.
    fn visit(&self, visit: &mut Visit<'_>);
}

impl Objects for [Object<'_>] {
    fn visit(&self, visit: &mut Visit<'_>) {
        let modifier = |object: &Object<'_>| object.modifier.map(|index| &*self[index].name);
        let _ = self.iter().try_for_each(|object| visit(object, modifier(object)));
    }
}

impl Objects for PackedObjects<'_> {
    fn visit(&self, visit: &mut Visit<'_>) {
        self.for_each(visit);
    }
}

impl Reader<'_> {
    /// Reads objects as if they stood in a scene text of this name. A modifier is the primitive of
    /// its name read last, as in any scene text. `each` is called after each object that was read.
    pub(super) fn read_objects(
        &mut self,
        name: String,
        objects: &(impl Objects + ?Sized),
        included_at: Option<Span>,
        mut each: impl FnMut(&mut Self, &Object<'_>),
    ) {
        let source = self.sources.add(name, &b""[..], included_at);
        let context = Context::new(Placement::default(), String::new());
        let mut heads = Heads::default();
        objects.visit(&mut |object, modifier| {
            let length = heads.text.len();
            let item = heads.item(modifier.unwrap_or(b"void"), object);
            self.item(item, Here { source, context: &context });
            each(self, object);
            let added = heads.text.len() - length;
            if self.is_stopped || !self.count_bytes(added + 2 * object.reals.len(), included_at) {
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        });
        if heads.text.len() > self.options.longest_kept_text {
            self.long_texts.push(source);
        }
        self.sources.set_text(source, heads.text.into_bytes());
    }
}

/// The text of the heads so far.
#[derive(Default)]
struct Heads {
    text: String,
    /// The string arguments of the object written last.
    strings: Vec<Word>,
    /// The last type and its name: most objects have the type of the one before.
    last_kind: Option<(Kind, Vec<u8>)>,
}

impl Heads {
    /// Appends the head of an object with this modifier, and makes an item of it.
    fn item<'a>(&'a mut self, parent: &[u8], object: &'a Object<'_>) -> Result<Item<'a>, SyntaxError> {
        if *object.kind == *b"alias" {
            return Ok(Item::Alias(self.alias(parent, object)));
        }
        let modifier = self.word(parent, ' ');
        let kind_word = self.word(&object.kind, ' ');
        let name = self.word(&object.name, '\n');
        let strings = self.count(object.strings.len(), if object.strings.is_empty() { '\n' } else { ' ' });
        self.strings.clear();
        for (index, string) in object.strings.iter().enumerate() {
            let is_last = index + 1 == object.strings.len();
            let word = self.word(string, if is_last { '\n' } else { ' ' });
            self.strings.push(word);
        }
        let integers = self.count(0, '\n');
        let reals = self.count(object.reals.len(), '\n');
        let Some(kind) = self.kind(&object.kind) else {
            let word = String::from_utf8_lossy(&object.kind).into_owned();
            return Err(SyntaxError::unknown_type(kind_word.place(), word));
        };
        Ok(Item::Primitive(Primitive {
            whole: self.text.as_bytes(),
            modifier,
            kind,
            kind_word,
            name,
            strings: &self.strings,
            integers: &[],
            reals: &object.reals,
            counts: [strings, integers, reals],
            end: reals.end,
        }))
    }

    fn kind(&mut self, word: &[u8]) -> Option<Kind> {
        if let Some((kind, name)) = &self.last_kind
            && name == word
        {
            return Some(*kind);
        }
        let kind = Kind::from_word(word)?;
        self.last_kind = Some((kind, word.to_vec()));
        Some(kind)
    }

    /// An alias without a string argument has its modifier as target.
    fn alias(&mut self, parent: &[u8], object: &Object<'_>) -> Alias<'_> {
        let (modifier, target) = match object.strings.first() {
            Some(target) => (parent, &**target),
            None => (&b"inherit"[..], parent),
        };
        let modifier = self.word(modifier, ' ');
        let kind = self.word(&object.kind, ' ');
        let name = self.word(&object.name, ' ');
        let target = self.word(target, '\n');
        Alias { whole: self.text.as_bytes(), modifier, kind, name, target }
    }

    fn word(&mut self, word: &[u8], after: char) -> Word {
        // Almost all words stand for themselves.
        if let Some(text) = plain(word) {
            return self.push_text(text, after);
        }
        let word = self.push(Quoted(&String::from_utf8_lossy(word)), after);
        // A word with quotes begins with one.
        let is_quoted = matches!(self.text.as_bytes()[word.start as usize], b'"' | b'\'');
        Word { is_quoted, ..word }
    }

    fn count(&mut self, count: usize, after: char) -> Word {
        const DIGITS: &str = "0123456789";
        match DIGITS.get(count..count + 1) {
            Some(digit) => self.push_text(digit, after),
            None => self.push(count, after),
        }
    }

    fn push(&mut self, value: impl Display, after: char) -> Word {
        let start = self.text.len();
        // Writing to a string does not fail.
        let _ = write!(self.text, "{value}");
        self.end_word(start, after)
    }

    fn push_text(&mut self, text: &str, after: char) -> Word {
        let start = self.text.len();
        self.text.push_str(text);
        self.end_word(start, after)
    }

    fn end_word(&mut self, start: usize, after: char) -> Word {
        let [start, end] = [start, self.text.len()].map(|offset| u32::try_from(offset).unwrap_or(u32::MAX));
        self.text.push(after);
        Word { start, end, is_quoted: false }
    }
}

/// A word that needs no quotes, as text.
fn plain(word: &[u8]) -> Option<&str> {
    let stands_for_itself = |byte: &u8| byte.is_ascii_graphic() && !matches!(byte, b'"' | b'\'');
    let is_plain = !matches!(word, [] | [b'#' | b'!', ..]) && word.iter().all(stands_for_itself);
    std::str::from_utf8(word).ok().filter(|_| is_plain)
}
