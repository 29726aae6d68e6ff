//! The table of options on the command line: parses words and reports unknown ones.

use crate::failure::Failure;
use radsight_options::{ParsedOption, Program, help};

/// The options of a program of ours.
pub(crate) fn options_of(name: &str) -> &'static Program {
    radsight_options::program(name).expect("each program has its options in the table")
}

/// Parses a word as an option of a program; prints the help text if it is requested.
pub(crate) fn parse_option(program: &'static Program, word: &str) -> Result<ParsedOption, Failure> {
    let found = program.parse_word(word).ok_or_else(|| unknown_option(program, word))?;
    if found.option.name == "--help" {
        return Err(Failure::answer(help(program)));
    }
    Ok(found)
}

/// Checks that a program used as many words as the table declares for the option.
pub(crate) fn check_words(program: &Program, found: &ParsedOption, word: &str, used: usize) -> Result<(), Failure> {
    match used {
        0 => Err(unknown_option(program, word)),
        _ if used == found.words() => Ok(()),
        _ => Err(Failure::fault(format!(
            "{}: option \"{word}\" used {used} words, but the table of options declares {}",
            program.name,
            found.words()
        ))),
    }
}

/// The error of a word that is not an option of the program.
pub(crate) fn unknown_option(program: &Program, word: &str) -> Failure {
    // Radiance's renderers have more options than ours.
    let is_renderer = program.options().any(|option| option.name == "-ab");
    let what = if is_renderer { "is not supported" } else { "is unknown" };
    Failure::usage(format!("{}: option \"{word}\" {what}\nhint: {}", program.name, program.hint(word)))
}
