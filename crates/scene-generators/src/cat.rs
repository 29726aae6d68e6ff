//! `cat [file …]`: concatenates files; `-` or no file means standard input.

use radsight_loader::FileKind;

use crate::arguments::Arguments;
use crate::text::Text;
use crate::{Error, Invocation, Output};

const USAGE: &str = "cat [-u] [file …]";

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut text = Text::default();
    for name in file_names(invocation, USAGE)? {
        text.push_bytes(&invocation.input(name, FileKind::Input)?)?;
    }
    Ok(Output { standard_output: text.into_bytes(), ..Output::default() })
}

/// The files to read; `-` if none is named. The option `-u` (no buffering) has no effect.
pub(crate) fn file_names<'a>(invocation: &Invocation<'a>, usage: &'static str) -> Result<Vec<&'a str>, Error> {
    let mut arguments = Arguments::with_usage(invocation.argv, usage);
    while let Some(option) = arguments.peek().filter(|word| word.starts_with('-') && *word != "-") {
        arguments.word();
        match option {
            "-u" => {}
            "--" => break,
            _ => return Err(arguments.unknown()),
        }
    }
    Ok(arguments.files())
}
