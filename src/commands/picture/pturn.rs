//! `pflip [-h] [-v] [-c] [picture [output]]` and `protate [-r] [-c] picture [output]`: mirror and
//! rotate pictures.
//!
//! `-h` and `-v` select the axis, `-r` rotates counterclockwise. With `-c` the resolution keeps the
//! order of the input, so that the displayed picture is turned; without it the order changes with
//! the pixels.

use super::files::{failed, open_picture, put_file};
use crate::commands::words::Words;
use crate::failure::{Outcome, say};
use radsight_picture::Header;
use radsight_picture_ops::turn::{OrderRecord, Turn, turn};

/// Runs `pflip`.
pub(super) fn flip(mut words: Words<'_>) -> Outcome {
    let (mut horizontally, mut vertically, mut record) = (false, false, OrderRecord::Kept);
    while let Some(option) = words.option()? {
        match option {
            "-h" => horizontally = true,
            "-v" => vertically = true,
            "-c" => record = OrderRecord::Corrected,
            _ => return Err(words.unknown(option)),
        }
    }
    if !horizontally && !vertically {
        say("pflip: warning - no operation\n");
    }
    let command = words.taken().join(" ");
    run(&words, Turn::Flip { horizontally, vertically }, record, &command)
}

/// Runs `protate`.
pub(super) fn rotate(mut words: Words<'_>) -> Outcome {
    let (mut direction, mut record) = (Turn::Clockwise, OrderRecord::Kept);
    while let Some(option) = words.option()? {
        match option {
            "-r" => direction = Turn::Counterclockwise,
            "-c" => record = OrderRecord::Corrected,
            _ => return Err(words.unknown(option)),
        }
    }
    let mut command = words.program().to_owned();
    if direction == Turn::Counterclockwise {
        command.push_str(" -r");
    }
    if record == OrderRecord::Corrected {
        command.push_str(" -c");
    }
    run(&words, direction, record, &command)
}

fn run(words: &Words<'_>, direction: Turn, record: OrderRecord, command: &str) -> Outcome {
    let (path, target) = words.input_and_output()?;
    let reader = open_picture(path)?;
    let header = with_command(reader.header(), command);
    put_file(target, |out| turn(reader, direction, record, &header, out).map_err(|error| failed(path, error)))
}

/// The header with its format before the command, as in the real programs.
fn with_command(input: &Header, command: &str) -> Header {
    let mut header = input.clone();
    let format = header.format().map(|format| format.into_owned());
    header.remove("FORMAT");
    if let Some(format) = format {
        header.push_variable("FORMAT", &format);
    }
    header.push_line(command);
    header
}
