//! A parsed text in memory.

use super::{Alias, Item, Items, Place, Primitive, SyntaxError, Word};
use crate::Kind;
use std::ops::Range;
use std::sync::Arc;

/// A text with its items, for a file that is used many times.
#[derive(Clone, Debug)]
pub struct Document {
    text: Arc<[u8]>,
    records: Vec<Record>,
    strings: Vec<Word>,
    integers: Vec<i64>,
    reals: Vec<f64>,
}

#[derive(Clone, Debug)]
enum Record {
    Comment(Place),
    Command(Place),
    Alias { modifier: Word, kind: Word, name: Word, target: Word },
    Primitive(PrimitiveRecord),
    Wrong(SyntaxError),
}

#[derive(Clone, Debug)]
struct PrimitiveRecord {
    modifier: Word,
    kind: Kind,
    kind_word: Word,
    name: Word,
    strings: Range<usize>,
    integers: Range<usize>,
    reals: Range<usize>,
    counts: [Word; 3],
    end: u32,
}

impl Document {
    /// Parses a whole text.
    #[must_use]
    pub fn parse(text: Arc<[u8]>) -> Self {
        let mut document = Document {
            text: Arc::clone(&text),
            records: Vec::new(),
            strings: Vec::new(),
            integers: Vec::new(),
            reals: Vec::new(),
        };
        match Items::new(&text) {
            Ok(mut items) => {
                while let Some(item) = items.advance() {
                    let record = document.record(item);
                    document.records.push(record);
                }
            }
            Err(error) => document.records.push(Record::Wrong(error)),
        }
        document
    }

    /// The text.
    #[must_use]
    pub fn text(&self) -> &Arc<[u8]> {
        &self.text
    }

    /// The items and mistakes, in order.
    pub fn items(&self) -> impl Iterator<Item = Result<Item<'_>, SyntaxError>> {
        self.records.iter().map(|record| self.item(record))
    }

    fn record(&mut self, item: Result<Item<'_>, SyntaxError>) -> Record {
        match item {
            Ok(Item::Comment(place)) => Record::Comment(place),
            Ok(Item::Command(place)) => Record::Command(place),
            Ok(Item::Alias(Alias { modifier, kind, name, target, .. })) => {
                Record::Alias { modifier, kind, name, target }
            }
            Ok(Item::Primitive(primitive)) => Record::Primitive(PrimitiveRecord {
                modifier: primitive.modifier,
                kind: primitive.kind,
                kind_word: primitive.kind_word,
                name: primitive.name,
                strings: append(&mut self.strings, primitive.strings),
                integers: append(&mut self.integers, primitive.integers),
                reals: append(&mut self.reals, primitive.reals),
                counts: primitive.counts,
                end: primitive.end,
            }),
            Err(error) => Record::Wrong(error),
        }
    }

    fn item(&self, record: &Record) -> Result<Item<'_>, SyntaxError> {
        let whole = &*self.text;
        Ok(match record {
            Record::Comment(place) => Item::Comment(place.clone()),
            Record::Command(place) => Item::Command(place.clone()),
            &Record::Alias { modifier, kind, name, target } => {
                Item::Alias(Alias { whole, modifier, kind, name, target })
            }
            Record::Primitive(record) => Item::Primitive(Primitive {
                whole,
                modifier: record.modifier,
                kind: record.kind,
                kind_word: record.kind_word,
                name: record.name,
                strings: &self.strings[record.strings.clone()],
                integers: &self.integers[record.integers.clone()],
                reals: &self.reals[record.reals.clone()],
                counts: record.counts,
                end: record.end,
            }),
            Record::Wrong(error) => return Err(error.clone()),
        })
    }
}

fn append<T: Copy>(all: &mut Vec<T>, new: &[T]) -> Range<usize> {
    let start = all.len();
    all.extend_from_slice(new);
    start..all.len()
}
