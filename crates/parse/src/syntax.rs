//! The grammar of scene text: a lossless list of items, each with its place.
//!
//! [`Items`] walks over a text without copying it and without a fresh allocation for each
//! primitive; [`Document`] is the same list kept in memory, for a file that is used many times.
//! Neither knows what the arguments of a type mean.
//!
//! A word is read as Radiance reads it: it ends at white space, may have quoted parts anywhere, and
//! a quote of one kind may stand between quotes of the other. Numbers are written as C writes them
//! in decimal; `inf` and `nan` are not numbers.
//!
//! ```
//! use radsight_parse::syntax::{Item, Items};
//! let mut items = Items::new(b"# a ball\nvoid sphere ball 0 0 4 0 0 1. .5").unwrap();
//! assert!(matches!(items.advance(), Some(Ok(Item::Comment(_)))));
//! let Some(Ok(Item::Primitive(ball))) = items.advance() else { panic!() };
//! assert_eq!((&*ball.text(ball.name), ball.reals), (&b"ball"[..], &[0.0, 0.0, 1.0, 0.5][..]));
//! assert!(items.advance().is_none());
//! ```

mod document;
mod error;
mod item;
mod items;
mod lexer;
mod real;
#[cfg(test)]
mod tests;

pub use document::Document;
pub use error::{Mistake, Section, SyntaxError};
pub use item::{Alias, Item, Place, Primitive, Word};
pub use items::{Items, MAX_TEXT_BYTES};
pub(crate) use lexer::{is_space, words};
pub use real::{parse_integer, parse_real};
