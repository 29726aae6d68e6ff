//! The table of options at the command line: what a word means to a program, and what is said of one that means nothing.

use crate::failure::Failure;
use radsight_options::{Program, Recognised, help};

/// The options of a program, which is one of ours.
pub(crate) fn options_of(name: &str) -> &'static Program {
    radsight_options::program(name).expect("each program has its options in the table")
}

/// What a word means to a program; asked for help, the program answers.
pub(crate) fn recognised(program: &'static Program, word: &str) -> Result<Recognised, Failure> {
    let found = program.recognise(word).ok_or_else(|| unknown_option(program, word))?;
    if found.option.name == "--help" {
        return Err(Failure::answer(help(program)));
    }
    Ok(found)
}

/// Checks that a program used as many words as the table says the option has.
pub(crate) fn check_words(program: &Program, found: &Recognised, word: &str, used: usize) -> Result<(), Failure> {
    match used {
        0 => Err(unknown_option(program, word)),
        _ if used == found.words() => Ok(()),
        _ => Err(Failure::fault(format!(
            "{}: option \"{word}\" used {used} words, and the table of options says {}",
            program.name,
            found.words()
        ))),
    }
}

/// The error of a word that is no option of the program.
pub(crate) fn unknown_option(program: &Program, word: &str) -> Failure {
    // Radiance's renderers have more options than ours.
    let is_renderer = program.options().any(|option| option.name == "-ab");
    let what = if is_renderer { "is not supported" } else { "is unknown" };
    Failure::usage(format!("{}: option \"{word}\" {what}\nhint: {}", program.name, program.hint(word)))
}
