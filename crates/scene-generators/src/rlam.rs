//! `rlam [-tS] [-u] [-i{a|f|d|i|w|b}[N]] [-in M] input …`: joins records of several inputs side by
//! side.
//!
//! An input is a file, `-`, or a command after `!`. Its records are N lines (`-ia`) or N binary
//! numbers of 4 (`-if`, `-ii`), 8 (`-id`), 2 (`-iw`) or 1 byte (`-ib`). The separator S (`-t`; a
//! line break if S is empty; a tab by default, nothing after a binary format) precedes each line
//! but no number. Options apply to the inputs after them. `-in` is the largest number of records.

use crate::arguments::Arguments;
use crate::number_text::leading_integer;
use crate::supply::Supply;
use crate::text::Text;
use crate::{Error, Invocation, Output, pipeline};
use radsight_loader::{FileKind, LoadError};
use std::io::{Cursor, Read};

/// The format of a record.
#[derive(Clone, Copy)]
enum Form {
    Lines(usize),
    Bytes(usize),
}

#[derive(Clone)]
struct Input {
    /// Index of the stream; standard input may be named several times.
    stream: usize,
    form: Form,
    separator: String,
}

/// A file, a command's output, or standard input.
struct Stream<'a> {
    name: String,
    supply: Supply<'a>,
}

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let (mut inputs, mut streams, mut most) = (Vec::new(), Vec::new(), 0);
    let mut now = Input { stream: 0, form: Form::Lines(1), separator: "\t".to_owned() };
    loop {
        while let Some(option) = arguments.option_before_files()? {
            match option.name {
                "-t" => now.separator = if option.text.is_empty() { "\n" } else { option.text }.to_owned(),
                "-u" => {}
                "-in" => most = usize::try_from(arguments.integer("most records (-in)")?).unwrap_or(0),
                "-i" => now.take_form(option.text, &arguments)?,
                _ => return Err(arguments.unknown()),
            }
        }
        let Some(word) = arguments.word() else { break };
        now.stream = stream(word, &mut streams, invocation)?;
        inputs.push(now.clone());
    }
    if inputs.is_empty() {
        return Err(arguments.mistake(invocation.argv.len(), "missing input1"));
    }
    let mut text = invocation.text();
    let has_lines = inputs.iter().any(|input| matches!(input.form, Form::Lines(_)));
    let mut records = 0;
    while (most == 0 || records < most) && put_record(&inputs, &mut streams, &mut text)? {
        if has_lines {
            text.push_bytes(b"\n")?;
        }
        records += 1;
    }
    Ok(Output { standard_output: text.finish()?, warnings: arguments.warnings, ..Output::default() })
}

impl Input {
    /// Parses the text of an option such as `-id3`.
    fn take_form(&mut self, text: &str, arguments: &Arguments<'_>) -> Result<(), Error> {
        let size = match text.as_bytes().first() {
            Some(b'a') => None,
            Some(b'f' | b'i') => Some(4usize),
            Some(b'd') => Some(8),
            Some(b'w') => Some(2),
            Some(b'b') => Some(1),
            _ => return Err(arguments.unknown()),
        };
        let count = match &text[1..] {
            "" => 1,
            digits => leading_integer(digits).ok_or_else(|| arguments.unknown())?.0,
        };
        let count = usize::try_from(count).unwrap_or(1).max(1);
        self.form = match size {
            None => Form::Lines(count),
            Some(size) => {
                self.separator.clear();
                Form::Bytes(size.saturating_mul(count))
            }
        };
        Ok(())
    }
}

/// The index of an input's stream, which is opened if it is new.
fn stream<'a>(name: &str, streams: &mut Vec<Stream<'a>>, invocation: &Invocation<'a>) -> Result<usize, Error> {
    let known = streams.iter().position(|stream| name == "-" && stream.name == name);
    if let Some(known) = known {
        return Ok(known);
    }
    let supply = match name.strip_prefix('!') {
        Some(command) => Supply::new(name, command_output(command, invocation)?),
        None => invocation.supply(name, FileKind::Input)?,
    };
    streams.push(Stream { name: name.to_owned(), supply });
    Ok(streams.len() - 1)
}

/// The output of a command: streamed if the caller may run it, otherwise complete, from the
/// programs of this crate.
fn command_output<'a>(command: &str, invocation: &Invocation<'a>) -> Result<Box<dyn Read + 'a>, Error> {
    match invocation.loader.open_command(command) {
        Err(LoadError::CommandRefused { .. }) => {
            let made = pipeline(command, invocation.loader, invocation.extra).map_err(|failed| failed.error)?;
            Ok(Box::new(Cursor::new(made.standard_output)))
        }
        opened => Ok(opened?),
    }
}

/// Writes one record of each input that still has one; `false` if none has.
fn put_record(inputs: &[Input], streams: &mut [Stream<'_>], text: &mut Text) -> Result<bool, Error> {
    let mut wrote = false;
    for (place, input) in inputs.iter().enumerate() {
        let stream = &mut streams[input.stream];
        match input.form {
            Form::Bytes(size) => {
                let Some(record) = stream.supply.exactly(size, text)? else { continue };
                text.push_bytes(stream.supply.bytes(record))?;
                wrote = true;
            }
            Form::Lines(count) => {
                let separator = input.separator.as_bytes();
                for line in 0..count {
                    let Some(found) = stream.supply.line(text)? else { break };
                    text.push_bytes(if place > 0 || line > 0 { separator } else { &[] })?;
                    let found = stream.supply.bytes(found);
                    text.push_bytes(found.strip_suffix(b"\n").unwrap_or(found))?;
                    wrote = true;
                }
            }
        }
    }
    Ok(wrote)
}
