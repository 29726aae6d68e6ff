//! `cat [file …]`: files one after the other; `-` and no file at all mean standard input.

use radsight_loader::FileKind;

use crate::arguments::Arguments;
use crate::text::Text;
use crate::{Error, Invocation, Output};

const USAGE: &str = "cat [-u] [file …]";

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut text = Text::default();
    for name in file_names(invocation, USAGE)? {
        match name {
            "-" => text.push_bytes(invocation.standard_input())?,
            name => text.push_bytes(&invocation.loader.load(name, FileKind::Other)?.bytes)?,
        }
    }
    Ok(Output { standard_output: text.into_bytes(), ..Output::default() })
}

/// The files to read, `-` when none is named. The option `-u` (no buffering) changes nothing here.
pub(crate) fn file_names<'a>(invocation: &Invocation<'a>, usage: &'static str) -> Result<Vec<&'a str>, Error> {
    let mut arguments = Arguments::new(invocation.argv, usage);
    while let Some(option) = arguments.peek().filter(|word| word.starts_with('-') && *word != "-") {
        arguments.word();
        match option {
            "-u" => {}
            "--" => break,
            _ => return Err(arguments.unknown()),
        }
    }
    let names: Vec<&str> = arguments.rest().iter().map(String::as_str).collect();
    Ok(if names.is_empty() { vec!["-"] } else { names })
}
