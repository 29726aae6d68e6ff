//! Radiance's programs that combine matrices of light.

mod dctimestep;
mod input;
mod rcomb;
mod rmtxop;

use super::words::Words;
use crate::failure::Outcome;
use crate::trust::Trust;

/// The function that runs a program.
type Program = fn(Words<'_>) -> Outcome;

/// The programs by their names.
const PROGRAMS: &[(&str, Program)] = &[("dctimestep", dctimestep::run), ("rcomb", rcomb::run), ("rmtxop", rmtxop::run)];

/// Runs a program if it is one of these; `words[0]` is its name.
pub(crate) fn run(words: &[String], trust: &Trust) -> Option<Outcome> {
    let name = words.first()?;
    let (_, program) = PROGRAMS.iter().find(|(known, _)| known == name)?;
    Some(program(Words::new(words, trust)))
}
