//! The text of `--help`.

use crate::option::ProgramOption;
use crate::program::Program;
use std::fmt::Write;

/// Line width, columns.
const WIDTH: usize = 100;
/// Column at which explanations begin.
const INDENT: usize = 26;

/// The help text of a program: its command line, summary, and options.
#[must_use]
pub fn help(program: &Program) -> String {
    let mut text = format!("{}: {}\n\nUsage: {}\n", program.name, program.summary, program.synopsis);
    if !program.description.is_empty() {
        text.push('\n');
        wrap(program.description, 0, &mut text);
    }
    for group in program.groups {
        let _ = writeln!(text, "\n{}:", group.title);
        for option in group.options {
            let usage = option.usage();
            let _ = write!(text, "  {usage}");
            if usage.chars().count() + 3 > INDENT {
                text.push('\n');
                text.push_str(&" ".repeat(INDENT));
            } else {
                text.push_str(&" ".repeat(INDENT - 2 - usage.chars().count()));
            }
            wrap(&explanation(program, option), INDENT, &mut text);
        }
    }
    text
}

/// The help text of an option, with its unit and its default in this program.
pub(crate) fn explanation(program: &Program, option: &ProgramOption) -> String {
    let mut text = option.help.to_owned();
    if !option.unit.is_empty() {
        let _ = write!(text, ", in {}", option.unit);
    }
    match program.default_of(option) {
        "" => {}
        "+" => text.push_str(" [default: on]"),
        "-" => text.push_str(" [default: off]"),
        default => {
            let _ = write!(text, " [default: {default}]");
        }
    }
    text
}

/// Appends words, wrapped at [`WIDTH`] columns; all lines but the first are indented.
fn wrap(words: &str, indent: usize, text: &mut String) {
    let mut column = indent;
    for (place, word) in words.split_whitespace().enumerate() {
        let length = word.chars().count();
        if place > 0 && column + 1 + length > WIDTH {
            text.push('\n');
            text.push_str(&" ".repeat(indent));
            column = indent;
        } else if place > 0 {
            text.push(' ');
            column += 1;
        }
        text.push_str(word);
        column += length;
    }
    text.push('\n');
}
