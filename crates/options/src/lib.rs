//! The options of every program that has the name of one of Radiance's.
//!
//! One table says what each option is called, what stands after it, its unit, its default and what it does.
//! [`Program::recognise`] reads a word of a command line by it; [`Settings`] holds what was given and prints it as
//! Radiance's `-defaults` does; [`help`], [`manual_page`] and [`Shell::completion`] are made of the same entries.
//!
//! Guarantees: every name of a program is unambiguous, and each text is a function of the table alone.
//!
//! This crate may not know what an option does to a program, nor the disk: the program takes the words that were
//! recognised, and writes the pages.
//!
//! ```
//! let rpict = radsight_options::program("rpict").unwrap();
//! let found = rpict.recognise("-vp").unwrap();
//! assert_eq!((found.option.values, found.words()), ("X Y Z", 4));
//! assert!(rpict.recognise("-vq").is_none());
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
pub use program::{Group, Program, Recognised};
pub use settings::Settings;

/// All programs, sorted by name.
#[must_use]
pub fn programs() -> &'static [&'static Program] {
    tables::PROGRAMS
}

/// The program of this name.
#[must_use]
pub fn program(name: &str) -> Option<&'static Program> {
    tables::PROGRAMS.iter().copied().find(|program| program.name == name)
}
