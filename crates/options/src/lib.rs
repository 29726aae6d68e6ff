//! The options of all programs that share a name with one of Radiance's.
//!
//! One table holds the name of each option, its values, unit, default and help text.
//! [`Program::parse_word`] parses a word of a command line; [`Settings`] holds the given values and
//! prints them as Radiance's `-defaults` does; [`help`], [`manual_page`] and [`Shell::completion`]
//! are generated from the same entries.
//!
//! Guarantees: every name of a program is unambiguous, and each text is a function of the table
//! alone.
//!
//! This crate may not know the effect of an option, nor the disk: the program applies the parsed
//! options and writes the pages.
//!
//! ```
//! let rpict = radsight_options::program("rpict").unwrap();
//! let found = rpict.parse_word("-vp").unwrap();
//! assert_eq!((found.option.values, found.words()), ("X Y Z", 4));
//! assert!(rpict.parse_word("-vq").is_none());
//! ```
#![forbid(unsafe_code)]

mod completion;
mod help;
mod manual;
mod option;
mod program;
mod settings;
mod tables;

pub use completion::Shell;
pub use help::help;
pub use manual::{manual_page, manual_page_file};
pub use option::{Listing, OptionForm, ProgramOption};
pub use program::{Group, ParsedOption, Program};
pub use settings::Settings;

/// All programs, sorted by name.
#[must_use]
pub fn programs() -> &'static [&'static Program] {
    tables::PROGRAMS
}

/// The program with this name.
#[must_use]
pub fn program(name: &str) -> Option<&'static Program> {
    tables::PROGRAMS.iter().copied().find(|program| program.name == name)
}
