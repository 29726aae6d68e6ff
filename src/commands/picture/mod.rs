//! Radiance's picture programs.

mod files;
mod getinfo;
mod pfilt;
mod pvalue;
mod words;

use crate::failure::Outcome;
use words::Words;

/// The programs by their names.
const PROGRAMS: [(&str, fn(Words<'_>) -> Outcome); 3] =
    [("getinfo", getinfo::run), ("pfilt", pfilt::run), ("pvalue", pvalue::run)];

/// The names of the programs.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    PROGRAMS.iter().map(|(name, _)| *name)
}

/// Runs a program, if it is one of these; `words[0]` is its name.
pub(crate) fn run(words: &[String]) -> Option<Outcome> {
    let name = words.first()?;
    let (_, program) = PROGRAMS.iter().find(|(known, _)| known == name)?;
    Some(program(Words::new(words)))
}
